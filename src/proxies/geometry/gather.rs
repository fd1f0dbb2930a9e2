//! Gathers what a node's proxy is made of: places meshes, and turns materials into classes and vertex colours.

use super::class::{Class, ClassMesh};
use super::node::ProxyGeometry;
use super::palette::{Look, Palette};
use super::soup::{Soup, area};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use svs_render::{Mesh, Primitive};

/// Something that a proxy stands for.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// An object.
    Mesh {
        /// Its triangles; materials are those of the palette.
        mesh: &'a Mesh,
        /// Mesh space to the node's space: tree space moved so that the node's origin is at zero. Metres.
        to_node: DAffine3,
    },
    /// The proxy of a child.
    Proxy {
        /// What [`super::simplify_node`] made.
        geometry: &'a ProxyGeometry,
        /// The child's origin relative to the node's, metres.
        origin: DVec3,
    },
}

/// Triangles of one material or class.
struct Source<'a> {
    positions: &'a [[f32; 3]],
    normals: &'a [[f32; 3]],
    colors: &'a [[u8; 4]],
    uvs: &'a [[f32; 2]],
    indices: &'a [u32],
    /// Index into the palette, or the class that the colours belong to.
    material: Result<u32, Class>,
    to_node: DAffine3,
}

impl<'a> Source<'a> {
    fn of_primitive(primitive: &'a Primitive, to_node: DAffine3) -> Self {
        let count = primitive.positions.len();
        Self {
            positions: &primitive.positions,
            normals: full(&primitive.normals, count),
            colors: full(&primitive.colors, count),
            uvs: full(&primitive.uvs, count),
            indices: &primitive.indices,
            material: Ok(primitive.material),
            to_node,
        }
    }

    fn of_class(mesh: &'a ClassMesh, to_node: DAffine3) -> Self {
        let count = mesh.positions.len();
        Self {
            positions: &mesh.positions,
            normals: full(&mesh.normals, count),
            colors: full(&mesh.colors, count),
            uvs: full(&mesh.uvs, count),
            indices: &mesh.indices,
            material: match mesh.class {
                Class::Plain(_) => Err(mesh.class),
                Class::Kept { material, .. } => Ok(material),
            },
            to_node,
        }
    }

    fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let count = self.positions.len();
        let chunks = self.indices.chunks_exact(3).map(|c| [c[0] as usize, c[1] as usize, c[2] as usize]);
        chunks.filter(move |corners| corners.iter().all(|&v| v < count))
    }

    fn place(&self, vertex: usize) -> [f32; 3] {
        let position = Vec3::from_array(self.positions[vertex]).as_dvec3();
        self.to_node.transform_point3(position).as_vec3().to_array()
    }

    /// Square metres in the node's space.
    fn area(&self) -> f64 {
        self.corners().map(|corners| area(corners.map(|v| self.place(v)))).filter(|a| a.is_finite()).sum()
    }
}

/// An attribute counts only if every vertex has it.
fn full<T>(values: &[T], count: usize) -> &[T] {
    if values.len() == count { values } else { &[] }
}

/// All triangles of the parts, in their order. Triangles without area or with unusable numbers are left out, and so are
/// repeated ones.
pub(super) fn gather(parts: &[Part<'_>], palette: &Palette) -> Soup {
    let mut sources = Vec::new();
    for part in parts {
        match part {
            Part::Mesh { mesh, to_node } => {
                sources.extend(mesh.primitives.iter().map(|p| Source::of_primitive(p, *to_node)));
            }
            Part::Proxy { geometry, origin } => {
                let to_node = DAffine3::from_translation(*origin);
                sources.extend(geometry.classes.iter().map(|mesh| Source::of_class(mesh, to_node)));
            }
        }
    }
    let kept = kept_materials(&sources, palette);
    let looks: Vec<Option<Look<'_>>> = sources
        .iter()
        .map(|source| match source.material {
            Err(class) => Some(Look { class, color: [1.0; 4], texture: None }),
            Ok(material) => {
                let flat = source.normals.is_empty();
                palette.look(material, !source.uvs.is_empty(), flat, kept.contains(&material))
            }
        })
        .collect();
    let classes: Vec<Class> =
        looks.iter().flatten().map(|look| look.class).collect::<BTreeSet<_>>().into_iter().collect();
    let mut soup = Soup { classes, ..Soup::default() };
    for (source, look) in sources.iter().zip(&looks) {
        if let Some(look) = look {
            append(&mut soup, source, look);
        }
    }
    drop_repeated(&mut soup);
    soup
}

/// Materials whose textures vary and cover a large share of the node.
fn kept_materials(sources: &[Source<'_>], palette: &Palette) -> BTreeSet<u32> {
    let candidate =
        |source: &Source<'_>| source.material.ok().filter(|&m| !source.uvs.is_empty() && palette.may_keep(m));
    if !sources.iter().any(|source| candidate(source).is_some()) {
        return BTreeSet::new();
    }
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    let mut total = 0.0;
    for source in sources {
        let area = source.area();
        total += area;
        if let Some(material) = candidate(source) {
            *areas.entry(material).or_default() += area;
        }
    }
    areas.into_iter().filter(|(_, area)| Palette::keeps(area / total)).map(|(material, _)| material).collect()
}

fn append(soup: &mut Soup, source: &Source<'_>, look: &Look<'_>) {
    let Ok(class) = soup.classes.binary_search(&look.class) else { return };
    let flat = look.class.is_flat();
    let linear = source.to_node.matrix3;
    let mirrored = linear.determinant() < 0.0;
    let to_normal = cofactors(linear) * if mirrored { -1.0 } else { 1.0 };
    let footprints = if look.texture.is_some() { footprints(source) } else { Vec::new() };
    let top = match look.class {
        Class::Plain(plain) if source.material.is_ok() => plain.top(),
        Class::Plain(_) | Class::Kept { .. } => 1.0,
    };
    let mut places = vec![u32::MAX; source.positions.len()];
    for corners in source.corners() {
        let placed = corners.map(|v| source.place(v));
        let area = area(placed);
        if !(area > 0.0 && area.is_finite()) {
            continue;
        }
        let face = {
            let [a, b, c] = placed.map(Vec3::from_array);
            let face = (b - a).as_dvec3().cross((c - a).as_dvec3());
            if mirrored { -face } else { face }
        };
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        for corner in order {
            let vertex = corners[corner];
            if places[vertex] == u32::MAX {
                places[vertex] = soup.positions.len() as u32;
                soup.positions.push(placed[corner]);
                soup.normals.push(if flat {
                    [0.0; 3]
                } else {
                    let normal = to_normal * Vec3::from_array(source.normals[vertex]).as_dvec3();
                    let scaled = normal / normal.abs().max_element();
                    let unit = scaled.try_normalize().or_else(|| face.try_normalize());
                    unit.unwrap_or(DVec3::Y).as_vec3().to_array()
                });
                soup.colors.push(color(source, look, vertex, top, footprints.get(vertex).copied()));
                let kept = matches!(look.class, Class::Kept { .. });
                let uv =
                    source.uvs.get(vertex).copied().filter(|uv| kept && uv.iter().all(|c| c.is_finite()));
                soup.uvs.push(uv.unwrap_or_default());
                soup.vertex_class.push(class as u32);
            }
            soup.indices.push(places[vertex]);
        }
    }
}

/// Columns of the matrix that turns normals: the inverse transpose times the determinant, also where there is no inverse.
fn cofactors(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn color(source: &Source<'_>, look: &Look<'_>, vertex: usize, top: f32, footprint: Option<f32>) -> [u8; 4] {
    let own = source.colors.get(vertex).copied().unwrap_or([255; 4]);
    if source.material.is_err() {
        return own;
    }
    let mut color: [f32; 4] = std::array::from_fn(|c| f32::from(own[c]) / 255.0 * look.color[c]);
    if let Some((pyramid, sampler)) = look.texture {
        let texel = pyramid.sample(sampler, source.uvs[vertex], footprint.unwrap_or_default());
        color = std::array::from_fn(|c| color[c] * texel[c]);
    }
    if let Class::Plain(plain) = look.class
        && !plain.blend
    {
        color[3] = 1.0;
    }
    let byte = |value: f32, top: f32| (value / top * 255.0).round().clamp(0.0, 255.0) as u8;
    [byte(color[0], top), byte(color[1], top), byte(color[2], top), byte(color[3], 1.0)]
}

/// By vertex: the longest edge of its triangles in texture coordinates.
fn footprints(source: &Source<'_>) -> Vec<f32> {
    let mut footprints = vec![0.0f32; source.positions.len()];
    for corners in source.corners() {
        let uvs = corners.map(|v| source.uvs[v]);
        let edge = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let longest = edge(uvs[0], uvs[1]).max(edge(uvs[1], uvs[2])).max(edge(uvs[2], uvs[0]));
        for vertex in corners {
            footprints[vertex] = footprints[vertex].max(longest);
        }
    }
    footprints
}

/// Of triangles with the same corners and class only the first is ever seen; the other side of a double layer is not the
/// same unless both sides are drawn, so winding counts.
fn drop_repeated(soup: &mut Soup) {
    let key = |t: usize| {
        let corners = soup.corners(t).map(|v| soup.positions[v as usize].map(f32::to_bits));
        let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
        (soup.class(t), [corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]])
    };
    let mut order: Vec<usize> = (0..soup.triangle_count()).collect();
    order.sort_by_cached_key(|&t| (key(t), t));
    let mut repeated = vec![false; order.len()];
    for pair in order.windows(2) {
        repeated[pair[1]] = key(pair[0]) == key(pair[1]);
    }
    if repeated.contains(&true) {
        soup.indices = soup.filtered(|t| !repeated[t]);
    }
}
