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
    /// Of each its error and the three numbers of its `deviation`, in units of mesh space; the latter NaN if absent.
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
        let mut trees = Vec::with_capacity(self.trees.len());
        for (index, tree) in self.trees.iter().enumerate() {
            trees.push(tree.json(index, proxies)?);
        }
        let levels: &[MeshLevelsTable] = if proxies { &self.mesh_levels } else { &[] };
        let levels: Vec<MeshLevelsJson> = levels.iter().map(MeshLevelsTable::json).collect();
        Ok(Visibility::from_parsed(&self.version, trees, &levels, self)?)
    }

    /// There is something to draw in place of objects.
    pub(crate) fn has_proxies(&self) -> bool {
        !self.mesh_levels.is_empty() || self.trees.iter().any(TreeNumbers::has_proxies)
    }
}

impl MeshLevelsTable {
    fn json(&self) -> MeshLevelsJson {
        let levels = self.meshes.iter().zip(self.errors.as_chunks().0);
        let level = |(&mesh, &[error, mean, rms, wrong]): (&u32, &[f64; 4])| MeshLevelJson {
            mesh,
            error,
            deviation: (!mean.is_nan()).then_some([mean, rms, wrong]),
        };
        MeshLevelsJson { mesh: self.mesh, levels: levels.map(level).collect() }
    }
}

/// Places in [`TreeNumbers::numbers`].
const TABLES: usize = 6;
const PROXIES: usize = 14;
const END: usize = 24;

/// Reads numbers. The first one that is not what it must be is kept, and 0 stands for it.
struct Numbers<'a> {
    numbers: &'a [f64],
    wrong: Option<&'static str>,
}

impl Numbers<'_> {
    fn number(&self, place: usize) -> f64 {
        self.numbers.get(place).copied().unwrap_or(-1.0)
    }

    fn optional(&mut self, place: usize, property: &'static str) -> Option<u32> {
        let number = self.number(place);
        if number == -1.0 {
            return None;
        }
        if number != f64::from(number as u32) {
            self.wrong.get_or_insert(property);
        }
        Some(number as u32)
    }

    fn required(&mut self, place: usize, property: &'static str) -> u32 {
        self.optional(place, property).unwrap_or_else(|| {
            self.wrong.get_or_insert(property);
            0
        })
    }

    /// An accessor, counted from the first of the tables.
    fn table(&mut self, place: usize) -> Option<u32> {
        self.optional(TABLES + place, "tables")
    }

    fn proxy_table(&mut self, place: usize) -> u32 {
        self.required(PROXIES + place, PROXY_TABLES)
    }
}

const PROXY_TABLES: &str = "proxies/tables";

impl TreeNumbers {
    fn has_proxies(&self) -> bool {
        self.numbers.len() == END
    }

    fn json(&self, tree: usize, proxies: bool) -> Result<TreeJson, SceneError> {
        let mut numbers = Numbers { numbers: &self.numbers, wrong: None };
        let proxies = (proxies && self.has_proxies()).then(|| ProxiesJson {
            visible: numbers.required(PROXIES, "proxies/visible") == 1,
            tables: ProxyTables {
                sphere: numbers.proxy_table(1),
                subtree: numbers.proxy_table(2),
                first_object: numbers.proxy_table(3),
                object_count: numbers.proxy_table(4),
                object: numbers.optional(PROXIES + 5, PROXY_TABLES),
                error: numbers.proxy_table(6),
                mesh: numbers.proxy_table(7),
                origin: numbers.proxy_table(8),
                deviation: numbers.optional(PROXIES + 9, PROXY_TABLES),
            },
        });
        let (importance_area, quality, triangles) = (numbers.number(3), numbers.number(4), numbers.number(5));
        let json = TreeJson {
            scene: numbers.optional(0, "scene"),
            anchors: self.anchors.clone(),
            directions: self.directions.clone(),
            object_count: numbers.required(1, "objectCount"),
            level_bits: u8::try_from(numbers.required(2, "levelBits")).unwrap_or(0),
            importance_area: if importance_area.is_finite() { importance_area } else { -1.0 },
            tables: Tables {
                node_sphere: numbers.table(0),
                node_subtree: numbers.table(1),
                node_first_object: numbers.table(2),
                node_object_count: numbers.table(3),
                object_order: numbers.table(4),
                level_row: numbers.table(5),
                level_row_index: numbers.table(6),
                importance: numbers.table(7),
            },
            proxies,
            nested: (self.nested.chunks_exact(3))
                .map(|n| NestedJson { object: n[0], tree: n[1], anchor: n[2] })
                .collect(),
            recommended: (quality >= 0.0).then_some(RecommendedJson { quality }),
            fingerprint: (!self.hash.is_empty())
                .then(|| FingerprintJson { triangles: triangles as u64, hash: self.hash.clone() }),
        };
        let expected = "a number, or absent where that is allowed";
        numbers.wrong.map_or(Ok(json), |property| Err(SceneError::Number { tree, property, expected }))
    }
}
