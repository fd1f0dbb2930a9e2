//! Textures and samplers on the GPU.

use std::collections::HashMap;

use crate::class::TextureSet;
use crate::pipeline::Layouts;
use crate::{Filter, Gpu, Image, Sampler, TextureRef, Wrap, mipmap};

/// One bind group per texture set, and the bytes all textures take.
pub(crate) fn upload(
    gpu: &Gpu,
    layouts: &Layouts,
    images: &[Image],
    sets: &[TextureSet],
) -> (Vec<wgpu::BindGroup>, u64) {
    let mut store = Store { gpu, images, views: HashMap::new(), samplers: HashMap::new(), bytes: 0 };
    let white = Image { width: 1, height: 1, rgba: vec![255; 4] };
    let white = store.texture(&white, false);
    let groups = sets.iter().map(|set| store.bind_group(layouts, set, &white)).collect();
    (groups, store.bytes)
}

struct Store<'a> {
    gpu: &'a Gpu,
    images: &'a [Image],
    /// By image and whether it holds sRGB colours.
    views: HashMap<(u32, bool), wgpu::TextureView>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    bytes: u64,
}

impl Store<'_> {
    fn bind_group(
        &mut self,
        layouts: &Layouts,
        set: &TextureSet,
        white: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let pairs: Vec<_> = set
            .iter()
            .zip([true, false, true])
            .map(|(texture, srgb)| {
                let view = texture.map_or_else(|| white.clone(), |texture| self.view(texture, srgb));
                (view, self.sampler(texture.map_or_else(Sampler::default, |texture| texture.sampler)))
            })
            .collect();
        let entries: Vec<_> = (0u32..)
            .zip(&pairs)
            .flat_map(|(i, (view, sampler))| {
                [
                    wgpu::BindGroupEntry {
                        binding: 2 * i,
                        resource: wgpu::BindingResource::TextureView(view),
                    },
                    wgpu::BindGroupEntry {
                        binding: 2 * i + 1,
                        resource: wgpu::BindingResource::Sampler(sampler),
                    },
                ]
            })
            .collect();
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("textures"),
            layout: &layouts.textures,
            entries: &entries,
        })
    }

    fn view(&mut self, texture: TextureRef, srgb: bool) -> wgpu::TextureView {
        if let Some(view) = self.views.get(&(texture.image, srgb)) {
            return view.clone();
        }
        let images = self.images;
        let view = self.texture(&images[texture.image as usize], srgb);
        self.views.insert((texture.image, srgb), view.clone());
        view
    }

    /// The image and its smaller versions; what is larger than the GPU takes is left out.
    fn texture(&mut self, image: &Image, srgb: bool) -> wgpu::TextureView {
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let smaller = mipmap::smaller(image, srgb);
        let levels: Vec<&Image> = std::iter::once(image)
            .chain(&smaller)
            .filter(|level| level.width.max(level.height) <= most)
            .collect();
        let first = levels[0];
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("image"),
            size: wgpu::Extent3d { width: first.width, height: first.height, depth_or_array_layers: 1 },
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: if srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm },
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (mip_level, level) in (0u32..).zip(&levels) {
            write(&self.gpu.queue, &texture, mip_level, level.width, level.height, &level.rgba);
            self.bytes += level.rgba.len() as u64;
        }
        texture.create_view(&Default::default())
    }

    fn sampler(&mut self, sampler: Sampler) -> wgpu::Sampler {
        let wrap = |wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        };
        let filter = |filter| match filter {
            Filter::Linear => wgpu::FilterMode::Linear,
            Filter::Nearest => wgpu::FilterMode::Nearest,
        };
        let device = &self.gpu.device;
        let new = || {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("sampler"),
                address_mode_u: wrap(sampler.wrap_u),
                address_mode_v: wrap(sampler.wrap_v),
                mag_filter: filter(sampler.magnify),
                min_filter: filter(sampler.minify),
                mipmap_filter: match sampler.minify {
                    Filter::Linear => wgpu::MipmapFilterMode::Linear,
                    Filter::Nearest => wgpu::MipmapFilterMode::Nearest,
                },
                ..Default::default()
            })
        };
        self.samplers.entry(sampler).or_insert_with(new).clone()
    }
}

/// Writes one level of a texture of four bytes a texel.
pub(crate) fn write(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    mip_level: u32,
    width: u32,
    height: u32,
    rgba: &[u8],
) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
        rgba,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
