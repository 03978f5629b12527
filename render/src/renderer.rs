//! The renderer: one scene, one picture a frame.

mod draw;
mod reload;

use crate::cull::Culler;
use crate::draw_list::{DrawList, Fading};
use crate::fade::{self, Fader, Share};
use crate::frame::{FrameUniform, covered_rectangle};
use crate::gpu::{Gpu, GpuError};
use crate::input::{Antialias, DrawMode, FrameInput, FrameStats, Options};
use crate::looks::FrameLooks;
use crate::passes::{Edges, Glass, Ground, SceneBindings, Sky, Smooth, Solid};
use crate::pool::Pool;
use crate::readback::{Picture, texture_bytes};
use crate::section::Section;
use crate::selection::Selection;
use crate::targets::Targets;
use crate::timing::{GpuTimer, GpuTimes, Laps, Pass};
use glam::{DVec3, UVec2, Vec3};
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use topout_scene::hdlod::{Marks, Node, Span};
use topout_scene::{Aabb, ElementId, Hdlod, LookId, Looks, Scene, View, hdlod};
use topout_schedule::Time;
use wgpu::util::DrawIndexedIndirectArgs as Command;

/// Pipelines that depend on the number of samples.
#[derive(Debug)]
struct Passes {
    solid: Solid,
    glass: Glass,
    sky: Sky,
    ground: Ground,
    edges: Edges,
    smooth: Option<Smooth>,
    samples: u32,
}

impl Passes {
    fn new(gpu: &Gpu, bindings: &SceneBindings, options: Options) -> Self {
        let (antialias, fades) = (options.antialias, options.fades());
        let samples = if antialias == Antialias::Msaa4 { 4 } else { 1 };
        Self {
            solid: Solid::new(gpu, bindings, samples, fades),
            glass: Glass::new(gpu, bindings, samples, fades),
            sky: Sky::new(gpu, bindings, samples),
            ground: Ground::new(gpu, bindings, samples),
            edges: Edges::new(gpu, samples, fades),
            smooth: (antialias == Antialias::Smooth).then(|| Smooth::new(gpu)),
            samples,
        }
    }
}

/// What the passes over the picture read; made anew with the textures.
#[derive(Debug)]
struct PictureGroups {
    glass: wgpu::BindGroup,
    edges: wgpu::BindGroup,
    smooth: Option<wgpu::BindGroup>,
}

impl PictureGroups {
    fn new(gpu: &Gpu, passes: &Passes, frame: &wgpu::Buffer, targets: &Targets) -> Self {
        // What smooths draws into the one beside.
        let smooths = passes.smooth.is_some();
        let marked = if smooths { &targets.scene.view } else { &targets.beside.view };
        Self {
            glass: passes.glass.bind(gpu, &targets.beside.view),
            edges: passes.edges.bind(gpu, frame, &targets.depth.view, marked),
            smooth: passes.smooth.as_ref().map(|s| s.bind(gpu, frame, &targets.scene.view)),
        }
    }
}

/// Where the commands of a frame lie in the indirect buffer, bytes.
#[derive(Clone, Copy, Debug, Default)]
struct CommandOffsets {
    element_opaque: u64,
    element_transparent: u64,
    cluster_opaque: u64,
    cluster_transparent: u64,
}

/// Draws one scene offscreen, a picture at a time.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    options: Options,
    bindings: SceneBindings,
    passes: Passes,
    frame: wgpu::Buffer,
    empty_materials: wgpu::Buffer,
    scene_group: wgpu::BindGroup,
    targets: Targets,
    groups: PictureGroups,
    commands: wgpu::Buffer,
    command_bytes: Vec<u8>,
    /// `None`: nothing is left out.
    culler: Option<Culler>,
    timer: Option<GpuTimer>,
    /// Frames drawn so far.
    frames: u64,
    list: DrawList,
    fader: Fader,
    /// [`Share::code`] of everything that may fade.
    shares: wgpu::Buffer,
    started: Instant,
    pool: Option<Pool>,
    scene: Option<Arc<Scene>>,
    hdlod: Option<Arc<Hdlod>>,
    bounds: Aabb,
    /// Of the scene.
    origin: DVec3,
    selection: Selection,
    section: Section,
    looks: FrameLooks,
}

impl Renderer {
    /// A renderer without a scene; shows sky and ground until [`Renderer::set_scene`].
    ///
    /// # Panics
    /// If the device cannot hold a few small buffers.
    pub fn new(gpu: &Gpu) -> Self {
        let options = Options::for_gpu(gpu);
        let bindings = SceneBindings::new(gpu);
        let passes = Passes::new(gpu, &bindings, options);
        let usage = wgpu::BufferUsages::COPY_DST;
        let small = |label, bytes, usage| {
            gpu.buffer(label, bytes, usage).expect("a device holds a few small buffers")
        };
        let frame_bytes = size_of::<FrameUniform>() as u64;
        let frame = small("frame", frame_bytes, usage | wgpu::BufferUsages::UNIFORM);
        let empty_materials = small("no materials", 64, usage | wgpu::BufferUsages::STORAGE);
        let commands = small("draw commands", 1 << 16, usage | wgpu::BufferUsages::INDIRECT);
        let shares =
            small("shares", u64::from(Share::COUNT) * 4, usage | wgpu::BufferUsages::VERTEX);
        let codes: Vec<u32> = (0..Share::COUNT).collect();
        gpu.queue.write_buffer(&shares, 0, bytemuck::cast_slice(&codes));
        let scene_group = bindings.bind(gpu, &frame, &empty_materials);
        let targets = Targets::new(gpu, UVec2::ONE, passes.samples);
        let groups = PictureGroups::new(gpu, &passes, &frame, &targets);
        let samples = passes.samples;
        Self {
            gpu: gpu.clone(),
            options,
            bindings,
            passes,
            frame,
            empty_materials,
            scene_group,
            targets,
            groups,
            commands,
            command_bytes: Vec::new(),
            culler: Culler::new(gpu, options.occlusion, samples)
                .expect("a device holds a few small buffers"),
            timer: GpuTimer::new(gpu),
            frames: 0,
            list: DrawList::default(),
            fader: Fader::default(),
            shares,
            started: Instant::now(),
            pool: None,
            scene: None,
            hdlod: None,
            bounds: Aabb::EMPTY,
            origin: DVec3::ZERO,
            selection: Selection::default(),
            section: Section::default(),
            looks: FrameLooks::default(),
        }
    }

    /// The settings in force.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Changes the settings; builds new pipelines where they need them.
    pub fn set_options(&mut self, options: Options) {
        let before = self.options;
        if !options.fades() {
            self.fader.clear();
        }
        if (options.antialias, options.fades()) != (before.antialias, before.fades()) {
            self.passes = Passes::new(&self.gpu, &self.bindings, options);
            if options.antialias != before.antialias {
                self.new_targets(self.targets.size);
            } else {
                self.bind_pictures();
            }
        }
        if (options.antialias, options.occlusion) != (before.antialias, before.occlusion) {
            self.culler = new_culler(&self.gpu, options, self.passes.samples);
        }
        self.options = options;
    }

    /// Uploads a scene in place of the one before, whose HDLOD, selection and looks go with it.
    ///
    /// # Errors
    /// If it does not fit on the device; there is no scene then.
    pub fn set_scene(&mut self, scene: &Arc<Scene>) -> Result<(), GpuError> {
        // First let go of the old one: there may not be room for both.
        self.pool = None;
        self.scene = None;
        self.hdlod = None;
        self.bounds = Aabb::EMPTY;
        self.origin = DVec3::ZERO;
        self.selection.elements.clear();
        self.looks = FrameLooks::default();
        self.scene_group = self.bindings.bind(&self.gpu, &self.frame, &self.empty_materials);
        let pool = Pool::new(&self.gpu, scene)?;
        self.scene_group = self.bindings.bind(&self.gpu, &self.frame, &pool.materials);
        self.section.set_model(&scene.model);
        self.pool = Some(pool);
        self.bounds = scene.model.bounds();
        self.origin = scene.model.origin;
        self.scene = Some(Arc::clone(scene));
        Ok(())
    }

    /// Uploads the clusters of the scene that is set, in place of those before.
    ///
    /// # Errors
    /// If they do not fit on the device; there are none then.
    pub fn set_hdlod(&mut self, hdlod: &Arc<Hdlod>) -> Result<(), GpuError> {
        self.hdlod = None;
        if let Some(pool) = &mut self.pool {
            pool.set_clusters(&self.gpu, hdlod)?;
            self.hdlod = Some(Arc::clone(hdlod));
        }
        Ok(())
    }

    /// Takes other dates for the scene that is set: a scene made of it by an edit of its schedule,
    /// which shares its model, and the tree that was brought along, of whose indices only those in
    /// `dirty` changed since it was set ([`Hdlod::restate`]). Where that is not what is set, everything
    /// is uploaded.
    ///
    /// # Errors
    /// As [`Renderer::set_scene`] and [`Renderer::set_hdlod`].
    pub fn update(
        &mut self,
        scene: &Arc<Scene>,
        hdlod: &Arc<Hdlod>,
        dirty: &[Range<usize>],
    ) -> Result<(), GpuError> {
        let same_model = |old: &Arc<Scene>| Arc::ptr_eq(&old.model, &scene.model);
        if !self.scene.as_ref().is_some_and(same_model) {
            self.set_scene(scene)?;
        }
        self.scene = Some(Arc::clone(scene));
        self.looks.forget_time();
        let sent = match &mut self.pool {
            Some(pool) if self.hdlod.is_some() => pool.update_clusters(&self.gpu, hdlod, dirty),
            _ => false,
        };
        if !sent {
            return self.set_hdlod(hdlod);
        }
        self.hdlod = Some(Arc::clone(hdlod));
        Ok(())
    }

    /// Takes other dates for the scene that is set, without a tree. Where it has another model,
    /// everything is uploaded.
    ///
    /// # Errors
    /// As [`Renderer::set_scene`].
    pub fn set_dates(&mut self, scene: &Arc<Scene>) -> Result<(), GpuError> {
        if !self.scene.as_ref().is_some_and(|old| Arc::ptr_eq(&old.model, &scene.model)) {
            return self.set_scene(scene);
        }
        self.clear_hdlod();
        self.scene = Some(Arc::clone(scene));
        self.looks.forget_time();
        Ok(())
    }

    /// Lets go of the clusters.
    pub fn clear_hdlod(&mut self) {
        self.hdlod = None;
        if let Some(pool) = &mut self.pool {
            pool.clusters = None;
        }
    }

    /// Whether [`DrawMode::Hdlod`] has a tree to cut.
    pub fn has_hdlod(&self) -> bool {
        self.hdlod.is_some()
    }

    /// Draws a line of this sRGB colour around these elements of the scene, as far as they are there, from
    /// the next frame on: strong where they are seen, weak where something solid is before them. Of very
    /// many only the largest on the picture have one.
    pub fn set_selection(&mut self, elements: &[ElementId], color: [u8; 3]) {
        self.selection.elements.clear();
        self.selection.elements.extend_from_slice(elements);
        self.selection.color = Vec3::from(color.map(f32::from)) / 255.0;
    }

    /// Gives the elements of the scene that is set these looks, from the next frame on; `None`: they look
    /// as they are.
    ///
    /// # Errors
    /// If the GPU has no room; they look as they are then.
    pub fn set_looks(&mut self, looks: Option<&Arc<Looks>>) -> Result<(), GpuError> {
        self.looks = FrameLooks::default();
        let Some(pool) = &mut self.pool else { return Ok(()) };
        let looks = looks.filter(|looks| looks.palette().len() > 1);
        pool.set_palette(&self.gpu, looks.map_or(&[], |looks| looks.palette()))?;
        self.looks = FrameLooks::new(looks.cloned());
        Ok(())
    }

    /// Draws a picture of `input.view.size` (held within what the adapter can) and returns without
    /// waiting for the GPU.
    pub fn render(&mut self, input: &FrameInput) -> FrameStats {
        let largest = self.gpu.device.limits().max_texture_dimension_2d;
        let mut view = input.view;
        view.size = view.size.clamp(UVec2::ONE, UVec2::splat(largest));
        if self.targets.size != view.size {
            self.new_targets(view.size);
        }
        self.frames += 1;
        if let Some(timer) = &mut self.timer {
            timer.begin_frame(self.frames);
        }
        let mut laps = Laps::start();
        let mut stats = self.select(&view, input.time, input.mode);
        laps.end(Pass::Select);
        stats.select_ms = laps.timings.cpu_ms();
        let culled = self.encode(&view, input.time, input.mode, &mut laps);
        stats.cpu_ms = laps.timings.cpu_ms() - stats.select_ms;
        stats.passes = laps.timings;
        stats.frame = self.frames;
        // What is left of the clusters is one draw a layer.
        let packed = if culled { 2 } else { 0 };
        stats.draws = (self.list.len() + self.section.layers.len()) as u64 + packed;
        let elements = self.list.elements.triangles() + self.section.layers.triangles();
        if self.cuts(input.mode) {
            let left = self.culler.as_ref().and_then(Culler::left);
            stats.left = left.map(|left| left + elements);
        } else {
            stats.triangles = elements;
        }
        stats
    }

    /// What is shown: `Rgba8Unorm` holding sRGB-encoded colour, opaque (its alpha is at least 253 of
    /// 255), of the size of the last frame's view. A new texture after every change of that size, and of
    /// [`Options::antialias`].
    pub fn color_view(&self) -> &wgpu::TextureView {
        &self.targets.scene.view
    }

    /// Size of the last picture in physical pixels.
    pub fn size(&self) -> UVec2 {
        self.targets.size
    }

    /// Waits until the GPU has finished every frame.
    pub fn wait_idle(&mut self) {
        self.gpu.wait();
    }

    /// Milliseconds that the GPU spent on the latest frame known to be finished; `None` where the
    /// adapter has no timestamps.
    pub fn gpu_ms(&mut self) -> Option<f64> {
        self.timer.as_mut().and_then(GpuTimer::latest).map(|times| times.frame_ms)
    }

    /// What the GPU took for frames whose times have arrived since the last call, at most the latest
    /// three; empty where the adapter has no timestamps. Does not wait: after [`Renderer::wait_idle`] the
    /// last frame is among them.
    pub fn take_gpu_times(&mut self) -> Vec<GpuTimes> {
        self.timer.as_mut().map_or_else(Vec::new, GpuTimer::take)
    }

    /// Whether [`Renderer::take_gpu_times`] will bring times of frames that are drawn already.
    pub fn expects_gpu_times(&self) -> bool {
        self.timer.as_ref().is_some_and(GpuTimer::is_under_way)
    }

    /// Whether the adapter tells how long it took.
    pub fn has_timestamps(&self) -> bool {
        self.timer.is_some()
    }

    /// Bytes that buffers and textures hold on the GPU.
    pub fn gpu_bytes(&self) -> u64 {
        self.pool.as_ref().map_or(0, Pool::bytes)
            + self.targets.bytes()
            + self.selection.bytes()
            + self.section.bytes()
            + self.culler.as_ref().map_or(0, Culler::bytes)
            + self.commands.size()
            + self.frame.size()
            + self.empty_materials.size()
            + self.shares.size()
    }

    /// The last picture, after waiting for it.
    ///
    /// # Errors
    /// If the device fails or has no memory left.
    pub fn read_back(&mut self) -> Result<Picture, GpuError> {
        let mut rgba = texture_bytes(&self.gpu, &self.targets.scene.texture)?;
        for pixel in rgba.chunks_exact_mut(4) {
            pixel[3] = if pixel[3] == 254 { 0 } else { 255 };
        }
        let size = self.targets.size;
        Ok(Picture { width: size.x, height: size.y, rgba })
    }

    fn new_targets(&mut self, size: UVec2) {
        self.selection.forget_targets();
        self.section.forget_targets();
        self.targets = Targets::new(&self.gpu, size, self.passes.samples);
        self.bind_pictures();
    }

    fn bind_pictures(&mut self) {
        self.groups = PictureGroups::new(&self.gpu, &self.passes, &self.frame, &self.targets);
    }

    /// Whether a mode draws a cut of the tree.
    fn cuts(&self, mode: DrawMode) -> bool {
        mode == DrawMode::Hdlod && self.hdlod.is_some()
    }

    /// Fills the draw list, but for the commands of elements.
    fn select(&mut self, view: &View, time: Time, mode: DrawMode) -> FrameStats {
        let mut stats = FrameStats::default();
        self.list.clear();
        self.section.clear();
        if let Some(culler) = &mut self.culler {
            culler.set_spans(&[]);
        }
        let (Some(scene), Some(pool)) = (&self.scene, &self.pool) else {
            return stats;
        };
        let tree = self.hdlod.as_ref().filter(|_| mode == DrawMode::Hdlod);
        self.looks.set_time(&self.gpu, scene, tree, pool, time);
        let (marks, through) = (self.looks.marks(), self.looks.see_through());
        match (&self.hdlod, mode) {
            (Some(tree), DrawMode::Hdlod) => {
                // What a plane cuts does not fade.
                let mut selection = if self.options.fades() && view.clip.is_none() {
                    let frame = Fading { scene, tree, view, time, marks, through };
                    let (now, length) = (self.started.elapsed(), self.options.fade);
                    fading_cut(&mut self.list, &mut self.fader, &frame, tree, pool, now, length)
                } else {
                    self.fader.clear();
                    cut(scene, tree, view, time, marks)
                };
                stats.fading = self.fader.count();
                self.list.visible.append(&mut selection.elements);
                self.list.cut.append(&mut selection.cut);
                let geometry = pool.clusters.as_ref();
                match self.culler.as_mut().filter(|c| geometry.is_some_and(|g| c.suits(g))) {
                    Some(culler) => {
                        let own = |span: &Span| span.look == LookId::OWN;
                        let (own, marked): (Vec<Span>, Vec<Span>) =
                            selection.spans.iter().partition(|span| own(span));
                        culler.set_spans(&own);
                        self.list.push_spans(&marked, pool.identity, through);
                    }
                    None => self.list.push_spans(&selection.spans, pool.identity, through),
                }
                let hidden = selection.spans.iter().filter(|s| through.hides_look(s.look));
                let hidden = hidden.map(|s| u64::from(s.index_count / 3)).sum::<u64>();
                stats.triangles = selection.triangles.saturating_sub(hidden);
                stats.clusters = selection.clusters;
                stats.visited = selection.visited;
                stats.worst_px = selection.worst_px;
            }
            _ => {
                self.fader.clear();
                self.list.gather_visible(scene, view, time, self.options.culling);
                stats.visited = scene.model.elements.len() as u32;
            }
        }
        let model = &scene.model;
        let before = self.list.visible.len() + self.list.cut.len();
        self.list.push_previews(self.looks.previews(scene, time), scene, view);
        if mode == DrawMode::Hdlod {
            let new = self.list.visible.iter().chain(&self.list.cut).rev();
            let new = new.take(self.list.visible.len() + self.list.cut.len() - before);
            let own = |id: &ElementId| model.triangles_of(&model.elements[id.index()]) as u64;
            stats.triangles += new.map(own).sum::<u64>();
        }
        for elements in [&mut self.list.visible, &mut self.list.cut] {
            for id in elements.extract_if(.., |id| through.hides(*id)) {
                if mode == DrawMode::Hdlod {
                    let own = model.triangles_of(&model.elements[id.index()]) as u64;
                    stats.triangles = stats.triangles.saturating_sub(own);
                }
            }
        }
        stats.elements = (self.list.visible.len() + self.list.cut.len()) as u32;
        stats
    }

    /// Writes and submits the commands of a frame. Says whether clusters were culled.
    fn encode(&mut self, view: &View, time: Time, mode: DrawMode, laps: &mut Laps) -> bool {
        let light = self.options.sun.light(time);
        let uniform = FrameUniform {
            sun: light.toward,
            day: light.day,
            accent: self.selection.color,
            ..FrameUniform::new(view, &self.bounds, self.origin, self.options.edges)
        };
        self.gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&uniform));
        let covered = covered_rectangle(&uniform, &self.bounds, view.tolerance_px);
        laps.end(Pass::Upload);
        let culled = self.cuts(mode) && self.prepare_culling(view, &uniform, covered);
        if self.cuts(mode) && self.culler.is_some() {
            laps.end(Pass::Cull);
        }
        if let (Some(scene), Some(pool)) = (&self.scene, &self.pool) {
            let through = self.looks.see_through();
            self.list.push_elements(&scene.model, &pool.meshes, through);
            self.section.set_elements(&self.list.cut, &scene.model, pool, through);
        }
        let indirect =
            mode != DrawMode::Objects && self.gpu.has(wgpu::Features::INDIRECT_FIRST_INSTANCE);
        let offsets = indirect.then(|| self.write_commands()).flatten();
        laps.end(Pass::Upload);
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        // Only where the scene can be is there anything to smooth or to line.
        let anything = self.list.len() + self.section.layers.len() > 0 || culled;
        let finish = covered
            .filter(|_| anything && (self.passes.smooth.is_some() || self.options.edges > 0.0));
        let from_above = uniform.sees_ground_from_above();
        if culled {
            self.record_culling(&mut encoder, view, &uniform, offsets, covered);
            laps.end(Pass::Cull);
        }
        let glass = covered.filter(|_| self.has_glass(culled));
        let scene = self.scene.as_ref().filter(|_| !self.selection.elements.is_empty());
        let outline = scene
            .and_then(|s| self.selection.choose(s, view, time, &uniform, self.looks.see_through()));
        if let (Some(pool), Some(rectangle), true) =
            (&self.pool, covered, self.section.has_solids())
        {
            let scene = (&self.bindings, &self.scene_group);
            let targets = &self.targets;
            self.section.draw_sums(&self.gpu, &mut encoder, scene, targets, pool, rectangle);
        }
        self.draw_scene(&mut encoder, mode, offsets, culled, from_above);
        laps.end(Pass::Scene);
        if let (Some(_), Some(scene), Some(pool)) = (outline, &self.scene, &self.pool) {
            // What stands behind glass is seen: the mask comes before it.
            let (frame, targets) = (&self.frame, &self.targets);
            self.selection.draw_mask(&self.gpu, &mut encoder, frame, targets, scene, pool);
            laps.end(Pass::Outline);
        }
        if let Some(rectangle) = glass {
            self.draw_glass(&mut encoder, mode, offsets, culled, rectangle);
            laps.end(Pass::Glass);
        }
        if let Some(rectangle) = finish {
            self.draw_finish(&mut encoder, rectangle);
            laps.end(Pass::Finish);
        }
        if let Some(rectangle) = outline {
            let stamps = self.timer.as_ref().and_then(|timer| timer.of_render(Pass::Outline));
            self.selection.draw_line(&mut encoder, &self.targets, rectangle, stamps);
            laps.end(Pass::Outline);
        }
        if let Some(timer) = &mut self.timer {
            timer.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        if let Some(timer) = &mut self.timer {
            timer.submitted();
        }
        laps.end(Pass::Submit);
        culled
    }

    /// The stamps of a render pass of this frame.
    fn stamps(&self, pass: Pass) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.timer.as_ref().and_then(|timer| timer.of_render(pass))
    }

    /// Brings all commands into the indirect buffer with one write. `None` where they do not fit;
    /// they are drawn directly then.
    fn write_commands(&mut self) -> Option<CommandOffsets> {
        let bytes = &mut self.command_bytes;
        bytes.clear();
        let mut push = |commands: &[Command]| {
            let offset = bytes.len() as u64;
            for command in commands {
                bytes.extend_from_slice(command.as_bytes());
            }
            offset
        };
        let offsets = CommandOffsets {
            element_opaque: push(&self.list.elements.opaque),
            element_transparent: push(&self.list.elements.transparent),
            cluster_opaque: push(&self.list.clusters.opaque),
            cluster_transparent: push(&self.list.clusters.transparent),
        };
        let needed = bytes.len() as u64;
        if needed > self.commands.size() {
            let usage = wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
            let room = needed.next_power_of_two();
            match self.gpu.buffer("draw commands", room, usage) {
                Ok(buffer) => self.commands = buffer,
                Err(error) => {
                    tracing::warn!("{error}; drawing without indirect commands");
                    return None;
                }
            }
        }
        if needed > 0 {
            self.gpu.queue.write_buffer(&self.commands, 0, &self.command_bytes);
        }
        Some(offsets)
    }
}

/// The cut of a frame, less what fades, which is brought into the list.
fn fading_cut(
    list: &mut DrawList,
    fader: &mut Fader,
    frame: &Fading<'_>,
    tree: &Arc<Hdlod>,
    pool: &Pool,
    now: Duration,
    length: Duration,
) -> hdlod::Selection {
    let view = View { tolerance_px: frame.view.tolerance_px * fade::TOLERANCE, ..*frame.view };
    let mut selection = cut(frame.scene, tree, &view, frame.time, frame.marks);
    let clusters = selection.drawn.iter().map(|drawn| Node::Cluster(drawn.cluster));
    let cut = clusters.chain(selection.elements.iter().map(|&id| Node::Leaf(id))).collect();
    fader.step(tree, cut, now.as_secs_f64(), length.as_secs_f64());
    if fader.is_active() {
        list.take_fading(fader, frame, pool, &mut selection);
    }
    selection
}

fn cut(
    scene: &Scene,
    tree: &Hdlod,
    view: &View,
    time: Time,
    marks: Option<&Marks>,
) -> hdlod::Selection {
    match marks {
        None => hdlod::select(scene, tree, view, time),
        Some(marks) => hdlod::select_marked(scene, tree, view, time, marks),
    }
}

/// `None` also where there is no room for it.
fn new_culler(gpu: &Gpu, options: Options, samples: u32) -> Option<Culler> {
    Culler::new(gpu, options.occlusion, samples)
        .inspect_err(|error| tracing::warn!("{error}; drawing what nobody sees too"))
        .ok()
        .flatten()
}
