// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras between those of two views.

use super::views::ViewDescription;
use crate::core::{Camera, DepthRange, OrthographicView, PerspectiveView, View};
use glam::{Quat, Vec3};

/// The camera half-way: it looks at the middle of both targets, from half the turn about it. None where there is no such camera, as
/// between two whose directions that are up oppose each other. Of a perspective and a parallel one the first says which.
pub fn between(first: &ViewDescription, second: &ViewDescription) -> Option<Camera> {
    let [from, to] = [first.view, second.view].map(|view| view.eye() - view.target());
    let up = match (first.up, second.up) {
        (None, None) => None,
        (first, second) => Some((upright(first) + upright(second)).try_normalize()?),
    };
    let target = first.view.target().midpoint(second.view.target());
    let way = half_way(from.try_normalize()?, to.try_normalize()?, up.unwrap_or(Vec3::Y));
    let eye = target + way * (0.5 * (from.length() + to.length()));
    let planes = [first, second].map(|of| match of.view {
        View::Perspective(view) => [view.near, view.far],
        View::Orthographic(view) => [view.near, view.far],
    });
    let (near, far) = (planes[0][0].min(planes[1][0]), planes[0][1].max(planes[1][1]));
    let depth = DepthRange::Forward;
    let view: View = match (first.view, second.view) {
        (View::Perspective(one), other) => {
            let own = one.field_of_view;
            let field_of_view = 0.5 * (own + other.perspective().map_or(own, |other| other.field_of_view));
            PerspectiveView { eye, target, field_of_view, near, far, depth }.into()
        }
        (View::Orthographic(one), other) => {
            let height = match other {
                View::Orthographic(other) => 0.5 * (one.height + other.height),
                View::Perspective(_) => one.height,
            };
            OrthographicView { eye, target, height, near, far, depth }.into()
        }
    };
    match up {
        Some(up) => Camera::with_up(&view, up, first.size).ok(),
        None => Camera::new(&view, first.size).ok(),
    }
}

fn upright(up: Option<Vec3>) -> Vec3 {
    up.and_then(Vec3::try_normalize).unwrap_or(Vec3::Y)
}

/// The direction half-way between two; between opposite ones round the upright axis.
fn half_way(from: Vec3, to: Vec3, up: Vec3) -> Vec3 {
    if from.dot(to) < -0.999 {
        let axis =
            (up - up.dot(from) * from).try_normalize().unwrap_or_else(|| from.any_orthonormal_vector());
        return Quat::from_axis_angle(axis, std::f32::consts::FRAC_PI_2) * from;
    }
    (from + to).normalize_or(from)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::command::inverse::views::parse_views;

    #[test]
    fn the_camera_goes_round_what_it_looks_at() {
        let view = |name: &str, camera: &str| {
            format!(
                "[[view]]\nname = \"{name}\"\nsize = [40, 30]\ncamera = {{ target = [0, 0, 0], {camera} }}\n"
            )
        };
        let text = [
            view("a", "eye = [0, 0, 4], field_of_view = 30"),
            view("b", "eye = [6, 0, 0], field_of_view = 50"),
            view("c", "eye = [0, 0, -4], height = 2"),
            view("d", "eye = [0, 0, 4], field_of_view = 30, up = [1, 0, 0]"),
            view("e", "eye = [0, 0, 4], field_of_view = 30, up = [-1, 0, 0]"),
        ];
        let views = parse_views("v.toml", &text.concat()).unwrap().list;
        let eye = |i: usize, j: usize| between(&views[i], &views[j]).unwrap().eye;
        assert!(eye(0, 1).distance(Vec3::new(5.0, 0.0, 5.0) * 0.5_f32.sqrt()) < 1e-5, "{}", eye(0, 1));
        assert!(eye(0, 2).distance(Vec3::new(4.0, 0.0, 0.0)) < 1e-5, "{}", eye(0, 2));
        assert_eq!(between(&views[2], &views[0]).unwrap().projection, 1);
        let camera = between(&views[0], &views[1]).unwrap();
        // Of 40 degrees.
        let edge =
            camera.clip_from_world.project_point3(Vec3::new(0.0, 5.0 * 20_f32.to_radians().tan(), 0.0));
        assert!((edge.y - 1.0).abs() < 1e-5, "{edge}");
        assert!(between(&views[3], &views[3]).unwrap().clip_from_world.project_point3(0.1 * Vec3::X).y > 0.0);
        assert!(between(&views[3], &views[4]).is_none());
    }
}
