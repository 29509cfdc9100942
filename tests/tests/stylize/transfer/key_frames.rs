// SPDX-License-Identifier: MIT OR Apache-2.0
//! Key frames, and files that move from scene to scene.

use super::baking::{HALF_FLOAT, at, baked, baker, color, diffusion, greatest, texels, transfer};
use super::marched::{PICTURE, marched, scene};
use crate::gpu::{self, gpu};
use crate::probing::{f, hold};
use airlight::Stage;
use airlight::scattering::Medium;
use airlight::stylize::{Keyed, Mode, Transfer, TransferError, TransferSettings, read_transfer};
use glam::Vec3;
use std::collections::BTreeMap;

#[test]
fn key_frames_are_mixed_linearly() {
    let style = |left: [f32; 3], limit: f32, mode: Mode| {
        let mut style = transfer(
            64,
            vec![diffusion(vec![at(0.2, 0.3, color(left, 1.0)), at(0.8, 0.6, color([0.5; 3], 0.5))])],
        );
        style.settings = TransferSettings { depth_limit: Some(limit), mode, ..style.settings };
        style
    };
    let [first, second] =
        [style([1.0, 0.0, 0.0], 10.0, Mode::Replace), style([0.0, 0.0, 1.0], 30.0, Mode::Light)];
    let keyed = Keyed::new(vec![(10.0, first.clone()), (30.0, second.clone())]).unwrap();
    let [a, b] = [baked(&first), baked(&second)];
    let textures = baker().bake_keys(gpu(), &keyed, None).unwrap();
    let medium = Medium::new(0.1, Vec3::ONE, 0.25, 50.0).unwrap();
    for (frame, share) in
        [(-5.0, 0.0), (10.0, 0.0), (15.0, 0.25), (20.0, 0.5), (29.0, 0.95), (30.0, 1.0), (99.0, 1.0)]
    {
        let expected: Vec<[f64; 4]> = a
            .iter()
            .zip(&b)
            .map(|(a, b)| std::array::from_fn(|i| a[i] * (1.0 - share) + b[i] * share))
            .collect();
        let at_once = texels(&baker().bake_frame(gpu(), &keyed, frame, None).unwrap());
        let cached = texels(&baker().mix_frame(gpu(), &textures, frame).unwrap());
        hold("a frame", greatest(&at_once, &expected), 2.0 * HALF_FLOAT);
        hold("a frame of baked keys", greatest(&cached, &expected), 2.0 * HALF_FLOAT);
        let function = keyed.function(frame, &medium);
        assert!((f(function.depth_limit) - (10.0 + 20.0 * share)).abs() < 1e-5);
        assert_eq!(function.mode, u32::from(share >= 1.0), "kinds change at the key");
        assert_eq!(function.g, 0.25);
    }
}

#[test]
fn numbers_follow_their_key_frames() {
    let keyed: Keyed<f32> = "0:5, 48:31,96:10".parse().unwrap();
    for (frame, value, width) in [
        (-1.0, 5.0, 5),
        (0.0, 5.0, 5),
        (24.0, 18.0, 19),
        (48.0, 31.0, 31),
        (72.0, 20.5, 21),
        (200.0, 10.0, 11),
    ] {
        assert_eq!((keyed.value(frame), keyed.width(frame).texels()), (value, width), "{frame}");
    }
    assert_eq!("0.4".parse::<Keyed<f32>>().unwrap().value(7.0), 0.4);
    assert_eq!(
        [-3.0, f32::NAN, 0.2, 2.9, 3e38].map(|x| Keyed::constant(x).width(0.0).texels()),
        [1, 1, 1, 3, 16_777_217]
    );
    for wrong in ["", "a", "1:2,3", "1:2:3", "nan", "0:1,b:2"] {
        assert!(matches!(wrong.parse::<Keyed<f32>>(), Err(TransferError::KeyText(_))), "{wrong}");
    }
    for wrong in ["4:1,4:2", "4:1,3:2"] {
        let error = wrong.parse::<Keyed<f32>>().unwrap_err();
        assert!(matches!(error, TransferError::Order { .. }), "{wrong}");
    }
    assert!(matches!(Keyed::<f32>::new(Vec::new()), Err(TransferError::NoKeys)));
    assert!(matches!(Keyed::new(vec![(f32::NAN, 1.0)]), Err(TransferError::Order { .. })));
}

#[test]
fn a_style_is_the_same_in_every_scene() {
    let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/transfer");
    let folder = tempfile::tempdir().unwrap();
    let (torus, tree) = (gpu::torus_over_plane(), gpu::small_tree());
    let stages = [torus.stage(PICTURE, [64, 64]), tree.stage(PICTURE, [64, 64])];
    let movements = BTreeMap::new();
    for name in ["sunset.toml", "alarm.toml"] {
        std::fs::copy(examples.join(name), folder.path().join(name)).unwrap();
        let [here, there] =
            [examples.join(name), folder.path().join(name)].map(|path| read_transfer(path).unwrap());
        assert_eq!(here, there);
        let map = |style: &Keyed<Transfer>, stage: &Stage| {
            let scattered = marched(stage);
            let scene = scene(stage, &scattered, &movements);
            baker().bake_frame(gpu(), style, 30.0, Some(&scene)).unwrap().read(gpu()).unwrap()
        };
        let maps = [map(&here, &stages[0]), map(&there, &stages[1])];
        assert_eq!(maps[0], maps[1], "{name}");
        let colors: std::collections::BTreeSet<_> = maps[0].chunks_exact(4).map(|c| c[0].to_bits()).collect();
        assert!(colors.len() > 5, "{name} is no flat colour");
    }
}
