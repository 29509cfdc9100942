// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rectified map against the reference.

use crate::cases::{PICTURE, foliage, plane};
use crate::gpu::{self, gpu};
use crate::methods::rectified;
use airlight::Stage;
use airlight::scattering::Rectification;
use airlight_tests::reference::scattering as reference;

#[test]
fn rectified_maps_are_those_of_the_reference() {
    let torus = gpu::torus_over_plane();
    let tree = gpu::small_tree();
    let cases: [(&str, &Stage, _, &Rectification); 2] = [
        ("foliage", &foliage().stage, foliage().view, &foliage().map),
        ("plane", &plane().stage, plane().view, &plane().map),
    ];
    let small =
        [(torus.stage(PICTURE, [512, 512]), torus.view), (tree.stage(PICTURE, [512, 512]), tree.view)]
            .map(|(stage, view)| (rectified(&stage.inputs(), [512, 256]), stage, view));
    let small =
        small.iter().zip(["torus", "tree"]).map(|((map, stage, view), name)| (name, stage, *view, map));
    for (name, stage, view, map) in cases.into_iter().chain(small) {
        let camera = gpu::reference_camera(&view, PICTURE);
        let rectification = gpu::read_back(&camera, stage.light.direction, stage.medium.distance_limit, map);
        let shadow_map = stage.pictures.shadow_map.read(gpu()).unwrap();
        let [width, height, _] = stage.pictures.shadow_map.size();
        let expected = reference::rectify(
            &reference::ShadowMap {
                depth: &shadow_map,
                width: width as usize,
                height: height as usize,
                clip_from_world: gpu::matrix(stage.light.clip_from_world),
                far_depth: f64::from(stage.light.far_depth),
            },
            &rectification,
            0.02,
        );
        let found = map.rectified.read(gpu()).unwrap();
        let (mut worst, mut at) = (0.0_f64, 0);
        for (i, (z, texel)) in found.iter().zip(&expected).enumerate() {
            let z = f64::from(*z);
            let beyond = (texel.low - z).max(z - texel.high);
            if beyond > worst || beyond.is_nan() {
                (worst, at) = (beyond, i);
            }
        }
        let total = expected.len() as f64;
        let ambiguous = expected.iter().filter(|t| t.ambiguous).count() as f64 / total;
        let spread = expected.iter().filter(|t| t.high - t.low > 1e-3).count() as f64 / total;
        let blocked = found.iter().filter(|z| **z < 1.0).count() as f64 / total;
        println!(
            "rectified {name}: worst {worst:.2e}, {:.1} % within 0.02 texel of an edge, {:.1} % where it matters, {:.0} % blocked",
            100.0 * ambiguous,
            100.0 * spread,
            100.0 * blocked
        );
        let texel = expected[at];
        assert!(worst <= 1e-4, "{name}: texel {at}: {} beyond {texel:?}", found[at]);
        assert!(ambiguous < 0.1 && blocked > 0.02, "{name}");
    }
}
