// SPDX-License-Identifier: MIT OR Apache-2.0
//! A motif in every style that comes with Airlight, with close-ups (thesis Fig. 5.5).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::{Easel, Motif};
use crate::command::CommandError;
use crate::painterly::{IsoForm, PainterlyStyle, STYLES};
use image::RgbaImage;
use image::imageops::crop_imm;

/// Side of a picture over that of its close-up.
const CLOSE_UP: u32 = 3;

/// The section.
pub fn section(studio: &Studio, folder: &str, motif: &'static Motif) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, motif)?;
    let about = "The iso-surface as rays see it, the three styles of Table 5.1 and a dense one, after six still frames; below \
                 each a close-up.";
    let mut album = Album::new(&studio.out, folder, format!("{}, painted", motif.name), about.to_owned())?;
    let rays = easel.cast(IsoForm::default(), 0.0)?;
    let mut pictures =
        vec![("surface".to_owned(), "As rays see it".to_owned(), easel.on_canvas(&rays.targets.color)?)];
    for (name, _) in STYLES {
        let painted = easel.still(style(name)?, 1.0)?;
        let count = |layer: u32| painted.strokes.iter().filter(|stroke| stroke.layer == layer).count();
        let counts = PainterlyStyle::LAYERS.iter().zip(0..).map(|(layer, i)| format!("{} {layer}", count(i)));
        album.fact(format!("Strokes in style {name}"), counts.collect::<Vec<_>>().join(", "));
        pictures.push((format!("style_{name}"), format!("Style {name}"), painted.pixels));
    }
    for (file, caption, pixels) in &pictures {
        album.add_tile(format!("{file}.png"), caption, studio.size, pixels)?;
    }
    for (file, caption, pixels) in pictures {
        let (size, pixels) = close_up(studio.size, pixels);
        album.add_tile(format!("{file}_close.png"), format!("{caption}, close"), size, &pixels)?;
    }
    album.finish_with_sheet(1 + STYLES.len() as u32, "As rays see it, styles a, b, c and dense")
}

/// The part of a picture around its middle, pixel by pixel.
fn close_up([width, height]: [u32; 2], pixels: Vec<u8>) -> ([u32; 2], Vec<u8>) {
    let size = [width, height].map(|side| (side / CLOSE_UP).max(1));
    let Some(whole) = RgbaImage::from_raw(width, height, pixels) else { return ([1, 1], vec![0; 4]) };
    let part = crop_imm(&whole, (width - size[0]) / 2, (height - size[1]) / 2, size[0], size[1]);
    (size, part.to_image().into_raw())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_ups_are_of_the_middle() {
        let pixels = (0..9 * 6).flat_map(|pixel| [pixel, 0, 0, 255]).collect();
        let (size, pixels) = close_up([9, 6], pixels);
        assert_eq!((size, pixels.len()), ([3, 2], 24));
        assert_eq!((pixels[0], pixels[20]), (2 * 9 + 3, 3 * 9 + 5));
    }
}
