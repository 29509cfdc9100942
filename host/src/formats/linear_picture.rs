// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that are read as scene-linear light: PNG, OpenEXR and Radiance.

use glam::Vec3;
use image::ImageFormat;
use std::borrow::Cow;
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Why a picture cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("picture {path}: {reason}; a .png (sRGB), .exr or .hdr (linear) picture is needed")]
pub struct PictureError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub reason: String,
}

/// Pixels of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PicturePixels {
    /// Width and height in pixels, positive.
    pub size: [u32; 2],
    /// RGB, not multiplied by alpha, and alpha, which is 1 where there is none; rows from the top. What the file holds, finite or not.
    pub pixels: Vec<[f32; 4]>,
}

impl PicturePixels {
    /// Linear RGB of a picture of light: what is transparent is dark.
    pub fn darkened(&self) -> Vec<Vec3> {
        self.pixels.iter().map(|[r, g, b, alpha]| Vec3::new(*r, *g, *b) * alpha).collect()
    }
}

/// Reads a .png, whose colours are taken as sRGB, or an .exr or .hdr, whose colours are linear, as linear RGB.
///
/// # Errors
/// [`PictureError`].
pub fn read_linear_picture(path: impl AsRef<Path>) -> Result<PicturePixels, PictureError> {
    Ok(linear(read(path.as_ref())?))
}

/// Like [`read_linear_picture`] from the bytes of a file that is part of the program. `name` stands for its path.
///
/// # Errors
/// [`PictureError`].
pub fn linear_picture_from_bytes(name: &str, bytes: &[u8]) -> Result<PicturePixels, PictureError> {
    Ok(linear(decode(Path::new(name), |_| Ok(bytes.into()))?))
}

fn linear((mut picture, encoded): (PicturePixels, bool)) -> PicturePixels {
    if encoded {
        for [r, g, b, _] in &mut picture.pixels {
            [r, g, b].into_iter().for_each(|value| *value = crate::data::linear_from_srgb(*value));
        }
    }
    picture
}

/// Like [`read_linear_picture`] for what is no light, such as weights: numbers as they are, those of a .png over the greatest.
///
/// # Errors
/// [`PictureError`].
pub fn read_picture_values(path: impl AsRef<Path>) -> Result<PicturePixels, PictureError> {
    read(path.as_ref()).map(|(picture, _)| picture)
}

/// The picture of a file, and whether its numbers stand for sRGB.
fn read(path: &Path) -> Result<(PicturePixels, bool), PictureError> {
    decode(path, |path| {
        let bytes = std::fs::read(path).map(Cow::Owned);
        bytes.map_err(|error| match error.kind() {
            ErrorKind::NotFound => "there is no such file".to_owned(),
            _ => error.to_string(),
        })
    })
}

/// The picture of the bytes that a file has, and whether its numbers stand for sRGB. The name says the format.
fn decode<'a>(
    path: &Path,
    bytes: impl FnOnce(&Path) -> Result<Cow<'a, [u8]>, String>,
) -> Result<(PicturePixels, bool), PictureError> {
    let failed = |reason: String| PictureError { path: path.to_owned(), reason };
    let (format, encoded) = match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("png") => (ImageFormat::Png, true),
        Some("exr") => (ImageFormat::OpenExr, false),
        Some("hdr") => (ImageFormat::Hdr, false),
        _ => return Err(failed("its name ends in neither .png nor .exr nor .hdr".to_owned())),
    };
    let bytes = bytes(path).map_err(failed)?;
    // The parsers are not ours; a panic in one is a broken file like any other.
    let picture = catch_unwind(AssertUnwindSafe(|| image::load_from_memory_with_format(&bytes, format)))
        .map_err(|_| failed("its parser gave up".to_owned()))?
        .map_err(|error| failed(error.to_string()))?
        .into_rgba32f();
    let size = [picture.width(), picture.height()];
    if size.contains(&0) {
        return Err(failed("it has no pixels".to_owned()));
    }
    let pixels = picture.pixels().map(|pixel| pixel.0).collect();
    Ok((PicturePixels { size, pixels }, encoded))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_linear_whatever_file_they_come_from() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        crate::formats::write_png(at("a.png"), 2, 1, &[255, 188, 0, 255, 0, 255, 255, 51]).unwrap();
        let png = read_linear_picture(at("a.png")).unwrap();
        assert_eq!(png.size, [2, 1]);
        assert!((png.pixels[0][1] - 0.5029).abs() < 1e-3, "{:?}", png.pixels);
        assert!((png.pixels[1][3] - 0.2).abs() < 1e-6 && png.pixels[1][..3] == [0.0, 1.0, 1.0]);
        let values = read_picture_values(at("a.png")).unwrap();
        assert!((values.pixels[0][1] - 188.0 / 255.0).abs() < 1e-6, "{:?}", values.pixels);
        crate::formats::write_exr(at("a.exr"), 1, 2, &[0.5, -0.25, 7.0, f32::NAN, 1.0, f32::INFINITY])
            .unwrap();
        let exr = read_linear_picture(at("a.exr")).unwrap();
        assert_eq!((exr.size, exr.pixels[0]), ([1, 2], [0.5, -0.25, 7.0, 1.0]));
        assert!(exr.pixels[1][0].is_nan() && exr.pixels[1][2] == f32::INFINITY);
        // One pixel of Radiance's format: (128, 64, 32) / 256 * 2^(130 - 128).
        let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n".to_vec();
        hdr.extend([128, 64, 32, 130]);
        std::fs::write(at("a.hdr"), hdr).unwrap();
        assert_eq!(read_linear_picture(at("a.hdr")).unwrap().pixels, [[2.0, 1.0, 0.5, 1.0]]);
    }

    #[test]
    fn broken_pictures_are_named() {
        let folder = tempfile::tempdir().unwrap();
        for (name, said) in [("a.txt", "neither"), ("b.png", ".png"), ("c.exr", ".exr"), ("a", "neither")] {
            std::fs::write(folder.path().join(name), "no picture").unwrap();
            let error = read_linear_picture(folder.path().join(name)).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains(said), "{error}");
        }
        let error = read_linear_picture(folder.path().join("no.png")).unwrap_err().to_string();
        assert!(error.contains("no.png: there is no such file"), "{error}");
    }
}
