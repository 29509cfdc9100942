// SPDX-License-Identifier: MIT OR Apache-2.0
//! What extrusion promises whatever the map: order, idempotence, empty texels, and that the camera never sees what was added.

use super::morphed::{epipoles, morph, reference_epipole, settings};
use crate::gpu::{self, Random, gpu, shaders};
use crate::probing::f;
use crate::shadow_maps::{random_map, texture};
use airlight::core::DepthRange;
use airlight::stylize::{Element, Epipole, Form, Morphology, MorphologySettings, Operator, Width};
use airlight_tests::parallel;
use airlight_tests::reference::stylize as reference;
use glam::Vec2;

#[test]
fn closings_and_openings_keep_their_promises() {
    let mut random = Random(84);
    let size = [70, 90];
    for (name, epipole) in epipoles(&mut random, size) {
        for form in [Form::Direct, Form::Rectified] {
            let values = random_map(&mut random, size, 1.0);
            let finite: Vec<f32> = values.iter().map(|z| if z.is_finite() { *z } else { 1.0 }).collect();
            let of = |operator, values: &[f32]| {
                morph(settings(operator, form, 15, DepthRange::Forward), &epipole, &texture(size, values))
            };
            let closed = of(Operator::Closing, &values);
            assert!(closed.iter().zip(&finite).all(|(a, b)| a <= b), "{name} {form:?}");
            assert!(
                of(Operator::Opening, &values).iter().zip(&finite).all(|(a, b)| a >= b),
                "{name} {form:?}"
            );
            assert!(
                of(Operator::Dilation, &values).iter().zip(&finite).all(|(a, b)| a <= b),
                "{name} {form:?}"
            );
            assert!(
                of(Operator::Erosion, &values).iter().zip(&finite).all(|(a, b)| a >= b),
                "{name} {form:?}"
            );
            if name == "nowhere" {
                assert!(closed == finite, "{form:?}: without a direction nothing is done");
            } else {
                assert!(closed != finite, "{name} {form:?}: nothing was closed");
            }
        }
    }
}

#[test]
fn closings_of_parallel_lines_are_idempotent() {
    // Along rows no resampling takes place: what the lattice promises holds to the last bit of depth.
    let mut random = Random(85);
    let size = [90, 40];
    let epipole = Epipole { position: Vec2::NEG_X, depth: -0.01, weight: 0.0 };
    for form in [Form::Direct, Form::Rectified] {
        let values = random_map(&mut random, size, 1.0);
        let of = |values: &[f32]| {
            let settings = settings(Operator::Closing, form, 9, DepthRange::Forward);
            morph(settings, &epipole, &texture(size, values))
        };
        let once = of(&values);
        let worst = of(&once).iter().zip(&once).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{form:?}: {worst}");
    }
}

#[test]
fn empty_texels_extrude_nothing_where_the_eye_is_beyond_the_far_plane() {
    let size = [48, 48];
    let epipole = Epipole { position: Vec2::new(10.3, 20.9), depth: 3.0, weight: 1.0 };
    for form in [Form::Direct, Form::Rectified] {
        let empty = vec![1.0; 48 * 48];
        let found = morph(
            settings(Operator::Dilation, form, 31, DepthRange::Forward),
            &epipole,
            &texture(size, &empty),
        );
        assert_eq!(found, empty, "{form:?}");
    }
}

#[test]
fn what_is_added_stays_hidden_from_the_camera() {
    let size = [128_u32, 128];
    for scene in [gpu::torus_over_plane(), gpu::small_tree()] {
        let stage = scene.stage([64, 64], size);
        let epipole = Epipole::new(&stage.light, &stage.camera, size).unwrap();
        let values = stage.pictures.shadow_map.read(gpu()).unwrap();
        let map = reference::Map { depth: &values, width: 128, height: 128, far: 1.0 };
        let seen = |found: &[f32], slack: f64| {
            let rows = parallel::rows(128, |y| {
                let added: Vec<usize> =
                    (0..128).filter(|x| found[y * 128 + x] < values[y * 128 + x]).collect();
                let seen = added.iter().filter(|x| {
                    let z = f(found[y * 128 + **x]);
                    // Before the near plane of the light there is nothing to see.
                    z > 0.0 && !reference::hidden(&map, &reference_epipole(&epipole), [**x, y], z, slack)
                });
                [added.len(), seen.count()]
            });
            rows.into_iter().fold([0, 0], |a, b| [a[0] + b[0], a[1] + b[1]])
        };
        let of = |form| {
            morph(
                settings(Operator::Dilation, form, 31, DepthRange::Forward),
                &epipole,
                &stage.pictures.shadow_map,
            )
        };
        let direct = seen(&of(Form::Direct), 2e-5);
        let rectified = seen(&of(Form::Rectified), 2e-5);
        // Extrusion across the light rays, as a plain dilation does it, is seen.
        let across = MorphologySettings {
            operator: Operator::Dilation,
            element: Element::Box,
            width: Width::new(31).unwrap(),
            depth: DepthRange::Forward,
        };
        let across = Morphology::new(gpu(), shaders(), across, size).unwrap();
        let bound = across.bind(gpu(), &stage.pictures.shadow_map).unwrap();
        let mut encoder = gpu().encoder();
        across.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        let plain = seen(&across.morphed.read(gpu()).unwrap(), 2e-5);
        println!("added and seen: direct {direct:?}, rectified {rectified:?}, box {plain:?}");
        assert!(direct[0] > 500 && direct[1] == 0, "{direct:?}");
        // The line passes up to half a texel beside the centre that is looked at.
        assert!(rectified[0] > 500 && rectified[1] * 10 < rectified[0], "{rectified:?}");
        assert!(plain[1] * 4 > plain[0], "the test cannot fail: {plain:?}");
    }
}
