//! What is selected, and the line around it.

use crate::frame::{FrameUniform, covered_rectangle};
use crate::gpu::Gpu;
use crate::looks::SeeThrough;
use crate::passes::{MASK_FORMAT, Outline};
use crate::pool::{MeshRange, Pool};
use crate::targets::{Target, Targets};
use glam::Vec3;
use topout_scene::{Aabb, Containment, ElementId, Projection, Scene, View};
use topout_schedule::Time;

/// Most elements that are lined in a frame, those largest on the picture: more would take longer than the
/// scene itself, and their lines would fill the picture.
const MOST_ELEMENTS: usize = 4096;
/// Most triangles, likewise.
const MOST_TRIANGLES: u64 = 1 << 18;

/// Selected elements; draws nothing and holds nothing on the GPU as long as there are none.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    pub elements: Vec<ElementId>,
    /// Of the line, as the display takes it.
    pub color: Vec3,
    /// Those that are in the frame.
    shown: Vec<(f32, ElementId)>,
    drawing: Option<Drawing>,
}

/// What it takes to draw them into a picture of one size.
#[derive(Debug)]
struct Drawing {
    outline: Outline,
    mask: Target,
    mask_group: wgpu::BindGroup,
    line_group: wgpu::BindGroup,
}

impl Selection {
    /// Forgets what belongs to textures that are gone.
    pub fn forget_targets(&mut self) {
        self.drawing = None;
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let size = |d: &Drawing| u64::from(d.mask.texture.width() * d.mask.texture.height());
        self.drawing.as_ref().map_or(0, size)
    }

    /// Finds what is there at `time` and in the frame. The part of the picture where the line can be, as
    /// x, y, width and height; `None` if nothing is to be drawn.
    pub fn choose(
        &mut self,
        scene: &Scene,
        view: &View,
        time: Time,
        uniform: &FrameUniform,
        through: &SeeThrough,
    ) -> Option<[u32; 4]> {
        self.shown.clear();
        let elements = &scene.model.elements;
        let frustum = view.frustum();
        for &id in &self.elements {
            let Some(element) = elements.get(id.index()) else { continue };
            let there = scene.behaviour(id).at(time) && !through.hides(id);
            if there && frustum.test(&element.bounds) != Containment::Outside {
                self.shown.push((apparent(&element.bounds, view), id));
            }
        }
        let larger = |a: &(f32, ElementId), b: &(f32, ElementId)| b.0.total_cmp(&a.0);
        if self.shown.len() > MOST_ELEMENTS {
            self.shown.select_nth_unstable_by(MOST_ELEMENTS, larger);
            self.shown.truncate(MOST_ELEMENTS);
        }
        self.shown.sort_by(larger);
        let mut triangles = 0;
        let mut within = |(_, id): &(f32, ElementId)| {
            triangles += scene.model.triangles_of(&elements[id.index()]) as u64;
            triangles <= MOST_TRIANGLES
        };
        // The first is drawn however large it is.
        let fitting = self.shown.iter().take_while(|s| within(s)).count().max(1);
        self.shown.truncate(fitting);
        let bounds = self
            .shown
            .iter()
            .fold(Aabb::EMPTY, |all, (_, id)| all.union(&elements[id.index()].bounds));
        covered_rectangle(uniform, &bounds, 0.0)
    }

    /// Draws the mask, by the depth of what is solid.
    pub fn draw_mask(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::Buffer,
        targets: &Targets,
        scene: &Scene,
        pool: &Pool,
    ) {
        let drawing = self.drawing.get_or_insert_with(|| Drawing::new(gpu, frame, targets));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mask"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &drawing.mask.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&drawing.outline.mask);
        pass.set_bind_group(0, &drawing.mask_group, &[]);
        pass.set_vertex_buffer(0, pool.scene.vertices.slice(..));
        pass.set_vertex_buffer(1, pool.instances.slice(..));
        pass.set_index_buffer(pool.scene.indices.slice(..), pool.scene.format);
        for (_, id) in &self.shown {
            for instance in scene.model.elements[id.index()].instances.clone() {
                let mesh = scene.model.instances[instance as usize].mesh;
                let MeshRange { base_vertex, first_index, opaque, transparent } =
                    pool.meshes[mesh.index()];
                let indices = first_index..first_index + opaque + transparent;
                pass.draw_indexed(indices, base_vertex as i32, instance..instance + 1);
            }
        }
    }

    /// Draws the line over a part of the picture.
    pub fn draw_line(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        [x, y, width, height]: [u32; 4],
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(drawing) = &self.drawing else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("outline"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.scene.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            timestamp_writes,
            ..Default::default()
        });
        pass.set_scissor_rect(x, y, width, height);
        pass.set_pipeline(&drawing.outline.line);
        pass.set_bind_group(0, &drawing.line_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Drawing {
    fn new(gpu: &Gpu, frame: &wgpu::Buffer, targets: &Targets) -> Self {
        let outline = Outline::new(gpu, targets.samples);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let mask = Target::new(gpu, "mask", MASK_FORMAT, targets.size, 1, usage);
        let [mask_group, line_group] = outline.bind(gpu, frame, &targets.depth.view, &mask.view);
        Self { outline, mask, mask_group, line_group }
    }
}

/// How large a box is on the picture, in no unit.
fn apparent(bounds: &Aabb, view: &View) -> f32 {
    match view.projection {
        Projection::Perspective { .. } => {
            bounds.diameter() / bounds.center().distance(view.eye).max(f32::MIN_POSITIVE)
        }
        Projection::Orthographic { .. } => bounds.diameter(),
    }
}
