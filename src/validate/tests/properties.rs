//! Whatever is done to a document: validation ends, and what it lets pass can be decoded.

use super::sample::Sample;
use crate::gltf::Document;
use crate::validate::{ROOT, ValidationReport, tables, validate};
use proptest::prelude::*;
use serde_json::{Value, json};
use svs_runtime::Visibility;

/// Pointers of everything in a JSON value, itself included.
fn pointers(value: &Value, at: String, out: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| pointers(item, format!("{at}/{i}"), out));
        }
        Value::Object(items) => {
            items.iter().for_each(|(key, item)| pointers(item, format!("{at}/{key}"), out))
        }
        _ => {}
    }
    out.push(at);
}

fn replacement() -> impl Strategy<Value = Value> {
    prop_oneof![
        (0u32..12).prop_map(|number| json!(number)),
        any::<u32>().prop_map(|number| json!(number)),
        any::<i64>().prop_map(|number| json!(number)),
        (-10.0..10.0).prop_map(|number: f64| json!(number)),
        Just(json!(null)),
        Just(json!([])),
        Just(json!({})),
        Just(json!([0, 1])),
        Just(json!("icosahedron")),
        Just(json!(true)),
    ]
}

/// Replaces something below `root`.
fn change(json: &mut Value, root: &str, choice: prop::sample::Index, value: Value) {
    let mut all = Vec::new();
    if let Some(below) = json.pointer(root) {
        pointers(below, root.to_owned(), &mut all);
        *json.pointer_mut(&all[choice.index(all.len())]).unwrap() = value;
    }
}

fn sample(nested: bool) -> Sample {
    if nested { Sample::nested() } else { Sample::example() }
}

fn check(sample: &Sample) -> Result<(), TestCaseError> {
    // Not everything that breaks is ours to judge.
    let Ok(doc) = Document::from_parts(sample.json.clone(), Some(sample.bin.clone())) else { return Ok(()) };
    let report = validate(&doc);
    if let Some(extension) = doc.json.pointer(ROOT).filter(|_| !report.has_errors()) {
        let tables = tables::read(&doc, extension, &mut ValidationReport::default()).unwrap();
        let decoded = Visibility::decode(extension, &tables);
        prop_assert!(decoded.is_ok(), "{:?}", decoded.err());
    }
    Ok(())
}

proptest! {
    #[test]
    fn broken_json(
        nested: bool,
        changes in prop::collection::vec((any::<bool>(), any::<prop::sample::Index>(), replacement()), 1..4),
    ) {
        let mut sample = sample(nested);
        for (anywhere, choice, value) in changes {
            change(&mut sample.json, if anywhere { "" } else { ROOT }, choice, value);
        }
        check(&sample)?;
    }

    #[test]
    fn broken_bytes(
        nested: bool,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut sample = sample(nested);
        for (place, byte) in changes {
            let place = place.index(sample.bin.len());
            sample.bin[place] = byte;
        }
        check(&sample)?;
    }
}
