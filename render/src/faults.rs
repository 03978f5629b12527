//! What a device says unasked: that it is gone, that it has no more memory, or that it refuses something.
//!
//! wgpu panics at what nobody listens to. A driver that was updated, a card that was unplugged or a computer
//! that slept takes the device away, and no call says so: [`Faults`] listens.

use crate::gpu::GpuError;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// What went wrong with a device that is still there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Fault {
    /// Something could not be made for want of memory; what was to be drawn with it is missing.
    OutOfMemory(String),
    /// Something was refused, or failed within the driver.
    Refused(String),
}

#[derive(Debug, Default)]
struct Heard {
    lost: OnceLock<String>,
    fault: Mutex<Option<Fault>>,
}

/// What was heard of a device. Cheap to clone; clones hear the same.
#[derive(Clone, Debug, Default)]
pub struct Faults(Arc<Heard>);

impl Faults {
    /// Listens to a device from now on, in place of whoever did before. `wake` is called from any thread, within
    /// calls to the device, whenever there is something to hear; it must not use the device.
    pub fn watch(device: &wgpu::Device, wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self::listen(device, wake, |_| ())
    }

    /// The same where nobody is shown a fault: what is refused is a mistake of this program, and panics.
    pub(crate) fn watch_strictly(device: &wgpu::Device) -> Self {
        Self::listen(
            device,
            || (),
            |fault| {
                assert!(!matches!(fault, Fault::Refused(_)), "the graphics device: {fault:?}");
            },
        )
    }

    fn listen(
        device: &wgpu::Device,
        wake: impl Fn() + Send + Sync + 'static,
        look: impl Fn(&Fault) + Send + Sync + 'static,
    ) -> Self {
        let faults = Self::default();
        let wake = Arc::new(wake);
        let (heard, waken) = (faults.clone(), Arc::clone(&wake));
        device.set_device_lost_callback(move |reason, message| {
            // Those who destroy a device know why; wgpu has nothing to say then.
            let message = match (reason, message.trim()) {
                (wgpu::DeviceLostReason::Destroyed, "") => "it was destroyed",
                (_, "") => "the driver gives no reason",
                (_, message) => message,
            };
            heard.lose(message);
            waken();
        });
        let heard = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let fault = match error {
                wgpu::Error::OutOfMemory { source } => Fault::OutOfMemory(source.to_string()),
                wgpu::Error::Validation { description, .. }
                | wgpu::Error::Internal { description, .. } => Fault::Refused(description),
            };
            // What follows from the loss is nobody's mistake.
            if heard.lost().is_none() {
                look(&fault);
            }
            heard.hear(fault);
            wake();
        }));
        faults
    }

    fn lose(&self, why: &str) {
        tracing::error!("the graphics device was lost: {why}");
        // Only the first reason counts.
        let _ = self.0.lost.set(why.to_owned());
    }

    fn hear(&self, fault: Fault) {
        let mut kept = self.0.fault.lock().unwrap_or_else(PoisonError::into_inner);
        // What fails first is the cause of what follows, unless that is memory.
        if !matches!((&*kept, &fault), (Some(_), Fault::Refused(_))) {
            // Only these are logged: one buffer that is missing is refused hundreds of times a frame.
            tracing::error!("the graphics device: {fault:?}");
            *kept = Some(fault);
        }
    }

    /// Why the device is gone; `None` while it is there.
    pub fn lost(&self) -> Option<&str> {
        self.0.lost.get().map(String::as_str)
    }

    /// Whether what was drawn until now can be relied on.
    ///
    /// # Errors
    /// The loss of the device, or the gravest fault since this was asked last.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        if let Some(why) = self.lost() {
            return Err(GpuError::Failed(format!("the graphics device was lost: {why}")));
        }
        match self.take() {
            Some(Fault::OutOfMemory(reason)) => {
                Err(GpuError::OutOfMemory { what: "the textures of a picture", reason })
            }
            Some(Fault::Refused(what)) => Err(GpuError::Failed(what)),
            None => Ok(()),
        }
    }

    /// The gravest fault since this was asked last.
    pub fn take(&self) -> Option<Fault> {
        self.0.fault.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Gpu;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_destroyed_device_and_what_it_refuses_are_heard_and_nothing_panics() {
        let gpu = Gpu::headless().unwrap();
        let woken = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&woken);
        let faults = Faults::watch(&gpu.device, move || {
            count.fetch_add(1, Ordering::Relaxed);
        });
        assert_eq!((faults.lost(), faults.take()), (None, None));
        let _ = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("too wide"),
            size: wgpu::Extent3d {
                width: gpu.device.limits().max_texture_dimension_2d + 1,
                height: 1,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        assert!(matches!(faults.take(), Some(Fault::Refused(text)) if text.contains("too wide")));
        assert_eq!((faults.take(), woken.load(Ordering::Relaxed)), (None, 1));
        gpu.device.destroy();
        gpu.wait();
        assert_eq!(faults.lost(), Some("it was destroyed"));
        assert_eq!(woken.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn a_picture_of_a_lost_device_is_an_error() {
        let gpu = Gpu::headless().unwrap();
        let mut renderer = crate::Renderer::new(&gpu);
        assert!(renderer.read_back().is_ok());
        gpu.device.destroy();
        let error = renderer.read_back().unwrap_err();
        assert!(matches!(error, GpuError::Failed(_) | GpuError::OutOfMemory { .. }), "{error}");
        assert!(error.to_string().contains("lost"), "{error}");
    }

    #[test]
    fn want_of_memory_outweighs_what_follows_from_it() {
        let faults = Faults::default();
        faults.hear(Fault::Refused("a".to_owned()));
        faults.hear(Fault::OutOfMemory("b".to_owned()));
        faults.hear(Fault::Refused("c".to_owned()));
        let error = faults.check().unwrap_err();
        assert!(matches!(error, GpuError::OutOfMemory { reason, .. } if reason == "b"));
        assert_eq!(faults.check(), Ok(()));
    }
}
