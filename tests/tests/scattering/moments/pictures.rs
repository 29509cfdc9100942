// SPDX-License-Identifier: MIT OR Apache-2.0
//! The error that six moments leave on scenes, pictures against the exact ones, and settings that are refused.

use super::filter::{filtered, read};
use crate::gpu::{self, gpu, shaders};
use airlight::scattering::{
    Filtering, Inputs, LightForm, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Rectification,
    ScatteringError, Settings, SettingsError, Start, Visibility, Weighting,
};
use airlight::{Stage, scenes};
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;

/// Mean and greatest error of visibility on a scene.
#[derive(Debug, Default)]
struct Errors {
    mean: f64,
    greatest: f64,
}

#[test]
fn errors_on_scenes_are_those_of_the_book() {
    // Bounds of the mean errors of plain means and of means by transmittance, and of the greatest of either.
    for (name, means, greatest) in [
        ("foliage", [0.0107, 0.0101], 0.2),
        ("torus", [0.01, 0.0123], 0.11),
        ("plane", [0.0099, 0.0087], 0.15),
        ("terrain", [0.005, 0.0047], 0.18),
    ] {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), PICTURE, [1024, 1024]).unwrap();
        let map = Rectification::new(gpu(), shaders(), [1024, 1024]).unwrap();
        let bound = map.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        map.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let rectified = map.rectified.read(gpu()).unwrap();
        let extinction = f64::from(stage.medium.extinction);
        // The row next to each pixel, where its ray ends in it, and what is visible of it.
        let rays = gpu::of_pixels(&stage, &view, &map, |rectification, ray| {
            let j = ray.nearest();
            let end = ray.end(rectification, j, extinction);
            (j, end, reference::row_visibility(&rectified[j * 1024..(j + 1) * 1024], end))
        });
        let values: Vec<f32> = rays
            .iter()
            .flat_map(|(j, end, _)| [(end.s - 0.5).max(0.5) as f32, *j as f32, end.z as f32])
            .collect();
        let body = "output(0u, moments_visibility(map, vec2<f32>(input(0u), input(1u)), false, input(2u)));";
        for (weighting, weights, mean) in
            [("average", None, means[0]), ("transmittance", Some((&stage.medium, &map.slices)), means[1])]
        {
            let found = read(&filtered(&map.rectified, weights), body, 3, 1, &values);
            let mut errors = Errors::default();
            for (found, (_, _, exact)) in found.iter().zip(&rays) {
                let exact = if weights.is_some() { exact.weighted } else { exact.average };
                let error = (f64::from(*found) - exact).abs();
                errors.mean += error / rays.len() as f64;
                errors.greatest = errors.greatest.max(error);
            }
            println!("{name}, {weighting}: mean {:.4}, greatest {:.2}", errors.mean, errors.greatest);
            assert!(errors.mean < mean && errors.greatest < greatest, "{name}, {weighting}: {errors:?}");
        }
    }
}

/// Size of the pictures.
const PICTURE: [u32; 2] = [480, 270];

/// Moments of a map of 1024 x 1024 texels, read and weighted in one of the ways there are; no march near the epipole.
fn settings(filtering: Filtering, weighting: Weighting) -> Settings {
    Settings {
        visibility: Visibility::Moments,
        map: [1024, 1024],
        filtering,
        weighting,
        epipole_march: false,
        ..Settings::default()
    }
}

/// A picture, four values a pixel, and the map that it came from.
fn picture(inputs: &Inputs<'_>, settings: Settings) -> (Vec<f32>, Rectification) {
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    (method.scattered.read(gpu()).unwrap(), method.rectification)
}

#[test]
fn pictures_are_near_the_exact_ones() {
    let reads = [Filtering::Linear, Filtering::Nearest];
    let mut failures = Vec::new();
    // Bounds of the mean errors of plain means and of means by transmittance; of the greatest error; and of the relative
    // root of the mean square of radiance.
    for (name, means, greatest, radiance) in [
        ("foliage", [0.0109, 0.0104], 0.22, 0.013),
        ("torus", [0.0103, 0.0125], 0.105, 0.0195),
        ("plane", [0.0102, 0.0089], 0.155, 0.02),
        ("terrain", [0.0056, 0.0051], 0.175, 0.0085),
    ] {
        let scene = scenes::scene(name).unwrap().unwrap();
        let view = scene.view.perspective().unwrap();
        let stage = Stage::new(gpu(), gpu::raster(), &scene.setting(), PICTURE, [1024, 1024]).unwrap();
        let mut exact = None;
        for (filtering, weighting) in
            reads.into_iter().flat_map(|r| [Weighting::Average, Weighting::Transmittance].map(|w| (r, w)))
        {
            let (found, map) = picture(&stage.inputs(), settings(filtering, weighting));
            let exact = exact.get_or_insert_with(|| gpu::exact_picture(&stage, &view, &map, 1));
            let visibility: Vec<f32> = found.chunks_exact(4).map(|texel| texel[3]).collect();
            let colours: Vec<f32> = found.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect();
            let (truth, mean) = match weighting {
                Weighting::Average => (exact.average(), means[0]),
                Weighting::Transmittance => (exact.weighted(), means[1]),
            };
            let errors = Errors {
                mean: error::mean_absolute(&visibility, &truth),
                greatest: error::max_absolute(&visibility, &truth),
            };
            // The exact radiance is weighted by transmittance.
            let relative = match weighting {
                Weighting::Average => 0.0,
                Weighting::Transmittance => error::relative_rmse(&colours, &exact.radiance()),
            };
            let what = format!("{name}, {filtering:?}, {weighting:?}");
            println!("{what}: mean {:.4}, greatest {:.3}", errors.mean, errors.greatest);
            if relative > 0.0 {
                println!("    radiance {:.2} %", 100.0 * relative);
            }
            if !(errors.mean <= mean && errors.greatest <= greatest && relative <= radiance) {
                failures.push(what);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn no_permutation_gives_nan_or_a_value_out_of_range() {
    for scene in [gpu::torus_over_plane(), gpu::small_tree()] {
        let stage = scene.stage(PICTURE, [512, 512]);
        for index in 0..16 {
            let bit = |k: usize| index >> k & 1 == 1;
            let filtering = if bit(0) { Filtering::Nearest } else { Filtering::Linear };
            let weighting = if bit(1) { Weighting::Average } else { Weighting::Transmittance };
            let settings = Settings {
                map: [256, 256],
                epipole_march: bit(2),
                start: if bit(3) { Start::NearPlane } else { Start::Eye },
                ..settings(filtering, weighting)
            };
            let (found, _) = picture(&stage.inputs(), settings);
            let fine = |texel: &[f32]| texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.0;
            assert!(found.chunks_exact(4).all(fine), "{settings:?}");
            let mean = found.chunks_exact(4).map(|texel| f64::from(texel[3])).sum::<f64>() / (480.0 * 270.0);
            assert!((0.2..0.98).contains(&mean), "{settings:?}: {mean}");
        }
    }
}

#[test]
fn what_moments_cannot_do_is_refused() {
    let plain = settings(Filtering::Linear, Weighting::Average);
    let spot = LightForm { spot: true, ..LightForm::default() };
    let texture = LightForm { texture: true, ..LightForm::default() };
    let point = LightForm { point: true, shadow_array: true, ..LightForm::default() };
    let refused = |error: Option<ScatteringError>, needed: &str| {
        let Some(ScatteringError::Settings(error)) = error else { panic!("{error:?} instead of: {needed}") };
        assert!(matches!(error, SettingsError::Visibility { method: "moments", .. }), "{error:?}");
        let sentence = format!("the method `moments` needs {needed}; `fourier` does without");
        assert_eq!(error.to_string(), sentence);
    };
    refused(
        Prefiltered::new(gpu(), shaders(), Settings { regions: 3, ..plain }, PICTURE).err(),
        "rows in one region",
    );
    let map = || ProjectiveMap::drawn(gpu(), plain.map).unwrap();
    let parts = Settings { regions: 3, ..plain };
    refused(ProjectivePrefiltered::new(gpu(), shaders(), map(), parts, PICTURE).err(), "rows in one region");
    // All lights and rows, with and without colours.
    for light in [LightForm::default(), spot, LightForm { texture: true, ..spot }, texture, point] {
        let method = Prefiltered::new(gpu(), shaders(), Settings { light, map: [64, 16], ..plain }, [16, 16]);
        let method = method.unwrap();
        let layers = light.colors().map_or(1, |colors| colors + 1);
        assert_eq!(method.prefilter.stored().size(), [64, 16, layers]);
        assert_eq!(method.prefilter.memory(), u64::from(64 * 16 * layers * 16));
    }
    assert!(ProjectivePrefiltered::new(gpu(), shaders(), map(), plain, PICTURE).is_ok());
}
