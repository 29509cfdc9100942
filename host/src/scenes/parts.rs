// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pieces of architecture that several scenes are built from.

use crate::data::{DEFAULT_ALBEDO, Mesh, cuboid, plane, sphere};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Albedo of walls and columns.
pub const STONE: Vec3 = Vec3::new(0.46, 0.42, 0.37);

/// A block from its least to its greatest corner.
pub fn block(min: Vec3, max: Vec3, albedo: Vec3) -> Mesh {
    cuboid(max - min).transformed(Mat4::from_translation(0.5 * (min + max))).with_albedo(albedo)
}

/// A floor of tiles in two colours from the least to the greatest x and z, its top at y = 0.
pub fn floor(x_min: f32, x_max: f32, z_min: f32, z_max: f32, tile: f32, colors: [Vec3; 2]) -> Mesh {
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

/// A surface of revolution around the y axis from a profile of radius and height, from the foot up.
fn lathe(profile: &[Vec2], segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for pair in profile.windows(2) {
        // Each stretch has normals of its own, so that mouldings stay sharp.
        let along = (pair[1] - pair[0]).normalize_or_zero();
        let first = mesh.positions.len() as u32;
        for segment in 0..=segments {
            let (sin, cos) = (segment as f32 / segments as f32 * TAU).sin_cos();
            for end in pair {
                let normal = Vec3::new(along.y * sin, -along.x, along.y * cos);
                add(&mut mesh, Vec3::new(end.x * sin, end.y, end.x * cos), normal);
            }
        }
        for segment in 0..segments {
            let a = first + 2 * segment;
            mesh.indices.extend_from_slice(&[a, a + 2, a + 1, a + 1, a + 2, a + 3]);
        }
    }
    mesh
}

fn add(mesh: &mut Mesh, position: Vec3, normal: Vec3) {
    mesh.positions.push(position);
    mesh.normals.push(normal);
    mesh.albedos.push(DEFAULT_ALBEDO);
}

/// A round column with base and capital, its foot in the middle of `at`.
pub fn column(at: Vec3, height: f32, radius: f32, albedo: Vec3) -> Mesh {
    let r = |factor: f32, y: f32| Vec2::new(radius * factor, y);
    let top = height;
    let profile = [
        r(1.45, 0.0),
        r(1.45, 0.10),
        r(1.25, 0.13),
        r(1.3, 0.22),
        r(1.0, 0.30),
        r(0.88, top - 0.42),
        r(1.05, top - 0.38),
        r(1.05, top - 0.32),
        r(1.5, top - 0.12),
        r(1.5, top),
        r(0.0, top),
    ];
    lathe(&profile, 40).transformed(Mat4::from_translation(at)).with_albedo(albedo)
}

/// Height over the sill of a pointed arch, metres, at a place `across` its axis. `half`: half its width; `height`: of its
/// point.
pub fn lancet_height(across: f32, half: f32, height: f32) -> f32 {
    // Two arcs with the width as radius, each around the other's foot.
    let rise = 3f32.sqrt() * half;
    let x = across.abs().min(half);
    height - rise + ((2.0 * half).powi(2) - (x + half).powi(2)).max(0.0).sqrt()
}

/// A pointed opening of a wall.
#[derive(Clone, Copy)]
pub struct Lancet {
    /// Place of its axis along the wall, metres.
    pub centre: f32,
    /// Half its width.
    pub half: f32,
    /// Height of its sill over the foot of the wall.
    pub sill: f32,
    /// Height of its point over the sill.
    pub height: f32,
}

/// A wall in the plane x = 0 from z = `from` to `to` with pointed openings in order, `thick` metres towards -x.
pub fn wall_with_lancets(
    from: f32,
    to: f32,
    height: f32,
    thick: f32,
    lancets: &[Lancet],
    albedo: Vec3,
) -> Mesh {
    const SLICES: u32 = 28;
    let mut mesh = Mesh::default();
    let mut sheet = |z: [f32; 2], low: [f32; 2], high: [f32; 2]| {
        for (x, normal) in [(0.0, Vec3::X), (-thick, Vec3::NEG_X)] {
            let corners = [(z[0], low[0]), (z[1], low[1]), (z[1], high[1]), (z[0], high[0])];
            quad(&mut mesh, corners.map(|(z, y)| Vec3::new(x, y, z)), normal);
        }
    };
    let mut begin = from;
    let mut reveals = Vec::new();
    for lancet in lancets {
        sheet([begin, lancet.centre - lancet.half], [0.0; 2], [height; 2]);
        let at = |slice: u32| {
            let across = lancet.half * (2.0 * slice as f32 / SLICES as f32 - 1.0);
            let top = lancet.sill + lancet_height(across, lancet.half, lancet.height);
            Vec2::new(lancet.centre + across, top)
        };
        for slice in 0..SLICES {
            let (a, b) = (at(slice), at(slice + 1));
            sheet([a.x, b.x], [a.y, b.y], [height; 2]);
            sheet([a.x, b.x], [0.0; 2], [lancet.sill; 2]);
            reveals.push((a, b));
        }
        let (left, right) = (at(0), at(SLICES));
        let (left_foot, right_foot) = (Vec2::new(left.x, lancet.sill), Vec2::new(right.x, lancet.sill));
        reveals.extend([(left_foot, left), (right, right_foot), (right_foot, left_foot)]);
        begin = lancet.centre + lancet.half;
    }
    sheet([begin, to], [0.0; 2], [height; 2]);
    for (a, b) in reveals {
        let along = (b - a).normalize_or_zero();
        let normal = Vec3::new(0.0, -along.x, along.y);
        let corners = [(0.0, a), (0.0, b), (-thick, b), (-thick, a)].map(|(x, at)| Vec3::new(x, at.y, at.x));
        quad(&mut mesh, corners, normal);
    }
    mesh.with_albedo(albedo)
}

fn quad(mesh: &mut Mesh, corners: [Vec3; 4], normal: Vec3) {
    let first = mesh.positions.len() as u32;
    corners.iter().for_each(|corner| add(mesh, *corner, normal));
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
}

/// A round hole near a place on a ball.
pub struct Hole {
    /// The place as seen from the middle of the hole, around and down, radians.
    pub away: Vec2,
    /// Radius of the hole, radians; 0 where there is none.
    pub size: f32,
}

/// A hollow ball around the origin with round holes. `hole`: the one nearest to a place, by its azimuth from +z towards
/// +x and its angle to +y, radians.
pub fn perforated_ball(
    radius: f32,
    segments: u32,
    rings: u32,
    albedo: Vec3,
    hole: impl Fn(f32, f32) -> Hole,
) -> Mesh {
    let mut mesh = sphere(radius, segments, rings).with_albedo(albedo);
    let angles = |point: Vec3| (point.x.atan2(point.z), (point.y / radius).clamp(-1.0, 1.0).acos());
    // Two triangles a cell, row after row; a cell is open where its middle is.
    mesh.indices = mesh
        .indices
        .chunks_exact(6)
        .filter(|corners| {
            let middle: Vec3 = corners.iter().map(|corner| mesh.positions[*corner as usize]).sum();
            let (around, down) = angles(middle.normalize_or_zero() * radius);
            let Hole { away, size } = hole(around, down);
            away.length() >= size
        })
        .flat_map(|corners| corners.to_vec())
        .collect();
    // Corners next to the rim of a hole move onto it.
    let cell = PI / rings as f32;
    for (position, normal) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
        let (around, down) = angles(*position);
        let Hole { away, size } = hole(around, down);
        let distance = away.length();
        if size > 0.0 && (distance - size).abs() < 0.75 * cell {
            let shift = away * (size / distance - 1.0);
            let (around, down) = (around + shift.x / down.sin().max(0.1), down + shift.y);
            *normal = Vec3::new(down.sin() * around.sin(), down.cos(), down.sin() * around.cos());
            *position = *normal * radius;
        }
    }
    mesh
}
