//! `cargo xtask bench proxies`: what proxies and the visibility-driven metric save, and what they cost in the picture.

mod ladder;
mod large;
mod metric;
mod rows;

use super::{build_svs, find_scenes, folder, save, svs};
use crate::run;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// What to run.
#[derive(Debug)]
pub(crate) struct Options {
    parts: Vec<String>,
    only: String,
    frames: Option<String>,
    scenes: PathBuf,
}

const PARTS: [&str; 3] = ["metric", "ladder", "large"];

impl Options {
    pub(crate) fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            parts: PARTS.map(str::to_owned).to_vec(),
            only: String::new(),
            frames: None,
            scenes: run::root().join("../shared/scenes"),
        };
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let mut value = || words.next().map(|&v| v.to_owned()).ok_or(format!("{word} needs a value"));
            match word {
                "--part" => options.parts = value()?.split(',').map(str::to_owned).collect(),
                "--only" => options.only = value()?,
                "--frames" => options.frames = Some(value()?),
                "--scenes" => options.scenes = value()?.into(),
                _ => return Err(format!("unknown option `{word}` of `bench proxies`")),
            }
        }
        match options.parts.iter().find(|part| !PARTS.contains(&part.as_str())) {
            None => Ok(options),
            Some(part) => Err(format!("unknown part `{part}`: use {}", PARTS.join(", "))),
        }
    }

    fn wants(&self, scene: &str) -> bool {
        self.only.split(',').any(|part| scene.contains(part))
    }

    fn frames<'a>(&'a self, default: &'a str) -> &'a str {
        self.frames.as_deref().unwrap_or(default)
    }
}

/// Runs the parts; what fails is named at the end, after the tables of the rest.
pub(crate) fn proxies(options: &Options) -> Result<(), String> {
    build_svs()?;
    let bench = Bench { public: find_scenes(&options.scenes, "")?, reports: folder("proxies")? };
    let (mut results, mut failed) = (Map::new(), Vec::new());
    for part in &options.parts {
        let (json, text) = match part.as_str() {
            "metric" => metric::run(options, &bench, &mut failed),
            "ladder" => ladder::run(options, &bench, &mut failed),
            _ => large::run(options, &bench, &mut failed),
        };
        println!("{text}");
        results.insert(part.clone(), json);
        save(
            &bench.reports.join(format!("{}.json", options.parts.join("-"))),
            &Value::Object(results.clone()),
        )?;
        std::fs::write(bench.reports.join(format!("{part}.md")), text).map_err(|error| error.to_string())?;
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("not all scenes passed\n{}", failed.join("\n"))) }
}

/// `svs build` without further options.
const DEFAULT: (&str, &[&str]) = ("", &[]);

/// Scenes, and where reports go.
#[derive(Debug)]
struct Bench {
    public: Vec<(String, PathBuf)>,
    reports: PathBuf,
}

impl Bench {
    fn public(&self, name: &str) -> Result<&Path, String> {
        let found = self.public.iter().find(|(public, _)| public == name);
        found.map(|(_, file)| file.as_path()).ok_or_else(|| format!("there is no scene {name}"))
    }

    /// A grid of copies of a public scene, made if it is not there yet; one copy is the scene itself.
    fn grid(&self, of: &str, copies: u32) -> Result<PathBuf, String> {
        let source = self.public(of)?;
        if copies == 1 {
            return Ok(source.to_owned());
        }
        let file = folder("")?.join(format!("{of}-x{copies}.glb"));
        if !file.is_file() {
            let mut sample = svs();
            sample.args(["sample", "grid", "-q", "--copies", &copies.to_string(), "--of"]).arg(source);
            run::step(&format!("make {copies} x {of}"), sample.arg("-o").arg(&file))?;
        }
        Ok(file)
    }

    /// The scene baked with proxies (`auto`: of what is visible, `all`: of everything), once. Other `options` of `svs build`
    /// have a `tag` of their own.
    fn bake(&self, scene: &Path, proxies: &str, (tag, options): (&str, &[&str])) -> Result<PathBuf, String> {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let baked = folder("")?.join(format!("{name}.proxies-{proxies}{tag}.glb"));
        let time = |file: &Path| std::fs::metadata(file).and_then(|data| data.modified()).ok();
        if time(&baked) <= time(scene) {
            let mut build = svs();
            build
                .arg("build")
                .arg(scene)
                .arg("-o")
                .arg(&baked)
                .args(["-q", "--proxies", proxies])
                .args(options);
            run::step(&format!("bake {name} with proxies ({proxies})"), &mut build)?;
        }
        Ok(baked)
    }

    /// Flies through a scene: the summary, and the rows of `frames.csv`.
    fn evaluate(
        &self,
        scene: &Path,
        name: &str,
        arguments: &[&str],
    ) -> Result<(Value, Vec<rows::Row>), String> {
        let report = self.reports.join(name);
        eprintln!("   {name}");
        let mut evaluate = svs();
        evaluate.arg("evaluate").arg(scene).arg("-o").arg(&report).args(["--json", "-q"]).args(arguments);
        let summary = run::json(&mut evaluate)?;
        let csv = std::fs::read_to_string(report.join("frames.csv")).map_err(|error| error.to_string())?;
        Ok((summary, rows::read(&csv)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_checked() {
        let options =
            Options::parse(&["--part", "ladder,large", "--only", "linz,lego"]).expect("good options");
        assert_eq!(options.parts, ["ladder", "large"]);
        assert!(options.wants("linz-city") && options.wants("lego-x") && !options.wants("atlas"));
        assert!(Options::parse(&["--part", "tables"]).is_err());
        assert!(Options::parse(&["--frames"]).is_err());
    }
}
