// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directional lights that are fitted to points, upright or leaning.

use super::light::{extent, light_view, unit_direction};
use super::{Light, LightError};
use glam::{DMat4, DVec2, DVec3, DVec4, Vec3};

impl Light {
    /// A directional light whose shadow map tightly holds points in the world, metres, forward depth. Its range along the light
    /// is that of the points, not of a box around them, which transmittance maps gain by.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn directional_around(
        towards: Vec3,
        radiance: Vec3,
        points: impl IntoIterator<Item = Vec3>,
    ) -> Result<Self, LightError> {
        Self::directional_around_balls(towards, radiance, points.into_iter().map(|point| (point, 0.0)))
    }

    /// The same around balls: middles and radii, metres.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn directional_around_balls(
        towards: Vec3,
        radiance: Vec3,
        balls: impl IntoIterator<Item = (Vec3, f32)>,
    ) -> Result<Self, LightError> {
        let direction = unit_direction(towards)?;
        let view = light_view(direction);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (middle, radius) in balls {
            let (seen, reach) =
                (view.transform_point3(middle.as_dvec3()), DVec3::splat(f64::from(radius.abs())));
            if !(seen.is_finite() && reach.is_finite()) {
                return Err(LightError::Points);
            }
            (low, high) = (low.min(seen - reach), high.max(seen + reach));
        }
        if !low.cmple(high).all() {
            return Err(LightError::Points);
        }
        Ok(Self::over(direction, radiance, view, (low, high)))
    }

    /// As [`Light::directional_around`], with near and far sides that lean so that the range along the light is least: for media
    /// that stand or lie askew to it, such as [`crate::data::Volume::occupied_points`]. Only transmittance maps of volumes take such a light; particles, shadow maps and scattering
    /// want sides across the light.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn directional_leaning(
        towards: Vec3,
        radiance: Vec3,
        points: impl IntoIterator<Item = Vec3>,
    ) -> Result<Self, LightError> {
        let direction = unit_direction(towards)?;
        let view = light_view(direction);
        let seen: Vec<DVec3> =
            points.into_iter().map(|point| view.transform_point3(point.as_dvec3())).collect();
        if seen.is_empty() || !seen.iter().all(|point| point.is_finite()) {
            return Err(LightError::Points);
        }
        let lean = least_lean(&seen);
        let upright = DMat4::from_cols(
            DVec4::new(1.0, 0.0, -lean.x, 0.0),
            DVec4::new(0.0, 1.0, -lean.y, 0.0),
            DVec4::Z,
            DVec4::W,
        );
        let view = upright * view;
        let seen: Vec<DVec3> = seen.into_iter().map(|point| upright.transform_point3(point)).collect();
        Ok(Self::over(direction, radiance, view, extent(DMat4::IDENTITY, &seen)))
    }
}

/// Metres along the light to the metre across it, by which near and far sides are to lean for the least range.
fn least_lean(seen: &[DVec3]) -> DVec2 {
    // The range is convex in the lean: one search in the other. A part of the points does for the search.
    // An odd stride, since points come in pairs of ends.
    let some: Vec<DVec3> = seen.iter().step_by(seen.len().div_ceil(8192) | 1).copied().collect();
    let range = |lean: DVec2| {
        let along = some.iter().map(|point| point.z - lean.dot(point.truncate()));
        let (low, high) =
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        high - low
    };
    let best_y = |x: f64| least(|y| range(DVec2::new(x, y)));
    let x = least(|x| range(DVec2::new(x, best_y(x))));
    DVec2::new(x, best_y(x))
}

/// Where a convex function is least between leans of 76 degrees, by golden sections.
fn least(value: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (mut low, mut high) = (-4.0, 4.0);
    let at = |share: f64, low: f64, high: f64| low + share * (high - low);
    let (mut first, mut second) = (at(1.0 - GOLDEN, low, high), at(GOLDEN, low, high));
    let (mut of_first, mut of_second) = (value(first), value(second));
    for _ in 0..26 {
        if of_first <= of_second {
            (high, second, of_second) = (second, first, of_first);
            first = at(1.0 - GOLDEN, low, high);
            of_first = value(first);
        } else {
            (low, first, of_first) = (first, second, of_second);
            second = at(GOLDEN, low, high);
            of_second = value(second);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::light::box_corners;
    use super::*;

    #[test]
    fn a_light_around_balls_reaches_from_the_first_to_the_last_and_a_little_farther() {
        let towards = Vec3::new(0.6, 0.0, 0.8);
        let balls = [(Vec3::new(3.0, 1.0, 4.0), 0.5), (Vec3::new(-0.6, 2.0, -0.8), 0.25), (Vec3::Y, 1.0)];
        let light = Light::directional_around_balls(towards, Vec3::ONE, balls).unwrap();
        // Along the light the middles lie at 5, -1 and 0: from -1.25 to 5.5 m, with a room of 1.1 % at each end.
        let range = light.world_from_clip.z_axis.truncate().length();
        assert!((range / (1.022 * 6.75) - 1.0).abs() < 1e-3, "{range}");
        let near = light.clip_from_world.project_point3(5.5 * towards);
        let far = light.clip_from_world.project_point3(-1.25 * towards);
        assert!((near.z - 0.0108).abs() < 2e-4 && (far.z - 0.9892).abs() < 2e-4, "{near} {far}");
        // Up from 0 to 2.25 m.
        let up = |y: f32| light.clip_from_world.project_point3(Vec3::new(0.0, y, 0.0)).y;
        assert!(
            (up(2.25) - 0.9733).abs() < 5e-3 && (up(0.0) + 0.9733).abs() < 5e-3,
            "{} {}",
            up(2.25),
            up(0.0)
        );
        for wrong in [vec![], vec![(Vec3::NAN, 1.0)], vec![(Vec3::ZERO, 1.0), (Vec3::Y, f32::INFINITY)]] {
            let error = Light::directional_around_balls(towards, Vec3::ONE, wrong).unwrap_err();
            assert_eq!(error, LightError::Points);
        }
        assert!(Light::directional_around(Vec3::ZERO, Vec3::ONE, [Vec3::ONE]).is_err());
        let point = Light::directional_around(Vec3::Y, Vec3::ONE, [Vec3::ONE]).unwrap();
        assert!(point.world_from_clip.is_finite());
    }

    /// A wall of 1 x 5 x 2 m under light from 45 degrees: each light ray passes at most √2 m of it, and the upright range is 3 times that.
    #[test]
    fn a_leaning_range_is_as_long_as_the_longest_way_through_a_wall() {
        let corners =
            || box_corners(Vec3::new(-0.5, 0.0, -1.0), Vec3::new(0.5, 5.0, 1.0)).map(DVec3::as_vec3);
        let range = |light: &Light| light.world_from_clip.z_axis.truncate().length();
        for towards in [Vec3::new(1.0, 1.0, 0.0), Vec3::new(-1.0, 1.0, 0.0), Vec3::new(-1.0, -1.0, 0.0)] {
            let light = Light::directional_leaning(towards, Vec3::ONE, corners()).unwrap();
            assert!((1.02..1.04).contains(&(range(&light) / 2.0_f32.sqrt())), "{}", range(&light));
            let upright = Light::directional_around(towards, Vec3::ONE, corners()).unwrap();
            assert!(range(&upright) > 2.9 * range(&light));
            for corner in corners() {
                let clip = light.clip_from_world.project_point3(corner);
                assert!(clip.x.abs() < 1.0 && clip.y.abs() < 1.0 && clip.z > 0.0 && clip.z < 1.0, "{clip}");
                let nearer = light.clip_from_world.project_point3(corner + 0.1 * light.direction);
                assert!((nearer - clip).truncate().length() < 1e-5 && nearer.z < clip.z);
            }
        }
        // A sheet askew to the light has next to no range, and of what is upright nothing leans.
        let sheet = [Vec3::ZERO, Vec3::new(1.0, 2.0, 0.0), Vec3::new(2.0, 1.0, 1.0)];
        assert!(range(&Light::directional_leaning(Vec3::Z, Vec3::ONE, sheet).unwrap()) < 0.01);
        let light = Light::directional_leaning(Vec3::Y, Vec3::ONE, corners()).unwrap();
        assert!(light.world_from_clip.x_axis.truncate().dot(Vec3::Y).abs() < 1e-3);
        assert!(Light::directional_leaning(Vec3::Y, Vec3::ONE, []).is_err());
    }
}
