// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene for every kind of light, camera and shadow map.

use super::parts::{Hole, Lancet, block, column, lancet_height, perforated_ball, wall_with_lancets};
use super::{BUNNY, SUZANNE, Scene, SceneError, placed, standing, view};
use crate::core::{Cascades, DepthRange, OrthographicView, Sky, direction_from_angles};
use crate::data::{
    Bounds, LightImage, Mesh, TerrainParameters, TreeParameters, mesh_from_bytes, plane, terrain,
    terrain_height, torus, tree,
};
use crate::scattering::Medium;
use crate::stage::Lighting;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

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
    let stand = Vec3::new(0.5, 0.0, -1.3);
    for (half, low, high) in [(0.52, 0.0, 0.14), (0.40, 0.14, 0.86), (0.48, 0.86, 0.98)] {
        let corner = Vec3::new(half, 0.0, half);
        mesh.append(&block(stand - corner + Vec3::Y * low, stand + corner + Vec3::Y * high, STONE));
    }
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 1.15).with_albedo(Vec3::new(0.74, 0.68, 0.62));
    mesh.append(&placed(bunny, stand + Vec3::Y * 0.96, -40.0));
    Ok(Scene {
        name: "spot",
        title: "A spot through a barred window",
        mesh,
        view: view(Vec3::new(2.3, 1.5, 4.4), Vec3::new(-1.25, 1.75, -1.6), 49.0, 0.1, 16.0),
        light: Lighting::Spot {
            position: Vec3::new(-14.3, 7.6, -0.43),
            target: Vec3::new(0.5, 0.9, -1.3),
            outer_degrees: 13.0,
            inner_degrees: 9.5,
            intensity: Vec3::new(8200.0, 6100.0, 3700.0),
            radius: 0.1,
        },
        light_texture: None,
        cascades: None,
        sky: Sky::new(Vec3::new(0.06, 0.09, 0.15), Vec3::new(0.08, 0.11, 0.16), Vec3::new(0.05, 0.045, 0.04)),
        medium: Medium::new(0.07, Vec3::splat(0.95), 0.2, 24.0)?,
        exposure: 0.62,
    })
}

/// The same hall with a slide in the spot.
pub fn slide() -> Result<Scene, SceneError> {
    Ok(Scene {
        name: "slide",
        title: "A slide in a spot",
        light_texture: Some(rose([1024, 1024])),
        exposure: 0.95,
        ..spot()?
    })
}

/// A rose window: rings of petals in two hues between dark leads.
fn rose(size: [u32; 2]) -> LightImage {
    LightImage::from_function(size, |uv| {
        let at = 2.0 * uv - Vec2::ONE;
        let (radius, turn) = (at.length(), at.y.atan2(at.x) / TAU + 0.5);
        let (ring, petals) = match radius {
            r if r < 0.16 => (0, 1.0),
            r if r < 0.46 => (1, 8.0),
            r if r < 0.76 => (2, 16.0),
            _ => (3, 32.0),
        };
        let across = (turn * petals).fract().min(1.0 - (turn * petals).fract()) / petals * TAU * radius;
        let edges = [0.16, 0.46, 0.76];
        let lead = edges.iter().any(|edge| (radius - edge).abs() < 0.02) || (ring > 0 && across < 0.015);
        let hues = [
            [Vec3::new(1.0, 0.85, 0.4), Vec3::new(1.0, 0.85, 0.4)],
            [Vec3::new(1.0, 0.12, 0.05), Vec3::new(1.0, 0.5, 0.06)],
            [Vec3::new(0.06, 0.25, 1.0), Vec3::new(0.1, 0.75, 0.9)],
            [Vec3::new(0.5, 0.08, 0.9), Vec3::new(0.9, 0.15, 0.5)],
        ];
        if lead { Vec3::ZERO } else { hues[ring][(turn * petals) as usize % 2] }
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
    mesh.append(&ball.transformed(Mat4::from_translation(centre)));
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
    Ok(Scene {
        name: "lamp",
        title: "A pierced lantern",
        mesh,
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
        if k < 3 {
            mesh.append(&column(Vec3::new(2.3, 0.0, z), 5.6, 0.26, STONE));
        }
        mesh.append(&block(Vec3::new(-3.6, 0.0, z - 0.2), Vec3::new(-3.25, 7.0, z + 0.2), STONE));
    }
    mesh.append(&block(Vec3::new(1.9, 5.6, -10.0), Vec3::new(2.7, 6.1, 6.0), STONE));
    let bunny = standing(mesh_from_bytes(BUNNY.0, BUNNY.1)?, 1.0).with_albedo(Vec3::splat(0.72));
    mesh.append(&block(Vec3::new(-0.15, 0.0, -2.5), Vec3::new(0.75, 0.5, -1.6), STONE));
    mesh.append(&placed(bunny, Vec3::new(0.3, 0.48, -2.05), -60.0));
    // A garden wall: what is seen through the windows is air behind the glass, not the open sky.
    mesh.append(&block(Vec3::new(-9.8, -0.3, -18.0), Vec3::new(-9.4, 4.2, 8.0), Vec3::splat(0.2)));
    let light = Lighting::directional(direction_from_angles(-84.0, 37.0), Vec3::new(52.0, 48.0, 44.0));
    let texture = leaded_glass(&mesh, &light, -3.85, &lancets);
    Ok(Scene {
        name: "glass",
        title: "Sun through stained glass",
        mesh,
        view: view(Vec3::new(1.55, 1.6, 4.2), Vec3::new(-0.75, 1.95, -3.4), 56.0, 0.1, 18.0),
        light,
        light_texture: Some(texture),
        cascades: None,
        sky: Sky::new(Vec3::new(0.07, 0.08, 0.11), Vec3::new(0.10, 0.11, 0.14), Vec3::new(0.06, 0.055, 0.05)),
        medium: Medium::new(0.055, Vec3::splat(0.96), 0.2, 20.0)?,
        exposure: 0.8,
    })
}

/// What the panes let through, in the light's shadow map: panes in the plane `x`, and no light beside them.
fn leaded_glass(mesh: &Mesh, light: &Lighting, x: f32, lancets: &[Lancet]) -> LightImage {
    let bounds = mesh.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    // A light that cannot be fitted has no map to colour.
    let Ok(light) = light.fitted(&bounds) else { return LightImage::from_function([1, 1], |_| Vec3::ONE) };
    LightImage::from_function([2048, 2048], |uv| {
        let ndc = Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.5);
        let point = light.world_from_clip.project_point3(ndc);
        let at = point + light.direction * ((x - point.x) / light.direction.x);
        lancets
            .iter()
            .enumerate()
            .find(|(_, lancet)| (at.z - lancet.centre).abs() < lancet.half + 0.3)
            .map_or(Vec3::ZERO, |(window, lancet)| {
                pane(window, lancet, Vec2::new(at.z - lancet.centre, at.y - lancet.sill))
            })
    })
}

/// Colour of a window at a place across its axis and above its sill, metres. Every window has a hue of its own, which
/// keeps the beams apart, and jewels of other hues in it.
fn pane(window: usize, lancet: &Lancet, at: Vec2) -> Vec3 {
    const HUES: [[Vec3; 3]; 5] = [
        [Vec3::new(0.55, 0.05, 0.75), Vec3::new(0.85, 0.10, 0.60), Vec3::new(0.95, 0.55, 0.08)],
        [Vec3::new(0.04, 0.16, 0.95), Vec3::new(0.08, 0.50, 0.95), Vec3::new(0.95, 0.10, 0.06)],
        [Vec3::new(0.04, 0.62, 0.24), Vec3::new(0.25, 0.85, 0.20), Vec3::new(0.95, 0.75, 0.12)],
        [Vec3::new(1.0, 0.50, 0.04), Vec3::new(1.0, 0.74, 0.14), Vec3::new(0.06, 0.20, 0.90)],
        [Vec3::new(0.95, 0.04, 0.03), Vec3::new(1.0, 0.26, 0.05), Vec3::new(0.05, 0.40, 0.90)],
    ];
    const LEAD: f32 = 0.022;
    let [main, light, jewel] = HUES[window % HUES.len()];
    let edge = lancet.half - at.x.abs();
    let top = lancet_height(at.x, lancet.half, lancet.height) - at.y;
    let border = edge.min(top).min(at.y);
    if (border - 0.13).abs() < LEAD || border < 0.0 {
        return Vec3::ZERO;
    }
    if border < 0.13 {
        let block = (at.y / 0.26).floor();
        let lead = (at.y - block * 0.26).min(block * 0.26 + 0.26 - at.y) < 0.5 * LEAD;
        return if lead { Vec3::ZERO } else { [jewel, light][block as usize % 2] };
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
        return jewel;
    }
    if radius < 0.38 {
        let petals = 8.0;
        let around = (from.y.atan2(from.x) / TAU + 0.5) * petals;
        let lead = (around - around.round()).abs() / petals * TAU * radius < 0.5 * LEAD;
        return if lead { Vec3::ZERO } else { [light, main][around as usize % 2] };
    }
    let diagonal = Vec2::new(at.x + at.y, at.x - at.y) / 0.3;
    if (diagonal - diagonal.round()).abs().min_element() * 0.3 < 0.5 * LEAD {
        return Vec3::ZERO;
    }
    let parity = (diagonal.x.floor() + diagonal.y.floor()).rem_euclid(3.0) as usize;
    [main, light, main][parity]
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
