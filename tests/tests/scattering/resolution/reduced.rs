// SPDX-License-Identifier: MIT OR Apache-2.0
//! Fewer pixels: evaluated ones are those of the full picture, upsampled ones come near the exact picture.

use super::cameras::any_camera;
use super::case::{Case, channels, rectified, submit};
use crate::gpu::{self, Random, gpu, shaders};
use crate::probing::f;
use airlight::scattering::{Along, Inputs, Interpolated, Prefiltered, Resolution, Settings};
use airlight_tests::error;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;

#[test]
fn reduced_cameras_look_through_the_centres_of_evaluated_pixels() {
    let mut random = Random(41);
    let (mut worst, mut round_trip) = (0.0_f64, 0.0_f64);
    for _ in 0..500 {
        let viewport = [1 + random.below(200) as u32, 1 + random.below(200) as u32];
        let camera = any_camera(&mut random, viewport);
        for factor in [1_u32, 2, 3, 4] {
            let reduced = camera.reduced(factor);
            let size = viewport.map(|side| side.div_ceil(factor));
            assert_eq!(reduced.viewport.to_array(), size.map(|side| side as f32));
            let at = [random.below(size[0] as usize), random.below(size[1] as usize)];
            let ndc = |pixel: [usize; 2], [width, height]: [u32; 2]| {
                ReferenceCamera::pixel_ndc(pixel[0], pixel[1], width as usize, height as usize)
            };
            let depth = random.unit();
            let unproject = |camera: &airlight::core::Camera, [x, y]: [f64; 2]| {
                gpu::matrix(camera.world_from_clip).apply([x, y, depth, 1.0])
            };
            let full = unproject(&camera, ndc(at.map(|a| a * factor as usize), viewport));
            let found = unproject(&reduced, ndc(at, size));
            // Homogeneous points, equal with their scale: rays and distances are the same, as far as f32 holds
            // the matrix.
            let scale =
                camera.world_from_clip.to_cols_array().map(|x| f(x).abs()).into_iter().fold(1.0, f64::max);
            worst = full.iter().zip(found).map(|(a, b)| (a - b).abs() / scale).fold(worst, f64::max);
            // The matrices stay each other's inverses, as far as they were.
            let product = gpu::matrix(reduced.clip_from_world).apply(found);
            let before = gpu::matrix(camera.clip_from_world).apply(full);
            let off = |p: [f64; 4], [x, y]: [f64; 2]| (p[0] - x * p[3]).abs().max((p[1] - y * p[3]).abs());
            let excess = off(product, ndc(at, size))
                - 4.0 * off(before, ndc(at.map(|a| a * factor as usize), viewport));
            round_trip = round_trip.max(excess);
        }
    }
    println!("reduced cameras: points {worst:.1e}, round trip {round_trip:.1e}");
    assert!(worst < 1e-6 && round_trip < 2e-3, "{worst:e} {round_trip:e}");
}

/// Radiance with average visibility: both visibilities vanish together.
fn average_radiance(picture: &reference::Picture) -> Vec<f64> {
    let scale = |p: &reference::Pixel| if p.weighted > 0.0 { p.average / p.weighted } else { 0.0 };
    picture.pixels.iter().flat_map(|p| p.radiance.map(|l| l * scale(p))).collect()
}

#[test]
fn evaluated_pixels_are_those_of_the_full_picture() {
    // A size that is no multiple of the factors.
    let case = Case::new("foliage", [479, 269]);
    let inputs = case.stage.inputs();
    let along = Along::ShadowMap { steps: 256 };
    let full = case.march(&inputs, &along, case.size).scattered.read(gpu()).unwrap();
    let depth = case.stage.pictures.depth.read(gpu()).unwrap();
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let reduced = case.reduced(resolution);
        let factor = resolution.factor() as usize;
        let [width, height] = reduced.viewport().map(|side| side as usize);
        assert_eq!([width, height], [479_usize.div_ceil(factor), 269_usize.div_ceil(factor)]);
        let depths = reduced.depth.read(gpu()).unwrap();
        let march = case.march(&reduced.inputs(&inputs), &along, reduced.viewport());
        let found = march.scattered.read(gpu()).unwrap();
        let mut visibilities: [Vec<f32>; 2] = [Vec::new(), Vec::new()];
        let mut radiances = visibilities.clone();
        for y in 0..height {
            for x in 0..width {
                let (from, to) = (y * factor * 479 + x * factor, y * width + x);
                assert_eq!(depths[to], depth[from], "pixel ({x}, {y})");
                visibilities[0].push(found[4 * to + 3]);
                visibilities[1].push(full[4 * from + 3]);
                radiances[0].extend(&found[4 * to..4 * to + 3]);
                radiances[1].extend(&full[4 * from..4 * from + 3]);
            }
        }
        // Rounding of the matrices moves a ray over the edge of a texel here and there.
        let visibility = error::mean_absolute(&visibilities[0], &visibilities[1]);
        let radiance = error::relative_rmse(&radiances[0], &radiances[1]);
        println!("1/{factor}: visibility {visibility:.1e}, radiance {radiance:.1e}");
        assert!(visibility < 1e-3 && radiance < 5e-3, "{visibility:e} {radiance:e}");
    }
}

#[test]
fn upsampled_radiance_is_that_of_the_exact_picture() {
    // Budgets at this size, where a leaf covers a quarter of the pixels that it covers at 1920x1080:
    // half, quarter.
    for (name, budgets) in
        [("foliage", [0.01, 0.015]), ("terrain", [0.002, 0.003]), ("torus", [0.003, 0.004])]
    {
        let case = Case::new(name, [959, 539]);
        let inputs = case.stage.inputs();
        let exact = average_radiance(&case.exact(&case.map, 1));
        let along = Along::RowSteps { map: &case.map, steps: 512 };
        let full = case.march(&inputs, &along, case.size).scattered.read(gpu()).unwrap();
        let baseline = error::relative_rmse(&channels(&full, 0..3), &exact);
        for (resolution, budget) in [Resolution::Half, Resolution::Quarter].into_iter().zip(budgets) {
            let reduced = case.reduced(resolution);
            let map = rectified(&reduced.inputs(&inputs));
            let exact = average_radiance(&case.exact(&map, resolution.factor()));
            let along = Along::RowSteps { map: &map, steps: 512 };
            let march = case.march(&reduced.inputs(&inputs), &along, reduced.viewport());
            let of = |interpolated| {
                let picture = case.upsampled(&reduced, &march.scattered, interpolated);
                error::relative_rmse(&channels(&picture, 0..3), &exact)
            };
            let (visibility, radiance) = (of(Interpolated::Visibility), of(Interpolated::Radiance));
            println!(
                "{name} 1/{}: {visibility:.4}, interpolating radiance {radiance:.4}, full {baseline:.4}",
                resolution.factor()
            );
            assert!(visibility <= budget, "{name}, {resolution:?}: {visibility} exceeds {budget}");
            assert!(radiance <= 3.0 * budget, "{name}, {resolution:?}: {radiance}");
        }
    }
}

#[test]
fn prefiltered_pictures_are_upsampled_as_well() {
    let case = Case::new("foliage", [960, 540]);
    let inputs = case.stage.inputs();
    let settings = Settings { map: [512, 512], epipole_march: false, ..Settings::default() };
    let evaluated = |viewport: [u32; 2], inputs: &Inputs<'_>| {
        let method = Prefiltered::new(gpu(), shaders(), settings, viewport).unwrap();
        let bound = method.bind(gpu(), inputs).unwrap();
        submit(|encoder| method.record(encoder, &bound));
        method
    };
    let method = evaluated(case.size, &inputs);
    let exact = case.exact(&method.rectification, 1).radiance();
    let full = error::relative_rmse(&channels(&method.scattered.read(gpu()).unwrap(), 0..3), &exact);
    for resolution in [Resolution::Half, Resolution::Quarter] {
        let reduced = case.reduced(resolution);
        let method = evaluated(reduced.viewport(), &reduced.inputs(&inputs));
        let picture = case.upsampled(&reduced, &method.scattered, Interpolated::Visibility);
        let exact = case.exact(&method.rectification, resolution.factor()).radiance();
        let found = error::relative_rmse(&channels(&picture, 0..3), &exact);
        println!("prefiltered 1/{}: {found:.4}, full {full:.4}", resolution.factor());
        assert!(found <= full + 0.01, "{resolution:?}: {found}, full {full}");
    }
}
