// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the passes make of a map, and every kind of epipole to try them with.

use crate::gpu::{Random, gpu, shaders};
use crate::probing::f;
use airlight::Texture;
use airlight::core::DepthRange;
use airlight::stylize::{EpipolarMorphology, EpipolarSettings, Epipole, Form, Operator, Width};
use airlight_tests::reference::stylize as reference;
use glam::Vec2;

pub const OPERATORS: [Operator; 4] =
    [Operator::Dilation, Operator::Erosion, Operator::Closing, Operator::Opening];

pub fn far(depth: DepthRange) -> f32 {
    if depth == DepthRange::Forward { 1.0 } else { 0.0 }
}

pub fn settings(operator: Operator, form: Form, width: u32, depth: DepthRange) -> EpipolarSettings {
    EpipolarSettings { operator, form, width: Width::new(width).unwrap(), depth }
}

pub fn built(settings: EpipolarSettings, size: [u32; 2]) -> EpipolarMorphology {
    let nowhere = Epipole { position: Vec2::ZERO, depth: 0.0, weight: 0.0 };
    EpipolarMorphology::new(gpu(), shaders(), settings, &nowhere, size).unwrap()
}

/// What passes that were built before make of a map.
pub fn morph_with(morphology: &EpipolarMorphology, epipole: &Epipole, map: &Texture) -> Vec<f32> {
    morphology.set_epipole(gpu(), epipole).unwrap();
    let bound = morphology.bind(gpu(), map).unwrap();
    let mut encoder = gpu().encoder();
    morphology.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    morphology.morphed.read(gpu()).unwrap()
}

pub fn morph(settings: EpipolarSettings, epipole: &Epipole, map: &Texture) -> Vec<f32> {
    let [width, height, _] = map.size();
    morph_with(&built(settings, [width, height]), epipole, map)
}

/// Every kind of epipole: inside, exactly on a texel or a corner, outside, far, at infinity, behind the light.
pub fn epipoles(random: &mut Random, [width, height]: [u32; 2]) -> Vec<(&'static str, Epipole)> {
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

pub fn reference_epipole(epipole: &Epipole) -> reference::Epipole {
    reference::Epipole {
        x: f(epipole.position.x),
        y: f(epipole.position.y),
        depth: f(epipole.depth),
        weight: f(epipole.weight),
    }
}
