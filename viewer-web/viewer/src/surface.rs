//! The canvas as something to draw on.

use svs_render::{DEPTH_FORMAT, Gpu, Target, wgpu};
use wasm_bindgen::JsError;

/// A configured canvas and its depth buffer.
#[derive(Debug)]
pub(crate) struct CanvasSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// What the renderer writes: with sRGB encoding, whatever the canvas itself is.
    format: wgpu::TextureFormat,
    depth: wgpu::TextureView,
}

impl CanvasSurface {
    pub(crate) fn new(gpu: &Gpu, surface: wgpu::Surface<'static>, size: [u32; 2]) -> Result<Self, JsError> {
        let [width, height] = size.map(|side| side.max(1));
        let config = surface.get_default_config(&gpu.adapter, width, height);
        let mut config = config.ok_or_else(|| JsError::new("the GPU cannot draw on a canvas"))?;
        // WebGPU has canvases without encoding alone, and views of them with it; WebGL2 has such canvases.
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let plain = config.format.remove_srgb_suffix();
        let format = plain.add_srgb_suffix();
        if capabilities.formats.contains(&format) {
            config.format = format;
        } else {
            config.format = plain;
            config.view_formats = vec![format];
        }
        config.present_mode = wgpu::PresentMode::Fifo;
        surface.configure(&gpu.device, &config);
        let depth = depth(gpu, width, height);
        Ok(Self { surface, config, format, depth })
    }

    /// Format of what is drawn.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Width and height, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The canvas has another size.
    pub(crate) fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        let largest = gpu.device.limits().max_texture_dimension_2d;
        let size = size.map(|side| side.clamp(1, largest));
        if size != self.size() {
            [self.config.width, self.config.height] = size;
            self.surface.configure(&gpu.device, &self.config);
            self.depth = depth(gpu, size[0], size[1]);
        }
    }

    /// What to draw the next frame into, and what to present then; `None` when there is nothing to draw on now.
    pub(crate) fn acquire(&mut self, gpu: &Gpu) -> Option<(wgpu::SurfaceTexture, Target)> {
        use wgpu::CurrentSurfaceTexture as Current;
        let texture = match self.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => texture,
            Current::Timeout | Current::Occluded => return None,
            Current::Lost | Current::Outdated | Current::Validation => {
                self.surface.configure(&gpu.device, &self.config);
                return None;
            }
        };
        let view = wgpu::TextureViewDescriptor { format: Some(self.format), ..Default::default() };
        let target = Target {
            color: texture.texture.create_view(&view),
            depth: self.depth.clone(),
            width: self.config.width,
            height: self.config.height,
        };
        Some((texture, target))
    }
}

pub(crate) fn texture(gpu: &Gpu, [width, height]: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn depth(gpu: &Gpu, width: u32, height: u32) -> wgpu::TextureView {
    texture(gpu, [width, height], DEPTH_FORMAT).create_view(&Default::default())
}
