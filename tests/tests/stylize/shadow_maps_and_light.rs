// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stylization as a whole: shadow maps are changed between drawing and scattering, and the light in the air follows.
//! Each operator has a file of its own: `morphology`, `epipolar_dilate`, `perlin_holes`, `transfer`.

use crate::gpu::{self, gpu, shaders};
use airlight::Texture;
use airlight::core::DepthRange;
use airlight::scattering::{Inputs, Prefiltered, Settings, Visibility, Weighting};
use airlight::stylize::{
    Element, Form, HoleParameters, HolePattern, Holes, Operator, ShadowMaps, ShadowOperator, ShadowStyle,
    StylizedShadows, Width, shadow_map_extent,
};

const PICTURE: [u32; 2] = [160, 90];
const MAP: [u32; 2] = [512, 512];
/// What half floats and the steps of a depth make of a visibility.
const ROUNDING: f32 = 2e-3;

/// Share of pixels that the second picture has darker, after no pixel is lighter.
fn darker(lighter: &[f32], darker: &[f32]) -> f64 {
    let mut count = 0;
    for (a, b) in lighter.iter().zip(darker) {
        assert!(*b <= a + ROUNDING, "{b} where it was {a}");
        count += usize::from(*b < a - ROUNDING);
    }
    count as f64 / lighter.len() as f64
}

#[test]
fn light_in_the_air_follows_the_shadow_map() {
    let scene = gpu::small_tree();
    let stage = scene.stage(PICTURE, MAP);
    let settings = Settings {
        visibility: Visibility::Rank { bits: 12 },
        weighting: Weighting::Average,
        epipole_march: false,
        ..Settings::default()
    };
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let visibility = |shadow_map: &Texture| -> Vec<f32> {
        let bound = method.bind(gpu(), &Inputs { shadow_map, ..stage.inputs() }).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        method.scattered.read(gpu()).unwrap().chunks_exact(4).map(|texel| texel[3]).collect()
    };
    let drawn = stage.inputs().shadow_map;
    let plain = visibility(drawn);

    let styled = |holes: &[HoleParameters], operators: &[ShadowOperator]| {
        let style = ShadowStyle { holes, operators };
        let matrices = StylizedShadows::matrices(&stage.light, None);
        let (over, maps) = ((&stage.camera, &matrices[..]), ShadowMaps::of(&stage.inputs()));
        let shadows = StylizedShadows::new(gpu(), shaders(), &style, over, maps, None).unwrap();
        let mut encoder = gpu().encoder();
        shadows.record(&mut encoder);
        gpu().submit(encoder).unwrap();
        visibility(shadows.inputs(&stage.inputs()).shadow_map)
    };
    let closed = |width| {
        let (operator, element) = (Operator::Closing, Element::Box);
        styled(&[], &[ShadowOperator::Across { operator, element, width: Width::new(width).unwrap() }])
    };
    assert!(styled(&[], &[]) == plain, "no operator changes nothing");
    assert!(closed(1) == plain, "a closing of one texel changes nothing");
    let small = closed(5);
    let large = closed(21);
    let [first, second] = [darker(&plain, &small), darker(&small, &large)];

    let width = Width::new(31).unwrap();
    let extrusion = ShadowOperator::Along { operator: Operator::Dilation, form: Form::Direct, width };
    let third = darker(&plain, &styled(&[], &[extrusion]));

    let holes = Holes { size: 0.4, density: 0.3, octaves: 2, ..Holes::default() };
    let extent = shadow_map_extent(&stage.light.clip_from_world, 0.0);
    let pattern = HolePattern::new(&holes, extent, DepthRange::Forward).unwrap();
    let fourth = darker(&styled(&[pattern.at(0.0).unwrap()], &[]), &plain);

    println!(
        "darker: closing {first:.3}, wider {second:.3}, extrusion {third:.3}; than with holes {fourth:.3}"
    );
    assert!([first, second, third, fourth].iter().all(|share| *share > 0.02));
}
