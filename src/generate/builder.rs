//! Puts shapes, paints and a node tree together into one glTF document.

use super::Sample;
use super::paint::Paint;
use super::shape::Shape;
use serde_json::{Map, Value, json};
use std::collections::HashMap;

/// Handle of a shape in a [`Builder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ShapeId(usize);

/// Handle of a mesh (painted shapes) in a [`Builder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct MeshId(usize);

/// Handle of a node in a [`Builder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NodeId(usize);

/// Node transform: scale, then rotation (unit quaternion x, y, z, w), then translation (metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
    pub(super) scale: [f64; 3],
}

impl Transform {
    pub(super) const IDENTITY: Transform =
        Transform { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] };

    pub(super) fn at(x: f64, y: f64, z: f64) -> Self {
        Transform { translation: [x, y, z], ..Self::IDENTITY }
    }

    pub(super) fn rotated(self, rotation: [f64; 4]) -> Self {
        Transform { rotation, ..self }
    }

    pub(super) fn scaled(self, x: f64, y: f64, z: f64) -> Self {
        Transform { scale: [x, y, z], ..self }
    }
}

/// A glTF document under construction. Only what nodes use is written, in the order of its first use.
#[derive(Debug, Default)]
pub(super) struct Builder {
    shapes: Vec<Shape>,
    meshes: Vec<Vec<(ShapeId, Paint)>>,
    known: HashMap<(ShapeId, Paint), MeshId>,
    nodes: Vec<Node>,
    roots: Vec<usize>,
}

#[derive(Debug)]
struct Node {
    name: String,
    transform: Transform,
    mesh: Option<MeshId>,
    children: Vec<usize>,
}

impl Builder {
    /// Takes a shape in.
    pub(super) fn shape(&mut self, shape: Shape) -> ShapeId {
        self.shapes.push(shape);
        ShapeId(self.shapes.len() - 1)
    }

    /// The mesh of one shape in one paint; asking again gives the same mesh.
    pub(super) fn mesh(&mut self, shape: ShapeId, paint: Paint) -> MeshId {
        if let Some(&mesh) = self.known.get(&(shape, paint)) {
            return mesh;
        }
        let mesh = self.mesh_of(&[(shape, paint)]);
        self.known.insert((shape, paint), mesh);
        mesh
    }

    /// A new mesh of several primitives; named for the first.
    pub(super) fn mesh_of(&mut self, parts: &[(ShapeId, Paint)]) -> MeshId {
        self.meshes.push(parts.to_vec());
        MeshId(self.meshes.len() - 1)
    }

    /// A node without a mesh; the caller puts something below it.
    pub(super) fn group(&mut self, parent: Option<NodeId>, name: impl Into<String>, at: Transform) -> NodeId {
        self.node(parent, name.into(), at, None)
    }

    /// A node with a mesh.
    pub(super) fn object(&mut self, parent: NodeId, name: impl Into<String>, mesh: MeshId, at: Transform) {
        self.node(Some(parent), name.into(), at, Some(mesh));
    }

    fn node(
        &mut self,
        parent: Option<NodeId>,
        name: String,
        transform: Transform,
        mesh: Option<MeshId>,
    ) -> NodeId {
        let id = self.nodes.len();
        self.nodes.push(Node { name, transform, mesh, children: Vec::new() });
        match parent {
            Some(parent) => self.nodes[parent.0].children.push(id),
            None => self.roots.push(id),
        }
        NodeId(id)
    }

    /// The finished document.
    pub(super) fn finish(self) -> Sample {
        let Builder { shapes, meshes, nodes, roots, .. } = self;
        let mut out = Output::default();
        let mut written_meshes = Indices::new(meshes.len());
        let mut written_shapes = Indices::new(shapes.len());
        let mut written_paints = HashMap::new();
        let mut mesh_list = Vec::new();
        let mut material_list = Vec::new();
        let mut node_list = Vec::with_capacity(nodes.len());
        for node in nodes {
            let mesh = node.mesh.map(|MeshId(mesh)| {
                written_meshes.get(mesh, || {
                    let primitives = meshes[mesh].iter().map(|&(ShapeId(shape), paint)| {
                        let first_accessor = 3 * written_shapes.get(shape, || out.shape(&shapes[shape]));
                        let material = *written_paints.entry(paint).or_insert_with(|| {
                            material_list.push(paint.material());
                            material_list.len() - 1
                        });
                        json!({
                            "attributes": { "POSITION": first_accessor, "NORMAL": first_accessor + 1 },
                            "indices": first_accessor + 2,
                            "material": material,
                        })
                    });
                    let primitives: Vec<Value> = primitives.collect();
                    let (ShapeId(shape), paint) = meshes[mesh][0];
                    let name = format!("{}, {}", shapes[shape].name, paint.name());
                    mesh_list.push(json!({ "name": name, "primitives": primitives }));
                })
            });
            node_list.push(node.json(mesh));
        }
        let (buffer_views, accessors, bin) = out.finish();
        let json = json!({
            "asset": { "version": "2.0", "generator": "svs sample" },
            "scene": 0,
            "scenes": [{ "nodes": roots }],
            "nodes": node_list,
            "meshes": mesh_list,
            "materials": material_list,
            "accessors": accessors,
            "bufferViews": buffer_views,
            "buffers": [{ "byteLength": bin.len() }],
        });
        Sample { json, bin }
    }
}

/// Numbers things in the order of their first use.
struct Indices {
    written: Vec<Option<usize>>,
    count: usize,
}

impl Indices {
    fn new(things: usize) -> Self {
        Indices { written: vec![None; things], count: 0 }
    }

    /// Index of `thing`; `write` runs if it is new.
    fn get(&mut self, thing: usize, write: impl FnOnce()) -> usize {
        if let Some(index) = self.written[thing] {
            return index;
        }
        write();
        let index = self.count;
        self.written[thing] = Some(index);
        self.count += 1;
        index
    }
}

/// Bytes and accessors of the shapes written so far: all vertex data in buffer view 0, all indices in 1.
#[derive(Default)]
struct Output {
    vertices: Vec<u8>,
    indices: Vec<u8>,
    accessors: Vec<Value>,
}

impl Output {
    fn shape(&mut self, shape: &Shape) {
        const FLOAT: u32 = 5126;
        const UNSIGNED_SHORT: u32 = 5123;
        let extreme = |pick: fn(f32, f32) -> f32| -> Vec<f64> {
            (0..3)
                .filter_map(|axis| shape.positions.iter().map(|p| p[axis]).reduce(pick))
                .map(f64::from)
                .collect()
        };
        let count = shape.positions.len();
        let mut positions =
            json!({ "bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3" });
        let mut normals = positions.clone();
        positions["min"] = extreme(f32::min).into_iter().map(short).collect();
        positions["max"] = extreme(f32::max).into_iter().map(short).collect();
        for (accessor, values) in [(&mut positions, &shape.positions), (&mut normals, &shape.normals)] {
            if !self.vertices.is_empty() {
                accessor["byteOffset"] = self.vertices.len().into();
            }
            self.vertices.extend(values.iter().flatten().flat_map(|x| x.to_le_bytes()));
        }
        let mut indices = json!({
            "bufferView": 1, "componentType": UNSIGNED_SHORT, "count": shape.indices.len(), "type": "SCALAR",
        });
        if !self.indices.is_empty() {
            indices["byteOffset"] = self.indices.len().into();
        }
        self.indices.extend(shape.indices.iter().flat_map(|i| i.to_le_bytes()));
        self.accessors.extend([positions, normals, indices]);
    }

    fn finish(self) -> (Value, Vec<Value>, Vec<u8>) {
        const ARRAY_BUFFER: u32 = 34962;
        const ELEMENT_ARRAY_BUFFER: u32 = 34963;
        let Output { vertices: mut bin, indices, accessors } = self;
        let views = json!([
            { "buffer": 0, "byteLength": bin.len(), "byteStride": 12, "target": ARRAY_BUFFER },
            { "buffer": 0, "byteOffset": bin.len(), "byteLength": indices.len(), "target": ELEMENT_ARRAY_BUFFER },
        ]);
        bin.extend(indices);
        (views, accessors, bin)
    }
}

impl Node {
    fn json(self, mesh: Option<usize>) -> Value {
        let mut node = Map::new();
        node.insert("name".into(), self.name.into());
        if let Some(mesh) = mesh {
            node.insert("mesh".into(), mesh.into());
        }
        let Transform { translation, rotation, scale } = self.transform;
        if translation != [0.0; 3] {
            node.insert("translation".into(), translation.into_iter().map(rounded).collect());
        }
        if rotation != Transform::IDENTITY.rotation {
            // Not rounded: a quaternion must keep its length.
            node.insert("rotation".into(), rotation.into_iter().map(short).collect());
        }
        if scale != [1.0; 3] {
            node.insert("scale".into(), scale.into_iter().map(rounded).collect());
        }
        if !self.children.is_empty() {
            node.insert("children".into(), self.children.into());
        }
        Value::Object(node)
    }
}

/// A length or factor to three digits (millimetres), which keeps the text short.
fn rounded(x: f64) -> Value {
    short((x * 1000.0).round() / 1000.0)
}

/// A number without a needless `.0`.
fn short(x: f64) -> Value {
    if x == x.trunc() && x.abs() < 1e15 { (x as i64).into() } else { x.into() }
}
