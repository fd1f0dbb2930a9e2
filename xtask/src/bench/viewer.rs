//! `cargo xtask bench viewer`: frame times of the web viewer, and how soon a picture is complete while a scene is loaded.

use super::{build_svs, find_scenes, folder, svs};
use crate::{run, web};
use std::path::PathBuf;
use std::process::Command;

/// What is measured, each by a script in `viewer-web/bench`.
const PARTS: [&str; 2] = ["viewer", "stream"];
/// Scenes of the frame times: many objects, nested.
const NESTED: [&str; 3] = ["medical-clinic", "lhcb-detector", "schependomlaan-apartments"];
/// The scene that is loaded: 23 MB.
const LOADED: &str = "medical-clinic";

/// What `cargo xtask bench viewer` was asked for.
#[derive(Debug)]
pub(crate) struct Options {
    parts: Vec<String>,
    frames: u32,
    scenes: PathBuf,
}

impl Options {
    /// Reads the arguments after `bench viewer`.
    pub(crate) fn parse(mut arguments: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            parts: PARTS.map(str::to_owned).to_vec(),
            frames: 24,
            scenes: run::root().join("../shared/scenes"),
        };
        while let [first, value, rest @ ..] = arguments {
            match *first {
                "--part" if value.split(',').all(|part| PARTS.contains(&part)) => {
                    options.parts = value.split(',').map(str::to_owned).collect();
                }
                "--frames" => {
                    let frames = value.parse().ok().filter(|frames| (1..=1000).contains(frames));
                    options.frames = frames.ok_or("--frames wants a number from 1 to 1000")?;
                }
                "--scenes" => options.scenes = PathBuf::from(value),
                _ => {
                    return Err(format!(
                        "`bench viewer` does not know `{first} {value}`; see `cargo xtask help`"
                    ));
                }
            }
            arguments = rest;
        }
        match arguments {
            [] => Ok(options),
            _ => {
                Err(format!("`bench viewer` does not know `{}`; see `cargo xtask help`", arguments.join(" ")))
            }
        }
    }
}

/// Bakes what is missing, measures, and prints one line of JSON a scene.
pub(crate) fn viewer(options: &Options) -> Result<(), String> {
    let site = run::root().join("viewer-web/dist/webgl");
    if !site.is_dir() {
        return Err("the viewer is not built: run `cargo xtask wasm` first".to_owned());
    }
    build_svs()?;
    web::install()?;
    for part in &options.parts {
        let mut command = Command::new("node");
        command.arg(web::folder().join("bench").join(format!("{part}.mjs")));
        if part == "viewer" {
            command.arg(options.frames.to_string());
            for name in NESTED {
                command.arg(baked(options, name, false)?);
            }
        } else {
            command.arg(baked(options, LOADED, true)?);
        }
        run::step(part, &mut command)?;
    }
    Ok(())
}

/// A public scene, baked, for streaming or not; baked now if it is not there.
fn baked(options: &Options, name: &str, stream: bool) -> Result<PathBuf, String> {
    let kind = if stream { "stream.svs.glb" } else { "svs.glb" };
    let output = folder("")?.join(format!("{name}.{kind}"));
    if output.is_file() {
        return Ok(output);
    }
    let scenes = find_scenes(&options.scenes, name)?;
    let (_, input) =
        scenes.first().ok_or_else(|| format!("no scene {name} in {}", options.scenes.display()))?;
    let mut bake = svs();
    bake.arg("build").arg(input).arg("-o").arg(&output).arg("-q");
    if stream {
        bake.args(["--layout", "stream"]);
    }
    run::step(&format!("bake {name}"), &mut bake)?;
    Ok(output)
}
