//! The viewer without its window: scene, camera, settings, and what happens when they change.

use super::canvas::Canvas;
use super::figures::History;
use super::keys::{Held, Shortcut};
use super::loading::{Loading, file_name};
use super::recording::Tape;
use super::scene::{Eye, Missing, OpenScene};
use super::state::{Limit, State};
use crate::rig::{CameraMode, Rig};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use svs_render::{Gpu, RenderError, View};

/// Change of the quality per key press.
const QUALITY_STEP: f32 = 0.05;

/// Told where there is nothing to cull by but the frustum.
const NOT_BAKED: &str =
    "no baked visibility in this file: shown with frustum culling. `svs build IN -o OUT` bakes it.";

/// Something to tell the user, until the next one.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Message {
    pub(crate) text: String,
    /// Something failed.
    pub(crate) error: bool,
}

/// What was found at the last click.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Picked {
    pub(crate) object: u32,
    pub(crate) name: Option<String>,
    pub(crate) triangles: u32,
    pub(crate) drawn: bool,
    pub(crate) hidden: bool,
    pub(crate) why: String,
}

/// Everything the picture depends on; while it stays the same, nothing is drawn anew.
#[derive(Clone, Debug, PartialEq)]
struct PictureKey {
    eye: Eye,
    state: State,
    scene: u64,
    hidden: usize,
}

/// The viewer.
pub(crate) struct Viewer {
    gpu: Arc<Gpu>,
    wake: Arc<dyn Fn() + Send + Sync>,
    pub(crate) state: State,
    pub(crate) rig: Rig,
    pub(crate) scene: Option<OpenScene>,
    /// How many scenes were opened.
    scenes: u64,
    pub(crate) loading: Option<Loading>,
    pub(crate) message: Option<Message>,
    pub(crate) history: History,
    pub(crate) tape: Tape,
    pub(crate) held: Held,
    pub(crate) missing: Option<Missing>,
    pub(crate) picked: Option<Picked>,
    /// Spheres in use, while they are shown.
    pub(crate) spheres: usize,
    /// Size of the part of the window that shows the scene, pixels.
    pub(crate) viewport: [u32; 2],
    /// Where the controls are, in points of the window: left, top, width, height. For tests that use the mouse.
    pub(crate) places: BTreeMap<&'static str, [f32; 4]>,
    shown: Option<PictureKey>,
    camera: Option<View>,
}

impl Viewer {
    /// A viewer without a scene. `wake` makes the window draw; `camera` is where to look from in the first scene.
    pub(crate) fn new(
        gpu: Arc<Gpu>,
        state: State,
        camera: Option<View>,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> Self {
        Self {
            gpu,
            wake,
            state,
            rig: Rig::new(DVec3::splat(-1.0), DVec3::ONE),
            scene: None,
            scenes: 0,
            loading: None,
            message: None,
            history: History::default(),
            tape: Tape::default(),
            held: Held::default(),
            missing: None,
            picked: None,
            spheres: 0,
            viewport: [1, 1],
            places: BTreeMap::new(),
            shown: None,
            camera,
        }
    }

    /// Starts to open a file; the present scene stays until it is there. The last one asked for wins.
    pub(crate) fn open(&mut self, path: &Path) {
        let wake = Arc::clone(&self.wake);
        self.loading = Some(Loading::start(Arc::clone(&self.gpu), path.to_owned(), move || wake()));
    }

    /// Takes over what was loaded meanwhile.
    pub(crate) fn receive(&mut self) {
        match self.loading.as_mut().and_then(Loading::finished) {
            None => {}
            Some(Err(text)) => {
                self.loading = None;
                self.message = Some(Message { text, error: true });
            }
            Some(Ok(loaded)) => {
                self.loading = None;
                let scene = OpenScene::new(&self.gpu, loaded);
                let (min, max) = scene.stage.bounds();
                self.rig = Rig::new(min, max);
                self.rig.frame(None, self.aspect());
                if let Some(view) = self.camera.take() {
                    self.rig.set_view(&view);
                }
                let plain = (!scene.stage.is_baked()).then_some(NOT_BAKED);
                self.message = scene
                    .stage
                    .notice()
                    .or(plain)
                    .map(|text| Message { text: text.to_owned(), error: false });
                self.state.forget_scene();
                if !scene.has(self.state.colours) {
                    self.state.colours = super::state::Colours::Material;
                }
                self.tape.stop();
                self.history.clear();
                (self.missing, self.picked) = (None, None);
                self.scene = Some(scene);
                self.scenes += 1;
            }
        }
    }

    /// Width by height of the picture.
    pub(crate) fn aspect(&self) -> f64 {
        f64::from(self.viewport[0]) / f64::from(self.viewport[1].max(1))
    }

    /// The camera and the size of its picture.
    pub(crate) fn eye(&self) -> Eye {
        Eye { view: self.rig.view(), width: self.viewport[0], height: self.viewport[1] }
    }

    /// Lets time go by: held keys move the camera, paths are recorded and played.
    pub(crate) fn advance(&mut self, seconds: f64) {
        let motion = self.held.motion();
        self.rig.advance(&motion, seconds, self.tape.is_recording());
        if let Some(view) = self.tape.advance(&self.rig.view(), seconds) {
            self.rig.set_view(&view);
        }
        self.state.check();
    }

    /// Something goes on by itself: the next frame must follow at once.
    pub(crate) fn is_busy(&self) -> bool {
        self.held.motion().moves() || self.tape.is_playing() || self.state.continuous
    }

    /// Culls and draws, if the picture would be another one than before (or `always`).
    pub(crate) fn draw(&mut self, canvas: &Canvas, always: bool) -> Result<(), RenderError> {
        let eye = self.eye();
        let Some(scene) = &mut self.scene else { return Ok(()) };
        let key = PictureKey {
            eye,
            state: State {
                help: false,
                panel: true,
                graphs: false,
                path_file: String::new(),
                ..self.state.clone()
            },
            scene: self.scenes,
            hidden: scene.hidden_count(),
        };
        if !always && !self.state.continuous && self.shown.as_ref() == Some(&key) {
            return Ok(());
        }
        scene.cull(&self.gpu, &eye, &self.state)?;
        self.history.push(scene.draw(&self.gpu, canvas, &eye, &self.state));
        if self.shown.as_ref() != Some(&key) {
            // A measurement holds for the picture it was made of.
            self.missing = None;
        }
        let at = scene.cull_eye(&eye);
        self.spheres = if self.state.spheres { scene.spheres_in_use(&at, &self.state).len() } else { 0 };
        self.shown = Some(key);
        self.describe();
        Ok(())
    }

    /// Describes the selected object anew.
    fn describe(&mut self) {
        let eye = self.eye();
        let Some(scene) = &mut self.scene else { return };
        self.picked =
            self.state.selected.filter(|&object| (object as usize) < scene.object_count()).map(|object| {
                let index = object as usize;
                Picked {
                    object,
                    name: scene.stage.names.get(index).cloned().flatten(),
                    triangles: scene.stage.triangles().get(index).copied().unwrap_or(0),
                    drawn: scene.is_drawn(object),
                    hidden: scene.is_hidden(object),
                    why: scene.explain(object, &eye, &self.state),
                }
            });
    }

    /// A click at a pixel of the picture: selects what is there, or nothing.
    pub(crate) fn click(&mut self, x: f64, y: f64) {
        let eye = self.eye();
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(eye.width) && y < f64::from(eye.height);
        let Some(scene) = self.scene.as_mut().filter(|_| inside) else { return };
        match scene.pick(&self.gpu, &eye, &self.state, [x as u32, y as u32]) {
            Ok(object) => self.state.selected = object,
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Selects the first object of a node by name; says whether there is one.
    pub(crate) fn select_named(&mut self, name: &str) -> bool {
        let Some(scene) = &self.scene else { return false };
        let found = scene.stage.names.iter().position(|node| node.as_deref() == Some(name));
        self.state.selected = found.map(|index| index as u32);
        found.is_some()
    }

    /// Hides or shows the selected object.
    pub(crate) fn hide_selected(&mut self, hidden: bool) {
        if let (Some(scene), Some(object)) = (&mut self.scene, self.state.selected) {
            scene.set_hidden(object, hidden);
        }
    }

    /// Shows everything that was hidden.
    pub(crate) fn show_all(&mut self) {
        if let Some(scene) = &mut self.scene {
            scene.show_all();
        }
    }

    /// Measures what is missing in the present picture.
    pub(crate) fn measure(&mut self) {
        let eye = self.eye();
        let Some(scene) = &mut self.scene else { return };
        let culled = scene.cull(&self.gpu, &eye, &self.state);
        match culled.and_then(|()| scene.measure_missing(&self.gpu, &eye)) {
            Ok(missing) => self.missing = Some(missing),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Shows the whole scene or the selected object.
    pub(crate) fn frame(&mut self, selection: bool) {
        let bounds = match (&self.scene, self.state.selected) {
            (Some(scene), Some(object)) if selection && (object as usize) < scene.object_count() => {
                Some(scene.stage.object_bounds(object))
            }
            _ => None,
        };
        self.rig.frame(bounds, self.aspect());
    }

    /// Starts or ends recording; the end writes the path file.
    pub(crate) fn record(&mut self, on: bool) {
        if on == self.tape.is_recording() {
            return;
        }
        if on {
            let radius = self.scene.as_ref().map_or(1.0, |scene| {
                let (min, max) = scene.stage.bounds();
                (max - min).length() * 0.5
            });
            self.tape.record(radius);
            return;
        }
        let file = PathBuf::from(&self.state.path_file);
        match self.tape.save(&file, &self.rig.view()) {
            Ok(poses) => self.tell(format!("camera path with {poses} poses written to {}", file.display())),
            Err(error) => self.fail(format!("the camera path is not written: {error}")),
        }
    }

    /// Starts or ends playing the path file.
    pub(crate) fn play(&mut self, on: bool) {
        if !on {
            if self.tape.is_playing() {
                self.tape.stop();
            }
            return;
        }
        if let Err(error) = self.tape.play(Path::new(&self.state.path_file), self.rig.view().near) {
            self.fail(format!("the camera path cannot be played: {error}"));
        }
    }

    /// Says something.
    pub(crate) fn tell(&mut self, text: String) {
        self.message = Some(Message { text, error: false });
    }

    /// Says what went wrong.
    pub(crate) fn fail(&mut self, text: String) {
        self.message = Some(Message { text, error: true });
    }

    /// Does what a key does once.
    pub(crate) fn press(&mut self, shortcut: Shortcut) {
        let state = &mut self.state;
        match shortcut {
            Shortcut::Orbit => self.rig.switch(CameraMode::Orbit),
            Shortcut::Walk => self.rig.switch(CameraMode::Walk),
            Shortcut::SwitchCamera => self.rig.switch(match self.rig.mode() {
                CameraMode::Orbit => CameraMode::Walk,
                CameraMode::Walk => CameraMode::Orbit,
            }),
            Shortcut::Frame => self.frame(true),
            Shortcut::FrameAll => self.frame(false),
            Shortcut::Record => self.record(!self.tape.is_recording()),
            Shortcut::Play => self.play(!self.tape.is_playing()),
            Shortcut::Hide => {
                let hidden =
                    state.selected.zip(self.scene.as_ref()).is_some_and(|(o, scene)| scene.is_hidden(o));
                self.hide_selected(!hidden);
            }
            Shortcut::ShowAll => self.show_all(),
            Shortcut::Freeze => state.freeze = !state.freeze,
            Shortcut::Skipped => state.skipped = !state.skipped,
            Shortcut::SkippedBoxes => state.skipped_boxes = !state.skipped_boxes,
            Shortcut::Spheres => state.spheres = !state.spheres,
            Shortcut::Measure => self.measure(),
            Shortcut::NextMethod => state.next_method(),
            Shortcut::NextColours => {
                state.next_colours();
                while self.scene.as_ref().is_some_and(|scene| !scene.has(self.state.colours)) {
                    self.state.next_colours();
                }
            }
            Shortcut::LowerQuality => state.quality = (state.quality - QUALITY_STEP).max(0.0),
            Shortcut::HigherQuality => state.quality = (state.quality + QUALITY_STEP).min(1.0),
            Shortcut::Graphs => state.graphs = !state.graphs,
            Shortcut::Panel => state.panel = !state.panel,
            Shortcut::Help => state.help = !state.help,
            Shortcut::Leave => {
                if !std::mem::take(&mut state.help) {
                    state.selected = None;
                }
            }
        }
    }

    /// Title of the window.
    pub(crate) fn title(&self) -> String {
        match &self.scene {
            Some(scene) => format!("{} - svs", file_name(&scene.path)),
            None => "svs".to_owned(),
        }
    }

    /// Settings and figures as JSON: what tests look at.
    pub(crate) fn dump(&self) -> serde_json::Value {
        let view = self.rig.view();
        serde_json::json!({
            "state": self.state,
            "file": self.scene.as_ref().map(|scene| file_name(&scene.path)),
            "baked": self.scene.as_ref().is_some_and(|scene| scene.stage.is_baked()),
            "objects": self.scene.as_ref().map_or(0, OpenScene::object_count),
            "total_triangles": self.scene.as_ref().map_or(0, OpenScene::triangle_count),
            "loading": self.loading.as_ref().map(Loading::name),
            "message": self.message,
            "frames": self.history.total(),
            "figures": self.history.last(),
            "drawn": self.scene.as_ref().map(|scene| scene.drawn()),
            "hidden": self.scene.as_ref().map_or(0, OpenScene::hidden_count),
            "spheres": self.spheres,
            "missing": self.missing,
            "picked": self.picked,
            "tape": self.tape.status(),
            "camera": {
                "mode": self.rig.mode(),
                "eye": view.eye.to_array(),
                "forward": view.forward.to_array(),
                "metres_per_second": self.rig.metres_per_second(),
            },
            "viewport": self.viewport,
            "places": self.places,
            "cost_error": self.scene.as_ref().map(|scene| scene.cost.error()),
            "budget_is_on": self.state.limit != Limit::None,
        })
    }
}
