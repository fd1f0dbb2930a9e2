//! The dissertation's test scene: unit cubes with normally distributed centres in one group.

use super::builder::{Builder, Transform};
use super::paint::Paint;
use super::portable;
use super::random::Random;
use super::shape::Shape;
use super::{Sample, SampleOptions};

/// 1,000 cubes at scale 1, standard deviation 5 m per axis; larger scenes are as dense, so they are wider.
pub(super) fn cubes(options: &SampleOptions) -> Sample {
    const PAINTS: [Paint; 5] = [Paint::Steel, Paint::Brass, Paint::Copper, Paint::PipeBlue, Paint::PipeGreen];
    let count = options.count(1000, 1);
    let deviation = 5.0 * portable::cbrt(count as f64 / 1000.0);
    let mut builder = Builder::default();
    let shape = builder.shape(Shape::unit_box("unit cube"));
    let root = builder.group(None, "cubes", Transform::IDENTITY);
    let mut random = Random::stream(options.seed, 0xc0be, 0);
    for k in 0..count {
        let [x, y, z] = [(); 3].map(|()| deviation * random.normal());
        let mesh = builder.mesh(shape, random.pick(&PAINTS));
        builder.object(root, format!("cube {k}"), mesh, Transform::at(x, y, z));
    }
    builder.finish()
}
