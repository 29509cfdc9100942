// SPDX-License-Identifier: MIT OR Apache-2.0
//! Blur of bent normals themselves and of how they differ from normals: Fig. 3.6 of the thesis.

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::easel::{BENT, Backdrop, Easel};
use crate::ambient::{BentForm, Blurring, Method};
use crate::command::CommandError;
use crate::core::{DepthRange, PerspectiveView};
use crate::data::{Mesh, plane, sphere};
use crate::scenes::AmbientScene;
use glam::{Mat4, Vec2, Vec3};

/// What is compared.
const BLURS: [(Blurring, &str, &str); 3] = [
    (Blurring::Off, "unblurred", "No blur: noise of 8 directions a pixel"),
    (Blurring::Plain, "plain", "Bent normals themselves blurred: bumps are lost"),
    (Blurring::Difference, "difference", "How they differ from normals blurred"),
];

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let scene = AmbientScene {
        name: "boulders",
        mesh: boulders(),
        view: PerspectiveView {
            eye: Vec3::new(0.5, 1.15, 2.6),
            target: Vec3::new(0.05, 0.3, 0.0),
            field_of_view: 36.0,
            near: 0.1,
            far: 40.0,
            depth: DepthRange::Reversed,
        },
        radius: 1.0,
        thickness: 1.0,
    };
    let easel = Easel::new(studio, scene)?;
    let title = "What is blurred".to_owned();
    let about =
        "Boulders whose bumps are in their normals alone, as of a bump map, lit by bent normals.".to_owned();
    let mut album = Album::new(&studio.out, folder, title, about)?;
    let ground = easel.ground()?;
    let backdrop = Backdrop::new(studio, "sunset")?;
    for (blurring, file, name) in BLURS {
        let bent = ground.bent(BentForm { blurring, ..BENT }, &easel.settings())?;
        let found = ground.seen(&bent, Some((&backdrop.cones, Method::Normals, true)))?;
        album.add_tile(format!("{file}.png"), name, studio.size, &easel.lit(&found, &backdrop)?)?;
    }
    album.finish_with_sheet(3, "No blur, plain blur, blur of the difference")
}

/// Three balls on a floor.
fn boulders() -> Mesh {
    let mut mesh = plane(Vec2::splat(6.0), 700).with_albedo(Vec3::new(0.5, 0.48, 0.45));
    for (x, z, radius, albedo) in [
        (-0.55, -0.2, 0.5, Vec3::new(0.62, 0.55, 0.47)),
        (0.5, -0.35, 0.62, Vec3::new(0.55, 0.56, 0.58)),
        (0.12, 0.5, 0.27, Vec3::new(0.66, 0.58, 0.5)),
    ] {
        let place = Mat4::from_translation(Vec3::new(x, 0.92 * radius, z));
        mesh.append(&sphere(radius, 512, 256).transformed(place).with_albedo(albedo));
    }
    for (normal, place) in mesh.normals.iter_mut().zip(&mesh.positions) {
        let slope = slope(*place);
        *normal = (*normal - (slope - *normal * normal.dot(slope))).normalize_or(*normal);
    }
    mesh
}

/// Gradient of bumps a few centimetres wide: two products of waves.
fn slope(place: Vec3) -> Vec3 {
    let wave = |place: Vec3, along: f32| {
        let (s, c) = ((place * along).map(f32::sin), (place * along).map(f32::cos));
        Vec3::new(c.x * s.y * s.z, s.x * c.y * s.z, s.x * s.y * c.z)
    };
    let turn = Mat4::from_rotation_x(0.7) * Mat4::from_rotation_z(0.4);
    let shifted = turn.transform_point3(place) + 0.3;
    0.55 * (turn.inverse().transform_vector3(wave(shifted, 55.0)) + 0.7 * wave(place + 0.4, 90.0))
}
