//! The textures that a frame is drawn into.

use crate::gpu::Gpu;
use crate::passes::{DEPTH_FORMAT, SCENE_FORMAT};
use glam::UVec2;
use wgpu::TextureUsages;

/// A texture and the view of all of it.
#[derive(Debug)]
pub(crate) struct Target {
    pub texture: wgpu::Texture,
    pub view: wgpu::TextureView,
}

impl Target {
    pub fn new(
        gpu: &Gpu,
        label: &str,
        format: wgpu::TextureFormat,
        size: UVec2,
        samples: u32,
        usage: TextureUsages,
    ) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let view = texture
            .create_view(&wgpu::TextureViewDescriptor { label: Some(label), ..Default::default() });
        Self { texture, view }
    }

    /// From a pixel on.
    pub fn part(&self, x: u32, y: u32) -> wgpu::TexelCopyTextureInfo<'_> {
        let origin = wgpu::Origin3d { x, y, z: 0 };
        wgpu::TexelCopyTextureInfo { origin, ..self.texture.as_image_copy() }
    }
}

/// Textures of one size.
#[derive(Debug)]
pub(crate) struct Targets {
    pub size: UVec2,
    pub samples: u32,
    /// Several samples a pixel; only where there is more than one.
    pub many: Option<Target>,
    /// What is shown, one sample a pixel.
    pub scene: Target,
    pub depth: Target,
    /// Beside the picture: a copy that glass is drawn over, then where a part is smoothed.
    pub beside: Target,
}

impl Targets {
    pub fn new(gpu: &Gpu, size: UVec2, samples: u32) -> Self {
        let attachment = TextureUsages::RENDER_ATTACHMENT;
        let copied = TextureUsages::COPY_SRC | TextureUsages::COPY_DST;
        let readable = attachment | TextureUsages::TEXTURE_BINDING | copied;
        let target =
            |label, format, samples, usage| Target::new(gpu, label, format, size, samples, usage);
        let depth_usage = attachment | TextureUsages::TEXTURE_BINDING;
        Self {
            size,
            samples,
            many: (samples > 1).then(|| target("scene samples", SCENE_FORMAT, samples, attachment)),
            scene: target("scene", SCENE_FORMAT, 1, readable),
            depth: target("depth", DEPTH_FORMAT, samples, depth_usage),
            beside: target("beside the picture", SCENE_FORMAT, 1, readable),
        }
    }

    /// Bytes on the GPU, four a sample.
    pub fn bytes(&self) -> u64 {
        let pixels = u64::from(self.size.x) * u64::from(self.size.y);
        let samples = u64::from(self.samples);
        let many = if self.many.is_some() { samples } else { 0 };
        pixels * 4 * (2 + samples + many)
    }
}
