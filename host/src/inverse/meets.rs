// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether a view sees a volume at all.

use super::SliceView;
use glam::DVec3;

/// Whether any ray through the middle of a pixel has a piece in the volume's box before its surface. `depths`: metres along each ray to
/// where it ends, row after row; those that are missing end nowhere.
pub fn meets_volume(view: &SliceView, depths: Option<&[f32]>) -> bool {
    let [origin, right, down] =
        [view.origin, view.origin_right, view.origin_down].map(|vector| vector.as_dvec3());
    let [way, way_right, way_down] =
        [view.direction, view.direction_right, view.direction_down].map(|vector| vector.as_dvec3());
    let edges = [view.edge_x, view.edge_y, view.edge_z].map(|edge| edge.as_dvec3());
    let meets = |pixel: usize| {
        let width = view.width as usize;
        let (column, row) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let from = origin + column * right + row * down;
        let along = way + column * way_right + row * way_down;
        let metres = (along.x * edges[0] + along.y * edges[1] + along.z * edges[2]).length();
        let limit = depths.and_then(|depths| depths.get(pixel)).map_or(f64::INFINITY, |at| f64::from(*at));
        let [begin, end] = span(from, along);
        end.min(limit / metres.max(1e-30)) > begin
    };
    (0..view.width as usize * view.height as usize).any(meets)
}

/// From where to where a ray is in the box 0..1, in lengths of its direction; nowhere where the second is not the greater.
fn span(from: DVec3, along: DVec3) -> [f64; 2] {
    (0..3).fold([0.0, f64::INFINITY], |[begin, end]: [f64; 2], axis| {
        let (from, along) = (from[axis], along[axis]);
        if along.abs() < 1e-30 {
            return if (0.0..=1.0).contains(&from) { [begin, end] } else { [begin, f64::NEG_INFINITY] };
        }
        let sides = [-from / along, (1.0 - from) / along];
        [begin.max(sides[0].min(sides[1])), end.min(sides[0].max(sides[1]))]
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::core::{Camera, DepthRange, OrthographicView, PerspectiveView, View};
    use glam::{Mat4, Vec3};

    #[test]
    fn views_that_look_elsewhere_or_end_before_it_see_nothing() {
        let placed = Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0)) * Mat4::from_translation(Vec3::splat(-0.5));
        let view =
            |view: View| SliceView::new(&Camera::new(&view, [8, 6]).unwrap(), placed, [8; 3], 8).unwrap();
        let depth = DepthRange::Reversed;
        let eye = Vec3::new(0.0, 0.0, 4.0);
        let perspective = |eye: Vec3, target: Vec3| {
            view(PerspectiveView { eye, target, field_of_view: 20.0, near: 0.1, far: 20.0, depth }.into())
        };
        assert!(meets_volume(&perspective(eye, Vec3::ZERO), None));
        assert!(meets_volume(&perspective(Vec3::ZERO, eye), None), "from within");
        assert!(!meets_volume(&perspective(eye, Vec3::new(0.0, 0.0, 9.0)), None), "behind");
        assert!(!meets_volume(&perspective(eye, Vec3::new(4.0, 0.0, 0.0)), None), "beside");
        let parallel = |y: f32| {
            let (eye, target) = (Vec3::new(0.0, y, 4.0), Vec3::new(0.0, y, 0.0));
            view(OrthographicView { eye, target, height: 0.5, near: 0.0, far: 20.0, depth }.into())
        };
        assert!(meets_volume(&parallel(0.6), None) && !meets_volume(&parallel(0.8), None));
        // The box begins 3.5 m from the eye.
        let seen = perspective(eye, Vec3::ZERO);
        let mut depths = vec![3.4; 48];
        assert!(!meets_volume(&seen, Some(&depths)));
        depths[20] = 3.8;
        assert!(meets_volume(&seen, Some(&depths)));
        assert!(meets_volume(&seen, Some(&[f32::INFINITY; 48])));
    }
}
