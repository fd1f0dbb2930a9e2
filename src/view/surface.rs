//! The window's surface: what is presented.

use super::ViewError;
use std::sync::Arc;
use svs_render::{Gpu, wgpu};
use winit::dpi::PhysicalSize;
use winit::window::Window;

/// A configured surface that survives resizing, minimising and loss.
pub(crate) struct WindowSurface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    window: Arc<Window>,
    /// False while the window has no pixels.
    usable: bool,
}

impl WindowSurface {
    /// Configures a surface for a window.
    pub(crate) fn new(
        gpu: &Gpu,
        surface: wgpu::Surface<'static>,
        window: Arc<Window>,
    ) -> Result<Self, ViewError> {
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let format = choose_format(&capabilities.formats).ok_or_else(|| ViewError::NoSurfaceFormat {
            adapter: gpu.description(),
            formats: format!("{:?}", capabilities.formats),
        })?;
        let mut usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        // Screenshots are copies of what was presented.
        usage |= capabilities.usages & wgpu::TextureUsages::COPY_SRC;
        let size = window.inner_size();
        let config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .map(|config| wgpu::SurfaceConfiguration { format, usage, ..config })
            .ok_or_else(|| ViewError::NoSurfaceFormat {
                adapter: gpu.description(),
                formats: "none".to_owned(),
            })?;
        let mut this = Self { surface, config, window, usable: false };
        this.resize(gpu, size);
        Ok(this)
    }

    /// Format of what is presented.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Width and height, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The window has pixels to draw on.
    pub(crate) fn is_usable(&self) -> bool {
        self.usable
    }

    /// The surface's texture can be read back.
    pub(crate) fn copyable(&self) -> bool {
        self.config.usage.contains(wgpu::TextureUsages::COPY_SRC)
    }

    /// The window has another size; 0 x 0 when minimised.
    pub(crate) fn resize(&mut self, gpu: &Gpu, size: PhysicalSize<u32>) {
        self.usable = size.width > 0 && size.height > 0;
        if self.usable {
            let largest = gpu.device.limits().max_texture_dimension_2d;
            (self.config.width, self.config.height) = (size.width.min(largest), size.height.min(largest));
            self.surface.configure(&gpu.device, &self.config);
        }
    }

    /// The texture to draw the next frame into; `None` when there is nothing to draw on now.
    pub(crate) fn acquire(&mut self, gpu: &Gpu) -> Result<Option<wgpu::SurfaceTexture>, ViewError> {
        use wgpu::CurrentSurfaceTexture as Current;
        if !self.usable {
            return Ok(None);
        }
        // A surface that was lost or outdated is made anew once; the next frame tries again.
        match self.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => Ok(Some(texture)),
            Current::Timeout | Current::Occluded => Ok(None),
            Current::Lost => {
                self.surface = gpu
                    .instance
                    .create_surface(Arc::clone(&self.window))
                    .map_err(|error| ViewError::Surface(error.to_string()))?;
                self.resize(gpu, self.window.inner_size());
                self.window.request_redraw();
                Ok(None)
            }
            Current::Outdated | Current::Validation => {
                self.resize(gpu, self.window.inner_size());
                self.window.request_redraw();
                Ok(None)
            }
        }
    }
}

/// Eight bits a channel, without sRGB conversion if there is the choice: the scene arrives here converted already, and
/// egui blends in the space of the display.
fn choose_format(formats: &[wgpu::TextureFormat]) -> Option<wgpu::TextureFormat> {
    use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb};
    [Rgba8Unorm, Bgra8Unorm, Rgba8UnormSrgb, Bgra8UnormSrgb]
        .into_iter()
        .find(|format| formats.contains(format))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as Format;

    #[test]
    fn only_formats_of_eight_bits_are_chosen() {
        assert_eq!(choose_format(&[Format::Bgra8UnormSrgb, Format::Bgra8Unorm]), Some(Format::Bgra8Unorm));
        assert_eq!(
            choose_format(&[Format::Rgba16Float, Format::Bgra8UnormSrgb]),
            Some(Format::Bgra8UnormSrgb)
        );
        assert_eq!(choose_format(&[Format::Rgba16Float]), None);
    }
}
