//! Pictures without a window. Not in browsers, where nothing can wait for the GPU.

use std::time::Instant;

use crate::batch::DrawStatistics;
use crate::pipeline::{DEPTH_FORMAT, ITEM_FORMAT};
use crate::{Frame, Gpu, GpuScene, Image, ItemTarget, RenderError, Renderer, Target};

const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// What one frame took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTime {
    /// Batching, encoding and handing over, milliseconds.
    pub cpu_ms: f64,
    /// Between the GPU's timestamps around the drawing, milliseconds; None where it has none.
    pub gpu_ms: Option<f64>,
    /// From the beginning of batching until the GPU is done, milliseconds.
    pub wall_ms: f64,
    /// What was drawn.
    pub statistics: DrawStatistics,
}

/// Which object is seen where, rows from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ItemBuffer {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Per pixel: the nearest opaque or masked object, or [`NO_ITEM`](crate::NO_ITEM).
    pub nearest: Vec<u32>,
    /// Per pixel: the nearest blended object in front of it, or [`NO_ITEM`](crate::NO_ITEM).
    pub transparent: Vec<u32>,
}

/// A picture of fixed size in GPU memory and what is needed to read it; reused between frames.
#[derive(Debug)]
pub struct Offscreen {
    color: wgpu::Texture,
    depth: wgpu::Texture,
    /// Made when items are first asked for.
    items: Option<[wgpu::Texture; 2]>,
    read_back: wgpu::Buffer,
    timer: Option<Timer>,
}

#[derive(Debug)]
struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_back: wgpu::Buffer,
}

impl Timer {
    fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |usage| {
            let label = Some("timestamps");
            let (size, mapped_at_creation) = (16, false);
            gpu.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation })
        };
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            read_back: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        })
    }
}

fn row_bytes(width: u32) -> u32 {
    (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

impl Offscreen {
    /// A picture of `width` times `height` pixels.
    ///
    /// # Errors
    /// When the size is 0 or more than the GPU takes.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, RenderError> {
        let most = gpu.device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 {
            return Err(RenderError::Data { what: "picture", index: 0, problem: "it has no pixels" });
        }
        if width.max(height) > most {
            return Err(RenderError::TooLarge {
                what: "pixels along an edge of the picture",
                needed: u64::from(width.max(height)),
                available: u64::from(most),
                advice: "draw a smaller picture",
            });
        }
        gpu.guarded(|| {
            let size = u64::from(row_bytes(width)) * u64::from(height) * 2;
            Ok(Self {
                color: texture(gpu, width, height, COLOR_FORMAT),
                depth: texture(gpu, width, height, DEPTH_FORMAT),
                items: None,
                read_back: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("read back"),
                    size,
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                }),
                timer: Timer::new(gpu),
            })
        })
    }

    /// A renderer that fits.
    pub fn renderer(gpu: &Gpu) -> Renderer {
        Renderer::new(gpu, COLOR_FORMAT)
    }

    fn target(&self) -> Target {
        Target {
            color: self.color.create_view(&Default::default()),
            depth: self.depth.create_view(&Default::default()),
            width: self.color.width(),
            height: self.color.height(),
        }
    }

    /// Draws a frame and reads it back: sRGB, rows from the top.
    ///
    /// # Errors
    /// When the GPU fails.
    pub fn image(
        &mut self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &GpuScene,
        frame: &Frame<'_>,
    ) -> Result<Image, RenderError> {
        gpu.guarded(|| {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            renderer.draw(gpu, scene, frame, &self.target(), &mut encoder);
            self.copy(&mut encoder, &self.color, 0);
            gpu.queue.submit([encoder.finish()]);
            let rgba = self.read(gpu, 1)?.remove(0);
            Ok(Image { width: self.color.width(), height: self.color.height(), rgba })
        })
    }

    /// Draws the ids of objects and reads them back.
    ///
    /// # Errors
    /// When the GPU fails.
    pub fn items(
        &mut self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &GpuScene,
        frame: &Frame<'_>,
    ) -> Result<ItemBuffer, RenderError> {
        let (width, height) = (self.color.width(), self.color.height());
        gpu.guarded(|| {
            let [nearest, transparent] = self
                .items
                .get_or_insert_with(|| [(); 2].map(|()| texture(gpu, width, height, ITEM_FORMAT)))
                .clone();
            let target = ItemTarget {
                nearest: nearest.create_view(&Default::default()),
                transparent: transparent.create_view(&Default::default()),
                depth: self.depth.create_view(&Default::default()),
                width,
                height,
            };
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            renderer.draw_items(gpu, scene, frame, &target, &mut encoder);
            self.copy(&mut encoder, &nearest, 0);
            self.copy(&mut encoder, &transparent, 1);
            gpu.queue.submit([encoder.finish()]);
            let ids = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect();
            let layers = self.read(gpu, 2)?;
            Ok(ItemBuffer { width, height, nearest: ids(&layers[0]), transparent: ids(&layers[1]) })
        })
    }

    /// Draws a frame and waits for the GPU; nothing is read back but the time.
    ///
    /// # Errors
    /// When the GPU fails.
    pub fn time(
        &mut self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &GpuScene,
        frame: &Frame<'_>,
    ) -> Result<FrameTime, RenderError> {
        gpu.guarded(|| {
            let target = self.target();
            let begin = Instant::now();
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let writes = self.timer.as_ref().map(|timer| wgpu::RenderPassTimestampWrites {
                query_set: &timer.queries,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            });
            let statistics = renderer.draw_timed(gpu, scene, frame, &target, &mut encoder, writes);
            if let Some(timer) = &self.timer {
                encoder.resolve_query_set(&timer.queries, 0..2, &timer.resolved, 0);
                encoder.copy_buffer_to_buffer(&timer.resolved, 0, &timer.read_back, 0, 16);
            }
            gpu.queue.submit([encoder.finish()]);
            let cpu_ms = begin.elapsed().as_secs_f64() * 1e3;
            wait(gpu)?;
            let wall_ms = begin.elapsed().as_secs_f64() * 1e3;
            let gpu_ms = match &self.timer {
                Some(timer) => Some(self.ticks(gpu, timer)?),
                None => None,
            };
            Ok(FrameTime { cpu_ms, gpu_ms, wall_ms, statistics })
        })
    }

    fn ticks(&self, gpu: &Gpu, timer: &Timer) -> Result<f64, RenderError> {
        let bytes = mapped(gpu, &timer.read_back, |bytes| bytes.to_vec())?;
        let stamps: Vec<u64> = bytes.as_chunks().0.iter().map(|&b| u64::from_le_bytes(b)).collect();
        Ok(stamps[1].saturating_sub(stamps[0]) as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-6)
    }

    fn copy(&self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture, layer: u64) {
        let bytes_per_row = row_bytes(texture.width());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.read_back,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: layer * u64::from(bytes_per_row) * u64::from(texture.height()),
                    bytes_per_row: Some(bytes_per_row),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
    }

    /// Rows without their padding, of the first `layers` layers.
    fn read(&self, gpu: &Gpu, layers: usize) -> Result<Vec<Vec<u8>>, RenderError> {
        let padded = row_bytes(self.color.width()) as usize;
        let (row, height) = (self.color.width() as usize * 4, self.color.height() as usize);
        mapped(gpu, &self.read_back, |bytes| {
            let rows = |layer: &[u8]| layer.chunks_exact(padded).flat_map(|r| &r[..row]).copied().collect();
            bytes.chunks_exact(padded * height).take(layers).map(rows).collect()
        })
    }
}

fn texture(gpu: &Gpu, width: u32, height: u32, format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("offscreen"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// Until the GPU has done everything it was given.
fn wait(gpu: &Gpu) -> Result<(), RenderError> {
    let result = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    result.map(drop).map_err(|error| RenderError::Lost(error.to_string()))
}

/// Waits for the GPU and looks at a buffer.
fn mapped<T>(gpu: &Gpu, buffer: &wgpu::Buffer, look: impl FnOnce(&[u8]) -> T) -> Result<T, RenderError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
    wait(gpu)?;
    let lost = |error: String| RenderError::Lost(error);
    receiver.recv().map_err(|error| lost(error.to_string()))?.map_err(|error| lost(error.to_string()))?;
    let result =
        buffer.get_mapped_range(..).map(|bytes| look(&bytes)).map_err(|error| lost(error.to_string()));
    buffer.unmap();
    result
}
