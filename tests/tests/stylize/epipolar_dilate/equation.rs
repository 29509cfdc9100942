// SPDX-License-Identifier: MIT OR Apache-2.0
//! Both forms against Eq. 3 in f64, texel by texel, and against each other.

use super::morphed::{OPERATORS, built, epipoles, far, morph, morph_with, reference_epipole, settings};
use crate::gpu::{self, Random, gpu};
use crate::probing::f;
use crate::shadow_maps::{random_map, texture};
use airlight::core::DepthRange;
use airlight::stylize::{EpipolarSettings, Epipole, Form, Operator};
use airlight_tests::parallel;
use airlight_tests::reference::stylize as reference;

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
    let mut random = Random(82);
    let mut tally = Tally::new();
    // Large along one axis each: a place of 2000 texels is as coarse in f32 in a narrow map as in a square one.
    for (size, is_drawn) in [([2048, 512], true), ([512, 2048], false)] {
        let passes = [(Operator::Dilation, 61), (Operator::Closing, 15)].map(|(operator, width)| {
            let settings = settings(operator, Form::Direct, width, DepthRange::Forward);
            (operator, settings, built(settings, size))
        });
        let stage = gpu::small_tree().stage([64, 64], size);
        let drawn = &stage.pictures.shadow_map;
        let values = if is_drawn { drawn.read(gpu()).unwrap() } else { random_map(&mut random, size, 1.0) };
        let noise = texture(size, &values);
        let map = if is_drawn { drawn } else { &noise };
        let mut all = epipoles(&mut random, size);
        all.push(("of the scene", Epipole::new(&stage.light, &stage.camera, size).unwrap()));
        for (name, epipole) in all {
            let [width, height] = size.map(|side| side as usize);
            let texels: Vec<_> = (0..1000).map(|_| [random.below(width), random.below(height)]).collect();
            for (operator, settings, morphology) in &passes {
                let found = morph_with(morphology, &epipole, map);
                let kernel = kernel(&values, size, *settings, &epipole);
                tally.check(&kernel, &found, &texels, *operator, name);
            }
        }
    }
    println!("{} texels, {:.5} of them with two texels to choose from", tally.texels, tally.share());
    assert!(tally.share() < 0.05);
}

#[test]
fn the_rectified_form_is_the_direct_one_within_resampling() {
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
