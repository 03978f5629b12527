//! Display (Fig. 4; H8, H9 with R1, R5 to R8): the cut of the tree for a view at a date.

use super::{Cluster, Drawn, Hdlod, Marks, Node, Selection, Span, Temporal};
use crate::{Aabb, Clip, Containment, ElementId, Frustum, Layer, Lens, LookId, Scene, View};
use topout_schedule::{Share, Time};

/// Whether mode paper draws a cluster that is good enough, or leaves it out (R1): the smaller of
/// what drawing gets wrong, judged by the smallest share that may be present, and of what leaving
/// out gets wrong, judged by the largest (R13). Of a share that is known: f >= 1/2.
pub fn draws_part(share: Share) -> bool {
    f64::from(share.lo) + f64::from(share.hi) >= 1.0
}

/// delta_c(t) of H8 in metres, with the additive w of R2: what drawing or leaving out the cluster,
/// as [`draws_part`] says, gets wrong at most by the paper's figure of merit. Of a share that is
/// known this is H8 as printed.
pub fn delta_m(cluster: &Cluster, share: Share) -> f32 {
    let wrong = if draws_part(share) { 1.0 - share.lo } else { share.hi };
    match share.hi {
        hi if hi <= 0.0 => 0.0,
        _ => cluster.eps + (f64::from(wrong) * cluster.weight) as f32,
    }
}

/// What to draw for a view at a date: a pure function of its arguments (H9, H10).
///
/// Tight: a cluster is good enough when its eps is at most the tolerance on the picture; what it
/// draws then is exact in time (R11). Paper: delta decides, and the cluster is drawn whole or
/// left out (R1, R13). A leaf that is present is drawn (R6).
///
/// Of a section ([`View::clip`]) only what lies inside wholly is drawn by clusters: they stand for what
/// is inside of their boxes, not for what a plane leaves of it. So the error is that of a whole scene.
pub fn select(scene: &Scene, hdlod: &Hdlod, view: &View, time: Time) -> Selection {
    cut(scene, hdlod, view, time, None)
}

/// [`select`] where elements have looks: a cluster of which those that are present look different is
/// not drawn, unless all of it is smaller than the tolerance. `marks` are those of the same date.
pub fn select_marked(
    scene: &Scene,
    hdlod: &Hdlod,
    view: &View,
    time: Time,
    marks: &Marks,
) -> Selection {
    cut(scene, hdlod, view, time, Some(marks))
}

fn cut(scene: &Scene, hdlod: &Hdlod, view: &View, time: Time, marks: Option<&Marks>) -> Selection {
    let mut walk = Walk {
        scene,
        hdlod,
        tolerance_px: view.tolerance_px,
        lens: view.lens(),
        frustum: view.frustum(),
        clip: view.clip,
        time,
        marks,
        out: Selection::default(),
    };
    if let Some(root) = hdlod.root {
        walk.node(root, Known::default());
    }
    for &element in &hdlod.loose {
        walk.node(Node::Leaf(element), Known::default());
    }
    walk.out
}

impl Hdlod {
    /// What drawing a cluster gets wrong at a date, metres; `None` where it is absent for sure.
    fn delta_at(&self, cluster: &Cluster, time: Time) -> Option<f32> {
        match self.temporal {
            Temporal::Tight => Some(cluster.eps),
            Temporal::Paper => match cluster.presence.at(time) {
                share if share.hi <= 0.0 => None,
                share => Some(delta_m(cluster, share)),
            },
        }
    }

    /// What one cluster draws at a date in place of everything below it; `None` where that would be off by
    /// more than the tolerance.
    pub fn drawn_alone(
        &self,
        scene: &Scene,
        cluster: u32,
        view: &View,
        time: Time,
    ) -> Option<Vec<Span>> {
        let cluster = &self.clusters[cluster as usize];
        let delta = self.delta_at(cluster, time).unwrap_or(0.0);
        if cluster.stale || view.error_px(delta, &cluster.bounds) > view.tolerance_px {
            return None;
        }
        let mut out = Vec::new();
        spans(scene, self, cluster, time, |span| out.push(span));
        Some(out)
    }
}

struct Walk<'a> {
    scene: &'a Scene,
    hdlod: &'a Hdlod,
    tolerance_px: f32,
    lens: Lens,
    frustum: Frustum,
    clip: Clip,
    time: Time,
    marks: Option<&'a Marks>,
    out: Selection,
}

/// What is known of a node from above.
#[derive(Clone, Copy, Default)]
struct Known {
    /// It is in the frame, all of it.
    inside: bool,
    /// No section plane cuts it.
    whole: bool,
}

impl Walk<'_> {
    /// The depth of the recursion is the number of levels: at most some dozens.
    fn node(&mut self, node: Node, known: Known) {
        self.out.visited += 1;
        match node {
            Node::Leaf(element) => self.leaf(element, known),
            Node::Cluster(i) => self.cluster(i, known),
        }
    }

    fn leaf(&mut self, id: ElementId, known: Known) {
        let element = &self.scene.model.elements[id.index()];
        if !self.scene.behaviour(id).at(self.time) {
            return;
        }
        if !known.inside && self.frustum.test(&element.bounds) == Containment::Outside {
            return;
        }
        match self.shown_of(&element.bounds, known) {
            Containment::Outside => return,
            Containment::Partly => self.out.cut.push(id),
            Containment::Inside => self.out.elements.push(id),
        }
        self.out.triangles += self.scene.model.triangles_of(element) as u64;
    }

    fn cluster(&mut self, index: u32, mut known: Known) {
        let cluster = &self.hdlod.clusters[index as usize];
        // H9 and R13: absent for sure. In a gap between two presences the nodes below find that out.
        if !cluster.presence.may_be_present(self.time) {
            return;
        }
        if !known.inside {
            match self.frustum.test(&cluster.bounds) {
                Containment::Outside => return,
                Containment::Partly => {}
                Containment::Inside => known.inside = true,
            }
        }
        match self.shown_of(&cluster.bounds, known) {
            Containment::Outside => return,
            Containment::Partly => {}
            Containment::Inside => known.whole = true,
        }
        let Some(delta) = self.hdlod.delta_at(cluster, self.time) else { return };
        let error_px = self.lens.error_px(delta, &cluster.bounds);
        let look = match self.marks {
            None => Some(LookId::OWN),
            Some(marks) => marks.of_cluster(index).or_else(|| {
                // Nobody can tell its parts apart.
                let size = self.lens.error_px(cluster.bounds.diameter(), &cluster.bounds);
                (size <= self.tolerance_px).then_some(LookId::OWN)
            }),
        };
        let Some(look) =
            look.filter(|_| known.whole && !cluster.stale && error_px <= self.tolerance_px)
        else {
            for i in cluster.children.clone() {
                self.node(self.hdlod.children[i as usize], known);
            }
            return;
        };
        self.out.worst_px = self.out.worst_px.max(error_px);
        self.draw(index, cluster, look);
    }

    /// How much of what is in a box the section shows. Of what is so small that nobody can tell its parts
    /// apart, even where it is simplified too, all or nothing.
    fn shown_of(&mut self, bounds: &Aabb, known: Known) -> Containment {
        if known.whole {
            return Containment::Inside;
        }
        let shown = self.clip.test(bounds);
        if shown != Containment::Partly {
            return shown;
        }
        let size = self.lens.error_px(bounds.diameter() * 2.0, bounds);
        if size > self.tolerance_px {
            return shown;
        }
        self.out.worst_px = self.out.worst_px.max(size);
        match self.clip.contains(bounds.center()) {
            true => Containment::Inside,
            false => Containment::Outside,
        }
    }

    fn draw(&mut self, index: u32, cluster: &Cluster, look: LookId) {
        let before = self.out.spans.len();
        spans(self.scene, self.hdlod, cluster, self.time, |span| {
            self.out.triangles += u64::from(span.index_count) / 3;
            self.out.spans.push(Span { look, ..span });
        });
        let end = self.out.spans.len();
        self.out.clusters += u32::from(end > before);
        self.out.drawn.push(Drawn { cluster: index, spans: before..end });
    }
}

/// What a cluster draws at a date, where it is good enough.
pub(crate) fn spans(
    scene: &Scene,
    hdlod: &Hdlod,
    cluster: &Cluster,
    time: Time,
    mut emit_span: impl FnMut(Span),
) {
    for (runs, layer) in cluster.layers.iter().zip([Layer::Opaque, Layer::Transparent]) {
        let mut emit = |from: u32, to: u32| {
            emit_span(Span {
                first_index: cluster.first_index + from,
                index_count: to - from,
                base_vertex: cluster.base_vertex,
                layer,
                look: LookId::OWN,
            });
        };
        match hdlod.temporal {
            Temporal::Tight => runs.present(&scene.behaviours, time, emit),
            Temporal::Paper if draws_part(cluster.presence.at(time)) && runs.start < runs.end() => {
                emit(runs.start, runs.end());
            }
            Temporal::Paper => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Parents;
    use super::super::tests::{built, scene};
    use super::*;
    use glam::UVec2;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn a_cluster_alone_draws_what_it_draws_in_the_cut(
            scene in scene(), time in 0i64..100, away in 1f32..30.0, paper in any::<bool>(),
        ) {
            let temporal = if paper { Temporal::Paper } else { Temporal::Tight };
            let tree = built(&scene, temporal);
            let size = UVec2::new(640, 360);
            let view = View::fit(&scene.model.bounds(), 30.0, 20.0, away, size);
            let time = Time::from_seconds(time);
            let cut = select(&scene, &tree, &view, time);
            let mut next = 0;
            for drawn in &cut.drawn {
                prop_assert_eq!(drawn.spans.start, next);
                next = drawn.spans.end;
                let alone = tree.drawn_alone(&scene, drawn.cluster, &view, time);
                prop_assert_eq!(alone.as_deref(), Some(&cut.spans[drawn.spans.clone()]));
                let exact = View { tolerance_px: 0.0, ..view };
                if tree.clusters[drawn.cluster as usize].eps > 0.0 {
                    prop_assert!(tree.drawn_alone(&scene, drawn.cluster, &exact, time).is_none());
                }
            }
            prop_assert_eq!(next, cut.spans.len());
        }

        /// Of a section clusters draw what is inside wholly; what is cut, or outside, they never draw.
        #[test]
        fn clusters_keep_off_section_planes(
            scene in scene(), time in 0i64..100, away in 1f32..30.0,
            at in -5f32..15.0, normal in (-1f32..1.0, -1f32..1.0, -1f32..1.0),
        ) {
            let tree = built(&scene, Temporal::Tight);
            let parents = Parents::of(&tree);
            let time = Time::from_seconds(time);
            let whole = View::fit(&scene.model.bounds(), 30.0, 20.0, away, UVec2::new(640, 360));
            let mut clip = Clip::NONE;
            prop_assume!(clip.cut(glam::Vec3::splat(at), normal.into()));
            let view = View { clip, ..whole };
            let cut = select(&scene, &tree, &view, time);
            prop_assert_eq!(
                select(&scene, &tree, &View { clip: Clip::NONE, ..view }, time),
                select(&scene, &tree, &whole, time)
            );
            let drawn_by = |cluster: u32| cut.drawn.iter().any(|d| d.cluster == cluster);
            for id in (0..scene.model.elements.len() as u32).map(ElementId) {
                let bounds = &scene.model.elements[id.index()].bounds;
                let above = parents.above(Node::Leaf(id)).any(drawn_by);
                let (exact, part) = (cut.elements.contains(&id), cut.cut.contains(&id));
                if !scene.behaviour(id).at(time) {
                    prop_assert!(!exact && !part);
                    continue;
                }
                prop_assert!(u8::from(above) + u8::from(exact) + u8::from(part) <= 1);
                let small = view.error_px(bounds.diameter(), bounds) <= view.tolerance_px;
                match clip.test(bounds) {
                    Containment::Inside => prop_assert!(above || exact),
                    Containment::Partly => prop_assert!(part || small),
                    Containment::Outside => prop_assert!(!part && (small || !(above || exact))),
                }
            }
        }

        /// What is drawn has the look of every element that it stands for, and without looks the cut is
        /// the one that there always was.
        #[test]
        fn looks_are_never_mixed(
            scene in scene(), time in 0i64..100, away in 1f32..30.0,
            looks in proptest::collection::vec(0u16..3, 64),
        ) {
            let tree = built(&scene, Temporal::Tight);
            let parents = Parents::of(&tree);
            let view = View::fit(&scene.model.bounds(), 30.0, 20.0, away, UVec2::new(640, 360));
            let time = Time::from_seconds(time);
            let look = |e: ElementId| LookId(looks[e.index() % looks.len()]);
            let all = (0..scene.model.elements.len() as u32).map(ElementId);
            let marked: Vec<_> =
                all.clone().map(|e| (e, look(e))).filter(|(_, l)| *l != LookId::OWN).collect();
            let mut marks = Marks::default();
            marks.set(&scene, &tree, &parents, &marked, time);
            let cut = select_marked(&scene, &tree, &view, time, &marks);
            let drawn_by = |cluster: u32| cut.drawn.iter().find(|d| d.cluster == cluster);
            for element in all.filter(|&e| scene.behaviour(e).at(time)) {
                let above = parents.above(Node::Leaf(element)).find_map(drawn_by);
                let by_itself = cut.elements.contains(&element);
                prop_assert!(by_itself != above.is_some());
                let Some(drawn) = above else { continue };
                let cluster = &tree.clusters[drawn.cluster as usize];
                let size = view.error_px(cluster.bounds.diameter(), &cluster.bounds);
                for span in &cut.spans[drawn.spans.clone()] {
                    prop_assert!(span.look == look(element) || size <= view.tolerance_px);
                }
            }
            marks.clear();
            prop_assert_eq!(
                select_marked(&scene, &tree, &view, time, &marks),
                select(&scene, &tree, &view, time)
            );
            // All alike.
            let red: Vec<_> =
                (0..scene.model.elements.len() as u32).map(|e| (ElementId(e), LookId(1))).collect();
            marks.set(&scene, &tree, &parents, &red, time);
            let cut = select_marked(&scene, &tree, &view, time, &marks);
            prop_assert!(cut.spans.iter().all(|s| s.look == LookId(1)));
        }
    }
}
