//! The device: found without a window, or taken over from one.

use crate::faults::Faults;
use crate::shader::ShaderTexts;
use pollster::block_on;

/// Why there is no device, or why something does not fit on it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No adapter answers. The command line ends with code 3.
    #[error(
        "no graphics adapter found ({0}); install a driver, for pictures without a graphics card \
         a software one such as Mesa's lavapipe (Debian: mesa-vulkan-drivers)"
    )]
    NoAdapter(String),
    /// The adapter refuses to work.
    #[error("the graphics adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// More data than one buffer can hold.
    #[error("{what} need {bytes} bytes on the GPU, and the adapter allows {limit}")]
    TooBig {
        /// What was to be uploaded.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The adapter's limit.
        limit: u64,
    },
    /// The driver could not provide the memory.
    #[error("out of GPU memory while uploading {what}: {reason}")]
    OutOfMemory {
        /// What was to be uploaded.
        what: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// The device answered something that it should not.
    #[error("the GPU failed: {0}")]
    Failed(String),
}

/// A device with its queue and what is known of it. Cheap to clone; clones share the device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its only queue.
    pub queue: wgpu::Queue,
    /// Name, kind and driver of the adapter.
    pub info: wgpu::AdapterInfo,
    pub(crate) shaders: ShaderTexts,
    /// What the device said unasked; nothing where a window listens.
    pub(crate) faults: Faults,
}

/// Everything that is used where it exists. Nothing of it is required.
fn wanted_features() -> wgpu::Features {
    wgpu::Features::INDIRECT_FIRST_INSTANCE
        | wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
        | wgpu::Features::MULTI_DRAW_INDIRECT_COUNT
}

/// What to ask of an adapter: the optional features that it has and all that it can hold.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("topout device"),
        required_features: wanted_features() & adapter.features(),
        required_limits: adapter.limits(),
        ..Default::default()
    }
}

/// How to start wgpu without a window. A release build does not have every indirect draw checked
/// by a compute pass: the commands are written by this crate alone, and the check costs ten times
/// the encoding of a large multi-draw.
pub fn instance_descriptor() -> wgpu::InstanceDescriptor {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    if !cfg!(debug_assertions) && std::env::var_os("WGPU_VALIDATION_INDIRECT_CALL").is_none() {
        descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    }
    descriptor
}

/// Smaller is better: real devices before the CPU, native interfaces before GL.
fn rank(info: &wgpu::AdapterInfo) -> (u8, u8) {
    let device = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    (device, u8::from(info.backend == wgpu::Backend::Gl))
}

impl Gpu {
    /// Opens the best adapter without a window: hardware first, software where there is none.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where nothing answers; [`GpuError::NoDevice`] where every adapter
    /// refuses.
    pub fn headless() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(instance_descriptor());
        let mut adapters = block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        adapters.retain(|a| a.get_info().backend != wgpu::Backend::Noop);
        adapters.sort_by_key(|a| rank(&a.get_info()));
        let mut refused = None;
        for adapter in adapters {
            match Self::from_adapter(&adapter) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => {
                    tracing::warn!("{error}");
                    refused.get_or_insert(error);
                }
            }
        }
        Err(refused.unwrap_or_else(|| {
            GpuError::NoAdapter("neither Vulkan, Metal, DirectX 12 nor GL".to_owned())
        }))
    }

    fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let (device, queue) =
            block_on(adapter.request_device(&device_descriptor(adapter))).map_err(|e| {
                GpuError::NoDevice { adapter: info.name.clone(), reason: e.to_string() }
            })?;
        let faults = Faults::watch_strictly(&device);
        Ok(Self { faults, ..Self::from_parts(device, queue, info) })
    }

    /// Takes over a device that a window has opened; see [`device_descriptor`] for how.
    pub fn from_parts(device: wgpu::Device, queue: wgpu::Queue, info: wgpu::AdapterInfo) -> Self {
        let (shaders, faults) = (ShaderTexts::default(), Faults::default());
        Self { device, queue, info, shaders, faults }
    }

    /// Whether the adapter is a program on the CPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether the device has an optional feature.
    pub(crate) fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }

    /// Creates a buffer, or says why it cannot be.
    ///
    /// # Errors
    /// [`GpuError::TooBig`] above the device's limit, [`GpuError::OutOfMemory`] if the driver
    /// refuses.
    pub(crate) fn buffer(
        &self,
        label: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let limits = self.device.limits();
        let mut limit = limits.max_buffer_size;
        if usage.contains(wgpu::BufferUsages::STORAGE) {
            limit = limit.min(limits.max_storage_buffer_binding_size);
        }
        if bytes > limit {
            return Err(GpuError::TooBig { what: label, bytes, limit });
        }
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            // A binding of nothing is not allowed.
            size: bytes.max(16),
            usage,
            mapped_at_creation: false,
        });
        match block_on(scope.pop()) {
            Some(error) => Err(GpuError::OutOfMemory { what: label, reason: error.to_string() }),
            None => Ok(buffer),
        }
    }

    /// Waits until everything submitted is done.
    pub(crate) fn wait(&self) {
        if let Err(error) = self.device.poll(wgpu::PollType::wait_indefinitely()) {
            tracing::error!("waiting for the GPU failed: {error}");
        }
    }
}
