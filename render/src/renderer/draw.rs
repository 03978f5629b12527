//! The commands of a frame, pass by pass.

use super::{CommandOffsets, Renderer};
use crate::cull::{self, Culler};
use crate::draw_list::Commands;
use crate::frame::FrameUniform;
use crate::input::{Backdrop, DrawMode};
use crate::pool::{Geometry, INSTANCE_BYTES, LOOK_BYTES, Pool, VERTEX_BYTES};
use crate::targets::Target;
use crate::timing::{GpuTimer, Pass};
use topout_scene::{ElementId, Layer, View};
use wgpu::util::DrawIndexedIndirectArgs as Command;

impl Renderer {
    pub(super) fn draw_scene(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mode: DrawMode,
        offsets: Option<CommandOffsets>,
        culled: bool,
        ground: bool,
    ) {
        let plain = match self.options.backdrop {
            Backdrop::Scenery => None,
            Backdrop::Plain(color) => Some(color.map(|c| f64::from(c) / 255.0)),
        };
        // Marked as what shows no element.
        let [r, g, b] = plain.unwrap_or_default();
        let color = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 254.0 / 255.0 });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(self.scene_color(color, self.has_glass(culled)))],
            depth_stencil_attachment: Some(self.scene_depth(wgpu::LoadOp::Clear(0.0))),
            timestamp_writes: self.stamps(Pass::Scene),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.scene_group, &[]);
        if let Some(pool) = &self.pool {
            pass.set_pipeline(&self.passes.solid.placed);
            let at = offsets.map(|o| (o.element_opaque, o.cluster_opaque));
            let (elements, clusters) = (&self.list.elements.opaque, &self.list.clusters.opaque);
            self.draw_layer(&mut pass, pool, mode, elements, clusters, at);
            if culled {
                pass.set_pipeline(&self.passes.solid.fixed);
                self.draw_left(&mut pass, Layer::Opaque);
            }
            self.draw_fading(&mut pass, pool, self.passes.solid.fading.as_ref(), Layer::Opaque);
            let cut = &self.section.layers.opaque;
            if !cut.is_empty() {
                pass.set_pipeline(&self.passes.solid.cut);
                pool.draw(&mut pass, &pool.scene, cut);
                self.section.fill(&mut pass);
            }
        }
        if plain.is_some() {
            return;
        }
        if ground {
            self.passes.ground.draw(&mut pass);
        }
        self.passes.sky.draw(&mut pass);
    }

    /// Whether anything transparent may be in the frame.
    pub(super) fn has_glass(&self, culled: bool) -> bool {
        let list = &self.list;
        let listed = !list.elements.transparent.is_empty()
            || !list.clusters.transparent.is_empty()
            || !self.section.layers.transparent.is_empty();
        let fading = |commands: &Commands| {
            let Commands { elements, clusters } = commands;
            !elements.transparent.is_empty() || !clusters.transparent.is_empty()
        };
        listed
            || list.fading.iter().any(fading)
            || (culled && self.culler.as_ref().is_some_and(Culler::has_glass))
    }

    /// Draws the transparent layer over a copy of the part of the picture where it can be, given as x,
    /// y, width and height.
    pub(super) fn draw_glass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mode: DrawMode,
        offsets: Option<CommandOffsets>,
        culled: bool,
        rectangle: [u32; 4],
    ) {
        let Some(pool) = &self.pool else { return };
        copy_part(encoder, &self.targets.scene, &self.targets.beside, rectangle);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("glass"),
            color_attachments: &[Some(self.scene_color(wgpu::LoadOp::Load, false))],
            depth_stencil_attachment: Some(self.scene_depth(wgpu::LoadOp::Load)),
            timestamp_writes: self.stamps(Pass::Glass),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.scene_group, &[]);
        pass.set_bind_group(1, &self.groups.glass, &[]);
        pass.set_pipeline(&self.passes.glass.placed);
        let at = offsets.map(|o| (o.element_transparent, o.cluster_transparent));
        let list = &self.list;
        let (elements, clusters) = (&list.elements.transparent, &list.clusters.transparent);
        self.draw_layer(&mut pass, pool, mode, elements, clusters, at);
        if culled {
            pass.set_pipeline(&self.passes.glass.fixed);
            self.draw_left(&mut pass, Layer::Transparent);
        }
        self.draw_fading(&mut pass, pool, self.passes.glass.fading.as_ref(), Layer::Transparent);
        pass.set_pipeline(&self.passes.glass.cut);
        pool.draw(&mut pass, &pool.scene, &self.section.layers.transparent);
    }

    /// What fades of a layer.
    fn draw_fading(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pool: &Pool,
        pipeline: Option<&wgpu::RenderPipeline>,
        layer: Layer,
    ) {
        let Some(pipeline) = pipeline.filter(|_| self.fader.is_active()) else { return };
        pass.set_pipeline(pipeline);
        for (code, commands) in (0u64..).zip(&self.list.fading) {
            pass.set_vertex_buffer(3, self.shares.slice(code * 4..code * 4 + 4));
            self.draw_batch(pass, pool, &pool.scene, commands.elements.of(layer), None);
            if let Some(geometry) = &pool.clusters {
                self.draw_batch(pass, pool, geometry, commands.clusters.of(layer), None);
            }
        }
    }

    /// What the scene is drawn into; with several samples also brought to one, and `kept` themselves
    /// where more is drawn over them.
    fn scene_color(
        &self,
        load: wgpu::LoadOp<wgpu::Color>,
        kept: bool,
    ) -> wgpu::RenderPassColorAttachment<'_> {
        let shown = &self.targets.scene.view;
        let many = self.targets.many.as_ref().map(|many| &many.view);
        let kept = kept || many.is_none();
        wgpu::RenderPassColorAttachment {
            view: many.unwrap_or(shown),
            depth_slice: None,
            resolve_target: many.map(|_| shown),
            ops: wgpu::Operations {
                load,
                store: if kept { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard },
            },
        }
    }

    fn scene_depth(&self, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.targets.depth.view,
            depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }
    }

    /// What culling left of the clusters, with the pipeline that is set.
    fn draw_left(&self, pass: &mut wgpu::RenderPass<'_>, layer: Layer) {
        let geometry = self.pool.as_ref().and_then(|pool| pool.clusters.as_ref());
        if let (Some(culler), Some(geometry)) = (&self.culler, geometry) {
            culler.draw(pass, geometry, layer);
        }
    }

    /// A frame as culling needs it; `None` where there is no tree, or nothing of the scene in the picture.
    fn cull_frame<'a>(
        &'a self,
        view: &'a View,
        uniform: &FrameUniform,
        covered: Option<[u32; 4]>,
    ) -> Option<cull::Frame<'a>> {
        let (low, high) = (self.bounds.min.abs(), self.bounds.max.abs());
        Some(cull::Frame {
            uniform: &self.frame,
            view,
            clip_from_world: uniform.clip_from_world,
            reach_m: low.max(high).max(view.eye.abs()).max_element(),
            samples: self.passes.samples,
            covered: covered?,
            depth: &self.targets.depth.view,
            model: &self.scene.as_ref()?.model,
            tree: self.hdlod.as_ref()?,
            geometry: self.pool.as_ref()?.clusters.as_ref()?,
            timer: self.timer.as_ref(),
        })
    }

    /// Prepares culling, and takes away elements that nobody sees; whether there are clusters to cull. Where
    /// the GPU has no room for it, everything is drawn from now on.
    pub(super) fn prepare_culling(
        &mut self,
        view: &View,
        uniform: &FrameUniform,
        covered: Option<[u32; 4]>,
    ) -> bool {
        let Some(mut culler) = self.culler.take() else { return false };
        let mut elements = std::mem::take(&mut self.list.visible);
        // What shines through hides nothing.
        let through = self.looks.see_through();
        let clear: Vec<ElementId> = elements.extract_if(.., |id| through.element(*id)).collect();
        let frame = self.cull_frame(view, uniform, covered);
        let done = frame.map(|frame| culler.prepare(&self.gpu, &frame, &mut elements));
        elements.extend(clear);
        self.list.visible = elements;
        if let Some(Err(error)) = &done {
            tracing::warn!("{error}; drawing also what nobody sees");
            if let Some(pool) = &self.pool {
                self.list.push_spans(&culler.spans(), pool.identity, self.looks.see_through());
            }
            return false;
        }
        let any = culler.triangles() > 0;
        self.culler = Some(culler);
        done.is_some() && any
    }

    /// The commands of culling, where the GPU does it.
    pub(super) fn record_culling(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        uniform: &FrameUniform,
        offsets: Option<CommandOffsets>,
        covered: Option<[u32; 4]>,
    ) {
        let Some(mut culler) = self.culler.take() else { return };
        if let (Some(frame), Some(pool)) = (self.cull_frame(view, uniform, covered), &self.pool) {
            culler.record(&self.gpu, &frame, encoder, |encoder, draw| {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("occluders"),
                    color_attachments: &[],
                    depth_stencil_attachment: Some(self.scene_depth(wgpu::LoadOp::Clear(0.0))),
                    timestamp_writes: self.stamps(Pass::Occluders),
                    ..Default::default()
                });
                pass.set_bind_group(0, &self.scene_group, &[]);
                pass.set_pipeline(&self.passes.solid.occluder_placed);
                let at = offsets.map(|o| (o.element_opaque, o.cluster_opaque));
                let elements = &self.list.elements.opaque;
                self.draw_layer(&mut pass, pool, DrawMode::Hdlod, elements, &[], at);
                pass.set_pipeline(&self.passes.solid.occluder_fixed);
                draw(&mut pass);
            });
        }
        self.culler = Some(culler);
    }

    /// The elements and the clusters of one layer; `offsets` of their commands, in that order.
    fn draw_layer(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pool: &Pool,
        mode: DrawMode,
        elements: &[Command],
        clusters: &[Command],
        offsets: Option<(u64, u64)>,
    ) {
        if mode == DrawMode::Objects {
            return draw_one_by_one(pass, pool, elements);
        }
        self.draw_batch(pass, pool, &pool.scene, elements, offsets.map(|o| o.0));
        if let Some(geometry) = &pool.clusters {
            self.draw_batch(pass, pool, geometry, clusters, offsets.map(|o| o.1));
        }
    }

    /// Commands on one geometry: a single multi-draw where the adapter allows it.
    fn draw_batch(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pool: &Pool,
        geometry: &Geometry,
        commands: &[Command],
        offset: Option<u64>,
    ) {
        if commands.is_empty() {
            return;
        }
        match offset {
            Some(offset) => {
                pool.set_buffers(pass, geometry);
                pass.multi_draw_indexed_indirect(&self.commands, offset, commands.len() as u32);
            }
            None => pool.draw(pass, geometry, commands),
        }
    }

    /// Smooths and lines a part of the picture, given as x, y, width and height. What smooths cannot
    /// write where it reads, so it works beside the picture, and the part is copied back.
    pub(super) fn draw_finish(&self, encoder: &mut wgpu::CommandEncoder, rectangle: [u32; 4]) {
        let smooths = self.passes.smooth.is_some();
        let fading = self.fader.is_active();
        if fading && !smooths {
            // Nothing reads what it draws into.
            copy_part(encoder, &self.targets.scene, &self.targets.beside, rectangle);
        }
        let target = if smooths { &self.targets.beside } else { &self.targets.scene };
        let depth = (self.passes.samples == 1).then_some(wgpu::RenderPassDepthStencilAttachment {
            view: &self.targets.depth.view,
            // Read only: the edges read it as a texture, too.
            depth_ops: None,
            stencil_ops: None,
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("finish"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: depth,
            timestamp_writes: self.stamps(Pass::Finish),
            ..Default::default()
        });
        let [x, y, w, h] = rectangle;
        pass.set_scissor_rect(x, y, w, h);
        if let (Some(smooth), Some(group)) = (&self.passes.smooth, &self.groups.smooth) {
            smooth.draw(&mut pass, group);
        }
        if self.options.edges > 0.0 {
            self.passes.edges.draw(&mut pass, &self.groups.edges, fading);
        }
        drop(pass);
        if smooths {
            GpuTimer::around(self.timer.as_ref(), Pass::Copy, encoder, |encoder| {
                copy_part(encoder, &self.targets.beside, &self.targets.scene, rectangle);
            });
        }
    }
}

/// Copies a part, given as x, y, width and height, to the same place of another texture.
fn copy_part(
    encoder: &mut wgpu::CommandEncoder,
    source: &Target,
    target: &Target,
    [x, y, width, height]: [u32; 4],
) {
    let extent = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    encoder.copy_texture_to_texture(source.part(x, y), target.part(x, y), extent);
}

/// The paper's baseline (R12): every object brings its own mesh and its own place, as in a viewer
/// that keeps them in buffers of their own.
fn draw_one_by_one(pass: &mut wgpu::RenderPass<'_>, pool: &Pool, commands: &[Command]) {
    let format = pool.scene.format;
    for c in commands {
        let vertices = c.base_vertex as u64 * VERTEX_BYTES;
        let indices = u64::from(c.first_index) * u64::from(format.byte_size());
        let row = |bytes: u64| {
            u64::from(c.first_instance) * bytes..u64::from(c.first_instance + 1) * bytes
        };
        pass.set_vertex_buffer(0, pool.scene.vertices.slice(vertices..));
        pass.set_vertex_buffer(1, pool.instances.slice(row(INSTANCE_BYTES)));
        pass.set_vertex_buffer(2, pool.looks.slice(row(LOOK_BYTES)));
        pass.set_index_buffer(pool.scene.indices.slice(indices..), format);
        pass.draw_indexed(0..c.index_count, 0, 0..1);
    }
}
