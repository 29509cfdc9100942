// SPDX-License-Identifier: MIT OR Apache-2.0
//! Simple shapes around the origin, with the default albedo.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::mesh::{DEFAULT_ALBEDO, Mesh};

/// A grid of `columns` x `rows` quads whose vertices come from `at`, with parameters in 0..1.
fn grid(columns: u32, rows: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (position, normal) = at(column as f32 / columns as f32, row as f32 / rows as f32);
            mesh.push(position, normal, DEFAULT_ALBEDO);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            mesh.indices.extend_from_slice(&[a, c, b, b, c, d]);
        }
    }
    mesh
}

/// A torus around the y axis: the tube of radius `minor` has its centre on the circle of radius `major`.
/// Segment counts below 3 count as 3.
pub fn torus(major: f32, minor: f32, major_segments: u32, minor_segments: u32) -> Mesh {
    grid(major_segments.max(3), minor_segments.max(3), |u, v| {
        let (around, across) = (u * TAU, -v * TAU);
        let radial = Vec3::new(around.sin(), 0.0, around.cos());
        let normal = radial * across.cos() + Vec3::Y * across.sin();
        (radial * major + normal * minor, normal)
    })
}

/// A horizontal rectangle at y = 0, facing up: `size` is its extent along x and z, with `subdivisions`
/// quads along each side (0 counts as 1).
pub fn plane(size: Vec2, subdivisions: u32) -> Mesh {
    let count = subdivisions.max(1);
    grid(count, count, |u, v| (Vec3::new((u - 0.5) * size.x, 0.0, (v - 0.5) * size.y), Vec3::Y))
}

/// A sphere with poles on the y axis. Segment counts below 3 and ring counts below 2 are raised to those.
pub fn sphere(radius: f32, segments: u32, rings: u32) -> Mesh {
    grid(segments.max(3), rings.max(2), |u, v| {
        let (around, down) = (u * TAU, v * PI);
        let normal = Vec3::new(down.sin() * around.sin(), down.cos(), down.sin() * around.cos());
        (normal * radius, normal)
    })
}

/// A box with the given edge lengths and flat faces.
pub fn cuboid(size: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut normal = Vec3::ZERO;
            normal[axis] = side;
            let mut tangent = Vec3::ZERO;
            tangent[(axis + 1) % 3] = 1.0;
            let across = normal.cross(tangent);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| {
                mesh.push((normal + tangent * u + across * v) * size * 0.5, normal, DEFAULT_ALBEDO)
            });
            let [a, b, c, d] = corners;
            mesh.indices.extend_from_slice(&[a, b, c, a, c, d]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every triangle of positive area faces the way its normals say.
    fn faces_outwards(mesh: &Mesh) -> bool {
        mesh.indices.chunks_exact(3).all(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let normal = t.iter().map(|i| mesh.normals[*i as usize]).sum::<Vec3>();
            (b - a).cross(c - a).dot(normal) >= -1e-6
        })
    }

    #[test]
    fn shapes_are_valid_face_outwards_and_have_their_size() {
        let cases = [
            (torus(1.0, 0.25, 64, 24), Vec3::new(2.5, 0.5, 2.5), 64 * 24 * 2),
            (plane(Vec2::new(4.0, 2.0), 8), Vec3::new(4.0, 0.0, 2.0), 128),
            (sphere(0.5, 64, 32), Vec3::ONE, 64 * 32 * 2),
            (cuboid(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(1.0, 2.0, 3.0), 12),
            (torus(1.0, 0.2, 0, 0), Vec3::new(2.08, 0.35, 1.8), 18),
        ];
        for (mesh, size, triangles) in cases {
            assert_eq!(mesh.validate(), Ok(()));
            assert!(faces_outwards(&mesh));
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
            assert_eq!(mesh.triangle_count(), triangles);
            let found = mesh.bounds().expect("vertices").size();
            assert!((found - size).abs().max_element() < 0.01, "{found} against {size}");
        }
    }
}
