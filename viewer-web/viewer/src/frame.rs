//! One frame: what is drawn, and what it cost.

use crate::open::Open;
use crate::settings::{Controls, Limit};
use svs::rig::Rig;
use svs::stage::{Kind, Method, Stage, overlay};
use svs_render::{Frame, Gpu, Line, Renderer, View, wgpu};
use svs_runtime::{Budget, CostModel};

use crate::surface::CanvasSurface;

/// Tint of the selected object.
const SELECTED: [u8; 4] = [255, 150, 30, 170];

/// A camera and the size of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    pub(crate) view: View,
    pub(crate) size: [u32; 2],
}

/// The last frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Figures {
    pub(crate) frames: u64,
    pub(crate) cull_us: f64,
    /// From one drawn frame to the next, if they followed each other.
    pub(crate) frame_ms: Option<f64>,
    /// Until all commands were given.
    pub(crate) encode_ms: f64,
    pub(crate) objects: usize,
    pub(crate) triangles: u64,
    pub(crate) draws: usize,
    pub(crate) proxies: usize,
    pub(crate) simplified: usize,
    pub(crate) dropped_pixels: f64,
}

/// What draws, and what it has to remember from frame to frame.
#[derive(Debug)]
pub(crate) struct Painter {
    pub(crate) renderer: Renderer,
    pub(crate) cost: CostModel,
    pub(crate) figures: Figures,
    pub(crate) drawn: Vec<u32>,
    frozen: Option<Eye>,
    lines: Vec<Line>,
    tinted: Option<u32>,
    last: Option<(f64, u64, u64)>,
}

impl Painter {
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self {
            renderer: Renderer::new(gpu, format),
            cost: CostModel::new(),
            figures: Figures::default(),
            drawn: Vec::new(),
            frozen: None,
            lines: Vec::new(),
            tinted: None,
            last: None,
        }
    }

    /// Another file, or more of it.
    pub(crate) fn forget_tints(&mut self) {
        self.tinted = None;
    }

    /// The next frame follows no other.
    pub(crate) fn pause(&mut self) {
        self.last = None;
    }

    /// Decides what is drawn.
    pub(crate) fn cull(&mut self, open: &mut Open, eye: Eye, controls: &Controls, now: fn() -> f64) {
        self.frozen = if controls.freeze { self.frozen.or(Some(eye)) } else { None };
        let Eye { view, size: [width, height] } = self.frozen.unwrap_or(eye);
        let budget = match controls.limit {
            Limit::None => Budget::Unlimited,
            Limit::Triangles(triangles) => Budget::Triangles(triangles),
            Limit::Milliseconds(ms) => Budget::Milliseconds(ms, &self.cost),
        };
        let begin = now();
        let (method, settings) = (controls.method, controls.settings());
        let drawn = if controls.proxies {
            open.stage.select(&view, width, height, method, &settings, &controls.detail(), &budget)
        } else {
            open.stage.cull(&view, width, height, method, &settings, &budget)
        };
        self.figures.cull_us = (now() - begin) * 1e3;
        self.drawn.clear();
        self.drawn.extend_from_slice(drawn);
        if open.is_loading() {
            self.stand_in(open);
        }
        self.figures.dropped_pixels = match method {
            Method::Nothing | Method::Exact => 0.0,
            Method::Frustum | Method::Visibility => open.stage.culler().selection().dropped_pixels,
        };
        self.figures.proxies = open.stage.count(&self.drawn, Kind::Proxy);
        self.figures.simplified = open.stage.count(&self.drawn, Kind::Level);
    }

    /// Proxies for what has not come yet, as far as they have.
    fn stand_in(&mut self, open: &Open) {
        let missing = self.drawn.iter().filter(|&&id| !open.has(id));
        let mut proxies: Vec<u32> =
            missing.filter_map(|&id| open.stage.proxies_around(id).find(|&proxy| open.has(proxy))).collect();
        proxies.sort_unstable();
        proxies.dedup();
        self.drawn.extend(proxies);
    }

    /// Draws; says whether it could.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        surface: &mut CanvasSurface,
        open: &mut Open,
        eye: Eye,
        controls: &Controls,
        now: fn() -> f64,
    ) -> bool {
        self.overlay(&open.stage, controls);
        self.tint(gpu, open, controls.selected);
        let Some(scene) = &open.gpu_scene else { return false };
        let begin = now();
        let Some((texture, target)) = surface.acquire(gpu) else { return false };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let frame = Frame { view: eye.view, objects: &self.drawn, lines: &self.lines };
        let statistics = self.renderer.draw(gpu, scene, &frame, &target, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(texture);
        let figures = &mut self.figures;
        figures.frames += 1;
        figures.encode_ms = now() - begin;
        (figures.objects, figures.triangles) = (statistics.objects, statistics.triangles);
        figures.draws = statistics.draw_calls;
        // A frame takes until the next one begins, where they follow each other.
        figures.frame_ms = self.last.map(|(at, triangles, objects)| {
            self.cost.record(triangles, objects, begin - at);
            begin - at
        });
        self.last = Some((begin, statistics.triangles, statistics.objects as u64));
        true
    }

    /// What the camera sees on an image of this size.
    pub(crate) fn view_of(rig: &Rig, size: [u32; 2]) -> Eye {
        Eye { view: rig.view(), size }
    }

    fn overlay(&mut self, stage: &Stage, controls: &Controls) {
        self.lines.clear();
        if let Some(Eye { view, size: [width, height] }) = self.frozen {
            let (min, max) = stage.bounds();
            let aspect = f64::from(width) / f64::from(height.max(1));
            overlay::frustum(&view, aspect, (max - min).length(), overlay::FRUSTUM_COLOUR, &mut self.lines);
        }
        if let Some(object) = controls.selected.filter(|&o| (o as usize) < stage.scene.objects.len()) {
            let (min, max) = stage.object_bounds(object);
            overlay::edges(min, max, overlay::SELECTION_COLOUR, &mut self.lines);
        }
    }

    fn tint(&mut self, gpu: &Gpu, open: &mut Open, selected: Option<u32>) {
        if self.tinted == selected {
            return;
        }
        self.tinted = selected;
        let Some(scene) = &mut open.gpu_scene else { return };
        let Some(object) = selected else { return scene.set_tints(gpu, None) };
        let mut tints = vec![[0; 4]; open.stage.data.objects.len()];
        for id in std::iter::once(object).chain(open.stage.levels_of(object)) {
            if let Some(tint) = tints.get_mut(id as usize) {
                *tint = SELECTED;
            }
        }
        scene.set_tints(gpu, Some(&tints));
    }
}
