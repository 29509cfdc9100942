// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that colour a light, as a slide or a window does.

use glam::{Vec2, Vec3};

/// Why a picture cannot colour a light.
#[derive(Debug, thiserror::Error)]
pub enum LightImageError {
    /// The number of texels is not that of the size.
    #[error("a light texture of {width}x{height} needs {} texels, not {given}", u64::from(*width) * u64::from(*height))]
    Texels {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
        /// Number of texels that were given.
        given: usize,
    },
    /// The file cannot be read.
    #[error("light texture {}: {reason}; a .png (sRGB), .exr or .hdr (linear) picture is needed", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// What a light texture (gobo) lets through: linear RGB, 0..1, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LightImage {
    size: [u32; 2],
    texels: Vec<Vec3>,
}

impl LightImage {
    /// A picture of `size` texels, rows from the top. Values outside 0..1 are clamped; what is not finite is dark.
    ///
    /// # Errors
    /// [`LightImageError::Texels`].
    pub fn new(size: [u32; 2], texels: Vec<Vec3>) -> Result<Self, LightImageError> {
        let [width, height] = size;
        let given = texels.len();
        if given == 0 || u64::from(width) * u64::from(height) != given as u64 {
            return Err(LightImageError::Texels { width, height, given });
        }
        let clean = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let texels = texels.into_iter().map(|texel| Vec3::from(texel.to_array().map(clean))).collect();
        Ok(Self { size, texels })
    }

    /// The picture of a function of the position: x right and y down, both 0..1. Sides of 0 count as 1.
    pub fn from_function(size: [u32; 2], color: impl Fn(Vec2) -> Vec3) -> Self {
        let size = size.map(|side| side.max(1));
        let extent = Vec2::new(size[0] as f32, size[1] as f32);
        let at = |x: u32, y: u32| Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / extent;
        let texels: Vec<Vec3> = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .map(|(x, y)| color(at(x, y)))
            .collect();
        Self::new(size, texels).unwrap_or(Self { size: [1, 1], texels: vec![Vec3::ZERO] })
    }

    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Linear RGB, rows from the top.
    pub fn texels(&self) -> &[Vec3] {
        &self.texels
    }
}

/// Reads a .png, whose values are taken as sRGB, or an .exr or .hdr, whose values are linear. Transparency darkens.
///
/// # Errors
/// [`LightImageError::File`].
#[cfg(feature = "command")]
pub fn load_light_image(path: impl AsRef<std::path::Path>) -> Result<LightImage, LightImageError> {
    let path = path.as_ref();
    let failed = |reason: String| LightImageError::File { path: path.to_owned(), reason };
    let picture = crate::formats::read_linear_picture(path).map_err(|error| failed(error.reason))?;
    let texels = picture.darkened();
    LightImage::new(picture.size, texels).map_err(|error| failed(error.to_string()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn values_are_cleaned_and_sizes_checked() {
        let wild = vec![Vec3::new(-1.0, 0.25, 2.0), Vec3::new(f32::NAN, f32::INFINITY, 1.0)];
        let image = LightImage::new([2, 1], wild.clone()).unwrap();
        assert_eq!(image.texels(), [Vec3::new(0.0, 0.25, 1.0), Vec3::new(0.0, 0.0, 1.0)]);
        for size in [[1, 1], [0, 0], [2, 2]] {
            assert!(LightImage::new(size, wild.clone()).is_err());
        }
        assert!(LightImage::new([0, 4], Vec::new()).is_err());
        let ramp = LightImage::from_function([4, 2], |uv| Vec3::new(uv.x, uv.y, 0.0));
        assert_eq!(ramp.texels()[5], Vec3::new(0.375, 0.75, 0.0));
    }

    #[cfg(feature = "command")]
    #[test]
    fn png_is_decoded_and_exr_is_taken_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let png = folder.path().join("a.png");
        crate::formats::write_png(&png, 2, 1, &[255, 188, 0, 255, 255, 255, 255, 0]).unwrap();
        let image = load_light_image(&png).unwrap();
        assert_eq!(image.size(), [2, 1]);
        assert!((image.texels()[0] - Vec3::new(1.0, 0.5029, 0.0)).length() < 1e-3, "{:?}", image.texels());
        assert_eq!(image.texels()[1], Vec3::ZERO);
        let exr = folder.path().join("a.exr");
        crate::formats::write_exr(&exr, 1, 2, &[0.5, 0.25, 7.0, 0.0, 1.0, 0.125]).unwrap();
        let image = load_light_image(&exr).unwrap();
        assert_eq!(image.texels(), [Vec3::new(0.5, 0.25, 1.0), Vec3::new(0.0, 1.0, 0.125)]);
        let text = folder.path().join("a.txt");
        std::fs::write(&text, "no picture").unwrap();
        std::fs::write(folder.path().join("b.png"), "no picture").unwrap();
        for wrong in ["a.txt", "b.png", "c.png", "a"] {
            let error = load_light_image(folder.path().join(wrong)).unwrap_err().to_string();
            assert!(error.contains(wrong) && error.contains(".png"), "{error}");
        }
    }
}
