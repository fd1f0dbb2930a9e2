//! The viewer, driven as a user would: the real program in a window of a virtual display (Xvfb), by scripts that set what
//! the controls set, and by a real mouse and keyboard (xdotool).
#![cfg(all(feature = "render", target_os = "linux"))]
// Long scripts in json!.
#![recursion_limit = "1024"]

mod controls;
mod display;
mod files;
#[path = "../common/handmade.rs"]
mod handmade;
mod mouse;
mod paths;
mod pictures;
mod proxies;
mod run;
