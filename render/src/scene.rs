//! A scene on the GPU.

use crate::chunk::Capacity;
use crate::geometry::Geometry;
use crate::layout::Layout;
use crate::pipeline::Layouts;
use crate::vertex::{Row, Vertex};
use crate::{Gpu, RenderError, SceneData, check, textures};

/// Objects per row of the tint texture.
const TINTS_PER_ROW: u32 = 2048;

/// Geometry, transforms, materials and textures, uploaded once.
#[derive(Debug)]
pub struct GpuScene {
    pub(crate) layout: Layout,
    pub(crate) chunks: Vec<Chunk>,
    pub(crate) textures: Vec<wgpu::BindGroup>,
    pub(crate) tints: Tints,
    bytes: u64,
}

/// One pair of buffers, and texture coordinates where the chunk has textured parts.
#[derive(Debug)]
pub(crate) struct Chunk {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) uvs: Option<wgpu::Buffer>,
    pub(crate) indices: wgpu::Buffer,
}

#[derive(Debug)]
pub(crate) struct Tints {
    texture: wgpu::Texture,
    pub(crate) bind_group: wgpu::BindGroup,
    pub(crate) on: bool,
}

impl GpuScene {
    /// Uploads a scene. `order` lists objects in the order culling answers, that is tree order: neighbours there are
    /// drawn by one call. Objects it leaves out come after; empty is the order of indices.
    ///
    /// # Errors
    /// When an index is out of range or a number not finite, or when the GPU has too little memory.
    pub fn upload(gpu: &Gpu, data: &SceneData, order: &[u32]) -> Result<Self, RenderError> {
        check::check(data, order)?;
        let limits = gpu.device.limits();
        let rows = (data.objects.len() as u32).div_ceil(TINTS_PER_ROW).max(1);
        if rows > limits.max_texture_dimension_2d {
            return Err(RenderError::TooLarge {
                what: "objects",
                needed: data.objects.len() as u64,
                available: u64::from(limits.max_texture_dimension_2d * TINTS_PER_ROW),
                advice: "merge small objects",
            });
        }
        let most = limits.max_buffer_size;
        let capacity = Capacity {
            vertices: Capacity::DEFAULT
                .vertices
                .min((most / size_of::<Vertex>() as u64).try_into().unwrap_or(u32::MAX)),
            indices: Capacity::DEFAULT.indices.min((most / 4).try_into().unwrap_or(u32::MAX)),
            ..Capacity::DEFAULT
        };
        let mut layout = Layout::new(data, order, capacity);
        let row_bytes = layout.most_rows() * size_of::<Row>() as u64;
        if row_bytes > most {
            return Err(RenderError::TooLarge {
                what: "bytes for the transforms of all objects",
                needed: row_bytes,
                available: most,
                advice: "merge small objects",
            });
        }
        gpu.guarded(|| {
            let layouts = Layouts::new(&gpu.device);
            let (chunks, geometry_bytes) = upload_chunks(gpu, data, &layout)?;
            let (textures, texture_bytes) = textures::upload(gpu, &layouts, &data.images, &layout.sets);
            let tints = Tints::new(gpu, &layouts, 1, 1);
            // Only uploading needed it.
            layout.sources = Vec::new();
            Ok(Self { layout, chunks, textures, tints, bytes: geometry_bytes + texture_bytes })
        })
    }

    /// Triangles of an object, 0 for one that does not exist.
    pub fn triangles(&self, object: u32) -> u32 {
        self.layout.spots.get(object as usize).map_or(0, |spot| spot.triangles)
    }

    /// Bytes of geometry and textures on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Colours objects: one sRGB colour each; alpha is how much of the material's colour it replaces. Missing entries
    /// leave objects as they are; `None` leaves all.
    pub fn set_tints(&mut self, gpu: &Gpu, tints: Option<&[[u8; 4]]>) {
        self.tints.on = tints.is_some();
        let Some(tints) = tints else { return };
        let rows = (self.layout.spots.len() as u32).div_ceil(TINTS_PER_ROW).max(1);
        if self.tints.texture.width() != TINTS_PER_ROW {
            self.tints = Tints::new(gpu, &Layouts::new(&gpu.device), TINTS_PER_ROW, rows);
            self.tints.on = true;
        }
        let mut texels = vec![[0; 4]; (TINTS_PER_ROW * rows) as usize];
        let count = tints.len().min(self.layout.spots.len());
        texels[..count].copy_from_slice(&tints[..count]);
        let bytes = bytemuck::cast_slice(&texels);
        textures::write(&gpu.queue, &self.tints.texture, 0, TINTS_PER_ROW, rows, bytes);
    }
}

impl Tints {
    fn new(gpu: &Gpu, layouts: &Layouts, width: u32, height: u32) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("tints"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tints"),
            layout: &layouts.tints,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view),
            }],
        });
        Self { texture, bind_group, on: false }
    }
}

/// Writes chunk after chunk: never more than one of them in memory beside the scene.
fn upload_chunks(gpu: &Gpu, data: &SceneData, layout: &Layout) -> Result<(Vec<Chunk>, u64), RenderError> {
    let mut geometry = Geometry::default();
    let mut chunks = Vec::new();
    let mut bytes = 0;
    for sources in layout.sources.chunk_by(|a, b| a.chunk == b.chunk) {
        let textured = layout.chunk_textured[chunks.len()];
        geometry.clear();
        for source in sources {
            geometry.append(data, layout, source, textured);
        }
        let mut buffer = |label, usage, content: &[u8]| {
            bytes += content.len() as u64;
            filled_buffer(gpu, label, usage, content)
        };
        let vertices =
            buffer("vertices", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&geometry.vertices))?;
        let indices = buffer("indices", wgpu::BufferUsages::INDEX, bytemuck::cast_slice(&geometry.indices))?;
        let uvs = if textured {
            Some(buffer(
                "texture coordinates",
                wgpu::BufferUsages::VERTEX,
                bytemuck::cast_slice(&geometry.uvs),
            )?)
        } else {
            None
        };
        chunks.push(Chunk { vertices, uvs, indices });
    }
    Ok((chunks, bytes))
}

/// A buffer with content. The queue is emptied after each, else copies of all chunks would pile up before the first
/// frame.
fn filled_buffer(
    gpu: &Gpu,
    label: &str,
    usage: wgpu::BufferUsages,
    content: &[u8],
) -> Result<wgpu::Buffer, RenderError> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: content.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, content);
    gpu.queue.submit([]);
    // Browsers cannot wait, and free copies by themselves.
    let poll =
        if cfg!(target_arch = "wasm32") { wgpu::PollType::Poll } else { wgpu::PollType::wait_indefinitely() };
    gpu.device.poll(poll).map_err(|error| RenderError::Lost(error.to_string()))?;
    Ok(buffer)
}
