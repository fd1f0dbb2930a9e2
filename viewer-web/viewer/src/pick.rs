//! Which object is at a pixel: drawn as numbers, read back when the browser has them.

use crate::surface::texture;
use std::cell::Cell;
use std::rc::Rc;
use svs_render::{DEPTH_FORMAT, Frame, Gpu, GpuScene, ITEM_FORMAT, ItemTarget, NO_ITEM, Renderer, wgpu};

/// Bytes from one of the two numbers to the other: copies begin on multiples of it.
const APART: u64 = 256;

/// A question on its way.
#[derive(Debug)]
pub(crate) struct Pick {
    buffer: wgpu::Buffer,
    /// `Some(false)`: the GPU could not read it back.
    done: Rc<Cell<Option<bool>>>,
}

impl Pick {
    /// Asks for a pixel (in range) of an image of this size.
    pub(crate) fn start(
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &GpuScene,
        frame: &Frame<'_>,
        size: [u32; 2],
        pixel: [u32; 2],
    ) -> Self {
        let layers = [(); 2].map(|()| texture(gpu, size, ITEM_FORMAT));
        let target = ItemTarget {
            nearest: layers[0].create_view(&Default::default()),
            transparent: layers[1].create_view(&Default::default()),
            depth: texture(gpu, size, DEPTH_FORMAT).create_view(&Default::default()),
            width: size[0],
            height: size[1],
        };
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pick"),
            size: 2 * APART,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.draw_items(gpu, scene, frame, &target, &mut encoder);
        for (layer, offset) in layers.iter().zip([0, APART]) {
            let mut from = layer.as_image_copy();
            from.origin = wgpu::Origin3d { x: pixel[0], y: pixel[1], z: 0 };
            let layout =
                wgpu::TexelCopyBufferLayout { offset, bytes_per_row: Some(256), rows_per_image: None };
            let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            let one = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
            encoder.copy_texture_to_buffer(from, to, one);
        }
        gpu.queue.submit([encoder.finish()]);
        let done = Rc::new(Cell::new(None));
        let answer = Sent(Rc::clone(&done));
        buffer.map_async(wgpu::MapMode::Read, .., move |result| answer.set(result.is_ok()));
        Self { buffer, done }
    }

    /// The id at the pixel, glass before what is behind it; `None` while the GPU is at it. Inside: `None` for the sky.
    pub(crate) fn answer(&self) -> Option<Option<u32>> {
        if !self.done.get()? {
            return Some(None);
        }
        let Ok(bytes) = self.buffer.get_mapped_range(..) else { return Some(None) };
        let at = |offset: u64| {
            let word = bytes.get(offset as usize..offset as usize + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(word)).filter(|&id| id != NO_ITEM)
        };
        Some(at(APART).or_else(|| at(0)))
    }
}

/// There is one thread only, but wgpu wants to be able to send callbacks to others.
struct Sent(Rc<Cell<Option<bool>>>);

impl Sent {
    fn set(self, ok: bool) {
        self.0.set(Some(ok));
    }
}
