// SPDX-License-Identifier: MIT OR Apache-2.0
use super::*;

/// Numbers in [0, 1) of a linear congruence.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Triangles of all sizes and some without an area.
fn soup(count: usize) -> Vec<Triangle> {
    let mut next = numbers(7);
    let mut point = |size: f64| Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * size;
    (0..count)
        .map(|i| {
            let (corner, size) = (point(4.0), if i % 10 == 0 { 3.0 } else { 0.3 });
            let (first, second) = (point(size), point(size));
            let second = if i % 17 == 0 { first * 2.0 } else { second };
            Triangle::flat([corner, corner + first, corner + second])
        })
        .collect()
}

/// Distance by the volumes of tetrahedra: not the test that the scene uses.
fn distance(triangle: &Triangle, origin: Vec3, direction: Vec3) -> Option<f64> {
    let [a, b, c] = triangle.positions.map(|p| p - origin);
    let normal = (b - a).cross(c - a);
    let t = a.dot(normal) / direction.dot(normal);
    let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|v| v.dot(direction));
    let inside = volumes.iter().all(|v| *v >= 0.0) || volumes.iter().all(|v| *v <= 0.0);
    (inside && t > 0.0).then_some(t)
}

#[test]
fn the_nearest_triangle_is_that_of_a_loop_over_all() {
    let triangles = soup(400);
    let scene = Scene::new(triangles.clone());
    let mut next = numbers(11);
    let mut met = 0;
    for ray in 0..4000 {
        let far = if ray % 3 == 0 { 15.0 } else { 4.0 };
        let origin = Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * far;
        let towards = Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * 4.0;
        let mut direction = (towards - origin).normalised();
        if ray % 5 == 0 {
            direction = Vec3::new(0.0, direction.y.signum(), 0.0);
        }
        let expected = triangles
            .iter()
            .enumerate()
            .filter_map(|(i, triangle)| Some((distance(triangle, origin, direction)?, i)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = scene.hit(origin, direction);
        assert_eq!(hit.map(|hit| hit.triangle), expected.map(|(_, i)| i), "ray {ray}");
        let Some((hit, (t, _))) = hit.zip(expected) else {
            assert!(!scene.occluded(origin, direction, f64::INFINITY));
            continue;
        };
        met += 1;
        assert!((hit.distance - t).abs() < 1e-9, "ray {ray}: {} {t}", hit.distance);
        assert!((scene.position(&hit) - origin - direction * t).length() < 1e-9);
        assert!(scene.occluded(origin, direction, f64::INFINITY));
        assert!(scene.occluded(origin, direction, t * (1.0 + 1e-9)));
        assert!(!scene.occluded(origin, direction, t * (1.0 - 1e-9)));
        assert_eq!(scene.hit_within(origin, direction, t * (1.0 - 1e-9)), None);
    }
    assert!(met > 2000, "{met} of 4000 rays met anything");
}

/// Boxes of no height and edges that rays go through exactly: a chequered floor has no gaps.
#[test]
fn a_floor_of_triangles_has_no_gaps() {
    let corner = |x: i32, z: i32| Vec3::new(f64::from(x), 0.3, f64::from(z));
    let floor = (-8..8).flat_map(|x| {
        (-8..8).flat_map(move |z| {
            let [a, b, c, d] = [corner(x, z), corner(x, z + 1), corner(x + 1, z + 1), corner(x + 1, z)];
            [Triangle::flat([a, b, c]), Triangle::flat([a, c, d])]
        })
    });
    let scene = Scene::new(floor.collect());
    let eye = Vec3::new(0.0, 5.3, 0.0);
    for i in -20..=20 {
        for j in -20..=20 {
            let target = Vec3::new(f64::from(i) * 0.25, 0.3, f64::from(j) * 0.25);
            let direction = (target - eye).normalised();
            let hit = scene.hit(eye, direction).expect("the floor");
            assert!((scene.position(&hit) - target).length() < 1e-12);
            // From below the normal is turned, and on the floor the floor is not in the way.
            assert_eq!(scene.normal(&hit, direction), Vec3::new(0.0, 1.0, 0.0));
            assert_eq!(scene.normal(&hit, -direction), Vec3::new(0.0, -1.0, 0.0));
            assert!(!scene.occluded(target, -direction, f64::INFINITY));
            assert!(!scene.occluded(target, direction, f64::INFINITY));
        }
    }
}

#[test]
fn normals_are_weighted_and_cancelled_ones_replaced() {
    let positions = [Vec3::default(), Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0)];
    let down = Vec3::new(0.0, -1.0, 0.0);
    let bent = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 0.0)];
    let at = |normals| {
        let scene = Scene::new(vec![Triangle { positions, normals }]);
        let hit = scene.hit(Vec3::new(0.5, 1.0, 0.25), down).expect("the triangle");
        assert!(hit.barycentric.iter().zip([0.25, 0.25, 0.5]).all(|(a, b)| (a - b).abs() < 1e-12));
        scene.normal(&hit, down)
    };
    let expected = Vec3::new(0.5, 1.0, 0.25).normalised();
    assert!((at(bent) - expected).length() < 1e-12);
    assert!((at(bent.map(|n| -n)) - expected).length() < 1e-12);
    assert_eq!(at([Vec3::default(); 3]), Vec3::new(0.0, 1.0, 0.0));
}

#[test]
fn nothing_is_met_where_nothing_is() {
    let scene = Scene::new(vec![]);
    assert_eq!(scene.hit(Vec3::default(), Vec3::new(0.0, 0.0, 1.0)), None);
    assert!(!scene.occluded(Vec3::default(), Vec3::new(0.0, 0.0, 1.0), 3.0));
}
