//! Times: several passes over a path, the methods taking turns frame by frame.

use super::bench::{Bench, Flown, Shot};
use super::error::EvaluateError;
use super::figures::median_of;
use super::method::EvaluationMethod;
use super::options::{EvaluateOptions, FrameBudget};
use super::result::{TimeResult, TimeSource};
use crate::bake::Progress;
use svs_render::FrameTime;

/// Frames of the warm-up, spread over the path.
const WARM_UP: usize = 3;

/// Frames that the cost model learns from before the first pass, spread over the path.
const LESSONS: usize = 12;

/// Timestamps may be this much longer than the wall clock: both are read at slightly different moments.
const TOLERANCE: f64 = 1.05;

/// What one frame of one method took and drew.
pub(super) struct Timed {
    pub(super) time: TimeResult,
    pub(super) draws: usize,
    pub(super) draw_calls: usize,
    pub(super) triangles: u64,
    /// What was drawn in the last pass: for methods whose answer depends on the frames before.
    pub(super) objects: Option<Vec<u32>>,
}

/// One pass of one frame.
struct Sample {
    cull_us: f64,
    frame_ms: f64,
    time: FrameTime,
}

/// Draws a few frames with each method, not counted: shaders are compiled, buffers grow, clocks rise. Says which clock
/// to trust.
pub(super) fn warm_up(
    bench: &mut Bench,
    shots: &[Shot],
    options: &EvaluateOptions,
) -> Result<TimeSource, EvaluateError> {
    let mut sound = bench.gpu.adapter.get_info().device_type != svs_render::wgpu::DeviceType::Cpu;
    for shot in spread(shots, WARM_UP) {
        for &method in &options.methods {
            let time = bench.fly(shot, method)?.time;
            // A frame of nothing may take no time at all.
            let is_sound =
                |ms: f64| ms <= time.wall_ms * TOLERANCE && (ms > 0.0 || time.statistics.triangles == 0);
            sound &= time.gpu_ms.is_some_and(is_sound);
        }
    }
    Ok(if sound { TimeSource::GpuTimestamps } else { TimeSource::WallClock })
}

/// Teaches the cost model on some frames: with everything that is visible, and with half of the objects, so that it can
/// tell the cost of a frame from that of its triangles.
pub(super) fn teach(bench: &mut Bench, shots: &[Shot], source: TimeSource) -> Result<(), EvaluateError> {
    for shot in spread(shots, LESSONS) {
        let Flown { cull_us, objects, time } = bench.fly(shot, EvaluationMethod::Visibility)?;
        let half: Vec<u32> = objects.iter().step_by(2).copied().collect();
        let whole = objects.len() as u64;
        learn(bench, whole, cull_us, &time, source);
        let time = bench.time(shot.view, &half)?;
        learn(bench, half.len() as u64, cull_us, &time, source);
    }
    Ok(())
}

fn learn(bench: &mut Bench, objects: u64, cull_us: f64, time: &FrameTime, source: TimeSource) {
    bench.cullers.cost.record(time.statistics.triangles, objects, frame_ms(source, cull_us, time));
}

/// Times all frames with all methods: one list per method, in the order of the options.
pub(super) fn measure(
    bench: &mut Bench,
    shots: &[Shot],
    options: &EvaluateOptions,
    source: TimeSource,
    progress: &dyn Progress,
) -> Result<Vec<Vec<Timed>>, EvaluateError> {
    let methods = &options.methods;
    let learning = matches!(options.budget, Some(FrameBudget::Milliseconds(_)));
    let mut samples: Vec<Vec<Vec<Sample>>> =
        methods.iter().map(|_| shots.iter().map(|_| Vec::with_capacity(options.passes)).collect()).collect();
    let mut lists: Vec<Vec<Option<Vec<u32>>>> = methods.iter().map(|_| vec![None; shots.len()]).collect();
    for pass in 0..options.passes {
        for (frame, shot) in shots.iter().enumerate() {
            for turn in 0..methods.len() {
                // Another one first each time: whoever comes after a long frame has no advantage.
                let place = (turn + frame + pass) % methods.len();
                let method = methods[place];
                let Flown { cull_us, objects, time } = bench.fly(shot, method)?;
                let depends_on_the_past = method.has_memory();
                if depends_on_the_past && pass + 1 == options.passes {
                    lists[place][frame] = Some(objects.to_vec());
                }
                let count = objects.len() as u64;
                if method == EvaluationMethod::Budget && learning {
                    learn(bench, count, cull_us, &time, source);
                }
                samples[place][frame].push(Sample {
                    cull_us,
                    frame_ms: frame_ms(source, cull_us, &time),
                    time,
                });
                progress.advance(1);
            }
        }
    }
    let timed = samples.into_iter().zip(lists).map(|(frames, lists)| {
        frames.into_iter().zip(lists).map(|(samples, objects)| summarize(&samples, objects)).collect()
    });
    Ok(timed.collect())
}

fn frame_ms(source: TimeSource, cull_us: f64, time: &FrameTime) -> f64 {
    let drawing = match (source, time.gpu_ms) {
        (TimeSource::GpuTimestamps, Some(gpu_ms)) => time.cpu_ms + gpu_ms,
        _ => time.wall_ms,
    };
    cull_us * 1e-3 + drawing
}

fn summarize(samples: &[Sample], objects: Option<Vec<u32>>) -> Timed {
    let median = |of: &dyn Fn(&Sample) -> f64| median_of(samples.iter().map(of));
    let gpu: Option<Vec<f64>> = samples.iter().map(|sample| sample.time.gpu_ms).collect();
    let frame_ms = samples.iter().map(|sample| sample.frame_ms);
    let time = TimeResult {
        cull_us: median(&|sample| sample.cull_us),
        frame_ms: median(&|sample| sample.frame_ms),
        frame_ms_least: frame_ms.clone().fold(f64::INFINITY, f64::min),
        frame_ms_most: frame_ms.fold(0.0, f64::max),
        cpu_ms: median(&|sample| sample.time.cpu_ms),
        gpu_ms: gpu.map(median_of),
        wall_ms: median(&|sample| sample.time.wall_ms),
    };
    // The last pass: the pictures are compared with what it drew.
    let statistics = samples.last().map(|sample| sample.time.statistics).unwrap_or_default();
    Timed {
        time,
        draws: statistics.objects,
        draw_calls: statistics.draw_calls,
        triangles: statistics.triangles,
        objects,
    }
}

/// At most `count` of the frames, evenly spread.
fn spread(shots: &[Shot], count: usize) -> impl Iterator<Item = &Shot> {
    let count = count.min(shots.len());
    (0..count).map(move |i| &shots[(2 * i + 1) * shots.len() / (2 * count)])
}
