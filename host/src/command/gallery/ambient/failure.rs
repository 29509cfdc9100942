// SPDX-License-Identifier: MIT OR Apache-2.0
//! Occluders that are no horizon, for which one direction cannot stand: Fig. 3.12 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel, error};
use crate::ambient::Method;
use crate::command::CommandError;
use crate::command::ambient::shown::Seen;
use crate::core::{DepthRange, PerspectiveView};
use crate::data::{Mesh, cuboid, plane, sphere};
use crate::scenes::AmbientScene;
use glam::{Mat4, Vec2, Vec3};

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let scene = AmbientScene {
        name: "fence",
        mesh: fence(),
        view: PerspectiveView {
            eye: Vec3::new(1.5, 1.25, 2.9),
            target: Vec3::new(0.1, 0.6, -0.2),
            field_of_view: 32.0,
            near: 0.1,
            far: 60.0,
            depth: DepthRange::Reversed,
        },
        radius: 1.5,
        thickness: 0.15,
    };
    let easel = Easel::new(studio, scene)?;
    let title = "Where a cone cannot follow".to_owned();
    let about = "Behind a fence light comes through slits, and no one direction can stand for them; nor does the screen show what the slats hide. \
                 Bent normals of the screen hardly leave the normal, and the wall is too bright."
        .to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let backdrop = Backdrop::new(studio, "sunset")?;
    let bent = ground.bent(BENT, &easel.settings())?;
    let [truth] = easel.traced([&backdrop.low_passed]);
    let found = ground.seen(&bent, Some((&backdrop.cones, Method::Cones, true)))?;
    let colour = |seen: &Seen| (seen.mean.normalize_or_zero() * 0.5 + 0.5).to_array();
    album.add_tile("cones.png", "Bent cones", studio.size, &easel.lit(&found, &backdrop)?)?;
    album.add_tile("reference.png", "Traced", studio.size, &easel.lit(&truth, &backdrop)?)?;
    album.add_tile("bent.png", "Bent normals of the screen", studio.size, &easel.numbers(&found, colour))?;
    album.add_tile("traced_bent.png", "Traced bent normals", studio.size, &easel.numbers(&truth, colour))?;
    album.fact("bent cones", format!("error {:.4}", error(&found, &truth)));
    album.finish_with_sheet(2, "Bent cones and rays; bent normals of both")
}

/// A fence before a wall, with a ball behind it, on a floor.
fn fence() -> Mesh {
    let mut mesh = plane(Vec2::splat(16.0), 1).with_albedo(Vec3::splat(0.6));
    let wood = Vec3::new(0.62, 0.5, 0.36);
    let mut add = |size: Vec3, at: Vec3, albedo: Vec3| {
        mesh.append(&cuboid(size).transformed(Mat4::from_translation(at)).with_albedo(albedo));
    };
    add(Vec3::new(3.2, 1.5, 0.1), Vec3::new(0.0, 0.75, -0.55), Vec3::splat(0.72));
    for slat in 0..11_u8 {
        let x = 0.28 * (f32::from(slat) - 5.0);
        add(Vec3::new(0.1, 1.2, 0.05), Vec3::new(x, 0.6, 0.0), wood);
    }
    for height in [0.25, 0.95] {
        add(Vec3::new(3.0, 0.09, 0.05), Vec3::new(0.0, height, -0.05), wood);
    }
    let place = Mat4::from_translation(Vec3::new(0.42, 0.22, -0.27));
    mesh.append(&sphere(0.2, 64, 32).transformed(place).with_albedo(Vec3::new(0.75, 0.42, 0.32)));
    mesh
}
