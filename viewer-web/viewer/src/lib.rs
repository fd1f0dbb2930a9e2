//! The viewer in a browser: this module culls and draws, the page around it has the controls and fetches the bytes.
#![cfg(target_arch = "wasm32")]

mod frame;
mod open;
mod pick;
mod settings;
mod surface;
mod viewer;

pub use viewer::Viewer;

use wasm_bindgen::prelude::*;

/// Says on the console where the module stopped, should it ever panic.
#[wasm_bindgen(start)]
fn start() {
    std::panic::set_hook(Box::new(|info| web_sys::console::error_1(&JsValue::from_str(&info.to_string()))));
}
