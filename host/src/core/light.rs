// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light uniform of `core/light`.

use encase::ShaderType;
use glam::dcamera::rh::{proj::directx, view};
use glam::{DVec3, Mat4, Vec2, Vec3};

/// What makes a light impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightError {
    /// The direction is zero or not finite.
    #[error("light direction {0} is impossible: it must be finite and not zero")]
    Direction(Vec3),
    /// The blockers have no extent.
    #[error("the scene from {min} to {max} cannot be fitted into a shadow map")]
    Scene {
        /// Least corner of its box.
        min: Vec3,
        /// Greatest corner.
        max: Vec3,
    },
}

/// Unit vector TOWARDS a light. `azimuth`: degrees from +z towards +x; `elevation`: degrees above the horizon.
pub fn direction_from_angles(azimuth: f32, elevation: f32) -> Vec3 {
    let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos())
}

/// `kind` of a light at infinity.
pub const DIRECTIONAL: u32 = 0;
/// `kind` of a light at a point that shines into a cone.
pub const SPOT: u32 = 1;
/// `kind` of a light at a point that shines everywhere.
pub const POINT: u32 = 2;

/// The uniform `Light` of `core/light`: a light and its standard shadow map.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Light {
    /// World to the shadow map's clip space.
    pub clip_from_world: Mat4,
    /// Its inverse.
    pub world_from_clip: Mat4,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of its axis.
    pub direction: Vec3,
    /// Depth of an empty texel.
    pub far_depth: f32,
    /// Linear RGB irradiance at normal incidence, or radiant intensity of a light at a point.
    pub radiance: Vec3,
    /// [`DIRECTIONAL`], [`SPOT`] or [`POINT`].
    pub kind: u32,
    /// Where a spot or point light is, metres.
    pub position: Vec3,
    /// Radius of a spot or point light, metres.
    pub radius: f32,
    /// Cosines of the half angles of a spot, inner and outer.
    pub spot_cosines: Vec2,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

impl Light {
    /// A directional light whose shadow map tightly holds the box of all blockers, forward depth.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn directional(towards: Vec3, radiance: Vec3, min: Vec3, max: Vec3) -> Result<Self, LightError> {
        let direction = towards.as_dvec3().normalize_or_zero();
        if !direction.is_finite() || direction == DVec3::ZERO {
            return Err(LightError::Direction(towards));
        }
        if !(min.is_finite() && max.is_finite() && min.cmple(max).all()) {
            return Err(LightError::Scene { min, max });
        }
        let up = if direction.y.abs() > 0.999 { DVec3::X } else { DVec3::Y };
        let view = view::look_to_mat4(DVec3::ZERO, -direction, up);
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for corner in 0..8u32 {
            let pick =
                |bit: u32, low: f32, high: f32| f64::from(if corner >> bit & 1 == 0 { low } else { high });
            let at = DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let seen = view.transform_point3(at);
            low = low.min(seen);
            high = high.max(seen);
        }
        // A little room, so that no blocker lies on the border or at the depth of an empty texel.
        let room = (high - low) * 0.01 + DVec3::splat((high - low).max_element() * 1e-3 + 1e-6);
        let (low, high) = (low - room, high + room);
        let projection = directx::orthographic(low.x, high.x, low.y, high.y, -high.z, -low.z);
        let clip_from_world = projection * view;
        Ok(Self {
            clip_from_world: clip_from_world.as_mat4(),
            world_from_clip: clip_from_world.inverse().as_mat4(),
            direction: direction.as_vec3(),
            far_depth: 1.0,
            radiance,
            kind: DIRECTIONAL,
            position: Vec3::ZERO,
            radius: 0.0,
            spot_cosines: Vec2::ZERO,
            reserved_a: 0.0,
            reserved_b: 0.0,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn angles_follow_the_convention() {
        assert!((direction_from_angles(0.0, 0.0) - Vec3::Z).length() < 1e-6);
        assert!((direction_from_angles(90.0, 0.0) - Vec3::X).length() < 1e-6);
        assert!((direction_from_angles(30.0, 90.0) - Vec3::Y).length() < 1e-6);
    }

    #[test]
    fn the_box_lies_inside_and_depth_grows_away_from_the_light() {
        for towards in [Vec3::Y, Vec3::new(0.3, 0.5, -0.8), -Vec3::Y, Vec3::X] {
            let light =
                Light::directional(towards, Vec3::ONE, Vec3::splat(-2.0), Vec3::new(1.0, 3.0, 2.0)).unwrap();
            for corner in [Vec3::splat(-2.0), Vec3::new(1.0, 3.0, 2.0), Vec3::new(1.0, -2.0, 2.0)] {
                let clip = light.clip_from_world * corner.extend(1.0);
                assert!(clip.x.abs() < 1.0 && clip.y.abs() < 1.0 && clip.z > 0.0 && clip.z < 1.0);
                let nearer = light.clip_from_world * (corner + light.direction * 0.1).extend(1.0);
                assert!(nearer.z < clip.z);
            }
        }
        assert!(Light::directional(Vec3::ZERO, Vec3::ONE, Vec3::ZERO, Vec3::ONE).is_err());
        assert!(Light::directional(Vec3::Y, Vec3::ONE, Vec3::ONE, Vec3::ZERO).is_err());
    }
}
