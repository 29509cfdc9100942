// SPDX-License-Identifier: MIT OR Apache-2.0
//! Visibility at a point over its hemisphere, and its statistics: ambient occlusion, bent normal, bent cone.
//!
//! The thesis prints d of Eq. 3.3 and 3.4 for an occluder and then averages what is free; here V is visibility throughout, as
//! in Listing 3.1.

use super::directions::Pattern;
use super::scene::Scene;
use crate::linear::Vec3;
use std::f64::consts::FRAC_PI_2;

/// How far occluders reach, metres: the distance fall-off f of Eq. 3.4.
///
/// An occluder at the distance r leaves the visibility 1 − f(r), where f is 1 up to `begin`, 0 from `end` on, and between
/// them 1 − s² (3 − 2 s) with s = (r − begin) / (end − begin): visibility rises to 1 with distance, without a step. For
/// `begin` = `end` it is a step, and where both are infinite every occluder counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Up to here occluders block all light, [0, `end`].
    pub begin: f64,
    /// From here on they block none, greater than 0.
    pub end: f64,
}

impl Reach {
    /// Every occluder blocks all light.
    pub const UNLIMITED: Self = Self { begin: f64::INFINITY, end: f64::INFINITY };

    /// f: what an occluder at a distance (metres) takes of the light, [0, 1].
    #[must_use]
    pub fn fall_off(&self, distance: f64) -> f64 {
        if distance >= self.end {
            0.0
        } else if distance <= self.begin {
            1.0
        } else {
            let s = (distance - self.begin) / (self.end - self.begin);
            1.0 - s * s * (3.0 - 2.0 * s)
        }
    }
}

/// A direction and how much comes along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Unit vector away from the surface.
    pub direction: Vec3,
    /// V, [0, 1].
    pub visibility: f64,
}

/// Samples of a visibility over the hemisphere about the unit vector `normal`, even in solid angle (Eq. 3.1).
#[must_use]
pub fn samples(normal: Vec3, pattern: &Pattern, turn: f64, visibility: impl Fn(Vec3) -> f64) -> Vec<Sample> {
    let hemisphere = pattern.cap(normal, FRAC_PI_2, turn);
    hemisphere.map(|(direction, _)| Sample { direction, visibility: visibility(direction) }).collect()
}

/// Samples of what a scene leaves visible at a point of it. Rays do not see what the point lies on; a point that is only
/// near a surface, as from a depth buffer, has to be lifted off it first.
#[must_use]
pub fn trace(
    scene: &Scene,
    point: Vec3,
    normal: Vec3,
    pattern: &Pattern,
    turn: f64,
    reach: Reach,
) -> Vec<Sample> {
    samples(normal, pattern, turn, |direction| {
        if reach.begin >= reach.end {
            f64::from(u8::from(!scene.occluded(point, direction, reach.end)))
        } else {
            let hit = scene.hit_within(point, direction, reach.end);
            hit.map_or(1.0, |hit| 1.0 - reach.fall_off(hit.distance))
        }
    })
}

/// What is kept of the visibility at a point.
///
/// Uniform and cosine-weighted occlusion are not independent of the bent normal: for any visibility
/// `open_cosine` = 2 · `open` · `length` · ⟨`direction`, n⟩, since (1/π) ∫ V ω dω = 2 AO N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// AO of Eq. 2.6 and 3.2: unoccluded share of the hemisphere's solid angle, [0, 1].
    pub open: f64,
    /// (1/π) ∫ V ⟨n, ω⟩ dω: the same share weighted by the cosine, [0, 1].
    pub open_cosine: f64,
    /// Unit vector along the mean unoccluded direction; the normal where nothing is open.
    pub direction: Vec3,
    /// Length R of the mean unoccluded direction N (Eq. 3.5), [0, 1]: 1/2 for an open plane; 0 where nothing is open.
    pub length: f64,
}

impl Statistics {
    /// Of samples that are even in solid angle over the hemisphere about the unit vector `normal`.
    #[must_use]
    pub fn of(normal: Vec3, samples: &[Sample]) -> Self {
        let (mut visible, mut cosine, mut sum) = (0.0, 0.0, Vec3::default());
        for sample in samples {
            visible += sample.visibility;
            cosine += sample.visibility * sample.direction.dot(normal);
            sum = sum + sample.direction * sample.visibility;
        }
        if visible == 0.0 {
            return Self { open: 0.0, open_cosine: 0.0, direction: normal, length: 0.0 };
        }
        let count = samples.len() as f64;
        let mean = sum * visible.recip();
        let length = mean.length();
        Self {
            open: visible / count,
            open_cosine: 2.0 * cosine / count,
            direction: if length > 0.0 { mean.normalised() } else { normal },
            length,
        }
    }

    /// The mean unoccluded direction N of Eq. 3.5.
    #[must_use]
    pub fn bent_normal(&self) -> Vec3 {
        self.direction * self.length
    }

    /// The bent normal that holds the occlusion, (1/π) ∫ V ω dω (Eq. 2.8): of length 1 on an open plane.
    #[must_use]
    pub fn scaled_bent_normal(&self) -> Vec3 {
        self.direction * (2.0 * self.open * self.length)
    }

    /// Half angle of the bent cone, radians, [0, π/2]; 0 where nothing is open.
    #[must_use]
    pub fn angle(&self, kind: Angle) -> f64 {
        match kind {
            _ if self.open == 0.0 => 0.0,
            Angle::Thesis => thesis_angle(self.length),
            Angle::Exact => exact_angle(self.length),
        }
    }
}

/// How the length of the bent normal becomes an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// Eq. 3.6.
    Thesis,
    /// The cap whose mean direction is as long.
    Exact,
}

/// Half angle of the bent cone after Eq. 3.6, radians: linear in the length R, and for a cap too small, (1 − cos a) π/2.
#[must_use]
pub fn thesis_angle(length: f64) -> f64 {
    (1.0 - (2.0 * length - 1.0).clamp(0.0, 1.0)) * FRAC_PI_2
}

/// Half angle of the cap whose mean direction has the length R = (1 + cos a) / 2, radians, at most π/2.
#[must_use]
pub fn exact_angle(length: f64) -> f64 {
    (2.0 * length - 1.0).clamp(0.0, 1.0).acos()
}
