// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light of simple maps, over hemispheres and caps.

use super::*;

/// The upper half of the sky as bright as it is high.
fn heights() -> Environment {
    Environment::from_function(128, |d| [d.y.max(0.0), (-d.y).max(0.0), d.x.max(0.0)])
}

/// Texels that differ by any amount.
fn chequers(height: usize) -> Environment {
    let texel = |i: usize| {
        let value = |k: usize| ((i * 7919 + k * 104_729) % 1009) as f64 / 1009.0;
        [value(1), value(2).powi(4), 1.0]
    };
    Environment::new(height, (0..2 * height * height).map(texel).collect())
}

/// By hand from the convention, not from the formulas.
#[test]
fn a_marked_texel_is_seen_where_the_convention_says() {
    for ([x, y], direction) in [
        ([7, 4], [-0.01, -0.01, -1.0]),
        ([8, 3], [0.2, 0.2, -1.0]),
        ([12, 3], [1.0, 0.2, 0.2]),
        ([11, 3], [1.0, 0.2, -0.2]),
        ([4, 4], [-1.0, -0.2, -0.2]),
        ([15, 4], [0.2, -0.2, 1.0]),
        ([0, 4], [-0.2, -0.2, 1.0]),
        ([12, 0], [0.4, 3.0, 0.1]),
        ([8, 7], [0.1, -3.0, -0.4]),
    ] {
        let mut texels = vec![[0.0; 3]; 128];
        texels[y * 16 + x] = [1.0, 2.0, 3.0];
        let map = Environment::new(8, texels);
        let direction = Vec3::from(direction).normalised();
        assert_eq!(map.radiance(direction), [1.0, 2.0, 3.0], "{direction:?}");
        assert_eq!(map.radiance(-direction), [0.0; 3]);
        assert_eq!(map.radiance(map.direction(x as f64 + 0.5, y as f64 + 0.5)), [1.0, 2.0, 3.0]);
    }
}

#[test]
fn the_integral_is_that_of_the_sphere() {
    for (value, expected) in heights().integral().into_iter().zip([PI, PI, PI]) {
        near(value, expected, 1e-3);
    }
}

/// Smaller maps have the same light, parts of texels included, and larger ones say the same.
#[test]
fn resized_maps_keep_their_light() {
    let map = chequers(48);
    for height in [16, 7, 100] {
        let resized = map.resized(height);
        assert_eq!(resized.height(), height);
        for (value, expected) in resized.integral().into_iter().zip(map.integral()) {
            near(value, expected, 1e-9);
        }
    }
    for (a, b) in map.resized(96).texels().iter().zip(map.resized(48).texels()) {
        assert!(a.iter().chain(b).all(|c| (0.0..=1.0 + 1e-12).contains(c)));
    }
    let twice = map.resized(96);
    for x in 0..192 {
        for (a, b) in twice.texels()[37 * 192 + x].iter().zip(map.texels()[18 * 96 + x / 2]) {
            near(*a, b, 1e-12);
        }
    }
    // Rows near the pole count less: two rows of one column pair, by their solid angles.
    let rows = [[1.0; 3], [0.0; 3]].map(|texel| vec![texel; 8]);
    let map = Environment::new(4, [rows[0].clone(), rows[1].clone(), rows[1].repeat(2)].concat());
    let share = (1.0 - 45.0_f64.to_radians().cos()) / 1.0;
    near(map.resized(2).texels()[0][0], share, 1e-12);
}

/// (1/π) ∫ ω_y² over the upper hemisphere is 2/3, (1/π) ∫ ω_x ω_y over the quarter sphere 2 / (3π).
#[test]
fn irradiance_of_known_skies() {
    let (map, pattern) = (heights(), Pattern::new(16384));
    let quarter = 2.0 / (3.0 * PI);
    for (normal, expected) in [
        (UP, [2.0 / 3.0, 0.0, quarter]),
        (-UP, [0.0, 2.0 / 3.0, quarter]),
        (Vec3::new(1.0, 0.0, 0.0), [quarter, quarter, 2.0 / 3.0]),
        (Vec3::new(0.0, 0.0, -1.0), [quarter; 3]),
    ] {
        for (value, expected) in map.irradiance(normal, &pattern).into_iter().zip(expected) {
            near(value, expected, 1e-3);
        }
    }
}

/// Erratum of Eq. 3.9: constant light is the same in all cones with 1 / sin² α, with the printed t it is 1 + cos α.
#[test]
fn constant_light_is_equal_in_all_cones_with_the_corrected_normalisation() {
    let (map, pattern) = (Environment::from_function(16, |_| [3.0, 1.0, 0.0]), Pattern::new(1024));
    let axis = Vec3::new(0.36, 0.48, -0.8);
    for degrees in [0.0_f64, 0.01, 1.0, 10.0, 30.0, 45.0, 66.0, 80.0, 90.0] {
        let angle = degrees.to_radians();
        let light = |t| map.cone(axis, angle, t, &pattern);
        let (projected, printed) = (light(Normalisation::Projected), light(Normalisation::Printed));
        for (c, radiance) in [3.0, 1.0, 0.0].into_iter().enumerate() {
            near(projected[c], radiance, 1e-9);
            near(printed[c], radiance * (1.0 + angle.cos()), 1e-9);
        }
    }
}

/// (1/π) ∫ ω_y² over the cap about y is (2/3) (1 − cos³ α).
#[test]
fn cones_of_a_known_sky() {
    let (map, pattern) = (heights(), Pattern::new(16384));
    for degrees in [5.0_f64, 20.0, 45.0, 70.0, 90.0] {
        let angle = degrees.to_radians();
        let integral = 2.0 / 3.0 * (1.0 - angle.cos().powi(3));
        let light = |t| map.cone(UP, angle, t, &pattern)[0];
        near(light(Normalisation::Projected), integral / angle.sin().powi(2), 1e-3);
        near(light(Normalisation::Printed), integral / (1.0 - angle.cos()), 2e-3);
    }
}

/// Against sums over small parts of the texels, which know nothing of caps.
#[test]
fn cones_agree_with_sums_over_texels() {
    const PARTS: usize = 24;
    let (map, pattern) = (chequers(16), Pattern::new(1 << 16));
    let (width, height) = (32 * PARTS, 16 * PARTS);
    for (axis, degrees) in [(Vec3::new(0.0, 0.0, 1.0), 90.0_f64), (Vec3::new(-0.48, 0.8, 0.36), 40.0)] {
        let angle = degrees.to_radians();
        let mut sum = [0.0; 3];
        for y in 0..height {
            let edge = |y: usize| (PI * y as f64 / height as f64).cos();
            let solid_angle = TAU / width as f64 * (edge(y) - edge(y + 1));
            for x in 0..width {
                let place = [x, y].map(|i| (i as f64 + 0.5) / PARTS as f64);
                let cosine = map.direction(place[0], place[1]).dot(axis);
                if cosine > angle.cos().max(0.0) {
                    let texel = map.texels()[y / PARTS * 32 + x / PARTS];
                    sum = [0, 1, 2].map(|c| sum[c] + texel[c] * cosine * solid_angle);
                }
            }
        }
        let cone = map.cone(axis, angle, Normalisation::Projected, &pattern);
        for (value, sum) in cone.into_iter().zip(sum) {
            near(value, sum / (PI * angle.sin().powi(2)), 2e-3);
        }
    }
}
