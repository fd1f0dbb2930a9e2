//! What a frame costs, learnt from frames.

/// Predicts the time of a frame: a base, plus so much per triangle, plus so much per object drawn, none of them negative.
///
/// The three are fitted to measured frames by recursive least squares (the normal equations are kept and fade by 2 % with
/// each frame), relative to each frame's time, so that short and long frames count alike. Single frames far off what the
/// others say count less (Huber 1964); several in turn are taken for a change, and most of what was before is forgotten.
/// What the frames leave open, the proportions of the three in [`Self::new`] decide.
#[derive(Clone, Debug)]
pub struct CostModel {
    /// Milliseconds: of an empty frame, per million triangles, per thousand objects.
    coefficients: [f64; 3],
    /// Weighted sums over the frames of `x xᵀ` and of `x · ms`.
    matrix: [[f64; 3]; 3],
    right: [f64; 3],
    /// Relative errors of the latest predictions, a ring.
    errors: [f32; WINDOW],
    frames: usize,
    /// Frames in turn that were surprisingly late (positive) or early (negative).
    streak: i32,
}

/// Milliseconds before any frame was seen: of an empty frame, per million triangles, per thousand objects. A modest GPU;
/// later only the proportions matter.
const PRIOR: [f64; 3] = [0.5, 10.0, 2.0];
/// Share of its weight that a frame keeps with each further frame: about fifty count.
const FADE: f64 = 0.98;
/// Weight of the prior, in frames: a frame counts 1 where it says something of a coefficient.
const PRIOR_WEIGHT: f64 = 2e-4;
/// Predictions whose errors are remembered.
const WINDOW: usize = 64;
/// Frames until one may be taken for an outlier.
const TRUSTING: usize = 8;
/// Relative errors beyond this many times the median count less. 2.5 medians are 1.7 standard deviations.
const OUTLIER: f64 = 2.5;
/// Errors below this are never outliers.
const SMALLEST_ERROR: f64 = 0.02;
/// Outliers in turn, all late or all early, that are a change.
const CHANGE: i32 = 6;
/// Weight that earlier frames keep after a change.
const KEPT: f64 = 0.02;

/// Ranges that are believed.
const MOST_TRIANGLES: f64 = 1e12;
const MOST_DRAWS: f64 = 1e9;
const LEAST_MS: f64 = 1e-3;
const MOST_MS: f64 = 1e7;

impl CostModel {
    /// All that predictions depend on.
    pub(crate) fn coefficients(&self) -> [f64; 3] {
        self.coefficients
    }

    /// Before it has seen a frame: 0.5 ms, 10 ms per million triangles and 2 ms per thousand objects.
    pub fn new() -> Self {
        Self {
            coefficients: PRIOR,
            matrix: [[0.0; 3]; 3],
            right: [0.0; 3],
            errors: [0.0; WINDOW],
            frames: 0,
            streak: 0,
        }
    }

    /// Learns from a frame that drew `triangles` in `draws` objects (as [`crate::Selection`] counts them: objects, not
    /// calls after merging) in `ms` milliseconds. Times that are not positive numbers are ignored.
    pub fn record(&mut self, triangles: u64, draws: u64, ms: f64) {
        if !(ms.is_finite() && ms > 0.0) {
            return;
        }
        let ms = ms.clamp(LEAST_MS, MOST_MS);
        let predicted = self.predict(triangles, draws);
        let error = (predicted - ms).abs() / ms;
        // A late frame is an outlier by what it is above the prediction, an early one by what it is below.
        let surprise = (predicted - ms).abs() / predicted.max(LEAST_MS).min(ms.max(LEAST_MS) * 4.0);
        let limit = OUTLIER * self.error().max(SMALLEST_ERROR);
        let mut trust = if self.frames < TRUSTING || surprise <= limit { 1.0 } else { limit / surprise };
        let side = if ms > predicted { 1 } else { -1 };
        self.streak = match self.streak {
            _ if surprise <= limit => 0,
            streak if streak.signum() == side => streak + side,
            _ => side,
        };
        if self.streak.abs() >= CHANGE {
            self.matrix.iter_mut().flatten().chain(&mut self.right).for_each(|entry| *entry *= KEPT);
            (self.streak, trust) = (0, 1.0);
        }
        self.errors[self.frames % WINDOW] = error.min(f64::from(f32::MAX)) as f32;
        self.frames += 1;
        // Relative to the prediction once there is one worth the name: relative to the time itself, noise would pull the fit
        // down.
        let scale =
            if self.frames > TRUSTING { predicted.max(ms * 0.25).min(ms * 4.0) } else { ms }.max(LEAST_MS);
        let weight = trust / (scale * scale);
        let x = features(triangles, draws);
        for (i, (row, right)) in self.matrix.iter_mut().zip(&mut self.right).enumerate() {
            for (entry, xj) in row.iter_mut().zip(x) {
                *entry = *entry * FADE + weight * x[i] * xj;
            }
            *right = *right * FADE + weight * x[i] * ms;
        }
        self.fit();
    }

    /// Milliseconds of a frame that draws `triangles` in `draws` objects. Never falls when either grows.
    pub fn predict(&self, triangles: u64, draws: u64) -> f64 {
        let [base, per_triangle, per_draw] = self.coefficients;
        base + per_triangle * (triangles as f64 * 1e-6) + per_draw * (draws as f64 * 1e-3)
    }

    /// Milliseconds that so many more triangles and draws add.
    pub(crate) fn predict_difference(&self, triangles: i64, draws: i64) -> f64 {
        let [_, per_triangle, per_draw] = self.coefficients;
        per_triangle * (triangles as f64 * 1e-6) + per_draw * (draws as f64 * 1e-3)
    }

    /// Milliseconds that one more object of so many triangles adds.
    pub(crate) fn predict_object(&self, triangles: u32) -> f64 {
        let [_, per_triangle, per_draw] = self.coefficients;
        per_triangle * (f64::from(triangles) * 1e-6) + per_draw * 1e-3
    }

    /// Median relative error, |predicted - measured| / measured, of the latest 64 predictions, each made before its
    /// frame was seen. 1 before the first frame.
    pub fn error(&self) -> f64 {
        let count = self.frames.min(WINDOW);
        if count == 0 {
            return 1.0;
        }
        // Errors are not negative, so their bits are in the same order: whole numbers are sorted elsewhere, too.
        let mut errors = self.errors.map(|error| u64::from(error.to_bits()));
        errors[..count].sort_unstable();
        f64::from(f32::from_bits(errors[count / 2] as u32))
    }

    /// Frames learnt from.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Most triangles that `draws` objects may have for the frame to take at most `ms` milliseconds; 0 if not even none
    /// fit.
    pub fn triangles_for(&self, ms: f64, draws: u64) -> u64 {
        let left = ms - self.predict(0, draws);
        if left < 0.0 || left.is_nan() {
            return 0;
        }
        // Conversion saturates: a division by 0 gives the largest number, 0 / 0 gives 0.
        let mut triangles = (left / self.coefficients[1] * 1e6) as u64;
        while triangles > 0 && self.predict(triangles, draws) > ms {
            triangles -= (triangles >> 40).max(1);
        }
        triangles
    }

    /// Solves for the coefficients: the least squares among those that are not negative, tried with each subset held at 0.
    fn fit(&mut self) {
        let (mut matrix, mut right) = (self.matrix, self.right);
        // The prior's proportions at the speed of this machine: the one factor that fits best.
        let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let speed = product(&right, &PRIOR) / product(&matrix.map(|row| product(&row, &PRIOR)), &PRIOR);
        if !speed.is_finite() || speed <= 0.0 {
            return;
        }
        let prior = PRIOR.map(|coefficient| coefficient * speed);
        for i in 0..3 {
            // A coefficient that is off by its own size costs the weight.
            let ridge = PRIOR_WEIGHT / (prior[i] * prior[i]);
            matrix[i][i] += ridge;
            right[i] += ridge * prior[i];
        }
        let mut best: Option<([f64; 3], f64)> = None;
        for free in 0..8_u8 {
            let Some(found) = solve(&matrix, &right, free) else { continue };
            // The squares less a constant: x·A·x - 2 r·x, at a stationary point of the free ones -r·x.
            let squares = -(0..3).map(|i| right[i] * found[i]).sum::<f64>();
            if found.iter().all(|&c| c.is_finite() && c >= 0.0)
                && best.as_ref().is_none_or(|best| squares < best.1)
            {
                best = Some((found, squares));
            }
        }
        if let Some((found, _)) = best {
            self.coefficients = found;
        }
    }
}

impl Default for CostModel {
    fn default() -> Self {
        Self::new()
    }
}

/// One, millions of triangles, thousands of objects.
fn features(triangles: u64, draws: u64) -> [f64; 3] {
    let (triangles, draws) = (triangles as f64, draws as f64);
    [1.0, triangles.min(MOST_TRIANGLES) * 1e-6, draws.min(MOST_DRAWS) * 1e-3]
}

/// Solves the equations of the unknowns whose bit is set in `free`, the others being 0, by Gaussian elimination of a
/// matrix that is positive definite. `None` if it is not, numerically.
fn solve(matrix: &[[f64; 3]; 3], right: &[f64; 3], free: u8) -> Option<[f64; 3]> {
    let (mut a, mut x) = (*matrix, *right);
    let is_free = |i: usize| free >> i & 1 == 1;
    for i in (0..3).filter(|&i| !is_free(i)) {
        a.iter_mut().for_each(|row| row[i] = 0.0);
        (a[i], x[i]) = ([0.0; 3], 0.0);
        a[i][i] = 1.0;
    }
    for i in 0..3 {
        if a[i][i] <= 0.0 || !a[i][i].is_finite() {
            return None;
        }
        for j in i + 1..3 {
            let factor = a[j][i] / a[i][i];
            let row = a[i];
            for (entry, above) in a[j].iter_mut().zip(row) {
                *entry -= factor * above;
            }
            x[j] -= factor * x[i];
        }
    }
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|j| a[i][j] * x[j]).sum();
        x[i] = (x[i] - known) / a[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests;
