// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which way strokes run: laid over the picture (thesis Fig. 5.2), and three ways compared (Fig. 5.3).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::marks::Marks;
use super::{BRAIN, Easel, Painted};
use crate::command::CommandError;
use crate::painterly::{Orientation, PainterlyStyle, Stroke};
use std::collections::BTreeMap;

/// Pixels between orientations that are laid over a picture.
const CELL: u32 = 24;
/// Degrees of strokes that all run alike.
const FIXED: f32 = -35.0;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, &BRAIN)?;
    let about = "The same surface with strokes at right angles to the gradient, all at one angle, and in the picture at right angles to \
                 the greatest curvature: on gyri along them, and away from the outline. Over the first one the orientation of \
                 strokes, one or so in every square of 24 pixels.";
    let mut album = Album::new(&studio.out, folder, "Which way strokes run".to_owned(), about.to_owned())?;
    let plain = style("a")?;
    let along = easel.still(plain, 1.0)?;
    album.add_tile("overlaid.png", "Orientations of strokes", studio.size, &overlaid(studio.size, &along))?;
    album.add_tile("gradient.png", "At right angles to the gradient", studio.size, &along.pixels)?;
    let fixed = PainterlyStyle { orientation: Orientation::Fixed, angle: FIXED, ..plain };
    album.add_tile("fixed.png", "All at one angle", studio.size, &easel.still(fixed, 1.0)?.pixels)?;
    let ridges = PainterlyStyle { orientation: Orientation::Curvature, angle: 90.0, ..plain };
    let pixels = easel.still(ridges, 1.0)?.pixels;
    album.add_tile("curvature.png", "At right angles to the greatest curvature", studio.size, &pixels)?;
    album.finish_with_sheet(2, "Orientations laid over strokes; by the gradient; at one angle; by curvature")
}

/// A picture with the orientation of the stroke on top in each cell of a grid.
fn overlaid(size: [u32; 2], painted: &Painted) -> Vec<u8> {
    let mut pixels = painted.pixels.clone();
    let mut marks = Marks { size, pixels: &mut pixels };
    let top = on_top(size, &painted.strokes);
    for (width, color) in [(4.2, [38, 24, 22]), (2.0, [255, 250, 236])] {
        for stroke in top.values() {
            marks.stroke(stroke, 0.8 * CELL as f32, width, color);
        }
    }
    pixels
}

/// The last drawn of the opaque strokes that lie in each cell.
fn on_top(size: [u32; 2], strokes: &[Stroke]) -> BTreeMap<(u32, u32), &Stroke> {
    let cell = |position: f32, side: u32| (position * side as f32) as u32 / CELL;
    let opaque = strokes.iter().filter(|stroke| stroke.opacity > 0.5);
    opaque
        .map(|stroke| ((cell(stroke.position.x, size[0]), cell(stroke.position.y, size[1])), stroke))
        .collect()
}
