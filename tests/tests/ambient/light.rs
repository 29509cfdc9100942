// SPDX-License-Identifier: MIT OR Apache-2.0
//! Preconvolved light: environment maps in cones of eight angles, against closed forms and sums in f64.

use crate::cones::{
    Cones, LAYERS, cones_of, layer_angle, lit, look_up, real_map, reference_map, texel_direction,
};
use crate::gpu::{Random, gpu, shaders, texture, vector};
use airlight::ambient::{ConeLight, ConeLightError, ConeLightForm};
use airlight::data::Environment;
use airlight_tests::linear::Vec3 as Point;
use airlight_tests::parallel::rows;
use airlight_tests::reference::ambient::{Normalisation, Pattern, Rgb};
use glam::Vec3;

/// Every texel and layer, with its direction.
fn each(cones: &Cones, mut check: impl FnMut(usize, Point, Rgb)) {
    for layer in 0..LAYERS {
        for y in 0..cones.side {
            for x in 0..cones.side {
                check(layer, texel_direction(x, y, cones.side), cones.texel(layer, x, y));
            }
        }
    }
}

#[test]
fn constant_light_is_the_same_in_all_cones() {
    let color = Vec3::new(3.0, 0.25, 700.0);
    for size in [[2, 1], [50, 25], [256, 128], [600, 300]] {
        let map = Environment::from_function(size, |_| color).unwrap();
        // Half floats once, or at each of six levels and in the result, where some drivers cut what others round.
        for (sampled, bound) in [(false, 1e-3), (true, 5e-3)] {
            let cones = Cones::of(&lit(&map, 16, sampled));
            each(&cones, |layer, direction, light| {
                for (value, expected) in light.into_iter().zip([3.0, 0.25, 700.0]) {
                    let error = value / expected - 1.0;
                    assert!(error.abs() < bound, "{size:?} {sampled} {layer} {direction:?}: {light:?}");
                }
            });
        }
    }
}

/// The mean of the cosine under the weight cos over the cap of half angle α is (2/3) (1 − cos³ α) / sin² α.
#[test]
fn light_linear_in_the_direction_has_its_closed_form() {
    let slopes = [Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.0, 1.0, 0.0), Vec3::new(-0.48, -0.64, 0.6)];
    let map = Environment::from_function([1024, 512], |d| 1.0 + Vec3::from(slopes.map(|slope| slope.dot(d))));
    let map = map.unwrap();
    for (sampled, bound) in [(false, 1.5e-3), (true, 0.01)] {
        let mut worst = 0.0_f64;
        each(&Cones::of(&lit(&map, 33, sampled)), |layer, direction, light| {
            let angle = layer_angle(layer);
            let share = 2.0 / 3.0 * (1.0 - angle.cos().powi(3)) / angle.sin().powi(2);
            for (value, slope) in light.into_iter().zip(slopes) {
                worst = worst.max((value - 1.0 - share * vector(slope).dot(direction)).abs());
            }
        });
        println!("linear light, sampled {sampled}: worst {worst:.5}");
        assert!(worst < bound, "sampled {sampled}: {worst}");
    }
}

/// The upper half of the sky, as bright as it is high: cones about the zenith, and beyond the horizon.
#[test]
fn half_a_sky_has_its_closed_forms() {
    let map = Environment::from_function([512, 256], |d| Vec3::splat(d.y.max(0.0))).unwrap();
    let light = lit(&map, 65, false);
    let cones = Cones::of(&light);
    for layer in 0..LAYERS {
        let angle = layer_angle(layer);
        let [zenith, nadir] = [[32, 32], [0, 0]].map(|[x, y]| cones.texel(layer, x, y)[0]);
        let expected = 2.0 / 3.0 * (1.0 - angle.cos().powi(3)) / angle.sin().powi(2);
        assert!((zenith - expected).abs() < 2e-3, "{layer}: {zenith}, not {expected}");
        // Texels of the horizon are half above it.
        assert!(nadir < if layer == 7 { 1e-4 } else { 1e-30 }, "{layer}: {nadir}");
    }
    // Of a surface upright: (1/π) ∫ ω_x ω_y over a quarter of the sphere.
    let upright = 2.0 / (3.0 * std::f64::consts::PI);
    for [x, y] in [[64, 32], [0, 32], [32, 0], [32, 64]] {
        let found = cones.texel(7, x, y)[0];
        assert!((found - upright).abs() < 2e-3, "{found}, not {upright}");
    }
}

/// Two sums that know nothing of each other: over texels, and over the directions of a pattern.
#[test]
fn the_sum_over_texels_is_the_references_integral() {
    let chequers = |d: Vec3| Vec3::new((3.0 * d.x).floor() + 3.0, (d * 5.0).z.floor() + 5.0, d.y + 1.0);
    let map = reference_map(&Environment::from_function([512, 256], chequers).unwrap());
    let pattern = Pattern::new(1 << 17);
    for axis in [[0.0, 1.0, 0.0], [0.48, -0.6, 0.64], [-0.8, 0.0, 0.6]].map(Point::from) {
        for (layer, light) in cones_of(&map, axis).into_iter().enumerate() {
            let expected = map.cone(axis, layer_angle(layer), Normalisation::Projected, &pattern);
            for (value, expected) in light.into_iter().zip(expected) {
                assert!(
                    (value - expected).abs() < 5e-3 * expected.max(1.0),
                    "{layer}: {value}, not {expected}"
                );
            }
        }
    }
}

/// What is wrong with a layer: root of the mean square and the greatest, over the mean.
fn errors(pairs: &[(Rgb, Rgb)]) -> [f64; 2] {
    let count = (3 * pairs.len()) as f64;
    let mean = pairs.iter().flat_map(|(_, exact)| exact).sum::<f64>() / count;
    let differences = pairs.iter().flat_map(|(found, exact)| [0, 1, 2].map(|c| (found[c] - exact[c]).abs()));
    let square = differences.clone().map(|d| d * d).sum::<f64>() / count;
    [square.sqrt() / mean, differences.fold(0.0, f64::max) / mean]
}

/// Both forms at the middles of texels.
#[test]
fn real_maps_are_convolved_as_in_f64() {
    const SIDE: usize = 65;
    for name in ["forest.exr", "sunset.exr"] {
        let map = real_map(name);
        let reference = reference_map(&map);
        let places: Vec<[usize; 2]> =
            (0..SIDE * SIDE).step_by(19).map(|place| [place % SIDE, place / SIDE]).collect();
        let exact =
            rows(places.len(), |i| cones_of(&reference, texel_direction(places[i][0], places[i][1], SIDE)));
        for (sampled, most) in [(false, [0.01, 0.1]), (true, [0.1, 1.0])] {
            let cones = Cones::of(&lit(&map, SIDE as u32, sampled));
            for layer in 0..LAYERS {
                let found = places.iter().map(|[x, y]| cones.texel(layer, *x, *y));
                let pairs: Vec<_> = found.zip(exact.iter().map(|cones| cones[layer])).collect();
                let [square, worst] = errors(&pairs);
                println!("{name} sampled {sampled} layer {layer}: RMS {square:.5}, worst {worst:.5}");
                assert!(
                    square < most[0] && worst < most[1],
                    "{name} sampled {sampled} {layer}: {square} {worst}"
                );
            }
        }
    }
}

/// Records of look-ups in these directions.
fn towards(directions: &[Point], angle: f64) -> Vec<[f32; 7]> {
    let record = |d: &Point| [d.x, d.y, d.z, angle, 0.0, 1.0, 0.0].map(|x| x as f32);
    directions.iter().map(record).collect()
}

const CONE: &str = "cone_radiance(cones, cone_sampler, direction, angle)";

/// A map whose texels have nothing in common, so that a seam shows.
fn noise() -> Environment {
    let mut random = Random(31);
    let texel = |_| Vec3::from([0; 3].map(|_| random.unit() as f32));
    Environment::new([64, 32], (0..64 * 32).map(texel).collect()).unwrap()
}

#[test]
fn nothing_shows_where_the_maps_edges_meet() {
    for (side, sampled) in [(8, false), (31, false), (32, true)] {
        let light = lit(&noise(), side, sampled);
        let cones = Cones::of(&light);
        // Four edges in the planes x = 0 and z = 0 below the horizon, and the corners about the nadir.
        let mut random = Random(5);
        let mut pairs = [Vec::new(), Vec::new()];
        for i in 0..400 {
            let (along, below) = (random.between(-1.0, 1.0), random.between(0.0, 1.0));
            for (pair, apart) in pairs.iter_mut().zip([1e-5, -1e-5]) {
                let (x, z) = if i % 2 == 0 { (along, apart) } else { (apart, along) };
                pair.push(Point::new(x, -below, z).normalised());
            }
        }
        for angle in [layer_angle(0), layer_angle(3)] {
            let [first, second] = pairs.each_ref().map(|pair| look_up(&light, CONE, &towards(pair, angle)));
            for (i, (a, b)) in first.iter().zip(&second).enumerate() {
                let apart = (Vec3::from(*a) - Vec3::from(*b)).abs().max_element();
                assert!(apart < 2e-3, "{side}: {apart} across the edge at {:?}", pairs[0][i]);
            }
        }
        // That the map has something to show: neighbours differ by far more.
        let side = side as usize;
        let step = (0..side - 1).map(|x| (cones.texel(0, x, 0)[0] - cones.texel(0, x + 1, 0)[0]).abs());
        assert!(step.fold(0.0, f64::max) > 0.01);
        // Texels of an edge have their twins, turned by half a turn about the middle of the edge.
        for layer in 0..LAYERS {
            for i in 0..side {
                let mirror = side - 1 - i;
                assert_eq!(cones.texel(layer, 0, i), cones.texel(layer, 0, mirror));
                assert_eq!(cones.texel(layer, side - 1, i), cones.texel(layer, side - 1, mirror));
                assert_eq!(cones.texel(layer, i, 0), cones.texel(layer, mirror, 0));
                assert_eq!(cones.texel(layer, i, side - 1), cones.texel(layer, mirror, side - 1));
            }
        }
    }
}

#[test]
fn look_ups_find_directions_and_angles() {
    let map = real_map("forest.exr").texels().to_vec();
    let map = Environment::new([512, 256], map).unwrap();
    let light = lit(&map, 65, false);
    let cones = Cones::of(&light);
    let relative = |found: [f32; 3], expected: Rgb| -> f64 {
        let largest = expected.into_iter().fold(0.0, f64::max);
        (0..3).map(|c| (f64::from(found[c]) - expected[c]).abs() / largest).fold(0.0, f64::max)
    };
    // At the middles of texels nothing is interpolated within a layer.
    let places: Vec<[usize; 2]> = (0..65 * 65).step_by(37).map(|place| [place % 65, place / 65]).collect();
    let directions: Vec<Point> =
        places.iter().map(|[x, y]| texel_direction(*x, *y, 65) * (0.01 + *x as f64)).collect();
    let degree = std::f64::consts::PI / 180.0;
    for (angle, layers, share) in [
        (0.0, [0, 0], 0.0),
        (5.0, [0, 0], 0.0),
        (11.25, [0, 0], 0.0),
        (14.0625, [0, 1], 0.25),
        (45.0, [3, 3], 0.0),
        (84.375, [6, 7], 0.5),
        (90.0, [7, 7], 0.0),
        (120.0, [7, 7], 0.0),
        (f64::NAN, [7, 7], 0.0),
        (-3.0, [0, 0], 0.0),
    ] {
        let found = look_up(&light, CONE, &towards(&directions, angle * degree));
        for (found, [x, y]) in found.into_iter().zip(&places) {
            let [narrow, wide] = layers.map(|layer| cones.texel(layer, *x, *y));
            let expected = [0, 1, 2].map(|c| narrow[c] + share * (wide[c] - narrow[c]));
            assert!(relative(found, expected) < 5e-3, "{angle}: {found:?}, not {expected:?}");
        }
    }
    // L_p is the widest cone.
    let all = "preconvolved_radiance(cones, cone_sampler, direction)";
    let widest = look_up(&light, CONE, &towards(&directions, 90.0 * degree));
    assert_eq!(look_up(&light, all, &towards(&directions, 0.3)), widest);
    // Directions without one count as +y.
    let wild = [[0.0, 0.0, 0.0], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0], [1e-36, 0.0, 0.0]];
    let up = look_up(&light, CONE, &towards(&[Point::new(0.0, 1.0, 0.0)], 0.5))[0];
    for found in look_up(&light, CONE, &towards(&wild.map(Point::from), 0.5)) {
        assert_eq!(found, up);
    }
}

/// Between texels too: at any direction.
#[test]
fn look_ups_between_texels_stay_near_the_integral() {
    let mut random = Random(77);
    let directions: Vec<Point> = (0..200).map(|_| random.direction()).collect();
    for name in ["forest.exr", "sunset.exr"] {
        let map = real_map(name);
        let reference = reference_map(&map);
        let exact = rows(directions.len(), |i| cones_of(&reference, directions[i]));
        let light = lit(&map, 65, false);
        for layer in [0, 1, 3, 7] {
            let found = look_up(&light, CONE, &towards(&directions, layer_angle(layer)));
            let found = found.into_iter().map(|rgb| rgb.map(f64::from));
            let pairs: Vec<_> = found.zip(exact.iter().map(|cones| cones[layer])).collect();
            let [square, worst] = errors(&pairs);
            println!("{name} looked up, layer {layer}: RMS {square:.5}, worst {worst:.5}");
            assert!(square < 0.1, "{name} {layer}: {square}");
        }
    }
}

#[test]
fn the_geometric_term_is_a_cosine_of_both_normalised() {
    let light = lit(&noise(), 8, true);
    let mut random = Random(9);
    let mut records = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..500 {
        let (a, b) = (random.direction(), random.direction());
        let [long, short] = [random.magnitude(1e-3, 1e3), random.magnitude(1e-3, 1e3)];
        let [a_scaled, b_scaled] = [a * long, b * short];
        records.push([a_scaled.x, a_scaled.y, a_scaled.z, 0.0, b_scaled.x, b_scaled.y, b_scaled.z]);
        expected.push(a.dot(b).max(0.0));
    }
    for wild in [[0.0; 7], [f64::NAN; 7], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]] {
        records.push(wild);
        expected.push(0.0);
    }
    let records: Vec<_> = records.iter().map(|record| record.map(|x| x as f32)).collect();
    let found = look_up(&light, "vec3<f32>(geometric_term(direction, normal))", &records);
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((f64::from(found[0]) - expected).abs() < 2e-6, "{found:?}, not {expected}");
    }
}

#[test]
fn impossible_radiance_counts_as_none() {
    let mut random = Random(3);
    let mut values: Vec<f32> = (0..4 * 128 * 64).map(|_| random.unit() as f32).collect();
    let mut repaired = values.clone();
    for (i, wild) in
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0].into_iter().cycle().take(900).enumerate()
    {
        (values[i * 36], repaired[i * 36]) = (wild, 0.0);
    }
    for sampled in [false, true] {
        let [wild, clean] = [&values, &repaired].map(|values| {
            let light = ConeLight::unlit(gpu(), shaders(), ConeLightForm { side: 16, sampled }).unwrap();
            let map = texture([128, 64], wgpu::TextureFormat::Rgba32Float, values);
            let bound = light.bind(gpu(), &map).unwrap();
            let mut encoder = gpu().encoder();
            light.record(&mut encoder, &bound);
            gpu().submit(encoder).unwrap();
            Cones::of(&light).values().to_vec()
        });
        assert!(wild.iter().all(|value| value.is_finite() && *value >= 0.0), "sampled {sampled}");
        assert_eq!(wild, clean, "sampled {sampled}");
    }
    // More light than half floats have.
    let map = Environment::from_function([64, 32], |_| Vec3::splat(1e6)).unwrap();
    for sampled in [false, true] {
        let cones = Cones::of(&lit(&map, 8, sampled));
        each(&cones, |_, _, light| {
            assert!(light.iter().all(|c| (65000.0..=65504.0).contains(c)), "sampled {sampled}: {light:?}");
        });
    }
}

#[test]
fn what_is_impossible_is_said() {
    let map = Environment::from_function([8, 4], |_| Vec3::ONE).unwrap();
    for side in [0, 7, 513, u32::MAX] {
        let error =
            ConeLight::new(gpu(), shaders(), &map, ConeLightForm { side, sampled: true }).err().unwrap();
        assert!(matches!(error, ConeLightError::Side(given) if given == side));
        assert!(
            error.to_string().contains(&format!("{side} ")) && error.to_string().contains("512"),
            "{error}"
        );
    }
    for size in [[8, 8], [4, 8], [3, 1], [7, 4]] {
        let map = Environment::from_function(size, |_| Vec3::ONE).unwrap();
        let error =
            ConeLight::new(gpu(), shaders(), &map, ConeLightForm { side: 8, sampled: true }).err().unwrap();
        let said = error.to_string();
        assert!(said.contains(&format!("{}x{}", size[0], size[1])) && said.contains("2:1"), "{said}");
    }
}
