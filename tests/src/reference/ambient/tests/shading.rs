// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light and visibility together.

use super::*;
use crate::reference::camera::{Camera, View};

/// A sky that is open in a cap of this half angle about `axis`.
fn cap(axis: Vec3, angle: f64, pattern: &Pattern) -> Vec<Sample> {
    samples(UP, pattern, 0.0, |d| f64::from(u8::from(d.dot(axis) > angle.cos())))
}

fn tilted(degrees: f64) -> Vec3 {
    let tilt = degrees.to_radians();
    Vec3::new(0.6 * tilt.sin(), tilt.cos(), 0.8 * tilt.sin())
}

/// Closed forms of an open plane: constant light, and light as high as it is bright.
#[test]
fn an_open_plane_sends_out_the_irradiance() {
    let map = Environment::from_function(128, |d| [0.7, d.y.max(0.0), d.x.max(0.0)]);
    let pattern = Pattern::new(8192);
    let samples = samples(UP, &pattern, 0.0, |_| 1.0);
    let expected = [0.7, 2.0 / 3.0, 2.0 / (3.0 * PI)];
    for (value, expected) in outgoing(&map, UP, &samples).into_iter().zip(expected) {
        near(value, expected, 1e-3);
    }
    let statistics = Statistics::of(UP, &samples);
    for brightness in [Brightness::Uniform, Brightness::Printed, Brightness::Cosine] {
        for angle in [Angle::Thesis, Angle::Exact] {
            let made = approximations(&map, UP, &statistics, angle, brightness, &pattern);
            for method in [made.occlusion, made.normals, made.cones] {
                for (value, expected) in method.into_iter().zip(expected) {
                    near(value, expected, 3e-3);
                }
            }
        }
    }
}

/// In constant light the cosine-weighted share is right for all methods and any visibility, here of a hundred slits.
#[test]
fn constant_light_is_exact_with_the_cosine_weighted_share() {
    let map = Environment::from_function(4, |_| [2.0, 1.0, 0.5]);
    let pattern = Pattern::new(2048);
    let slits = samples(UP, &pattern, 0.0, |d| (40.0 * d.x + 13.0 * d.y).sin().max(0.0));
    let statistics = Statistics::of(UP, &slits);
    let truth = outgoing(&map, UP, &slits);
    assert!(truth[0] > 0.1 && truth[0] < 1.9, "{truth:?}");
    for angle in [Angle::Thesis, Angle::Exact] {
        let made = approximations(&map, UP, &statistics, angle, Brightness::Cosine, &pattern);
        for method in [made.occlusion, made.normals, made.cones] {
            for (value, truth) in method.into_iter().zip(truth) {
                near(value / truth, 1.0, 1e-9);
            }
        }
    }
}

/// A cap above the horizon in constant light: the truth is sin² α ⟨N, n⟩; ⟨ω, N⟩ ⟨N, n⟩ integrates to the same; A ⟨N, n⟩ L_c
/// is right with the printed t and too dark by 1 + cos α with the corrected one.
#[test]
fn the_geometric_term_is_exact_for_caps_above_the_horizon() {
    let map = Environment::from_function(4, |_| [1.0; 3]);
    let pattern = Pattern::new(1 << 15);
    for (tilt, degrees) in [(0.0, 20.0), (20.0, 45.0), (45.0, 30.0), (60.0, 28.0)] {
        let (axis, alpha) = (tilted(tilt), f64::to_radians(degrees));
        let open = cap(axis, alpha, &pattern);
        let truth = outgoing(&map, UP, &open)[0];
        near(truth / (alpha.sin().powi(2) * axis.y), 1.0, 4e-3);
        let inside = open.iter().filter(|s| s.visibility > 0.0);
        let factored: f64 = inside.map(|s| s.direction.dot(axis) * axis.y).sum();
        near(truth / (2.0 * factored / pattern.count() as f64), 1.0, 4e-3);
        let statistics = Statistics::of(UP, &open);
        let cones =
            |brightness| approximations(&map, UP, &statistics, Angle::Exact, brightness, &pattern).cones[0];
        near(cones(Brightness::Printed) / truth, 1.0, 4e-3);
        near(cones(Brightness::Uniform) / truth, 1.0 / (1.0 + alpha.cos()), 4e-3);
        near(cones(Brightness::Cosine) / truth, 1.0, 1e-9);
    }
}

/// A cap that the horizon cuts: what lies above it of 66 degrees about 45 gives 1.037 of the factored term.
#[test]
fn the_geometric_term_is_near_where_the_horizon_cuts_the_cap() {
    let pattern = Pattern::new(1 << 16);
    let (axis, alpha) = (tilted(45.0), 66.0_f64.to_radians());
    let (mut exact, mut factored) = (0.0, 0.0);
    for sample in cap(axis, alpha, &pattern).iter().filter(|s| s.visibility > 0.0) {
        exact += sample.direction.y;
        factored += sample.direction.dot(axis) * axis.y;
    }
    near(exact / factored, 1.037, 2e-3);
}

/// In a pit under a sky that brightens to one side all light of the cone is right for exact angles, and cones see what
/// normals cannot: the rim hides the bright horizon.
#[test]
fn cones_gather_the_light_that_a_pit_lets_in() {
    let map = Environment::from_function(128, |d| [1.0 - d.y.clamp(0.0, 1.0).powi(2), d.y.max(0.0), 1.0]);
    let alpha = 40.0_f64.to_radians();
    let scene = Scene::new([plane(0.0), pit(alpha, 1.0)].concat());
    let pattern = Pattern::new(16384);
    let samples = trace(&scene, ORIGIN, UP, &pattern, 0.0, Reach::UNLIMITED);
    let truth = outgoing(&map, UP, &samples);
    // (1/π) ∫ over the cap of (1 − cos²) cos and of cos².
    let c = alpha.cos();
    let expected =
        [alpha.sin().powi(2) - 0.5 * (1.0 - c.powi(4)), 2.0 / 3.0 * (1.0 - c.powi(3)), alpha.sin().powi(2)];
    for (value, expected) in truth.into_iter().zip(expected) {
        near(value / expected, 1.0, 0.01);
    }
    let statistics = Statistics::of(UP, &samples);
    let made = approximations(&map, UP, &statistics, Angle::Exact, Brightness::Cosine, &pattern);
    for ((cone, normal), truth) in made.cones.into_iter().zip(made.normals).zip(truth).take(2) {
        near(cone / truth, 1.0, 0.01);
        assert!((normal / truth - 1.0).abs() > 0.2, "{normal} {truth}");
    }
}

/// A floor with a ball on it: what is hit, that rows are in order, and that the truth is a single trace's.
#[test]
fn pictures_are_those_of_single_points() {
    let scene = Scene::new([plane(0.0), ball(Vec3::new(0.0, 1.0, 0.0), 1.0)].concat());
    let camera = Camera::perspective(&View {
        eye: Vec3::new(0.0, 1.5, 6.0),
        target: Vec3::new(0.0, 1.0, 0.0),
        up: UP,
        fov_y: 0.8,
        aspect: 1.5,
        near: 0.1,
        far: f64::INFINITY,
        reversed: true,
    });
    let (width, height) = (24, 16);
    let found = surfaces(&scene, &camera, width, height);
    let ball_above = found[8 * width + 12].expect("the ball");
    near((ball_above.position - UP).length(), 1.0, 1e-3);
    assert!(between(ball_above.normal, ball_above.position - UP) < 2.0);
    assert!(found[3].is_none() && found[15 * width].is_some_and(|s| s.normal == UP));

    let settings = Settings {
        directions: 512,
        light_directions: 256,
        reach: Reach::UNLIMITED,
        lift: 0.0,
        angle: Angle::Exact,
        brightness: Brightness::Cosine,
    };
    let map = Environment::from_function(8, |_| [1.0, 0.5, 0.0]);
    let pixels = picture(&scene, &map, &found, width, &settings);
    assert_eq!(pixels.len(), found.len());
    for (place, (pixel, surface)) in pixels.iter().zip(&found).enumerate() {
        let Some(pixel) = pixel else {
            assert!(surface.is_none());
            continue;
        };
        assert_eq!(Some(pixel.surface), *surface);
        near(pixel.truth[0], pixel.statistics.open_cosine, 1e-12);
        near(pixel.truth[1], 0.5 * pixel.truth[0], 1e-12);
        near(pixel.approximations.cones[0], pixel.truth[0], 1e-9);
        // The closed form of the ball seen from the floor.
        if pixel.surface.position.y == 0.0 {
            let towards = UP - pixel.surface.position;
            let hidden = towards.dot(UP) / towards.length().powi(3);
            near(pixel.statistics.open_cosine, 1.0 - hidden, 0.02 + 0.05 * hidden);
        } else {
            assert!(place / width > 2, "the ball does not reach the upper rows");
        }
    }
}
