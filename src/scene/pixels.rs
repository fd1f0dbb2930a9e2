//! PNG and JPEG to texels. Without the feature `bake` there is no decoder in here: browsers bring their own, and put
//! what they have decoded into [`svs_render::SceneData::images`].

use super::alpha_mask::Unreadable;

/// Largest texture that is decoded, in texels: beyond, a tiny file could fill the memory.
#[cfg_attr(not(feature = "bake"), expect(dead_code, reason = "nothing is decoded"))]
pub(crate) const MAX_TEXELS: u64 = 64 << 20;

/// Width, height and rows from the top, four bytes a texel.
pub(crate) type Rgba = (u32, u32, Vec<u8>);

/// Width, height and rows from the top: whether a texel passes an alpha test.
pub(crate) type Passes = (u32, u32, Vec<bool>);

#[cfg(feature = "bake")]
mod decoder {
    use super::{MAX_TEXELS, Passes, Rgba, Unreadable};
    use image::{DynamicImage, ImageReader};
    use std::io::Cursor;

    /// Texels of a PNG or JPEG, if they are not too many.
    pub(crate) fn texels(bytes: &[u8]) -> Result<u64, Unreadable> {
        let (width, height) = reader(bytes)?.into_dimensions().map_err(|_| Unreadable::Data)?;
        let texels = u64::from(width) * u64::from(height);
        if texels > MAX_TEXELS { Err(Unreadable::Size) } else { Ok(texels) }
    }

    fn reader(bytes: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, Unreadable> {
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|_| Unreadable::Data)
    }

    /// Decodes a PNG or JPEG, after a look at its size.
    fn decode(bytes: &[u8]) -> Result<DynamicImage, Unreadable> {
        texels(bytes)?;
        let image = reader(bytes)?.decode().map_err(|_| Unreadable::Data)?;
        if image.width() == 0 || image.height() == 0 { Err(Unreadable::Data) } else { Ok(image) }
    }

    /// A PNG or JPEG as eight bits a channel.
    pub(crate) fn rgba(bytes: &[u8]) -> Result<Rgba, Unreadable> {
        let image = decode(bytes)?.into_rgba8();
        Ok((image.width(), image.height(), image.into_raw()))
    }

    /// Tests `alpha * texel alpha >= cutoff`; `None` for an image without alpha. Alpha is linear whatever the colours are.
    pub(crate) fn alpha_test(bytes: &[u8], alpha: f32, cutoff: f32) -> Result<Option<Passes>, Unreadable> {
        let image = decode(bytes)?;
        if !image.color().has_alpha() {
            return Ok(None);
        }
        let (width, height) = (image.width(), image.height());
        let is_deep = matches!(image, DynamicImage::ImageLumaA16(_) | DynamicImage::ImageRgba16(_));
        let passes = if is_deep {
            let passes = |value: u16| f32::from(value) / 65535.0 * alpha >= cutoff;
            image.into_rgba16().pixels().map(|pixel| passes(pixel.0[3])).collect()
        } else {
            let passes: Vec<bool> =
                (0..=255_u8).map(|value| f32::from(value) / 255.0 * alpha >= cutoff).collect();
            image.into_rgba8().pixels().map(|pixel| passes[usize::from(pixel.0[3])]).collect()
        };
        Ok(Some((width, height, passes)))
    }
}

#[cfg(not(feature = "bake"))]
mod decoder {
    use super::{Passes, Rgba, Unreadable};

    pub(crate) fn texels(_: &[u8]) -> Result<u64, Unreadable> {
        Err(Unreadable::Data)
    }

    pub(crate) fn rgba(_: &[u8]) -> Result<Rgba, Unreadable> {
        Err(Unreadable::Data)
    }

    pub(crate) fn alpha_test(_: &[u8], _: f32, _: f32) -> Result<Option<Passes>, Unreadable> {
        Err(Unreadable::Data)
    }
}

pub(crate) use decoder::{alpha_test, rgba, texels};
