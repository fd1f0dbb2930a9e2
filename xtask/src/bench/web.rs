//! `cargo xtask bench web`: three.js alone against three.js with the plugin in a browser, and culling in WebAssembly against
//! native.

use super::{build_svs, find_scenes, folder, save, svs};
use crate::table::{count, markdown, median, short};
use crate::{run, wasm, web};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Nested scenes of different kinds.
const SCENES: &str = "duplex-apartment,lhcb-detector,medical-clinic";

/// What to run.
#[derive(Debug)]
pub(crate) struct Options {
    only: String,
    frames: String,
    scenes: PathBuf,
}

impl Options {
    pub(crate) fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            only: SCENES.to_owned(),
            frames: "12".to_owned(),
            scenes: run::root().join("../shared/scenes"),
        };
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let mut value = || words.next().map(|&v| v.to_owned()).ok_or(format!("{word} needs a value"));
            match word {
                "--only" => options.only = value()?,
                "--frames" => options.frames = value()?,
                "--scenes" => options.scenes = value()?.into(),
                _ => return Err(format!("unknown option `{word}` of `bench web`")),
            }
        }
        Ok(options)
    }
}

/// Runs everything; scenes that fail are named at the end, after the tables of the others.
pub(crate) fn web(options: &Options) -> Result<(), String> {
    build_svs()?;
    run::step(
        "build draws",
        run::cargo().args(["build", "--release", "--package", "svs", "--example", "draws"]),
    )?;
    web::install()?;
    wasm::wasm(&wasm::Options::only("svs-runtime-wasm"))?;
    let matches = |name: &str| options.only.split(',').any(|part| name.contains(part));
    let scenes = find_scenes(&options.scenes, "")?;
    let scenes: Vec<&(String, PathBuf)> = scenes.iter().filter(|(name, _)| matches(name)).collect();
    if scenes.is_empty() {
        return Err(format!("no scene's name contains `{}`", options.only));
    }
    let reports = folder("web")?;
    let (mut results, mut failed) = (Vec::new(), Vec::new());
    for (name, file) in scenes {
        eprintln!("== {name}");
        match measure(options, name, file) {
            Ok(mut result) => {
                result["scene"] = name.as_str().into();
                results.push(result);
            }
            Err(error) => failed.push(format!("{name}: {error}")),
        }
        save(&reports.join("web.json"), &json!({ "scenes": results }))?;
    }
    println!("{}", report(&results));
    if failed.is_empty() { Ok(()) } else { Err(format!("not all scenes passed\n{}", failed.join("\n"))) }
}

/// Bakes a scene, if that is not done yet, and measures it.
fn measure(options: &Options, name: &str, file: &Path) -> Result<Value, String> {
    let baked = folder("")?.join(format!("{name}.svs.glb"));
    let modified = |file: &Path| std::fs::metadata(file).and_then(|data| data.modified()).ok();
    if modified(&baked) <= modified(file) {
        run::step("bake", svs().arg("build").arg(file).arg("-o").arg(&baked).arg("-q"))?;
    }
    let script = web::folder().join("bench/bench.mjs");
    run::json(Command::new("node").arg(script).arg(&baked).arg(&options.frames))
}

fn report(results: &[Value]) -> String {
    let number =
        |result: &Value, pointer: &str| result.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let mut rows = Vec::new();
    for result in results {
        for place in ["outside", "inside"] {
            let at = |figure: &str| number(result, &format!("/{place}/{figure}"));
            rows.push(vec![
                format!("{}, {place}", result["scene"].as_str().unwrap_or_default()),
                count(at("plain/calls")),
                count(at("visibility/calls")),
                count(at("plain/triangles")),
                count(at("visibility/triangles")),
                count(at("plain/milliseconds")),
                count(at("visibility/milliseconds")),
                short(at("ratio")),
            ]);
        }
    }
    let head =
        ["scene", "calls", "with plugin", "triangles", "with plugin", "ms", "with plugin", "times faster"];
    let mut text = markdown(&head, &rows);
    let outside = results.iter().map(|result| number(result, "/outside/ratio"));
    text += &format!("\nOutside, the median is {} times faster.\n\n", short(median(outside)));
    let rows: Vec<Vec<String>> = results
        .iter()
        .map(|result| {
            vec![
                result["scene"].as_str().unwrap_or_default().to_owned(),
                count(number(result, "/culling/objects")),
                short(number(result, "/culling/native")),
                short(number(result, "/culling/wasm")),
                short(number(result, "/culling/ratio")),
            ]
        })
        .collect();
    text += &markdown(&["culling", "objects", "ms native", "ms in WebAssembly", "ratio"], &rows);
    text
}
