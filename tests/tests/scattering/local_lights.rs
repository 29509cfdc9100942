// SPDX-License-Identifier: MIT OR Apache-2.0
//! Spots, point lights and light textures in the prefiltered method and in the march, against the f64 references and closed forms.

use crate::gpu::{self, gpu, point, spot};
use crate::lit_case::*;
use airlight::Texture;
use airlight::core::DepthRange;
use airlight::scattering::{Prefiltered, Settings, Visibility, Weighting};
use airlight_tests::reference::scattering as reference;
use reference::{LocalRows, Over, Start, Weights};

// Slices and rectified maps.

#[test]
fn slices_hold_what_rays_reach_inside_the_cone() {
    for case in [Case::new("spot", spot(), None, None), Case::new("point", point(), None, None)] {
        let (method, _) = prefiltered(&case, case.settings());
        let texels = method.rectification.slices.read(gpu()).unwrap();
        case.with_reference(|scene, _| {
            let size = MAP.map(|side| side as usize);
            let exact = LocalRows::new(scene.camera, scene.light, scene.medium.distance_limit, size).unwrap();
            let (mut worst, mut wider, mut dark) = (0.0_f64, 0.0_f64, 0);
            for (slice, texel) in exact.slices.iter().zip(texels.chunks_exact(4)) {
                let missed = slice.theta_max - slice.theta_min < 2e-3;
                if slice.dark || missed || slice.alpha_max - slice.alpha_min < 1e-3 {
                    dark += 1;
                    continue;
                }
                worst = worst.max((f64::from(texel[2]) - slice.alpha_min).abs());
                // A bound of the reach: no less than it.
                worst = worst.max(slice.alpha_max - f64::from(texel[3]));
                wider = wider.max(f64::from(texel[3]) - slice.alpha_max);
            }
            println!("{}: worst {worst:.1e}, up to {wider:.3} rad more, {dark} dark slices", case.name);
            assert!(worst < 1e-3, "{}: {worst}", case.name);
            assert!(wider < 0.35, "{}: {wider}", case.name);
            assert!(dark < exact.slices.len() / 2, "{}", case.name);
        });
    }
}

#[test]
fn rectified_maps_are_those_of_the_reference() {
    for case in [Case::new("spot", spot(), None, None), Case::new("point", point(), None, None)] {
        let (method, _) = prefiltered(&case, case.settings());
        let found = method.rectification.rectified.read(gpu()).unwrap();
        case.with_reference(|scene, maps| {
            let expected = rows(scene, &method).rectify(maps, 0.02);
            let beyond = |(z, texel): (&f32, &reference::RectifiedTexel)| {
                (texel.low - f64::from(*z)).max(f64::from(*z) - texel.high)
            };
            let off = found.iter().zip(&expected).map(beyond).filter(|b| *b > 1e-3).count();
            let worst = found.iter().zip(&expected).map(beyond).fold(0.0, f64::max);
            let ambiguous = expected.iter().filter(|t| t.high - t.low > 1e-3).count();
            let blocked = found.iter().filter(|z| **z < 1.0).count();
            println!(
                "{}: worst {worst:.1e}, {off} off, {ambiguous} ambiguous, {blocked} blocked of {}",
                case.name,
                found.len()
            );
            // f32 light rays that graze a texel's edge beyond the band.
            assert!(off < found.len() / 2000, "{}: {off}", case.name);
            assert!(blocked > found.len() / 20 && ambiguous < found.len() / 10, "{}", case.name);
        });
    }
}

// Radiance.

/// The reference's picture over the rectified map that the GPU made.
fn over_rows(case: &Case, method: &Prefiltered, weights: Weights) -> reference::Picture {
    let map = method.rectification.rectified.read(gpu()).unwrap();
    case.with_reference(|scene, maps| {
        let rows = rows(scene, method);
        let fall_off = rows.fall_off(maps, scene.texture.as_ref());
        let over = Over { map: &map[..], fall_off: &fall_off, medium: scene.medium };
        scene.over_rows(&rows, &over, weights, STRIDE)
    })
}

#[test]
fn without_blockers_radiance_is_that_of_the_airlight_integral() {
    for case in [
        Case::new("spot", spot(), None, None).empty(),
        Case::new("point", point(), None, None).empty(),
        Case::new("spot, texture", spot(), Some(panes()), None).empty(),
    ] {
        let exact = case.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
        let (_, found) = prefiltered(&case, case.settings());
        let error = relative_rmse(&found, &exact);
        let march = relative_rmse(&marched(&case, 256, Weighting::Transmittance), &exact);
        println!(
            "{} without blockers: prefiltered {:.2} %, marched {:.2} %",
            case.name,
            100.0 * error,
            100.0 * march
        );
        assert!(error < 0.03, "{}: {error}", case.name);
        assert!(march < 0.01, "{}: {march}", case.name);
    }
}

#[test]
fn radiance_reaches_its_figures() {
    let cases = [
        Case::new("spot", spot(), None, None),
        Case::new("point", point(), None, None),
        Case::new("spot, texture", spot(), Some(panes()), None),
    ];
    let mut failures = Vec::new();
    for case in cases {
        let truth = case.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
        let march = relative_rmse(&marched(&case, 256, Weighting::Transmittance), &truth);
        for (weighting, weights) in
            [(Weighting::Average, Weights::Factored), (Weighting::Transmittance, Weights::Exact)]
        {
            let (method, found) = prefiltered(&case, Settings { weighting, ..case.settings() });
            let exact = over_rows(&case, &method, weights);
            let rank = Visibility::Rank { bits: 12 };
            let (_, ranked) = prefiltered(&case, Settings { weighting, visibility: rank, ..case.settings() });
            let visibility = Visibility::Moments;
            let (_, moments) = prefiltered(&case, Settings { weighting, visibility, ..case.settings() });
            let of_moments = relative_rmse(&moments, &exact);
            let other = over_rows(&case, &method, Weights::Exact);
            let error = relative_rmse(&found, &exact);
            println!(
                "{}, {}: {:.2} % of {weights:?}, {:.2} % of the exact weights, {:.2} % of the truth; march {:.2} %; \
                 rank queries {:.2} %, {:.2} %, {:.2} %; moments {:.2} %, {:.2} %, {:.2} %",
                case.name,
                gpu::weighting_name(weighting),
                100.0 * error,
                100.0 * relative_rmse(&found, &other),
                100.0 * relative_rmse(&found, &truth),
                100.0 * march,
                100.0 * relative_rmse(&ranked, &exact),
                100.0 * relative_rmse(&ranked, &other),
                100.0 * relative_rmse(&ranked, &truth),
                100.0 * of_moments,
                100.0 * relative_rmse(&moments, &other),
                100.0 * relative_rmse(&moments, &truth)
            );
            if error.is_nan() || error > 0.03 {
                failures.push(format!("{}, {weights:?}: {error}", case.name));
            }
            // Weights of the reference ray, which all rays of a row share, err more than rank queries do.
            let part = if weighting == Weighting::Average { RANKED } else { 1.0 };
            let of_ranks = relative_rmse(&ranked, &exact);
            if of_moments.is_nan() || of_moments > of_ranks + MOMENTS {
                failures.push(format!(
                    "{}, {weights:?}: moments {of_moments}, rank queries {of_ranks}",
                    case.name
                ));
            }
            if of_ranks.is_nan() || of_ranks > part * error {
                failures.push(format!("{}, {weights:?}: rank queries {of_ranks}, bases {error}", case.name));
            }
        }
        if march.is_nan() || march > 0.02 {
            failures.push(format!("{}, march: {march}", case.name));
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// The mean fall-off of each texel and color that the filter of moments stores, and that times the six moments.
fn stored_means(map: &Texture, color: u32) -> Vec<[f64; 7]> {
    let [width, height, layers] = map.size();
    let places: Vec<f32> =
        (0..height).flat_map(|y| (0..width).flat_map(move |x| [x as f32, y as f32])).collect();
    let head = "#import airlight::scattering::visibility_moments::unpack_moments
                @group(#{GROUP}) @binding(2) var map: texture_2d_array<u32>;";
    let body = format!(
        "let at = vec2<u32>(vec2<f32>(input(0u), input(1u)));
         let m = unpack_moments(textureLoad(map, at, {color}u, 0));
         let falloff = bitcast<vec4<f32>>(textureLoad(map, at, {}u, 0)).{};
         for (var k = 0u; k < 3u; k++) {{ output(k, falloff * m.low[k]); output(3u + k, falloff * m.high[k]); }}
         output(6u, falloff);",
        layers - 1,
        ["x", "y", "z"][color as usize]
    );
    let probe = gpu::Probe { head, body: &body, inputs: 2, outputs: 7 };
    let found = probe.run_with(&places, &[("map", map)]);
    found.chunks_exact(7).map(|means| std::array::from_fn(|k| f64::from(means[k]))).collect()
}

#[test]
fn moments_are_prefix_means_with_the_light_s_fall_off() {
    for (case, budget) in [
        (Case::new("spot", spot(), None, None), 5e-6),
        (Case::new("spot, texture", spot(), Some(panes()), None), 1e-4),
    ] {
        let visibility = Visibility::Moments;
        let settings = Settings { visibility, weighting: Weighting::Average, ..case.settings() };
        let (method, _) = prefiltered(&case, settings);
        let map = method.rectification.rectified.read(gpu()).unwrap();
        let fall_off =
            case.with_reference(|scene, maps| rows(scene, &method).fall_off(maps, scene.texture.as_ref()));
        let width = MAP[0] as usize;
        for color in 0..case.form.colors().unwrap() {
            let found = stored_means(method.prefilter.stored(), color);
            let (mut worst, mut mean, mut light) = (0.0_f64, 0.0, 0.0);
            for j in 0..MAP[1] as usize {
                let mut sums = [0.0; 7];
                for i in 0..width {
                    let part = fall_off[j * width + i][color as usize];
                    let own = reference::chebyshev_moments([(f64::from(map[j * width + i]), 1.0)]);
                    for k in 0..6 {
                        sums[k] += part * own[k];
                    }
                    sums[6] += part;
                    for k in 0..7 {
                        let error = (found[j * width + i][k] - sums[k] / (i + 1) as f64).abs();
                        worst = if error <= worst { worst } else { error };
                        mean += error / (7 * found.len()) as f64;
                    }
                }
                light += sums[6] / found.len() as f64;
            }
            println!("{}, color {color}: worst {worst:.1e}, mean {mean:.1e}, fall-off {light:.2}", case.name);
            assert!(worst <= budget, "{}, color {color}: {worst}", case.name);
            assert!((0.1..0.95).contains(&light), "{light}");
        }
    }
}

#[test]
fn the_view_of_the_tests_is_forward() {
    // `Case` reads shadow maps and depth as forward.
    assert_eq!(gpu::torus_over_plane().view.depth, DepthRange::Forward);
}
