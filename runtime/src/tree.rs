//! A decoded visibility tree: read access.

use crate::directions::DirectionSet;
use crate::encode;
use crate::proxies::Proxies;
use crate::sorting::sorted;
use glam::Vec3;
use std::ops::Range;

/// One visibility tree, checked. Everything is in **tree space**: world space, or the local space of its anchors.
#[derive(Debug)]
pub struct Tree {
    pub(crate) placement: Placement,
    pub(crate) directions: &'static DirectionSet,
    pub(crate) object_count: u32,
    pub(crate) nodes: Vec<Node>,
    /// Empty if the tree has no nodes.
    pub(crate) objects: Vec<ObjectRow>,
    pub(crate) order: Option<Vec<u32>>,
    pub(crate) level_bits: u8,
    pub(crate) rows: Vec<u8>,
    pub(crate) importance: Vec<u8>,
    /// Area in m² for each importance code.
    pub(crate) areas: Vec<f64>,
    pub(crate) proxies: Option<Proxies>,
    pub(crate) nested: Vec<Nested>,
    /// Other trees, ascending, and how many entries of `nested` each has.
    pub(crate) nested_counts: Vec<(u32, usize)>,
    pub(crate) recommended_quality: Option<f32>,
    pub(crate) fingerprint: Option<Fingerprint>,
}

/// Where a tree is in the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Placement {
    /// At the root of this glTF scene: tree space is world space.
    Scene(u32),
    /// In the local space of each of these glTF nodes.
    Anchors(Vec<u32>),
}

impl Placement {
    /// Places where the tree is: 1 for a scene.
    pub fn count(&self) -> usize {
        match self {
            Self::Scene(_) => 1,
            Self::Anchors(nodes) => nodes.len(),
        }
    }
}

/// An inner node: a bounding sphere and the objects in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Centre of the sphere, metres of tree space.
    pub center: Vec3,
    /// Radius, metres, not negative.
    pub radius: f32,
    /// Nodes in the subtree, itself included: the next node that is not below this one is this many further on.
    pub subtree: u32,
    /// First object below the node.
    pub first_object: u32,
    /// Objects below the node, contiguous.
    pub object_count: u32,
    /// Ancestors of this node.
    pub depth: u32,
}

impl Node {
    /// Places in tree order of the objects below the node.
    pub fn objects(&self) -> Range<u32> {
        self.first_object..self.first_object + self.object_count
    }
}

/// What a query needs to know of one object, side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRow {
    /// Byte offset of its levels in the rows.
    pub(crate) row: usize,
    /// Its first importance code.
    pub(crate) importance: u32,
    /// Ancestors.
    pub(crate) depth: u32,
    /// Highest level over all directions.
    pub(crate) max_level: u8,
}

/// An object that stands for an anchor of another tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nested {
    /// Place in this tree's order.
    pub object: u32,
    /// Index of the other tree.
    pub tree: u32,
    /// Index into the other tree's anchors.
    ///
    /// If this tree itself has several anchors, this is the one below the first; below the `k`-th it is
    /// `anchor + k * m`, where `m` entries of this tree name that other tree.
    pub anchor: u32,
}

/// What a tree was baked from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    /// Sum of the objects' triangle counts.
    pub triangles: u64,
    /// [`encode::fingerprint`] of the objects.
    pub hash: u64,
}

impl Tree {
    /// Where the tree is in the scene.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Its sample directions.
    pub fn direction_set(&self) -> &'static DirectionSet {
        self.directions
    }

    /// Number of objects.
    pub fn object_count(&self) -> usize {
        self.object_count as usize
    }

    /// Inner nodes in depth-first order.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Index of the object at `place` among the mesh-bearing nodes and instances below the anchor, in depth-first
    /// document order.
    ///
    /// # Panics
    /// If `place >= self.object_count()`.
    pub fn document_index(&self, place: usize) -> u32 {
        assert!(place < self.object_count(), "no object {place}");
        self.order.as_ref().map_or(place as u32, |order| order[place])
    }

    /// Visible level of an object from a direction: how many of its ancestors, counted upwards from its parent,
    /// see it. 0 without nodes.
    ///
    /// # Panics
    /// If `object >= self.object_count()` or `direction >= self.direction_set().len()`.
    pub fn level(&self, object: usize, direction: usize) -> u8 {
        assert!(object < self.object_count() && direction < self.directions.len());
        self.objects.get(object).map_or(0, |o| self.row_level(o, direction))
    }

    /// Highest visible level of an object over all directions.
    ///
    /// # Panics
    /// If `object >= self.object_count()`.
    pub fn max_level(&self, object: usize) -> u8 {
        assert!(object < self.object_count());
        self.objects.get(object).map_or(0, |o| o.max_level)
    }

    /// Number of ancestors of an object.
    ///
    /// # Panics
    /// If `object >= self.object_count()`.
    pub fn depth(&self, object: usize) -> u32 {
        assert!(object < self.object_count());
        self.objects.get(object).map_or(0, |o| o.depth)
    }

    /// Largest visible projected area of an object, in m², over all directions, seen from outside its ancestor at
    /// `height` (the parent has height 1). 0 where no direction reaches that height, and for height 0.
    ///
    /// # Panics
    /// If `object >= self.object_count()`.
    pub fn importance_area(&self, object: usize, height: u32) -> f32 {
        assert!(object < self.object_count());
        match self.objects.get(object) {
            Some(o) if (1..=u32::from(o.max_level)).contains(&height) => self.area(o, height) as f32,
            _ => 0.0,
        }
    }

    /// Meshes that stand for groups of objects.
    pub fn proxies(&self) -> Option<&Proxies> {
        self.proxies.as_ref()
    }

    /// Objects that stand for other trees, by place.
    pub fn nested(&self) -> &[Nested] {
        &self.nested
    }

    /// Quality the baker recommends, 0 to 1, for [`crate::Settings::from_quality`].
    pub fn recommended_quality(&self) -> Option<f32> {
        self.recommended_quality
    }

    /// What the tree was baked from.
    pub fn fingerprint(&self) -> Option<Fingerprint> {
        self.fingerprint
    }

    /// The scene has changed since it was baked: draw it with frustum culling alone.
    ///
    /// `triangle_counts` are those of the tree's objects now, in tree order. A tree without a fingerprint is stale
    /// only if the number of objects differs. Allocates; call it once per load.
    pub fn is_stale(&self, triangle_counts: &[u32]) -> bool {
        if triangle_counts.len() != self.object_count() {
            return true;
        }
        let Some(fingerprint) = self.fingerprint else { return false };
        let objects = triangle_counts.iter().enumerate();
        let keys = objects.map(|(k, &n)| u64::from(self.document_index(k)) << 32 | u64::from(n));
        let objects = sorted(keys).into_iter().map(|key| ((key >> 32) as u32, key as u32));
        let triangles: u64 = triangle_counts.iter().map(|&n| u64::from(n)).sum();
        fingerprint != Fingerprint { triangles, hash: encode::fingerprint(objects) }
    }

    #[inline]
    pub(crate) fn row_level(&self, object: &ObjectRow, direction: usize) -> u8 {
        encode::unpack_level(&self.rows[object.row..], self.level_bits, direction)
    }

    /// `height` must be in `1..=object.max_level`.
    #[inline]
    pub(crate) fn area(&self, object: &ObjectRow, height: u32) -> f64 {
        self.areas[usize::from(self.importance[(object.importance + height - 1) as usize])]
    }
}

impl Tree {
    /// Anchor of the other tree that `nested` stands for below this tree's anchor `anchor`.
    pub fn nested_anchor(&self, nested: &Nested, anchor: usize) -> usize {
        let found = self.nested_counts.binary_search_by_key(&nested.tree, |&(tree, _)| tree);
        let per_anchor = found.map_or(0, |at| self.nested_counts[at].1);
        (nested.anchor as usize).saturating_add(anchor.saturating_mul(per_anchor))
    }
}
