//! The texture the scene is drawn into. The window shows it beside the panel; while nothing changes it is shown again
//! without drawing the scene anew.

use svs_render::{Gpu, Target, wgpu};

/// What the scene is drawn into: colours are sRGB, as in the pictures of `svs render`.
pub(crate) const SCENE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A colour and a depth texture of the viewport's size.
#[derive(Debug)]
pub(crate) struct Canvas {
    /// What to draw into.
    pub(crate) target: Target,
    /// How the panel's library shows it.
    pub(crate) id: egui::TextureId,
    color: wgpu::Texture,
    /// The same bytes, read without conversion: egui wants colours as they are displayed.
    shown: wgpu::Texture,
}

impl Canvas {
    /// A canvas of this size in pixels (at least 1 x 1); `reuse` names a canvas that it replaces.
    pub(crate) fn new(
        gpu: &Gpu,
        egui: &mut egui_wgpu::Renderer,
        size: [u32; 2],
        reuse: Option<egui::TextureId>,
    ) -> Self {
        use wgpu::TextureUsages as Usage;
        let texture = |format, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let color = texture(SCENE_FORMAT, Usage::RENDER_ATTACHMENT | Usage::COPY_SRC);
        let depth = texture(svs_render::DEPTH_FORMAT, Usage::RENDER_ATTACHMENT);
        // A view of another format would do, but OpenGL has none.
        let shown = texture(SCENE_FORMAT.remove_srgb_suffix(), Usage::TEXTURE_BINDING | Usage::COPY_DST);
        let view = shown.create_view(&wgpu::TextureViewDescriptor::default());
        let nearest = wgpu::FilterMode::Nearest;
        let id = match reuse {
            Some(id) => {
                egui.update_egui_texture_from_wgpu_texture(&gpu.device, &view, nearest, id);
                id
            }
            None => egui.register_native_texture(&gpu.device, &view, nearest),
        };
        let target = Target {
            color: color.create_view(&wgpu::TextureViewDescriptor::default()),
            depth: depth.create_view(&wgpu::TextureViewDescriptor::default()),
            width: size[0],
            height: size[1],
        };
        Self { target, id, color, shown }
    }

    /// Makes what was drawn the picture that is shown.
    pub(crate) fn publish(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_texture_to_texture(
            self.color.as_image_copy(),
            self.shown.as_image_copy(),
            self.color.size(),
        );
    }

    /// Width and height, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.target.width, self.target.height]
    }
}
