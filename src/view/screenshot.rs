//! Pictures of the window.

use super::ViewError;
use std::path::Path;
use svs_render::{Gpu, wgpu};

/// Reads a texture of eight bits a channel back and writes it as PNG. Waits for the GPU.
pub(crate) fn save(gpu: &Gpu, texture: &wgpu::Texture, path: &Path) -> Result<(), ViewError> {
    let failed = |message: String| ViewError::Write { path: path.to_owned(), message };
    let (width, height) = (texture.width(), texture.height());
    let row = width * 4;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("screenshot"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
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
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    let blue_first = matches!(texture.format().remove_srgb_suffix(), wgpu::TextureFormat::Bgra8Unorm);
    let mut rgb = Vec::with_capacity(width as usize * height as usize * 3);
    for line in mapped.chunks(padded as usize) {
        for texel in line[..row as usize].chunks(4) {
            // A window is opaque, whatever its alpha says.
            let [a, b, c] = [texel[0], texel[1], texel[2]];
            rgb.extend(if blue_first { [c, b, a] } else { [a, b, c] });
        }
    }
    let picture = image::RgbImage::from_raw(width, height, rgb)
        .ok_or_else(|| failed("the picture has another size than its texture".to_owned()))?;
    picture.save_with_format(path, image::ImageFormat::Png).map_err(|error| failed(error.to_string()))
}
