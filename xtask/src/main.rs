//! Developer commands: `cargo xtask test`, `cargo xtask wasm`, `cargo xtask bench`, `cargo xtask samples`.

#![forbid(unsafe_code)]

mod bench;
mod khronos;
mod npm;
mod run;
mod samples;
mod system;
mod table;
mod test;
mod wasm;
mod web;

use std::process::ExitCode;

const USAGE: &str = "\
Developer commands of svs

Usage: cargo xtask <COMMAND>

Commands:
  test          formatting, lints and all tests, those of the web packages in a browser and the Khronos validator among
                them; installs what is missing
  samples       write the sample asset of the specification anew
  wasm          build the web modules into viewer-web and print their sizes; fails if one is too large
      --only NAME                     only modules whose package name contains NAME
      --std auto|debian               standard library: rustup's where it is or can be installed, else Debian's (auto),
                                      or Debian's in any case
  bench scenes  bake, validate and verify the public scenes and print the table of the README, and what proxies cost
      --quality draft|standard|high   quality of the bake (default: standard)
      --cameras N                     cameras per group of views (default: as `svs verify`)
      --only NAME                     only scenes whose name contains NAME
      --scenes FOLDER                 where the scenes are (default: ../shared/scenes)
      --cost                          bake and validate only
  bench frames  fly through the public scenes and three large generated ones and print the tables of the README;
                reports are left in target/bench/frames
      --only NAME[,NAME...]           only scenes whose name contains one of them
      --frames N                      frames of each path (default: 24; 6 in the large scenes)
      --passes N                      times each frame is timed (default: 3; 2 in the large scenes)
      --scenes FOLDER                 where the public scenes are (default: ../shared/scenes)
  bench viewer  frame times of the web viewer on WebGL 2, frustum culling against visibility, and how soon a picture is
                complete while a scene comes at 20 Mbit/s; one line of JSON a scene
      --part viewer,stream            only these parts (default: both)
      --frames N                      frames of the path (default: 24)
      --scenes FOLDER                 where the public scenes are (default: ../shared/scenes)
  bench web     three.js alone against three.js with the plugin in a browser on WebGL 2, and culling in WebAssembly against
                native
      --only NAME[,NAME...]           only scenes whose name contains one of them
      --frames N                      frames of each path (default: 12)
      --scenes FOLDER                 where the public scenes are (default: ../shared/scenes)
  bench proxies what proxies and the visibility-driven metric save, and what a picture is worth within a budget;
                reports are left in target/bench/proxies
      --part metric,ladder,large      only these parts (default: all)
      --only NAME[,NAME...]           only scenes whose name contains one of them
      --frames N                      frames of each path (default: 40 of metric, 4 of ladder, 1 of large)
      --scenes FOLDER                 where the public scenes are (default: ../shared/scenes)
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["test"] => test::test(),
        ["samples"] => samples::samples(),
        ["wasm", rest @ ..] => wasm::Options::parse(rest).and_then(|options| wasm::wasm(&options)),
        ["bench", "scenes", rest @ ..] => {
            bench::scenes::Options::parse(rest).and_then(|options| bench::scenes::scenes(&options))
        }
        ["bench", "frames", rest @ ..] => {
            bench::frames::Options::parse(rest).and_then(|options| bench::frames::frames(&options))
        }
        ["bench", "viewer", rest @ ..] => {
            bench::viewer::Options::parse(rest).and_then(|options| bench::viewer::viewer(&options))
        }
        ["bench", "web", rest @ ..] => {
            bench::web::Options::parse(rest).and_then(|options| bench::web::web(&options))
        }
        ["bench", "proxies", rest @ ..] => {
            bench::proxies::Options::parse(rest).and_then(|options| bench::proxies::proxies(&options))
        }
        [] | ["help" | "-h" | "--help", ..] => {
            print!("{USAGE}");
            Ok(())
        }
        _ => Err(format!("unknown command `{}`\n\n{USAGE}", words.join(" "))),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}
