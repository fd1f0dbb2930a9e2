//! Primitive modes to triangles (glTF 2.0, 3.7.2.1).

/// Primitive mode that has triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// `Some(None)` for points and lines; `None` for a number that is no mode.
    pub(crate) fn from_mode(mode: usize) -> Option<Option<Topology>> {
        match mode {
            0..=3 => Some(None),
            4 => Some(Some(Topology::List)),
            5 => Some(Some(Topology::Strip)),
            6 => Some(Some(Topology::Fan)),
            _ => None,
        }
    }

    /// Triangles made of `corners` indices; an incomplete last one is ignored.
    pub(crate) fn triangle_count(self, corners: usize) -> usize {
        match self {
            Topology::List => corners / 3,
            Topology::Strip | Topology::Fan => corners.saturating_sub(2),
        }
    }

    /// Places of triangle `t`'s corners in the index list; all triangles face the same way.
    pub(crate) fn corners(self, t: usize) -> [usize; 3] {
        match self {
            Topology::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Topology::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Topology::Fan => [t + 1, t + 2, 0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(topology: Topology, corners: usize) -> Vec<[usize; 3]> {
        (0..topology.triangle_count(corners)).map(|t| topology.corners(t)).collect()
    }

    #[test]
    fn triangles_are_those_of_the_specification() {
        assert_eq!(all(Topology::List, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(all(Topology::Strip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(all(Topology::Fan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            for corners in 0..3 {
                assert!(all(topology, corners).is_empty());
            }
        }
    }
}
