//! The extension in numbers, and its tables.

use crate::SceneError;
use svs_runtime::format::{
    FingerprintJson, MeshLevelJson, MeshLevelsJson, NestedJson, ProxiesJson, ProxyTables, RecommendedJson,
    Tables, TreeJson,
};
use svs_runtime::{AccessorSource, AccessorView, Visibility};

/// The extension as JavaScript has read it, unchecked.
#[derive(Clone, Debug, Default)]
pub struct Bake {
    /// `version`.
    pub version: String,
    /// `trees`.
    pub trees: Vec<TreeNumbers>,
    /// `meshLevels`.
    pub mesh_levels: Vec<MeshLevelsTable>,
    /// The accessors that the trees name, ascending.
    pub accessors: Vec<Accessor>,
}

/// One accessor, its elements tightly packed.
#[derive(Clone, Debug, Default)]
pub struct Accessor {
    /// Index in the document.
    pub index: u32,
    /// glTF component type.
    pub component_type: u32,
    /// Components per element.
    pub components: u32,
    /// Elements.
    pub count: u32,
    /// Little-endian.
    pub bytes: Vec<u8>,
}

/// One tree.
#[derive(Clone, Debug, Default)]
pub struct TreeNumbers {
    /// `directions`.
    pub directions: String,
    /// `anchors`.
    pub anchors: Vec<u32>,
    /// In this order: `scene`, `objectCount`, `levelBits`, `importanceArea`, `recommended.quality`, `fingerprint.triangles`,
    /// then the accessors of the tables (NODE_SPHERE, NODE_SUBTREE, NODE_FIRST_OBJECT, NODE_OBJECT_COUNT, OBJECT_ORDER,
    /// LEVEL_ROW, LEVEL_ROW_INDEX, IMPORTANCE) and, if there are proxies, `visible` as 0 or 1 and theirs (PROXY_SPHERE,
    /// PROXY_SUBTREE, PROXY_FIRST_OBJECT, PROXY_OBJECT_COUNT, PROXY_OBJECT, PROXY_ERROR, PROXY_MESH, PROXY_ORIGIN,
    /// PROXY_DEVIATION).
    /// -1 stands for what is absent, NaN for what is no number.
    pub numbers: Vec<f64>,
    /// `object`, `tree` and `anchor` of each of `nested`.
    pub nested: Vec<u32>,
    /// `fingerprint.hash`; empty without.
    pub hash: String,
}

/// Simplified versions of a mesh.
#[derive(Clone, Debug, Default)]
pub struct MeshLevelsTable {
    /// Mesh of the originals.
    pub mesh: u32,
    /// Simplified meshes.
    pub meshes: Vec<u32>,
    /// Of each its error and the three numbers of its `deviation`, in units of mesh space; the latter negative if absent.
    pub errors: Vec<f64>,
}

impl AccessorSource for Bake {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let found = self.accessors.binary_search_by_key(&index, |accessor| accessor.index as usize).ok()?;
        let Accessor { component_type, components, count, bytes, .. } = &self.accessors[found];
        let (component_type, components) = (*component_type, *components);
        Some(AccessorView { bytes, component_type, components, count: *count as usize })
    }
}

impl Bake {
    /// The trees, with their proxies or without.
    pub(crate) fn decode(&self, proxies: bool) -> Result<Visibility, SceneError> {
        let trees: Result<Vec<TreeJson>, SceneError> =
            self.trees.iter().enumerate().map(|(index, tree)| tree.json(index, proxies)).collect();
        let levels = self.mesh_levels.iter().filter(|_| proxies).map(|entry| MeshLevelsJson {
            mesh: entry.mesh,
            levels: (entry.meshes.iter().zip(entry.errors.as_chunks().0))
                .map(|(&mesh, &[error, mean, rms, wrong])| MeshLevelJson {
                    mesh,
                    error,
                    deviation: (mean >= 0.0).then_some([mean, rms, wrong]),
                })
                .collect(),
        });
        let levels: Vec<MeshLevelsJson> = levels.collect();
        Ok(Visibility::from_parsed(&self.version, trees?, &levels, self)?)
    }

    /// There is something to draw in place of objects.
    pub(crate) fn has_proxies(&self) -> bool {
        !self.mesh_levels.is_empty() || self.trees.iter().any(TreeNumbers::has_proxies)
    }
}

/// Places in [`TreeNumbers::numbers`].
const TABLES: usize = 6;
const PROXIES: usize = 14;
const END: usize = 24;

impl TreeNumbers {
    fn has_proxies(&self) -> bool {
        self.numbers.len() == END
    }

    fn json(&self, tree: usize, proxies: bool) -> Result<TreeJson, SceneError> {
        let expected = "a number, or absent where that is allowed";
        let wrong = |property| SceneError::Number { tree, property, expected };
        let number = |place: usize| self.numbers.get(place).copied().unwrap_or(-1.0);
        let optional = |place: usize, property: &'static str| -> Result<Option<u32>, SceneError> {
            let number = number(place);
            match number {
                -1.0 => Ok(None),
                _ if number == f64::from(number as u32) => Ok(Some(number as u32)),
                _ => Err(wrong(property)),
            }
        };
        let required = |place, property| optional(place, property)?.ok_or(wrong(property));
        let table = |place| optional(place, "tables");
        let proxy_table = |place| required(place, "proxies/tables");
        let importance_area = number(3);
        let proxies = if proxies && self.has_proxies() {
            Some(ProxiesJson {
                visible: required(PROXIES, "proxies/visible")? == 1,
                tables: ProxyTables {
                    sphere: proxy_table(PROXIES + 1)?,
                    subtree: proxy_table(PROXIES + 2)?,
                    first_object: proxy_table(PROXIES + 3)?,
                    object_count: proxy_table(PROXIES + 4)?,
                    object: optional(PROXIES + 5, "proxies/tables")?,
                    error: proxy_table(PROXIES + 6)?,
                    mesh: proxy_table(PROXIES + 7)?,
                    origin: proxy_table(PROXIES + 8)?,
                    deviation: optional(PROXIES + 9, "proxies/tables")?,
                },
            })
        } else {
            None
        };
        let triangles = number(5);
        Ok(TreeJson {
            scene: optional(0, "scene")?,
            anchors: self.anchors.clone(),
            directions: self.directions.clone(),
            object_count: required(1, "objectCount")?,
            level_bits: u8::try_from(required(2, "levelBits")?).unwrap_or(0),
            importance_area: if importance_area.is_finite() { importance_area } else { -1.0 },
            tables: Tables {
                node_sphere: table(TABLES)?,
                node_subtree: table(TABLES + 1)?,
                node_first_object: table(TABLES + 2)?,
                node_object_count: table(TABLES + 3)?,
                object_order: table(TABLES + 4)?,
                level_row: table(TABLES + 5)?,
                level_row_index: table(TABLES + 6)?,
                importance: table(TABLES + 7)?,
            },
            proxies,
            nested: (self.nested.chunks_exact(3))
                .map(|n| NestedJson { object: n[0], tree: n[1], anchor: n[2] })
                .collect(),
            recommended: (number(4) >= 0.0).then(|| RecommendedJson { quality: number(4) }),
            fingerprint: (!self.hash.is_empty())
                .then(|| FingerprintJson { triangles: triangles as u64, hash: self.hash.clone() }),
        })
    }
}
