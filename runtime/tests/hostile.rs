//! Files that lie: never a panic, never more memory than the file holds, always a typed error or a usable tree.

mod common;

use common::{Accessors, camera, encode, extension, sample, some_proxies};
use proptest::prelude::*;
use serde_json::{Value, json};
use svs_runtime::{
    Bounds, Budget, DecodeError, Detail, Placement, Proxies, ProxyTables, Query, SceneCuller, Settings, Tree,
    TreeError, TreeTables, Visibility,
};

/// A valid two-tree extension, the second inside the first.
fn valid(seed: u64) -> (Value, Accessors) {
    let (mut outer, mut inner) = (sample(seed, false).tables, sample(seed + 1, false).tables);
    outer.nested = vec![svs_runtime::Nested { object: 0, tree: 1, anchor: 0 }];
    outer.object_order = Some((0..outer.object_count).rev().collect());
    inner.placement = Placement::Anchors(vec![3]);
    outer.proxies = Some(some_proxies(outer.object_count));
    inner.proxies = Some(ProxyTables { object: None, ..some_proxies(inner.object_count) });
    let mut accessors = Accessors::default();
    let trees = vec![encode(&outer, &mut accessors), encode(&inner, &mut accessors)];
    let mut extension = extension(trees);
    extension["meshLevels"] =
        json!([{"mesh": 1, "levels": [{"mesh": 4, "error": 0.5}, {"mesh": 5, "error": 2}]}]);
    (extension, accessors)
}

/// Whatever was decoded can be used.
fn use_it(visibility: &Visibility) {
    let unit = |tree: &Tree| {
        vec![Bounds { min: glam::Vec3::splat(-1.0), max: glam::Vec3::ONE }; tree.object_count().min(10_000)]
    };
    let bounds: Vec<_> = visibility.trees().iter().map(|tree| unit(tree)).collect();
    let Ok(mut culler) = SceneCuller::new(visibility, &bounds) else { return };
    for query in [Query::Object, Query::SphereWeighted3] {
        culler.cull(&camera(5), &Settings { query, ..Settings::from_quality(0.95) });
        for budget in [Budget::Unlimited, Budget::Triangles(20)] {
            let detail = Detail { tau: 4.0, ..Detail::default() };
            culler.select(&camera(5), &Settings { query, ..Settings::default() }, &detail, &budget);
        }
        culler.set_hidden(svs_runtime::Draw { tree: 0, anchor: 0, object: 0 }, true);
    }
}

/// Every place in a JSON value, as pointers.
fn pointers(value: &Value, at: String, out: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, v)| pointers(v, format!("{at}/{k}"), out));
        }
        Value::Object(members) => members.iter().for_each(|(k, v)| pointers(v, format!("{at}/{k}"), out)),
        _ => {}
    }
    out.push(at);
}

fn replacement() -> impl Strategy<Value = Value> {
    prop_oneof![
        any::<u32>().prop_map(|v| json!(v)),
        (0_u32..40).prop_map(|v| json!(v)),
        any::<i64>().prop_map(|v| json!(v)),
        any::<f64>().prop_map(|v| json!(v)),
        Just(json!(null)),
        Just(json!([])),
        Just(json!({})),
        Just(json!([[[0]]])),
        Just(json!("icosahedron-1")),
        Just(json!("1.0")),
        Just(serde_json::from_str("1e999").unwrap_or(json!(0))),
        Just(serde_json::from_str("123456789012345678901234567890").unwrap_or(json!(0))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn mutated_json_is_safe(
        seed in 0_u64..50, edits in prop::collection::vec((any::<usize>(), replacement()), 1..4),
    ) {
        let (mut json, accessors) = valid(seed);
        for (at, value) in edits {
            let mut all = Vec::new();
            pointers(&json, String::new(), &mut all);
            if let Some(place) = json.pointer_mut(&all[at % all.len()]) {
                *place = value;
            }
        }
        if let Ok(visibility) = Visibility::decode(&json, &accessors) {
            use_it(&visibility);
        }
    }

    #[test]
    fn mutated_bytes_are_safe(
        seed in 0_u64..50, edits in prop::collection::vec((any::<usize>(), any::<usize>(), any::<u8>()), 1..4),
    ) {
        let (json, mut accessors) = valid(seed);
        let tables = accessors.0.len();
        for (table, at, value) in edits {
            let bytes = &mut accessors.0[table % tables].0;
            let length = bytes.len().max(1);
            if let Some(byte) = bytes.get_mut(at % length) {
                *byte = value;
            }
        }
        if let Ok(visibility) = Visibility::decode(&json, &accessors) {
            use_it(&visibility);
        }
    }

    #[test]
    fn mutated_accessors_are_safe(
        seed in 0_u64..50, table: usize, kind in 5120_u32..5128, components in 0_u32..17, count: Option<usize>,
        cut: usize,
    ) {
        let (json, mut accessors) = valid(seed);
        let tables = accessors.0.len();
        let accessor = &mut accessors.0[table % tables];
        accessor.0.truncate(cut % (accessor.0.len() + 1));
        (accessor.1, accessor.2) = (kind, components);
        accessor.3 = count.unwrap_or(accessor.3);
        if let Ok(visibility) = Visibility::decode(&json, &accessors) {
            use_it(&visibility);
        }
    }

    #[test]
    fn random_text_is_safe(text in ".{0,200}", bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(Visibility::decode_json(&text, &Accessors::default()).is_err());
        let text = String::from_utf8_lossy(&bytes);
        prop_assert!(Visibility::decode_json(&text, &Accessors::default()).is_err());
    }

    #[test]
    fn what_is_written_is_read(seed: u64) {
        let mut tables = sample(seed, false).tables;
        tables.proxies = Some(some_proxies(tables.object_count));
        let mut accessors = Accessors::default();
        let tree = encode(&tables, &mut accessors);
        let visibility = Visibility::decode(&extension(vec![tree]), &accessors).unwrap();
        let (decoded, direct) = (&visibility.trees()[0], Tree::new(tables).unwrap());
        prop_assert_eq!(decoded.nodes(), direct.nodes());
        let nodes = |tree: &Tree| tree.proxies().map(|proxies: &Proxies| proxies.nodes().to_vec());
        prop_assert_eq!(nodes(decoded), nodes(&direct));
        let places = |tree: &Tree| {
            let objects = 0..tree.object_count() as u32;
            tree.proxies().map(|proxies| objects.map(|k| proxies.object(k)).collect::<Vec<_>>())
        };
        prop_assert_eq!(places(decoded), places(&direct));
        for object in 0..direct.object_count() {
            prop_assert_eq!(decoded.depth(object), direct.depth(object));
            for d in 0..direct.direction_set().len() {
                prop_assert_eq!(decoded.level(object, d), direct.level(object, d));
            }
            for height in 0..7 {
                let areas = (decoded.importance_area(object, height), direct.importance_area(object, height));
                prop_assert_eq!(areas.0, areas.1);
            }
        }
    }
}

fn tree_error(json: &Value, accessors: &Accessors) -> TreeError {
    match Visibility::decode(json, accessors) {
        Err(DecodeError::Tree { source, .. }) => source,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_count_without_data_is_refused() {
    let (mut json, accessors) = valid(1);
    json["trees"][0]["objectCount"] = json!(4_000_000_000_u32);
    assert!(matches!(tree_error(&json, &accessors), TreeError::TableLength { .. }));
    // Without any table the count stands alone; nothing is allocated for it, and nothing is drawn without boxes.
    json["trees"][0]["tables"] = json!({});
    json["trees"][0]["proxies"]["tables"]["PROXY_OBJECT"] = json!(null);
    let visibility = Visibility::decode(&json, &accessors).unwrap();
    assert_eq!(visibility.trees()[0].object_count(), 4_000_000_000);
    assert_eq!(visibility.trees()[0].level(3_999_999_999, 5), 0);
    let boxes: [&[Bounds]; 2] = [&[], &[]];
    assert!(SceneCuller::new(&visibility, &boxes).is_err());
}

#[test]
fn other_versions_are_refused() {
    let (mut json, accessors) = valid(1);
    for (version, ok) in [("1.7", true), ("1", true), ("2.0", false), ("10", false), ("", false)] {
        json["version"] = json!(version);
        assert_eq!(Visibility::decode(&json, &accessors).is_ok(), ok, "{version}");
    }
}

/// A chain of nodes as deep as the table is long: linear time, no recursion.
#[test]
fn deep_chains_are_fine() {
    let n = 100_000_u32;
    let tables = TreeTables {
        node_sphere: vec![[0.0, 0.0, 0.0, 1.0]; n as usize],
        node_subtree: (1..=n).rev().collect(),
        node_first_object: vec![0; n as usize],
        node_object_count: vec![n; n as usize],
        object_count: n,
        level_bits: 1,
        level_row: vec![0; 6],
        level_row_index: Some(vec![0; n as usize]),
        importance: Vec::new(),
        ..sample(1, false).tables
    };
    let tables = TreeTables { directions: "icosahedron-1".to_owned(), ..tables };
    let tree = Tree::new(tables).unwrap();
    assert_eq!(tree.depth(0), n);
    use_it(&Visibility::new(vec![tree]).unwrap());
}

#[test]
fn each_inconsistency_has_its_error() {
    let valid = sample(11, false).tables;
    let broken = |edit: &dyn Fn(&mut TreeTables)| {
        let mut tables = valid.clone();
        edit(&mut tables);
        Tree::new(tables).unwrap_err()
    };
    let last = valid.node_sphere.len() - 1;
    assert!(matches!(broken(&|t| t.directions = "cub".into()), TreeError::Directions { .. }));
    assert!(matches!(broken(&|t| t.level_bits = 3), TreeError::LevelBits { found: 3 }));
    assert!(matches!(broken(&|t| t.importance_area = f64::NAN), TreeError::ImportanceArea));
    assert!(matches!(broken(&|t| t.placement = Placement::Anchors(vec![])), TreeError::Placement));
    assert!(matches!(broken(&|t| t.recommended_quality = Some(1.5)), TreeError::Quality));
    assert!(matches!(broken(&|t| t.node_sphere[0][3] = -1.0), TreeError::Sphere { node: 0 }));
    assert!(matches!(broken(&|t| t.node_sphere[0][0] = f32::NAN), TreeError::Sphere { node: 0 }));
    assert!(matches!(broken(&|t| t.node_subtree[last] = 0), TreeError::Subtree { .. }));
    assert!(matches!(broken(&|t| t.node_subtree[last] = 2), TreeError::Subtree { .. }));
    assert!(matches!(broken(&|t| t.node_subtree[0] = u32::MAX), TreeError::Subtree { node: 0 }));
    assert!(matches!(broken(&|t| t.node_object_count[last] = u32::MAX), TreeError::ObjectRange { .. }));
    assert!(matches!(broken(&|t| t.node_first_object[0] = u32::MAX), TreeError::ObjectRange { node: 0 }));
    assert!(matches!(broken(&|t| t.importance.push(0)), TreeError::TableLength { table: "IMPORTANCE", .. }));
    let count = valid.object_count as usize;
    assert!(matches!(broken(&|t| t.object_order = Some(vec![7; count])), TreeError::Order { value: 7 }));
    assert!(matches!(broken(&|t| t.level_row_index = Some(vec![9999; count])), TreeError::Row { .. }));
    let high = |t: &mut TreeTables| {
        t.level_bits = 8;
        t.level_row = vec![200; 66];
        t.level_row_index = Some(vec![0; count]);
        t.directions = "octahedron-2".into();
    };
    assert!(matches!(broken(&high), TreeError::Level { level: 200, .. }));
    let nested = |t: &mut TreeTables| {
        t.nested = vec![svs_runtime::Nested { object: count as u32, tree: 0, anchor: 0 }];
    };
    assert!(matches!(broken(&nested), TreeError::Nested { .. }));
}

#[test]
fn many_trees_cannot_multiply_one_large_table() {
    let mut tables = sample(3, false).tables;
    tables.nested = Vec::new();
    let mut accessors = Accessors::default();
    let tree = encode(&tables, &mut accessors);
    // The tree is valid; only its row table is made large, by rows that no object uses.
    let (bytes, _, _, count) = &mut accessors.0[tree["tables"]["LEVEL_ROW"].as_u64().unwrap() as usize];
    bytes.resize(bytes.len() * (1_200_000 / bytes.len()), 0);
    *count = bytes.len();
    let held: usize = accessors.0.iter().map(|accessor| accessor.0.len()).sum();
    let many = |count: usize| extension(vec![tree.clone(); count]);
    assert!(tree["tables"].get("LEVEL_ROW_INDEX").is_some() && held > 1 << 20, "{held}");
    assert!(Visibility::decode(&many(15), &accessors).is_ok());
    let error = Visibility::decode(&many(17), &accessors).unwrap_err();
    assert!(matches!(error, DecodeError::TablesTooLarge { tree: 16 }), "{error}");
}

/// A chain of proxies as deep as the table is long, split and refined step by step.
#[test]
fn deep_chains_of_proxies_are_fine() {
    let n = 20_000_u32;
    let chain = ProxyTables {
        visible: true,
        sphere: vec![[0.0, 0.0, 0.0, 1.0]; n as usize],
        subtree: (1..=n).rev().collect(),
        first_object: (0..n).collect(),
        object_count: (1..=n).rev().collect(),
        object: None,
        error: vec![1.0; n as usize],
        deviation: None,
        mesh: vec![0; n as usize],
        origin: vec![[0.0; 3]; n as usize],
    };
    let mut tables = TreeTables {
        node_sphere: Vec::new(),
        node_subtree: Vec::new(),
        node_first_object: Vec::new(),
        node_object_count: Vec::new(),
        object_count: n,
        level_row: Vec::new(),
        level_row_index: None,
        importance: Vec::new(),
        proxies: Some(chain),
        ..sample(1, false).tables
    };
    use_it(&Visibility::new(vec![Tree::new(tables.clone()).unwrap()]).unwrap());
    if let Some(proxies) = &mut tables.proxies {
        proxies.error[7] = 2.0;
    }
    let TreeError::Proxies(error) = Tree::new(tables).unwrap_err() else { panic!("not of the proxies") };
    assert_eq!(*error, TreeError::ProxyError { node: 7 });
}

#[test]
fn broken_proxies_and_levels_are_refused() {
    let (valid, accessors) = valid(1);
    assert_eq!(Visibility::decode(&valid, &accessors).unwrap().mesh_levels()[0].levels.len(), 2);
    let mut json = valid.clone();
    json["trees"][0]["proxies"]["tables"]["PROXY_ERROR"] = json!(9999);
    let error = tree_error(&json, &accessors);
    assert_eq!(error, TreeError::Accessor { table: "PROXY_ERROR", accessor: 9999 });
    let mut json = valid.clone();
    json["trees"][0]["proxies"]["tables"]["PROXY_ORIGIN"] =
        valid["trees"][0]["tables"]["NODE_SPHERE"].clone();
    assert!(matches!(tree_error(&json, &accessors), TreeError::AccessorType { table: "PROXY_ORIGIN", .. }));
    let mut json = valid.clone();
    json["meshLevels"][0]["levels"][1]["error"] = json!(0.25);
    let error = Visibility::decode(&json, &accessors).unwrap_err();
    assert!(matches!(error, DecodeError::MeshLevels { entry: 0, .. }), "{error}");
    let mut json = valid.clone();
    json["trees"][0]["proxies"] = json!({"visible": true});
    assert!(matches!(Visibility::decode(&json, &accessors), Err(DecodeError::Json(_))));
}
