//! Everything on the GPU: uploads, passes, timing, read-back.
//!
//! A [`Renderer`] lives long and holds one scene; every frame it is told what to show
//! ([`FrameInput`]), draws it offscreen and says what it did ([`FrameStats`]). It knows nothing of
//! windows: a window composites [`Renderer::color_view`], the command line reads it back.

mod cull;
mod draw_list;
mod fade;
mod faults;
mod frame;
mod gpu;
mod input;
mod looks;
mod passes;
mod pool;
mod readback;
mod renderer;
mod section;
mod selection;
mod shader;
mod sun;
mod targets;
mod timing;

pub use faults::{Fault, Faults};
pub use gpu::{Gpu, GpuError, device_descriptor, instance_descriptor};
pub use input::{Antialias, Backdrop, DrawMode, FrameInput, FrameStats, Occlusion, Options};
pub use readback::Picture;
pub use renderer::Renderer;
pub use shader::{ShaderError, ShaderFolder};
pub use sun::Sun;
pub use timing::{FrameTimings, GpuTimes, Pass, PassTime};

#[cfg(test)]
mod tests;
