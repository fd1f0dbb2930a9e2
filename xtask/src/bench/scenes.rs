//! `cargo xtask bench scenes`: bakes, validates and verifies the public scenes and prints the README's table.

use super::{at, build_svs, find_scenes, folder, save, svs};
use crate::table::{count, markdown, median, short};
use crate::{khronos, run};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Methods in the report of `svs verify --json`: ours as it comes, ours with as many triangles as the published
/// method draws, and the published method.
const DEFAULT: &str = "default";
const EQUAL: &str = "at published triangles";
const PUBLISHED: &str = "published";

/// What to run.
#[derive(Debug)]
pub(crate) struct Options {
    quality: String,
    cameras: Option<String>,
    only: String,
    scenes: PathBuf,
    /// Bakes are made and checked, but not flown through.
    cost: bool,
}

impl Options {
    pub(crate) fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            quality: "standard".to_owned(),
            cameras: None,
            only: String::new(),
            scenes: run::root().join("../shared/scenes"),
            cost: false,
        };
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let mut value = || words.next().map(|&v| v.to_owned()).ok_or(format!("{word} needs a value"));
            match word {
                "--quality" => options.quality = value()?,
                "--cameras" => options.cameras = Some(value()?),
                "--only" => options.only = value()?,
                "--scenes" => options.scenes = value()?.into(),
                "--cost" => options.cost = true,
                _ => return Err(format!("unknown option `{word}` of `bench scenes`")),
            }
        }
        Ok(options)
    }
}

/// Runs everything; scenes that fail are named at the end, after the table of the others.
pub(crate) fn scenes(options: &Options) -> Result<(), String> {
    build_svs()?;
    let folder = folder("")?;
    let found = find_scenes(&options.scenes, &options.only)?;
    if found.is_empty() {
        return Err(format!("no scene matches in {}", options.scenes.display()));
    }
    let mut results = Vec::new();
    let mut failed = Vec::new();
    for (name, file) in found {
        eprintln!("== {name}");
        let outputs = ["svs", "proxies-auto"].map(|tag| folder.join(format!("{name}.{tag}.glb")));
        match measure(options, &file, &outputs) {
            Ok(mut result) => {
                result["scene"] = name.into();
                results.push(result);
            }
            Err(error) => failed.push(format!("{name}: {error}")),
        }
        save(&folder.join("scenes.json"), &json!({ "quality": options.quality, "scenes": results }))?;
    }
    println!("{}", report(&results, options));
    if failed.is_empty() { Ok(()) } else { Err(format!("not all scenes passed\n{}", failed.join("\n"))) }
}

/// Bakes one scene without and with proxies, checks the results with both validators, measures the first.
fn measure(options: &Options, input: &Path, [plain, proxies]: &[PathBuf; 2]) -> Result<Value, String> {
    let (build, validation, khronos) = bake(options, input, plain, "off")?;
    let (with_proxies, ..) = bake(options, input, proxies, "auto")?;
    let mut result =
        json!({ "build": build, "validate": validation, "khronos": khronos, "with_proxies": with_proxies });
    if options.cost {
        return Ok(result);
    }
    let mut verify = svs();
    verify.arg("verify").arg(plain).arg("--json");
    if let Some(cameras) = &options.cameras {
        verify.args(["--cameras", cameras]);
    }
    let verify = run::json(&mut verify)?;
    eprintln!(
        "   {} s to bake, {} s to verify",
        short(at(&result, "/build/wall_seconds")),
        short(at(&verify, "/wall_seconds"))
    );
    result["verify"] = verify;
    Ok(result)
}

/// Bakes one scene: the report, and what both validators say.
fn bake(
    options: &Options,
    input: &Path,
    output: &Path,
    proxies: &str,
) -> Result<(Value, Value, Value), String> {
    let words = ["--quality", &options.quality, "--proxies", proxies, "--json"];
    let build = run::json(svs().arg("build").arg(input).arg("-o").arg(output).args(words))?;
    let validation = run::json(svs().arg("validate").arg(output).arg("--json"))?;
    if !khronos::installed() {
        eprintln!("the Khronos validator is not there (`cargo xtask test` installs it): not run");
        return Ok((build, validation, Value::Null));
    }
    let (before, after) = (khronos::validate(input)?, khronos::validate(output)?);
    if before == (0, 0) && after != (0, 0) {
        return Err(format!("the Khronos validator finds {} errors and {} warnings", after.0, after.1));
    }
    Ok((build, validation, json!({ "errors": after.0, "warnings": after.1 })))
}

/// Mean missing ppm and triangles over those in the frustum, of a method in a group of cameras.
fn quality(scene: &Value, group: &str, method: &str) -> (f64, f64) {
    let groups = scene.pointer("/verify/groups").and_then(Value::as_array);
    let found =
        groups.into_iter().flatten().find(|entry| entry["group"] == group && entry["method"] == method);
    found.map_or((f64::NAN, f64::NAN), |entry| {
        (at(entry, "/missing_ppm/mean"), at(entry, "/triangles/over_frustum"))
    })
}

/// How many times more pixels the published method misses at the same number of triangles. Both miss nothing: 1.
/// Where ours cannot be made to draw as few triangles (nothing was worth a sphere, say), nothing can be compared: NaN.
fn advantage(scene: &Value, group: &str) -> f64 {
    let (ours, our_triangles) = quality(scene, group, EQUAL);
    let (published, triangles) = quality(scene, group, PUBLISHED);
    if our_triangles > 1.05 * triangles {
        f64::NAN
    } else if ours == 0.0 && published == 0.0 {
        1.0
    } else {
        published / ours
    }
}

fn report(results: &[Value], options: &Options) -> String {
    let cost: Vec<Vec<String>> = results.iter().map(cost_row).collect();
    let mut text = markdown(
        &[
            "scene",
            "objects",
            "triangles",
            "seconds",
            "peak memory, MB",
            "added, kB",
            "% of geometry",
            "bytes per object",
        ],
        &cost,
    );
    text += "\nWith `--proxies auto`:\n\n";
    let rows: Vec<Vec<String>> = results.iter().map(proxies_row).collect();
    text += &markdown(
        &[
            "scene",
            "seconds",
            "peak memory, MB",
            "proxies",
            "simplified meshes",
            "of proxies and meshes, kB",
            "% of geometry",
        ],
        &rows,
    );
    if options.cost {
        return text;
    }
    for group in ["outside", "inside"] {
        let rows: Vec<Vec<String>> = results.iter().map(|scene| quality_row(scene, group)).collect();
        text +=
            &format!("\nSeen from {group}; triangles are a share of those that frustum culling draws:\n\n");
        text += &markdown(
            &[
                "scene",
                "ours, ppm",
                "ours, triangles",
                "ours at published's triangles, ppm",
                "triangles",
                "published, ppm",
                "published, triangles",
                "published ppm / ours",
            ],
            &rows,
        );
        let all: Vec<f64> = results.iter().map(|scene| advantage(scene, group)).collect();
        let compared = all.iter().filter(|value| !value.is_nan()).count();
        text += &format!(
            "\nPublished / ours at its triangles, median of the {compared} of {} scenes that compare: {}\n",
            all.len(),
            ratio(median(all.iter().copied()))
        );
    }
    text
}

fn cost_row(scene: &Value) -> Vec<String> {
    let build = &scene["build"];
    let (added, objects) = (at(build, "/bytes_added"), at(build, "/objects"));
    vec![
        scene["scene"].as_str().unwrap_or_default().to_owned(),
        count(objects),
        count(at(build, "/triangles")),
        short(at(build, "/wall_seconds")),
        count(at(build, "/peak_memory_bytes") / 1e6),
        short(added / 1e3),
        short(100.0 * added / at(build, "/geometry_bytes")),
        short(added / objects),
    ]
}

fn proxies_row(scene: &Value) -> Vec<String> {
    let build = &scene["with_proxies"];
    let bytes = at(build, "/proxies/bytes");
    vec![
        scene["scene"].as_str().unwrap_or_default().to_owned(),
        short(at(build, "/wall_seconds")),
        count(at(build, "/peak_memory_bytes") / 1e6),
        count(at(build, "/proxies/nodes")),
        count(at(build, "/proxies/mesh_levels")),
        short(bytes / 1e3),
        short(100.0 * bytes / at(build, "/geometry_bytes")),
    ]
}

fn quality_row(scene: &Value, group: &str) -> Vec<String> {
    let mut row = vec![scene["scene"].as_str().unwrap_or_default().to_owned()];
    for method in [DEFAULT, EQUAL, PUBLISHED] {
        let (missing, triangles) = quality(scene, group, method);
        row.push(short(missing));
        row.push(short(triangles));
    }
    row.push(ratio(advantage(scene, group)));
    row
}

/// A ratio; infinite where ours misses nothing and the published method does.
fn ratio(value: f64) -> String {
    if value == f64::INFINITY { "∞".to_owned() } else { short(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(ours: f64, published: f64) -> Value {
        let group = |method, ppm: f64| {
            json!({ "group": "outside", "method": method, "missing_ppm": { "mean": ppm },
                    "triangles": { "over_frustum": 0.5 } })
        };
        json!({
            "scene": "x",
            "build": { "objects": 10, "triangles": 1200, "wall_seconds": 1.5, "peak_memory_bytes": 2e6,
                       "bytes_added": 2000, "geometry_bytes": 100_000 },
            "with_proxies": { "wall_seconds": 3.0, "peak_memory_bytes": 4e6, "geometry_bytes": 100_000,
                              "proxies": { "nodes": 30, "mesh_levels": 4, "bytes": 15_000 } },
            "verify": { "groups": [group(DEFAULT, 1.0), group(EQUAL, ours), group(PUBLISHED, published)] },
        })
    }

    #[test]
    fn rows_hold_what_was_measured() {
        assert_eq!(cost_row(&scene(2.0, 10.0)), ["x", "10", "1,200", "1.5", "2", "2.0", "2.0", "200"]);
        assert_eq!(proxies_row(&scene(2.0, 10.0)), ["x", "3.0", "4", "30", "4", "15", "15"]);
        let row = quality_row(&scene(2.0, 10.0), "outside");
        assert_eq!(row, ["x", "1.0", "0.50", "2.0", "0.50", "10", "0.50", "5.0"]);
        assert_eq!(quality_row(&scene(2.0, 10.0), "inside")[1..], ["-"; 7]);
    }

    #[test]
    fn advantage_of_missing_nothing() {
        assert_eq!(advantage(&scene(0.0, 0.0), "outside"), 1.0);
        assert_eq!(ratio(advantage(&scene(0.0, 3.0), "outside")), "∞");
    }

    #[test]
    fn unequal_triangles_are_not_compared() {
        let mut scene = scene(0.0, 3.0);
        scene["verify"]["groups"][1]["triangles"]["over_frustum"] = json!(0.6);
        assert_eq!(ratio(advantage(&scene, "outside")), "-");
    }

    #[test]
    fn options_are_checked() {
        assert!(Options::parse(&["--quality", "draft", "--only", "linz", "--cost"]).is_ok());
        assert!(Options::parse(&["--quality"]).is_err());
        assert!(Options::parse(&["--colour", "red"]).is_err());
    }
}
