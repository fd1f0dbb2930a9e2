//! Draws frames.

use std::mem::size_of;

use crate::batch::{Batcher, Draw, DrawStatistics};
use crate::frame::{Frame, FrameUniform};
use crate::pipeline::{Key, NO_ITEM, Pipelines};
use crate::vertex::{LineVertex, Row};
use crate::{Gpu, GpuScene};

/// Sets of per-frame buffers, used in turn: so many draws may share one submission.
const SETS: usize = 4;

/// What to draw into.
#[derive(Clone, Debug)]
pub struct Target {
    /// Colours, in the renderer's format.
    pub color: wgpu::TextureView,
    /// Depth, in [`DEPTH_FORMAT`](crate::DEPTH_FORMAT).
    pub depth: wgpu::TextureView,
    /// Pixels per row of both.
    pub width: u32,
    /// Rows of both.
    pub height: u32,
}

/// What to draw ids into: [`ITEM_FORMAT`](crate::ITEM_FORMAT), [`NO_ITEM`](crate::NO_ITEM) where there is nothing.
#[derive(Clone, Debug)]
pub struct ItemTarget {
    /// Nearest opaque or masked objects.
    pub nearest: wgpu::TextureView,
    /// Nearest blended objects in front of those.
    pub transparent: wgpu::TextureView,
    /// Depth, in [`DEPTH_FORMAT`](crate::DEPTH_FORMAT); used up.
    pub depth: wgpu::TextureView,
    /// Pixels per row of all three.
    pub width: u32,
    /// Rows of all three.
    pub height: u32,
}

/// Pipelines and per-frame buffers. One submission may hold the commands of at most four calls of `draw` and
/// `draw_items` of one renderer.
#[derive(Debug)]
pub struct Renderer {
    pipelines: Pipelines,
    batcher: Batcher,
    sets: Vec<FrameSet>,
    next: usize,
    lines: Vec<LineVertex>,
}

/// Buffers that change with every frame.
#[derive(Debug)]
struct FrameSet {
    uniform: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    rows: Growing,
    lines: Growing,
}

/// A vertex buffer that grows.
#[derive(Debug)]
struct Growing(wgpu::Buffer);

impl Growing {
    fn new(device: &wgpu::Device, size: u64) -> Self {
        Self(device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }))
    }

    fn write(&mut self, gpu: &Gpu, bytes: &[u8]) {
        let needed = bytes.len() as u64;
        if needed > self.0.size() {
            // Some more than needed, so that a slowly growing set does not make a buffer every frame.
            let most = gpu.device.limits().max_buffer_size;
            *self = Self::new(&gpu.device, (needed + needed / 2).min(most).max(needed).next_multiple_of(4));
        }
        if !bytes.is_empty() {
            gpu.queue.write_buffer(&self.0, 0, bytes);
        }
    }
}

impl FrameSet {
    fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> Self {
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("camera"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        Self { uniform, bind_group, rows: Growing::new(device, 4096), lines: Growing::new(device, 256) }
    }
}

impl Renderer {
    /// A renderer for targets of one colour format. Formats that encode sRGB are faster.
    pub fn new(gpu: &Gpu, color_format: wgpu::TextureFormat) -> Self {
        let pipelines = Pipelines::new(&gpu.device, color_format);
        let sets = (0..SETS).map(|_| FrameSet::new(&gpu.device, &pipelines.layouts.frame)).collect();
        Self { pipelines, batcher: Batcher::default(), sets, next: 0, lines: Vec::new() }
    }

    /// Clears the target to the sky and draws everything.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        scene: &GpuScene,
        frame: &Frame<'_>,
        target: &Target,
        encoder: &mut wgpu::CommandEncoder,
    ) -> DrawStatistics {
        self.draw_timed(gpu, scene, frame, target, encoder, None)
    }

    pub(crate) fn draw_timed(
        &mut self,
        gpu: &Gpu,
        scene: &GpuScene,
        frame: &Frame<'_>,
        target: &Target,
        encoder: &mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> DrawStatistics {
        self.prepare(gpu, scene, frame, target.width, target.height);
        let tinted = scene.tints.on;
        for draw in &self.batcher.draws {
            let class = &scene.layout.classes[draw.class as usize];
            self.pipelines.get(&gpu.device, Key::color(class, draw.mirrored, tinted));
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(depth(&target.depth, wgpu::LoadOp::Clear(0.0))),
            timestamp_writes,
            ..Default::default()
        });
        let set = &self.sets[self.next];
        let (opaque, blended) = self.batcher.draws.split_at(self.batcher.blended);
        let key = |draw: &Draw| Key::color(&scene.layout.classes[draw.class as usize], draw.mirrored, tinted);
        encode(&mut pass, &mut self.pipelines, gpu, scene, set, opaque, key);
        pass.set_bind_group(0, &set.bind_group, &[]);
        pass.set_bind_group(1, &scene.tints.bind_group, &[]);
        pass.set_bind_group(2, &scene.textures[0], &[]);
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        encode(&mut pass, &mut self.pipelines, gpu, scene, set, blended, key);
        if !self.lines.is_empty() {
            pass.set_pipeline(&self.pipelines.lines);
            pass.set_vertex_buffer(0, set.lines.0.slice(..));
            pass.draw(0..self.lines.len() as u32, 0..1);
        }
        drop(pass);
        self.batcher.statistics
    }

    /// Draws the ids of objects. Lines are left out.
    pub fn draw_items(
        &mut self,
        gpu: &Gpu,
        scene: &GpuScene,
        frame: &Frame<'_>,
        target: &ItemTarget,
        encoder: &mut wgpu::CommandEncoder,
    ) -> DrawStatistics {
        self.prepare(gpu, scene, &Frame { lines: &[], ..*frame }, target.width, target.height);
        let nothing = wgpu::Color { r: f64::from(NO_ITEM), g: 0.0, b: 0.0, a: 0.0 };
        let set = &self.sets[self.next];
        let (opaque, blended) = self.batcher.draws.split_at(self.batcher.blended);
        let key = |draw: &Draw| Key::item(&scene.layout.classes[draw.class as usize], draw.mirrored);
        let passes = [
            (&target.nearest, opaque, wgpu::LoadOp::Clear(0.0)),
            (&target.transparent, blended, wgpu::LoadOp::Load),
        ];
        for (view, draws, load) in passes {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("items"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(nothing), store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: Some(depth(&target.depth, load)),
                ..Default::default()
            });
            encode(&mut pass, &mut self.pipelines, gpu, scene, set, draws, key);
        }
        self.batcher.statistics
    }

    /// Plans the frame and hands its data to the GPU.
    fn prepare(&mut self, gpu: &Gpu, scene: &GpuScene, frame: &Frame<'_>, width: u32, height: u32) {
        let eye = frame.view.eye;
        self.batcher.plan(&scene.layout, frame.objects, eye);
        self.lines.clear();
        self.lines.extend(frame.lines.iter().flat_map(|line| {
            let end =
                |p: glam::DVec3| LineVertex { position: (p - eye).as_vec3().to_array(), color: line.color };
            [end(line.from), end(line.to)]
        }));
        self.next = (self.next + 1) % SETS;
        let set = &mut self.sets[self.next];
        gpu.queue.write_buffer(
            &set.uniform,
            0,
            bytemuck::bytes_of(&FrameUniform::new(&frame.view, width, height)),
        );
        set.rows.write(gpu, bytemuck::cast_slice(&self.batcher.rows));
        set.lines.write(gpu, bytemuck::cast_slice(&self.lines));
    }
}

fn depth(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

/// Issues draw calls; what stays the same from one to the next is not set again.
fn encode(
    pass: &mut wgpu::RenderPass<'_>,
    pipelines: &mut Pipelines,
    gpu: &Gpu,
    scene: &GpuScene,
    set: &FrameSet,
    draws: &[Draw],
    key: impl Fn(&Draw) -> Key,
) {
    if draws.is_empty() {
        return;
    }
    pass.set_bind_group(0, &set.bind_group, &[]);
    pass.set_bind_group(1, &scene.tints.bind_group, &[]);
    let mut last: Option<&Draw> = None;
    let mut textures = None;
    for draw in draws {
        let same = |part: fn(&Draw) -> u32| last.is_some_and(|last| part(last) == part(draw));
        if !(same(|d| d.class) && same(|d| u32::from(d.mirrored))) {
            let class = &scene.layout.classes[draw.class as usize];
            pass.set_pipeline(pipelines.get(&gpu.device, key(draw)));
            if textures != Some(class.set) {
                pass.set_bind_group(2, &scene.textures[class.set as usize], &[]);
                textures = Some(class.set);
            }
        }
        if !same(|d| d.chunk) {
            let chunk = &scene.chunks[draw.chunk as usize];
            pass.set_vertex_buffer(0, chunk.vertices.slice(..));
            pass.set_index_buffer(chunk.indices.slice(..), wgpu::IndexFormat::Uint32);
            if let Some(uvs) = &chunk.uvs {
                pass.set_vertex_buffer(2, uvs.slice(..));
            }
        }
        if !same(|d| d.row) {
            pass.set_vertex_buffer(1, set.rows.0.slice(u64::from(draw.row) * size_of::<Row>() as u64..));
        }
        pass.draw_indexed(draw.first_index..draw.first_index + draw.index_count, 0, 0..draw.instances);
        last = Some(draw);
    }
}
