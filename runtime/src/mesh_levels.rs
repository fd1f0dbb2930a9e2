//! Simplified versions of single meshes.

use crate::deviation::Deviation;
use crate::error::DecodeError;
use crate::format::MeshLevelsJson;
use crate::sorting::repeated;

/// Simplified versions of one glTF mesh, coarser and coarser, for any object that has it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshLevels {
    /// glTF mesh of the originals.
    pub mesh: u32,
    /// At least one, at most 64, their errors never falling.
    pub levels: Vec<MeshLevel>,
}

/// One simplified version of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshLevel {
    /// glTF mesh.
    pub mesh: u32,
    /// Geometric error, metres of mesh space, finite and not negative. In the space of a tree: times the largest singular
    /// value of the linear part of the transform from mesh to tree.
    pub error: f32,
    /// How much of the original it shows wrong; lengths in metres of mesh space.
    pub deviation: Deviation,
}

/// Most levels of a mesh.
pub(crate) const MOST_LEVELS: usize = 64;

/// Checks `meshLevels`.
pub(crate) fn read(entries: &[MeshLevelsJson]) -> Result<Vec<MeshLevels>, DecodeError> {
    let repeated = repeated(entries.iter().map(|entry| entry.mesh));
    entries
        .iter()
        .enumerate()
        .map(|(entry, json)| {
            let problem = |problem| Err(DecodeError::MeshLevels { entry, problem });
            if repeated == Some(json.mesh) {
                return problem("another entry names the same mesh");
            }
            if json.levels.is_empty() || json.levels.len() > MOST_LEVELS {
                return problem("there must be 1 to 64 levels");
            }
            let mut least = 0.0;
            let mut levels = Vec::with_capacity(json.levels.len());
            for level in &json.levels {
                let error = level.error as f32;
                if !(error.is_finite() && error >= least) {
                    return problem("errors must be finite, not negative and not fall");
                }
                least = error;
                let deviation = level.deviation.map_or(Deviation::of_error(error), |[mean, rms, wrong]| {
                    Deviation { mean: mean as f32, rms: rms as f32, wrong: wrong as f32 }
                });
                if !deviation.is_valid(error) {
                    return problem("a deviation must be in order: 0 <= mean <= rms <= error, wrong 0 to 1");
                }
                levels.push(MeshLevel { mesh: level.mesh, error, deviation });
            }
            Ok(MeshLevels { mesh: json.mesh, levels })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::MeshLevelJson;

    fn entry(mesh: u32, errors: &[f64]) -> MeshLevelsJson {
        let levels = errors.iter().enumerate();
        let levels = levels.map(|(k, &error)| MeshLevelJson { mesh: 100 + k as u32, error, deviation: None });
        MeshLevelsJson { mesh, levels: levels.collect() }
    }

    #[test]
    fn errors_rise() {
        let read = |errors: &[f64]| read(&[entry(1, &[0.0]), entry(3, errors)]);
        let levels = read(&[0.5, 0.5, 2.0]).unwrap();
        assert_eq!(
            (levels[1].mesh, levels[1].levels[2]),
            (3, MeshLevel { mesh: 102, error: 2.0, deviation: Deviation::of_error(2.0) })
        );
        for bad in [&[][..], &[1.0, 0.5], &[-1.0], &[f64::NAN], &[1e300], &[0.0; 65]] {
            assert!(matches!(read(bad), Err(DecodeError::MeshLevels { entry: 1, .. })), "{bad:?}");
        }
    }

    #[test]
    fn a_mesh_has_one_entry() {
        let twice = read(&[entry(3, &[1.0]), entry(3, &[1.0])]);
        assert!(matches!(twice, Err(DecodeError::MeshLevels { entry: 0, .. })));
        assert_eq!(read(&[]).unwrap(), []);
    }
}
