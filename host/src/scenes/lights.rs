// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene for every kind of light, camera and shadow map.

use super::parts::{Lancet, block, column, lancet_height, perforated_ball, wall_with_lancets};
use super::{BUNNY, SUZANNE, Scene, SceneError, placed, standing, view};
use crate::core::{Cascades, DepthRange, OrthographicView, Sky, direction_from_angles};
use crate::data::{
    Bounds, LightImage, Mesh, TerrainParameters, TreeParameters, mesh_from_bytes, plane, terrain,
    terrain_height, torus, tree,
};
use crate::scattering::Medium;
use crate::stage::Lighting;
use glam::{Mat4, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

const STONE: Vec3 = Vec3::new(0.46, 0.42, 0.37);

/// A spot outside a barred window: its beams cross a dark hall to a bunny on a pedestal.
pub fn spot() -> Result<Scene, SceneError> {
    let mut mesh = Mesh::default();
    mesh.append(&floor(-4.0, 4.6, -4.6, 6.0, 0.9, [Vec3::splat(0.30), Vec3::new(0.13, 0.12, 0.115)]));
    let window = Lancet { centre: -1.2, half: 1.15, sill: 1.05, height: 3.1 };
    let wall = wall_with_lancets(-4.6, 6.0, 5.6, 0.45, &[window], Vec3::new(0.42, 0.38, 0.34));
    mesh.append(&wall.transformed(Mat4::from_translation(Vec3::new(-4.0, 0.0, 0.0))));
    // Bars in the middle of the wall.
    let bar = Vec3::splat(0.1);
    let x = [-4.28, -4.2];
    for k in 1..5 {
        let z = window.centre + window.half * (0.4 * k as f32 - 1.0);
        let top = window.sill + lancet_height(z - window.centre, window.half, window.height);
        mesh.append(&block(Vec3::new(x[0], 1.05, z - 0.045), Vec3::new(x[1], top + 0.05, z + 0.045), bar));
    }
    for k in 1..6 {
        let y = window.sill + 0.52 * k as f32;
        let [low, high] = [window.centre - window.half, window.centre + window.half];
        mesh.append(&block(Vec3::new(x[0], y - 0.04, low), Vec3::new(x[1], y + 0.04, high), bar));
    }
    mesh.append(&block(Vec3::new(-4.45, 0.0, -5.0), Vec3::new(4.6, 5.6, -4.6), Vec3::new(0.40, 0.36, 0.33)));
    mesh.append(&block(Vec3::new(-4.45, 5.6, -5.0), Vec3::new(4.6, 5.9, 6.0), Vec3::splat(0.25)));
    for k in 0..4 {
        let z = -3.4 + 2.4 * k as f32;
        mesh.append(&block(
            Vec3::new(-4.0, 5.2, z - 0.15),
            Vec3::new(4.6, 5.6, z + 0.15),
            Vec3::new(0.2, 0.14, 0.09),
        ));
    }
    for x in [-1.6, 1.9] {
        mesh.append(&column(Vec3::new(x, 0.0, -3.6), 5.2, 0.3, STONE));
    }
    mesh.append(&block(Vec3::new(0.35, 0.0, -1.85), Vec3::new(1.35, 0.12, -0.85), STONE));
    mesh.append(&column(Vec3::new(0.85, 0.1, -1.35), 0.85, 0.3, STONE));
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 1.05).with_albedo(Vec3::new(0.74, 0.68, 0.62));
    mesh.append(&placed(bunny, Vec3::new(0.87, 0.93, -1.35), -35.0));
    Ok(Scene {
        name: "spot",
        title: "A spot through a barred window",
        mesh,
        view: view(Vec3::new(2.7, 1.55, 5.2), Vec3::new(-1.25, 1.95, -1.6), 52.0, 0.1, 16.0),
        light: Lighting::Spot {
            position: Vec3::new(-8.6, 5.6, -1.0),
            target: Vec3::new(0.6, 0.85, -1.3),
            outer_degrees: 27.0,
            inner_degrees: 20.0,
            intensity: Vec3::new(1500.0, 1180.0, 760.0),
            radius: 0.1,
        },
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.012, 0.018, 0.032),
            Vec3::new(0.02, 0.026, 0.04),
            Vec3::new(0.01, 0.009, 0.008),
        ),
        medium: Medium::new(0.05, Vec3::splat(0.95), 0.25, 24.0)?,
        exposure: 0.62,
    })
}

/// A pierced lantern between columns: rays to all sides, and dots of light on everything around.
pub fn lamp() -> Result<Scene, SceneError> {
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
    // Diamonds in staggered rows, poles closed.
    let open = |around: u32, down: u32| {
        let (row, in_row) = (down / 6, down % 6);
        let place = (around + 4 * (row % 2)) % 8;
        let from_middle = (place as i32 * 2 - 7).abs() / 2 + (in_row as i32 * 2 - 5).abs() / 2;
        (1..7).contains(&row) && from_middle < 3
    };
    let ball = perforated_ball(0.42, 112, 48, brass, open);
    mesh.append(&ball.transformed(Mat4::from_translation(centre)));
    for (y, radius) in [(0.0, 0.435), (0.40, 0.15), (-0.40, 0.15)] {
        let ring = torus(radius, 0.02, 64, 12).with_albedo(brass);
        mesh.append(&ring.transformed(Mat4::from_translation(centre + Vec3::Y * y)));
    }
    mesh.append(&block(
        centre + Vec3::new(-0.012, 0.4, -0.012),
        centre + Vec3::new(0.012, 3.2, 0.012),
        brass,
    ));
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 0.95).with_albedo(Vec3::new(0.6, 0.45, 0.36));
    mesh.append(&placed(head, Vec3::new(1.15, 0.0, 1.2), -35.0));
    Ok(Scene {
        name: "lamp",
        title: "A pierced lantern",
        mesh,
        view: view(Vec3::new(-1.3, 1.25, 6.2), Vec3::new(0.05, 2.0, -0.6), 48.0, 0.1, 16.0),
        light: Lighting::Point { position: centre, intensity: Vec3::new(62.0, 40.0, 19.0), radius: 0.06 },
        light_texture: None,
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.010, 0.014, 0.028),
            Vec3::new(0.018, 0.02, 0.034),
            Vec3::new(0.012, 0.009, 0.007),
        ),
        medium: Medium::new(0.06, Vec3::splat(0.95), 0.1, 20.0)?,
        exposure: 0.95,
    })
}

/// Low sun through the leaded windows of a nave.
pub fn glass() -> Result<Scene, SceneError> {
    let mut mesh = Mesh::default();
    mesh.append(&floor(-3.6, 3.6, -10.0, 6.0, 0.8, [Vec3::splat(0.42), Vec3::new(0.24, 0.22, 0.21)]));
    let lancets: Vec<Lancet> = (0..5)
        .map(|k| Lancet { centre: -8.2 + 2.9 * k as f32, half: 0.72, sill: 1.5, height: 3.7 })
        .collect();
    let wall = wall_with_lancets(-10.0, 6.0, 7.0, 0.5, &lancets, STONE);
    mesh.append(&wall.transformed(Mat4::from_translation(Vec3::new(-3.6, 0.0, 0.0))));
    mesh.append(&block(Vec3::new(3.6, 0.0, -10.0), Vec3::new(4.0, 7.0, 6.0), STONE));
    mesh.append(&block(Vec3::new(-4.1, 0.0, -10.4), Vec3::new(4.0, 7.0, -10.0), STONE));
    mesh.append(&block(Vec3::new(-4.1, 7.0, -10.4), Vec3::new(4.0, 7.3, 6.0), STONE));
    for k in 0..4 {
        let z = -6.75 + 2.9 * k as f32;
        mesh.append(&column(Vec3::new(2.3, 0.0, z), 5.6, 0.26, STONE));
        mesh.append(&block(Vec3::new(-3.6, 0.0, z - 0.2), Vec3::new(-3.25, 7.0, z + 0.2), STONE));
    }
    mesh.append(&block(Vec3::new(1.9, 5.6, -10.0), Vec3::new(2.7, 6.1, 6.0), STONE));
    for k in 0..5 {
        let z = -8.2 + 2.9 * k as f32;
        mesh.append(&block(
            Vec3::new(-0.2, 0.0, z - 0.25),
            Vec3::new(1.5, 0.45, z + 0.2),
            Vec3::new(0.2, 0.12, 0.07),
        ));
        mesh.append(&block(
            Vec3::new(-0.2, 0.4, z - 0.3),
            Vec3::new(1.5, 0.95, z - 0.22),
            Vec3::new(0.2, 0.12, 0.07),
        ));
    }
    let light = Lighting::directional(direction_from_angles(-78.0, 36.0), Vec3::new(30.0, 28.0, 25.0));
    let texture = leaded_glass(&mesh, &light, -3.85, &lancets);
    Ok(Scene {
        name: "glass",
        title: "Sun through stained glass",
        mesh,
        view: view(Vec3::new(1.1, 1.55, 4.9), Vec3::new(-0.9, 2.35, -3.4), 55.0, 0.1, 18.0),
        light,
        light_texture: Some(texture),
        cascades: None,
        sky: Sky::new(
            Vec3::new(0.035, 0.04, 0.055),
            Vec3::new(0.07, 0.075, 0.09),
            Vec3::new(0.022, 0.02, 0.018),
        ),
        medium: Medium::new(0.055, Vec3::splat(0.96), 0.2, 20.0)?,
        exposure: 0.8,
    })
}

/// What the panes let through, in the light's shadow map: panes in the plane `x`, clear outside the openings.
fn leaded_glass(mesh: &Mesh, light: &Lighting, x: f32, lancets: &[Lancet]) -> LightImage {
    let bounds = mesh.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    // A light that cannot be fitted has no map to colour.
    let Ok(light) = light.fitted(&bounds) else { return LightImage::from_function([1, 1], |_| Vec3::ONE) };
    LightImage::from_function([1536, 1536], |uv| {
        let ndc = Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5);
        let point = light.world_from_clip.project_point3(ndc);
        let at = point + light.direction * ((x - point.x) / light.direction.x);
        lancets
            .iter()
            .enumerate()
            .find(|(_, lancet)| (at.z - lancet.centre).abs() < lancet.half + 0.3)
            .map_or(Vec3::ONE, |(window, lancet)| {
                pane(window, lancet, Vec2::new(at.z - lancet.centre, at.y - lancet.sill))
            })
    })
}

/// Colour of a window at a place across its axis and above its sill, metres.
fn pane(window: usize, lancet: &Lancet, at: Vec2) -> Vec3 {
    const JEWELS: [Vec3; 6] = [
        Vec3::new(0.95, 0.04, 0.03),
        Vec3::new(0.03, 0.10, 0.95),
        Vec3::new(1.0, 0.55, 0.05),
        Vec3::new(0.05, 0.65, 0.18),
        Vec3::new(0.55, 0.06, 0.75),
        Vec3::new(0.08, 0.55, 0.85),
    ];
    const LEAD: f32 = 0.022;
    let jewel = |k: usize| JEWELS[k % JEWELS.len()];
    let edge = lancet.half - at.x.abs();
    let top = lancet_height(at.x, lancet.half, lancet.height) - at.y;
    let border = edge.min(top).min(at.y);
    if (border - 0.13).abs() < LEAD || border < 0.0 {
        return Vec3::ZERO;
    }
    if border < 0.13 {
        let block = (at.y / 0.26).floor();
        let lead = (at.y - block * 0.26).min(block * 0.26 + 0.26 - at.y) < 0.5 * LEAD;
        return if lead { Vec3::ZERO } else { jewel(window + 1 + block as usize % 2) };
    }
    // Medallions up the axis, diamonds around them.
    let cell = 0.92;
    let middle = Vec2::new(0.0, 0.2 + cell * (((at.y - 0.2) / cell).floor() + 0.5));
    let from = at - middle;
    let radius = from.length();
    if (radius - 0.38).abs() < LEAD || (radius - 0.17).abs() < LEAD {
        return Vec3::ZERO;
    }
    if radius < 0.17 {
        return jewel(window + 2);
    }
    if radius < 0.38 {
        let petals = 8.0;
        let around = (from.y.atan2(from.x) / TAU + 0.5) * petals;
        let lead = (around - around.round()).abs() / petals * TAU * radius < 0.5 * LEAD;
        return if lead { Vec3::ZERO } else { jewel(window + around as usize % 2 * 3) };
    }
    let diagonal = Vec2::new(at.x + at.y, at.x - at.y) / 0.3;
    let nearest = (diagonal - diagonal.round()).abs().min_element() * 0.3;
    if nearest < 0.5 * LEAD {
        return Vec3::ZERO;
    }
    let parity = (diagonal.x.floor() + diagonal.y.floor()).rem_euclid(3.0) as usize;
    [jewel(window + 1), jewel(window + 5), Vec3::new(0.75, 0.85, 0.9)][parity]
}

/// A round temple seen from afar without perspective, the sun between its columns.
pub fn orthographic() -> Result<Scene, SceneError> {
    let marble = Vec3::new(0.62, 0.58, 0.52);
    let mut mesh = plane(Vec2::splat(36.0), 4).with_albedo(Vec3::new(0.15, 0.16, 0.13));
    for (k, radius) in [3.9f32, 3.55, 3.2].into_iter().enumerate() {
        // Steps are drums of many sides.
        let top = 0.22 * (k + 1) as f32;
        for side in 0..24 {
            let turn = Quat::from_rotation_y(TAU * side as f32 / 48.0);
            let width = radius * (TAU / 48.0).tan() * 1.01;
            let slab = block(Vec3::new(-width, 0.0, -radius), Vec3::new(width, top, radius), marble);
            mesh.append(&slab.transformed(Mat4::from_quat(turn)));
        }
    }
    let count = 12;
    for k in 0..count {
        let angle = TAU * (k as f32 + 0.5) / count as f32;
        let at = Vec3::new(2.75 * angle.sin(), 0.66, 2.75 * angle.cos());
        mesh.append(&column(at, 3.1, 0.24, marble));
    }
    let cornice = torus(2.75, 0.36, 96, 4).with_albedo(marble);
    mesh.append(&cornice.transformed(Mat4::from_translation(Vec3::Y * 4.0)));
    let head = standing(mesh_from_bytes(SUZANNE.0, SUZANNE.1)?, 1.7).with_albedo(Vec3::new(0.66, 0.30, 0.16));
    mesh.append(&placed(head, Vec3::new(0.0, 0.66, 0.0), 45.0));
    for (x, z, seed) in [(-5.6, -5.2, 3), (6.4, -4.6, 8)] {
        let parameters =
            TreeParameters { seed, leaves: 5000, clumps: 22, height: 5.2, ..TreeParameters::default() };
        mesh.append(&placed(tree(&parameters), Vec3::new(x, -0.05, z), 0.0));
    }
    Ok(Scene {
        name: "orthographic",
        title: "A round temple without perspective",
        mesh,
        view: OrthographicView {
            eye: Vec3::new(9.0, 8.6, 12.0),
            target: Vec3::new(0.0, 1.75, 0.0),
            height: 9.6,
            near: 0.5,
            far: 36.0,
            depth: DepthRange::Forward,
        }
        .into(),
        light: Lighting::directional(direction_from_angles(250.0, 27.0), Vec3::new(10.0, 7.4, 4.6)),
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.05, 0.08, 0.15), Vec3::new(0.12, 0.13, 0.16), Vec3::new(0.03, 0.03, 0.025)),
        medium: Medium::new(0.045, Vec3::splat(0.95), 0.1, 40.0)?,
        exposure: 0.8,
    })
}

/// A wide valley with trees from near to far, one sun, four cascades.
pub fn cascades() -> Result<Scene, SceneError> {
    let parameters = TerrainParameters { seed: 5, size: 220.0, resolution: 512, height: 26.0 };
    let mut mesh = terrain(&parameters);
    let ground = |x, z| terrain_height(&parameters, x, z);
    let eye = Vec2::new(6.0, 62.0);
    let leaves = |seed| TreeParameters { seed, leaves: 2600, clumps: 24, ..TreeParameters::default() };
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
        mesh.append(&placed(planted, Vec3::new(x, ground(x, z) - 0.15, z), 67.0 * k as f32));
    }
    let height = ground(eye.x, eye.y) + 3.2;
    Ok(Scene {
        name: "cascades",
        title: "A valley in four cascades",
        mesh,
        view: view(Vec3::new(eye.x, height, eye.y), Vec3::new(0.0, height + 0.4, 20.0), 50.0, 0.2, 170.0),
        light: Lighting::directional(direction_from_angles(196.0, 15.0), Vec3::new(9.5, 6.0, 3.2)),
        light_texture: None,
        cascades: Some(Cascades::new(4)),
        sky: Sky::new(Vec3::new(0.05, 0.09, 0.18), Vec3::new(0.26, 0.21, 0.18), Vec3::new(0.03, 0.03, 0.03)),
        medium: Medium::new(0.0075, Vec3::splat(0.96), 0.5, 200.0)?,
        exposure: 0.8,
    })
}

/// A floor of tiles in two colours from the least to the greatest x and z, its top at y = 0.
fn floor(x_min: f32, x_max: f32, z_min: f32, z_max: f32, tile: f32, colors: [Vec3; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    let count = |extent: f32| (extent / tile).ceil() as u32;
    for row in 0..count(z_max - z_min) {
        for column in 0..count(x_max - x_min) {
            let corner = Vec3::new(x_min + tile * column as f32, 0.0, z_min + tile * row as f32);
            let size = Vec2::new(tile.min(x_max - corner.x), tile.min(z_max - corner.z));
            let middle = corner + Vec3::new(0.5 * size.x, 0.0, 0.5 * size.y);
            let flat = plane(size, 1).with_albedo(colors[((row + column) % 2) as usize]);
            mesh.append(&flat.transformed(Mat4::from_translation(middle)));
        }
    }
    mesh
}
