// SPDX-License-Identifier: MIT OR Apache-2.0
//! Holes filled, and blockers extruded along view rays (thesis Fig. 6.3, 6.4, 6.6, 6.11).

use super::super::album::{Album, Section};
use super::super::studio::{Studio, parameters};
use super::{Change, Easel, Tile, tile};
use crate::command::CommandError;
use crate::stylize::{Element, Form, Operator, ShadowOperator, Width};

/// Closes holes by a box or a disc.
pub fn closing_across(element: Element, texels: f32) -> ShadowOperator {
    ShadowOperator::Across { operator: Operator::Closing, element, width: Width::nearest(texels) }
}

/// Something along view rays.
pub fn along(operator: Operator, texels: f32) -> ShadowOperator {
    ShadowOperator::Along { operator, form: Form::Rectified, width: Width::nearest(texels) }
}

/// Hole filling of a ring and of a crown.
pub fn closing(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let about = "A closing of the shadow map fills holes that its kernel does not fit into, and nothing else. Surfaces \
                 keep the shadows that were drawn.";
    let mut album = Album::new(&studio.out, folder, "Hole filling".to_owned(), about.to_owned())?;
    for (name, map, texels) in [("ring", 1024, [209.0, 209.0]), ("canopy", 1024, [25.0, 41.0])] {
        let easel = Easel::new(studio, name, map)?;
        let operators: [(&str, String, Vec<ShadowOperator>); 4] = [
            ("drawn", easel.scene.title.to_owned(), vec![]),
            ("box", format!("Box of {} texels", texels[0]), vec![closing_across(Element::Box, texels[0])]),
            (
                "epipolar",
                format!("Along view rays, {} texels", texels[1]),
                vec![along(Operator::Closing, texels[1])],
            ),
            ("disc", format!("Disc of {} texels", texels[0]), vec![closing_across(Element::Disc, texels[0])]),
        ];
        let mut rows: [Vec<Tile>; 3] = Default::default();
        for (file, caption, operators) in operators {
            let change = Change { operators: &operators, ..Change::default() };
            let shadows = easel.shadows(&change)?;
            let inputs = shadows.inputs(&easel.stage.inputs());
            let file = format!("{name}_{file}");
            // A disc that fills the ring takes seconds without a GPU.
            if !(operators.is_empty() || name == "ring" && file.ends_with("disc")) {
                let time = easel.time(&shadows)?;
                album.fact(format!("{name}: {caption}, map of {map}x{map}"), format!("{time:.1} ms"));
            }
            let scattered = easel.scatter(&inputs)?;
            rows[1].push(tile(&format!("{file}_light"), "Its scattered light", easel.light(scattered)?));
            rows[0].push(tile(&file, caption, easel.finish(scattered)?));
            rows[2].push(tile(&format!("{file}_map"), "Its shadow map", easel.map(&inputs)?));
        }
        for (file, caption, pixels) in rows.iter().flatten() {
            album.add_tile(file, caption, studio.size, pixels)?;
        }
        album.fact(name, parameters(&easel.scene));
    }
    album.finish_with_sheet(
        4,
        "As drawn; closed by a box, along view rays, by a disc; below their light and shadow maps",
    )
}

/// Silhouette enhancement.
pub fn extrusion(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let easel = Easel::new(studio, "hare", 1024)?;
    let about = format!(
        "Blockers are extruded along view rays, behind what the camera sees: nothing changes but the shadow in the \
         air, which grows deep and sharp. {}",
        parameters(&easel.scene)
    );
    let mut album = Album::new(&studio.out, folder, "Silhouette enhancement".to_owned(), about)?;
    let mut rows: [Vec<Tile>; 3] = Default::default();
    for (file, texels) in [("drawn", 1.0), ("short", 81.0), ("long", 301.0)] {
        let operators = [along(Operator::Dilation, texels)];
        let change = Change { operators: &operators[..usize::from(texels > 1.0)], ..Change::default() };
        let shadows = easel.shadows(&change)?;
        let inputs = shadows.inputs(&easel.stage.inputs());
        let mut caption = "As drawn".to_owned();
        if texels > 1.0 {
            caption = format!("Extruded by {texels} texels");
            let time = easel.time(&shadows)?;
            album.fact(format!("{caption}, map of 1024x1024"), format!("{time:.1} ms"));
        }
        let scattered = easel.scatter(&inputs)?;
        rows[1].push(tile(&format!("{file}_light"), "Its scattered light", easel.light(scattered)?));
        rows[0].push(tile(file, caption, easel.finish(scattered)?));
        rows[2].push(tile(&format!("{file}_map"), "Its shadow map", easel.map(&inputs)?));
    }
    for (file, caption, pixels) in rows.iter().flatten() {
        album.add_tile(file, caption, studio.size, pixels)?;
    }
    album.finish_with_sheet(3, "As drawn, extruded a little, extruded a lot")
}
