//! The extension object against its JSON Schema (`schema/EXT_spherical_visibility/schema/`).

use super::ROOT;
use super::report::ValidationReport;
use jsonschema::error::ValidationErrorKind as Kind;
use jsonschema::{Registry, ValidationError, Validator};
use serde_json::Value;
use std::sync::OnceLock;

/// Issues of the schema reported at most; a broken file repeats itself.
const MOST: usize = 100;

macro_rules! schema_files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../schema/EXT_spherical_visibility/schema/", $name))),)*]
    };
}

/// The embedded schema files by name; the first is the entry.
const FILES: &[(&str, &str)] = schema_files![
    "glTF.EXT_spherical_visibility.schema.json",
    "tree.EXT_spherical_visibility.schema.json",
    "tables.EXT_spherical_visibility.schema.json",
    "proxies.EXT_spherical_visibility.schema.json",
    "proxyTables.EXT_spherical_visibility.schema.json",
    "meshLevels.EXT_spherical_visibility.schema.json",
    "meshLevel.EXT_spherical_visibility.schema.json",
    "nested.EXT_spherical_visibility.schema.json",
    "recommended.EXT_spherical_visibility.schema.json",
    "fingerprint.EXT_spherical_visibility.schema.json",
    "glTFProperty.schema.json",
    "glTFid.schema.json",
    "extension.schema.json",
    "extras.schema.json",
];

/// Base that the files' relative `$id`s and `$ref`s are resolved against; nothing is ever fetched.
const BASE: &str = "json-schema:///";

/// Adds an issue for every violation of the schema.
pub(super) fn check(extension: &Value, report: &mut ValidationReport) {
    for error in validator().iter_errors(extension).take(MOST) {
        let pointer = format!("{ROOT}{}", error.instance_path());
        report.error(code(&error), pointer, message(&error));
    }
}

/// The names are those of the Khronos validator where it has one.
fn code(error: &ValidationError<'_>) -> &'static str {
    match error.kind() {
        Kind::Type { .. } => "TYPE_MISMATCH",
        Kind::Required { .. } if error.schema_path().as_str().contains("/dependentRequired") => {
            "UNSATISFIED_DEPENDENCY"
        }
        Kind::Required { .. } => "UNDEFINED_PROPERTY",
        Kind::Enum { .. } | Kind::Constant { .. } => "VALUE_NOT_IN_LIST",
        Kind::Minimum { .. }
        | Kind::Maximum { .. }
        | Kind::ExclusiveMinimum { .. }
        | Kind::ExclusiveMaximum { .. } => "VALUE_NOT_IN_RANGE",
        Kind::Pattern { .. } => "PATTERN_MISMATCH",
        Kind::MinItems { .. } => "EMPTY_ENTITY",
        Kind::UniqueItems => "DUPLICATE_ELEMENTS",
        Kind::OneOfMultipleValid { .. } | Kind::OneOfNotValid { .. } => "ONE_OF_MISMATCH",
        _ => "SCHEMA_VIOLATION",
    }
}

/// The library quotes the whole offending value, which may be a long tree.
fn message(error: &ValidationError<'_>) -> String {
    const LONGEST: usize = 200;
    let text = error.to_string();
    if text.chars().count() <= LONGEST { text } else { error.masked().to_string() }
}

fn validator() -> &'static Validator {
    static VALIDATOR: OnceLock<Validator> = OnceLock::new();
    VALIDATOR.get_or_init(|| match build() {
        Ok(validator) => validator,
        Err(error) => unreachable!("the embedded schema is valid, a test builds it: {error}"),
    })
}

fn build() -> Result<Validator, Box<dyn std::error::Error>> {
    let mut registry = Registry::new();
    for (name, text) in FILES {
        registry = registry.add(format!("{BASE}{name}"), serde_json::from_str::<Value>(text)?)?;
    }
    let registry = registry.prepare()?;
    let entry = serde_json::json!({ "$ref": format!("{BASE}{}", FILES[0].0) });
    Ok(jsonschema::options().with_registry(&registry).build(&entry)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn clean() -> Value {
        json!({
            "version": "1.0",
            "generator": "test",
            "trees": [{
                "scene": 0,
                "directions": "icosahedron-1",
                "objectCount": 4,
                "levelBits": 2,
                "importanceArea": 12.5,
                "tables": {
                    "NODE_SPHERE": 1, "NODE_SUBTREE": 2, "NODE_FIRST_OBJECT": 3, "NODE_OBJECT_COUNT": 4,
                    "LEVEL_ROW": 5, "_MINE": 6
                },
                "proxies": {
                    "visible": true,
                    "tables": {
                        "PROXY_SPHERE": 1, "PROXY_SUBTREE": 2, "PROXY_FIRST_OBJECT": 3, "PROXY_OBJECT_COUNT": 4,
                        "PROXY_OBJECT": 5, "PROXY_ERROR": 6, "PROXY_MESH": 7, "PROXY_ORIGIN": 8, "_MINE": 9
                    }
                },
                "nested": [{"object": 3, "tree": 1, "anchor": 0}],
                "recommended": {"quality": 0.5},
                "fingerprint": {"triangles": 123456, "hash": "0123456789abcdef"},
                "extras": {"any": ["thing"]},
                "unknown": true
            }],
            "meshLevels": [{"mesh": 0, "levels": [{"mesh": 1, "error": 0.5}]}],
            "extensions": {"VENDOR_x": {}},
            "extras": 1
        })
    }

    fn codes(extension: &Value) -> Vec<(&'static str, String)> {
        let mut report = ValidationReport::default();
        check(extension, &mut report);
        report.issues.into_iter().map(|issue| (issue.code, issue.pointer)).collect()
    }

    /// Sets `value` at `pointer` (or removes it) and expects exactly one issue, at `at`.
    #[track_caller]
    fn expect(pointer: &str, value: Option<Value>, code: &str, at: &str) {
        let mut extension = clean();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = extension.pointer_mut(parent).unwrap();
        match value {
            Some(value) => parent[key] = value,
            None => _ = parent.as_object_mut().unwrap().remove(key),
        }
        let found = codes(&extension);
        let found: Vec<(&str, &str)> =
            found.iter().map(|(code, pointer)| (*code, pointer.as_str())).collect();
        assert_eq!(found, [(code, format!("{ROOT}{at}").as_str())]);
    }

    #[test]
    fn clean_data_passes() {
        assert_eq!(codes(&clean()), []);
    }

    #[test]
    fn each_violation_has_its_code_and_place() {
        expect("/version", None, "UNDEFINED_PROPERTY", "");
        expect("/version", Some(json!(1)), "TYPE_MISMATCH", "/version");
        expect("/version", Some(json!("one")), "PATTERN_MISMATCH", "/version");
        expect("/trees", Some(json!([])), "EMPTY_ENTITY", "/trees");
        expect("/extensions", Some(json!({"VENDOR_x": 1})), "TYPE_MISMATCH", "/extensions/VENDOR_x");
        expect("/trees/0/levelBits", Some(json!(3)), "VALUE_NOT_IN_LIST", "/trees/0/levelBits");
        expect("/trees/0/objectCount", Some(json!(0)), "VALUE_NOT_IN_RANGE", "/trees/0/objectCount");
        expect("/trees/0/objectCount", Some(json!(1.5)), "TYPE_MISMATCH", "/trees/0/objectCount");
        expect("/trees/0/importanceArea", Some(json!(-1)), "VALUE_NOT_IN_RANGE", "/trees/0/importanceArea");
        expect("/trees/0/scene", None, "ONE_OF_MISMATCH", "/trees/0");
        expect("/trees/0/anchors", Some(json!([1])), "ONE_OF_MISMATCH", "/trees/0");
        expect("/trees/0/fingerprint", None, "UNDEFINED_PROPERTY", "/trees/0");
        expect(
            "/trees/0/fingerprint/hash",
            Some(json!("xyz")),
            "PATTERN_MISMATCH",
            "/trees/0/fingerprint/hash",
        );
        expect(
            "/trees/0/recommended/quality",
            Some(json!(2)),
            "VALUE_NOT_IN_RANGE",
            "/trees/0/recommended/quality",
        );
        expect("/trees/0/nested/0/tree", Some(json!(-1)), "VALUE_NOT_IN_RANGE", "/trees/0/nested/0/tree");
        expect("/trees/0/proxies/visible", None, "UNDEFINED_PROPERTY", "/trees/0/proxies");
        expect("/trees/0/proxies/tables/PROXY_MESH", None, "UNDEFINED_PROPERTY", "/trees/0/proxies/tables");
        expect("/meshLevels", Some(json!([])), "EMPTY_ENTITY", "/meshLevels");
        let at = "/meshLevels/0/levels/0/error";
        expect(at, Some(json!(-1)), "VALUE_NOT_IN_RANGE", at);
        expect("/trees/0/tables/LEVEL_ROW", None, "UNSATISFIED_DEPENDENCY", "/trees/0/tables");
        expect("/trees/0/tables/_MINE", Some(json!("six")), "TYPE_MISMATCH", "/trees/0/tables/_MINE");
    }

    #[test]
    fn anchors_are_distinct() {
        let mut extension = clean();
        let tree = extension["trees"][0].as_object_mut().unwrap();
        tree.remove("scene");
        tree.insert("anchors".into(), json!([1, 1]));
        assert_eq!(codes(&extension), [("DUPLICATE_ELEMENTS", format!("{ROOT}/trees/0/anchors"))]);
    }

    #[test]
    fn long_values_do_not_flood_the_message() {
        let mut extension = clean();
        extension["trees"][0]["directions"] = json!(vec!["x".repeat(50); 50]);
        let mut report = ValidationReport::default();
        check(&extension, &mut report);
        assert!(report.issues[0].message.len() < 300, "{}", report.issues[0]);
    }

    #[test]
    fn files_are_valid_and_resolve() {
        build().unwrap();
        for (name, text) in FILES {
            let schema: Value = serde_json::from_str(text).unwrap();
            assert_eq!(schema["$id"], json!(name));
            assert!(jsonschema::meta::is_valid(&schema), "{name}");
        }
    }
}
