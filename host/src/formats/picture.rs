// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures: PNG for looking, OpenEXR for scene-linear radiance.

use std::io::{self, Cursor};
use std::path::Path;

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::whole::{WriteError, write_whole};

/// Number of channels of `length` values for `width` x `height` pixels, if it is one of `allowed`.
pub(super) fn channels(
    path: &Path,
    width: u32,
    height: u32,
    length: usize,
    allowed: &[u64],
) -> Result<u64, WriteError> {
    let pixels = u64::from(width) * u64::from(height);
    let found = allowed.iter().copied().find(|c| pixels.checked_mul(*c) == Some(length as u64));
    found.filter(|_| pixels > 0).ok_or_else(|| WriteError::Data {
        path: path.to_owned(),
        reason: format!("{length} values do not make a picture of {width}x{height} pixels"),
    })
}

/// Writes an 8-bit PNG, grey, RGB or RGBA as the number of `pixels` tells (1, 3 or 4 bytes a pixel, rows from the top),
/// whole or not at all. The values are taken as sRGB, as PNG has it.
///
/// # Errors
/// [`WriteError`].
pub fn write_png(path: impl AsRef<Path>, width: u32, height: u32, pixels: &[u8]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let color = match channels(path, width, height, pixels.len(), &[1, 3, 4])? {
        1 => ExtendedColorType::L8,
        3 => ExtendedColorType::Rgb8,
        _ => ExtendedColorType::Rgba8,
    };
    write_whole(path, |writer| {
        PngEncoder::new_with_quality(writer, CompressionType::Default, FilterType::Adaptive)
            .write_image(pixels, width, height, color)
            .map_err(io::Error::other)
    })
}

/// Writes an OpenEXR file of 32-bit floats, RGB or RGBA as the number of `pixels` tells (rows from the top), whole or not at all.
///
/// # Errors
/// [`WriteError`].
pub fn write_exr(path: impl AsRef<Path>, width: u32, height: u32, pixels: &[f32]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let color = match channels(path, width, height, pixels.len(), &[3, 4])? {
        3 => ExtendedColorType::Rgb32F,
        _ => ExtendedColorType::Rgba32F,
    };
    let bytes: Vec<u8> = pixels.iter().flat_map(|value| value.to_ne_bytes()).collect();
    // The encoder seeks.
    let mut file = Cursor::new(Vec::new());
    OpenExrEncoder::new(&mut file)
        .write_image(&bytes, width, height, color)
        .map_err(|error| WriteError::File { path: path.to_owned(), source: io::Error::other(error) })?;
    write_whole(path, |writer| writer.write_all(file.get_ref()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let png = folder.path().join("a.png");
        for (count, color) in
            [(1, image::ColorType::L8), (3, image::ColorType::Rgb8), (4, image::ColorType::Rgba8)]
        {
            let pixels: Vec<u8> = (0..3 * 2 * count).map(|i| i * 7).collect();
            write_png(&png, 3, 2, &pixels).expect("written");
            let read = image::open(&png).expect("a picture");
            assert_eq!((read.width(), read.height(), read.color()), (3, 2, color));
            assert_eq!(read.as_bytes(), pixels);
        }
        let exr = folder.path().join("a.exr");
        let pixels: Vec<f32> = (0..18).map(|i| i as f32 * 100.25 - 3.0).collect();
        write_exr(&exr, 3, 2, &pixels).expect("written");
        assert_eq!(image::open(&exr).expect("a picture").to_rgb32f().into_raw(), pixels);
    }

    #[test]
    fn wrong_sizes_are_errors_and_leave_no_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        let error = write_png(&path, 3, 2, &[0; 17]).expect_err("17 values");
        assert!(error.to_string().contains("3x2"), "{error}");
        assert!(write_png(&path, 0, 0, &[]).is_err());
        assert!(write_exr(&path, u32::MAX, u32::MAX, &[0.0]).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
    }
}
