// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights whose shadow buffers hold what they shine on.

use super::SplattingError;
use crate::core::{Light, LightError};
use crate::stage::Lighting;
use glam::dcamera::rh::{proj::directx, view};
use glam::{DMat4, DVec2, DVec3, DVec4, Vec3};

/// What a shadow buffer holds beyond the points, so that filtered reads stay inside.
const ROOM: f64 = 1.02;
/// Half of the widest cone that a point light's buffer spans.
const WIDEST: f64 = 80.0;

/// The light with a matrix that tightly holds `points` in the world, metres: of a directional light a box, of a spot its own cone, of
/// a point light a frustum around all points. Without points a directional light has none, and the others look at the origin.
///
/// # Errors
/// [`SplattingError::LightInside`] for a spot or point light in the box around the points, since light has to meet the first
/// sheet first; [`SplattingError::LightTooNear`] where a point light sees them over more than 160 degrees;
/// [`SplattingError::Light`] for what is impossible by itself.
pub fn light_around(lighting: &Lighting, points: &[Vec3]) -> Result<Light, SplattingError> {
    match *lighting {
        Lighting::Directional { towards, radiance } => {
            Ok(Light::directional_around(towards, radiance, points.iter().copied())?)
        }
        Lighting::Spot { position, target, outer_degrees, inner_degrees, intensity, radius } => {
            check_outside(position, points)?;
            let axis = (target.as_dvec3() - position.as_dvec3()).normalize_or_zero();
            let [near, far] = range(position, axis, points);
            Ok(Light::spot(position, target, outer_degrees, inner_degrees, intensity, radius, near, far)?)
        }
        Lighting::Point { position, intensity, radius } => {
            check_outside(position, points)?;
            let eye = position.as_dvec3();
            let rays: Vec<DVec3> =
                points.iter().map(|point| (point.as_dvec3() - eye).normalize_or_zero()).collect();
            let axis = middle_of(&rays).or((-eye).try_normalize()).unwrap_or(DVec3::NEG_Y);
            let least = rays.iter().map(|ray| ray.dot(axis)).fold(1.0, f64::min);
            if least < WIDEST.to_radians().cos() {
                return Err(SplattingError::LightTooNear(position));
            }
            let [near, far] = range(position, axis, points);
            let mut light = Light::point(position, intensity, radius, near, far)?;
            let up = if axis.y.abs() > 0.999 { DVec3::X } else { DVec3::Y };
            let view = view::look_to_mat4(eye, axis, up);
            let tangents = |ray: &DVec3| {
                let seen = view.transform_vector3(*ray);
                seen.truncate() / -seen.z
            };
            let (low, high) = rays
                .iter()
                .map(tangents)
                .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), at| (l.min(at), h.max(at)));
            let (low, high) = if low.cmple(high).all() { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
            let middle = 0.5 * (low + high);
            let half = (0.5 * ROOM * (high - low)).max(DVec2::splat(1e-4));
            // From tangents -1..1 to those of the points.
            let part = DMat4::from_cols(
                DVec4::new(half.x.recip(), 0.0, 0.0, 0.0),
                DVec4::new(0.0, half.y.recip(), 0.0, 0.0),
                DVec4::Z,
                DVec4::new(-middle.x / half.x, -middle.y / half.y, 0.0, 1.0),
            );
            let whole =
                directx::perspective(0.5 * std::f64::consts::PI, 1.0, f64::from(near), f64::from(far));
            let clip_from_world = part * whole * view;
            light.clip_from_world = clip_from_world.as_mat4();
            light.world_from_clip = clip_from_world.inverse().as_mat4();
            light.direction = (-axis).as_vec3();
            Ok(light)
        }
    }
}

fn check_outside(position: Vec3, points: &[Vec3]) -> Result<(), SplattingError> {
    if points.iter().any(|point| !point.is_finite()) {
        return Err(LightError::Points.into());
    }
    let (low, high) = points
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), point| (l.min(*point), h.max(*point)));
    if low.cmple(position).all() && position.cmple(high).all() {
        return Err(SplattingError::LightInside(position));
    }
    Ok(())
}

/// Distances along an axis that hold the points, metres.
fn range(position: Vec3, axis: DVec3, points: &[Vec3]) -> [f32; 2] {
    let along = points.iter().map(|point| axis.dot(point.as_dvec3() - position.as_dvec3()));
    let (near, far) = along.fold((f64::INFINITY, 0.0_f64), |(n, f), at| (n.min(at), f.max(at)));
    if far <= 0.0 {
        return [0.1, 1.0];
    }
    let far = 1.01 * far;
    [(0.99 * near).max(1e-3 * far) as f32, far as f32]
}

/// The axis of about the narrowest cone around unit vectors.
fn middle_of(rays: &[DVec3]) -> Option<DVec3> {
    let mut axis = rays.iter().sum::<DVec3>().try_normalize()?;
    // Ever smaller steps towards the ray that lies farthest away, as in Badoiu and Clarkson's search for the least ball.
    for step in 1..=256 {
        let farthest = rays.iter().min_by(|a, b| a.dot(axis).total_cmp(&b.dot(axis)))?;
        axis = (axis + (*farthest - axis) / f64::from(step + 1)).try_normalize()?;
    }
    Some(axis)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{POINT, SPOT};

    fn corners(min: Vec3, max: Vec3) -> Vec<Vec3> {
        crate::data::Bounds { min, max }.corners().to_vec()
    }

    fn point(position: Vec3) -> Lighting {
        Lighting::Point { position, intensity: Vec3::ONE, radius: 0.1 }
    }

    /// What lies outside of the picture of a light, and the least room at its edges.
    fn held(light: &Light, points: &[Vec3]) -> [f32; 2] {
        let mut most = 0.0_f32;
        let mut least = f32::INFINITY;
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
            let reached = points.iter().map(|point| {
                let seen = light.clip_from_world * point.extend(1.0);
                assert!(seen.w > 0.0 && (0.0..seen.w).contains(&seen.z), "{seen}");
                axis.dot((seen / seen.w).truncate())
            });
            let reached = reached.fold(f32::NEG_INFINITY, f32::max);
            (most, least) = (most.max(reached), least.min(reached));
        }
        [most, least]
    }

    #[test]
    fn frusta_of_point_lights_hold_all_points_and_little_more() {
        let points = corners(Vec3::new(-2.0, -1.0, -3.0), Vec3::new(1.0, 1.5, 2.0));
        let mut random = crate::data::Random::new(5);
        let mut seen = 0;
        for _ in 0..200 {
            let position = 12.0 * random.in_ball();
            let Ok(light) = light_around(&point(position), &points) else { continue };
            seen += 1;
            let [most, least] = held(&light, &points);
            assert!(most < 1.0 && least > 0.95, "{position}: {most} {least}");
            let back = light.world_from_clip.project_point3(Vec3::new(0.3, -0.6, 0.5));
            let again = light.clip_from_world.project_point3(back);
            assert!(again.distance(Vec3::new(0.3, -0.6, 0.5)) < 1e-3, "{again}");
            // All rays leave the light.
            let [near, far] =
                [0.0, 1.0].map(|z| light.world_from_clip.project_point3(Vec3::new(0.5, 0.5, z)));
            let [near, far] = [near, far].map(|place| (place - position).normalize());
            assert!(near.dot(far) > 0.9999 && light.kind == POINT, "{near} {far}");
        }
        assert!(seen > 150, "{seen}");
    }

    #[test]
    fn lights_among_the_points_are_refused() {
        let points = corners(Vec3::NEG_ONE, Vec3::ONE);
        for position in [Vec3::ZERO, Vec3::new(0.9, -0.9, 0.2), Vec3::ONE] {
            let spot = Lighting::Spot {
                position,
                target: Vec3::splat(7.0),
                outer_degrees: 20.0,
                inner_degrees: 10.0,
                intensity: Vec3::ONE,
                radius: 0.1,
            };
            for lighting in [point(position), spot] {
                let error = light_around(&lighting, &points).unwrap_err();
                assert!(matches!(error, SplattingError::LightInside(_)), "{error}");
            }
        }
        let near = light_around(&point(Vec3::new(0.0, 1.05, 0.0)), &points).unwrap_err();
        assert!(matches!(near, SplattingError::LightTooNear(_)), "{near}");
        assert!(light_around(&point(Vec3::splat(f32::NAN)), &points).is_err());
        assert!(light_around(&point(Vec3::splat(3.0)), &[Vec3::NAN]).is_err());
        // Nothing to shine on.
        let light = light_around(&point(Vec3::splat(3.0)), &[]).unwrap();
        assert!(light.clip_from_world.is_finite() && light.world_from_clip.is_finite());
    }

    #[test]
    fn spots_keep_their_cone_and_parallel_light_holds_all_points() {
        let points = corners(Vec3::NEG_ONE, Vec3::ONE);
        let spot = |outer_degrees| Lighting::Spot {
            position: Vec3::new(0.0, 6.0, 0.0),
            target: Vec3::ZERO,
            outer_degrees,
            inner_degrees: 5.0,
            intensity: Vec3::ONE,
            radius: 0.1,
        };
        for degrees in [10.0_f32, 40.0] {
            let light = light_around(&spot(degrees), &points).unwrap();
            let edge = Vec3::new(6.0 * degrees.to_radians().tan(), 0.0, 0.0);
            let seen = light.clip_from_world.project_point3(edge).truncate().abs().max_element();
            assert!((seen * 1.02 - 1.0).abs() < 1e-3 && light.kind == SPOT, "{seen}");
            let depths =
                [5.0, 7.0].map(|y| light.clip_from_world.project_point3(Vec3::new(0.0, 6.0 - y, 0.0)).z);
            assert!(depths[0] > 0.0 && depths[0] < 0.1 && depths[1] < 1.0 && depths[1] > 0.9, "{depths:?}");
        }
        let sun = Lighting::directional(Vec3::new(1.0, 2.0, 0.5), Vec3::ONE);
        let [most, least] = held(&light_around(&sun, &points).unwrap(), &points);
        assert!(most < 1.0 && least > 0.9);
        assert!(light_around(&sun, &[]).is_err());
    }
}
