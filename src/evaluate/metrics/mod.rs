//! How far a picture is from the reference, and what is missing in it.

mod holes;
mod items;
mod planes;
mod psnr;
mod ssim;

pub use holes::{hole_mask, largest_region};
pub use items::{Compared, Seen};
pub use psnr::{MAX_PSNR, Psnr, psnr};
pub use ssim::ssim;

/// Why two pictures cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pictures of {}x{} and {}x{} pixels cannot be compared", a.0, a.1, b.0, b.1)]
pub struct SizeMismatch {
    /// Width and height of the one.
    pub a: (u32, u32),
    /// Width and height of the other.
    pub b: (u32, u32),
}

fn same_size(a: &svs_render::Image, b: &svs_render::Image) -> Result<(), SizeMismatch> {
    let size = |image: &svs_render::Image| (image.width, image.height);
    let whole = |image: &svs_render::Image| {
        image.rgba.len() as u64 == u64::from(image.width) * u64::from(image.height) * 4
    };
    if size(a) == size(b) && whole(a) && whole(b) {
        Ok(())
    } else {
        Err(SizeMismatch { a: size(a), b: size(b) })
    }
}

#[cfg(test)]
mod tests;
