// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes under environment maps: models on a floor, and a room that is open to the front and above.

use super::parts::{STONE, block, column, floor};
use super::{BUNNY, SUZANNE, SceneError, perspective, placed, standing};
use crate::core::PerspectiveView;
use crate::data::{Mesh, mesh_from_bytes, teapot};
use glam::Vec3;

/// What is drawn, from where, and how far occluders are looked for on the screen.
#[derive(Clone, Debug)]
pub struct AmbientScene {
    /// Name, as in `--only ambient/NAME`.
    pub name: &'static str,
    /// What is drawn.
    pub mesh: Mesh,
    /// The camera.
    pub view: PerspectiveView,
    /// Metres up to which occluders count.
    pub radius: f32,
    /// Metres that what is seen is taken to be thick.
    pub thickness: f32,
}

/// Colours of tiles.
const TILES: [Vec3; 2] = [Vec3::new(0.62, 0.59, 0.54), Vec3::new(0.5, 0.47, 0.43)];

/// All of them: the bunny, Suzanne, and a room with columns.
///
/// # Errors
/// Where a model of the program cannot be read.
pub fn ambient_scenes() -> Result<[AmbientScene; 3], SceneError> {
    let of_model = |name, file, albedo| -> Result<AmbientScene, SceneError> {
        let mut mesh = floor(-5.0, 5.0, -5.0, 5.0, 1.0, TILES);
        mesh.append(&placed(model(file, 1.4)?, Vec3::ZERO, 17.0).with_albedo(albedo));
        Ok(AmbientScene {
            name,
            mesh,
            view: perspective(Vec3::new(0.4, 1.7, 3.0), Vec3::new(0.0, 0.6, 0.0), 40.0, 0.1, 40.0),
            radius: 4.0,
            thickness: 1.0,
        })
    };
    Ok([
        of_model("bunny", BUNNY, Vec3::new(0.72, 0.66, 0.56))?,
        of_model("suzanne", SUZANNE, Vec3::new(0.66, 0.5, 0.4))?,
        AmbientScene {
            name: "room",
            mesh: room()?,
            view: perspective(Vec3::new(0.9, 3.1, 7.6), Vec3::new(-0.1, 0.9, -1.5), 40.0, 0.1, 40.0),
            radius: 8.0,
            thickness: 8.0,
        },
    ])
}

/// A model of this height on the ground.
fn model((name, bytes): (&str, &[u8]), height: f32) -> Result<Mesh, SceneError> {
    Ok(standing(mesh_from_bytes(name, bytes)?, height))
}

/// Six metres wide with walls of three metres, open to the front and the sky.
fn room() -> Result<Mesh, SceneError> {
    let mut mesh = floor(-3.0, 3.0, -4.0, 3.0, 1.0, TILES);
    let ochre = Vec3::new(0.7, 0.5, 0.3);
    let blue = Vec3::new(0.34, 0.45, 0.6);
    let mut add = |min: [f32; 3], max: [f32; 3], albedo| mesh.append(&block(min.into(), max.into(), albedo));
    add([-3.2, 0.0, -4.0], [-3.0, 3.0, 2.0], ochre);
    add([3.0, 0.0, -4.0], [3.2, 3.0, 2.0], blue);
    add([-3.2, 0.0, -4.2], [3.2, 3.0, -4.0], STONE);
    // A bench along the wall, and a table.
    add([-2.6, 0.0, -3.9], [2.6, 0.5, -3.2], STONE);
    add([-0.8, 0.0, -2.0], [0.8, 0.75, -0.9], STONE);
    for (x, z) in [(-2.1, 0.4), (2.1, 0.4), (-2.1, -2.2), (2.1, -2.2)] {
        mesh.append(&column(Vec3::new(x, 0.0, z), 3.0, 0.24, STONE));
    }
    let white = Vec3::new(0.75, 0.73, 0.68);
    mesh.append(&placed(standing(teapot(), 0.5), Vec3::new(0.0, 0.75, -1.45), 30.0).with_albedo(white));
    mesh.append(&placed(model(BUNNY, 0.8)?, Vec3::new(1.25, 0.0, 0.9), -30.0).with_albedo(white));
    Ok(mesh)
}
