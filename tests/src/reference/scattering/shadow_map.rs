// SPDX-License-Identifier: MIT OR Apache-2.0
//! Standard shadow maps, and their brute-force rectification.

use super::slice::Rectification;
use super::views::ShadowViews;
use crate::linear::{Mat4, Vec3};
use crate::reference::camera;

/// A standard shadow map.
#[derive(Clone, Copy, Debug)]
pub struct ShadowMap<'a> {
    /// Depth-buffer values, row-major, row 0 at the top.
    pub depth: &'a [f32],
    /// Texels of a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// World to the light's clip space.
    pub clip_from_world: Mat4,
    /// Depth of the far plane, which is that of a texel without a blocker: 1, or 0 for reversed z.
    pub far_depth: f64,
}

impl ShadowMap<'_> {
    /// The stored depth of a texel, none outside of the map or without a blocker (or where the
    /// value is not finite).
    #[must_use]
    pub fn texel(&self, x: i64, y: i64) -> Option<f64> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        if x >= self.width || y >= self.height {
            return None;
        }
        let depth = f64::from(self.depth[y * self.width + x]);
        (!camera::is_far(depth, self.far_depth)).then_some(depth)
    }

    /// Texel coordinates (the top left corner of the map is (0, 0)) and depth of a world point.
    #[must_use]
    pub fn project(&self, point: Vec3) -> [f64; 3] {
        let [x, y, z, w] = self.clip_from_world.apply_point(point);
        [(0.5 + 0.5 * x / w) * self.width as f64, (0.5 - 0.5 * y / w) * self.height as f64, z / w]
    }
}

/// A texel of the rectified map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectifiedTexel {
    /// Its depth, by the shadow map's texel that holds the light ray.
    pub z: f64,
    /// Least depth over the shadow map's texels within the stated distance of the light ray.
    pub low: f64,
    /// Greatest depth over them.
    pub high: f64,
    /// Whether there is more than one such texel: another precision may choose another one.
    pub ambiguous: bool,
}

/// The rectified map, row-major. `edge` is the uncertainty of the look-up in texels of the shadow
/// map (up to 1/2): texels that near to the light ray count for `low` and `high`.
///
/// # Panics
/// If the shadow map's matrix is singular, or its depths are not `width * height`.
#[must_use]
pub fn rectify(shadow_map: &ShadowMap<'_>, rectification: &Rectification, edge: f64) -> Vec<RectifiedTexel> {
    assert_eq!(shadow_map.depth.len(), shadow_map.width * shadow_map.height);
    let world_from_clip = shadow_map.clip_from_world.inverse().expect("a regular matrix");
    let frame = &rectification.frame;
    crate::parallel::rows(rectification.slices.len(), |j| {
        let slice = &rectification.slices[j];
        let texel = |i: usize| {
            let r = (i as f64 + 0.5) * slice.texel(rectification.width);
            let on_light_ray = frame.eye + frame.radial(slice.phi) * r;
            let [x, y, _] = shadow_map.project(on_light_ray);
            let depth_of = |column: f64, row: f64| {
                shadow_map.texel(column as i64, row as i64).map_or(1.0, |stored| {
                    let ndc_x = 2.0 * x / shadow_map.width as f64 - 1.0;
                    let ndc_y = 1.0 - 2.0 * y / shadow_map.height as f64;
                    let [px, py, pz, pw] = world_from_clip.apply([ndc_x, ndc_y, stored, 1.0]);
                    let blocker = Vec3::new(px, py, pz) * pw.recip();
                    let h = (blocker - frame.eye).dot(frame.l);
                    slice.depth(r.atan2(h))
                })
            };
            let z = depth_of(x.floor(), y.floor());
            let near = |at: f64| ((at - edge).floor(), (at + edge).floor());
            let ((left, right), (top, bottom)) = (near(x), near(y));
            let others = [(left, top), (right, top), (left, bottom), (right, bottom)]
                .map(|(column, row)| depth_of(column, row));
            RectifiedTexel {
                z,
                low: others.into_iter().fold(z, f64::min),
                high: others.into_iter().fold(z, f64::max),
                ambiguous: left != right || top != bottom,
            }
        };
        (0..rectification.width).map(texel).collect::<Vec<_>>()
    })
    .concat()
}

/// The same for several shadow maps, of which the first that holds a light ray counts: cascades.
///
/// # Panics
/// If a matrix is singular or a map has not the size that it states.
#[must_use]
pub fn rectify_views(
    maps: &[ShadowMap<'_>],
    rectification: &Rectification,
    edge: f64,
) -> Vec<RectifiedTexel> {
    let views = ShadowViews::new(maps);
    let frame = &rectification.frame;
    crate::parallel::rows(rectification.slices.len(), |j| {
        let slice = &rectification.slices[j];
        let texel = |i: usize| {
            let r = (i as f64 + 0.5) * slice.texel(rectification.width);
            views.look_up(frame.eye + frame.radial(slice.phi) * r, edge, |blocker| {
                blocker.map_or(1.0, |blocker| slice.depth(frame.polar(blocker).theta))
            })
        };
        (0..rectification.width).map(texel).collect::<Vec<_>>()
    })
    .concat()
}
