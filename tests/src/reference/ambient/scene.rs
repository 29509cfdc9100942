// SPDX-License-Identifier: MIT OR Apache-2.0
//! Triangles and the rays that meet them.
//!
//! The boxes are those of `obvhs`, in f32 and widened by more than f32 rounds, so that they only choose which triangles a ray
//! is tested against; every test is in f64. Origins may lie ten times as far from the origin of the world as the
//! triangles do.

use crate::linear::Vec3;
use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use obvhs::{BvhBuildParams, faststack::StackStack};

/// How far boxes are widened, of the scene's greatest coordinate: some thirty roundings of f32.
const WIDENING: f64 = 2e-6;
/// Hits nearer than this, of the scene's greatest coordinate, are the surface that the ray begins on.
const NEAREST: f64 = 1e-9;
/// Greatest depth of the tree that is walked.
const DEPTH: usize = 192;

/// A triangle that blocks light from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Corners, world, metres.
    pub positions: [Vec3; 3],
    /// Shading normals of the corners, of any length.
    pub normals: [Vec3; 3],
}

impl Triangle {
    /// A flat triangle, whose normal is on the side from which its corners run counter-clockwise.
    #[must_use]
    pub fn flat(positions: [Vec3; 3]) -> Self {
        let [a, b, c] = positions;
        Self { positions, normals: [(b - a).cross(c - a); 3] }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction.
    pub distance: f64,
    /// Place in the list of triangles.
    pub triangle: usize,
    /// Weights of the corners; their sum is 1.
    pub barycentric: [f64; 3],
}

/// Triangles, ready for rays.
pub struct Scene {
    triangles: Vec<Triangle>,
    /// In the order of the tree's leaves: a corner, the edges to the next and to the last one, place in `triangles`.
    edges: Vec<([Vec3; 3], usize)>,
    tree: Bvh2,
    /// Greatest coordinate, metres.
    extent: f64,
}

impl Scene {
    /// The scene of a list of triangles, which may be empty. Triangles without an area are never met.
    ///
    /// # Panics
    /// If a position is not finite, or the tree is too deep to be walked.
    #[must_use]
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let coordinates = triangles.iter().flat_map(|t| t.positions).flat_map(Vec3::to_array);
        let extent = coordinates.fold(0.0, |most: f64, c| {
            assert!(c.is_finite(), "a corner of a triangle is not finite");
            most.max(c.abs())
        });
        let widening = Vec3A::splat((WIDENING * extent) as f32);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|t| {
                let corners = t.positions.map(single);
                let bounds = Aabb::from_points(&corners);
                Aabb::new(bounds.min - widening, bounds.max + widening)
            })
            .collect();
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut std::time::Duration::default())
        };
        assert!(tree.max_depth <= DEPTH, "a tree of {} levels is too deep", tree.max_depth);
        let edges = tree
            .primitive_indices
            .iter()
            .map(|&i| {
                let [a, b, c] = triangles[i as usize].positions;
                ([a, b - a, c - a], i as usize)
            })
            .collect();
        Self { triangles, edges, tree, extent }
    }

    /// The triangles, in the order that they were given.
    #[must_use]
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Whether a triangle lies along the unit vector `direction` nearer than `max_distance` (metres, may be infinite).
    #[must_use]
    pub fn occluded(&self, origin: Vec3, direction: Vec3, max_distance: f64) -> bool {
        let nearest = NEAREST * self.extent;
        let mut found = false;
        self.walk(origin, direction, max_distance, |edges, _, limit| {
            found = meet(edges, origin, direction).is_some_and(|[t, ..]| t > nearest && t < *limit);
            found
        });
        found
    }

    /// The nearest triangle along a direction.
    #[must_use]
    pub fn hit(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.hit_within(origin, direction, f64::INFINITY)
    }

    /// The nearest triangle along a direction, nearer than `max_distance` (lengths of the direction, may be infinite).
    #[must_use]
    pub fn hit_within(&self, origin: Vec3, direction: Vec3, max_distance: f64) -> Option<Hit> {
        let nearest = NEAREST * self.extent;
        let mut best = None;
        self.walk(origin, direction, max_distance, |edges, triangle, limit| {
            if let Some([distance, u, v]) = meet(edges, origin, direction)
                && distance * direction.length() > nearest
                && distance < *limit
            {
                *limit = distance;
                best = Some(Hit { distance, triangle, barycentric: [1.0 - u - v, u, v] });
            }
            false
        });
        best
    }

    /// The point of a hit, world, metres.
    #[must_use]
    pub fn position(&self, hit: &Hit) -> Vec3 {
        weighted(self.triangles[hit.triangle].positions, hit.barycentric)
    }

    /// Unit shading normal of a hit, on the side that a ray of this direction comes from. Where the corners' normals cancel
    /// it is the triangle's own.
    #[must_use]
    pub fn normal(&self, hit: &Hit, direction: Vec3) -> Vec3 {
        let triangle = &self.triangles[hit.triangle];
        let [a, b, c] = triangle.positions;
        let own = (b - a).cross(c - a);
        let smooth = weighted(triangle.normals, hit.barycentric);
        let chosen = if smooth.length() > 1e-9 { smooth } else { own };
        let facing = if own.dot(direction) > 0.0 { -own } else { own };
        let unit = chosen.normalised();
        if unit.dot(facing) < 0.0 { -unit } else { unit }
    }

    /// Tests triangles along a ray, nearer boxes first, until `test` returns true; it may lower the limit of distance.
    fn walk(
        &self,
        origin: Vec3,
        direction: Vec3,
        max_distance: f64,
        mut test: impl FnMut(&[Vec3; 3], usize, &mut f64) -> bool,
    ) {
        let mut limit = max_distance;
        // Boxes are left out only beyond what f32 rounds of the limit.
        let rounded = |limit: f64| (limit * (1.0 + 1e-6)) as f32;
        let ray = Ray::new(single(origin), single(direction), 0.0, rounded(limit));
        let mut stack = StackStack::<u32, DEPTH>::default();
        self.tree.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), |node, ray, _| {
            let first = node.first_index as usize;
            for (edges, triangle) in &self.edges[first..first + node.prim_count as usize] {
                if test(edges, *triangle, &mut limit) {
                    return false;
                }
            }
            ray.tmax = rounded(limit);
            true
        });
    }
}

fn single(v: Vec3) -> Vec3A {
    Vec3A::from_array(v.to_array().map(|c| c as f32))
}

fn weighted(corners: [Vec3; 3], weights: [f64; 3]) -> Vec3 {
    corners.into_iter().zip(weights).fold(Vec3::default(), |sum, (corner, weight)| sum + corner * weight)
}

/// Distance and weights of the second and third corner where a ray meets a triangle (Möller and Trumbore 1997). Edges belong
/// to the triangle, so that none is missed between two of them.
fn meet([corner, second, third]: &[Vec3; 3], origin: Vec3, direction: Vec3) -> Option<[f64; 3]> {
    const EDGE: f64 = 1e-12;
    let p = direction.cross(*third);
    let determinant = second.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let inverse = determinant.recip();
    let from_corner = origin - *corner;
    let u = from_corner.dot(p) * inverse;
    if !(-EDGE..=1.0 + EDGE).contains(&u) {
        return None;
    }
    let q = from_corner.cross(*second);
    let v = direction.dot(q) * inverse;
    if v < -EDGE || u + v > 1.0 + EDGE {
        return None;
    }
    Some([third.dot(q) * inverse, u, v])
}

#[cfg(test)]
mod tests;
