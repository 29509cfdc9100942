// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where rows and columns lie: the host and the shader against the f64 reference.

use super::cameras::{LIMIT, any_camera, host_camera, light_for, matrix_rounding, next_to_the_border};
use crate::gpu::{self, Probe, Random};
use airlight::scattering::{Projective, ProjectiveRows, projective_rows};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;
use glam::DVec4;

/// The numbers of the uniform, in its order.
fn flat(rows: &ProjectiveRows) -> [f32; 24] {
    let mut bytes = encase::UniformBuffer::new(Vec::<u8>::new());
    bytes.write(rows).unwrap();
    let words = bytes.into_inner();
    std::array::from_fn(|i| {
        let word: [u8; 4] = words[4 * i..4 * i + 4].try_into().unwrap();
        if i >= 22 { u32::from_le_bytes(word) as f32 } else { f32::from_le_bytes(word) }
    })
}

/// Rebuilds the uniform from the first 24 numbers of a record.
const UNFLATTEN: &str = "
    fn given_rows() -> ProjectiveRows {
        return ProjectiveRows(
            vec3<f32>(input(0u), input(1u), input(2u)), input(3u), vec3<f32>(input(4u), input(5u), input(6u)), input(7u),
            vec3<f32>(input(8u), input(9u), input(10u)), input(11u),
            vec3<f32>(input(12u), input(13u), input(14u)), input(15u),
            vec4<f32>(input(16u), input(17u), input(18u), input(19u)), input(20u), input(21u),
            u32(input(22u)), u32(input(23u))
        );
    }";

struct Case {
    camera: ReferenceCamera,
    light: linear::Vec3,
    projective: Projective,
    reference: reference::Projective,
}

pub const SIZE: [usize; 2] = [96, 40];

fn cases(count: usize) -> Vec<Case> {
    let mut random = Random(41);
    let mut cases = Vec::new();
    while cases.len() < count {
        let aspect = random.between(0.5, 2.5);
        let camera = any_camera(&mut random, aspect);
        let light = gpu::vector(gpu::host_vector(light_for(&mut random, &camera)));
        let splits = if camera.is_orthographic() { 1 } else { cases.len() % 4 + 1 };
        let host = host_camera(&camera, [96, 64]);
        let Ok(projective) = projective_rows(&host, gpu::host_vector(light), LIMIT, splits as u32) else {
            continue;
        };
        // Next to the limits the precision of f32 matrices decides.
        if projective.obliqueness > 100.0 || next_to_the_border(&camera, light, 1e-3) {
            continue;
        }
        let reference = reference::Projective::new(&camera, light, f64::from(LIMIT), SIZE, splits).unwrap();
        cases.push(Case { camera, light, projective, reference });
    }
    cases
}

#[test]
fn view_rays_are_rows_light_rays_columns_and_all_of_the_frustum_is_inside() {
    let mut random = Random(42);
    let cases = cases(600);
    let kinds = [
        cases.iter().filter(|c| c.camera.is_orthographic()).count(),
        cases.iter().filter(|c| c.camera.far_depth < 0.5).count(),
        cases.iter().filter(|c| c.camera.far.is_infinite()).count(),
    ];
    println!("{} cases: {kinds:?} orthographic, reversed, infinite", cases.len());
    assert!(kinds.iter().all(|count| *count > 60));
    // Greatest error over its budget.
    let mut worst = [0.0_f64; 4];
    for (index, case) in cases.iter().enumerate() {
        let Case { camera, projective, reference, .. } = case;
        let reach = camera.far.min(f64::from(LIMIT));
        let ndc = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let (origin, direction) = (camera.origin(ndc), camera.ray(ndc));
        let mut before: Option<(usize, f64)> = None;
        for step in 0..24 {
            let along = camera.near + (reach - camera.near) * (f64::from(step) + 0.5) / 24.0;
            let point = origin + direction * (along / direction.dot(camera.forward));
            let [x, ..] = reference.coordinates(point);
            if x < reference.near {
                continue;
            }
            // The matrix that rasterises, as the shader gets it, in f64.
            let split = projective.rows.bounds.to_array()[..projective.splits.len() - 1]
                .iter()
                .filter(|bound| f64::from(**bound) <= x)
                .count();
            let matrix = projective.splits[split].clip_from_world.as_dmat4();
            let project = |p: linear::Vec3| {
                let clip = matrix * DVec4::new(p.x, p.y, p.z, 1.0);
                [clip.x / clip.w, clip.y / clip.w, clip.z / clip.w]
            };
            let [u, v, z] = project(point);
            let [row, depth] = reference.slopes(point);
            let span = [reference.y[1] - reference.y[0], reference.z[1] - reference.z[0]];
            // Entries of f32 times coordinates, over what the range and the division by X leave of them. In
            // orthographic views nothing is divided by X.
            let metres = point.length() + camera.eye.length() + 1.0;
            let ratio = |slope: f64, span: f64| {
                let divisor = if camera.is_orthographic() { 1.0 } else { x };
                4e-7 * metres * (1.0 + slope.abs()) / (span * divisor)
            };
            let corner =
                camera.corners().map(|d| reference.axes[0].dot(d).recip()).into_iter().fold(1.0, f64::max);
            let greatest = |range: [f64; 2]| 1.0 + range[0].abs().max(range[1].abs());
            let of = |range: [f64; 2]| {
                1e-5 + (1e-6 + matrix_rounding(camera)) * corner * greatest(range) / (range[1] - range[0])
            };
            let expected_row = (row - reference.y[0]) / span[0];
            let expected_depth = 0.05 + 0.9 * (depth - reference.z[0]) / span[1];
            worst[0] =
                worst[0].max((0.5 - 0.5 * v - expected_row).abs() / (of(reference.y) + ratio(row, span[0])));
            worst[1] = worst[1].max((z - expected_depth).abs() / (of(reference.z) + ratio(depth, span[1])));
            let texels = SIZE[0] as f64 / projective.splits.len() as f64;
            let column = (split as f64 + 0.5 + 0.5 * u) * texels;
            // A finite far plane of forward depth is known as well as an f32 matrix holds it.
            let plane = 3e-7 * camera.far.min(1e4) / camera.near.max(1e-3);
            let fine = 0.1 * (1e-5 + 2.0 * ratio(1.0, 1.0) + plane) * SIZE[0] as f64;
            worst[2] = worst[2].max((column - reference.column(x)).abs() / fine);
            let inside = |value: f64| (-1e-3..=1.001).contains(&value);
            assert!(
                inside(expected_row)
                    && inside((expected_depth - 0.05) / 0.9)
                    && inside(column / SIZE[0] as f64),
                "case {index}: {column} {expected_row} {expected_depth}"
            );
            if let Some((last_split, last)) = before {
                assert!(split > last_split || u > last, "case {index}: columns fall along a ray");
            }
            before = Some((split, u));
            // Away from the light: the same column and row, deeper.
            let [u_on, v_on, z_on] = project(point - case.light * 2.0);
            worst[3] = worst[3].max(
                (u_on - u).abs().max((v_on - v).abs())
                    / (0.1 * (1e-5 + ratio(1.0 + row.abs(), span[0].min(1.0)))),
            );
            assert!(z_on > z, "case {index}: depth falls along the light");
        }
    }
    println!("worst error over budget: rows, depth, columns, light rays {worst:?}");
    assert!(worst.iter().all(|w| *w <= 1.0), "{worst:?}");
}

#[test]
fn shader_places_points_and_rays_as_the_reference_does() {
    let mut random = Random(43);
    let cases = cases(500);
    let head = format!(
        "#import airlight::scattering::projective::{{
             ProjectiveRows, rectified_position, projective_ray, column_from_x, x_from_column, reference_reach,
             row_slope, texel_begin, stretch_weight, filtered_column, light_ray_point
         }}{UNFLATTEN}"
    );
    let probe = Probe {
        head: &head,
        body: "let rows = given_rows();
               let size = vec2<f32>(96.0, 40.0);
               let at = vec3<f32>(input(24u), input(25u), input(26u));
               let direction = vec3<f32>(input(27u), input(28u), input(29u));
               let distance = input(30u);
               let place = rectified_position(rows, size, at + direction * distance);
               let ray = projective_ray(rows, 40.0, at, direction, distance);
               output(0u, place.x); output(1u, place.y); output(2u, place.z);
               output(3u, ray.row); output(4u, ray.depth); output(5u, ray.begin); output(6u, ray.end); output(7u, ray.reach);
               output(8u, column_from_x(rows, 96.0, x_from_column(rows, 96.0, input(31u))));
               output(9u, x_from_column(rows, 96.0, input(31u)));
               output(10u, reference_reach(rows, 40.0, 7.0));
               output(11u, row_slope(rows, 40.0, 7.0));
               output(12u, texel_begin(rows, 96.0, 0u));
               output(13u, stretch_weight(input(32u), max(ray.end - texel_begin(rows, 96.0, 0u), 0.0) * 1.5));
               output(14u, filtered_column(rows, 96.0, 1.5, input(32u), 0u, ray.end));
               let on = light_ray_point(rows, 40.0, 7.0, x_from_column(rows, 96.0, input(31u)));
               output(15u, on.x); output(16u, on.y); output(17u, on.z);",
        inputs: 33,
        outputs: 18,
    };
    let mut values = Vec::new();
    let mut asked = Vec::new();
    for case in &cases {
        let reach = case.camera.far.min(f64::from(LIMIT));
        let ndc = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let (origin, direction) = (case.camera.origin(ndc), case.camera.ray(ndc));
        let distance = reach * random.between(0.02, 1.0);
        let column = random.between(0.0, 96.0);
        let extinction = if random.unit() < 0.2 { 0.0 } else { random.magnitude(1e-4, 1.0) };
        values.extend(flat(&case.projective.rows));
        values.extend(origin.to_array().map(|x| x as f32));
        values.extend(direction.to_array().map(|x| x as f32));
        values.extend([distance as f32, column as f32, extinction as f32]);
        asked.push((origin, direction, distance, column, extinction));
    }
    let results = probe.run(&values);
    let mut worst = [0.0_f64; 8];
    let mut note = |kind: usize, error: f64, budget: f64| {
        worst[kind] = worst[kind].max(if error.is_nan() { f64::INFINITY } else { error / budget });
    };
    for ((case, (origin, direction, distance, column, extinction)), found) in
        cases.iter().zip(asked).zip(results.chunks_exact(18))
    {
        let reference = &case.reference;
        let found: Vec<f64> = found.iter().map(|x| f64::from(*x)).collect();
        let point = origin + direction * distance;
        let [x, ..] = reference.coordinates(point);
        let [row, depth] = reference.slopes(point);
        let span = [reference.y[1] - reference.y[0], reference.z[1] - reference.z[0]];
        // Rounding of the point itself, and of the corner rays' slopes, which the ranges are made of.
        let metres = point.length() + case.camera.eye.length() + 1.0;
        let level = reference.orthographic.is_some();
        let divisor = if level { 1.0 } else { x };
        let corner =
            case.camera.corners().map(|d| reference.axes[0].dot(d).recip()).into_iter().fold(0.0, f64::max);
        let steep = if level { metres } else { 1.0 + corner };
        let greatest = |range: [f64; 2]| 1.0 + range[0].abs().max(range[1].abs());
        let matrix = 1e-6 + matrix_rounding(&case.camera);
        let of = |range: [f64; 2]| matrix * steep * greatest(range) / (range[1] - range[0]) + 1e-6;
        let point_of = |range: [f64; 2]| of(range) * (1.0 + 0.3 * metres / divisor);
        let oblique = f64::from(case.projective.obliqueness);
        let expected_row = (row - reference.y[0]) / span[0] * 40.0 - 0.5;
        let expected_depth = 0.05 + 0.9 * (depth - reference.z[0]) / span[1];
        let plane = 3e-7 * case.camera.far.min(1e4) / case.camera.near.max(1e-3);
        let near = (1e-5 + plane + 1e-6 * metres / x.abs().max(reference.near.abs()).max(1e-3))
            * oblique.max(1.0)
            * 5.0;
        if x > reference.near {
            note(0, (found[0] - reference.column(x)).abs(), near);
            note(1, (found[1] - expected_row).abs(), 40.0 * point_of(reference.y));
            note(2, (found[2] - expected_depth).abs(), point_of(reference.z));
        }
        note(1, (found[3] - expected_row.clamp(0.0, 39.0)).abs(), 40.0 * of(reference.y));
        note(2, (found[4] - expected_depth.clamp(0.05, 0.95)).abs(), of(reference.z));
        let scale = reference.far.abs().max(reference.near.abs()) + metres;
        let begin = if reference.orthographic.is_some() { reference.coordinates(origin)[0] } else { 0.0 };
        note(3, (found[5] - begin).abs().max((found[6] - x).abs()), 2e-6 * scale);
        note(3, (found[7] * reference.axes[0].dot(direction) - 1.0).abs(), 2e-6 * steep);
        note(4, (found[8] - column).abs(), 96.0 * 1e-5);
        note(4, (found[9] - reference.x_of(column)).abs(), (2e-6 * oblique.max(1.0) + plane) * scale);
        note(5, (found[10] / reference.reference_length(7) - 1.0).abs(), matrix * steep);
        note(5, (found[11] - reference.row_slope(7)).abs(), matrix * steep * greatest(reference.y));
        let first = if reference.orthographic.is_some() { reference.near } else { 0.0 };
        note(5, (found[12] - first).abs(), 1e-5 * scale);
        // The weight of all up to the end: the integral of transmittance.
        let until = (x - first).max(0.0) * 1.5;
        let weight = if extinction == 0.0 { until } else { -(-extinction * until).exp_m1() / extinction };
        note(6, (found[13] - weight).abs(), 2e-6 * scale);
        // Interpolation at that column gives the weighted mean of what is lit up to the last whole texel.
        if x > reference.near {
            let place = found[14];
            assert!((0.5..=95.5).contains(&place), "{place}");
            let texel = reference.column(x).floor().min(95.0);
            let whole = |i: f64| {
                let edge = if i == 0.0 { first } else { reference.x_of(i) };
                let metres = (edge - first) * 1.5;
                if extinction == 0.0 { metres } else { -(-extinction * metres).exp_m1() / extinction }
            };
            // A row that is lit before `texel` and dark in it: prefix means 1 and W_i / W_(i+1).
            let share = place - (texel - 0.5);
            let mean = 1.0 + (whole(texel) / whole(texel + 1.0) - 1.0) * share;
            let sharp = (reference.column(x) - texel - 0.5).abs() < 0.49;
            if texel > 0.0 && sharp {
                note(7, (mean - whole(texel) / weight).abs(), 1e-4);
            }
        }
        let [a, b] = [reference.x_of(column), reference.row_slope(7)];
        let y = if reference.orthographic.is_some() { b } else { a * b };
        let on = reference.origin + reference.axes[0] * a + reference.axes[1] * y;
        let error = (linear::Vec3::new(found[15], found[16], found[17]) - on).length();
        note(3, error, (4e-6 * oblique.max(1.0) + plane) * (scale + y.abs()));
    }
    println!("worst error over budget: column, row, depth, ray, inverse, reference, weight, share {worst:?}");
    assert!(worst.iter().all(|w| *w <= 1.0), "{worst:?}");
}
