//! What is drawn in a frame, as plain data: pure functions of scene, view and time.

use crate::fade::{Fader, Share};
use crate::looks::SeeThrough;
use crate::pool::{MeshRange, Pool};
use topout_scene::hdlod::{Marks, Node, Selection, Span};
use topout_scene::{Containment, ElementId, Hdlod, Layer, Model, Scene, View};
use topout_schedule::Time;
use wgpu::util::DrawIndexedIndirectArgs as Command;

/// What is going may have so many times the triangles of the cut.
const MOST_GOING: u64 = 4;

/// Draw commands by layer.
#[derive(Debug, Default)]
pub(crate) struct Layers {
    pub opaque: Vec<Command>,
    pub transparent: Vec<Command>,
}

impl Layers {
    pub fn clear(&mut self) {
        self.opaque.clear();
        self.transparent.clear();
    }

    pub fn len(&self) -> usize {
        self.opaque.len() + self.transparent.len()
    }

    /// Those of one layer.
    pub fn of(&self, layer: Layer) -> &[Command] {
        match layer {
            Layer::Opaque => &self.opaque,
            Layer::Transparent => &self.transparent,
        }
    }

    /// Triangles of all commands.
    pub fn triangles(&self) -> u64 {
        self.opaque.iter().chain(&self.transparent).map(|c| u64::from(c.index_count) / 3).sum()
    }
}

/// Commands of the scene's elements and of clusters.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    /// Exact elements, out of the scene's geometry.
    pub elements: Layers,
    /// Parts of clusters, out of the clusters' geometry.
    pub clusters: Layers,
}

impl Commands {
    pub fn clear(&mut self) {
        self.elements.clear();
        self.clusters.clear();
    }

    pub fn len(&self) -> usize {
        self.elements.len() + self.clusters.len()
    }
}

/// All commands of a frame; kept from frame to frame for its memory.
#[derive(Debug, Default)]
pub(crate) struct DrawList {
    /// Exact elements, out of the scene's geometry.
    pub elements: Layers,
    /// Parts of clusters, out of the clusters' geometry.
    pub clusters: Layers,
    /// What fades, by its share of the pixels ([`Share::code`]).
    pub fading: [Commands; Share::COUNT as usize],
    /// Which behaviours are present; scratch.
    present: Vec<bool>,
    /// Elements drawn exactly.
    pub visible: Vec<ElementId>,
    /// Elements that section planes cut, drawn exactly as far as they are shown.
    pub cut: Vec<ElementId>,
}

impl DrawList {
    /// Commands, of what fades too.
    pub fn len(&self) -> usize {
        let fading: usize = self.fading.iter().map(Commands::len).sum();
        self.elements.len() + self.clusters.len() + fading
    }

    pub fn clear(&mut self) {
        self.elements.clear();
        self.clusters.clear();
        self.visible.clear();
        self.cut.clear();
        self.fading.iter_mut().for_each(Commands::clear);
    }

    /// Finds the elements that are present at `time` and outside neither the frame nor the section. Every distinct
    /// behaviour is asked once.
    pub fn gather_visible(&mut self, scene: &Scene, view: &View, time: Time, culling: bool) {
        self.present.clear();
        self.present.extend(scene.behaviours.iter().map(|b| b.at(time)));
        let frustum = view.frustum();
        let elements = scene.model.elements.iter().zip(&scene.element_behaviour);
        for (id, (element, behaviour)) in (0u32..).zip(elements) {
            let present = self.present.get(behaviour.index()).copied().unwrap_or(false);
            if !present || (culling && frustum.test(&element.bounds) == Containment::Outside) {
                continue;
            }
            match view.clip.test(&element.bounds) {
                Containment::Outside => {}
                Containment::Partly => self.cut.push(ElementId(id)),
                Containment::Inside => self.visible.push(ElementId(id)),
            }
        }
    }

    /// Adds elements that are not there, as far as they are outside neither the frame nor the section.
    pub fn push_previews(
        &mut self,
        elements: impl Iterator<Item = ElementId>,
        scene: &Scene,
        view: &View,
    ) {
        let frustum = view.frustum();
        for id in elements {
            let bounds = &scene.model.elements[id.index()].bounds;
            if frustum.test(bounds) == Containment::Outside {
                continue;
            }
            match view.clip.test(bounds) {
                Containment::Outside => {}
                Containment::Partly => self.cut.push(id),
                Containment::Inside => self.visible.push(id),
            }
        }
    }

    /// Appends the commands of the visible elements, one per instance and layer.
    pub fn push_elements(&mut self, model: &Model, meshes: &[MeshRange], through: &SeeThrough) {
        for &id in &self.visible {
            push_element(&mut self.elements, id, model, meshes, through);
        }
    }

    /// Appends the commands of parts of clusters; `identity` is the first of the instances that move
    /// nothing, one a look.
    pub fn push_spans<'a>(
        &mut self,
        spans: impl IntoIterator<Item = &'a Span>,
        identity: u32,
        through: &SeeThrough,
    ) {
        let push = |span| push_span(&mut self.clusters, span, identity, through);
        spans.into_iter().for_each(push);
    }

    /// Takes what fades out of a selection. `view` has the whole tolerance, which what is going must keep.
    pub fn take_fading(
        &mut self,
        fader: &mut Fader,
        frame: &Fading<'_>,
        pool: &Pool,
        selection: &mut Selection,
    ) {
        let Fading { scene, tree, view, time, through, .. } = *frame;
        let model = &scene.model;
        let (mut late, mut triangles) = (Vec::new(), 0);
        'fades: for (top, nodes, share) in fader.going() {
            let mut spans = Vec::new();
            for node in &nodes {
                if let Node::Cluster(cluster) = node {
                    match tree.drawn_alone(scene, *cluster, view, time) {
                        Some(own) => spans.extend(own),
                        None => {
                            late.push(top);
                            continue 'fades;
                        }
                    }
                }
            }
            let Commands { elements, clusters } = &mut self.fading[share.code() as usize];
            triangles += spans.iter().map(|s| u64::from(s.index_count) / 3).sum::<u64>();
            spans.iter().for_each(|span| push_span(clusters, span, pool.identity, through));
            for node in nodes {
                if let Node::Leaf(id) = node
                    && scene.behaviour(id).at(time)
                {
                    triangles += model.triangles_of(&model.elements[id.index()]) as u64;
                    push_element(elements, id, model, &pool.meshes, through);
                }
            }
        }
        late.into_iter().for_each(|top| fader.end(top));
        if triangles > MOST_GOING * selection.triangles {
            // After a jump of the camera, not on its way.
            fader.end_all();
            self.fading.iter_mut().for_each(Commands::clear);
        }
        if !fader.is_active() {
            return;
        }
        let mut steady = Vec::with_capacity(selection.spans.len());
        for drawn in &selection.drawn {
            let spans = &selection.spans[drawn.spans.clone()];
            match fader.coming(Node::Cluster(drawn.cluster)) {
                None => steady.extend_from_slice(spans),
                Some(share) => {
                    let clusters = &mut self.fading[share.code() as usize].clusters;
                    let identity = pool.identity;
                    spans.iter().for_each(|span| push_span(clusters, span, identity, through));
                }
            }
        }
        selection.spans = steady;
        selection.elements.retain(|&id| match fader.coming(Node::Leaf(id)) {
            None => true,
            Some(share) => {
                let elements = &mut self.fading[share.code() as usize].elements;
                push_element(elements, id, model, &pool.meshes, through);
                false
            }
        });
    }
}

/// The commands of an element, one per instance and layer.
pub(crate) fn push_element(
    layers: &mut Layers,
    id: ElementId,
    model: &Model,
    meshes: &[MeshRange],
    through: &SeeThrough,
) {
    if through.hides(id) {
        return;
    }
    let through = through.element(id);
    for instance in model.elements[id.index()].instances.clone() {
        let mesh = meshes[model.instances[instance as usize].mesh.index()];
        let command = |first_index, index_count| Command {
            index_count,
            instance_count: 1,
            first_index,
            base_vertex: mesh.base_vertex as i32,
            first_instance: instance,
        };
        if through {
            let all = mesh.opaque + mesh.transparent;
            layers.transparent.push(command(mesh.first_index, all));
            continue;
        }
        if mesh.opaque > 0 {
            layers.opaque.push(command(mesh.first_index, mesh.opaque));
        }
        if mesh.transparent > 0 {
            layers.transparent.push(command(mesh.first_index + mesh.opaque, mesh.transparent));
        }
    }
}

fn push_span(layers: &mut Layers, span: &Span, identity: u32, through: &SeeThrough) {
    if through.hides_look(span.look) {
        return;
    }
    let layer = match span.layer {
        Layer::Opaque if !through.look(span.look) => &mut layers.opaque,
        _ => &mut layers.transparent,
    };
    layer.push(Command {
        index_count: span.index_count,
        instance_count: 1,
        first_index: span.first_index,
        base_vertex: span.base_vertex as i32,
        first_instance: identity + u32::from(span.look.0),
    });
}

/// A frame in which levels fade.
#[derive(Clone, Copy)]
pub(crate) struct Fading<'a> {
    pub scene: &'a Scene,
    pub tree: &'a Hdlod,
    pub view: &'a View,
    pub time: Time,
    pub marks: Option<&'a Marks>,
    pub through: &'a SeeThrough,
}
