//! What a pass reports.

/// An object to draw, as a pass reports it: its place alone, or with what an estimate of its size needs.
pub(crate) trait Hit: Copy + Default {
    /// Sizes are wanted: what is dropped for its size is added up.
    const MEASURED: bool;
    /// `height` is that of the sphere that answered, above the object; 0 if the frustum alone decided.
    fn new(place: u32, height: u32) -> Self;
    /// Place in tree order.
    fn place(self) -> u32;
}

impl Hit for u32 {
    const MEASURED: bool = false;
    #[inline]
    fn new(place: u32, _: u32) -> Self {
        place
    }
    #[inline]
    fn place(self) -> u32 {
        self
    }
}

/// An object and the height of the sphere that answered for it, 0 without.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) place: u32,
    pub(crate) height: u32,
}

impl Hit for Measured {
    const MEASURED: bool = true;
    #[inline]
    fn new(place: u32, height: u32) -> Self {
        Self { place, height }
    }
    #[inline]
    fn place(self) -> u32 {
        self.place
    }
}

/// A hit that is small enough to be left out, see [`crate::Settings::small_share`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Small {
    /// Which of the hits, from 0.
    pub(crate) at: u32,
    /// Its estimated visible pixels.
    pub(crate) pixels: f32,
}

/// What passes report.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hits<T> {
    pub(crate) list: Vec<T>,
    /// The small ones among them, ascending.
    pub(crate) small: Vec<Small>,
    /// Estimated visible pixels of what was dropped only for its size, if that is measured.
    pub(crate) too_small: f64,
}
