// SPDX-License-Identifier: MIT OR Apache-2.0
//! Style and brushes.

use super::flags::Options;
use crate::Gpu;
use crate::command::CommandError;
use crate::command::error::{named, one_line};
use crate::painterly::{
    BrushImage, Brushes, PainterlyStyle, STYLES, StrokeError, parse_style, procedural_brushes, read_style,
};
use image::ImageFormat;
use std::path::Path;

/// Most pixels of a brush along a side.
const MOST: u32 = 4096;
/// Of the computed brushes.
const SEED: u64 = 7;

/// What strokes look like.
pub struct Looks {
    /// The style.
    pub style: PainterlyStyle,
    images: Vec<BrushImage>,
}

impl Looks {
    /// Reads them.
    ///
    /// # Errors
    /// Misuse: an unknown name. A failure: a file.
    pub fn new(flags: &Options) -> Result<Self, CommandError> {
        let mut style = style(&flags.style)?;
        if let Some(orientation) = flags.orientation {
            style.orientation = orientation.orientation();
        }
        let images = if flags.brush.is_empty() {
            procedural_brushes(SEED)
        } else {
            let images: Vec<_> = flags.brush.iter().map(|path| brush(path)).collect::<Result<_, _>>()?;
            // A style knows how many computed brushes there are, and not how many of the caller's.
            for layer in [&mut style.coarse, &mut style.medium, &mut style.fine] {
                layer.brush = layer.brush.map(|brush| brush % images.len() as u32);
            }
            images
        };
        Ok(Self { style, images })
    }

    /// Uploads the brushes.
    ///
    /// # Errors
    /// [`StrokeError`].
    pub fn brushes(&self, gpu: &Gpu) -> Result<Brushes, StrokeError> {
        Brushes::new(gpu, &self.images)
    }
}

fn style(path: &Path) -> Result<PainterlyStyle, CommandError> {
    if let Some((name, text)) = STYLES.iter().find(|(name, _)| path.as_os_str() == *name) {
        return Ok(parse_style(name, text)?);
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return read_style(path)
            .map_err(|error| CommandError::failure(format!("--style: {}", named(path, error.to_string()))));
    }
    let known: Vec<_> = STYLES.iter().map(|(name, _)| *name).collect();
    let (path, known) = (path.display(), known.join(", "));
    let problem = format!("`{path}` is unknown: give {known}, or a file that ends in .toml");
    Err(CommandError::misuse("--style", problem))
}

fn brush(path: &Path) -> Result<BrushImage, CommandError> {
    let shown = path.display();
    let failed = |problem: String| CommandError::failure(format!("--brush: {shown}: {problem}"));
    let bytes = std::fs::read(path).map_err(|error| failed(format!("it cannot be read: {error}")))?;
    let image = image::load_from_memory_with_format(&bytes, ImageFormat::Png)
        .map_err(|error| failed(format!("it is no valid PNG: {}; export it again", one_line(error))))?;
    let (width, height) = (image.width(), image.height());
    if width > MOST || height > MOST {
        return Err(failed(format!(
            "{width}x{height} pixels are too many, {MOST} a side are taken: shrink it"
        )));
    }
    BrushImage::from_srgb([width, height], image.into_rgba8().as_raw())
        .map_err(|error| failed(error.to_string()))
}
