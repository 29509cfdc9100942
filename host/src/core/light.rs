// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light uniform of `core/light`.

use encase::ShaderType;
use glam::dcamera::rh::{proj::directx, view};
use glam::{DMat4, DVec3, Mat4, Vec2, Vec3};

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
    /// Nothing to fit a shadow map to.
    #[error("a shadow map cannot be fitted: there must be a point or more, all of them finite")]
    Points,
    /// A light at a point that is nowhere.
    #[error("light position {0} is impossible: it must be finite")]
    Position(Vec3),
    /// A spot that shines nowhere.
    #[error("a spot at {position} aimed at {target} has no direction: the two must be finite and apart")]
    Aim {
        /// Where it is.
        position: Vec3,
        /// Where it shines.
        target: Vec3,
    },
    /// The cone of a spot.
    #[error(
        "a spot of {outer} degrees, {inner} of them in full light, is impossible: \
         0 <= inner <= outer and 0.5 <= outer <= 80 are needed, measured from the axis"
    )]
    Cone {
        /// Degrees from the axis to where there is no light.
        outer: f32,
        /// Degrees from the axis to where the light begins to fall off.
        inner: f32,
    },
    /// The radius of a light at a point.
    #[error("light radius {0} m is impossible: it must be positive and finite")]
    Radius(f32),
    /// The range of a shadow map.
    #[error("a shadow map from {near} m to {far} m is impossible: 0 < near < far is needed, both finite")]
    Range {
        /// Nearest blocker.
        near: f32,
        /// Farthest blocker.
        far: f32,
    },
    /// The number of cascades.
    #[error("{0} cascades are impossible: the number must be from 1 to 6")]
    Cascades(u32),
    /// Cascades of a light that is not directional.
    #[error("cascades are for directional lights: leave them out for a spot or a point light")]
    CascadesOfLocal,
    /// How cascades are split.
    #[error(
        "a logarithmic share of {0} is impossible: it must be from 0 (equal cascades) to 1 (logarithmic)"
    )]
    Split(f32),
    /// A texture in front of a point light.
    #[error("a point light takes no light texture: use a spot, or several")]
    TextureOfPoint,
    /// The camera that cascades are fitted to.
    #[error("cascades cannot be fitted to this camera: its matrices and the distance limit must be finite")]
    Camera,
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
        if !(min.is_finite() && max.is_finite() && min.cmple(max).all()) {
            return Err(LightError::Scene { min, max });
        }
        let direction = unit_direction(towards)?;
        let view = light_view(direction);
        Ok(Self::over(direction, radiance, view, extent(view, &box_corners(min, max))))
    }

    /// Towards `direction`, over what `view` sees from the least to the greatest coordinates.
    pub(super) fn over(direction: DVec3, radiance: Vec3, view: DMat4, (low, high): (DVec3, DVec3)) -> Self {
        let [low, high] = roomy(low, high);
        let projection = directx::orthographic(low.x, high.x, low.y, high.y, -high.z, -low.z);
        let clip_from_world = projection * view;
        Self {
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
        }
    }

    /// A spot with a perspective shadow map, forward depth, that holds its whole cone. `outer_degrees`,
    /// `inner_degrees`: from the axis to where the light ends, and to where it begins to fall off. `intensity`: linear
    /// RGB radiant intensity. `radius`, and the range `near..far` of blockers, in metres.
    ///
    /// # Errors
    /// [`LightError`].
    #[allow(clippy::too_many_arguments)]
    pub fn spot(
        position: Vec3,
        target: Vec3,
        outer_degrees: f32,
        inner_degrees: f32,
        intensity: Vec3,
        radius: f32,
        near: f32,
        far: f32,
    ) -> Result<Self, LightError> {
        let axis = (target.as_dvec3() - position.as_dvec3()).normalize_or_zero();
        if !(position.is_finite() && target.is_finite()) || axis == DVec3::ZERO {
            return Err(LightError::Aim { position, target });
        }
        let (outer, inner) = (outer_degrees, inner_degrees);
        if !((0.5..=80.0).contains(&outer) && inner >= 0.0 && inner <= outer) {
            return Err(LightError::Cone { outer, inner });
        }
        check_local(radius, near, far)?;
        let view = view::look_to_mat4(position.as_dvec3(), axis, up_for(axis));
        let half = f64::from(outer).to_radians().tan() * ROOM;
        let projection = directx::perspective(2.0 * half.atan(), 1.0, f64::from(near), f64::from(far));
        let clip_from_world = projection * view;
        let cosine = |degrees: f32| f64::from(degrees).to_radians().cos() as f32;
        Ok(Self {
            clip_from_world: clip_from_world.as_mat4(),
            world_from_clip: clip_from_world.inverse().as_mat4(),
            direction: (-axis).as_vec3(),
            far_depth: 1.0,
            radiance: intensity,
            kind: SPOT,
            position,
            radius,
            spot_cosines: Vec2::new(cosine(inner), cosine(outer)),
            reserved_a: 0.0,
            reserved_b: 0.0,
        })
    }

    /// A point light; its six shadow maps are those of [`super::ShadowViews::cube`], forward depth, and its own
    /// matrices are unused. `intensity`: linear RGB radiant intensity. `radius` in metres.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn point(
        position: Vec3,
        intensity: Vec3,
        radius: f32,
        near: f32,
        far: f32,
    ) -> Result<Self, LightError> {
        if !position.is_finite() {
            return Err(LightError::Position(position));
        }
        check_local(radius, near, far)?;
        Ok(Self {
            clip_from_world: Mat4::IDENTITY,
            world_from_clip: Mat4::IDENTITY,
            direction: Vec3::Y,
            far_depth: 1.0,
            radiance: intensity,
            kind: POINT,
            position,
            radius,
            spot_cosines: Vec2::ZERO,
            reserved_a: 0.0,
            reserved_b: 0.0,
        })
    }
}

/// What a map holds beyond the cone or the face that it is for, so that the taps of a filter stay inside.
pub(super) const ROOM: f64 = 1.02;

pub(super) fn check_local(radius: f32, near: f32, far: f32) -> Result<(), LightError> {
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(LightError::Radius(radius));
    }
    check_range(near, far)
}

pub(super) fn check_range(near: f32, far: f32) -> Result<(), LightError> {
    if near > 0.0 && far > near && far.is_finite() { Ok(()) } else { Err(LightError::Range { near, far }) }
}

pub(super) fn unit_direction(towards: Vec3) -> Result<DVec3, LightError> {
    let direction = towards.as_dvec3().normalize_or_zero();
    let possible = direction.is_finite() && direction != DVec3::ZERO;
    if possible { Ok(direction) } else { Err(LightError::Direction(towards)) }
}

pub(super) fn up_for(axis: DVec3) -> DVec3 {
    if axis.y.abs() > 0.999 { DVec3::X } else { DVec3::Y }
}

/// The view of a directional light towards `direction`: z grows towards the light.
pub(super) fn light_view(direction: DVec3) -> DMat4 {
    view::look_to_mat4(DVec3::ZERO, -direction, up_for(direction))
}

pub(super) fn box_corners(min: Vec3, max: Vec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let pick =
            |bit: usize, low: f32, high: f32| f64::from(if corner >> bit & 1 == 0 { low } else { high });
        DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    })
}

/// Least and greatest coordinates of points as a view sees them.
pub(super) fn extent(view: DMat4, points: &[DVec3]) -> (DVec3, DVec3) {
    points
        .iter()
        .map(|point| view.transform_point3(*point))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), seen| (low.min(seen), high.max(seen)))
}

/// A little room, so that no blocker lies on the border or at the depth of an empty texel.
pub(super) fn roomy(low: DVec3, high: DVec3) -> [DVec3; 2] {
    let room = (high - low) * 0.01 + DVec3::splat((high - low).max_element() * 1e-3 + 1e-6);
    [low - room, high + room]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use glam::Quat;

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

    #[test]
    fn the_map_of_a_spot_holds_its_cone_and_depth_grows_away_from_it() {
        for target in [Vec3::new(3.0, 0.5, -1.0), Vec3::new(1.0, -4.0, 2.0)] {
            let position = Vec3::new(1.0, 2.0, 2.0);
            let light = Light::spot(position, target, 30.0, 20.0, Vec3::ONE, 0.1, 0.05, 20.0).unwrap();
            let axis = (target - position).normalize();
            let across = axis.any_orthonormal_vector();
            for turn in 0..12 {
                let rim = Quat::from_axis_angle(axis, turn as f32 * 0.52) * across;
                for (near, far) in [(0.06, 0.1), (0.1, 5.0), (5.0, 19.0)] {
                    let at = |distance: f32| {
                        let along = axis + rim * 30_f32.to_radians().tan();
                        light.clip_from_world * (position + along * distance).extend(1.0)
                    };
                    let (a, b) = (at(near), at(far));
                    assert!(a.x.abs() < a.w && a.y.abs() < a.w && a.w > 0.0, "{a}");
                    assert!(a.z / a.w > 0.0 && a.z / a.w < b.z / b.w && b.z / b.w < 1.0, "{a} {b}");
                }
            }
            assert!(light.spot_cosines.x > light.spot_cosines.y);
            assert!((light.direction + axis).length() < 1e-6);
        }
    }

    #[test]
    fn impossible_local_lights_are_refused() {
        let spot = |position: Vec3, target: Vec3, outer, inner, radius, near, far| {
            Light::spot(position, target, outer, inner, Vec3::ONE, radius, near, far).unwrap_err()
        };
        use LightError as E;
        assert!(matches!(spot(Vec3::Y, Vec3::Y, 30.0, 20.0, 0.1, 0.1, 9.0), E::Aim { .. }));
        assert!(matches!(spot(Vec3::NAN, Vec3::Y, 30.0, 20.0, 0.1, 0.1, 9.0), E::Aim { .. }));
        for (outer, inner) in [(20.0, 30.0), (0.0, 0.0), (90.0, 10.0), (f32::NAN, 1.0), (30.0, -1.0)] {
            assert!(matches!(spot(Vec3::Y, Vec3::ZERO, outer, inner, 0.1, 0.1, 9.0), E::Cone { .. }));
        }
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(matches!(spot(Vec3::Y, Vec3::ZERO, 30.0, 20.0, radius, 0.1, 9.0), E::Radius(_)));
            assert!(matches!(Light::point(Vec3::Y, Vec3::ONE, radius, 0.1, 9.0), Err(E::Radius(_))));
        }
        for (near, far) in [(0.0, 1.0), (2.0, 1.0), (0.1, f32::INFINITY), (f32::NAN, 1.0)] {
            assert!(matches!(spot(Vec3::Y, Vec3::ZERO, 30.0, 20.0, 0.1, near, far), E::Range { .. }));
            assert!(matches!(Light::point(Vec3::Y, Vec3::ONE, 0.1, near, far), Err(E::Range { .. })));
        }
        assert!(matches!(Light::point(Vec3::INFINITY, Vec3::ONE, 0.1, 0.1, 9.0), Err(E::Position(_))));
    }
}
