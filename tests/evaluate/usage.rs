//! Wrong usage and folders that cannot be written.

use crate::{folder, root, svs};
use std::ffi::OsStr;
use std::path::Path;

/// Must fail with this code and say all of these words, and write nothing.
#[track_caller]
fn fails(scene: &Path, output: &Path, more: &[&str], code: i32, words: &[&str]) {
    let arguments = [OsStr::new("evaluate"), scene.as_os_str(), OsStr::new("-o"), output.as_os_str()];
    let more: Vec<&OsStr> = more.iter().map(OsStr::new).collect();
    let (found, stdout, stderr) = svs(&[&arguments[..], &more].concat());
    assert_eq!(found, Some(code), "{stdout}{stderr}");
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in {stderr}");
    }
    assert!(!stderr.contains("panicked") && !output.join("report.html").exists(), "{stderr}");
}

#[test]
fn wrong_arguments_are_explained() {
    let folder = folder();
    let (scene, report) = (root().join("samples/plant.glb"), folder.path().join("report"));
    let wrong: [(&[&str], &[&str]); 17] = [
        (&["--methods", "frustum,magic"], &["\"magic\"", "first-misfit"]),
        (&["--methods", ""], &["there is no method"]),
        (&["--methods", "frustum,frustum"], &["frustum", "twice"]),
        (&["--methods", "budget"], &["budget needs --budget"]),
        (&["--methods", "first-misfit", "--budget", "5ms"], &["first-misfit", "milliseconds"]),
        (&["--frames", "0"], &["0 frames"]),
        (&["--passes", "0"], &["0 passes"]),
        (&["--metric", "cubic"], &["\"cubic\"", "sigmoid:S,T"]),
        (&["--detail=-1"], &["pixels"]),
        (&["--reference", "magic"], &["\"magic\"", "proxies-frustum"]),
        (&["--reference", "budget"], &["budget needs --budget"]),
        (&["--size", "0x720"], &["1280x720"]),
        (&["--size", "15x720"], &["15 pixels"]),
        (&["--size", "big"], &["1280x720"]),
        (&["--budget", "110%"], &["110%", "8ms"]),
        (&["--quality", "2"], &["0 to 1"]),
        (&["--tour", "outside", "--path", "x.json"], &["--path"]),
    ];
    for (arguments, words) in wrong {
        fails(&scene, &report, arguments, 2, words);
    }
    assert!(!report.exists());
}

#[test]
fn what_cannot_be_read_or_written_is_named_before_any_work() {
    let folder = folder();
    let (scene, report) = (root().join("samples/plant.glb"), folder.path().join("report"));
    let start = std::time::Instant::now();
    fails(&folder.path().join("no.glb"), &report, &[], 1, &["cannot read", "no.glb"]);
    fails(&scene, &report, &["--path", "no.json"], 1, &["no.json"]);
    fails(&scene, &folder.path().join("no/where"), &[], 1, &["cannot write", "there is no folder"]);
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").expect("a file");
    fails(&scene, &file, &[], 1, &["cannot write", "file, not a folder"]);
    assert_eq!(std::fs::read_to_string(&file).expect("a file"), "mine");
    let broken = folder.path().join("broken.json");
    std::fs::write(&broken, "{\"version\":1,\"poses\":[]}").expect("a file");
    fails(&scene, &report, &["--path", broken.to_str().expect("UTF-8")], 1, &["broken.json"]);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert!(!report.exists());
}
