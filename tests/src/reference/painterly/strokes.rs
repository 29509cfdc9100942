// SPDX-License-Identifier: MIT OR Apache-2.0
//! Strokes in f64: what a ray caster sees of a ball or plane, where a point of it is seen, densities of quads by testing every
//! one at every texel, and shares that are taken frame by frame.

use crate::linear::{Mat4, Vec3};
use crate::reference::camera::Camera;

/// What is seen of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Where it lies in the space of the object.
    pub point: Vec3,
    /// Unit normal in the world, outwards.
    pub normal: Vec3,
    /// Metres along the view ray.
    pub distance: f64,
}

/// An object that turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A ball of a middle and radius, in its own space.
    Ball(Vec3, f64),
    /// A rectangle around a middle, spanned by two vectors at right angles of its half lengths, in its own space.
    Plane(Vec3, Vec3, Vec3),
}

/// A shape in the world. `world_from_object` turns, moves, and scales evenly.
#[derive(Clone, Copy, Debug)]
pub struct Posed {
    /// The shape.
    pub shape: Shape,
    /// Into the world, metres.
    pub world_from_object: Mat4,
    object_from_world: Mat4,
    scale: f64,
}

fn point(of: [f64; 4]) -> Vec3 {
    Vec3::new(of[0], of[1], of[2])
}

impl Posed {
    /// A shape in a pose.
    ///
    /// # Panics
    /// If the pose has no inverse.
    #[must_use]
    pub fn new(shape: Shape, world_from_object: Mat4) -> Self {
        let object_from_world = world_from_object.inverse().expect("a pose that has an inverse");
        let scale = point(world_from_object.apply_direction(Vec3::new(1.0, 0.0, 0.0))).length();
        Self { shape, world_from_object, object_from_world, scale }
    }

    /// A point of the object in the world.
    #[must_use]
    pub fn to_world(&self, of: Vec3) -> Vec3 {
        point(self.world_from_object.apply_point(of))
    }

    /// What the view ray through a place of the picture meets.
    #[must_use]
    pub fn sight(&self, camera: &Camera, ndc: [f64; 2]) -> Option<Sight> {
        let (origin, direction) = (camera.origin(ndc), camera.ray(ndc));
        let start = point(self.object_from_world.apply_point(origin));
        // Of the length of one over the scale.
        let along = point(self.object_from_world.apply_direction(direction));
        let (distance, outwards) = match self.shape {
            Shape::Ball(middle, radius) => {
                let from = start - middle;
                let (a, b, c) = (along.dot(along), from.dot(along), from.dot(from) - radius * radius);
                let under = b * b - a * c;
                if under < 0.0 {
                    return None;
                }
                let distance = (-b - under.sqrt()) / a;
                (distance, (from + along * distance).normalised())
            }
            Shape::Plane(middle, across, up) => {
                let normal = across.cross(up).normalised();
                let distance = (middle - start).dot(normal) / along.dot(normal);
                let inside = start + along * distance - middle;
                let within = |axis: Vec3| inside.dot(axis).abs() <= axis.dot(axis);
                if !(within(across) && within(up)) {
                    return None;
                }
                (distance, if along.dot(normal) > 0.0 { -normal } else { normal })
            }
        };
        if distance.is_nan() || distance <= 0.0 {
            return None;
        }
        let normal = point(self.world_from_object.apply_direction(outwards)) * self.scale.recip();
        Some(Sight { point: start + along * distance, normal, distance })
    }

    /// Where a point of the object is seen in the picture, (0, 0) top left to (1, 1); none out of it.
    #[must_use]
    pub fn place(&self, camera: &Camera, of: Vec3) -> Option<[f64; 2]> {
        let [x, y, depth] = camera.project(self.to_world(of))?;
        let inside = x.abs() <= 1.0 && y.abs() <= 1.0 && (0.0..=1.0).contains(&depth);
        inside.then_some([0.5 + 0.5 * x, 0.5 - 0.5 * y])
    }

    /// Cosine between the outward normal of a ball at one of its points and the way to the eye: it is seen where this is
    /// positive.
    #[must_use]
    pub fn facing(&self, camera: &Camera, of: Vec3) -> f64 {
        let Shape::Ball(middle, _) = self.shape else { return f64::NAN };
        let world = self.to_world(of);
        let outwards = (world - self.to_world(middle)).normalised();
        let towards =
            if camera.is_orthographic() { -camera.forward } else { (camera.eye - world).normalised() };
        outwards.dot(towards)
    }
}

/// A quad of the picture, pixels and radians from +x downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    /// Its middle.
    pub middle: [f64; 2],
    /// Along its orientation.
    pub length: f64,
    /// Across.
    pub width: f64,
    /// Of its length.
    pub orientation: f64,
}

impl Quad {
    /// Coordinates in it, 0..1 from its beginning along and across; beyond that outside.
    #[must_use]
    pub fn coordinates(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = self.orientation.sin_cos();
        let (dx, dy) = (x - self.middle[0], y - self.middle[1]);
        [(dx * cosine + dy * sine) / self.length + 0.5, (dy * cosine - dx * sine) / self.width + 0.5]
    }

    /// Whether a place is in it, and whether it lies within `margin` pixels of its outline.
    #[must_use]
    pub fn covers(&self, at: [f64; 2], margin: f64) -> (bool, bool) {
        let [along, across] = self.coordinates(at).map(|c| (c - 0.5).abs() - 0.5);
        let out = (along * self.length).max(across * self.width);
        (out < 0.0, out.abs() <= margin)
    }
}

/// Sum of what quads add at a place: none outside of them, else `weight` times the brush at their coordinates; of how many; and
/// whether the place lies within `margin` pixels of an outline, where a rasteriser that rounds corners may put it on either side.
#[must_use]
pub fn density(
    quads: &[(Quad, f64)],
    at: [f64; 2],
    margin: f64,
    brush: impl Fn([f64; 2]) -> f64,
) -> (f64, u32, bool) {
    let (mut sum, mut count, mut doubtful) = (0.0, 0, false);
    for (quad, weight) in quads {
        let (inside, near) = quad.covers(at, margin);
        doubtful |= near;
        if inside {
            sum += weight * brush(quad.coordinates(at));
            count += 1;
        }
    }
    (sum, count, doubtful)
}

/// Shares that are left after frames of a sixtieth of a second, each of which takes `rate` of what is left.
#[must_use]
pub fn left_after(rate: f64, frames: u32) -> f64 {
    (0..frames).fold(1.0, |left, _| left - rate * left)
}

/// The orientation modulo pi in [-pi/2, pi/2), by adding and taking away half turns.
#[must_use]
pub fn half_turn(mut angle: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    while angle >= FRAC_PI_2 {
        angle -= PI;
    }
    while angle < -FRAC_PI_2 {
        angle += PI;
    }
    angle
}

/// Layer 0, 1 or 2 of a gradient magnitude; none above all.
#[must_use]
pub fn layer(magnitude: f64, ends: [f64; 3]) -> Option<usize> {
    ends.iter().position(|end| magnitude < *end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::camera::View;

    #[test]
    fn half_lives_are_those_of_the_equations() {
        for (rate, half, tenth) in
            [(0.05, 13.5, 45.0), (1.0 / 3.0, 1.7, 5.7), (0.9, 0.3, 1.0), (0.1, 6.6, 22.0)]
        {
            let frames = |left: f64| left.ln() / (1.0_f64 - rate).ln();
            assert!((frames(0.5) - half).abs() < 0.05 && (frames(0.1) - tenth).abs() < 0.2);
            assert!((left_after(rate, 9).ln() / 9.0 - (1.0_f64 - rate).ln()).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_seen_is_seen_where_it_is() {
        let camera = Camera::perspective(&View {
            eye: Vec3::new(0.3, 0.4, 4.0),
            target: Vec3::new(0.0, 0.0, 0.0),
            up: Vec3::new(0.0, 1.0, 0.0),
            fov_y: 0.6,
            aspect: 1.5,
            near: 0.1,
            far: 50.0,
            reversed: false,
        });
        let pose = Mat4::from_rows([
            [0.0, 0.0, 2.0, -1.0],
            [0.0, 2.0, 0.0, -1.0],
            [-2.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 1.0],
        ]);
        let middle = Vec3::new(0.5, 0.5, 0.5);
        let plane = Shape::Plane(middle, Vec3::new(0.1, 0.0, 0.3), Vec3::new(0.0, 0.4, 0.0));
        for shape in [Shape::Ball(middle, 0.4), plane] {
            let posed = Posed::new(shape, pose);
            let mut met = 0;
            for i in 0..100 {
                let place = [0.3 + 0.004 * f64::from(i), 0.35 + 0.003 * f64::from(i)];
                let ndc = [2.0 * place[0] - 1.0, 1.0 - 2.0 * place[1]];
                let Some(sight) = posed.sight(&camera, ndc) else { continue };
                met += 1;
                let back = posed.place(&camera, sight.point).expect("in the picture");
                assert!((back[0] - place[0]).abs() + (back[1] - place[1]).abs() < 1e-12);
                assert!((sight.normal.length() - 1.0).abs() < 1e-12);
                assert!(sight.normal.dot(camera.ray(ndc)) < 0.0);
            }
            assert!(met > 30, "{met}");
        }
        let quad = Quad { middle: [3.0, 5.0], length: 4.0, width: 2.0, orientation: 0.5 };
        let tip = [3.0 + 2.0 * 0.5_f64.cos(), 5.0 + 2.0 * 0.5_f64.sin()];
        let found = quad.coordinates(tip);
        assert!((found[0] - 1.0).abs() < 1e-12 && (found[1] - 0.5).abs() < 1e-12);
    }
}
