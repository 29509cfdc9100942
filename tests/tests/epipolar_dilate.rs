// SPDX-License-Identifier: MIT OR Apache-2.0
//! Extrusion of blockers along view rays: the direct form against Eq. 3 in f64, the rectified form against what
//! resampling may do to it, and the promise that the camera never sees what was added.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/shadow_maps.rs"]
mod shadow_maps;

use airlight::Texture;
use airlight::core::{Camera, DepthRange, Light, OrthographicView, View};
use airlight::stylize::{
    Element, EpipolarMorphology, EpipolarSettings, Epipole, Form, Morphology, MorphologySettings, Operator,
    StylizeError, Width,
};
use airlight_tests::parallel;
use airlight_tests::reference::stylize as reference;
use glam::{DMat4, DVec3, DVec4, Vec2, Vec3};
use gpu::{Random, gpu, shaders};
use shadow_maps::{random_map, texture};

const OPERATORS: [Operator; 4] =
    [Operator::Dilation, Operator::Erosion, Operator::Closing, Operator::Opening];

fn f(x: f32) -> f64 {
    f64::from(x)
}

fn far(depth: DepthRange) -> f32 {
    if depth == DepthRange::Forward { 1.0 } else { 0.0 }
}

fn settings(operator: Operator, form: Form, width: u32, depth: DepthRange) -> EpipolarSettings {
    EpipolarSettings { operator, form, width: Width::new(width).unwrap(), depth }
}

fn built(settings: EpipolarSettings, size: [u32; 2]) -> EpipolarMorphology {
    let nowhere = Epipole { position: Vec2::ZERO, depth: 0.0, weight: 0.0 };
    EpipolarMorphology::new(gpu(), shaders(), settings, &nowhere, size).unwrap()
}

/// What passes that were built before make of a map.
fn morph_with(morphology: &EpipolarMorphology, epipole: &Epipole, map: &Texture) -> Vec<f32> {
    morphology.set_epipole(gpu(), epipole).unwrap();
    let bound = morphology.bind(gpu(), map).unwrap();
    let mut encoder = gpu().encoder();
    morphology.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    morphology.morphed.read(gpu()).unwrap()
}

fn morph(settings: EpipolarSettings, epipole: &Epipole, map: &Texture) -> Vec<f32> {
    let [width, height, _] = map.size();
    morph_with(&built(settings, [width, height]), epipole, map)
}

/// Every kind of epipole: inside, exactly on a texel or a corner, outside, far, at infinity, behind the light.
fn epipoles(random: &mut Random, [width, height]: [u32; 2]) -> Vec<(&'static str, Epipole)> {
    let (w, h) = (f64::from(width), f64::from(height));
    let mut depth = || random.between(-0.5, 1.5) as f32;
    let mut at = |x: f64, y: f64, weight: f32| Epipole {
        position: Vec2::new(x as f32, y as f32) * weight,
        depth: depth() * weight,
        weight,
    };
    vec![
        ("inside", at(0.371 * w, 0.642 * h, 1.0)),
        ("on a texel", at((0.5 * w).floor() + 0.5, (0.25 * h).floor() + 0.5, 1.0)),
        ("on a corner", at((0.5 * w).floor(), (0.5 * h).floor(), 1.0)),
        ("outside", at(-0.4 * w, 0.3 * h, 1.0)),
        ("outside the corner", at(1.7 * w, 1.2 * h, 1.0)),
        ("far", at(-3e4 * w, 1.1e4 * h, 1.0)),
        ("behind the light", at(0.3 * w, -0.8 * h, -1.0)),
        ("behind the light, inside", at(0.6 * w, 0.55 * h, -1.0)),
        ("at infinity", Epipole { position: Vec2::new(0.36, -1.0), depth: 0.004, weight: 0.0 }),
        ("at infinity along a row", Epipole { position: Vec2::X, depth: -0.01, weight: 0.0 }),
        ("nowhere", Epipole { position: Vec2::ZERO, depth: 1.0, weight: 0.0 }),
    ]
}

fn reference_epipole(epipole: &Epipole) -> reference::Epipole {
    reference::Epipole {
        x: f(epipole.position.x),
        y: f(epipole.position.y),
        depth: f(epipole.depth),
        weight: f(epipole.weight),
    }
}

fn kernel<'a>(
    values: &'a [f32],
    size: [u32; 2],
    settings: EpipolarSettings,
    epipole: &Epipole,
) -> reference::Kernel<'a> {
    let [width, height] = size.map(|side| side as usize);
    reference::Kernel {
        map: reference::Map { depth: values, width, height, far: f(far(settings.depth)) },
        epipole: reference_epipole(epipole),
        width: settings.width.texels() as usize,
        spread: settings.form == Form::Rectified,
    }
}

fn expected(kernel: &reference::Kernel<'_>, operator: Operator, x: usize, y: usize) -> reference::Interval {
    match operator {
        Operator::Dilation => kernel.dilated(x, y),
        Operator::Erosion => kernel.eroded(x, y),
        Operator::Closing => kernel.closed(x, y),
        Operator::Opening => kernel.opened(x, y),
    }
}

/// Counts texels whose interval is wider than a thousandth, and asserts that all lie in theirs.
struct Tally {
    texels: usize,
    wide: usize,
    skipped: usize,
}

impl Tally {
    fn new() -> Self {
        Self { texels: 0, wide: 0, skipped: 0 }
    }

    /// `found`: stored. Results of the rectified form pass two more roundings to the line's end and back.
    fn check(
        &mut self,
        kernel: &reference::Kernel<'_>,
        found: &[f32],
        texels: &[[usize; 2]],
        operator: Operator,
        what: &str,
    ) {
        let wanted = parallel::rows(texels.len(), |i| {
            let [x, y] = texels[i];
            let skip = kernel.spread && kernel.diagonal(x, y);
            (!skip).then(|| expected(kernel, operator, x, y))
        });
        for ([x, y], wanted) in texels.iter().zip(wanted) {
            let Some(wanted) = wanted else {
                self.skipped += 1;
                continue;
            };
            let stored = f(found[y * kernel.map.width + x]);
            let depth = kernel.map.facing(stored);
            let slack = if kernel.spread { 2e-5 } else { 0.0 };
            assert!(
                depth >= wanted.least - slack && depth <= wanted.greatest + slack,
                "{what}, {operator:?} of {} at {x}, {y}: {depth}, not in {wanted:?}",
                kernel.width
            );
            self.texels += 1;
            self.wide += usize::from(wanted.greatest - wanted.least > 1e-3);
        }
    }

    fn share(&self) -> f64 {
        self.wide as f64 / self.texels as f64
    }
}

fn every_texel([width, height]: [u32; 2]) -> Vec<[usize; 2]> {
    (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| [x, y])).collect()
}

#[test]
fn the_direct_form_is_equation_3_everywhere() {
    let _turn = gpu::turn();
    let mut random = Random(81);
    let mut tally = Tally::new();
    for size in [[1, 1], [1, 9], [7, 1], [5, 4], [33, 20], [64, 64], [128, 128]] {
        let longer = size[0].max(size[1]);
        for width in [1, 3, 15, 2 * longer + 41] {
            let big = longer == 128 && width > 15;
            for operator in if big { &OPERATORS[..2] } else { &OPERATORS[..] } {
                let depth = if random.unit() < 0.3 { DepthRange::Reversed } else { DepthRange::Forward };
                let settings = settings(*operator, Form::Direct, width, depth);
                let morphology = built(settings, size);
                for (name, epipole) in epipoles(&mut random, size) {
                    let values = random_map(&mut random, size, far(depth));
                    let found = morph_with(&morphology, &epipole, &texture(size, &values));
                    let kernel = kernel(&values, size, settings, &epipole);
                    tally.check(&kernel, &found, &every_texel(size), *operator, name);
                }
            }
        }
    }
    println!("{} texels, {:.5} of them with two texels to choose from", tally.texels, tally.share());
    assert!(tally.share() < 0.01);
}

#[test]
fn the_direct_form_is_equation_3_at_random_texels_of_large_maps() {
    let _turn = gpu::turn();
    let mut random = Random(82);
    let size = [2048, 2048];
    let scene = gpu::small_tree();
    let stage = scene.stage([64, 64], size);
    let own = Epipole::new(&stage.light, &stage.camera, size).unwrap();
    let drawn = stage.pictures.shadow_map.read(gpu()).unwrap();
    let noise = random_map(&mut random, size, 1.0);
    let mut tally = Tally::new();
    for (values, map) in [(&drawn, stage.pictures.shadow_map), (&noise, texture(size, &noise))] {
        let mut all = epipoles(&mut random, size);
        all.push(("of the scene", own));
        for (name, epipole) in all {
            let texels: Vec<_> = (0..1000).map(|_| [random.below(2048), random.below(2048)]).collect();
            for (operator, width) in [(Operator::Dilation, 61), (Operator::Closing, 15)] {
                let settings = settings(operator, Form::Direct, width, DepthRange::Forward);
                let found = morph(settings, &epipole, &map);
                tally.check(&kernel(values, size, settings, &epipole), &found, &texels, operator, name);
            }
        }
    }
    println!("{} texels, {:.5} of them with two texels to choose from", tally.texels, tally.share());
    assert!(tally.share() < 0.05);
}

#[test]
fn the_rectified_form_is_the_direct_one_within_resampling() {
    let _turn = gpu::turn();
    let mut random = Random(83);
    let mut tally = Tally::new();
    for size in [[1, 1], [1, 9], [40, 33], [96, 128]] {
        let scene = gpu::torus_over_plane().stage([64, 64], size);
        let drawn = scene.pictures.shadow_map.read(gpu()).unwrap();
        let longer = size[0].max(size[1]);
        for width in [3, 15, 71, 2 * longer + 41] {
            let big = longer == 128 && width > 15;
            // Not where the second kernel begins nearer to the epipole and runs away from it, since lines spread from
            // there on: openings, and closings of an eye behind the light.
            for operator in if big { &OPERATORS[..2] } else { &OPERATORS[..3] } {
                let settings = settings(*operator, Form::Rectified, width, DepthRange::Forward);
                let morphology = built(settings, size);
                let spreads = |epipole: &Epipole| *operator == Operator::Closing && epipole.weight < 0.0;
                for (name, epipole) in epipoles(&mut random, size).into_iter().filter(|e| !spreads(&e.1)) {
                    let noise = random_map(&mut random, size, 1.0);
                    let values = if random.unit() < 0.5 { &noise } else { &drawn };
                    let found = morph_with(&morphology, &epipole, &texture(size, values));
                    let kernel = kernel(values, size, settings, &epipole);
                    tally.check(&kernel, &found, &every_texel(size), *operator, name);
                }
            }
        }
    }
    let skipped = tally.skipped as f64 / (tally.texels + tally.skipped) as f64;
    println!("{} texels, {skipped:.3} left out, wide {:.3}", tally.texels, tally.share());
    assert!(skipped < 0.15);
}

#[test]
fn both_forms_agree_on_a_drawn_map() {
    let _turn = gpu::turn();
    let size = [512, 512];
    let stage = gpu::torus_over_plane().stage([64, 64], size);
    let epipole = Epipole::new(&stage.light, &stage.camera, size).unwrap();
    for (operator, budget) in [(Operator::Dilation, 0.06), (Operator::Closing, 0.06)] {
        let of = |form| {
            morph(settings(operator, form, 61, DepthRange::Forward), &epipole, &stage.pictures.shadow_map)
        };
        let (direct, rectified) = (of(Form::Direct), of(Form::Rectified));
        let original = stage.pictures.shadow_map.read(gpu()).unwrap();
        let changed = direct.iter().zip(&original).filter(|(a, b)| a != b).count();
        let apart = direct.iter().zip(&rectified).filter(|(a, b)| (**a - **b).abs() > 2e-3).count();
        println!("{operator:?}: {changed} texels changed, {apart} of them differently");
        assert!(changed > 1000);
        assert!((apart as f64) < budget * changed as f64);
    }
}

#[test]
fn closings_and_openings_keep_their_promises() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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

#[test]
fn the_epipole_is_where_view_rays_meet() {
    let mut random = Random(86);
    let size = [300, 200];
    let mut worst = 0.0_f64;
    let check = |epipole: &Epipole, clip: DMat4, eye: DVec4, random: &mut Random, worst: &mut f64| {
        let project = |point: DVec3| {
            let clip = clip * point.extend(1.0);
            (clip.w > 0.05).then(|| {
                let [x, y, z] = [clip.x, clip.y, clip.z].map(|value| value / clip.w);
                ([150.0 * (x + 1.0), 100.0 * (1.0 - y)], z)
            })
        };
        let direction =
            if eye.w == 0.0 { -eye.truncate() } else { gpu::host_vector(random.direction()).as_dvec3() };
        let origin =
            if eye.w == 0.0 { gpu::host_vector(random.direction()).as_dvec3() * 5.0 } else { eye.truncate() };
        let [near, far] = [random.between(2.0, 6.0), random.between(7.0, 12.0)];
        let (Some((s, z)), Some((t, wanted))) =
            (project(origin + near * direction), project(origin + far * direction))
        else {
            return 0;
        };
        let epipole = reference_epipole(epipole);
        let towards = epipole.direction(t).unwrap();
        let apart = [s[0] - t[0], s[1] - t[1]];
        let along = apart[0] * towards[0] + apart[1] * towards[1];
        // Rays along light rays stay in their texel.
        if along.abs() < 1.0 {
            return 0;
        }
        let across = apart[0] * towards[1] - apart[1] * towards[0];
        assert!(along > 0.0, "the eye lies the other way: {epipole:?}");
        *worst = worst.max((across / along).abs()).max((epipole.extruded(s, z, t, 1.0) - wanted).abs());
        1
    };
    let mut checked = [0; 3];
    for _ in 0..400 {
        let towards = gpu::host_vector(random.direction());
        let (min, max) = (Vec3::splat(-20.0), Vec3::splat(20.0));
        let sun = Light::directional(towards, Vec3::ONE, min, max).unwrap();
        let camera = gpu::host_camera(&random.camera(1.5), [64, 64]);
        let epipole = Epipole::new(&sun, &camera, size).unwrap();
        let eye = camera.eye.as_dvec3().extend(1.0);
        checked[0] += check(&epipole, sun.clip_from_world.as_dmat4(), eye, &mut random, &mut worst);

        let view = OrthographicView {
            eye: gpu::host_vector(random.direction()) * 9.0,
            target: Vec3::ZERO,
            height: 4.0,
            near: 0.5,
            far: 30.0,
            depth: if random.unit() < 0.5 { DepthRange::Reversed } else { DepthRange::Forward },
        };
        let camera = Camera::new(&View::Orthographic(view), [64, 64]).unwrap();
        let epipole = Epipole::new(&sun, &camera, size).unwrap();
        assert!(epipole.weight.abs() < 1e-6);
        let eye = (view.eye - view.target).normalize().as_dvec3().extend(0.0);
        checked[1] += check(&epipole, sun.clip_from_world.as_dmat4(), eye, &mut random, &mut worst);

        // A perspective map; the eye is in front of the light or behind it.
        let clip = glam::dcamera::rh::proj::directx::perspective(1.2, 1.5, 0.1, 50.0);
        let eye = gpu::host_vector(random.direction()).as_dvec3() * random.between(1.0, 6.0);
        let epipole = Epipole::in_map(clip, eye.extend(1.0), size).unwrap();
        checked[2] += check(&epipole, clip, eye.extend(1.0), &mut random, &mut worst);
    }
    println!("{checked:?} rays, worst {worst:.1e}");
    assert!(checked.iter().all(|count| *count > 30), "{checked:?}");
    assert!(worst < 2e-4, "{worst}");
}

#[test]
fn impossible_eyes_are_errors() {
    let nan = Epipole::in_map(DMat4::IDENTITY, DVec4::new(f64::NAN, 0.0, 0.0, 1.0), [4, 4]);
    assert!(matches!(nan, Err(StylizeError::Epipole(_))));
    let nowhere = Epipole::in_map(DMat4::IDENTITY, DVec4::ZERO, [4, 4]);
    assert!(matches!(nowhere, Err(StylizeError::Epipole(_))));
    // An eye at infinity along the light is no error: nothing has a direction there.
    let along = Epipole::in_map(DMat4::IDENTITY, DVec4::Z, [4, 4]).unwrap();
    assert_eq!((along.position, along.depth, along.weight), (Vec2::ZERO, 1.0, 0.0));
}
