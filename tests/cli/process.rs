//! Behaviour as a process: pipes, signals.

use crate::{Finished, folder, names, run, small_scene, svs};
use std::process::Stdio;

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    for arguments in [vec!["info"], vec!["info", "--json"], vec!["validate"]] {
        let mut child = svs()
            .args(arguments)
            .arg(&scene)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("svs starts");
        // Nobody reads: with `| head -1` the pipe is closed before the program writes.
        drop(child.stdout.take());
        Finished::from(child.wait_with_output().expect("svs ends")).ok();
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    use std::process::Command;
    let folder = folder();
    let scene = folder.path().join("city.glb");
    run(&["sample".as_ref(), "city".as_ref(), "-q".as_ref(), "-o".as_ref(), scene.as_os_str()]).ok();
    let output = folder.path().join("out.glb");
    // Far more rays than can be cast before the interrupt.
    let child = svs()
        .arg("build")
        .arg(&scene)
        .arg("-o")
        .arg(&output)
        .args(["--max-missing", "0.000001", "--rays", "100000000000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("svs starts");
    std::thread::sleep(std::time::Duration::from_millis(400));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill starts").success());
    let finished = Finished::from(child.wait_with_output().expect("svs ends"));
    // On a machine so busy that the handler is not there yet, the signal itself ends the program: no code.
    assert!(matches!(finished.code, Some(130) | None), "{finished:?}");
    assert_eq!(names(folder.path()), ["city.glb"]);
}
