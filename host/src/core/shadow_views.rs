// SPDX-License-Identifier: MIT OR Apache-2.0
//! The uniform of `core/shadow_views`: cascades of a directional light, faces around a point light.

use super::camera::Camera;
use super::light::{
    DIRECTIONAL, Light, LightError, ROOM, box_corners, check_range, extent, light_view, roomy,
};
use encase::ShaderType;
use glam::dcamera::rh::{proj::directx, view};
use glam::{DMat4, DVec3, DVec4, Mat4, Vec3};

/// The most views of an array of shadow maps.
pub const MAX_VIEWS: usize = 6;

/// The uniform `ShadowViews`: view k belongs to layer k of the array of shadow maps.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct ShadowViews {
    /// World to the clip space of each view.
    pub clip_from_world: [Mat4; MAX_VIEWS],
    /// Their inverses.
    pub world_from_clip: [Mat4; MAX_VIEWS],
    /// Number of views, 1 to 6.
    pub count: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
    /// Padding.
    pub reserved_c: u32,
}

/// How the depth of a view is cut into cascades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cascades {
    /// Number of cascades, 1 to 6.
    pub count: u32,
    /// Share of the logarithmic split, 0 (equal lengths) to 1: the practical split scheme of Zhang et al. (2006).
    pub logarithmic: f32,
}

impl Cascades {
    /// `count` cascades with the usual split.
    pub fn new(count: u32) -> Self {
        Self { count, logarithmic: 0.7 }
    }

    /// Distances along the view at which cascades end, between `near` and `far`, both positive.
    fn ends(&self, near: f64, far: f64) -> impl Iterator<Item = f64> {
        let (count, share) = (f64::from(self.count), f64::from(self.logarithmic));
        (1..=self.count).map(move |end| {
            let part = f64::from(end) / count;
            share * near * (far / near).powf(part) + (1.0 - share) * (near + (far - near) * part)
        })
    }
}

impl ShadowViews {
    /// The faces +x, -x, +y, -y, +z, -z around a point light, each a little wider than a right angle, so that every
    /// direction lies in one and a filter's taps stay inside. Forward depth over `near..far` metres.
    ///
    /// # Errors
    /// [`LightError::Position`], [`LightError::Range`].
    pub fn cube(position: Vec3, near: f32, far: f32) -> Result<Self, LightError> {
        if !position.is_finite() {
            return Err(LightError::Position(position));
        }
        check_range(near, far)?;
        let projection = directx::perspective(2.0 * ROOM.atan(), 1.0, f64::from(near), f64::from(far));
        let faces = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        Ok(Self::of(faces.map(|axis| {
            let up = if axis.y == 0.0 { DVec3::Y } else { DVec3::Z };
            projection * view::look_to_mat4(position.as_dvec3(), axis, up)
        })))
    }

    /// Cascades of a directional light, nearest first, fitted to parts of a camera's frustum from the eye (or the near
    /// plane of an orthographic camera) to the lesser of its far plane and `limit` metres, without what lies outside
    /// the box `min..max` of all blockers. The depth range is that of [`Light::directional`] for this box in all of
    /// them, so that blockers between the light and the frustum are kept and depths compare between layers.
    ///
    /// # Errors
    /// [`LightError`].
    pub fn cascades(
        light: &Light,
        camera: &Camera,
        cascades: Cascades,
        limit: f32,
        [min, max]: [Vec3; 2],
    ) -> Result<Self, LightError> {
        if light.kind != DIRECTIONAL {
            return Err(LightError::CascadesOfLocal);
        }
        if !(1..=MAX_VIEWS as u32).contains(&cascades.count) {
            return Err(LightError::Cascades(cascades.count));
        }
        if !(0.0..=1.0).contains(&cascades.logarithmic) {
            return Err(LightError::Split(cascades.logarithmic));
        }
        if !(min.is_finite() && max.is_finite() && min.cmple(max).all()) {
            return Err(LightError::Scene { min, max });
        }
        let direction = light.direction.as_dvec3().normalize_or_zero();
        if direction == DVec3::ZERO {
            return Err(LightError::Direction(light.direction));
        }
        let frustum = Frustum::new(camera, f64::from(limit)).ok_or(LightError::Camera)?;
        let view = light_view(direction);
        let (low, high) = extent(view, &box_corners(min, max));
        let [scene_low, scene_high] = roomy(low, high);
        let mut begin = frustum.begin;
        let matrices = cascades.ends(frustum.near, frustum.far).map(|end| {
            let (low, high) = extent(view, &frustum.part(begin, end));
            begin = end;
            let room = (high - low) * 0.01 + DVec3::splat(1e-6);
            let (mut low, mut high) = (low - room, high + room);
            let (inner_low, inner_high) = (low.max(scene_low), high.min(scene_high));
            // A part of the frustum beside all blockers keeps its own extent; so does each side of it.
            if inner_low.x < inner_high.x && inner_low.y < inner_high.y {
                (low, high) = (inner_low, inner_high);
            }
            directx::orthographic(low.x, high.x, low.y, high.y, -scene_high.z, -scene_low.z) * view
        });
        Ok(Self::of(matrices))
    }

    fn of(matrices: impl IntoIterator<Item = DMat4>) -> Self {
        let mut views = Self {
            clip_from_world: [Mat4::IDENTITY; MAX_VIEWS],
            world_from_clip: [Mat4::IDENTITY; MAX_VIEWS],
            count: 0,
            reserved_a: 0,
            reserved_b: 0,
            reserved_c: 0,
        };
        for (view, matrix) in matrices.into_iter().enumerate().take(MAX_VIEWS) {
            views.clip_from_world[view] = matrix.as_mat4();
            views.world_from_clip[view] = matrix.inverse().as_mat4();
            views.count += 1;
        }
        views
    }
}

/// A camera's frustum, in f64.
struct Frustum {
    /// Where the four corner rays start, and how far they go for one metre along the view.
    rays: [(DVec3, DVec3); 4],
    /// Where cascades begin, metres along the view from where the rays start.
    begin: f64,
    near: f64,
    far: f64,
}

impl Frustum {
    fn new(camera: &Camera, limit: f64) -> Option<Self> {
        let world_from_clip = camera.world_from_clip.as_dmat4();
        let at = |x: f64, y: f64, depth: f32| world_from_clip * DVec4::new(x, y, f64::from(depth), 1.0);
        let near = |x, y| at(x, y, camera.near_depth).project();
        // An infinite far plane has w = 0, and the direction alone is left.
        let direction = |x, y| {
            let far = at(x, y, camera.far_depth);
            far.truncate() - near(x, y) * far.w
        };
        let rows = camera.clip_from_world.as_dmat4().transpose();
        let perspective = camera.projection == 0;
        let forward =
            if perspective { rows.w_axis.truncate() } else { direction(0.0, 0.0) }.normalize_or_zero();
        let eye = camera.eye.as_dvec3();
        let rays = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| {
            let along = direction(x, y);
            (if perspective { eye } else { near(x, y) }, along / along.dot(forward))
        });
        let start = if perspective { eye } else { near(0.0, 0.0) };
        let far = at(0.0, 0.0, camera.far_depth);
        let along = (far.truncate() - start * far.w).dot(forward);
        let far = if along >= limit * far.w { limit } else { along / far.w };
        let near = (near(0.0, 0.0) - start).dot(forward);
        let finite = rays.iter().all(|(from, along)| from.is_finite() && along.is_finite());
        let valid = finite && limit.is_finite() && near.is_finite() && far.is_finite() && far > 0.0;
        // Logarithms want a positive beginning, also of an orthographic view and of a far plane before the near one.
        let near = near.max(far * 1e-3).min(far * 0.5);
        valid.then_some(Self { rays, begin: 0.0, near, far })
    }

    /// Corners of the part between two distances along the view.
    fn part(&self, begin: f64, end: f64) -> [DVec3; 8] {
        std::array::from_fn(|corner| {
            let (from, along) = self.rays[corner & 3];
            from + along * if corner < 4 { begin } else { end }
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{DepthRange, OrthographicView, PerspectiveView, View};
    use crate::data::Random;

    fn inside(views: &ShadowViews, point: Vec3) -> Option<(usize, Vec3)> {
        (0..views.count as usize).find_map(|view| {
            let clip = views.clip_from_world[view] * point.extend(1.0);
            let held = clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w;
            held.then(|| (view, clip.truncate() / clip.w))
        })
    }

    #[test]
    fn every_direction_from_a_point_light_has_a_face() {
        let position = Vec3::new(3.0, -1.0, 0.5);
        let views = ShadowViews::cube(position, 0.01, 30.0).unwrap();
        assert_eq!(views.count, 6);
        let mut random = Random::new(5);
        let diagonals = [Vec3::ONE, Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::NEG_ONE];
        for direction in (0..3000).map(|_| random.direction()).chain(diagonals) {
            let at = |distance: f32| inside(&views, position + direction * distance).unwrap();
            let ((_, near), (_, far)) = (at(0.5), at(16.0));
            assert!(near.z > 0.0 && near.z < far.z && far.z < 1.0, "{near} {far}");
        }
        assert!(ShadowViews::cube(Vec3::NAN, 0.1, 1.0).is_err());
        assert!(ShadowViews::cube(Vec3::ZERO, 1.0, 1.0).is_err());
    }

    fn cameras() -> Vec<Camera> {
        let perspective = |depth, far| {
            View::from(PerspectiveView {
                eye: Vec3::new(2.0, 3.0, 4.0),
                target: Vec3::new(-3.0, 2.0, -5.0),
                field_of_view: 55.0,
                near: 0.2,
                far,
                depth,
            })
        };
        let orthographic = View::from(OrthographicView {
            eye: Vec3::new(2.0, 3.0, 4.0),
            target: Vec3::new(-3.0, 1.0, -5.0),
            height: 6.0,
            near: 0.5,
            far: 25.0,
            depth: DepthRange::Reversed,
        });
        let views = [
            perspective(DepthRange::Forward, 25.0),
            perspective(DepthRange::Reversed, 25.0),
            perspective(DepthRange::Reversed, f32::INFINITY),
            orthographic,
        ];
        views.iter().map(|view| Camera::new(view, [96, 54]).unwrap()).collect()
    }

    #[test]
    fn cascades_hold_the_frustum_and_share_the_depth_of_the_whole_map() {
        let (min, max) = (Vec3::new(-40.0, -2.0, -40.0), Vec3::new(40.0, 30.0, 40.0));
        let mut random = Random::new(9);
        for camera in cameras() {
            let light = Light::directional(random.direction(), Vec3::ONE, min, max).unwrap();
            let views = ShadowViews::cascades(&light, &camera, Cascades::new(4), 20.0, [min, max]).unwrap();
            assert_eq!(views.count, 4);
            let mut used = [0; 4];
            for _ in 0..2000 {
                let ndc = Vec3::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0), camera.near_depth);
                let near = camera.world_from_clip.project_point3(ndc);
                let far = camera.world_from_clip * ndc.with_z(camera.far_depth).extend(1.0);
                let direction = (far.truncate() - near * far.w).normalize();
                let point = near + direction * random.range(0.0, 19.0);
                let (view, at) = inside(&views, point).unwrap_or_else(|| panic!("{point} of {camera:?}"));
                used[view] += 1;
                let whole = light.clip_from_world.project_point3(point);
                assert!((at.z - whole.z).abs() < 1e-5, "{at} {whole}");
            }
            assert!(used.iter().filter(|count| **count > 0).count() >= 2, "{used:?}");
            // The nearest cascade is finer than the whole map.
            let width = |matrix: Mat4| matrix.row(0).truncate().length();
            assert!(width(views.clip_from_world[0]) > 4.0 * width(light.clip_from_world));
        }
    }

    #[test]
    fn splits_grow_from_the_near_to_the_far_plane() {
        let ends: Vec<f64> = Cascades { count: 3, logarithmic: 1.0 }.ends(0.1, 100.0).collect();
        for (end, expected) in ends.iter().zip([1.0, 10.0, 100.0]) {
            assert!((end / expected - 1.0).abs() < 1e-9, "{ends:?}");
        }
        let equal: Vec<f64> = Cascades { count: 4, logarithmic: 0.0 }.ends(1.0, 9.0).collect();
        assert_eq!(equal, [3.0, 5.0, 7.0, 9.0]);
    }

    #[test]
    fn impossible_cascades_are_refused() {
        let bounds = [Vec3::splat(-1.0), Vec3::ONE];
        let light = Light::directional(Vec3::Y, Vec3::ONE, bounds[0], bounds[1]).unwrap();
        let spot = Light::spot(Vec3::Y, Vec3::ZERO, 30.0, 20.0, Vec3::ONE, 0.1, 0.1, 9.0).unwrap();
        let camera = cameras()[0];
        let of = |light: &Light, cascades, limit| {
            ShadowViews::cascades(light, &camera, cascades, limit, bounds).unwrap_err()
        };
        assert_eq!(of(&light, Cascades::new(0), 9.0), LightError::Cascades(0));
        assert_eq!(of(&light, Cascades::new(7), 9.0), LightError::Cascades(7));
        assert!(matches!(of(&light, Cascades { count: 2, logarithmic: 1.5 }, 9.0), LightError::Split(_)));
        assert_eq!(of(&spot, Cascades::new(2), 9.0), LightError::CascadesOfLocal);
        assert_eq!(of(&light, Cascades::new(2), f32::INFINITY), LightError::Camera);
    }
}
