//! Smallest enclosing ball of a few points.
//!
//! Farthest-point pivoting as in Gärtner, Fast and Robust Smallest Enclosing Balls, ESA 1999: the ball of the
//! current support is grown by the farthest point outside it until there is none. The radius rises with every
//! step, so no support comes twice. The ball of a support and one more point (five at most) is found by
//! trying every subset that has the new point, which needs no cases for degenerate positions: subsets without a
//! circumscribed ball are passed over.

use crate::bake::tree::Sphere;
use glam::DVec3;

/// Points this far outside (part of the radius) count as inside.
pub(super) const TOLERANCE: f64 = 1e-12;

/// Smallest ball of finite points; `None` without points. Its radius is exact but for rounding, and large enough for
/// all points.
pub(super) fn exact_ball(points: &[DVec3]) -> Option<Sphere> {
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    let middle = low * 0.5 + high * 0.5;
    let extent = (high - low).max_element();
    if extent <= 0.0 {
        return Some(Sphere { center: middle, radius: 0.0 });
    }
    // About the middle and of unit size: squares neither overflow nor vanish, and offsets cost no digits.
    let unit: Vec<DVec3> = points.iter().map(|&point| (point - middle) / extent).collect();
    let mut support = vec![farthest(&unit, unit[0]).0];
    let mut ball = Ball { center: support[0], squared: 0.0 };
    loop {
        let (point, squared) = farthest(&unit, ball.center);
        if squared <= ball.squared * (1.0 + TOLERANCE) {
            break;
        }
        match grow(&support, point) {
            // A step that does not grow has reached the limit of the arithmetic.
            Some((grown, next)) if grown.squared > ball.squared => (ball, support) = (grown, next),
            _ => break,
        }
    }
    let center = middle + ball.center * extent;
    let radius = points.iter().map(|point| point.distance(center)).fold(0.0, f64::max);
    Some(Sphere { center, radius })
}

#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    squared: f64,
}

/// The first of the points farthest from `center`, and its squared distance.
fn farthest(points: &[DVec3], center: DVec3) -> (DVec3, f64) {
    let mut best = (center, -1.0);
    for &point in points {
        let squared = point.distance_squared(center);
        if squared > best.1 {
            best = (point, squared);
        }
    }
    best
}

/// The smallest ball of `support` and `point` that has `point` on its surface, and its support.
fn grow(support: &[DVec3], point: DVec3) -> Option<(Ball, Vec<DVec3>)> {
    let mut best: Option<(Ball, Vec<DVec3>)> = None;
    for subset in 0u32..1 << support.len() {
        if subset.count_ones() > 3 {
            continue;
        }
        let others: Vec<DVec3> =
            (0..support.len()).filter(|&i| subset >> i & 1 == 1).map(|i| support[i]).collect();
        let Some(ball) = circumscribed(point, &others) else { continue };
        let holds = |other: &DVec3| other.distance_squared(ball.center) <= ball.squared * (1.0 + TOLERANCE);
        if support.iter().all(holds) && best.as_ref().is_none_or(|(best, _)| ball.squared < best.squared) {
            let mut next = others;
            next.push(point);
            best = Some((ball, next));
        }
    }
    best
}

/// The smallest ball with `origin` and up to three `others` on its surface; `None` if they are nearly dependent.
fn circumscribed(origin: DVec3, others: &[DVec3]) -> Option<Ball> {
    // The centre is origin + sum of x_i v_i with 2 v_i . sum of x_j v_j = v_i . v_i.
    let count = others.len();
    let v: Vec<DVec3> = others.iter().map(|&other| other - origin).collect();
    let mut rows = [[0.0; 4]; 3];
    for i in 0..count {
        for j in 0..count {
            rows[i][j] = 2.0 * v[i].dot(v[j]);
        }
        rows[i][3] = v[i].length_squared();
    }
    let scale = (0..count).map(|i| rows[i][3]).fold(0.0, f64::max);
    // Gauss-Jordan elimination with row pivoting.
    for column in 0..count {
        let pivot = (column..count)
            .max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
            .filter(|&row| rows[row][column].abs() > 1e-13 * scale)?;
        rows.swap(column, pivot);
        let pivot = rows[column];
        for row in (0..count).filter(|&row| row != column) {
            let factor = rows[row][column] / pivot[column];
            for (value, pivot) in rows[row].iter_mut().zip(pivot) {
                *value -= factor * pivot;
            }
        }
    }
    let offset: DVec3 = (0..count).map(|i| v[i] * (rows[i][3] / rows[i][i])).sum();
    let center = origin + offset;
    // The largest of the distances, which differ by rounding alone.
    let squared =
        others.iter().map(|other| other.distance_squared(center)).fold(offset.length_squared(), f64::max);
    squared.is_finite().then_some(Ball { center, squared })
}
