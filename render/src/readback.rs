//! From the GPU back into memory.

use crate::gpu::{Gpu, GpuError};
use wgpu::BufferUsages;

/// A picture in memory.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Rows from the top, four bytes a pixel: sRGB red, green, blue, then 255 where an element is
    /// shown and 0 where there is only the backdrop.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// The four bytes of a pixel; (0, 0) is the upper left one.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "({x}, {y}) is outside the picture");
        let at = (y as usize * self.width as usize + x as usize) * 4;
        std::array::from_fn(|i| self.rgba[at + i])
    }
}

/// The bytes of a texture of four bytes a pixel, rows without padding.
pub(crate) fn texture_bytes(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
    // Whoever lost the device wants to hear that, not what followed from it.
    let _ = gpu.device.poll(wgpu::PollType::Poll);
    gpu.faults.check()?;
    let size = texture.size();
    let row = size.width * 4;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let buffer =
        gpu.buffer("picture read back", u64::from(padded) * u64::from(size.height), usage)?;
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        size,
    );
    gpu.queue.submit([encoder.finish()]);
    let (send, receive) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver only goes away together with the whole read-back.
        let _ = send.send(result);
    });
    gpu.wait();
    gpu.faults.check()?;
    match receive.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(GpuError::Failed(error.to_string())),
        Err(_) => return Err(GpuError::Failed("reading back was never finished".to_owned())),
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| GpuError::Failed(e.to_string()))?;
    Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}
