//! `cargo xtask bench frames`: flies through scenes with `svs evaluate` and prints the README's tables of frame times.

use super::{at, build_svs, find_scenes, folder, save, svs};
use crate::run;
use crate::table::{count, markdown, median, short};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Drawn within this budget, by the runtime's rule and by the dissertation's.
const BUDGET: &str = "10%";

/// A generated scene: its name, and the arguments of `svs sample`.
const GENERATED: [(&str, &[&str]); 2] =
    [("plant-100k", &["plant", "--scale", "24"]), ("city-100k", &["city", "--scale", "6.3"])];
/// A grid of real parts: its name, the scene and how many of it.
const GRID: (&str, &str, &str) = ("clinic-grid", "medical-clinic", "40");

/// What to run.
#[derive(Debug)]
pub(crate) struct Options {
    only: String,
    frames: Option<String>,
    passes: Option<String>,
    scenes: PathBuf,
}

/// A scene to fly through.
struct Subject {
    name: String,
    file: PathBuf,
    large: bool,
}

impl Options {
    pub(crate) fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            only: String::new(),
            frames: None,
            passes: None,
            scenes: run::root().join("../shared/scenes"),
        };
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let mut value = || words.next().map(|&v| v.to_owned()).ok_or(format!("{word} needs a value"));
            match word {
                "--only" => options.only = value()?,
                "--frames" => options.frames = Some(value()?),
                "--passes" => options.passes = Some(value()?),
                "--scenes" => options.scenes = value()?.into(),
                _ => return Err(format!("unknown option `{word}` of `bench frames`")),
            }
        }
        Ok(options)
    }
}

/// Runs everything; scenes that fail are named at the end, after the tables of the others.
pub(crate) fn frames(options: &Options) -> Result<(), String> {
    build_svs()?;
    let subjects = subjects(options)?;
    if subjects.is_empty() {
        return Err(format!("no scene's name contains `{}`", options.only));
    }
    let reports = folder("frames")?;
    let (mut results, mut failed) = (Vec::new(), Vec::new());
    for subject in &subjects {
        eprintln!("== {}", subject.name);
        match evaluate(options, subject, &reports.join(&subject.name)) {
            Ok(mut result) => {
                result["scene"] = subject.name.as_str().into();
                results.push(result);
            }
            Err(error) => failed.push(format!("{}: {error}", subject.name)),
        }
        save(&reports.join("frames.json"), &json!({ "scenes": results }))?;
    }
    println!("{}", report(&results));
    if failed.is_empty() { Ok(()) } else { Err(format!("not all scenes passed\n{}", failed.join("\n"))) }
}

/// All scenes whose name matches; large ones are made if they are not there yet.
fn subjects(options: &Options) -> Result<Vec<Subject>, String> {
    let bench = folder("")?;
    let public = match find_scenes(&options.scenes, "") {
        Ok(public) => public,
        Err(error) => {
            eprintln!("only the generated scenes: {error}");
            Vec::new()
        }
    };
    let matches = |name: &str| options.only.split(',').any(|part| name.contains(part));
    let mut found: Vec<Subject> = public
        .iter()
        .filter(|(name, _)| matches(name))
        .map(|(name, file)| Subject { name: name.clone(), file: file.clone(), large: false })
        .collect();
    let mut make = |name: &str, arguments: &[&str], of: Option<&Path>| -> Result<(), String> {
        let file = bench.join(format!("{name}.glb"));
        if !file.is_file() {
            let mut sample = svs();
            sample.arg("sample").args(arguments).arg("-o").arg(&file);
            if let Some(of) = of {
                sample.arg("--of").arg(of);
            }
            run::step(&format!("make {name}"), &mut sample)?;
        }
        found.push(Subject { name: name.to_owned(), file, large: true });
        Ok(())
    };
    for (name, arguments) in GENERATED.iter().filter(|(name, _)| matches(name)) {
        make(name, arguments, None)?;
    }
    let (name, of, copies) = GRID;
    if let Some((_, of)) = public.iter().find(|(public, _)| matches(name) && public == of) {
        make(name, &["grid", "--copies", copies], Some(of))?;
    }
    Ok(found)
}

/// Bakes one scene, if that is not done yet, and flies through it.
fn evaluate(options: &Options, subject: &Subject, report: &Path) -> Result<Value, String> {
    let baked = folder("")?.join(format!("{}.svs.glb", subject.name));
    let is_new = |file: &Path| std::fs::metadata(file).and_then(|data| data.modified()).ok();
    if is_new(&baked) <= is_new(&subject.file) {
        run::step("bake", svs().arg("build").arg(&subject.file).arg("-o").arg(&baked).arg("-q"))?;
    }
    let frames = options.frames.as_deref().unwrap_or(if subject.large { "6" } else { "24" });
    let passes = options.passes.as_deref().unwrap_or(if subject.large { "2" } else { "3" });
    run::json(svs().arg("evaluate").arg(&baked).arg("-o").arg(report).arg("--json").args([
        "--methods",
        "frustum,visibility,exact,budget,first-misfit",
        "--budget",
        BUDGET,
        "--frames",
        frames,
        "--passes",
        passes,
    ]))
}

fn report(results: &[Value]) -> String {
    let mut text = String::new();
    for path in ["outside", "inside"] {
        let rows: Vec<Vec<String>> = results.iter().filter_map(|scene| row(scene, path)).collect();
        text += &format!("\nCameras {path}:\n\n");
        text += &markdown(
            &[
                "scene",
                "objects",
                "triangles, million",
                "frustum, ms",
                "visibility, ms",
                "times faster",
                "exact, ms",
                "missing ppm, median",
                "worst",
                "worst SSIM",
            ],
            &rows,
        );
        let all = results.iter().filter_map(|scene| path_of(scene, path)).map(speedup);
        text += &format!("\nTimes faster than frustum culling, median: {}\n", short(median(all)));
    }
    let rows: Vec<Vec<String>> = results.iter().flat_map(budget_rows).collect();
    text += &format!("\nWithin a budget of {BUDGET} of each frame's triangles:\n\n");
    text += &markdown(
        &[
            "scene, path",
            "SSIM, median",
            "SSIM, worst",
            "stop at first misfit: SSIM, median",
            "worst",
            "missing ppm, median",
            "stop at first misfit: ppm",
        ],
        &rows,
    );
    text
}

fn path_of<'a>(scene: &'a Value, path: &str) -> Option<&'a Value> {
    scene["paths"].as_array()?.iter().find(|entry| entry["name"] == path)
}

fn method_of<'a>(path: &'a Value, method: &str) -> &'a Value {
    let methods = path["methods"].as_array();
    methods.into_iter().flatten().find(|entry| entry["method"] == method).unwrap_or(&Value::Null)
}

/// Median frame time of frustum culling over that with visibility.
fn speedup(path: &Value) -> f64 {
    at(method_of(path, "frustum"), "/frame_ms/median") / at(method_of(path, "visibility"), "/frame_ms/median")
}

fn row(scene: &Value, path: &str) -> Option<Vec<String>> {
    let path = path_of(scene, path)?;
    let [frustum, visibility, exact] = ["frustum", "visibility", "exact"].map(|name| method_of(path, name));
    Some(vec![
        scene["scene"].as_str().unwrap_or_default().to_owned(),
        count(at(scene, "/objects")),
        short(at(scene, "/triangles") / 1e6),
        short(at(frustum, "/frame_ms/median")),
        short(at(visibility, "/frame_ms/median")),
        format!("{:.2}", speedup(path)),
        short(at(exact, "/frame_ms/median")),
        short(at(visibility, "/missing_ppm/median")),
        short(at(visibility, "/missing_ppm/worst")),
        format!("{:.5}", at(visibility, "/ssim/worst")),
    ])
}

fn budget_rows(scene: &Value) -> Vec<Vec<String>> {
    let paths = scene["paths"].as_array().into_iter().flatten();
    let row = |path: &Value| {
        let [ours, theirs] = ["budget", "first-misfit"].map(|name| method_of(path, name));
        let name = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let ssim = |method, which| format!("{:.4}", at(method, which));
        vec![
            format!("{}, {}", name(&scene["scene"]), name(&path["name"])),
            ssim(ours, "/ssim/median"),
            ssim(ours, "/ssim/worst"),
            ssim(theirs, "/ssim/median"),
            ssim(theirs, "/ssim/worst"),
            short(at(ours, "/missing_ppm/median")),
            short(at(theirs, "/missing_ppm/median")),
        ]
    };
    paths.map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_what_was_measured() {
        let method = |name, ms: f64, ssim: f64| {
            json!({ "method": name, "frame_ms": { "median": ms }, "ssim": { "median": ssim, "worst": ssim },
                    "missing_ppm": { "median": 3.0, "worst": 20.0 } })
        };
        let methods = [
            method("frustum", 90.0, 1.0),
            method("visibility", 30.0, 0.9995),
            method("budget", 5.0, 0.97),
            method("first-misfit", 4.0, 0.93),
        ];
        let scene = json!({ "scene": "x", "objects": 1200, "triangles": 2_500_000,
                            "paths": [{ "name": "outside", "methods": methods }] });
        let row = row(&scene, "outside").expect("a path");
        assert_eq!(row, ["x", "1,200", "2.5", "90", "30", "3.00", "-", "3.0", "20", "0.99950"]);
        assert!(super::row(&scene, "inside").is_none());
        assert_eq!(budget_rows(&scene)[0][..4], ["x, outside", "0.9700", "0.9700", "0.9300"]);
    }

    #[test]
    fn options_are_checked() {
        assert!(Options::parse(&["--frames", "8", "--only", "linz"]).is_ok());
        assert!(Options::parse(&["--passes"]).is_err());
        assert!(Options::parse(&["--budget", "3"]).is_err());
    }
}
