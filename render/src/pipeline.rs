//! Pipelines, made when first needed.

use std::collections::HashMap;
use std::mem::size_of;

use crate::class::{Class, Mode, Textured};
use crate::shader::{COLOR, FRAME, ITEM, LIGHT, LINES, SKY, VERTEX, compose};
use crate::vertex::{LineVertex, Row, Vertex};

/// Format of depth targets: reversed, 1 at the near plane and 0 at infinity.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Format of item targets.
pub const ITEM_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// In item targets and buffers: nothing.
pub const NO_ITEM: u32 = u32::MAX;

/// What tells pipelines apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Key {
    item: bool,
    /// Without its texture set.
    class: Class,
    mirrored: bool,
    tinted: bool,
}

impl Key {
    pub(crate) fn color(class: &Class, mirrored: bool, tinted: bool) -> Self {
        Self { item: false, class: Class { set: 0, ..*class }, mirrored, tinted }
    }

    /// Ids need of the material only where it is.
    pub(crate) fn item(class: &Class, mirrored: bool) -> Self {
        let textured = match (class.mode, class.textured) {
            (Mode::Opaque, _) | (_, Textured::No) => Textured::No,
            _ => Textured::Color,
        };
        let plain =
            Class { textured, flat: false, colors: false, unlit: false, emissive: false, set: 0, ..*class };
        Self { item: true, class: plain, mirrored, tinted: false }
    }

    fn names(&self, srgb: bool) -> Vec<&'static str> {
        let class = &self.class;
        let conditions = [
            ("ITEM", self.item),
            ("SRGB_TARGET", srgb),
            ("TEXTURED", class.textured != Textured::No),
            ("FULL", class.textured == Textured::Full),
            ("COLORS", class.colors),
            ("FLAT", class.flat),
            ("UNLIT", class.unlit),
            ("EMISSIVE", class.emissive),
            ("DOUBLE_SIDED", class.double_sided),
            ("MASK", class.mode == Mode::Mask),
            ("BLEND", class.mode == Mode::Blend),
            ("CUT", class.mode != Mode::Opaque),
            ("TINTED", self.tinted),
            ("TINT_PER_PIXEL", self.tinted && class.textured != Textured::No),
            ("MATERIAL_PER_PIXEL", class.textured != Textured::No && !class.unlit),
        ];
        conditions.into_iter().filter(|&(_, on)| on).map(|(name, _)| name).collect()
    }

    /// Whether texture coordinates are read.
    pub(crate) fn textured(&self) -> bool {
        self.class.textured != Textured::No
    }
}

/// Layouts of bind groups; equal ones are interchangeable, so scene and renderer each make theirs.
#[derive(Clone, Debug)]
pub(crate) struct Layouts {
    pub(crate) frame: wgpu::BindGroupLayout,
    pub(crate) tints: wgpu::BindGroupLayout,
    pub(crate) textures: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let entry =
            |binding, visibility, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = |filterable| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let pairs: Vec<_> = (0..3)
            .flat_map(|i| [entry(2 * i, fragment, texture(true)), entry(2 * i + 1, fragment, sampler)])
            .collect();
        Self {
            frame: layout("frame", &[entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, uniform)]),
            tints: layout("tints", &[entry(0, wgpu::ShaderStages::VERTEX, texture(false))]),
            textures: layout("textures", &pairs),
        }
    }
}

/// All pipelines for one colour format.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) layouts: Layouts,
    layout: wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    made: HashMap<Key, wgpu::RenderPipeline>,
    pub(crate) sky: wgpu::RenderPipeline,
    pub(crate) lines: wgpu::RenderPipeline,
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&layouts.frame), Some(&layouts.tints), Some(&layouts.textures)],
            immediate_size: 0,
        });
        let srgb: &[&str] = if format.is_srgb() { &["SRGB_TARGET"] } else { &[] };
        let target = |blend| wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL };
        let line_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4];
        let line_layout = wgpu::VertexBufferLayout {
            array_stride: size_of::<LineVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &line_attributes,
        };
        let simple =
            |label, source: &str, buffers: &[Option<wgpu::VertexBufferLayout<'_>>], topology, blend| {
                make(
                    device,
                    &layout,
                    &Recipe {
                        label,
                        source: &compose(&[FRAME, source], srgb),
                        buffers,
                        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                        depth_write: false,
                        depth_compare: wgpu::CompareFunction::GreaterEqual,
                        target: target(blend),
                    },
                )
            };
        let sky = simple("sky", SKY, &[], wgpu::PrimitiveTopology::TriangleList, None);
        let blend = Some(wgpu::BlendState::ALPHA_BLENDING);
        let lines = simple("lines", LINES, &[Some(line_layout)], wgpu::PrimitiveTopology::LineList, blend);
        Self { layouts, layout, format, made: HashMap::new(), sky, lines }
    }

    /// The pipeline of a key, compiled when it is first asked for.
    pub(crate) fn get(&mut self, device: &wgpu::Device, key: Key) -> &wgpu::RenderPipeline {
        let (layout, format) = (&self.layout, self.format);
        self.made.entry(key).or_insert_with(|| scene_pipeline(device, layout, format, key))
    }
}

fn scene_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    key: Key,
) -> wgpu::RenderPipeline {
    let last = if key.item { ITEM } else { COLOR };
    let source = compose(&[FRAME, LIGHT, VERTEX, last], &key.names(format.is_srgb()));
    let vertex = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Unorm10_10_10_2, 2 => Unorm8x4, 3 => Unorm8x4, 4 => Unorm8x4, 5 => Uint32
    ];
    let row = wgpu::vertex_attr_array![6 => Float32x3, 7 => Float32x3, 8 => Float32x3, 9 => Float32x3, 10 => Uint32];
    let uv = wgpu::vertex_attr_array![11 => Float32x2];
    let buffer = |array_stride: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: array_stride as u64, step_mode, attributes })
    };
    let buffers = [
        buffer(size_of::<Vertex>(), wgpu::VertexStepMode::Vertex, &vertex),
        buffer(size_of::<Row>(), wgpu::VertexStepMode::Instance, &row),
        buffer(size_of::<[f32; 2]>(), wgpu::VertexStepMode::Vertex, &uv),
    ];
    let blended = key.class.mode == Mode::Blend;
    make(
        device,
        layout,
        &Recipe {
            label: if key.item { "items" } else { "surfaces" },
            source: &source,
            buffers: if key.textured() { &buffers } else { &buffers[..2] },
            primitive: wgpu::PrimitiveState {
                front_face: if key.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                cull_mode: (!key.class.double_sided).then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_write: key.item || !blended,
            depth_compare: wgpu::CompareFunction::Greater,
            target: wgpu::ColorTargetState {
                format: if key.item { ITEM_FORMAT } else { format },
                blend: (blended && !key.item).then_some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            },
        },
    )
}

struct Recipe<'a> {
    label: &'a str,
    source: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    primitive: wgpu::PrimitiveState,
    depth_write: bool,
    depth_compare: wgpu::CompareFunction,
    target: wgpu::ColorTargetState,
}

fn make(device: &wgpu::Device, layout: &wgpu::PipelineLayout, recipe: &Recipe<'_>) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(recipe.label),
        source: wgpu::ShaderSource::Wgsl(recipe.source.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: recipe.buffers,
        },
        primitive: recipe.primitive,
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(recipe.depth_write),
            depth_compare: Some(recipe.depth_compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(recipe.target.clone())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
