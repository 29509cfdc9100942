// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light through windows: a spot outside bars, a slide, stained glass.

use super::parts::{Lancet, STONE, block, column, floor, lancet_height, wall_with_lancets};
use super::{BUNNY, Scene, SceneError, placed, standing, view};
use crate::core::{Sky, direction_from_angles};
use crate::data::{Bounds, LightImage, Mesh, mesh_from_bytes};
use crate::scattering::Medium;
use crate::stage::Lighting;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::TAU;

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
