//! Where everything lies on the GPU: which objects are merged, which are instanced, and in what order.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::SceneData;
use crate::chunk::{Capacity, Filler, Source};
use crate::class::{Class, Mode, Sets, class_of};
use crate::extent::Extent;

/// Runs of neighbours are cut into blocks of this many indices, so that near ones can be drawn before far ones: what is
/// hidden then costs no shading. Few enough calls even for 100 million triangles.
const BLOCK_INDICES: u32 = 3 << 14;

/// No object, no group.
pub(crate) const NONE: u32 = u32::MAX;

/// Vertices written out for further uses of meshes, in all: 32 MiB.
const REPEATED_VERTICES: u64 = 1 << 20;

/// Clusters may be this large, metres, whatever their parts: the error of a position is then below 0.1 mm.
const CLUSTER_EXTENT: f64 = 2048.0;

/// A merged part: the triangles of one object in one class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) object: u32,
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
    /// Index into [`Layout::blocks`].
    pub(crate) block: u32,
}

/// Neighbouring parts that one draw call can take.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    pub(crate) class: u32,
    pub(crate) chunk: u32,
    pub(crate) cluster: u32,
    pub(crate) parts: std::ops::Range<u32>,
}

/// A part of an instanced mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) class: u32,
    pub(crate) chunk: u32,
    pub(crate) group: u32,
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
}

/// What batching reads of every visible object: half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Spot {
    /// Middle of its box, world space.
    pub(crate) center: DVec3,
    pub(crate) triangles: u32,
    /// Its group of instances (mesh and handedness), or [`NONE`].
    pub(crate) group: u32,
}

/// Where an object stands: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Place {
    /// Columns of the linear part.
    pub(crate) columns: [[f32; 3]; 3],
    /// World place of the mesh's origin.
    pub(crate) origin: DVec3,
}

/// The whole plan.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    pub(crate) classes: Vec<Class>,
    /// Merged parts in drawing order; opaque and masked classes first.
    pub(crate) parts: Vec<Part>,
    pub(crate) segments: Vec<Segment>,
    /// Objects of consecutive merged parts. They do not depend on what is visible, nor does therefore the order in which
    /// two objects are drawn: where surfaces lie in one plane, the same one always wins.
    pub(crate) blocks: Vec<Extent>,
    /// The same of each group of instances.
    pub(crate) groups: Vec<Extent>,
    /// World origins of merged vertices.
    pub(crate) clusters: Vec<DVec3>,
    /// `part_ids[part_start[o]..part_start[o + 1]]` are the merged parts of object `o`.
    pub(crate) part_start: Vec<u32>,
    pub(crate) part_ids: Vec<u32>,
    /// Parts of instanced meshes, by class.
    pub(crate) pieces: Vec<Piece>,
    pub(crate) spots: Vec<Spot>,
    /// Per group: whether its instances are mirrored.
    pub(crate) mirrored: Vec<bool>,
    pub(crate) places: Vec<Place>,
    pub(crate) chunk_textured: Vec<bool>,
    pub(crate) sources: Vec<Source>,
    pub(crate) sets: Vec<crate::class::TextureSet>,
}

/// Middle and half size of a mesh, None without vertices.
fn mesh_box(mesh: &crate::Mesh) -> Option<(DVec3, DVec3)> {
    let mut points = mesh.primitives.iter().flat_map(|p| &p.positions).map(|&p| Vec3::from(p));
    let first = points.next()?;
    let (low, high) = points.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    Some(((low + high) * 0.5, (high - low) * 0.5))
}

/// Half size of a turned box.
fn turned(linear: DMat3, half: DVec3) -> DVec3 {
    linear.x_axis.abs() * half.x + linear.y_axis.abs() * half.y + linear.z_axis.abs() * half.z
}

pub(crate) fn is_mirrored(to_world: &DAffine3) -> bool {
    let m = to_world.matrix3;
    m.x_axis.dot(m.y_axis.cross(m.z_axis)) < 0.0
}

/// Which meshes are drawn by instances.
fn instanced_meshes(data: &SceneData, merged_vertices: u64) -> Vec<bool> {
    let mut uses = vec![0u64; data.meshes.len()];
    for object in &data.objects {
        uses[object.mesh as usize] += 1;
    }
    let vertices =
        |mesh: usize| data.meshes[mesh].primitives.iter().map(|p| p.positions.len() as u64).sum::<u64>();
    let mut small: Vec<(u64, usize)> = (0..data.meshes.len())
        .filter(|&mesh| uses[mesh] > 1)
        .map(|mesh| (uses[mesh] * vertices(mesh), mesh))
        .filter(|&(total, _)| total <= merged_vertices)
        .collect();
    small.sort_unstable();
    let mut instanced: Vec<bool> = uses.iter().map(|&uses| uses > 1).collect();
    let mut repeated = 0;
    for (total, mesh) in small {
        repeated += total;
        if repeated > REPEATED_VERTICES {
            break;
        }
        instanced[mesh] = false;
    }
    instanced
}

/// Objects in `order`, each once, then those it leaves out.
fn full_order(order: &[u32], objects: usize) -> Vec<u32> {
    let mut seen = vec![false; objects];
    let all = order.iter().copied().chain(0..objects as u32);
    all.filter(|&object| !std::mem::replace(&mut seen[object as usize], true)).collect()
}

impl Layout {
    /// Plans a checked scene.
    pub(crate) fn new(data: &SceneData, order: &[u32], capacity: Capacity) -> Self {
        let mut sets = Sets::new();
        let primitive_classes: Vec<Vec<Class>> = data
            .meshes
            .iter()
            .map(|mesh| {
                mesh.primitives.iter().map(|primitive| class_of(data, primitive, &mut sets)).collect()
            })
            .collect();
        let mut classes: Vec<Class> = primitive_classes.iter().flatten().copied().collect();
        classes.sort_unstable();
        classes.dedup();
        let class_index = |class: &Class| classes.binary_search(class).unwrap_or_default() as u32;

        let boxes: Vec<_> = data.meshes.iter().map(|mesh| mesh_box(mesh).unwrap_or_default()).collect();
        let instanced = instanced_meshes(data, capacity.merged_vertices);
        let mut plan = Self { sets: sets.list, ..Self::default() };
        plan.describe_objects(data, &boxes, &instanced);

        // Merged parts: by class, then in the order culling answers.
        let mut wanted = Vec::new();
        for (position, object) in full_order(order, data.objects.len()).into_iter().enumerate() {
            let mesh = data.objects[object as usize].mesh;
            if !instanced[mesh as usize] {
                for (primitive, class) in primitive_classes[mesh as usize].iter().enumerate() {
                    wanted.push((class_index(class), position as u32, primitive as u32, object));
                }
            }
        }
        wanted.sort_unstable();
        let mut filler = Filler::new(data, capacity, &classes);
        plan.place_parts(data, &boxes, &wanted, &mut filler);
        plan.cut_blocks();

        // Pieces: every group draws the same triangles of its mesh.
        let mut groups_of_mesh = vec![[NONE; 2]; data.meshes.len()];
        for (object, &Spot { group, .. }) in data.objects.iter().zip(&plan.spots) {
            if group != NONE {
                groups_of_mesh[object.mesh as usize][usize::from(plan.mirrored[group as usize])] = group;
            }
        }
        let mut wanted: Vec<(u32, u32, u32)> = Vec::new();
        for (mesh, list) in primitive_classes.iter().enumerate().filter(|&(mesh, _)| instanced[mesh]) {
            wanted.extend(
                list.iter().enumerate().map(|(i, class)| (class_index(class), mesh as u32, i as u32)),
            );
        }
        wanted.sort_unstable();
        for (class, mesh, primitive) in wanted {
            filler.place(class, mesh, primitive, NONE, NONE, |chunk, first_index, index_count| {
                for group in groups_of_mesh[mesh as usize].into_iter().filter(|&group| group != NONE) {
                    plan.pieces.push(Piece { class, chunk, group, first_index, index_count });
                }
            });
        }
        plan.sources = filler.sources;
        plan.chunk_textured = filler.chunk_textured;
        plan.classes = classes;
        plan
    }

    fn describe_objects(&mut self, data: &SceneData, boxes: &[(DVec3, DVec3)], instanced: &[bool]) {
        let mesh_triangles: Vec<u32> = data
            .meshes
            .iter()
            .map(|mesh| mesh.primitives.iter().map(|p| p.indices.len() / 3).sum::<usize>() as u32)
            .collect();
        let mut groups = std::collections::HashMap::new();
        for object in &data.objects {
            let m = object.to_world.matrix3;
            let columns = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.as_vec3().to_array());
            self.places.push(Place { columns, origin: object.to_world.translation });
            let center = object.to_world.transform_point3(boxes[object.mesh as usize].0);
            let triangles = mesh_triangles[object.mesh as usize];
            let group = if instanced[object.mesh as usize] {
                let mirrored = is_mirrored(&object.to_world);
                *groups.entry((object.mesh, mirrored)).or_insert_with(|| {
                    self.mirrored.push(mirrored);
                    self.groups.push(Extent::EMPTY);
                    (self.mirrored.len() - 1) as u32
                })
            } else {
                NONE
            };
            if let Some(extent) = self.groups.get_mut(group as usize) {
                extent.extend(center);
            }
            self.spots.push(Spot { center, triangles, group });
        }
    }

    fn place_parts(
        &mut self,
        data: &SceneData,
        boxes: &[(DVec3, DVec3)],
        wanted: &[(u32, u32, u32, u32)],
        filler: &mut Filler<'_>,
    ) {
        let half = |object: u32| {
            let object = &data.objects[object as usize];
            turned(object.to_world.matrix3, boxes[object.mesh as usize].1)
        };
        let limit =
            cluster_limit(wanted.iter().map(|&(.., object)| half(object).max_element() * 2.0).collect());
        let mut extent: Option<(DVec3, DVec3)> = None;
        for &(class, _, primitive, object) in wanted {
            let (center, half) = (self.spots[object as usize].center, half(object));
            let (low, high) = (center - half, center + half);
            let joined = extent.map_or((low, high), |(l, h)| (l.min(low), h.max(high)));
            let allowed = limit.max(half.max_element() * 8.0);
            if extent.is_none() || (joined.1 - joined.0).max_element() > allowed {
                extent = Some((low, high));
                self.clusters.push(center);
            } else {
                extent = Some(joined);
            }
            let cluster = (self.clusters.len() - 1) as u32;
            let mesh = data.objects[object as usize].mesh;
            filler.place(class, mesh, primitive, object, cluster, |chunk, first_index, index_count| {
                let part = self.parts.len() as u32;
                self.parts.push(Part { object, first_index, index_count, block: NONE });
                match self.segments.last_mut() {
                    Some(last) if (last.class, last.chunk, last.cluster) == (class, chunk, cluster) => {
                        last.parts.end = part + 1;
                    }
                    _ => self.segments.push(Segment { class, chunk, cluster, parts: part..part + 1 }),
                }
            });
        }
        self.index_parts(data.objects.len());
    }

    fn cut_blocks(&mut self) {
        for segment in &self.segments {
            let parts = &mut self.parts[segment.parts.start as usize..segment.parts.end as usize];
            let mut end = 0;
            for part in parts {
                if part.first_index >= end {
                    self.blocks.push(Extent::EMPTY);
                    end = part.first_index + BLOCK_INDICES;
                }
                part.block = self.blocks.len() as u32 - 1;
                if let Some(block) = self.blocks.last_mut() {
                    block.extend(self.spots[part.object as usize].center);
                }
            }
        }
    }

    /// From objects to their parts.
    fn index_parts(&mut self, objects: usize) {
        self.part_start = vec![0; objects + 1];
        for part in &self.parts {
            self.part_start[part.object as usize + 1] += 1;
        }
        for object in 0..objects {
            self.part_start[object + 1] += self.part_start[object];
        }
        let mut next = self.part_start.clone();
        self.part_ids = vec![0; self.parts.len()];
        for (id, part) in self.parts.iter().enumerate() {
            let slot = &mut next[part.object as usize];
            self.part_ids[*slot as usize] = id as u32;
            *slot += 1;
        }
    }

    /// Rows when everything is visible.
    pub(crate) fn most_rows(&self) -> u64 {
        (self.clusters.len() + self.spots.iter().filter(|spot| spot.group != NONE).count()) as u64
    }

    /// Whether parts of this class are blended.
    pub(crate) fn is_blended(&self, class: u32) -> bool {
        self.classes[class as usize].mode == Mode::Blend
    }
}

/// How large a cluster may be. Relative to the median part too: scenes are not always in metres.
fn cluster_limit(mut extents: Vec<f64>) -> f64 {
    if extents.is_empty() {
        return CLUSTER_EXTENT;
    }
    let middle = extents.len() / 2;
    let (_, median, _) = extents.select_nth_unstable_by(middle, f64::total_cmp);
    CLUSTER_EXTENT.max(*median * 256.0)
}
