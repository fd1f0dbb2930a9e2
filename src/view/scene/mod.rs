//! The open file: what of it is drawn, and how it looks.

mod items;

pub(crate) use items::Missing;

use crate::stage::overlay;
use crate::stage::{Kind, Method, Stage, visible_objects};
use crate::view::canvas::{Canvas, SCENE_FORMAT};
use crate::view::figures::FrameFigures;
use crate::view::loading::Loaded;
use crate::view::state::{Colours, Limit, State};
use crate::view::tints;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use svs_render::{Frame, Gpu, GpuScene, Line, Offscreen, RenderError, Renderer, View, wgpu};
use svs_runtime::{Budget, CostModel, Detail, Settings};

/// A camera and the size of its image: all that culling looks from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    pub(crate) view: View,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// Everything the answer of culling depends on.
#[derive(Clone, Debug, PartialEq)]
struct CullKey {
    eye: Eye,
    method: Method,
    settings: Settings,
    limit: Limit,
    triangles: u64,
    milliseconds: f64,
    detail: Option<Detail>,
    hidden: u64,
}

/// An open file and everything that belongs to it.
pub(crate) struct OpenScene {
    pub(crate) path: PathBuf,
    pub(crate) stage: Stage,
    pub(crate) took: Duration,
    gpu_scene: GpuScene,
    renderer: Renderer,
    offscreen: Option<(Offscreen, [u32; 2])>,
    /// What is drawn, as culling gave it: objects, and their levels and proxies.
    drawn: Vec<u32>,
    /// For each object of the file: it is drawn, or something that stands for it.
    is_drawn: Vec<bool>,
    hidden: BTreeSet<u32>,
    hidden_version: u64,
    frozen: Option<Eye>,
    culled: Option<CullKey>,
    cull_us: f64,
    estimated_missing_ppm: f64,
    tints: Vec<[u8; 4]>,
    /// What a frame costs on this machine.
    pub(crate) cost: CostModel,
    lines: Vec<Line>,
}

impl OpenScene {
    /// Takes a file over from the loader.
    pub(crate) fn new(gpu: &Gpu, loaded: Loaded) -> Self {
        let objects = loaded.stage.scene.objects.len();
        Self {
            path: loaded.path,
            stage: loaded.stage,
            took: loaded.took,
            gpu_scene: loaded.gpu_scene,
            renderer: Renderer::new(gpu, SCENE_FORMAT),
            offscreen: None,
            drawn: Vec::new(),
            is_drawn: vec![false; objects],
            hidden: BTreeSet::new(),
            hidden_version: 0,
            frozen: None,
            culled: None,
            cull_us: 0.0,
            estimated_missing_ppm: 0.0,
            tints: Vec::new(),
            cost: CostModel::new(),
            lines: Vec::new(),
        }
    }

    /// Objects of the file.
    pub(crate) fn object_count(&self) -> usize {
        self.is_drawn.len()
    }

    /// Triangles of the file, each as often as it can be drawn.
    pub(crate) fn triangle_count(&self) -> u64 {
        self.stage.triangles().iter().map(|&triangles| u64::from(triangles)).sum()
    }

    /// Bytes on the GPU.
    pub(crate) fn gpu_bytes(&self) -> u64 {
        self.gpu_scene.bytes()
    }

    /// What culling lets through.
    pub(crate) fn drawn(&self) -> &[u32] {
        &self.drawn
    }

    /// Whether culling lets an object through, or something that stands for it.
    pub(crate) fn is_drawn(&self, object: u32) -> bool {
        self.is_drawn.get(object as usize).copied().unwrap_or(false)
    }

    /// Hidden by the user.
    pub(crate) fn is_hidden(&self, object: u32) -> bool {
        self.hidden.contains(&object)
    }

    /// How many the user has hidden.
    pub(crate) fn hidden_count(&self) -> usize {
        self.hidden.len()
    }

    /// Hides an object or shows it again.
    pub(crate) fn set_hidden(&mut self, object: u32, hidden: bool) {
        let changed = if hidden { self.hidden.insert(object) } else { self.hidden.remove(&object) };
        if changed && (object as usize) < self.object_count() {
            self.stage.set_hidden(object, hidden);
            self.hidden_version += 1;
        }
    }

    /// Shows everything again.
    pub(crate) fn show_all(&mut self) {
        for object in std::mem::take(&mut self.hidden) {
            self.stage.set_hidden(object, false);
        }
        self.hidden_version += 1;
    }

    /// What culling looks from: the camera, or where it was when culling was frozen.
    pub(crate) fn cull_eye(&self, eye: &Eye) -> Eye {
        self.frozen.unwrap_or(*eye)
    }

    /// Decides what is drawn. While frozen, the answer changes only with the settings.
    pub(crate) fn cull(&mut self, gpu: &Gpu, eye: &Eye, state: &State) -> Result<(), RenderError> {
        self.frozen = if state.freeze { self.frozen.or(Some(*eye)) } else { None };
        let eye = self.cull_eye(eye);
        let key = CullKey {
            eye,
            method: state.method,
            settings: state.settings(),
            limit: state.limit,
            triangles: state.triangles,
            milliseconds: state.milliseconds,
            detail: state.proxies.then(|| state.detail()),
            hidden: self.hidden_version,
        };
        if state.freeze && self.culled.as_ref() == Some(&key) {
            return Ok(());
        }
        let budget = match state.limit {
            // What is exact has no budget.
            _ if state.method == Method::Exact => Budget::Unlimited,
            Limit::None => Budget::Unlimited,
            Limit::Triangles => Budget::Triangles(state.triangles),
            Limit::Milliseconds => Budget::Milliseconds(state.milliseconds, &self.cost),
        };
        let begin = Instant::now();
        let Eye { view, width, height } = eye;
        let objects = match &key.detail {
            Some(detail) => {
                self.stage.select(&view, width, height, state.method, &key.settings, detail, &budget)
            }
            None => self.stage.cull(&view, width, height, state.method, &key.settings, &budget),
        };
        self.cull_us = begin.elapsed().as_secs_f64() * 1e6;
        self.drawn.clear();
        self.drawn.extend_from_slice(objects);
        let pixels = f64::from(eye.width) * f64::from(eye.height);
        let dropped = match state.method {
            Method::Nothing | Method::Exact => 0.0,
            Method::Frustum | Method::Visibility => self.stage.culler().selection().dropped_pixels,
        };
        self.estimated_missing_ppm = dropped / pixels.max(1.0) * 1e6;
        if state.method == Method::Exact {
            let items = self.items(gpu, &eye, Shown::Drawn)?;
            self.drawn = visible_objects(&items);
            self.cull_us = begin.elapsed().as_secs_f64() * 1e6;
        }
        self.is_drawn.fill(false);
        for &id in &self.drawn {
            match self.is_drawn.get_mut(id as usize) {
                Some(drawn) => *drawn = true,
                None => {
                    for object in self.stage.objects_of(id) {
                        self.is_drawn[object as usize] = true;
                    }
                }
            }
        }
        self.culled = Some(key);
        Ok(())
    }

    /// Everything the user has not hidden.
    fn not_hidden(&self) -> Vec<u32> {
        self.stage.order().iter().copied().filter(|object| !self.hidden.contains(object)).collect()
    }

    /// What is shown: what is drawn, or all with the skipped marked.
    fn shown(&self, state: &State) -> Shown {
        if state.freeze && state.skipped { Shown::All } else { Shown::Drawn }
    }

    /// Draws the scene into the canvas and waits for the GPU.
    pub(crate) fn draw(&mut self, gpu: &Gpu, canvas: &Canvas, eye: &Eye, state: &State) -> FrameFigures {
        self.colour(gpu, state);
        self.outline(eye, state);
        let shown = self.shown(state);
        let all = if shown == Shown::All { self.not_hidden() } else { Vec::new() };
        let objects = if shown == Shown::All { &all } else { &self.drawn };
        let begin = Instant::now();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let frame = Frame { view: eye.view, objects, lines: &self.lines };
        let statistics = self.renderer.draw(gpu, &self.gpu_scene, &frame, &canvas.target, &mut encoder);
        canvas.publish(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        // Waiting costs what it shows: the time of a frame without anything beside it. A lost device shows itself when
        // the window is drawn.
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        let frame_ms = begin.elapsed().as_secs_f64() * 1e3;
        if shown == Shown::Drawn {
            self.cost.record(statistics.triangles, statistics.objects as u64, frame_ms);
        }
        // Skipped objects that are shown all the same do not count.
        let triangles = |&object: &u32| u64::from(self.gpu_scene.triangles(object));
        FrameFigures {
            frame_ms,
            cull_us: self.cull_us,
            objects: self.drawn.len(),
            proxies: self.stage.count(&self.drawn, Kind::Proxy),
            simplified: self.stage.count(&self.drawn, Kind::Level),
            nodes: self.stage.nodes_shown(&self.drawn),
            draws: statistics.draw_calls,
            triangles: self.drawn.iter().map(triangles).sum(),
            estimated_missing_ppm: self.estimated_missing_ppm,
        }
    }

    fn colour(&mut self, gpu: &Gpu, state: &State) {
        let marks_skipped = self.shown(state) == Shown::All;
        let mut tints = tints::base(&self.stage, state.colours);
        if marks_skipped || state.selected.is_some() {
            let ids = self.stage.data.objects.len();
            tints.resize(ids, tints::NONE);
        }
        if marks_skipped {
            for (tint, _) in tints.iter_mut().zip(&self.is_drawn).filter(|(_, drawn)| !**drawn) {
                *tint = tints::SKIPPED;
            }
        }
        if let Some(object) = state.selected.filter(|&object| (object as usize) < tints.len()) {
            tints[object as usize] = tints::SELECTED;
            for level in self.stage.levels_of(object) {
                tints[level as usize] = tints::SELECTED;
            }
        }
        if tints != self.tints {
            self.tints = tints;
            let given = Some(self.tints.as_slice()).filter(|tints| !tints.is_empty());
            self.gpu_scene.set_tints(gpu, given);
        }
    }

    fn outline(&mut self, eye: &Eye, state: &State) {
        self.lines.clear();
        let at = self.cull_eye(eye);
        if state.freeze {
            let (min, max) = self.stage.bounds();
            let aspect = f64::from(at.width) / f64::from(at.height.max(1));
            let depth = (max - min).length();
            overlay::frustum(&at.view, aspect, depth, overlay::FRUSTUM_COLOUR, &mut self.lines);
        }
        if state.freeze && state.skipped_boxes {
            let mut lines = std::mem::take(&mut self.lines);
            let all = self.stage.order().iter().copied();
            let skipped = all.filter(|&object| !self.is_drawn(object) && !self.is_hidden(object));
            for object in skipped.take(overlay::MOST_BOXES) {
                let (min, max) = self.stage.object_bounds(object);
                overlay::edges(min, max, overlay::SKIPPED_COLOUR, &mut lines);
            }
            self.lines = lines;
        }
        if state.spheres {
            for sphere in self.spheres_in_use(&at, state) {
                overlay::sphere(sphere.center, sphere.radius, overlay::SPHERE_COLOUR, &mut self.lines);
            }
        }
        if let Some(object) = state.selected.filter(|&object| (object as usize) < self.object_count()) {
            let (min, max) = self.stage.object_bounds(object);
            overlay::edges(min, max, overlay::SELECTION_COLOUR, &mut self.lines);
        }
    }

    /// The spheres that answer from here, the largest first.
    pub(crate) fn spheres_in_use(&mut self, eye: &Eye, state: &State) -> Vec<svs_runtime::SphereInUse> {
        let mut spheres = Vec::new();
        if state.method == Method::Visibility && self.stage.is_baked() {
            let camera = Stage::camera(&eye.view, eye.width, eye.height);
            self.stage.culler().spheres_in_use(&camera, &state.settings(), &mut spheres);
        }
        spheres.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        spheres.truncate(overlay::MOST_SPHERES);
        spheres
    }

    /// Why an object is drawn or not, in words.
    pub(crate) fn explain(&mut self, object: u32, eye: &Eye, state: &State) -> String {
        let drawn = self.is_drawn(object);
        if self.is_hidden(object) {
            return "not drawn: you have hidden it".to_owned();
        }
        match state.method {
            Method::Nothing => return "drawn: this method draws everything".to_owned(),
            Method::Exact if drawn => return "drawn: it shows in the item buffer".to_owned(),
            Method::Exact => return "not drawn: it shows in no pixel of the item buffer".to_owned(),
            Method::Frustum | Method::Visibility => {}
        }
        if let Some(text) = self.stand_in(object, drawn) {
            return text;
        }
        let eye = self.cull_eye(eye);
        let Some(draw) = self.stage.draw_of(object) else {
            return "drawn always: culling does not know it".to_owned();
        };
        let camera = Stage::camera(&eye.view, eye.width, eye.height);
        let settings = if state.method == Method::Frustum { Settings::FRUSTUM } else { state.settings() };
        let reason = self.stage.culler().explain(draw, &camera, &settings);
        crate::view::explain::sentence(&reason, drawn, state.limit != Limit::None)
    }

    /// Colours can be shown: they need what was baked, or proxies.
    pub(crate) fn has(&self, colours: Colours) -> bool {
        match colours {
            Colours::Material | Colours::Object => true,
            Colours::Level | Colours::Importance => self.stage.is_baked(),
            Colours::Proxies | Colours::Severity => self.stage.has_proxies(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Drawn,
    All,
}
