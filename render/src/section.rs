//! What section planes cut: drawn exactly, as far as it is shown, and filled where it is solid.

use crate::draw_list::{Layers, push_element};
use crate::gpu::Gpu;
use crate::looks::SeeThrough;
use crate::passes::{Caps, SUM_FORMAT, SceneBindings};
use crate::pool::Pool;
use crate::targets::{Target, Targets};
use topout_scene::{ElementId, Model, Solids};
use wgpu::util::DrawIndexedIndirectArgs as Command;

/// The cut elements of a frame; holds nothing on the GPU as long as nothing was cut.
#[derive(Debug, Default)]
pub(crate) struct Section {
    /// All of them.
    pub layers: Layers,
    /// The opaque ones that are solids: counter-clockwise as seen from outside, and clockwise.
    solids: [Vec<Command>; 2],
    /// Of the scene that is set.
    known: Solids,
    drawing: Option<Drawing>,
}

/// What it takes to fill cuts in a picture of one size.
#[derive(Debug)]
struct Drawing {
    caps: Caps,
    sums: Target,
    group: wgpu::BindGroup,
}

impl Section {
    /// Of another model.
    pub fn set_model(&mut self, model: &Model) {
        self.clear();
        self.known = Solids::new(model);
    }

    /// Nothing is cut.
    pub fn clear(&mut self) {
        self.layers.clear();
        self.solids.iter_mut().for_each(Vec::clear);
    }

    /// Forgets what belongs to textures that are gone.
    pub fn forget_targets(&mut self) {
        self.drawing = None;
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let size = |d: &Drawing| u64::from(d.sums.texture.width() * d.sums.texture.height()) * 8;
        self.drawing.as_ref().map_or(0, size)
    }

    /// These are cut.
    pub fn set_elements(
        &mut self,
        elements: &[ElementId],
        model: &Model,
        pool: &Pool,
        through: &SeeThrough,
    ) {
        for &id in elements {
            let before = self.layers.opaque.len();
            push_element(&mut self.layers, id, model, &pool.meshes, through);
            for command in &self.layers.opaque[before..] {
                let instance = command.first_instance as usize;
                if let Some(outward) = self.known.faces_outward(model, instance) {
                    self.solids[usize::from(!outward)].push(*command);
                }
            }
        }
    }

    /// Whether any cut is to be filled.
    pub fn has_solids(&self) -> bool {
        self.solids.iter().any(|commands| !commands.is_empty())
    }

    /// Adds up the surfaces of what is solid within a part of the picture.
    pub fn draw_sums(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: (&SceneBindings, &wgpu::BindGroup),
        targets: &Targets,
        pool: &Pool,
        [x, y, width, height]: [u32; 4],
    ) {
        let (bindings, scene_group) = scene;
        let drawing = self.drawing.get_or_insert_with(|| Drawing::new(gpu, bindings, targets));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("cap sums"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &drawing.sums.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_scissor_rect(x, y, width, height);
        pass.set_bind_group(0, scene_group, &[]);
        for (pipeline, commands) in drawing.caps.sum.iter().zip(&self.solids) {
            pass.set_pipeline(pipeline);
            pool.draw(&mut pass, &pool.scene, commands);
        }
    }

    /// Draws the cuts into a pass over the scene, whose group is set.
    pub fn fill(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(drawing) = self.drawing.as_ref().filter(|_| self.has_solids()) else { return };
        pass.set_pipeline(&drawing.caps.fill);
        pass.set_bind_group(1, &drawing.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Drawing {
    fn new(gpu: &Gpu, bindings: &SceneBindings, targets: &Targets) -> Self {
        let caps = Caps::new(gpu, bindings, targets.samples);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let sums = Target::new(gpu, "cap sums", SUM_FORMAT, targets.size, 1, usage);
        let group = caps.bind(gpu, &sums.view);
        Self { caps, sums, group }
    }
}
