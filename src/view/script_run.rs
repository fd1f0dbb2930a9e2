//! Runs a script: one step per frame, through what the controls call.

use super::ViewError;
use super::keys::shortcut_named;
use super::script::Step;
use super::state::Limit;
use super::viewer::Viewer;
use std::path::PathBuf;
use svs_render::View;
use winit::keyboard::KeyCode;

/// Frames of a path and of held keys come at this rate in scripts, however long they take.
pub(crate) const SECONDS_PER_FRAME: f64 = 1.0 / 60.0;

/// What a step asks of the window.
#[derive(Debug, Default)]
pub(crate) struct Wishes {
    /// Another size, pixels.
    pub(crate) resize: Option<[u32; 2]>,
    /// A picture of this frame.
    pub(crate) screenshot: Option<PathBuf>,
    /// Figures after this frame.
    pub(crate) dump: Option<PathBuf>,
    /// The script is over.
    pub(crate) leave: bool,
}

/// A script on its way.
#[derive(Debug)]
pub(crate) struct Script {
    steps: Vec<Step>,
    next: usize,
    /// Frames until the next step.
    wait: u32,
    stay: bool,
    /// Figures go here after every frame.
    pub(crate) watch: Option<PathBuf>,
}

impl Script {
    /// From its begin.
    pub(crate) fn new(steps: Vec<Step>) -> Self {
        Self { steps, next: 0, wait: 0, stay: false, watch: None }
    }

    /// Steps are left, or the window will close: frames must follow.
    pub(crate) fn is_running(&self) -> bool {
        self.next < self.steps.len() || self.wait > 0 || !self.stay
    }

    /// Takes the next step. Call it once per frame, before the frame is drawn.
    pub(crate) fn step(&mut self, viewer: &mut Viewer) -> Result<Wishes, ViewError> {
        let mut wishes = Wishes::default();
        if viewer.loading.is_some() {
            return Ok(wishes);
        }
        if self.wait > 0 {
            self.wait -= 1;
            if self.wait == 0 {
                viewer.held.clear();
            }
            return Ok(wishes);
        }
        if self.steps.get(self.next) == Some(&Step::WaitForPlay) && viewer.tape.is_playing() {
            return Ok(wishes);
        }
        let Some(step) = self.steps.get(self.next).cloned() else {
            wishes.leave = !self.stay;
            return Ok(wishes);
        };
        self.next += 1;
        self.take(step, viewer, &mut wishes)
            .map_err(|message| ViewError::Step { step: self.next, message })?;
        Ok(wishes)
    }

    fn take(&mut self, step: Step, viewer: &mut Viewer, wishes: &mut Wishes) -> Result<(), String> {
        let height = f64::from(viewer.viewport[1]);
        let state = &mut viewer.state;
        match step {
            Step::Method(name) => {
                state.method = name.parse().map_err(|_| format!("there is no method {name}"))?;
            }
            Step::Quality(quality) => state.quality = quality,
            Step::SphereLimit(degrees) => state.sphere_limit = degrees,
            Step::TriangleBudget(triangles) => (state.limit, state.triangles) = (Limit::Triangles, triangles),
            Step::TimeBudget(ms) => (state.limit, state.milliseconds) = (Limit::Milliseconds, ms),
            Step::NoBudget => state.limit = Limit::None,
            Step::Proxies(on) => state.proxies = on,
            Step::Detail(pixels) => state.tau = pixels,
            Step::Metric(name) => {
                state.set_metric(crate::stage::parse_metric(&name).map_err(|error| error.to_string())?);
            }
            Step::Freeze(on) => state.freeze = on,
            Step::Skipped(on) => state.skipped = on,
            Step::SkippedBoxes(on) => state.skipped_boxes = on,
            Step::Spheres(on) => state.spheres = on,
            Step::Colours(colours) => state.colours = colours,
            Step::Continuous(on) => state.continuous = on,
            Step::Graphs(on) => state.graphs = on,
            Step::Panel(on) => state.panel = on,
            Step::Help(on) => state.help = on,
            Step::Camera(mode) => viewer.rig.switch(mode),
            Step::Drag([right, down]) => viewer.rig.drag(right, down, height),
            Step::Pan([right, down]) => viewer.rig.pan(right, down, height),
            Step::Wheel(notches) => viewer.rig.wheel(notches),
            Step::Hold { keys, seconds } => {
                for key in &keys {
                    viewer.held.set(held_key(key)?, true);
                }
                self.wait = (seconds / SECONDS_PER_FRAME).round().clamp(1.0, 36_000.0) as u32;
            }
            Step::Key(name) => {
                let shortcut = shortcut_named(&name).ok_or_else(|| format!("there is no key {name}"))?;
                viewer.press(shortcut);
            }
            Step::LookFrom { eye, forward } => {
                let old = viewer.rig.view();
                let view = View::looking_along(eye.into(), forward.into(), old.vertical_fov, old.near);
                viewer.rig.set_view(&view);
            }
            Step::Click([x, y]) => viewer.click(x, y),
            Step::Select(name) => {
                if !viewer.select_named(&name) {
                    return Err(format!("there is no object {name}"));
                }
            }
            Step::Hide(on) => viewer.hide_selected(on),
            Step::ShowAll => viewer.show_all(),
            Step::Measure => viewer.measure(),
            Step::Record(on) => viewer.record(on),
            Step::Play(on) => viewer.play(on),
            Step::WaitForPlay => {}
            Step::PathFile(file) => state.path_file = file,
            Step::Drop(file) => viewer.open(&file),
            Step::Resize(size) => {
                wishes.resize = Some(size);
                // The window system answers when it likes.
                self.wait = 10;
            }
            Step::Frames(count) => self.wait = count.saturating_sub(1),
            Step::Screenshot(file) => wishes.screenshot = Some(file),
            Step::Dump(file) => wishes.dump = Some(file),
            Step::Watch(file) => self.watch = Some(file),
            Step::Stay => self.stay = true,
        }
        Ok(())
    }
}

fn held_key(name: &str) -> Result<KeyCode, String> {
    Ok(match name.to_lowercase().as_str() {
        "w" => KeyCode::KeyW,
        "a" => KeyCode::KeyA,
        "s" => KeyCode::KeyS,
        "d" => KeyCode::KeyD,
        "c" => KeyCode::KeyC,
        "space" => KeyCode::Space,
        "shift" => KeyCode::ShiftLeft,
        "up" => KeyCode::ArrowUp,
        "down" => KeyCode::ArrowDown,
        "left" => KeyCode::ArrowLeft,
        "right" => KeyCode::ArrowRight,
        _ => return Err(format!("no key {name} moves the camera")),
    })
}
