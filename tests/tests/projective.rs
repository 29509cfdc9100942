// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projective rectification on the GPU against the f64 references and closed forms.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{
    Camera, DepthRange, Light, MeshBuffers, PerspectiveView, Pictures, Sky, direction_from_angles,
};
use airlight::data::{Mesh, plane};
use airlight::scattering::{
    Along, BasisFormat, Choice, Inputs, March, Medium, OBLIQUENESS_LIMIT, Projective, ProjectiveError,
    ProjectiveMap, ProjectivePrefiltered, ProjectiveRaster, ProjectiveRows, Settings, SettingsError, Start,
    Visibility, Weighting, choose, projective_rows,
};
use airlight::{Buffer, Lighting, Texture, scenes};
use airlight_tests::error;
use airlight_tests::linear;
use airlight_tests::reference::camera::{Camera as ReferenceCamera, OrthographicView};
use airlight_tests::reference::scattering as reference;
use glam::{DVec4, Mat4, Vec2, Vec3};
use gpu::{Probe, Random, gpu, shaders};
use wgpu::TextureFormat::R32Float;

const PICTURE: [u32; 2] = [480, 270];

/// The uniform of a reference's camera of either kind.
fn host_camera(camera: &ReferenceCamera, viewport: [u32; 2]) -> Camera {
    Camera { projection: u32::from(camera.is_orthographic()), ..gpu::host_camera(camera, viewport) }
}

fn orthographic(random: &mut Random, aspect: f64) -> ReferenceCamera {
    let eye = random.direction() * random.between(0.0, 30.0);
    ReferenceCamera::orthographic(&OrthographicView {
        eye,
        target: eye + random.direction(),
        up: random.direction(),
        half_height: random.between(0.5, 20.0),
        aspect,
        depth: random.between(5.0, 80.0),
        reversed: random.unit() < 0.5,
    })
}

fn any_camera(random: &mut Random, aspect: f64) -> ReferenceCamera {
    if random.unit() < 0.25 { orthographic(random, aspect) } else { random.camera(aspect) }
}

/// A light that projective rows can serve more often than not: beside the picture.
fn light_for(random: &mut Random, camera: &ReferenceCamera) -> linear::Vec3 {
    if camera.is_orthographic() {
        return random.direction();
    }
    if random.unit() < 0.4 {
        random.light(camera)
    } else {
        random.direction().without(camera.forward).normalised()
    }
}

/// Whether the light or its antipode is about as far from the picture's centre as its border, by the sine of the angle.
fn next_to_the_border(camera: &ReferenceCamera, light: linear::Vec3, sine: f64) -> bool {
    let sides = camera.side_normals().map(|n| n.dot(light.normalised()));
    let inside = |sign: f64| sides.iter().fold(f64::INFINITY, |least, side| least.min(sign * side));
    !camera.is_orthographic() && (inside(1.0).abs() < sine || inside(-1.0).abs() < sine)
}

/// Error of the direction of view rays, radians, by the rounding of an f32 matrix from clip space to the world: with
/// forward depth they are the difference of numbers as large as the eye's place over the near
/// distance.
fn matrix_rounding(camera: &ReferenceCamera) -> f64 {
    let cancels = !camera.is_orthographic() && camera.far_depth > 0.5;
    if cancels { 6e-8 * camera.eye.length() / camera.near } else { 0.0 }
}

/// A light outside of the picture: at a corner for 0, at a right angle to the view for 1.
fn light_beside_corner(camera: &ReferenceCamera, turn: f64) -> Vec3 {
    let corner = camera.corners()[2];
    let beside = corner.without(camera.forward).normalised();
    gpu::host_vector((corner * (1.0 - turn) + beside * turn).normalised())
}

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

// (a) Geometry.

struct Case {
    camera: ReferenceCamera,
    light: linear::Vec3,
    projective: Projective,
    reference: reference::Projective,
}

const SIZE: [usize; 2] = [96, 40];
const LIMIT: f32 = 90.0;

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
    let _turn = gpu::turn();
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

#[test]
fn rows_are_refused_exactly_when_the_light_or_its_antipode_is_in_view() {
    let mut random = Random(44);
    let (mut failed, mut borders, mut rows, mut oblique) = ([0; 2], 0, 0, 0);
    for index in 0..2000 {
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let light = gpu::vector(gpu::host_vector(random.light(&camera)));
        let expected = reference::light_in_view(&camera, light);
        if next_to_the_border(&camera, light, 2e-5) {
            borders += 1;
            continue;
        }
        let found = projective_rows(&host_camera(&camera, [96, 64]), gpu::host_vector(light), LIMIT, 2);
        match (found, expected) {
            (Err(ProjectiveError::LightInView), Some(reference::Failure::LightInView)) => failed[0] += 1,
            (Err(ProjectiveError::AntipodeInView), Some(reference::Failure::AntipodeInView)) => {
                failed[1] += 1
            }
            (Ok(_), None) => rows += 1,
            (Err(ProjectiveError::TooOblique { obliqueness, limit }), None) => {
                assert!(obliqueness > limit);
                oblique += 1;
            }
            (found, expected) => panic!("camera {index}: {found:?} instead of {expected:?}"),
        }
    }
    println!(
        "{failed:?} light and antipode in view, {rows} rows, {oblique} too oblique, {borders} at borders"
    );
    assert!(failed.iter().all(|count| *count > 200) && rows > 200 && oblique < rows / 4);
    let mut camera = host_camera(&random.camera(1.5), [96, 64]);
    let towards = gpu::host_vector(random.direction());
    for splits in [0, 5] {
        assert_eq!(projective_rows(&camera, towards, LIMIT, splits), Err(ProjectiveError::Splits(splits)));
    }
    for (light, limit) in [(Vec3::ZERO, 9.0), (Vec3::NAN, 9.0), (Vec3::X, f32::INFINITY), (Vec3::X, 0.0)] {
        assert_eq!(projective_rows(&camera, light, limit, 1), Err(ProjectiveError::NotFinite));
    }
    camera.world_from_clip.x_axis.x = f32::NAN;
    assert_eq!(projective_rows(&camera, towards, LIMIT, 1), Err(ProjectiveError::NotFinite));
    let level = orthographic(&mut random, 1.5);
    for sign in [1.0, -1.0] {
        let light = gpu::host_vector(level.forward * sign);
        let found = projective_rows(&host_camera(&level, [96, 64]), light, LIMIT, 1);
        assert_eq!(found, Err(ProjectiveError::ViewParallelToLight));
    }
}

#[test]
fn the_choice_is_projective_where_rows_are_good_and_says_why_where_not() {
    let mut random = Random(45);
    let mut counts = [0; 4];
    for index in 0..1000 {
        let aspect = random.between(0.5, 2.5);
        let camera = any_camera(&mut random, aspect);
        let mut light = gpu::host_vector(light_for(&mut random, &camera));
        if index % 5 == 0 && !camera.is_orthographic() {
            light = light_beside_corner(&camera, random.magnitude(0.01, 0.5));
        }
        let host = host_camera(&camera, [96, 64]);
        let rows = projective_rows(&host, light, LIMIT, 2);
        match (choose(&host, light, LIMIT, 2), rows) {
            (Choice::Projective(chosen), Ok(rows)) => {
                assert_eq!(*chosen, rows);
                assert!(rows.obliqueness <= OBLIQUENESS_LIMIT, "camera {index}");
                counts[0] += 1;
            }
            (Choice::Epipolar { reason } | Choice::March { reason }, Ok(rows)) => {
                let limit = OBLIQUENESS_LIMIT;
                assert!(rows.obliqueness > limit, "camera {index}");
                assert_eq!(reason, ProjectiveError::TooOblique { obliqueness: rows.obliqueness, limit });
                counts[1] += 1;
            }
            (Choice::Epipolar { reason }, Err(_)) => {
                assert!(!camera.is_orthographic() && !reason.to_string().is_empty());
                counts[2] += 1;
            }
            (Choice::March { .. }, Err(_)) => {
                assert!(camera.is_orthographic());
                counts[3] += 1;
            }
            (choice, rows) => panic!("camera {index}: {choice:?} of {rows:?}"),
        }
    }
    println!("{counts:?} projective, too oblique, epipolar for other reasons, marched for other reasons");
    assert!(counts[0] > 300 && counts[1] > 10 && counts[2] > 100);
}

// (b) Pictures.

/// A scene on the GPU, for a camera of either kind.
struct Stage {
    reference: ReferenceCamera,
    camera: Camera,
    light: Light,
    medium: Medium,
    meshes: Vec<MeshBuffers>,
    pictures: Pictures,
    buffers: [Buffer; 3],
}

impl Stage {
    fn new(
        mesh: &Mesh,
        reference: ReferenceCamera,
        towards: Vec3,
        medium: Medium,
        picture: [u32; 2],
        shadow: u32,
    ) -> Self {
        let camera = host_camera(&reference, picture);
        let bounds = mesh.bounds().unwrap();
        let light = Light::directional(towards, Vec3::new(9.0, 7.0, 5.0), bounds.min, bounds.max).unwrap();
        let meshes = vec![MeshBuffers::new(gpu(), mesh)];
        let sky = Sky::new(Vec3::splat(0.3), Vec3::splat(0.3), Vec3::splat(0.1));
        let pictures = gpu::raster().render(gpu(), &camera, &light, &sky, &meshes, [shadow, shadow]).unwrap();
        let buffers = [
            Buffer::uniform(gpu(), &camera),
            Buffer::uniform(gpu(), &light),
            Buffer::uniform(gpu(), &medium),
        ];
        Self { reference, camera, light, medium, meshes, pictures, buffers }
    }

    fn inputs(&self) -> Inputs<'_> {
        let [camera, light, medium] = &self.buffers;
        let Pictures { depth, shadow_map, .. } = &self.pictures;
        Inputs {
            camera,
            light,
            medium,
            depth,
            shadow_map,
            shadow_views: None,
            shadow_maps: None,
            light_texture: None,
        }
    }

    fn projective(&self, splits: u32) -> Projective {
        projective_rows(&self.camera, self.light.direction, self.medium.distance_limit, splits).unwrap()
    }

    /// The reference's rows.
    fn reference_rows(&self, map: [u32; 2], splits: u32) -> reference::Projective {
        let size = map.map(|side| side as usize);
        let limit = f64::from(self.medium.distance_limit);
        let splits = if self.reference.is_orthographic() { 1 } else { splits as usize };
        reference::Projective::new(&self.reference, gpu::vector(self.light.direction), limit, size, splits)
            .unwrap()
    }

    /// The exact picture over the map that the GPU made.
    fn exact(&self, map: &Texture, splits: u32) -> reference::Picture {
        self.exact_from(map, splits, reference::Start::Eye)
    }

    fn exact_from(&self, map: &Texture, splits: u32, start: reference::Start) -> reference::Picture {
        let depth = self.pictures.depth.read(gpu()).unwrap();
        let [width, height, _] = self.pictures.depth.size();
        let scene = reference::Scene {
            camera: &self.reference,
            light: gpu::reference_light(&self.light),
            medium: gpu::reference_medium(&self.medium),
            depth: &depth,
            width: width as usize,
            height: height as usize,
        };
        let [columns, rows, _] = map.size();
        let rows = self.reference_rows([columns, rows], splits);
        reference::projective_picture(&scene, &rows, &map.read(gpu()).unwrap(), start, 1)
    }

    fn map(&self, map: [u32; 2], splits: u32) -> ProjectiveMap {
        let made = ProjectiveMap::resampled(gpu(), shaders(), map).unwrap();
        made.write(gpu(), &self.projective(splits));
        let bound = made.bind(gpu(), &self.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        made.record(&mut encoder, bound.as_ref());
        gpu().submit(encoder).unwrap();
        made
    }

    fn drawn(&self, map: [u32; 2], splits: u32) -> ProjectiveMap {
        let made = ProjectiveMap::drawn(gpu(), map).unwrap();
        let projective = self.projective(splits);
        made.write(gpu(), &projective);
        let raster = ProjectiveRaster::new(gpu(), shaders()).unwrap();
        let bound = raster.bind(gpu(), &projective).unwrap();
        let mut encoder = gpu().encoder();
        raster.record(&mut encoder, &bound, &self.meshes, &made.rectified);
        gpu().submit(encoder).unwrap();
        made
    }

    fn prefiltered(&self, map: ProjectiveMap, settings: Settings) -> (Scattered, ProjectivePrefiltered) {
        let [width, height, _] = self.pictures.depth.size();
        let level = self.reference.is_orthographic();
        let settings = Settings { start: if level { Start::NearPlane } else { settings.start }, ..settings };
        let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, [width, height]).unwrap();
        let bound = method.bind(gpu(), &self.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        (scattered(&method.scattered), method)
    }

    fn marched(&self, map: &ProjectiveMap, weighting: Weighting) -> Scattered {
        let [width, height, _] = self.pictures.depth.size();
        let along = Along::Projective(map);
        let method = March::new(gpu(), shaders(), &along, weighting, [width, height]).unwrap();
        let bound = method.bind(gpu(), &self.inputs(), &along).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        scattered(&method.scattered)
    }
}

struct Scattered {
    visibility: Vec<f32>,
    radiance: Vec<f32>,
}

fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered {
        visibility: values.chunks_exact(4).map(|texel| texel[3]).collect(),
        radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect(),
    }
}

/// The direction towards the light of a scene of the gallery.
fn towards(scene: &scenes::Scene) -> Vec3 {
    match scene.light {
        Lighting::Directional { towards, .. } => towards,
        _ => panic!("{} has a light at a point", scene.name),
    }
}

/// A scene of the gallery with the light beside the picture.
fn gallery(name: &str) -> Stage {
    let scene = scenes::scene(name).unwrap().unwrap();
    let light = match name {
        "foliage" => direction_from_angles(105.0, 48.0),
        "torus" => direction_from_angles(75.0, 40.0),
        _ => towards(&scene),
    };
    let camera = gpu::reference_camera(&scene.view.perspective().unwrap(), PICTURE);
    Stage::new(&scene.mesh, camera, light, scene.medium, PICTURE, 1024)
}

/// A foliage scene as an orthographic camera sees it.
fn level_foliage() -> Stage {
    let scene = scenes::scene("foliage").unwrap().unwrap();
    let camera = ReferenceCamera::orthographic(&OrthographicView {
        eye: linear::Vec3::new(-3.0, 4.0, 9.0),
        target: linear::Vec3::new(0.0, 3.0, 0.0),
        up: linear::Vec3::new(0.0, 1.0, 0.0),
        half_height: 4.0,
        aspect: f64::from(PICTURE[0]) / f64::from(PICTURE[1]),
        depth: 25.0,
        reversed: false,
    });
    Stage::new(&scene.mesh, camera, direction_from_angles(105.0, 48.0), scene.medium, PICTURE, 1024)
}

#[test]
fn resampled_maps_are_those_of_the_reference() {
    let _turn = gpu::turn();
    for (name, stage, splits) in [
        ("foliage", gallery("foliage"), 3),
        ("plane", gallery("plane"), 1),
        ("orthographic", level_foliage(), 1),
    ] {
        let size = [384, 256];
        let map = stage.map(size, splits);
        let shadow_map = stage.pictures.shadow_map.read(gpu()).unwrap();
        let [width, height, _] = stage.pictures.shadow_map.size();
        let standard = reference::ShadowMap {
            depth: &shadow_map,
            width: width as usize,
            height: height as usize,
            clip_from_world: gpu::matrix(stage.light.clip_from_world),
            far_depth: 1.0,
        };
        let expected = stage.reference_rows(size, splits).rectify(&[standard], 0.02);
        let found = map.rectified.read(gpu()).unwrap();
        let beyond = |(z, texel): (&f32, &reference::RectifiedTexel)| {
            (texel.low - f64::from(*z)).max(f64::from(*z) - texel.high)
        };
        let worst = found.iter().zip(&expected).map(beyond).fold(0.0, f64::max);
        let blocked = found.iter().filter(|z| **z < 1.0).count() as f64 / found.len() as f64;
        println!("resampled {name}: worst {worst:.2e}, {:.0} % blocked", 100.0 * blocked);
        assert!(worst <= 2e-5 && blocked > 0.02, "{name}: {worst}");
    }
}

#[test]
fn drawn_maps_are_the_resampled_ones() {
    let _turn = gpu::turn();
    for (name, mut stage) in
        [("terrain", gallery("terrain")), ("torus", gallery("torus")), ("orthographic", level_foliage())]
    {
        // The finest shadow map that fits.
        let sky = Sky::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        stage.pictures = gpu::raster()
            .render(gpu(), &stage.camera, &stage.light, &sky, &stage.meshes, [4096, 4096])
            .unwrap();
        for splits in if name == "orthographic" { vec![1] } else { vec![1, 3] } {
            let size = [512, 256];
            let drawn = stage.drawn(size, splits).rectified.read(gpu()).unwrap();
            let map = stage.map(size, splits).rectified.read(gpu()).unwrap();
            // A texel may take either side of a silhouette within a texel of the shadow map: the drawn depth must
            // lie between those of the neighbourhood that the resampled map has.
            let [width, height] = size.map(|side| side as usize);
            let mut wrong = 0;
            let mut sum = 0.0;
            for y in 0..height {
                for x in 0..width {
                    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
                    for near_y in y.saturating_sub(1)..(y + 2).min(height) {
                        for near_x in x.saturating_sub(1)..(x + 2).min(width) {
                            low = low.min(map[near_y * width + near_x]);
                            high = high.max(map[near_y * width + near_x]);
                        }
                    }
                    let z = drawn[y * width + x];
                    assert!((0.0..=1.0).contains(&z));
                    wrong += usize::from(z < low - 0.004 || z > high + 0.004);
                    sum += f64::from((z - map[y * width + x]).abs());
                }
            }
            let share = wrong as f64 / drawn.len() as f64;
            let mean = sum / drawn.len() as f64;
            println!(
                "drawn {name}, {splits} splits: {:.2} % beyond the neighbours, mean difference {mean:.4}",
                100.0 * share
            );
            assert!(share < 0.02 && mean < 0.02, "{name} {splits}: {share} {mean}");
        }
    }
}

#[test]
fn blockers_outside_of_the_frustum_cast_shadows() {
    let _turn = gpu::turn();
    // A plate high above the picture, and one far below it that casts none.
    let mut mesh = plane(Vec2::splat(3.0), 1).transformed(Mat4::from_translation(Vec3::new(0.0, 40.0, 0.0)));
    mesh.append(&plane(Vec2::splat(60.0), 1).transformed(Mat4::from_translation(Vec3::Y * -40.0)));
    let view = PerspectiveView {
        eye: Vec3::new(0.0, 1.0, 8.0),
        target: Vec3::new(0.0, 1.0, 0.0),
        field_of_view: 40.0,
        near: 0.1,
        far: 20.0,
        depth: DepthRange::Forward,
    };
    let picture = [96, 64];
    let medium = Medium::new(0.02, Vec3::ONE, 0.0, 20.0).unwrap();
    let stage = Stage::new(&mesh, gpu::reference_camera(&view, picture), Vec3::Y, medium, picture, 1024);
    for splits in 1..=4 {
        let drawn = stage.drawn([264, 128], splits);
        let values = drawn.rectified.read(gpu()).unwrap();
        let (near, rest): (Vec<f32>, Vec<f32>) = values.iter().partition(|z| **z < 0.05);
        assert!(near.iter().all(|z| *z == 0.0) && near.len() > 50, "{} blocked", near.len());
        // What lies below all rays is clamped to 1, where nothing is told from it.
        assert!(rest.iter().all(|z| *z == 1.0));
        let exact = stage.exact(&drawn.rectified, splits);
        let (found, _) =
            stage.prefiltered(drawn, Settings { weighting: Weighting::Average, ..Settings::default() });
        let (least, error) = (
            found.visibility.iter().fold(1.0_f32, |a, b| a.min(*b)),
            error::mean_absolute(&found.visibility, &exact.average()),
        );
        // The shadow is 3 of the 20 metres; darkest where rays run through all of it.
        println!("{splits} splits: least visibility {least:.3}, mean error {error:.4}");
        assert!(least < 0.93 && error < 0.004);
    }
}

#[test]
fn marched_rows_are_the_exact_sums() {
    let _turn = gpu::turn();
    for (name, stage, splits) in [("foliage", gallery("foliage"), 3), ("orthographic", level_foliage(), 1)] {
        let map = stage.map([384, 512], splits);
        let exact = stage.exact(&map.rectified, splits);
        for (weighting, expected) in
            [(Weighting::Average, exact.average()), (Weighting::Transmittance, exact.weighted())]
        {
            let found = stage.marched(&map, weighting);
            // The march takes the nearest row, the reference interpolates two.
            let error = error::mean_absolute(&found.visibility, &expected);
            println!("{name}, {}: {error:.5}", gpu::weighting_name(weighting));
            assert!(error < 0.004, "{name}: {error}");
        }
    }
}

#[test]
fn pictures_reach_their_figures() {
    let _turn = gpu::turn();
    let mut failures = Vec::new();
    for (name, budget) in [("foliage", 0.006), ("terrain", 0.006), ("plane", 0.02), ("torus", 0.02)] {
        let stage = gallery(name);
        for splits in 1..=4 {
            // The figures hold from two splits on. One alone, which is the thesis' row, gives most of its texels to the
            // first metre, and the rest are too few to average the ringing out: 0.0082 on foliage misses 0.006.
            let budget = if splits == 1 { 1.5 * budget } else { budget };
            let map = [if splits == 3 { 513 } else { 512 }, 512];
            let average = Settings { weighting: Weighting::Average, ..Settings::default() };
            let (found, method) = stage.prefiltered(stage.map(map, splits), average);
            let exact = stage.exact(&method.map.rectified, splits);
            let error = error::mean_absolute(&found.visibility, &exact.average());
            let (weighted, _) = stage.prefiltered(stage.map(map, splits), Settings::default());
            let radiance = error::relative_rmse(&weighted.radiance, &exact.radiance());
            let rank = Visibility::Rank { bits: 12 };
            let (plain, _) =
                stage.prefiltered(stage.map(map, splits), Settings { visibility: rank, ..average });
            let (ranked, _) = stage
                .prefiltered(stage.map(map, splits), Settings { visibility: rank, ..Settings::default() });
            let six = Visibility::Moments;
            let (six_plain, _) =
                stage.prefiltered(stage.map(map, splits), Settings { visibility: six, ..average });
            let (moments, _) = stage
                .prefiltered(stage.map(map, splits), Settings { visibility: six, ..Settings::default() });
            let of_moments = error::mean_absolute(&six_plain.visibility, &exact.average());
            let moments = error::relative_rmse(&moments.radiance, &exact.radiance());
            let of_ranks = error::mean_absolute(&plain.visibility, &exact.average());
            let ranked = error::relative_rmse(&ranked.radiance, &exact.radiance());
            println!(
                "{name}, {splits} splits, obliqueness {:.1}: visibility {error:.5} of at most {budget}, radiance {:.2} %; \
                 rank queries {of_ranks:.5}, {:.2} %; moments {of_moments:.5}, {:.2} %",
                stage.projective(splits).obliqueness,
                100.0 * radiance,
                100.0 * ranked,
                100.0 * moments
            );
            // About what they err by over epipolar rows, see `moments.rs`.
            if !(of_moments <= 0.0143 && moments <= 0.022) {
                failures.push(format!("{name}, {splits} splits: moments {of_moments}, {moments}"));
            }
            if !(of_ranks <= 0.2 * error && ranked <= radiance) {
                failures.push(format!("{name}, {splits} splits: rank queries {of_ranks}, {ranked}"));
            }
            if !(error <= budget && radiance <= 0.03) {
                failures.push(format!("{name}, {splits} splits: {error} {radiance}"));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn pictures_of_an_orthographic_camera_reach_their_figures() {
    let _turn = gpu::turn();
    let stage = level_foliage();
    let [eight, sixteen] = [BasisFormat::Rgba8Unorm, BasisFormat::Rgba16Float];
    // All depths of the picture share the depth range: its edges are as wide as those of the basis, in metres.
    for (bases, format, budget) in [(32, eight, 0.012), (32, sixteen, 0.011), (64, sixteen, 0.006)] {
        let settings = Settings { bases, format, epipole_march: false, ..Settings::default() };
        let average = Settings { weighting: Weighting::Average, ..settings };
        let (found, method) = stage.prefiltered(stage.map([1024, 512], 1), average);
        let exact = stage.exact(&method.map.rectified, 1);
        let error = error::mean_absolute(&found.visibility, &exact.average());
        let (weighted, _) = stage.prefiltered(stage.map([1024, 512], 1), settings);
        let radiance = error::relative_rmse(&weighted.radiance, &exact.radiance());
        println!(
            "orthographic, {bases} bases, {format:?}: visibility {error:.5}, radiance {:.2} %",
            100.0 * radiance
        );
        assert!(error <= budget && radiance <= 0.03, "{format:?}: {error} {radiance}");
    }
    let six = Settings { visibility: Visibility::Moments, epipole_march: false, ..Settings::default() };
    let average = Settings { weighting: Weighting::Average, ..six };
    let (found, method) = stage.prefiltered(stage.map([1024, 512], 1), average);
    let exact = stage.exact(&method.map.rectified, 1);
    let error = error::mean_absolute(&found.visibility, &exact.average());
    let (weighted, _) = stage.prefiltered(stage.map([1024, 512], 1), six);
    let radiance = error::relative_rmse(&weighted.radiance, &exact.radiance());
    println!("orthographic, moments: visibility {error:.5}, radiance {:.2} %", 100.0 * radiance);
    assert!(error <= 0.015 && radiance <= 0.034, "moments: {error} {radiance}");
}

#[test]
fn oblique_rows_are_as_good_as_slices_up_to_the_limit_of_the_choice() {
    let _turn = gpu::turn();
    const SMALL: [u32; 2] = [192, 108];
    let (mut compared, mut failures) = ([0; 2], Vec::new());
    for name in ["foliage", "terrain", "torus", "plane"] {
        let scene = scenes::scene(name).unwrap().unwrap();
        let camera = gpu::reference_camera(&scene.view.perspective().unwrap(), SMALL);
        for turn in [1.0, 0.5, 0.3, 0.2, 0.15, 0.1, 0.03, 0.01] {
            let light = light_beside_corner(&camera, turn);
            let stage = Stage::new(&scene.mesh, camera, light, scene.medium, SMALL, 1024);
            let rows = stage.projective(3);
            let depth = stage.pictures.depth.read(gpu()).unwrap();
            let shadow_map = stage.pictures.shadow_map.read(gpu()).unwrap();
            let truth = reference::shadow_map_picture(
                &reference::Scene {
                    camera: &camera,
                    light: gpu::reference_light(&stage.light),
                    medium: gpu::reference_medium(&stage.medium),
                    depth: &depth,
                    width: SMALL[0] as usize,
                    height: SMALL[1] as usize,
                },
                &reference::ShadowMap {
                    depth: &shadow_map,
                    width: 1024,
                    height: 1024,
                    clip_from_world: gpu::matrix(stage.light.clip_from_world),
                    far_depth: 1.0,
                },
                1,
            );
            let settings = Settings { map: [513, 512], epipole_march: false, ..Settings::default() };
            let (projective, _) = stage.prefiltered(stage.map([513, 512], 3), settings);
            let method = airlight::scattering::Prefiltered::new(gpu(), shaders(), settings, SMALL).unwrap();
            let bound = method.bind(gpu(), &stage.inputs()).unwrap();
            let mut encoder = gpu().encoder();
            method.record(&mut encoder, &bound);
            gpu().submit(encoder).unwrap();
            let epipolar = scattered(&method.scattered);
            let errors =
                [&projective, &epipolar].map(|s| error::relative_rmse(&s.radiance, &truth.radiance()));
            println!(
                "{name} {turn}: obliqueness {:.1}, radiance {:.2} % projective, {:.2} % epipolar",
                rows.obliqueness,
                100.0 * errors[0],
                100.0 * errors[1]
            );
            let fine = errors[0] <= 0.002 + 1.8 * errors[1];
            let chosen = rows.obliqueness <= OBLIQUENESS_LIMIT;
            compared[usize::from(chosen)] += 1;
            if chosen && !fine || rows.obliqueness > 8.0 * OBLIQUENESS_LIMIT && fine {
                failures.push(format!("{name} {turn}: {errors:?}"));
            }
        }
    }
    assert!(failures.is_empty() && compared[0] > 5 && compared[1] > 10, "{compared:?} {failures:?}");
}

#[test]
fn regions_and_near_planes_keep_the_figures() {
    let _turn = gpu::turn();
    let scene = scenes::scene("terrain").unwrap().unwrap();
    let mut view = scene.view.perspective().unwrap();
    // A near plane that matters, and air in which the reference ray of a row is far from some of its rays.
    view.near = 6.0;
    let near = gpu::reference_camera(&view, PICTURE);
    let thick = Medium { extinction: 0.06, ..scene.medium };
    let eye = gpu::reference_camera(&scene.view.perspective().unwrap(), PICTURE);
    let cases = [
        ("from the eye", eye, scene.medium, reference::Start::Eye, [0.005, 0.005, 0.005]),
        ("from the near plane", near, scene.medium, reference::Start::NearPlane, [0.01, 0.005, 0.005]),
        ("from the near plane in thick air", near, thick, reference::Start::NearPlane, [0.03, 0.01, 0.01]),
    ];
    for (name, camera, medium, start, budgets) in cases {
        let stage = Stage::new(&scene.mesh, camera, towards(&scene), medium, PICTURE, 1024);
        let mut before = f64::INFINITY;
        for (regions, budget) in [1, 3, 8].into_iter().zip(budgets) {
            let settings = Settings {
                regions,
                format: BasisFormat::Rgba16Float,
                start: if start == reference::Start::Eye { Start::Eye } else { Start::NearPlane },
                epipole_march: false,
                ..Settings::default()
            };
            let (found, method) = stage.prefiltered(stage.map([510, 512], 3), settings);
            let exact = stage.exact_from(&method.map.rectified, 3, start);
            let error = error::relative_rmse(&found.radiance, &exact.radiance());
            println!(
                "terrain {name}, {regions} regions: radiance {:.2} % of at most {:.1} %",
                100.0 * error,
                100.0 * budget
            );
            if regions == 1 {
                let rank = Settings { visibility: Visibility::Rank { bits: 12 }, ..settings };
                let (ranked, _) = stage.prefiltered(stage.map([510, 512], 3), rank);
                let ranked = error::relative_rmse(&ranked.radiance, &exact.radiance());
                println!("terrain {name}, rank queries: radiance {:.2} %", 100.0 * ranked);
                let six = Settings { visibility: Visibility::Moments, ..settings };
                let (moments, _) = stage.prefiltered(stage.map([510, 512], 3), six);
                let moments = error::relative_rmse(&moments.radiance, &exact.radiance());
                println!("terrain {name}, moments: radiance {:.2} %", 100.0 * moments);
                assert!(moments <= budget + 0.01, "{name}, moments: {moments}");
                // In thick air both err by what the weights of the reference ray do.
                assert!(ranked <= error + 5e-4, "{name}: {ranked}");
            }
            // Regions are put together by the ray's own weights: never worse.
            assert!(error <= budget && error <= before + 5e-4, "{name}, {regions} regions: {error}");
            before = error;
        }
    }
}

#[test]
fn a_row_lit_up_to_a_column_has_its_closed_form() {
    let _turn = gpu::turn();
    // A narrow view, so that all rays of a row are nearly as long as its reference ray.
    let view = PerspectiveView {
        eye: Vec3::new(1.0, 2.0, -3.0),
        target: Vec3::new(2.0, 2.2, -9.0),
        field_of_view: 12.0,
        near: 0.1,
        far: 100.0,
        depth: DepthRange::Reversed,
    };
    const SIZE: [u32; 2] = [516, 16];
    let mesh = plane(Vec2::splat(9.0), 1);
    for (splits, lit, extinction) in
        [(1, 200, 0.02), (2, 300, 0.05), (3, 340, 0.01), (4, 400, 0.1), (4, 256, 0.0)]
    {
        let medium = Medium::new(extinction, Vec3::ONE, 0.0, 200.0).unwrap();
        let camera = gpu::reference_camera(&view, PICTURE);
        let light = Vec3::new(0.2, 1.0, 0.1).normalize();
        let mut stage = Stage::new(&mesh, camera, light, medium, PICTURE, 64);
        let mut random = Random(9);
        let depths: Vec<f32> =
            (0..PICTURE[0] * PICTURE[1]).map(|_| random.magnitude(1e-3, 1e-1) as f32).collect();
        stage.pictures.depth = gpu::texture(PICTURE, R32Float, &depths);
        let row: Vec<f32> = (0..SIZE[0]).map(|column| if column < lit { 1.0 } else { 0.0 }).collect();
        let rows = stage.reference_rows(SIZE, splits);
        let edge = rows.x_of(f64::from(lit));
        let mut worst = [0.0_f64; 4];
        for weighting in [Weighting::Average, Weighting::Transmittance] {
            let map = stage.map(SIZE, splits);
            map.rectified.write(gpu(), &row.repeat(SIZE[1] as usize)).unwrap();
            let marched = stage.marched(&map, weighting);
            let settings = Settings { weighting, bases: 128, epipole_march: false, ..Settings::default() };
            let evaluated = |map: ProjectiveMap, settings: Settings| {
                map.rectified.write(gpu(), &row.repeat(SIZE[1] as usize)).unwrap();
                let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, PICTURE).unwrap();
                let bound = method.bind(gpu(), &stage.inputs()).unwrap();
                let mut encoder = gpu().encoder();
                method.record_filter(&mut encoder, &bound);
                method.record_evaluation(&mut encoder, &bound);
                gpu().submit(encoder).unwrap();
                scattered(&method.scattered)
            };
            let found = evaluated(map, settings);
            let rank = Settings { visibility: Visibility::Rank { bits: 8 }, ..settings };
            let ranked = evaluated(stage.map(SIZE, splits), rank);
            let sigma = if weighting == Weighting::Average { 0.0 } else { f64::from(extinction) };
            let weight = |t: f64| if sigma == 0.0 { t } else { -(-sigma * t).exp_m1() / sigma };
            for (i, depth) in depths.iter().enumerate() {
                let (x, y) = (i % PICTURE[0] as usize, i / PICTURE[0] as usize);
                let ndc = ReferenceCamera::pixel_ndc(x, y, PICTURE[0] as usize, PICTURE[1] as usize);
                let distance = stage.reference.distance(ndc, f64::from(*depth));
                let cosine = rows.axes[0].dot(stage.reference.ray(ndc));
                let expected = weight(distance.min(edge / cosine)) / weight(distance);
                worst[0] = worst[0].max((f64::from(marched.visibility[i]) - expected).abs());
                worst[1] = worst[1].max((f64::from(found.visibility[i]) - expected).abs());
                let of_ranks = if weighting == Weighting::Average { 2 } else { 3 };
                worst[of_ranks] = worst[of_ranks].max((f64::from(ranked.visibility[i]) - expected).abs());
            }
        }
        println!(
            "{splits} splits, lit up to {edge:.2} m, extinction {extinction}: march {:.1e}, bases {:.1e}, \
             rank queries {:.1e}, weighted {:.1e}",
            worst[0], worst[1], worst[2], worst[3]
        );
        // f16 of the picture and f32 of the sums; 8 bits and 128 bases at the ends of the depth range.
        assert!(worst[0] < 1.5e-3 && worst[1] < 0.01, "{splits}: {worst:?}");
        // Rays weigh a little otherwise than the reference ray of their row.
        assert!(worst[2] < 1.0e-3 && worst[3] < 4e-3, "{splits}: {worst:?}");
    }
}

#[test]
fn an_orthographic_camera_is_refused_where_rays_begin_at_the_eye() {
    let _turn = gpu::turn();
    let level = orthographic(&mut Random(5), 1.5);
    let light = gpu::host_vector(level.right + level.forward * 0.2);
    let rows = projective_rows(&host_camera(&level, [96, 64]), light, LIMIT, 1).unwrap();
    for (start, expected) in [(Start::Eye, Err(SettingsError::OrthographicStart)), (Start::NearPlane, Ok(()))]
    {
        let map = ProjectiveMap::resampled(gpu(), shaders(), [16, 8]).unwrap();
        let settings = Settings { start, ..Settings::default() };
        let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, [16, 8]).unwrap();
        assert_eq!(method.write(gpu(), &rows), expected);
    }
}

#[test]
fn no_camera_light_or_input_gives_nan_or_a_value_out_of_range() {
    let _turn = gpu::turn();
    const SMALL: [u32; 2] = [16, 8];
    let mut random = Random(77);
    let depth = gpu::texture(SMALL, R32Float, &[1.0; 128]);
    let shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let first = host_camera(&random.camera(2.0), SMALL);
    let matrix = gpu::light_matrix(linear::Vec3::new(0.0, 1.0, 0.0), linear::Vec3::default(), 10.0, 1.0);
    let camera = Buffer::uniform(gpu(), &first);
    let light =
        Buffer::uniform(gpu(), &gpu::host_light(linear::Vec3::new(0.0, 1.0, 0.0), matrix, 1.0, Vec3::ONE));
    let medium = Buffer::uniform(gpu(), &Medium::new(0.1, Vec3::ONE, 0.0, 10.0).unwrap());
    let inputs = Inputs {
        camera: &camera,
        light: &light,
        medium: &medium,
        depth: &depth,
        shadow_map: &shadow_map,
        shadow_views: None,
        shadow_maps: None,
        light_texture: None,
    };
    let base = Settings {
        bases: 8,
        format: BasisFormat::Rgba16Float,
        start: Start::NearPlane,
        ..Settings::default()
    };
    let plain =
        Settings { window: false, epipole_march: false, regions: 3, weighting: Weighting::Average, ..base };
    let rank = Settings { visibility: Visibility::Rank { bits: 10 }, ..base };
    let moments = Settings { visibility: Visibility::Moments, ..base };
    let methods = [base, plain, rank, moments].map(|settings| {
        let map = ProjectiveMap::resampled(gpu(), shaders(), SMALL).unwrap();
        ProjectivePrefiltered::new(gpu(), shaders(), map, settings, SMALL).unwrap()
    });
    let bound = [0, 1, 2, 3].map(|i| methods[i].bind(gpu(), &inputs).unwrap());
    let along = Along::Projective(&methods[0].map);
    let march = March::new(gpu(), shaders(), &along, Weighting::Transmittance, SMALL).unwrap();
    let march_bound = march.bind(gpu(), &inputs, &along).unwrap();
    let (mut done, mut sum) = (0, 0.0);
    while done < 800 {
        let near = random.magnitude(1e-3, 1.0);
        let far_away = if random.unit() < 0.1 { 1e4 } else { 30.0 };
        let eye = random.direction() * random.between(0.0, far_away);
        let seen = if random.unit() < 0.3 {
            orthographic(&mut random, 2.0)
        } else {
            ReferenceCamera::perspective(&airlight_tests::reference::camera::View {
                eye: gpu::vector(gpu::host_vector(eye)),
                target: eye + random.direction(),
                up: random.direction(),
                fov_y: if random.unit() < 0.1 {
                    random.magnitude(0.002, 0.2)
                } else {
                    random.between(0.2, 2.9)
                },
                aspect: 2.0,
                near,
                far: if random.unit() < 0.3 { f64::INFINITY } else { near * random.magnitude(1.1, 1e5) },
                reversed: random.unit() < 0.5,
            })
        };
        let host = host_camera(&seen, SMALL);
        let towards = light_for(&mut random, &seen);
        let far_depth = if random.unit() < 0.5 { 1.0 } else { 0.0 };
        let air = Medium::new(
            if random.unit() < 0.15 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 },
            Vec3::new(1.0, random.unit() as f32, 0.0),
            random.between(-0.999, 0.999) as f32,
            random.magnitude(1e-3, 1e7) as f32,
        )
        .unwrap();
        let splits = random.below(4) as u32 + 1;
        let Ok(rows) = projective_rows(&host, gpu::host_vector(towards), air.distance_limit, splits) else {
            continue;
        };
        let matrix = gpu::light_matrix(towards, seen.eye, random.magnitude(0.1, 1e3), far_depth);
        camera.write(gpu(), &host);
        light.write(gpu(), &gpu::host_light(towards, matrix, far_depth, Vec3::new(1e4, 1.0, 0.0)));
        medium.write(gpu(), &air);
        let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 3.0, 1e30, 0.0, 1.0];
        let mut depths = |count: usize| -> Vec<f32> {
            let share = random.unit();
            (0..count)
                .map(|_| if random.unit() < share { wild[random.below(8)] } else { random.unit() as f32 })
                .collect()
        };
        depth.write(gpu(), &depths(128)).unwrap();
        shadow_map.write(gpu(), &depths(64)).unwrap();
        let method = &methods[done % 4];
        method.write(gpu(), &rows).unwrap();
        methods[0].map.write(gpu(), &rows);
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound[done % 4]);
        march.record(&mut encoder, &march_bound);
        gpu().submit(encoder).unwrap();
        let name = || format!("case {done}: {host:?} {rows:?} {air:?}");
        let map = method.map.rectified.read(gpu()).unwrap();
        assert!(map.iter().all(|z| (0.0..=1.0).contains(z)), "{}", name());
        let stored = &method.prefilter.textures()[0];
        let bases = if stored.0 == "bases" { stored.1.read(gpu()).unwrap() } else { Vec::new() };
        assert!(bases.iter().all(|b| (-0.01..=1.01).contains(b)), "{}", name());
        for texture in [&method.scattered, &march.scattered] {
            for texel in texture.read(gpu()).unwrap().chunks_exact(4) {
                let fine = texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.0;
                assert!(fine, "{texel:?}; {}", name());
                assert!(air.extinction > 0.0 || texel[..3] == [0.0; 3], "{texel:?}; {}", name());
                sum += f64::from(texel[3]);
            }
        }
        done += 1;
    }
    let mean = sum / (800.0 * 256.0);
    println!("mean visibility {mean:.3}");
    assert!((0.2..0.95).contains(&mean), "the random cases are not varied enough: {mean}");
}
