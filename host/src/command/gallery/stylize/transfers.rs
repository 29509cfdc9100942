// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions (thesis Fig. 6.13 and 6.14).

use super::super::album::{Album, Section};
use super::super::studio::{Studio, parameters};
use super::occluders::closing_across;
use super::openings::canopy_holes;
use super::styles::{self, ALARM, DUSK, LIFT, UNDERWATER};
use super::{Change, Easel, Tile, plates, tile};
use crate::command::CommandError;
use crate::stylize::{
    Baker, Blend, Color, Constraint, Element, Keyed, Layer, Place, Source, StylizedShadows, Transfer,
};
use glam::Vec3;

/// Light of a change through a function: pixels, with the function in the corner.
fn styled(
    studio: &Studio,
    baker: &Baker,
    easel: &Easel<'_>,
    shadows: &StylizedShadows,
    style: &Keyed<Transfer>,
) -> Result<Vec<u8>, CommandError> {
    let inputs = shadows.inputs(&easel.stage.inputs());
    let scattered = easel.scatter(&inputs)?;
    let map = easel.function(baker, style, 0.0, inputs, scattered)?;
    let restyled = easel.restyled(style, 0.0, &map, &inputs, scattered)?;
    let mut pixels = easel.finish(&restyled)?;
    plates::inset(&mut pixels, easel.size, &plates::function(&studio.gpu, &map)?);
    Ok(pixels)
}

/// Where an artist clicked, shares of the picture's width and height, and the grey wanted there: the more the less of the ray
/// is lit, so that the light comes out as where all of it is.
const PICKS: [([f32; 2], f32); 5] = [
    // Water in the turtle's shadow.
    ([0.56, 0.81], 0.66),
    // The same on the turtle, where its head takes the light, and beside that.
    ([0.45, 0.56], 0.69),
    ([0.56, 0.47], 0.54),
    // What is lit stays as it is: the turtle, and water before the light.
    ([0.50, 0.31], 0.50),
    ([0.31, 0.31], 0.47),
];

/// A dark patch removed.
pub fn patch(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, "turtle", 1024)?;
    let baker = Baker::new(&studio.gpu, &studio.shaders).map_err(CommandError::failure)?;
    let lift = styles::read(LIFT)?;
    let picked = |x: f32, y: f32| {
        let [width, height] = studio.size;
        let at = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
        Place::Pixel([at(x, width), at(y, height)])
    };
    let constraints = PICKS
        .map(|([x, y], grey)| Constraint { place: picked(x, y), color: Color::opaque(Vec3::splat(grey)) });
    let removed = lift.try_map(|transfer| {
        let mut transfer = transfer.clone();
        let source = Source::Diffusion(constraints.to_vec());
        transfer.layers.push(Layer { blend: Blend::Over, ..Layer::new(source) });
        Ok::<_, CommandError>(transfer)
    })?;
    let about = format!(
        "Flippers and head leave gaps in the turtle's shadow, which is a dark patch across its belly and below. Holes are \
         filled; one function lifts the shadow, another takes the patch away, by constraints at picked pixels. {}",
        parameters(&easel.scene)
    );
    let mut album = Album::new(&studio.out, folder, "A dark patch removed".to_owned(), about)?;
    let operators = [closing_across(Element::Disc, 101.0)];
    let closed = Change { operators: &operators, ..Change::default() };
    let [drawn, closed] = [easel.shadows(&Change::default())?, easel.shadows(&closed)?];
    let plain = |shadows: &StylizedShadows| {
        let inputs = shadows.inputs(&easel.stage.inputs());
        easel.finish(easel.scatter(&inputs)?)
    };
    let mut tiles: Vec<Tile> = vec![
        tile("drawn", "As drawn", plain(&drawn)?),
        tile("closed", "Holes filled", plain(&closed)?),
        tile("lifted", "A function that lifts shadows", styled(studio, &baker, &easel, &closed, &lift)?),
        tile(
            "removed",
            "Another that takes the patch away",
            styled(studio, &baker, &easel, &closed, &removed)?,
        ),
        tile("drawn_map", "Shadow map", easel.map(&drawn.inputs(&easel.stage.inputs()))?),
        tile("closed_map", "Shadow map, holes filled", easel.map(&closed.inputs(&easel.stage.inputs()))?),
    ];
    let inputs = closed.inputs(&easel.stage.inputs());
    let scattered = easel.scatter(&inputs)?;
    tiles.push(tile(
        "rays",
        "Amber: lit share of each ray; blue: its length",
        plates::rays(&studio.gpu, &easel, scattered)?,
    ));
    for (file, caption, pixels) in &tiles {
        album.add_tile(file, caption, studio.size, pixels)?;
    }
    album.finish_with_sheet(
        4,
        "As drawn, holes filled, shadows lifted, patch removed; maps, and what the functions read",
    )
}

/// Styles, and scenes that they move across.
const STYLES: [(&str, styles::Style); 3] = [("Alarm", ALARM), ("Dusk", DUSK), ("Underwater", UNDERWATER)];
const SCENES: [&str; 3] = ["foliage", "terrain", "cascades"];

/// Functions that move from scene to scene.
pub fn transfer(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let baker = Baker::new(&studio.gpu, &studio.shaders).map_err(CommandError::failure)?;
    let about = "Three functions, copied from scene to scene as they are. Each scene as it is, what functions read of it \
                 (amber: lit share of each ray; blue: its length), and through each function, which lies in the corner.";
    let mut album =
        Album::new(&studio.out, folder, "One function, three scenes".to_owned(), about.to_owned())?;
    for name in SCENES {
        let easel = Easel::new(studio, name, 4096)?;
        let shadows = easel.shadows(&Change::default())?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        let scattered = easel.scatter(&inputs)?;
        let mut tiles = vec![
            tile(&format!("{name}_physical"), easel.scene.title, easel.finish(scattered)?),
            tile(
                &format!("{name}_rays"),
                "What functions read",
                plates::rays(&studio.gpu, &easel, scattered)?,
            ),
        ];
        for (title, style) in STYLES {
            let file = format!("{name}_{}", title.to_lowercase());
            let style = styles::read(style)?;
            tiles.push(tile(&file, title, styled(studio, &baker, &easel, &shadows, &style)?));
        }
        for (file, caption, pixels) in &tiles {
            album.add_tile(file, caption, studio.size, pixels)?;
        }
    }
    album.finish_with_sheet(5, "Physically based, what functions read, alarm, dusk, underwater")
}

/// Occluders changed and a function applied.
pub fn combined(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let baker = Baker::new(&studio.gpu, &studio.shaders).map_err(CommandError::failure)?;
    let easel = Easel::new(studio, "canopy", 1024)?;
    let about = format!("Shafts simplified by hole filling, then coloured. {}", parameters(&easel.scene));
    let mut album = Album::new(&studio.out, folder, "Hole filling and a function".to_owned(), about)?;
    let operators = [closing_across(Element::Box, 41.0)];
    let holes = Change::holes(canopy_holes());
    let closed = Change { operators: &operators, ..holes };
    let style = styles::read(DUSK)?;
    for (file, caption, change) in [("open", "As it was", holes), ("closed", "Holes filled", closed)] {
        let shadows = easel.shadows(&change)?;
        let scattered = easel.scatter(&shadows.inputs(&easel.stage.inputs()))?;
        album.add_tile(format!("{file}.png"), caption, studio.size, &easel.finish(scattered)?)?;
        let pixels = styled(studio, &baker, &easel, &shadows, &style)?;
        album.add_tile(format!("{file}_styled.png"), format!("{caption}, coloured"), studio.size, &pixels)?;
    }
    album.finish_with_sheet(2, "Above as drawn, below with holes filled; right through a function")
}
