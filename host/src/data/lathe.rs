// SPDX-License-Identifier: MIT OR Apache-2.0
//! Closed bodies with smooth normals: surfaces of revolution, and tubes along a curve.

use super::mesh::{DEFAULT_ALBEDO, Mesh};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Edges of a profile that meet at a sharper angle than this cosine stay sharp.
const CREASE: f32 = 0.7;

/// The body that a profile about the y axis encloses. `profile`: distances from the axis and heights, metres, from the lowest end to the
/// highest with the body on the side of the axis; where it begins or ends away from the axis, a flat lid closes it. Edges of less
/// than 45 degrees are smooth. `segments`: around the axis, at least 3.
pub fn lathe(profile: &[Vec2], segments: u32) -> Mesh {
    let mut outline: Vec<Vec2> = Vec::with_capacity(profile.len() + 2);
    let axis = |point: Vec2| Vec2::new(0.0, point.y);
    if let Some(first) = profile.first().filter(|first| first.x > 0.0) {
        outline.push(axis(*first));
    }
    outline.extend(profile.iter().map(|point| Vec2::new(point.x.max(0.0), point.y)));
    if let Some(last) = profile.last().filter(|last| last.x > 0.0) {
        outline.push(axis(*last));
    }
    outline.dedup();
    let mut mesh = Mesh::default();
    let outwards: Vec<Vec2> =
        outline.windows(2).map(|pair| (pair[0] - pair[1]).perp().normalize_or_zero()).collect();
    let segments = segments.max(3);
    for (index, (pair, own)) in outline.windows(2).zip(&outwards).enumerate() {
        // At a smooth edge both sides share a normal.
        let shared = |other: Option<&Vec2>| {
            other.filter(|other| other.dot(*own) > CREASE).map_or(*own, |other| (*own + *other).normalize())
        };
        let normals = [
            shared(index.checked_sub(1).and_then(|before| outwards.get(before))),
            shared(outwards.get(index + 1)),
        ];
        let first = mesh.positions.len() as u32;
        for step in 0..=segments {
            let (sine, cosine) = (TAU * (step % segments) as f32 / segments as f32).sin_cos();
            let turned = |flat: Vec2| Vec3::new(flat.x * sine, flat.y, flat.x * cosine);
            for (point, normal) in pair.iter().zip(normals) {
                mesh.push(turned(*point), turned(normal), DEFAULT_ALBEDO);
            }
        }
        for step in 0..segments {
            let low = first + 2 * step;
            let [a, b, c, d] = [low, low + 2, low + 1, low + 3];
            if pair[0].x > 0.0 {
                mesh.indices.extend_from_slice(&[a, b, c]);
            }
            if pair[1].x > 0.0 {
                mesh.indices.extend_from_slice(&[b, d, c]);
            }
        }
    }
    mesh
}

/// A smooth profile through `points`: `steps` parts between each two of them, by a Catmull-Rom spline.
pub(super) fn smooth_profile(points: &[Vec2], steps: u32) -> Vec<Vec2> {
    let at = |index: isize| points[index.clamp(0, points.len() as isize - 1) as usize];
    let mut profile = Vec::new();
    for index in 0..points.len().saturating_sub(1) as isize {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|offset| at(index + offset));
        for step in 0..steps {
            let t = step as f32 / steps as f32;
            let tangents = [0.5 * (c - a), 0.5 * (d - b)];
            let (square, cube) = (t * t, t * t * t);
            let point = (2.0 * cube - 3.0 * square + 1.0) * b
                + (cube - 2.0 * square + t) * tangents[0]
                + (3.0 * square - 2.0 * cube) * c
                + (cube - square) * tangents[1];
            profile.push(point.max(Vec2::new(0.0, f32::NEG_INFINITY)));
        }
    }
    profile.extend(points.last());
    profile
}

/// A tube along `path`, places and radii in metres, closed by lids. `segments`: around it, at least 3.
pub fn tube(path: &[(Vec3, f32)], segments: u32) -> Mesh {
    let segments = segments.max(3);
    let mut mesh = Mesh::default();
    let last = path.len().saturating_sub(1);
    let along = |index: usize| {
        let (before, behind) = (index.saturating_sub(1), (index + 1).min(last));
        (path[behind].0 - path[before].0).try_normalize().unwrap_or(Vec3::Y)
    };
    let mut right = Vec3::ZERO;
    for (index, (place, radius)) in path.iter().enumerate() {
        let forward = along(index);
        // The ring turns as little as it can from one place to the next.
        right = (right - forward * right.dot(forward))
            .try_normalize()
            .unwrap_or(forward.any_orthonormal_vector());
        let up = forward.cross(right);
        let lids = [(index == 0).then_some(-forward), (index == last).then_some(forward)];
        let rings = [lids[0], None, lids[1]];
        for (which, lid) in rings.into_iter().enumerate().filter(|(which, lid)| *which == 1 || lid.is_some())
        {
            let first = mesh.positions.len() as u32;
            for step in 0..segments {
                let (sine, cosine) = (TAU * step as f32 / segments as f32).sin_cos();
                let side = right * cosine + up * sine;
                mesh.push(*place + side * *radius, lid.unwrap_or(side), DEFAULT_ALBEDO);
            }
            for step in 0..segments {
                let (a, b) = (first + step, first + (step + 1) % segments);
                match (which, lid) {
                    (0, _) => mesh.indices.extend_from_slice(&[first, b, a]),
                    (2, _) => mesh.indices.extend_from_slice(&[first, a, b]),
                    _ if index < last => {
                        // The next ring of the side follows this one, but for a lid between them.
                        let next = segments;
                        mesh.indices.extend_from_slice(&[a, b, a + next, b, b + next, a + next]);
                    }
                    _ => {}
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::data::Bounds;
    use std::collections::BTreeMap;

    /// Every edge, by place, has as many triangles on one side as on the other; triangles face as their normals do; and the
    /// volume inside, cubic metres.
    pub fn closed(mesh: &Mesh) -> f32 {
        assert_eq!(mesh.validate(), Ok(()));
        let key = |index: u32| (mesh.positions[index as usize] * 1e4).round().to_array().map(|v| v as i64);
        let mut edges: BTreeMap<([i64; 3], [i64; 3]), i32> = BTreeMap::new();
        let mut volume = 0.0;
        for triangle in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            let normals: Vec3 = triangle.iter().map(|i| mesh.normals[*i as usize]).sum();
            // At poles triangles have no area but what rounding gives them.
            let face = (b - a).cross(c - a);
            assert!(face.dot(normals) >= -1e-3 * face.length() - 1e-7, "{a} {b} {c}: {face} {normals}");
            for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (key(triangle[i]), key(triangle[j]))) {
                if from != to {
                    *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
                }
            }
        }
        let open = edges.values().filter(|count| **count != 0).count();
        assert_eq!(open, 0, "of {} edges", edges.len());
        assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-3));
        volume
    }

    #[test]
    fn bodies_are_closed_and_have_their_volume() {
        // A cylinder with a cone on it.
        let profile = [Vec2::new(0.5, 0.0), Vec2::new(0.5, 1.0), Vec2::new(0.0, 2.0)];
        let volume = closed(&lathe(&profile, 96));
        let expected = std::f32::consts::PI * 0.25 * (1.0 + 1.0 / 3.0);
        assert!((volume / expected - 1.0).abs() < 2e-3, "{volume} {expected}");
        // A ball: all its normals leave the middle.
        let half: Vec<Vec2> = (0..=32)
            .map(|i| (TAU * 0.5 * i as f32 / 32.0).sin_cos())
            .map(|(s, c)| Vec2::new(s, -c))
            .collect();
        let ball = lathe(&half, 64);
        assert!((closed(&ball) / (2.0 / 3.0 * TAU) - 1.0).abs() < 0.01);
        for (place, normal) in ball.positions.iter().zip(&ball.normals) {
            assert!(place.normalize().dot(*normal) > 0.995, "{place} {normal}");
        }
        let path: Vec<(Vec3, f32)> = (0..=40)
            .map(|i| TAU * 0.5 * i as f32 / 40.0)
            .map(|angle| (Vec3::new(angle.cos(), angle.sin(), 0.0), 0.1))
            .collect();
        let volume = closed(&tube(&path, 32));
        let expected = std::f32::consts::PI * 0.01 * 0.5 * TAU;
        assert!((volume / expected - 1.0).abs() < 0.02, "{volume} {expected}");
        let bounds = Bounds::of(tube(&path, 32).positions).expect("a tube");
        assert!((bounds.max.y - 1.1).abs() < 1e-3, "{bounds:?}");
        for none in [lathe(&[], 5), tube(&[], 5)] {
            assert!(none.indices.is_empty());
        }
    }

    #[test]
    fn smooth_profiles_pass_through_their_points() {
        let points = [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.2), Vec2::new(0.5, 1.0)];
        let profile = smooth_profile(&points, 4);
        assert_eq!(profile.len(), 9);
        assert!([0, 4, 8].iter().zip(points).all(|(index, point)| profile[*index].distance(point) < 1e-6));
        assert!(smooth_profile(&[], 4).is_empty());
    }
}
