// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions fused into the evaluation of light shafts, against `Restyle` after the plain evaluation, which
//! tests/tests/transfer holds against f64.

use crate::gpu::{self, Random, TestScene, gpu, point, shaders, spot};
use crate::probing::hold;
use crate::wild_function::wild_function;
use airlight::core::Sky;
use airlight::data::LightImage;
use airlight::scattering::{
    Evaluated, Inputs, LightForm, Medium, Prefiltered, ProjectiveMap, ProjectivePrefiltered, Settings, Start,
    Visibility, Weighting, projective_rows,
};
use airlight::stylize::{
    Mode, Phase, RayProperty, Restyle, StylizedEvaluation, TransferError, TransferFunction, TransferSettings,
};
use airlight::{Buffer, Lighting, Pass, Sampler, Setting, Stage, Texture};
use glam::Vec3;
use wgpu::TextureFormat::{R32Float, Rgba16Float};

const PICTURE: [u32; 2] = [96, 72];
const MAP: [u32; 2] = [256, 256];
const SHADOW: [u32; 2] = [512, 512];

/// Between the two lies one rounding to rgba16float: half a step is 2^-11 of the radiance that is kept or multiplied, and
/// 2^-12 of visibility, by which the function of these tests changes no more than half as much again; the picture is rounded
/// once more on either side, another 2^-11 each. The rest is for angles, which either computes in its own order.
const ROUNDING: f64 = 1.5 / 1024.0;

fn stage(scene: &TestScene, light: Lighting, texture: Option<&LightImage>) -> Stage {
    let setting = Setting {
        mesh: &scene.mesh,
        view: scene.view.into(),
        light,
        light_texture: texture,
        cascades: None,
        sky: Sky::new(Vec3::splat(0.3), Vec3::splat(0.4), Vec3::splat(0.1)),
        medium: scene.medium,
        samples: 1,
    };
    Stage::new(gpu(), gpu::raster(), &setting, PICTURE, SHADOW).unwrap()
}

fn sun(scene: &TestScene) -> Lighting {
    Lighting::directional(scene.light, scene.radiance)
}

/// A function whose colours change by at most 1.5 over its side.
fn smooth_map(alpha: f64) -> Texture {
    let size = 128_u32;
    let values: Vec<f32> = (0..size * size)
        .flat_map(|i| {
            let [x, y] = [i % size, i / size].map(|p| (f64::from(p) + 0.5) / f64::from(size));
            let wave = |k: f64| 0.5 + 0.3 * (k * x + 1.3 * k).sin() + 0.2 * ((7.0 - k) * y + k).cos();
            let cover = alpha * (0.7 + 0.3 * (2.0 * x - y).sin());
            [wave(2.0) * cover, wave(3.0) * cover, wave(4.0) * cover, cover].map(|v| v as f32)
        })
        .collect();
    gpu::texture([size, size], Rgba16Float, &values)
}

fn white_map() -> Texture {
    gpu::texture([1, 1], Rgba16Float, &[1.0; 4])
}

fn read(texture: &Texture) -> Vec<f64> {
    texture.read(gpu()).unwrap().into_iter().map(f64::from).collect()
}

/// What `Restyle` makes of what the method evaluated.
fn apart(inputs: &Inputs<'_>, scattered: &Texture, map: &Texture, function: &TransferFunction) -> Vec<f64> {
    let [width, height, _] = scattered.size();
    let restyle = Restyle::new(gpu(), shaders(), function, inputs, [width, height]).unwrap();
    let uniform = Buffer::uniform(gpu(), function);
    let bound = restyle.bind(gpu(), inputs, scattered, map, &uniform).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    read(&restyle.restyled)
}

fn fused(
    inputs: &Inputs<'_>,
    method: &dyn Evaluated,
    map: &Texture,
    function: &TransferFunction,
) -> Vec<f64> {
    let uniform = Buffer::uniform(gpu(), function);
    let stylized = StylizedEvaluation::new(gpu(), shaders(), function, method).unwrap();
    let bound = stylized.bind(gpu(), inputs, method, map, &uniform).unwrap();
    let mut encoder = gpu().encoder();
    stylized.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    read(&stylized.restyled)
}

/// Every property, mode and phase function, over what `method` prefiltered and evaluated.
fn compare(name: &str, inputs: &Inputs<'_>, medium: &Medium, method: &dyn Evaluated) {
    use RayProperty::{Depth, LightAngle, PictureAngle, Visibility};
    let scattered = read(method.scattered());
    let lit: f64 = scattered.chunks_exact(4).map(|texel| texel[3]).sum();
    let pixels = scattered.len() as f64 / 4.0;
    assert!(lit > 0.03 * pixels && lit < 0.995 * pixels, "{name} has neither light nor shadow: {lit}");
    let map = smooth_map(0.9);
    let (mut worst, mut visibility) = (0.0_f64, 0.0_f64);
    let properties =
        [(Visibility, Depth), (LightAngle, PictureAngle), (Depth, LightAngle), (PictureAngle, Visibility)];
    for (round, (across, down)) in properties.into_iter().enumerate() {
        for (turn, mode) in [Mode::Replace, Mode::Light, Mode::Scattering].into_iter().enumerate() {
            let settings = TransferSettings {
                across,
                down,
                mode,
                phase: if (round + turn) % 2 == 0 { Phase::Constant } else { Phase::HenyeyGreenstein },
                // Less than rays may have, as much, and more.
                depth_limit: [Some(0.4), None, Some(1.7)][turn].map(|part| part * medium.distance_limit),
                strength: [1.0, 0.6][round % 2],
                brightness: 1.4,
                g: Some(0.5),
            };
            let function = settings.function(medium);
            let expected = apart(inputs, method.scattered(), &map, &function);
            let found = fused(inputs, method, &map, &function);
            // Errors grow with what the function's colours are multiplied by.
            let most = TransferSettings { strength: 1.0, ..settings }.function(medium);
            let white = apart(inputs, method.scattered(), &white_map(), &most);
            assert!(white.iter().zip(&expected).any(|(a, b)| (a - b).abs() > 0.02), "nothing is restyled");
            for i in 0..found.len() {
                let difference = (found[i] - expected[i]).abs();
                if i % 4 == 3 {
                    visibility = visibility.max(difference);
                } else {
                    worst = worst.max((difference - 1e-6).max(0.0) / (scattered[i] + white[i] + 1e-9));
                }
            }
        }
    }
    hold(&format!("{name}: light"), worst, ROUNDING);
    hold(&format!("{name}: visibility"), visibility, 1e-9);
}

fn prefiltered(name: &str, stage: &Stage, settings: Settings) {
    let light = LightForm::of(&stage.light, &stage.inputs());
    let settings = Settings { map: MAP, light, ..settings };
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), &stage.inputs()).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    compare(name, &stage.inputs(), &stage.medium, &method);
}

fn with(visibility: Visibility) -> Settings {
    Settings { visibility, ..Settings::default() }
}

const RANK: Visibility = Visibility::Rank { bits: 12 };

#[test]
fn directional_lights_are_restyled_as_by_a_pass_of_its_own() {
    let scene = gpu::torus_over_plane();
    let torus = stage(&scene, sun(&scene), None);
    prefiltered("torus, Fourier bases", &torus, Settings::default());
    prefiltered("torus, moments", &torus, with(Visibility::Moments));
    let near = Settings { start: Start::NearPlane, regions: 3, ..Settings::default() };
    prefiltered("torus, three regions from the near plane on", &torus, near);
    // The light stands in the picture.
    let scene = gpu::small_tree();
    let tree = stage(&scene, sun(&scene), None);
    prefiltered("tree, Fourier bases", &tree, Settings::default());
    prefiltered("tree, rank queries", &tree, with(RANK));
    let wavelet = Settings { weighting: Weighting::Average, ..with(Visibility::Wavelet { bits: 12 }) };
    prefiltered("tree, wavelet matrix", &tree, wavelet);
    let panes = LightImage::from_function([8, 8], |uv| Vec3::new(uv.x, uv.y, 0.5));
    prefiltered("tree, light texture", &stage(&scene, sun(&scene), Some(&panes)), Settings::default());
}

#[test]
fn lights_at_a_point_are_restyled_as_by_a_pass_of_its_own() {
    let scene = gpu::torus_over_plane();
    for (name, light) in [("spot", spot()), ("point light", point())] {
        let stage = stage(&scene, light, None);
        prefiltered(&format!("{name}, Fourier bases"), &stage, Settings::default());
        prefiltered(&format!("{name}, rank queries"), &stage, with(RANK));
        prefiltered(&format!("{name}, moments"), &stage, with(Visibility::Moments));
    }
}

#[test]
fn projective_rows_are_restyled_as_by_a_pass_of_its_own() {
    let scene = gpu::torus_over_plane();
    let stage = stage(&scene, sun(&scene), None);
    let limit = stage.medium.distance_limit;
    let projective = projective_rows(&stage.camera, stage.light.direction, limit, 2).unwrap();
    for (name, settings) in [
        ("Fourier bases", Settings::default()),
        ("rank queries", with(RANK)),
        ("moments", with(Visibility::Moments)),
        ("near plane", Settings { start: Start::NearPlane, ..Settings::default() }),
    ] {
        let map = ProjectiveMap::resampled(gpu(), shaders(), MAP).unwrap();
        let method = ProjectivePrefiltered::new(gpu(), shaders(), map, settings, PICTURE).unwrap();
        method.write(gpu(), &projective).unwrap();
        let bound = method.bind(gpu(), &stage.inputs()).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, &bound);
        gpu().submit(encoder).unwrap();
        compare(&format!("projective rows, {name}"), &stage.inputs(), &stage.medium, &method);
    }
}

#[test]
fn nothing_but_numbers_leaves_the_pass() {
    let mut random = Random(53);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 6e4, -6e4, 0.0, 0.7];
    let scene = gpu::small_tree();
    let mut stage = stage(&scene, sun(&scene), None);
    let mut any = |size: [u32; 2], channels: u32| -> Vec<f32> {
        (0..size[0] * size[1] * channels).map(|_| wild[random.below(7)]).collect()
    };
    stage.pictures.depth = gpu::texture(PICTURE, R32Float, &any(PICTURE, 1));
    let map = gpu::texture([8, 8], Rgba16Float, &any([8, 8], 4));
    for (round, visibility) in [Visibility::Fourier, RANK, Visibility::Moments].into_iter().enumerate() {
        let settings = Settings { map: MAP, ..with(visibility) };
        let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
        for turn in 0..4 {
            let round = 4 * round + turn;
            let mut light = stage.light;
            light.radiance = Vec3::splat([12.0, 3e38, -3e38][round % 3]);
            let light = Buffer::uniform(gpu(), &light);
            let inputs = Inputs { light: &light, ..stage.inputs() };
            let function = wild_function(&mut random, round);
            let bound = method.bind(gpu(), &inputs).unwrap();
            let mut encoder = gpu().encoder();
            method.record_rectification(&mut encoder, &bound);
            method.record_filter(&mut encoder, &bound);
            gpu().submit(encoder).unwrap();
            let found = fused(&inputs, &method, &map, &function);
            assert!(found.iter().all(|value| value.is_finite()), "{function:?}");
            // The compute form says the same.
            let mut definitions = method.evaluation_definitions();
            for (name, needed) in
                [("ANGLES", function.needs_angles()), ("ANISOTROPIC", function.is_anisotropic())]
            {
                definitions = if needed { definitions.flag(name) } else { definitions };
            }
            let pass = Pass::compute_with(gpu(), shaders(), "stylize/evaluate", &definitions).unwrap();
            let restyled = Texture::storage(gpu(), PICTURE, Rgba16Float);
            let (uniform, sampler) = (Buffer::uniform(gpu(), &function), Sampler::linear(gpu()));
            let mut resources = method.evaluation_resources(&inputs);
            resources.extend([
                ("transfer_function", (&uniform).into()),
                ("transfer_map", (&map).into()),
                ("transfer_sampler", (&sampler).into()),
                ("restyled", (&restyled).into()),
            ]);
            let bound = pass.bind_known(gpu(), &resources).unwrap();
            let mut encoder = gpu().encoder();
            pass.dispatch(&mut encoder, &bound, [PICTURE[0], PICTURE[1], 1]);
            gpu().submit(encoder).unwrap();
            assert_eq!(read(&restyled), found);
        }
    }
}

#[test]
fn what_an_evaluation_does_not_know_is_an_error() {
    let scene = gpu::torus_over_plane();
    let stage = stage(&scene, sun(&scene), None);
    let settings = Settings { map: [64, 64], ..Settings::default() };
    let map = white_map();
    let refused = |across: RayProperty, size: [u32; 2]| {
        let method = Prefiltered::new(gpu(), shaders(), settings, size).unwrap();
        let function = TransferSettings { across, ..TransferSettings::default() }.function(&stage.medium);
        let stylized = match StylizedEvaluation::new(gpu(), shaders(), &function, &method) {
            Ok(stylized) => stylized,
            Err(error) => return Some(error),
        };
        let uniform = Buffer::uniform(gpu(), &function);
        stylized.bind(gpu(), &stage.inputs(), &method, &map, &uniform).err()
    };
    let error = refused(RayProperty::VisibleDepth, PICTURE).unwrap();
    assert!(matches!(error, TransferError::VisibleDepth), "{error}");
    assert!(error.to_string().contains("`Restyle`"), "{error}");
    let error = refused(RayProperty::Depth, [95, 72]).unwrap();
    assert_eq!(error.to_string(), "a depth buffer of [96, 72] was given where [95, 72] is needed");
    assert!(refused(RayProperty::Depth, PICTURE).is_none());
}
