// SPDX-License-Identifier: MIT OR Apache-2.0
//! Occluders that are no horizon, for which one direction cannot stand: Fig. 3.12 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel, error};
use crate::ambient::Method;
use crate::command::CommandError;
use crate::command::ambient::shown::Seen;
use crate::core::{DepthRange, PerspectiveView};
use crate::data::{Mesh, cuboid, plane};
use crate::scenes::AmbientScene;
use glam::{Mat4, Vec2, Vec3};

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let scene = AmbientScene {
        name: "canopy",
        mesh: canopy(),
        view: PerspectiveView {
            eye: Vec3::new(0.9, 0.78, 5.2),
            target: Vec3::new(0.0, 0.52, 0.0),
            field_of_view: 34.0,
            near: 0.1,
            far: 60.0,
            depth: DepthRange::Reversed,
        },
        radius: 4.0,
        thickness: 4.0,
    };
    let easel = Easel::new(studio, scene)?;
    let title = "Where a cone cannot follow".to_owned();
    let about = "Under a canopy the sky is seen on all sides, not above. The mean of these directions points at the canopy, and the cone \
                 gathers light from what is hidden. Rays find the light of the horizon."
        .to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let backdrops = [Backdrop::new(studio, "sunset")?];
    let bent = ground.bent(BENT, &easel.settings())?;
    let ([truth], [backdrop]) = (easel.traced(&backdrops), &backdrops);
    let found = ground.seen(&bent, Some((&backdrop.cones, Method::Cones, true)))?;
    let colour = |seen: &Seen| (seen.mean.normalize_or_zero() * 0.5 + 0.5).to_array();
    album.add_tile("cones.png", "Bent cones", studio.size, &easel.lit(&found, backdrop)?)?;
    album.add_tile("reference.png", "Traced", studio.size, &easel.lit(&truth, backdrop)?)?;
    album.add_tile("bent.png", "Bent normals of the screen", studio.size, &easel.numbers(&found, colour))?;
    album.add_tile("traced_bent.png", "Traced bent normals", studio.size, &easel.numbers(&truth, colour))?;
    album.fact("bent cones", format!("error {:.4}", error(&found, &truth)));
    album.finish_with_sheet(2, "Bent cones and rays; bent normals of both")
}

/// A slab on four posts over a floor, and a block below.
fn canopy() -> Mesh {
    let mut mesh = plane(Vec2::splat(16.0), 1).with_albedo(Vec3::splat(0.7));
    let mut add = |size: Vec3, at: Vec3, albedo: Vec3| {
        mesh.append(&cuboid(size).transformed(Mat4::from_translation(at)).with_albedo(albedo));
    };
    let white = Vec3::splat(0.72);
    add(Vec3::new(4.4, 0.1, 3.4), Vec3::new(0.0, 1.0, 0.0), white);
    for (x, z) in [(-2.0, -1.5), (2.0, -1.5), (-2.0, 1.5), (2.0, 1.5)] {
        add(Vec3::new(0.09, 0.95, 0.09), Vec3::new(x, 0.475, z), white);
    }
    add(Vec3::new(0.6, 0.35, 0.5), Vec3::new(0.2, 0.175, 0.2), Vec3::new(0.7, 0.55, 0.42));
    mesh
}
