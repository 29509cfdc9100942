// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights of the core on the GPU against f64, within stated error budgets: their maps and views, how they fall
//! off, and how air scatters them.

use crate::gpu::{self, Probe, Random};
use crate::probing::{MATRIX_AT, f, hold, triple, worst};
use airlight::core::ShadowViews;
use airlight_tests::linear::{Mat4, Vec3};
use airlight_tests::reference::camera::{Camera as ReferenceCamera, View};
use airlight_tests::reference::{light, phase, scattering};
use std::f64::consts::PI;

const LIGHT: &str = "#import airlight::core::light::{
        Light, shadow_position, shadow_point, direction_to_light, angular_falloff, light_falloff
    }";

/// Points to a map of 512 x 256 texels and back: what [`extend`] records becomes the place on the map, the depth,
/// and the point that these two stand for.
fn to_the_map_and_back(kind: u32, inputs: &[f32]) -> Vec<f32> {
    Probe {
        head: &format!("{LIGHT}{MATRIX_AT}"),
        body: &format!(
            "let light = Light(matrix_at(0u), matrix_at(16u), vec3<f32>(0.0), 1.0, vec3<f32>(0.0), {kind}u,
                 vec3<f32>(0.0), 0.0, vec2<f32>(0.0), 0.0, 0.0);
             let at = shadow_position(light, vec2<f32>(512.0, 256.0), vec3<f32>(input(32u), input(33u), input(34u)));
             let back = shadow_point(light, vec2<f32>(512.0, 256.0), at.xy, at.z);
             output(0u, at.x); output(1u, at.y); output(2u, at.z);
             output(3u, back.x); output(4u, back.y); output(5u, back.z);"
        ),
        inputs: 35,
        outputs: 6,
    }
    .run(inputs)
}

/// A record of a light's matrix, its inverse, and a point.
fn extend(inputs: &mut Vec<f32>, clip_from_world: Mat4, world_from_clip: Mat4, point: Vec3) {
    inputs.extend(gpu::host_matrix(clip_from_world).to_cols_array());
    inputs.extend(gpu::host_matrix(world_from_clip).to_cols_array());
    inputs.extend(gpu::host_vector(point).to_array());
}

#[test]
fn points_go_to_the_shadow_map_and_back() {
    let mut random = Random(31);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for _ in 0..500 {
        let towards = random.direction();
        let half = random.between(1.0, 50.0);
        let centre = random.direction() * random.between(0.0, 20.0);
        let matrix = gpu::light_matrix(towards, centre, half, if random.unit() < 0.5 { 1.0 } else { 0.0 });
        let point = gpu::vector(gpu::host_vector(centre + random.direction() * random.between(0.0, half)));
        extend(&mut inputs, matrix, matrix.inverse().unwrap(), point);
        cases.push((matrix, point, half));
    }
    let found = to_the_map_and_back(0, &inputs);
    let (mut forth, mut back) = (0.0_f64, 0.0_f64);
    for ((matrix, point, half), found) in cases.iter().zip(found.chunks_exact(6)) {
        let map = scattering::ShadowMap {
            depth: &[],
            width: 512,
            height: 256,
            clip_from_world: *matrix,
            far_depth: 1.0,
        };
        let [x, y, z] = map.project(*point);
        let scale = 1.0 + point.length() / half;
        let texels = (f(found[0]) - x).abs().max((f(found[1]) - y).abs()) / 512.0;
        forth = forth.max(texels.max((f(found[2]) - z).abs()) / scale);
        back = back.max((triple(&found[3..]) - *point).length() / (half + point.length()));
    }
    hold("shadow_position, of the map", forth, 5e-7);
    hold("shadow_point of it, of the scene's size", back, 1e-6);
}

#[test]
fn texels_are_as_wide_as_what_they_hold() {
    let mut random = Random(41);
    let (mut inputs, mut expected) = (Vec::new(), Vec::new());
    for case in 0..500 {
        let (middle, axis) = (random.direction() * random.between(0.0, 10.0), random.direction());
        let (half, distance) = (random.between(0.1, 1.3), random.between(0.1, 30.0));
        let point = middle + axis * distance + random.direction().without(axis) * (0.2 * distance);
        // Over half the picture at the point's distance, or half the map's side.
        let (matrix, side) = if case % 2 == 0 {
            let (target, up, aspect) = (middle + axis, random.direction(), 1.0);
            let (near, far, reversed) = (0.05, 40.0, false);
            let view = View { eye: middle, target, up, fov_y: 2.0 * half, aspect, near, far, reversed };
            (ReferenceCamera::perspective(&view).clip_from_world, distance * half.tan())
        } else {
            (gpu::light_matrix(axis, middle, 20.0 * half, 1.0), 20.0 * half)
        };
        inputs.extend(gpu::host_matrix(matrix).to_cols_array());
        inputs.extend(gpu::host_vector(point).to_array());
        expected.push((2.0 * side / 300.0, 1.0 + (middle.length() + distance) / distance));
    }
    let found = Probe {
        head: &format!("#import airlight::core::light::metres_of_texel\n{MATRIX_AT}"),
        body: "output(0u, metres_of_texel(matrix_at(0u), 300.0, vec3<f32>(input(16u), input(17u), input(18u))));",
        inputs: 19,
        outputs: 1,
    }
    .run(&inputs);
    let error = |(found, (side, scale)): (&f32, &(f64, f64))| (f(*found) / side - 1.0).abs() / scale;
    hold("metres_of_texel", found.iter().zip(&expected).map(error).fold(0.0, f64::max), 1e-6);
}

#[test]
fn points_go_to_the_map_of_a_spot_and_back() {
    let mut random = Random(37);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..1000 {
        // A spot's map is the picture of a camera at its place.
        let eye = random.direction() * random.between(0.0, 10.0);
        let axis = random.direction();
        let half = random.between(0.1, 1.3);
        let camera = ReferenceCamera::perspective(&View {
            eye,
            target: eye + axis,
            up: random.direction(),
            fov_y: 2.0 * half,
            aspect: 1.0,
            near: 0.05,
            far: 40.0,
            reversed: false,
        });
        let across = random.direction().without(axis).normalised() * (half.tan() * random.unit());
        let distance = random.between(0.1, 30.0);
        let behind = case % 8 == 0;
        let point = eye + (axis + across) * if behind { -distance } else { distance };
        let point = gpu::vector(gpu::host_vector(point));
        extend(&mut inputs, camera.clip_from_world, camera.world_from_clip, point);
        cases.push((camera.clip_from_world, eye, point, distance, behind));
    }
    let found = to_the_map_and_back(1, &inputs);
    let (mut forth, mut depth, mut back) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((matrix, eye, point, distance, behind), found) in cases.iter().zip(found.chunks_exact(6)) {
        if *behind {
            assert!(found[0] < 0.0 && found[1] < 0.0 && found.iter().all(|x| x.is_finite()), "{found:?}");
            continue;
        }
        let [x, y, z, w] = matrix.apply_point(*point);
        // Cancellation: the f32 matrix holds the eye's place to an ulp of its size.
        let scale = 1.0 + point.length().max(eye.length()) / distance;
        let texels = (f(found[0]) / 512.0 - (0.5 + 0.5 * x / w)).abs();
        let texels = texels.max((f(found[1]) / 256.0 - (0.5 - 0.5 * y / w)).abs());
        forth = forth.max(texels / scale);
        depth = depth.max((f(found[2]) - z / w).abs() * w / scale);
        // Depth is steep near the light and flat far away: an ulp of it is distance^2 / near metres.
        let room = 1.0 + eye.length() + distance + distance * distance / 0.05;
        back = back.max((triple(&found[3..]) - *point).length() / room);
    }
    hold("shadow_position of a spot, of the map", forth, 3e-6);
    hold("depth of a spot, times metres", depth, 3e-6);
    hold("shadow_point of a spot, of an ulp's reach", back, 1e-6);
}

#[test]
fn light_falls_off_by_cones_and_inverse_squares() {
    let probe = Probe {
        head: LIGHT,
        body: "let m = mat4x4<f32>();
               let light = Light(m, m, vec3<f32>(input(0u), input(1u), input(2u)), 1.0, vec3<f32>(0.0), u32(input(3u)),
                   vec3<f32>(input(4u), input(5u), input(6u)), input(7u), vec2<f32>(input(8u), input(9u)), 0.0, 0.0);
               let point = vec3<f32>(input(10u), input(11u), input(12u));
               let towards = direction_to_light(light, point);
               output(0u, towards.x); output(1u, towards.y); output(2u, towards.z);
               output(3u, angular_falloff(light, towards));
               output(4u, light_falloff(light, point));",
        inputs: 13,
        outputs: 5,
    };
    let mut random = Random(41);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    let mut record =
        |direction: Vec3, kind: u32, position: Vec3, radius: f64, cosines: [f64; 2], point: Vec3| {
            inputs.extend(gpu::host_vector(direction).to_array());
            inputs.push(kind as f32);
            inputs.extend(gpu::host_vector(position).to_array());
            inputs.extend([radius as f32, cosines[0] as f32, cosines[1] as f32]);
            inputs.extend(gpu::host_vector(point).to_array());
        };
    for case in 0..3000_u32 {
        let axis = random.direction();
        let position = gpu::vector(gpu::host_vector(random.direction() * random.between(0.0, 5.0)));
        let radius = random.magnitude(1e-3, 1.0);
        let outer = random.between(0.1, 1.3);
        let inner = outer * random.between(0.0, 0.95);
        // Most points in the cone's neighbourhood, some anywhere.
        let across = random.direction().without(axis).normalised() * (outer.tan() * random.between(0.0, 1.3));
        let direction = if case % 5 == 0 { random.direction() } else { (axis + across).normalised() };
        let point = gpu::vector(gpu::host_vector(position + direction * random.magnitude(0.05, 50.0)));
        let kind = case % 3;
        record(-axis, kind, position, radius, [inner.cos(), outer.cos()], point);
        cases.push((
            match kind {
                0 => light::Light::Directional { towards: -axis },
                1 => light::Light::Spot { position, axis, inner, outer, radius },
                _ => light::Light::Point { position, radius },
            },
            point,
            outer,
            inner,
        ));
    }
    // At the light itself, far beyond every scene, and with one edge for both cones: finite and in range.
    let y = Vec3::new(0.0, 1.0, 0.0);
    let o = Vec3::new(0.0, 0.0, 0.0);
    for (position, point, radius) in
        [(o, o, 0.0), (y, y, 0.1), (o, y * 1e30, 0.1), (o, y * -1e30, 0.0), (o, y, 0.0)]
    {
        record(-y, 1, position, radius, [0.9, 0.9], point);
        record(-y, 2, position, radius, [0.0, 0.0], point);
    }
    let found = probe.run(&inputs);
    let (mut towards, mut cone, mut whole) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((light, point, outer, inner), found) in cases.iter().zip(found.chunks_exact(5)) {
        let expected = light.towards(*point);
        towards = towards.max((triple(found) - expected).length());
        let cosine = match light {
            light::Light::Spot { axis, .. } => -expected.dot(*axis),
            _ => 1.0,
        };
        // Cosines are rounded to f32 before their narrow difference divides.
        let steep = 1.0 / (inner.cos() - outer.cos());
        cone = cone.max((f(found[3]) - light.cone(cosine.clamp(-1.0, 1.0).acos())).abs() / (1.0 + steep));
        let (exact, open) = (light.irradiance(*point), 1.0 + steep);
        let free = match light {
            light::Light::Directional { .. } => 1.0,
            light::Light::Spot { position, radius, .. } | light::Light::Point { position, radius } => {
                1.0 / ((*point - *position).dot(*point - *position) + radius * radius)
            }
        };
        whole = whole.max((f(found[4]) - exact).abs() / (free * open));
        if cosine < outer.cos() - 1e-6 {
            assert_eq!((found[3], found[4]), (0.0, 0.0), "outside the cone");
        }
    }
    hold("direction_to_light", towards, 4e-7 * 100.0);
    hold("angular_falloff, of its steepness", cone, 2e-6);
    hold("light_falloff, relative, of its steepness", whole, 4e-6);
    for found in found[5 * cases.len()..].chunks_exact(5) {
        assert!(found.iter().all(|x| x.is_finite()) && (0.0..=1.0).contains(&found[3]), "{found:?}");
    }
}

#[test]
fn light_rays_find_their_view() {
    let probe = Probe {
        head: &format!(
            "#import airlight::core::shadow_views::{{
                ShadowViews, clip_in_views, view_position, point_at_depth, view_contains, or_in_view
            }}{MATRIX_AT}"
        ),
        body: "var views: ShadowViews;
               for (var k = 0u; k < 6u; k++) {
                   views.clip_from_world[k] = matrix_at(16u * k);
                   views.world_from_clip[k] = matrix_at(96u + 16u * k);
               }
               views.count = u32(input(192u));
               let point = vec3<f32>(input(193u), input(194u), input(195u));
               let at = view_position(views, vec2<f32>(512.0, 256.0), point);
               output(0u, f32(at.inside)); output(1u, f32(at.view));
               output(2u, at.at.x / 512.0); output(3u, at.at.y / 256.0); output(4u, at.at.z);
               let back = point_at_depth(views.clip_from_world[at.view], views.world_from_clip[at.view], point, at.at.z);
               output(5u, back.x); output(6u, back.y); output(7u, back.z);",
        inputs: 196,
        outputs: 8,
    };
    let mut random = Random(43);
    let (mut inputs, mut cases) = (Vec::new(), Vec::new());
    for case in 0..1500 {
        let centre = random.direction() * random.between(0.0, 4.0);
        let cube = case % 2 == 0;
        let views = if cube {
            ShadowViews::cube(gpu::host_vector(centre), 0.05, 30.0).unwrap()
        } else {
            // Nested boxes, as cascades are.
            let towards = random.direction();
            let count = 1 + random.below(6);
            let mut views = ShadowViews::cube(glam::Vec3::ZERO, 0.1, 1.0).unwrap();
            views.count = count as u32;
            for view in 0..count {
                let matrix = gpu::light_matrix(towards, centre, 2.0 * (view + 1) as f64, 1.0);
                views.clip_from_world[view] = gpu::host_matrix(matrix);
                views.world_from_clip[view] = gpu::host_matrix(matrix.inverse().unwrap());
            }
            views
        };
        let point = centre + random.direction() * random.magnitude(0.2, 20.0);
        let point = gpu::host_vector(point);
        for matrix in views.clip_from_world.iter().chain(&views.world_from_clip) {
            inputs.extend(matrix.to_cols_array());
        }
        inputs.push(views.count as f32);
        inputs.extend(point.to_array());
        cases.push((views, gpu::vector(point), cube));
    }
    let found = probe.run(&inputs);
    let (mut places, mut back, mut hits, mut skipped) = (0.0_f64, 0.0_f64, [0; 2], 0);
    for ((views, point, cube), found) in cases.iter().zip(found.chunks_exact(8)) {
        let matrices: Vec<_> =
            views.clip_from_world[..views.count as usize].iter().map(|m| gpu::matrix(*m)).collect();
        let (expected, margin) = light::first_view(&matrices, *point);
        if margin < 1e-4 {
            skipped += 1;
            continue;
        }
        assert_eq!(found[0] == 1.0, expected.is_some(), "{point:?}");
        hits[usize::from(expected.is_some())] += 1;
        assert!(expected.is_some() || !cube);
        let Some((view, [x, y, z])) = expected else { continue };
        assert_eq!(found[1] as usize, view);
        let errors = [f(found[2]) - (0.5 + 0.5 * x), f(found[3]) - (0.5 - 0.5 * y), f(found[4]) - z];
        places = errors.iter().fold(places, |worst, error| worst.max(error.abs()));
        let room = if *cube { 1.0 + point.length().powi(2) / 0.05 } else { 1.0 + point.length() };
        back = back.max((triple(&found[5..]) - *point).length() / room);
    }
    assert!(hits[0] > 50 && hits[1] > 500 && skipped < 50, "{hits:?} {skipped}");
    hold("view_position, of the map", places, 2e-5);
    hold("point_at_depth, of an ulp's reach", back, 2e-6);
}

// Phase functions.

fn henyey_greenstein(pairs: &[f32]) -> Vec<f32> {
    Probe {
        head: "#import airlight::core::phase::{henyey_greenstein, isotropic}",
        body: "output(0u, henyey_greenstein(input(0u), input(1u))); output(1u, isotropic());",
        inputs: 2,
        outputs: 2,
    }
    .run(pairs)
}

const MEAN_COSINES: [f32; 11] = [-0.99, -0.9, -0.6, -0.2, 0.0, 1e-4, 0.3, 0.76, 0.9, 0.97, 0.99];

#[test]
fn phase_functions_are_those_of_the_reference() {
    // Cosines close to 1 are f32 as well: the difference from 1 is exact.
    let mut cosines: Vec<f32> = (0..=400).map(|i| i as f32 / 200.0 - 1.0).collect();
    cosines.extend((1..=24).flat_map(|i| [1.0 - 0.5_f32.powi(i), 0.5_f32.powi(i) - 1.0]));
    let pairs: Vec<f32> = MEAN_COSINES.iter().flat_map(|g| cosines.iter().flat_map(|c| [*c, *g])).collect();
    let found = henyey_greenstein(&pairs);
    let error = worst(
        pairs
            .chunks_exact(2)
            .zip(found.chunks_exact(2))
            .map(|(pair, found)| (f(found[0]) / phase::henyey_greenstein(f(pair[0]), f(pair[1])), 1.0)),
    );
    hold("henyey_greenstein, relative", error, 2e-6);
    hold("isotropic, relative", (f(found[1]) / phase::isotropic() - 1.0).abs(), 1e-7);
    // Cosines that rounding has carried out of range, and means beyond the clamp, stay finite.
    let wild = henyey_greenstein(&[1.0000002, 0.9, -1.0000002, -0.9, 1.0, 1.0, -1.0, -1.0, 0.5, 1e30]);
    assert!(wild.iter().all(|p| p.is_finite() && *p >= 0.0), "{wild:?}");
    let clamped = phase::henyey_greenstein(1.0, f(0.999));
    hold("henyey_greenstein at its clamp, relative", (f(wild[4]) / clamped - 1.0).abs(), 1e-3);
}

#[test]
fn phase_functions_are_normalised_with_mean_cosine_g() {
    const STEPS: usize = 20_000;
    for g in MEAN_COSINES {
        // Nodes crowd at the peak; the trapezoids are between the f32 cosines themselves.
        let cosines: Vec<f32> = (0..=STEPS)
            .map(|i| {
                let angle = PI * (i as f64 / STEPS as f64).powi(2);
                let cosine = angle.cos() as f32;
                if g >= 0.0 { cosine } else { -cosine }
            })
            .collect();
        let pairs: Vec<f32> = cosines.iter().flat_map(|c| [*c, g]).collect();
        let values: Vec<f64> = henyey_greenstein(&pairs).chunks_exact(2).map(|p| f(p[0])).collect();
        let (mut norm, mut mean) = (0.0, 0.0);
        for i in 0..STEPS {
            let (a, b) = (f(cosines[i]), f(cosines[i + 1]));
            let width = 2.0 * PI * (a - b).abs() * 0.5;
            norm += width * (values[i] + values[i + 1]);
            mean += width * (a * values[i] + b * values[i + 1]);
        }
        hold(&format!("norm, g {g}"), (norm - 1.0).abs(), 1e-4);
        hold(&format!("mean cosine, g {g}"), (mean - f(g)).abs(), 1e-4);
    }
}
