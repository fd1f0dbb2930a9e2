//! Proxies: meshes that stand for groups of objects, in a hierarchy of their own over the tree's objects.

use crate::deviation::Deviation;
use crate::error::TreeError;
use crate::nesting::{self, Names, expect_length};
use crate::tables::sphere;
use glam::Vec3;
use std::ops::Range;

/// The tables of a tree's proxies, unchecked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProxyTables {
    /// Proxies hold only what is visible from outside of their spheres.
    pub visible: bool,
    /// Centre x, y, z and radius per proxy, metres of tree space.
    pub sphere: Vec<[f32; 4]>,
    /// Proxies in each subtree, itself included.
    pub subtree: Vec<u32>,
    /// First object, in proxy order, that each stands for.
    pub first_object: Vec<u32>,
    /// Objects each stands for.
    pub object_count: Vec<u32>,
    /// Place in tree order for each place in proxy order; `None`: the same order.
    pub object: Option<Vec<u32>>,
    /// Geometric errors, metres of tree space.
    pub error: Vec<f32>,
    /// By area; `None`: not known, see [`Deviation::of_error`].
    pub deviation: Option<Vec<Deviation>>,
    /// glTF mesh of each.
    pub mesh: Vec<u32>,
    /// What is added to the mesh's positions, metres of tree space.
    pub origin: Vec<[f32; 3]>,
}

/// The proxies of one tree, checked.
#[derive(Clone, Debug)]
pub struct Proxies {
    visible: bool,
    nodes: Vec<ProxyNode>,
    order: Option<Order>,
}

/// Proxy order against tree order.
#[derive(Clone, Debug)]
struct Order {
    /// Place in tree order, per position in proxy order.
    places: Vec<u32>,
    /// The other way round.
    positions: Vec<u32>,
}

/// A mesh that stands for the objects in a range of the proxy order. Everything is in tree space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProxyNode {
    /// Centre of the sphere around the objects, the proxy and the spheres of its children, metres.
    pub center: Vec3,
    /// Radius, metres, not negative.
    pub radius: f32,
    /// Proxies in the subtree, itself included.
    pub subtree: u32,
    /// First object it stands for, in proxy order.
    pub first_object: u32,
    /// Objects it stands for.
    pub object_count: u32,
    /// Proxies above this one.
    pub depth: u32,
    /// Geometric error, metres: at most so far is the proxy from what it stands for. Not larger than the parent's.
    pub error: f32,
    /// How much of what it stands for it shows wrong.
    pub deviation: Deviation,
    /// glTF mesh.
    pub mesh: u32,
    /// Added to the mesh's positions, metres.
    pub origin: Vec3,
}

impl ProxyNode {
    /// Positions in proxy order of the objects it stands for.
    pub fn objects(&self) -> Range<u32> {
        self.first_object..self.first_object + self.object_count
    }
}

const NAMES: Names = Names {
    subtree: "PROXY_SUBTREE",
    first_object: "PROXY_FIRST_OBJECT",
    object_count: "PROXY_OBJECT_COUNT",
};

impl Proxies {
    /// Checks the tables of proxies over `object_count` objects, in time and memory linear in the tables.
    ///
    /// # Errors
    /// [`TreeError::Proxies`] with every inconsistency.
    pub fn new(tables: ProxyTables, object_count: u32) -> Result<Self, TreeError> {
        Self::check(tables, object_count).map_err(|error| TreeError::Proxies(Box::new(error)))
    }

    fn check(tables: ProxyTables, object_count: u32) -> Result<Self, TreeError> {
        let count = tables.sphere.len();
        expect_length("PROXY_ERROR", tables.error.len(), count as u64)?;
        if let Some(deviation) = &tables.deviation {
            expect_length("PROXY_DEVIATION", deviation.len(), count as u64)?;
        }
        expect_length("PROXY_MESH", tables.mesh.len(), count as u64)?;
        expect_length("PROXY_ORIGIN", tables.origin.len(), count as u64)?;
        let order = tables.object.map(|places| Order::new(places, object_count)).transpose()?;
        let ranges = [&*tables.subtree, &tables.first_object, &tables.object_count];
        let depths = nesting::depths(count, &NAMES, ranges, object_count)?;
        let parents = nesting::parents(depths.iter().copied());
        let mut nodes: Vec<ProxyNode> = Vec::with_capacity(count);
        for (node, depth) in depths.into_iter().enumerate() {
            let (center, radius) = sphere(tables.sphere[node]).ok_or(TreeError::Sphere { node })?;
            let most = parents[node].map_or(f32::MAX, |parent| nodes[parent as usize].error);
            let error = tables.error[node];
            if !(0.0..=most).contains(&error) {
                return Err(TreeError::ProxyError { node });
            }
            let deviation = match &tables.deviation {
                Some(all) => all[node],
                None => Deviation::of_error(error),
            };
            if !deviation.is_valid(error) {
                return Err(TreeError::ProxyDeviation { node });
            }
            let origin = Vec3::from(tables.origin[node]);
            if !origin.is_finite() {
                return Err(TreeError::ProxyOrigin { node });
            }
            nodes.push(ProxyNode {
                center,
                radius,
                subtree: tables.subtree[node],
                first_object: tables.first_object[node],
                object_count: tables.object_count[node],
                depth,
                error,
                deviation,
                mesh: tables.mesh[node],
                origin,
            });
        }
        Ok(Self { visible: tables.visible, nodes, order })
    }

    /// All proxies in depth-first order, parents first.
    pub fn nodes(&self) -> &[ProxyNode] {
        &self.nodes
    }

    /// Place in tree order of the object at a position in proxy order.
    ///
    /// # Panics
    /// If the proxies have an order of their own and `position` is not below the number of objects.
    pub fn object(&self, position: u32) -> u32 {
        self.order.as_ref().map_or(position, |order| order.places[position as usize])
    }

    /// Position in proxy order of the object at a place in tree order.
    ///
    /// # Panics
    /// If the proxies have an order of their own and `place` is not below the number of objects.
    pub fn position(&self, place: u32) -> u32 {
        self.order.as_ref().map_or(place, |order| order.positions[place as usize])
    }

    /// Innermost proxy of each object, in proxy order, up to the last object that has one.
    pub(crate) fn innermost(&self) -> impl Iterator<Item = Option<u32>> {
        let end = self.nodes.iter().map(|node| node.objects().end).max().unwrap_or(0);
        let mut result = vec![None; end as usize];
        for (index, node) in self.nodes.iter().enumerate() {
            // A proxy's own objects come first: they end where its first child's begin.
            let first_child = self.nodes.get(index + 1).filter(|_| node.subtree > 1);
            let end = first_child.map_or(node.objects().end, |child| child.first_object);
            result[node.first_object as usize..end as usize].fill(Some(index as u32));
        }
        result.into_iter()
    }

    /// Parent of each proxy.
    pub(crate) fn parents(&self) -> Vec<Option<u32>> {
        nesting::parents(self.nodes.iter().map(|node| node.depth))
    }

    /// Proxies hold only what is visible from outside of their spheres.
    pub fn visible_only(&self) -> bool {
        self.visible
    }
}

impl Order {
    fn new(places: Vec<u32>, object_count: u32) -> Result<Self, TreeError> {
        // From here on the count is backed by a table's length.
        expect_length("PROXY_OBJECT", places.len(), u64::from(object_count))?;
        let mut positions = vec![u32::MAX; places.len()];
        for (position, &place) in places.iter().enumerate() {
            match positions.get_mut(place as usize) {
                Some(free @ &mut u32::MAX) => *free = position as u32,
                _ => return Err(TreeError::ProxyOrder { value: place }),
            }
        }
        Ok(Self { places, positions })
    }
}

#[cfg(test)]
mod tests;
