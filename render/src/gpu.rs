//! The GPU: finding one and talking to it.

use std::future::Future;

use crate::RenderError;

/// Why there is no GPU to draw with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver answers.
    #[error(
        "no GPU found ({reason}); install a Vulkan driver, e.g. the package mesa-vulkan-drivers, which also draws \
         without a GPU, or name another with WGPU_BACKEND=vulkan|dx12|metal|gl"
    )]
    NoAdapter {
        /// The words of wgpu.
        reason: String,
    },
    /// `WGPU_ADAPTER_NAME` names none of the GPUs there are.
    #[error("WGPU_ADAPTER_NAME={wanted} names no GPU of this machine; there are: {found}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// What there is.
        found: String,
    },
    /// The driver gives no device.
    #[error(
        "{adapter} cannot be used ({reason}); update its driver or choose another with WGPU_ADAPTER_NAME"
    )]
    NoDevice {
        /// Description of the GPU.
        adapter: String,
        /// The words of wgpu.
        reason: String,
    },
}

/// A GPU in use.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance of wgpu it belongs to.
    pub instance: wgpu::Instance,
    /// Which GPU and driver.
    pub adapter: wgpu::Adapter,
    /// Makes buffers, textures and pipelines.
    pub device: wgpu::Device,
    /// Takes commands.
    pub queue: wgpu::Queue,
}

impl Gpu {
    /// A GPU without a window: hardware where there is some, else a software driver. Waits for it.
    /// `WGPU_BACKEND` and `WGPU_ADAPTER_NAME` (a part of a name) choose another.
    ///
    /// # Errors
    /// When no driver answers; the text says what to install.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn headless() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        pollster::block_on(Self::new(instance, None))
    }

    /// A GPU that can show on `surface`, if one is given.
    ///
    /// # Errors
    /// When no driver answers; the text says what to install.
    pub async fn new(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let adapter = match std::env::var("WGPU_ADAPTER_NAME") {
            Ok(wanted) if !wanted.is_empty() => named(&instance, surface, wanted).await?,
            _ => any(&instance, surface).await?,
        };
        // What WebGL2 grants is all that is used; sizes go up to what the driver has.
        let available = adapter.limits();
        let mut limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(available.clone());
        limits.max_buffer_size = available.max_buffer_size;
        let device = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("svs"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: limits,
            ..Default::default()
        });
        let (device, queue) = device.await.map_err(|error| GpuError::NoDevice {
            adapter: describe(&adapter.get_info()),
            reason: error.to_string(),
        })?;
        Ok(Self { instance, adapter, device, queue })
    }

    /// Name and interface, such as "llvmpipe (LLVM 15.0.6, 256 bits), Vulkan".
    pub fn description(&self) -> String {
        describe(&self.adapter.get_info())
    }

    /// Runs `work` and turns what the driver refused meanwhile into an error. In browsers, which answer later, errors
    /// go to the console instead.
    pub(crate) fn guarded<T>(&self, work: impl FnOnce() -> Result<T, RenderError>) -> Result<T, RenderError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let validation = ready(validation.pop()).flatten();
        let memory = ready(memory.pop()).flatten();
        // Memory first: what could not be made is then refused as invalid too.
        match memory.or(validation) {
            Some(error) => Err(RenderError::from_wgpu(&error)),
            None => result,
        }
    }
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    format!("{}, {:?}", info.name, info.backend)
}

/// Hardware before software, and of two ways to one GPU not OpenGL: wgpu itself takes the first it finds.
#[cfg(not(target_arch = "wasm32"))]
async fn any(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
) -> Result<wgpu::Adapter, GpuError> {
    let saves_power = wgpu::PowerPreference::from_env() == Some(wgpu::PowerPreference::LowPower);
    let rank = |adapter: &wgpu::Adapter| {
        let info = adapter.get_info();
        let device = match info.device_type {
            wgpu::DeviceType::DiscreteGpu if !saves_power => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::DiscreteGpu => 2,
            wgpu::DeviceType::VirtualGpu => 3,
            wgpu::DeviceType::Other => 4,
            wgpu::DeviceType::Cpu => 5,
        };
        (device, info.backend == wgpu::Backend::Gl)
    };
    let all = instance.enumerate_adapters(wgpu::Backends::all()).await;
    let usable =
        |adapter: &wgpu::Adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface));
    let best = all.into_iter().filter(usable).min_by_key(rank);
    best.ok_or_else(|| GpuError::NoAdapter { reason: "no driver answers".to_owned() })
}

#[cfg(target_arch = "wasm32")]
async fn any(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
) -> Result<wgpu::Adapter, GpuError> {
    let options = wgpu::RequestAdapterOptions { compatible_surface: surface, ..Default::default() };
    let adapter = instance.request_adapter(&options).await;
    adapter.map_err(|error| GpuError::NoAdapter { reason: error.to_string() })
}

async fn named(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    wanted: String,
) -> Result<wgpu::Adapter, GpuError> {
    let mut found = Vec::new();
    for adapter in instance.enumerate_adapters(wgpu::Backends::all()).await {
        if surface.is_some_and(|surface| !adapter.is_surface_supported(surface)) {
            continue;
        }
        let info = adapter.get_info();
        if info.name.to_lowercase().contains(&wanted.to_lowercase()) {
            return Ok(adapter);
        }
        found.push(describe(&info));
    }
    let found = if found.is_empty() { "none".to_owned() } else { found.join("; ") };
    Err(GpuError::NoSuchAdapter { wanted, found })
}

/// The answer of a future that is there already, as error scopes are outside browsers.
fn ready<T>(future: impl Future<Output = T>) -> Option<T> {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match future.as_mut().poll(&mut context) {
        std::task::Poll::Ready(value) => Some(value),
        std::task::Poll::Pending => None,
    }
}
