//! Boxes of objects, as the engine's loader knows them.

use glam::Vec3;
use thiserror::Error;

/// Axis-aligned box of one object in tree space, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

/// Why boxes cannot be used.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum BoundsError {
    /// Not one box per object of the tree: the scene is not the one that was baked.
    #[error("tree {tree} has {expected} objects, but {found} boxes were given")]
    Count {
        /// Index of the tree (0 for a [`crate::Culler`]).
        tree: usize,
        /// Boxes given.
        found: usize,
        /// Objects in the tree.
        expected: usize,
    },
    /// Not finite, or a minimum above its maximum.
    #[error("tree {tree}, object {object}: its box is not finite or inside out")]
    Box {
        /// Index of the tree (0 for a [`crate::Culler`]).
        tree: usize,
        /// Place in tree order.
        object: usize,
    },
    /// Not one list of boxes per tree.
    #[error("there are {expected} trees, but {found} lists of boxes were given")]
    Trees {
        /// Lists given.
        found: usize,
        /// Number of trees.
        expected: usize,
    },
    /// There is no such tree.
    #[error("there is no tree {tree}")]
    NoTree {
        /// Index given.
        tree: usize,
    },
    /// Not one triangle count per object of the tree.
    #[error("tree {tree} has {expected} objects, but {found} triangle counts were given")]
    Triangles {
        /// Index of the tree.
        tree: usize,
        /// Counts given.
        found: usize,
        /// Objects in the tree.
        expected: usize,
    },
    /// Not one triangle count per proxy of the tree.
    #[error("tree {tree} has {expected} proxies, but {found} triangle counts were given")]
    ProxyTriangles {
        /// Index of the tree.
        tree: usize,
        /// Counts given.
        found: usize,
        /// Proxies of the tree.
        expected: usize,
    },
    /// Where levels start does not ascend from 0 to their number, with one entry per object and one more.
    #[error("tree {tree}: where the levels of its objects start does not fit the objects and the levels")]
    LevelStarts {
        /// Index of the tree.
        tree: usize,
    },
    /// More than 64 levels, errors that are not finite or fall, or triangles that rise.
    #[error("tree {tree}, object {object}: its levels do not get coarser and coarser, or are more than 64")]
    Levels {
        /// Index of the tree.
        tree: usize,
        /// Place in tree order.
        object: usize,
    },
    /// Where levels start does not ascend from 0 to their number, with one entry per loose object and one more.
    #[error("where the levels of loose objects start does not fit the objects and the levels")]
    LooseLevelStarts,
    /// More than 64 levels, errors that are not finite or fall, or triangles that rise.
    #[error("loose object {object}: its levels do not get coarser and coarser, or are more than 64")]
    LooseLevels {
        /// Index of the loose object.
        object: usize,
    },
    /// Not one triangle count per loose object, or more objects than can be numbered.
    #[error("{boxes} boxes of loose objects, but {triangles} triangle counts were given")]
    LooseCount {
        /// Boxes given.
        boxes: usize,
        /// Triangle counts given.
        triangles: usize,
    },
    /// Not finite, or a minimum above its maximum.
    #[error("loose object {object}: its box is not finite or inside out")]
    LooseBox {
        /// Index of the loose object.
        object: usize,
    },
}

impl Bounds {
    /// The box of nothing: any box extends it.
    pub(crate) const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    pub(crate) fn is_valid(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    pub(crate) fn extend(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }
}
