// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stroke maps: the layers of gradient magnitude, and where a frame puts strokes in each (thesis 4.2.1).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::style;
use super::marks::{Marks, orientation_color};
use super::{CUT, Easel, STENT};
use crate::command::CommandError;
use crate::painterly::{IsoForm, PainterlyStyle};

const PAPER: [u8; 4] = [236, 230, 217, 255];
/// What paper is mixed with where there is a surface of a layer.
const LAYERS: [[u8; 4]; 3] = [[214, 203, 182, 255], [176, 176, 170, 255], [112, 128, 140, 255]];
/// Length of a mark over that of its stroke.
const SHORTER: f32 = 0.28;

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let about = "Layers of gradient magnitude in style a, and the strokes of a single frame in each: a mark for each stroke, \
                 longer for a longer one, coloured by its orientation.";
    let mut album = Album::new(&studio.out, folder, "Stroke maps by layer".to_owned(), about.to_owned())?;
    for motif in [&CUT, &STENT] {
        let easel = Easel::new(studio, motif)?;
        let style = style("a")?;
        let layers = segmented(studio, &easel, &style)?;
        let pixels = picture(&layers, |layer| LAYERS[layer]);
        let file = |what: &str| format!("{}_{what}.png", motif.transfer);
        album.add_tile(file("layers"), format!("{}: its layers", motif.name), studio.size, &pixels)?;

        let mut painting = easel.painting(style, 1.0)?;
        easel.paint(&mut painting, 0.0, 1.0, true)?;
        let strokes = easel.read(&painting)?.strokes;
        for (layer, name) in PainterlyStyle::LAYERS.into_iter().enumerate() {
            let mut pixels =
                picture(&layers, |of| if of == layer { LAYERS[0] } else { [226, 219, 205, 255] });
            let mut marks = Marks { size: studio.size, pixels: &mut pixels };
            let placed = strokes.iter().filter(|stroke| stroke.layer as usize == layer);
            for stroke in placed.clone() {
                marks.stroke(stroke, SHORTER * stroke.size, 2.2, orientation_color(stroke.orientation));
            }
            let caption = format!("{} {name} strokes", placed.count());
            album.add_tile(file(name), caption, studio.size, &pixels)?;
        }
    }
    album.finish_with_sheet(4, "Layers, and the coarse, medium and fine strokes of a frame")
}

/// The layer of each pixel by the thresholds of a style.
fn segmented(
    studio: &Studio,
    easel: &Easel<'_>,
    style: &PainterlyStyle,
) -> Result<Vec<Option<usize>>, CommandError> {
    let targets = easel.cast(IsoForm::default(), 0.0)?.targets;
    let magnitudes = targets.surface.read(&studio.gpu)?;
    let distances = targets.distance.read(&studio.gpu)?;
    let layer = |(texel, distance): (&[f32], &f32)| {
        let magnitude = texel[3] * style.gradient_scale;
        let layer = style.layers().iter().position(|layer| magnitude < layer.threshold);
        layer.filter(|_| *distance >= 0.0)
    };
    Ok(magnitudes.chunks_exact(4).zip(&distances).map(layer).collect())
}

fn picture(layers: &[Option<usize>], color: impl Fn(usize) -> [u8; 4]) -> Vec<u8> {
    layers.iter().flat_map(|layer| layer.map_or(PAPER, &color)).collect()
}
