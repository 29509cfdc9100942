// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random holes (thesis Fig. 6.1, 6.7, 6.9 and 6.12).

use super::super::album::{Album, Section};
use super::super::studio::{Studio, parameters as parameters_of};
use super::{Change, Easel, Tile, tile};
use crate::command::CommandError;
use crate::stylize::{HoleMask, HolePicture, Holes};

/// Holes that make shafts of the canopy's scene.
pub fn canopy_holes() -> Holes {
    Holes { size: 0.32, density: 0.22, octaves: 3, persistence: 0.5, seed: 3, ..Holes::default() }
}

/// A crown before and after, and the maps between.
pub fn holes(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, "canopy", 2048)?;
    let holes = canopy_holes();
    let about = format!(
        "Holes of {} m over {:.0} % of the area, in the shadow of the tree alone. Its leaves hide that they are not there. {}",
        holes.size,
        holes.density * 100.0,
        parameters_of(&easel.scene)
    );
    let mut album = Album::new(&studio.out, folder, "Holes in a crown".to_owned(), about)?;
    let mut rows: [Vec<Tile>; 3] = Default::default();
    for (file, caption, change) in [
        ("before", "As drawn", Change::default()),
        ("after", "With holes in the crown", Change::holes(holes)),
    ] {
        let shadows = easel.shadows(&change)?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        if change.holes.is_some() {
            album.fact("holes, map of 2048x2048", format!("{:.1} ms", easel.time(&shadows)?));
        }
        let scattered = easel.scatter(&inputs)?;
        rows[1].push(tile(&format!("{file}_light"), "Its scattered light", easel.light(scattered)?));
        rows[0].push(tile(file, caption, easel.finish(scattered)?));
        rows[2].push(tile(&format!("{file}_map"), "Shadow map of the whole scene", easel.map(&inputs)?));
    }
    let parameters = easel.holes(&Change::holes(holes))?[0];
    let mut masks = Vec::new();
    for (file, caption, picture) in [
        ("noise", "Noise", HolePicture::Noise),
        ("mask", "Where it is below the threshold", HolePicture::Mask),
    ] {
        let mask = HoleMask::new(&studio.gpu, &studio.shaders, picture, &parameters, [2048, 2048])
            .map_err(CommandError::failure)?;
        let mut encoder = studio.gpu.encoder();
        mask.record(&mut encoder);
        studio.gpu.submit(encoder)?;
        masks.push(tile(file, caption, easel.grey(&mask.mask)?));
    }
    let [pictures, lights, maps] = rows;
    for (file, caption, pixels) in pictures.iter().chain(&lights).chain(&masks).chain(&maps) {
        album.add_tile(file, caption, studio.size, pixels)?;
    }
    album.finish_with_sheet(
        2,
        "Before and after; their light; noise and mask; the shadow map before and after",
    )
}

/// Size by density.
pub fn parameters(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    const SIZES: [f32; 4] = [0.9, 0.45, 0.22, 0.1];
    const DENSITIES: [f32; 4] = [0.04, 0.1, 0.2, 0.35];
    let easel = Easel::new(studio, "canopy", 1024)?;
    let about =
        "Density grows to the right, holes shrink downwards: large ones make few bold shafts, the smallest \
                 average out to a haze."
            .to_owned();
    let mut album = Album::new(&studio.out, folder, "Size and density of holes".to_owned(), about)?;
    for (row, size) in SIZES.into_iter().enumerate() {
        for (column, density) in DENSITIES.into_iter().enumerate() {
            let change = Change::holes(Holes { size, density, ..canopy_holes() });
            let caption = format!("{size} m, {:.0} %", density * 100.0);
            album.add_tile(format!("{row}_{column}.png"), caption, studio.size, &easel.picture(&change)?)?;
        }
    }
    album.finish_with_sheet(4, "0.9 m, 0.45 m, 0.22 m and 0.1 m; 4 %, 10 %, 20 % and 35 % of the area")
}

/// Holes in a head before the sun.
pub fn halo(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let holes = Holes { size: 0.12, density: 0.3, octaves: 2, seed: 5, ..Holes::default() };
    let about = "Holes in the shadow of a head that hides the sun: rays burst around it.";
    before_and_after(studio, folder, "halo", ("A halo", about), holes)
}

/// Holes in a leaping bunny.
pub fn motion(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let holes = Holes { size: 0.17, density: 0.45, octaves: 2, seed: 2, ..Holes::default() };
    let about = "Holes in the shadow that trails behind the bunny: streaks, as comics draw speed.";
    before_and_after(studio, folder, "leap", ("The illusion of motion", about), holes)
}

/// Holes in a pierced lantern, six faces.
pub fn lantern(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let holes = Holes { size: 0.03, density: 0.12, octaves: 2, seed: 2, ..Holes::default() };
    let about = "Holes in the lantern's shadow in all six maps of a point light: finer rays between those of its own holes.";
    before_and_after(studio, folder, "lamp", ("Holes in a lantern", about), holes)
}

fn before_and_after(
    studio: &Studio,
    folder: &str,
    scene: &str,
    (title, about): (&str, &str),
    holes: Holes,
) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, scene, 1024)?;
    let about = format!(
        "{about} {} m, {:.0} % of the area. {}",
        holes.size,
        holes.density * 100.0,
        parameters_of(&easel.scene)
    );
    let mut album = Album::new(&studio.out, folder, title.to_owned(), about)?;
    let mut rows: [Vec<Tile>; 3] = Default::default();
    for (file, caption, change) in
        [("before", "As drawn", Change::default()), ("after", "With holes", Change::holes(holes))]
    {
        let shadows = easel.shadows(&change)?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        if change.holes.is_some() {
            album.fact("holes", format!("{:.1} ms", easel.time(&shadows)?));
        }
        let scattered = easel.scatter(&inputs)?;
        rows[1].push(tile(&format!("{file}_light"), "Its scattered light", easel.light(scattered)?));
        rows[0].push(tile(file, caption, easel.finish(scattered)?));
        if easel.has_one_map() {
            rows[2].push(tile(&format!("{file}_map"), "Its shadow map", easel.map(&inputs)?));
        }
    }
    for (file, caption, pixels) in rows.iter().flatten() {
        album.add_tile(file, caption, studio.size, pixels)?;
    }
    album.finish_with_sheet(2, "Before and after, and their light")
}
