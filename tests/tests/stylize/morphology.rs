// SPDX-License-Identifier: MIT OR Apache-2.0
//! Box and disc on shadow maps: equal to the f64 reference bit for bit, and what closings and openings promise.

use crate::gpu::{self, Random, gpu, shaders};
use crate::shadow_maps::{random_map, texture};
use airlight::Texture;
use airlight::core::DepthRange;
use airlight::stylize::{Element, Morphology, MorphologySettings, Operator, StylizeError, Width};
use airlight_tests::parallel;
use airlight_tests::reference::stylize as reference;

const OPERATORS: [Operator; 4] =
    [Operator::Dilation, Operator::Erosion, Operator::Closing, Operator::Opening];
const ELEMENTS: [Element; 2] = [Element::Box, Element::Disc];

fn settings(operator: Operator, element: Element, width: u32, depth: DepthRange) -> MorphologySettings {
    MorphologySettings { operator, element, width: Width::new(width).unwrap(), depth }
}

fn morph(settings: MorphologySettings, map: &Texture) -> Vec<f32> {
    let [width, height, _] = map.size();
    let morphology = Morphology::new(gpu(), shaders(), settings, [width, height]).unwrap();
    let bound = morphology.bind(gpu(), map).unwrap();
    let mut encoder = gpu().encoder();
    morphology.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    morphology.morphed.read(gpu()).unwrap()
}

fn reference_of<'a>(
    values: &'a [f32],
    size: [u32; 2],
    settings: MorphologySettings,
) -> reference::Morphology<'a> {
    let far = if settings.depth == DepthRange::Forward { 1.0 } else { 0.0 };
    reference::Morphology {
        map: reference::Map { depth: values, width: size[0] as usize, height: size[1] as usize, far },
        element: match settings.element {
            Element::Box => reference::Element::Box,
            Element::Disc => reference::Element::Disc,
        },
        radius: i64::from(settings.width.radius()),
    }
}

fn expected(of: &reference::Morphology<'_>, operator: Operator, x: usize, y: usize) -> f64 {
    match operator {
        Operator::Dilation => of.dilated(x, y),
        Operator::Erosion => of.eroded(x, y),
        Operator::Closing => of.closed(x, y),
        Operator::Opening => of.opened(x, y),
    }
}

/// Compares every texel. The second stage of closings and openings is given the first, as the reference made it.
fn compare(values: &[f32], size: [u32; 2], settings: MorphologySettings) {
    let found = morph(settings, &texture(size, values));
    let [width, height] = size.map(|side| side as usize);
    let all = |values: &[f32], operator: Operator| -> Vec<f32> {
        let of = reference_of(values, size, settings);
        let row = |y| (0..width).map(|x| expected(&of, operator, x, y) as f32).collect::<Vec<_>>();
        parallel::rows(height, row).concat()
    };
    let wanted = match settings.operator {
        Operator::Dilation | Operator::Erosion => all(values, settings.operator),
        Operator::Closing => all(&all(values, Operator::Dilation), Operator::Erosion),
        Operator::Opening => all(&all(values, Operator::Erosion), Operator::Dilation),
    };
    let wrong = found.iter().zip(&wanted).filter(|(a, b)| a != b).count();
    assert_eq!(wrong, 0, "{settings:?} on {size:?}: {wrong} of {} texels", found.len());
}

#[test]
fn every_operator_equals_its_reference_everywhere() {
    let mut random = Random(71);
    let sizes = [[1, 1], [1, 7], [9, 1], [2, 3], [13, 31], [64, 48], [128, 128]];
    for size in sizes {
        let longer = size[0].max(size[1]);
        let widths: &[u32] = if longer == 128 { &[5, 31, 63, 65, 169] } else { &[1, 3, 11, 65] };
        for width in widths.iter().copied().chain([2 * longer - 1, 2 * longer + 41]) {
            for element in ELEMENTS {
                // The reference looks at every texel of every window.
                let heavy = longer == 128 && width > 31;
                let operators = if heavy { &OPERATORS[random.below(4)..][..1] } else { &OPERATORS[..] };
                for operator in operators {
                    let reversed = random.unit() < 0.3;
                    let (depth, far) =
                        if reversed { (DepthRange::Reversed, 0.0) } else { (DepthRange::Forward, 1.0) };
                    let values = random_map(&mut random, size, far);
                    compare(&values, size, settings(*operator, element, width, depth));
                }
            }
        }
    }
}

/// A map of 2048 x 2048: drawn, and at random.
fn large_maps() -> [(&'static str, Texture); 2] {
    let size = [2048, 2048];
    let stage = gpu::small_tree().stage([64, 64], size);
    let values = random_map(&mut Random(5), size, 1.0);
    [("tree", stage.pictures.shadow_map), ("random", texture(size, &values))]
}

#[test]
fn every_operator_equals_its_reference_at_random_texels_of_large_maps() {
    let mut random = Random(72);
    for (name, map) in large_maps() {
        let values = map.read(gpu()).unwrap();
        for element in ELEMENTS {
            for (operator, width, count) in [
                (Operator::Dilation, 61, 1000),
                (Operator::Erosion, 101, 1000),
                (Operator::Closing, 11, 1000),
                (Operator::Opening, 9, 1000),
                (Operator::Closing, 61, 12),
            ] {
                let settings = settings(operator, element, width, DepthRange::Forward);
                let found = morph(settings, &map);
                let of = reference_of(&values, [2048, 2048], settings);
                let texels: Vec<[usize; 2]> =
                    (0..count).map(|_| [random.below(2048), random.below(2048)]).collect();
                let wanted =
                    parallel::rows(count, |i| expected(&of, operator, texels[i][0], texels[i][1]) as f32);
                for ([x, y], wanted) in texels.iter().zip(wanted) {
                    assert_eq!(found[y * 2048 + x], wanted, "{name}: {settings:?} at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn closings_and_openings_keep_their_promises() {
    let mut random = Random(73);
    let size = [97, 83];
    for element in ELEMENTS {
        for width in [3, 9, 35, 301] {
            let values = random_map(&mut random, size, 1.0);
            let finite: Vec<f32> = values.iter().map(|z| if z.is_finite() { *z } else { 1.0 }).collect();
            let of = |operator, values: &[f32]| {
                morph(settings(operator, element, width, DepthRange::Forward), &texture(size, values))
            };
            let closed = of(Operator::Closing, &values);
            let opened = of(Operator::Opening, &values);
            assert!(closed.iter().zip(&finite).all(|(a, b)| a <= b), "closings only add blockers");
            assert!(opened.iter().zip(&finite).all(|(a, b)| a >= b), "openings only take them away");
            assert_eq!(of(Operator::Closing, &closed), closed, "{element:?} {width}");
            assert_eq!(of(Operator::Opening, &opened), opened, "{element:?} {width}");
            assert!(width > 200 || closed.iter().zip(&finite).any(|(a, b)| a < b), "nothing was closed");
        }
    }
}

#[test]
fn holes_are_filled_up_to_the_width_of_the_kernel() {
    let size = [64_u32, 64];
    for (element, hole) in [(Element::Box, 6_usize), (Element::Disc, 6)] {
        // A blocker with a square hole.
        let inside = |i: usize, side: usize| (20..20 + side).contains(&i);
        let map: Vec<f32> = (0..64 * 64)
            .map(|i| if inside(i % 64, hole) && inside(i / 64, hole) { 1.0 } else { 0.25 })
            .collect();
        let open = |width| {
            let closed =
                morph(settings(Operator::Closing, element, width, DepthRange::Forward), &texture(size, &map));
            closed.iter().filter(|z| **z == 1.0).count()
        };
        assert_eq!(open(5), if element == Element::Box { 36 } else { open(5) });
        assert!(open(5) > 0, "a hole wider than the kernel stays");
        assert_eq!(open(11), 0, "{element:?}: a hole narrower than the kernel is filled");
    }
}

#[test]
fn impossible_maps_and_widths_are_errors() {
    let some = settings(Operator::Closing, Element::Box, 5, DepthRange::Forward);
    let empty = Morphology::new(gpu(), shaders(), some, [0, 4]);
    assert!(matches!(empty, Err(StylizeError::Size { .. })));
    let morphology = Morphology::new(gpu(), shaders(), some, [8, 4]).unwrap();
    let other = morphology.bind(gpu(), &texture([4, 8], &[0.5; 32]));
    assert!(matches!(other, Err(StylizeError::OtherSize { .. })));
    for width in [0.0, 4.0, -5.0, f64::NAN] {
        assert!(matches!(Width::try_from(width), Err(StylizeError::Width(_))), "{width}");
    }
}
