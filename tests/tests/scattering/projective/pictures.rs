// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of scenes against the exact ones, within the figures that the book states.

use super::cameras::light_beside_corner;
use super::stage::{PICTURE, Scattered, Stage, gallery, level_foliage, scattered, towards};
use crate::gpu::{self, gpu, shaders};
use airlight::scattering::{
    BasisFormat, Medium, OBLIQUENESS_LIMIT, ProjectiveMap, ProjectivePrefiltered, Settings, Start,
    Visibility, Weighting,
};
use airlight::scenes;
use airlight_tests::error;
use airlight_tests::reference::scattering as reference;

#[test]
fn marched_rows_are_the_exact_sums() {
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

/// Each way to a picture over rows of one map, plain and weighted by transmittance: bases, rank queries, moments.
fn six_ways(map: [u32; 2]) -> [ProjectivePrefiltered; 6] {
    let ways = [Settings::default().visibility, Visibility::Rank { bits: 12 }, Visibility::Moments];
    let method = |settings| {
        let map = ProjectiveMap::resampled(gpu(), shaders(), map).unwrap();
        ProjectivePrefiltered::new(gpu(), shaders(), map, settings, PICTURE).unwrap()
    };
    std::array::from_fn(|index| {
        let weighting = [Weighting::Average, Settings::default().weighting][index % 2];
        method(Settings { visibility: ways[index / 2], weighting, ..Settings::default() })
    })
}

#[test]
fn pictures_reach_their_figures() {
    let mut failures = Vec::new();
    // Splits of three need columns that they divide.
    let [even, of_three] = [[512, 512], [513, 512]].map(six_ways);
    for (name, budget) in [("foliage", 0.006), ("terrain", 0.006), ("plane", 0.02), ("torus", 0.02)] {
        let stage = gallery(name);
        for splits in 1..=4 {
            // The figures hold from two splits on. One alone, which is the thesis' row, gives most of its texels to the
            // first metre, and the rest are too few to average the ringing out: 0.0082 on foliage misses 0.006.
            let budget = if splits == 1 { 1.5 * budget } else { budget };
            let methods = if splits == 3 { &of_three } else { &even };
            let found = methods.each_ref().map(|method| stage.evaluated(method, splits));
            // Every third pixel: of all places in squares of two and four pixels, and enough for means.
            let exact = stage.exact_from(&methods[0].map.rectified, splits, reference::Start::Eye, 3);
            let of_visibility = |found: &Scattered| {
                let own = exact.sample(&found.visibility, PICTURE[0] as usize, 1, 0..1);
                error::mean_absolute(&own, &exact.average())
            };
            let of_radiance = |found: &Scattered| {
                let own = exact.sample(&found.radiance, PICTURE[0] as usize, 3, 0..3);
                error::relative_rmse(&own, &exact.radiance())
            };
            let [error, of_ranks, of_moments] = [0, 2, 4].map(|way| of_visibility(&found[way]));
            let [radiance, ranked, moments] = [1, 3, 5].map(|way| of_radiance(&found[way]));
            println!(
                "{name}, {splits} splits, obliqueness {:.1}: visibility {error:.5} of at most {budget}, radiance {:.2} %; \
                 rank queries {of_ranks:.5}, {:.2} %; moments {of_moments:.5}, {:.2} %",
                stage.projective(splits).obliqueness,
                100.0 * radiance,
                100.0 * ranked,
                100.0 * moments
            );
            // About what they err by over epipolar rows, see `moments/pictures.rs`.
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
    let stage = level_foliage();
    // The map is that of the rows, whatever is made of it.
    let map = stage.map([1024, 512], 1).rectified;
    let exact = stage.exact(&map, 1);
    let map = map.read(gpu()).unwrap();
    let [eight, sixteen] = [BasisFormat::Rgba8Unorm, BasisFormat::Rgba16Float];
    // All depths of the picture share the depth range: its edges are as wide as those of the basis, in metres.
    for (bases, format, budget) in [(32, eight, 0.012), (32, sixteen, 0.011), (64, sixteen, 0.006)] {
        let settings = Settings { bases, format, epipole_march: false, ..Settings::default() };
        let average = Settings { weighting: Weighting::Average, ..settings };
        let (found, method) = stage.prefiltered(stage.map([1024, 512], 1), average);
        assert!(method.map.rectified.read(gpu()).unwrap() == map, "{format:?}: another map");
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
    assert!(method.map.rectified.read(gpu()).unwrap() == map, "moments: another map");
    let error = error::mean_absolute(&found.visibility, &exact.average());
    let (weighted, _) = stage.prefiltered(stage.map([1024, 512], 1), six);
    let radiance = error::relative_rmse(&weighted.radiance, &exact.radiance());
    println!("orthographic, moments: visibility {error:.5}, radiance {:.2} %", 100.0 * radiance);
    assert!(error <= 0.015 && radiance <= 0.034, "moments: {error} {radiance}");
}

#[test]
fn oblique_rows_are_as_good_as_slices_up_to_the_limit_of_the_choice() {
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
        // The map is that of the rows, however many regions evaluate it.
        let map = stage.map([510, 512], 3).rectified;
        let exact = stage.exact_from(&map, 3, start, 1).radiance();
        let map = map.read(gpu()).unwrap();
        for (regions, budget) in [1, 3, 8].into_iter().zip(budgets) {
            let settings = Settings {
                regions,
                format: BasisFormat::Rgba16Float,
                start: if start == reference::Start::Eye { Start::Eye } else { Start::NearPlane },
                epipole_march: false,
                ..Settings::default()
            };
            let (found, method) = stage.prefiltered(stage.map([510, 512], 3), settings);
            assert!(
                method.map.rectified.read(gpu()).unwrap() == map,
                "{name}, {regions} regions: another map"
            );
            let error = error::relative_rmse(&found.radiance, &exact);
            println!(
                "terrain {name}, {regions} regions: radiance {:.2} % of at most {:.1} %",
                100.0 * error,
                100.0 * budget
            );
            if regions == 1 {
                let rank = Settings { visibility: Visibility::Rank { bits: 12 }, ..settings };
                let (ranked, _) = stage.prefiltered(stage.map([510, 512], 3), rank);
                let ranked = error::relative_rmse(&ranked.radiance, &exact);
                println!("terrain {name}, rank queries: radiance {:.2} %", 100.0 * ranked);
                let six = Settings { visibility: Visibility::Moments, ..settings };
                let (moments, _) = stage.prefiltered(stage.map([510, 512], 3), six);
                let moments = error::relative_rmse(&moments.radiance, &exact);
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
