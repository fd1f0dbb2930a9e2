//! Scene, culler and renderer, ready to be asked for frames.

use super::error::EvaluateError;
use super::method::EvaluationMethod;
use super::options::{EvaluateOptions, FrameBudget};
use crate::gltf::Document;
use crate::stage::{Method, Stage};
use std::time::Instant;
use svs_render::{Frame, FrameTime, Gpu, GpuScene, Image, ItemBuffer, Offscreen, Renderer, SceneData, View};
use svs_runtime::{Budget, CostModel, Detail, Settings};

/// What a frame is drawn with, apart from the method.
pub(super) struct Shot {
    pub(super) view: View,
    /// What [`EvaluationMethod::Exact`] draws.
    pub(super) exact: Vec<u32>,
    /// Triangles allowed for the methods with a budget.
    pub(super) triangles: Option<u64>,
}

/// Says what a method draws.
pub(super) struct Cullers {
    pub(super) stage: Stage,
    /// With cullers of their own: what was drawn in the last frame counts for these methods, and the others must not come
    /// between.
    with_memory: Vec<(EvaluationMethod, Stage)>,
    pub(super) settings: Settings,
    detail: Detail,
    pub(super) cost: CostModel,
    milliseconds: Option<f64>,
    width: u32,
    height: u32,
}

impl Cullers {
    /// The objects that a method draws.
    pub(super) fn cull<'a>(&'a mut self, shot: &'a Shot, method: EvaluationMethod) -> &'a [u32] {
        let capacity = shot.triangles.unwrap_or(u64::MAX);
        let found = self.with_memory.iter_mut().find(|(own, _)| *own == method);
        let stage = found.map_or(&mut self.stage, |(_, stage)| stage);
        let limit = match (self.milliseconds, shot.triangles) {
            (Some(most), _) => Budget::Milliseconds(most, &self.cost),
            (None, Some(most)) => Budget::Triangles(most),
            (None, None) => Budget::Unlimited,
        };
        let (width, height, settings) = (self.width, self.height, &self.settings);
        if let Some(metric) = method.draws_proxies() {
            let detail = Detail { metric: metric.unwrap_or(self.detail.metric), ..self.detail };
            let by =
                if method == EvaluationMethod::ProxiesFrustum { Method::Frustum } else { Method::Visibility };
            return stage.select(&shot.view, width, height, by, settings, &detail, &limit);
        }
        let (method, budget) = match method {
            EvaluationMethod::Exact => return &shot.exact,
            EvaluationMethod::Nothing => (Method::Nothing, Budget::Unlimited),
            EvaluationMethod::Frustum => (Method::Frustum, Budget::Unlimited),
            EvaluationMethod::FirstMisfit => (Method::Visibility, Budget::StopAtFirstMisfit(capacity)),
            EvaluationMethod::Budget => (Method::Visibility, limit),
            _ => (Method::Visibility, Budget::Unlimited),
        };
        stage.cull(&shot.view, width, height, method, settings, &budget)
    }

    pub(super) fn triangles_of(&self, objects: &[u32]) -> u64 {
        let triangles = self.stage.triangles();
        objects
            .iter()
            .filter_map(|&object| triangles.get(object as usize))
            .map(|&count| u64::from(count))
            .sum()
    }
}

/// A frame that was culled and drawn.
pub(super) struct Flown<'a> {
    /// Culling, microseconds.
    pub(super) cull_us: f64,
    /// What was drawn.
    pub(super) objects: &'a [u32],
    pub(super) time: FrameTime,
}

/// Everything a frame needs.
pub(super) struct Bench {
    pub(super) cullers: Cullers,
    pub(super) gpu: Gpu,
    pub(super) scene: GpuScene,
    renderer: Renderer,
    offscreen: Offscreen,
}

impl Bench {
    pub(super) fn new(doc: &Document, options: &EvaluateOptions) -> Result<Self, EvaluateError> {
        let mut stage = Stage::open(doc)?;
        let gpu = Gpu::headless()?;
        let offscreen = Offscreen::new(&gpu, options.width, options.height)?;
        let scene = GpuScene::upload(&gpu, &stage.data, stage.upload_order())?;
        // It is on the GPU now.
        stage.data = SceneData::default();
        let mut with_memory = Vec::new();
        let mut methods: Vec<EvaluationMethod> = options.methods.clone();
        methods.extend(Some(options.reference).filter(|reference| !options.methods.contains(reference)));
        for method in methods.into_iter().filter(|method| method.has_memory()) {
            let mut stage = Stage::open(doc)?;
            stage.data = SceneData::default();
            with_memory.push((method, stage));
        }
        let cullers = Cullers {
            settings: options.quality.map_or_else(|| stage.recommended(), Settings::from_quality),
            with_memory,
            detail: options.detail,
            stage,
            cost: CostModel::new(),
            milliseconds: match options.budget {
                Some(FrameBudget::Milliseconds(most)) => Some(most),
                _ => None,
            },
            width: options.width,
            height: options.height,
        };
        Ok(Self { cullers, renderer: Offscreen::renderer(&gpu), offscreen, scene, gpu })
    }

    /// Culls, then draws what is left, and takes the time of both.
    pub(super) fn fly<'a>(
        &'a mut self,
        shot: &'a Shot,
        method: EvaluationMethod,
    ) -> Result<Flown<'a>, EvaluateError> {
        let start = Instant::now();
        let objects = self.cullers.cull(shot, method);
        let cull_us = match method {
            EvaluationMethod::Exact => 0.0,
            _ => start.elapsed().as_secs_f64() * 1e6,
        };
        let frame = Frame { view: shot.view, objects, lines: &[] };
        let time = self.offscreen.time(&self.gpu, &mut self.renderer, &self.scene, &frame)?;
        Ok(Flown { cull_us, objects, time })
    }

    /// Draws these objects and takes the time.
    pub(super) fn time(&mut self, view: View, objects: &[u32]) -> Result<FrameTime, EvaluateError> {
        let frame = Frame { view, objects, lines: &[] };
        Ok(self.offscreen.time(&self.gpu, &mut self.renderer, &self.scene, &frame)?)
    }

    pub(super) fn image(&mut self, view: View, objects: &[u32]) -> Result<Image, EvaluateError> {
        let frame = Frame { view, objects, lines: &[] };
        Ok(self.offscreen.image(&self.gpu, &mut self.renderer, &self.scene, &frame)?)
    }

    pub(super) fn items(&mut self, view: View, objects: &[u32]) -> Result<ItemBuffer, EvaluateError> {
        let frame = Frame { view, objects, lines: &[] };
        Ok(self.offscreen.items(&self.gpu, &mut self.renderer, &self.scene, &frame)?)
    }
}
