// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lamp, a hall without perspective, a valley in cascades.

use super::parts::{Hole, STONE, block, column, floor, perforated_ball};
use super::{Parts, SUZANNE, Scene, SceneError, placed, standing, view};
use crate::core::{Cascades, DepthRange, OrthographicView, Sky, direction_from_angles};
use crate::data::{
    Mesh, TerrainParameters, TreeParameters, mesh_from_bytes, terrain, terrain_height, torus, tree,
};
use crate::scattering::Medium;
use crate::stage::Lighting;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A pierced lantern between columns: rays to all sides, and dots of light on everything around.
pub fn lamp() -> Result<Parts, SceneError> {
    let mut mesh = Mesh::default();
    mesh.append(&floor(
        -6.0,
        6.0,
        -4.4,
        7.0,
        0.75,
        [Vec3::new(0.36, 0.31, 0.26), Vec3::new(0.17, 0.13, 0.11)],
    ));
    mesh.append(&block(Vec3::new(-6.0, 0.0, -4.8), Vec3::new(6.0, 5.4, -4.4), Vec3::new(0.42, 0.36, 0.31)));
    for x in [-4.1, -1.75, 1.75, 4.1] {
        mesh.append(&column(Vec3::new(x, 0.0, -2.6), 4.6, 0.27, STONE));
    }
    for x in [-3.3, 3.5] {
        mesh.append(&column(Vec3::new(x, 0.0, 0.9), 4.6, 0.27, STONE));
    }
    mesh.append(&block(Vec3::new(-6.0, 4.6, -2.95), Vec3::new(6.0, 5.0, -2.25), STONE));
    let centre = Vec3::new(0.0, 2.35, -0.5);
    let brass = Vec3::new(0.35, 0.22, 0.09);
    // Round holes in staggered rows, fewer towards the poles, which are closed.
    let hole = |around: f32, down: f32| {
        let row = (down / PI * 9.0).floor().clamp(0.0, 8.0);
        let middle = (row + 0.5) / 9.0 * PI;
        let count = (16.0 * middle.sin()).round();
        let place = (around / TAU).rem_euclid(1.0) * count + 0.5 * (row % 2.0);
        let across = (place - place.floor() - 0.5) * TAU / count * middle.sin();
        let size = if row % 2.0 == 0.0 { 0.14 } else { 0.105 };
        let open = (1.0..8.0).contains(&row);
        Hole { away: Vec2::new(across, down - middle), size: if open { size } else { 0.0 } }
    };
    let ball = perforated_ball(0.42, 384, 192, brass, hole);
    let ball = ball.transformed(Mat4::from_translation(centre));
    for (y, radius) in [(0.39, 0.16), (-0.39, 0.16)] {
        let ring = torus(radius, 0.02, 64, 12).with_albedo(brass);
        mesh.append(&ring.transformed(Mat4::from_translation(centre + Vec3::Y * y)));
    }
    mesh.append(&block(
        centre + Vec3::new(-0.012, 0.4, -0.012),
        centre + Vec3::new(0.012, 3.2, 0.012),
        brass,
    ));
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 0.95).with_albedo(Vec3::new(0.6, 0.45, 0.36));
    mesh.append(&placed(head, Vec3::new(1.75, 0.0, 0.5), -75.0));
    let scene = Scene {
        name: "lamp",
        title: "A pierced lantern",
        mesh: Mesh::default(),
        view: view(Vec3::new(-1.3, 1.25, 6.2), Vec3::new(0.05, 2.0, -0.6), 48.0, 0.1, 16.0),
        light: Lighting::Point { position: centre, intensity: Vec3::new(84.0, 52.0, 23.0), radius: 0.06 },
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.035, 0.045, 0.08),
            Vec3::new(0.05, 0.055, 0.085),
            Vec3::new(0.035, 0.028, 0.022),
        ),
        medium: Medium::new(0.06, Vec3::splat(0.95), 0.1, 20.0)?,
        exposure: 0.95,
    };
    Ok(Parts::new(scene, ball, mesh))
}

/// A hall cut open by the near plane, as architects draw a section: light falls through its roof onto a head.
pub fn orthographic() -> Result<Scene, SceneError> {
    let plaster = Vec3::new(0.50, 0.46, 0.41);
    let slate = Vec3::new(0.05, 0.048, 0.05);
    let (half, depth, height) = (8.0, 4.0, 5.6);
    let mut mesh = floor(-half, half, -depth, depth, 0.8, [Vec3::splat(0.34), Vec3::new(0.17, 0.16, 0.155)]);
    for z in [-depth, depth] {
        let (low, high) = if z < 0.0 { (z - 0.4, z) } else { (z, z + 0.4) };
        mesh.append(&block(Vec3::new(-half, 0.0, low), Vec3::new(half, height, high), plaster));
    }
    for x in [-half, half] {
        let (low, high) = if x < 0.0 { (x - 0.4, x) } else { (x, x + 0.4) };
        mesh.append(&block(Vec3::new(low, 0.0, -depth), Vec3::new(high, height, depth), plaster));
    }
    // The roof is strips along x and z that leave square skylights.
    let lights = [-5.2, -2.6, 0.0, 2.6, 5.2];
    let (wide, rows) = (0.62, [-1.9, 0.5]);
    let roof = |x: [f32; 2], z: [f32; 2]| {
        block(Vec3::new(x[0], height, z[0]), Vec3::new(x[1], height + 0.35, z[1]), slate)
    };
    let mut from = -half - 0.4;
    for x in lights {
        mesh.append(&roof([from, x - wide], [-depth - 0.4, depth + 0.4]));
        let mut behind = -depth - 0.4;
        for z in rows {
            mesh.append(&roof([x - wide, x + wide], [behind, z - wide]));
            behind = z + wide;
            // Glazing bars.
            for offset in [-0.2, 0.2] {
                mesh.append(&roof([x + offset - 0.03, x + offset + 0.03], [z - wide, z + wide]));
            }
        }
        mesh.append(&roof([x - wide, x + wide], [behind, depth + 0.4]));
        from = x + wide;
    }
    mesh.append(&roof([from, half + 0.4], [-depth - 0.4, depth + 0.4]));
    for x in [-6.5, -3.9, -1.3, 1.3, 3.9, 6.5] {
        mesh.append(&column(Vec3::new(x, 0.0, -3.2), height, 0.3, plaster));
    }
    let stand = Vec3::new(-0.3, 0.0, -1.0);
    for (half, low, high) in [(0.85, 0.0, 0.2), (0.65, 0.2, 0.9), (0.75, 0.9, 1.05)] {
        let corner = Vec3::new(half, 0.0, half);
        mesh.append(&block(stand - corner + Vec3::Y * low, stand + corner + Vec3::Y * high, plaster));
    }
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 1.5).with_albedo(Vec3::new(0.70, 0.36, 0.20));
    mesh.append(&placed(head, stand + Vec3::Y * 1.03, 20.0));
    Ok(Scene {
        name: "orthographic",
        title: "A hall in section, without perspective",
        mesh,
        view: OrthographicView {
            eye: Vec3::new(3.4, 4.0, 12.0),
            target: Vec3::new(0.0, 2.95, -1.0),
            height: 6.4,
            near: 11.0,
            far: 22.0,
            depth: DepthRange::Forward,
        }
        .into(),
        light: Lighting::directional(direction_from_angles(-112.0, 56.0), Vec3::new(30.0, 22.0, 13.0)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.22, 0.29, 0.40), Vec3::new(0.26, 0.30, 0.38), Vec3::new(0.20, 0.17, 0.15)),
        medium: Medium::new(0.075, Vec3::splat(0.95), 0.0, 40.0)?,
        exposure: 0.9,
    })
}

/// A wide valley with trees from near to far, one sun, four cascades.
pub fn cascades() -> Result<Scene, SceneError> {
    let parameters = TerrainParameters { seed: 5, size: 220.0, resolution: 400, height: 26.0 };
    let mut mesh = terrain(&parameters);
    let ground = |x, z| terrain_height(&parameters, x, z);
    let eye = Vec2::new(6.0, 62.0);
    let leaves = |seed| TreeParameters {
        seed,
        leaves: 5200,
        clumps: 26,
        leaf_length: 0.16,
        ..TreeParameters::default()
    };
    let kinds = [tree(&leaves(2)), tree(&leaves(6)), tree(&leaves(13))];
    for (k, (x, z, scale)) in [
        (1.2, 53.0, 1.0),
        (11.0, 44.0, 1.3),
        (-6.5, 40.0, 1.2),
        (-13.0, 28.0, 1.4),
        (7.0, 24.0, 1.5),
        (20.0, 18.0, 1.6),
        (-22.0, 8.0, 1.7),
        (-4.0, 4.0, 1.8),
        (12.0, -8.0, 1.9),
        (-14.0, -16.0, 2.0),
        (30.0, -14.0, 2.0),
        (2.0, -32.0, 2.2),
    ]
    .into_iter()
    .enumerate()
    {
        let planted = kinds[k % 3].clone().transformed(Mat4::from_scale(Vec3::splat(scale)));
        mesh.append(&placed(planted, Vec3::new(x, ground(x, z) - 0.35 * scale, z), 67.0 * k as f32));
    }
    let height = ground(eye.x, eye.y) + 3.2;
    Ok(Scene {
        name: "cascades",
        title: "A valley in four cascades",
        mesh,
        view: view(Vec3::new(eye.x, height, eye.y), Vec3::new(1.0, height + 1.6, 20.0), 50.0, 0.2, 170.0),
        light: Lighting::directional(direction_from_angles(196.0, 15.0), Vec3::new(9.0, 5.6, 2.9)),
        light_texture: None,
        cascades: Some(Cascades::new(4)),
        sky: Sky::new(Vec3::new(0.05, 0.09, 0.18), Vec3::new(0.26, 0.21, 0.18), Vec3::new(0.03, 0.03, 0.03)),
        medium: Medium::new(0.0055, Vec3::splat(0.96), 0.5, 200.0)?,
        exposure: 0.7,
    })
}
