//! What is seen pixel by pixel: picking, what is missing, what stands for an object.

use super::{Eye, OpenScene, Shown};
use crate::stage::Extra;
use crate::view::explain;
use crate::view::state::State;
use std::collections::BTreeSet;
use svs_render::{Frame, Gpu, ItemBuffer, NO_ITEM, Offscreen, RenderError};
use svs_runtime::Outcome;

/// What is missing, measured.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Missing {
    /// Pixels that show an object which is not drawn.
    pub(crate) pixels: u64,
    /// Pixels of the image.
    pub(crate) of: u64,
    /// Missing pixels per million pixels of the image.
    pub(crate) ppm: f64,
    /// Objects that are seen and not drawn.
    pub(crate) objects: usize,
}

impl OpenScene {
    /// Which object is nearest at every pixel.
    pub(super) fn items(&mut self, gpu: &Gpu, eye: &Eye, shown: Shown) -> Result<ItemBuffer, RenderError> {
        let size = [eye.width.max(1), eye.height.max(1)];
        let mut offscreen = match self.offscreen.take() {
            Some((offscreen, has)) if has == size => offscreen,
            _ => Offscreen::new(gpu, size[0], size[1])?,
        };
        let all: Vec<u32>;
        let objects = match shown {
            Shown::Drawn => &self.drawn,
            Shown::All => {
                all = self.not_hidden();
                &all
            }
        };
        let frame = Frame { view: eye.view, objects, lines: &[] };
        let items = offscreen.items(gpu, &mut self.renderer, &self.gpu_scene, &frame);
        self.offscreen = Some((offscreen, size));
        items
    }

    /// The object at a pixel of the picture; glass counts before what is behind it.
    pub(crate) fn pick(
        &mut self,
        gpu: &Gpu,
        eye: &Eye,
        state: &State,
        pixel: [u32; 2],
    ) -> Result<Option<u32>, RenderError> {
        let [x, y] = pixel.map(|side| side as usize);
        let at = |items: &ItemBuffer| {
            let index = y * items.width as usize + x;
            let at = |buffer: &[u32]| buffer.get(index).copied().filter(|&object| object != NO_ITEM);
            at(&items.transparent).or_else(|| at(&items.nearest))
        };
        let found = at(&self.items(gpu, eye, self.shown(state))?);
        match found.and_then(|id| self.stage.extra(id)) {
            None => Ok(found),
            Some(Extra::Level { object, .. }) => Ok(Some(object)),
            // Which of its objects: the one that would be seen there.
            Some(Extra::Proxy { .. }) => Ok(at(&self.items(gpu, eye, Shown::All)?)),
        }
    }

    /// Compares what is drawn with everything that could be, pixel by pixel, from where culling looks.
    pub(crate) fn measure_missing(&mut self, gpu: &Gpu, eye: &Eye) -> Result<Missing, RenderError> {
        let eye = self.cull_eye(eye);
        let items = self.items(gpu, &eye, Shown::All)?;
        let lacks = |object: u32| object != NO_ITEM && !self.is_drawn(object);
        let mut objects = BTreeSet::new();
        let mut pixels = 0_u64;
        for (&nearest, &transparent) in items.nearest.iter().zip(&items.transparent) {
            if lacks(nearest) || lacks(transparent) {
                pixels += 1;
                objects.extend([nearest, transparent].into_iter().filter(|&object| lacks(object)));
            }
        }
        let of = items.nearest.len() as u64;
        Ok(Missing { pixels, of, ppm: pixels as f64 / of.max(1) as f64 * 1e6, objects: objects.len() })
    }

    /// What is drawn in the place of an object, in words; `None` if it is drawn itself, or nothing is.
    pub(super) fn stand_in(&self, object: u32, drawn: bool) -> Option<String> {
        if !drawn || !self.stage.has_proxies() || self.drawn.contains(&object) {
            return None;
        }
        let stands =
            |&id: &u32| self.stage.extra(id).is_some() && self.stage.objects_of(id).contains(&object);
        let id = self.drawn.iter().copied().find(stands)?;
        let triangles = u64::from(self.gpu_scene.triangles(id));
        let error = self.stage.outcome(object).and_then(|outcome| match outcome {
            Outcome::Level { error, .. } | Outcome::Proxy { error, .. } => Some(error),
            _ => None,
        });
        Some(match self.stage.extra(id)? {
            Extra::Level { level, .. } => explain::level(level, error, triangles),
            Extra::Proxy { .. } => explain::proxy(self.stage.objects_of(id).len() as u64, error, triangles),
        })
    }
}
