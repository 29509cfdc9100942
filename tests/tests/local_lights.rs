// SPDX-License-Identifier: MIT OR Apache-2.0
//! Spots, point lights, light textures and cascades in the prefiltered method and in the march, against the f64
//! references, closed forms and invariants.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{Cascades, DepthRange, Light, PerspectiveView, Sky};
use airlight::data::LightImage;
use airlight::scattering::{
    BasisFormat, Inputs, LightForm, March, Medium, Prefiltered, Settings, Visibility, Weighting,
};
use airlight::{Buffer, Lighting, Setting, Stage, Texture};
use airlight_tests::error;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec2, Vec3};
use gpu::{Random, gpu, point, shaders, spot};
use reference::{Cone, LocalLight, LocalRows, LocalScene, Over, ShadowMap, Start, Weights};
use wgpu::TextureFormat::R32Float;

const PICTURE: [u32; 2] = [192, 108];
const MAP: [u32; 2] = [512, 512];
const SHADOW: [u32; 2] = [1024, 1024];
/// One pixel in so many, in both directions, is compared with the references that integrate.
const STRIDE: usize = 3;
/// Rank queries err by at most this part of what bases do, in plain means over the same rows.
const RANKED: f64 = 0.5;
/// Six moments err by at most this more than rank queries, in radiance; both share what rows themselves err by.
const MOMENTS: f64 = 0.003;

/// A scene with a light, on the GPU.
struct Case {
    name: &'static str,
    stage: Stage,
    view: PerspectiveView,
    form: LightForm,
    texture: Option<LightImage>,
}

impl Case {
    fn new(
        name: &'static str,
        light: Lighting,
        texture: Option<LightImage>,
        cascades: Option<Cascades>,
    ) -> Self {
        let scene = gpu::torus_over_plane();
        let stage = Stage::new(
            gpu(),
            gpu::raster(),
            &Setting {
                mesh: &scene.mesh,
                view: scene.view.into(),
                light,
                light_texture: texture.as_ref(),
                cascades,
                sky: Sky::new(Vec3::splat(0.3), Vec3::splat(0.4), Vec3::splat(0.1)),
                medium: scene.medium,
                samples: 1,
            },
            PICTURE,
            SHADOW,
        )
        .unwrap();
        let form = LightForm::of(&stage.light, &stage.inputs());
        LightForm::check_eye(&stage.camera, &stage.light).unwrap();
        Self { name, stage, view: scene.view, form, texture }
    }

    /// The same without blockers.
    fn empty(mut self) -> Self {
        self.stage.pictures.shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
        if self.stage.pictures.shadow_maps.is_some() {
            let maps = Texture::array(
                gpu(),
                [8, 8, 6],
                R32Float,
                wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            );
            maps.write(gpu(), &[1.0; 384]).unwrap();
            self.stage.pictures.shadow_maps = Some(maps);
        }
        self
    }

    fn settings(&self) -> Settings {
        Settings { map: MAP, light: self.form, ..Settings::default() }
    }

    fn camera(&self) -> ReferenceCamera {
        gpu::reference_camera(&self.view, PICTURE)
    }

    /// Depths and matrix of every shadow map, as the references take them.
    fn maps(&self) -> Vec<(Vec<f32>, [usize; 2], Mat4)> {
        let read = |texture: &Texture, matrices: &[Mat4]| {
            let depths = texture.read(gpu()).unwrap();
            let [width, height, _] = texture.size().map(|side| side as usize);
            let layers = depths.chunks_exact(width * height);
            layers.zip(matrices).map(|(layer, m)| (layer.to_vec(), [width, height], *m)).collect()
        };
        match (&self.stage.pictures.shadow_maps, &self.stage.views) {
            (Some(maps), Some(views)) => read(maps, &views.clip_from_world[..views.count as usize]),
            _ => read(&self.stage.pictures.shadow_map, &[self.stage.light.clip_from_world]),
        }
    }

    fn light(&self) -> LocalLight {
        let light = &self.stage.light;
        let cosines = light.spot_cosines.to_array().map(f64::from);
        LocalLight {
            position: gpu::vector(light.position),
            radius: f64::from(light.radius),
            intensity: light.radiance.to_array().map(f64::from),
            cone: if self.form.spot {
                Cone::Spot { direction: gpu::vector(light.direction), cosines }
            } else {
                Cone::Point
            },
        }
    }

    /// What `compare` gives for the scene as the references see it.
    fn with_reference<R>(&self, compare: impl FnOnce(&LocalScene<'_>, &[ShadowMap<'_>]) -> R) -> R {
        let maps = self.maps();
        let maps: Vec<ShadowMap<'_>> = maps
            .iter()
            .map(|(depth, [width, height], matrix)| ShadowMap {
                depth,
                width: *width,
                height: *height,
                clip_from_world: gpu::matrix(*matrix),
                far_depth: 1.0,
            })
            .collect();
        let camera = self.camera();
        let depth = self.stage.pictures.depth.read(gpu()).unwrap();
        let rgb: Vec<f32> =
            self.texture.iter().flat_map(|t| t.texels().iter().flat_map(|texel| texel.to_array())).collect();
        let scene = LocalScene {
            camera: &camera,
            light: self.light(),
            texture: self.texture.as_ref().map(|texture| reference::LightTexture {
                rgb: &rgb,
                width: texture.size()[0] as usize,
                height: texture.size()[1] as usize,
                clip_from_world: Some(gpu::matrix(self.stage.light.clip_from_world)),
                outside: if self.form.local() { 0.0 } else { 1.0 },
            }),
            medium: gpu::reference_medium(&self.stage.medium),
            depth: &depth,
            width: PICTURE[0] as usize,
            height: PICTURE[1] as usize,
        };
        compare(&scene, &maps)
    }
}

fn sun() -> Lighting {
    Lighting::directional(Vec3::new(0.55, 0.75, -0.4), Vec3::new(12.0, 11.0, 10.0))
}

/// Soft coloured panes.
fn panes() -> LightImage {
    LightImage::from_function([16, 16], |uv| {
        let wave = |k: f32, at: f32| 0.5 + 0.5 * (k * at).sin();
        Vec3::new(wave(9.0, uv.x), wave(7.0, uv.y + 0.3), wave(5.0, uv.x + uv.y))
    })
}

struct Scattered {
    radiance: Vec<f32>,
}

fn scattered(texture: &Texture) -> Scattered {
    let values = texture.read(gpu()).unwrap();
    Scattered { radiance: values.chunks_exact(4).flat_map(|texel| texel[..3].to_vec()).collect() }
}

fn prefiltered(case: &Case, settings: Settings) -> (Prefiltered, Scattered) {
    let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
    let bound = method.bind(gpu(), &case.stage.inputs()).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let result = scattered(&method.scattered);
    (method, result)
}

fn marched(case: &Case, steps: u32, weighting: Weighting) -> Scattered {
    let method = March::of_light(gpu(), shaders(), case.form, steps, weighting, PICTURE).unwrap();
    let along = airlight::scattering::Along::ShadowMap { steps };
    let bound = method.bind(gpu(), &case.stage.inputs(), &along).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    scattered(&method.scattered)
}

/// The reference's rows with the slices that the GPU computed.
fn rows(scene: &LocalScene<'_>, method: &Prefiltered) -> LocalRows {
    let size = MAP.map(|side| side as usize);
    let mut rows = LocalRows::new(scene.camera, scene.light, scene.medium.distance_limit, size).unwrap();
    let texels = method.rectification.slices.read(gpu()).unwrap();
    for (slice, texel) in rows.slices.iter_mut().zip(texels.chunks_exact(4)) {
        slice.theta_min = f64::from(texel[0]);
        slice.theta_max = f64::from(texel[1]);
        slice.alpha_min = f64::from(texel[2]);
        slice.alpha_max = f64::from(texel[3]);
    }
    rows
}

fn relative_rmse(found: &Scattered, exact: &reference::Picture) -> f64 {
    let found = exact.sample(&found.radiance, PICTURE[0] as usize, 3, 0..3);
    error::relative_rmse(&found, &exact.radiance())
}

// Slices and rectified maps.

#[test]
fn slices_hold_what_rays_reach_inside_the_cone() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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

// Directional lights.

#[test]
fn one_cascade_is_the_single_map() {
    let _turn = gpu::turn();
    let mut plain = Case::new("sun", sun(), None, None);
    let mut cascades = Case::new("cascades", sun(), None, Some(Cascades::new(1)));
    // The same map and matrix, as an array of one. Its border is blocked, for light rays beyond it are not.
    let mut map = plain.stage.pictures.shadow_map.read(gpu()).unwrap();
    let side = SHADOW[0] as usize;
    for (i, depth) in map.iter_mut().enumerate() {
        if [i % side, i / side].iter().any(|at| *at == 0 || *at == side - 1) {
            *depth = 0.0;
        }
    }
    plain.stage.pictures.shadow_map = gpu::texture(SHADOW, R32Float, &map);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
    let array = Texture::array(gpu(), [SHADOW[0], SHADOW[1], 1], R32Float, usage);
    array.write(gpu(), &map).unwrap();
    cascades.stage.pictures.shadow_maps = Some(array);
    let mut views = cascades.stage.views.unwrap();
    views.count = 1;
    views.clip_from_world[0] = plain.stage.light.clip_from_world;
    views.world_from_clip[0] = plain.stage.light.world_from_clip;
    cascades.stage.shadow_views = Some(Buffer::uniform(gpu(), &views));
    let settings = |case: &Case| Settings { format: BasisFormat::Rgba16Float, ..case.settings() };
    let (a, one) = prefiltered(&plain, settings(&plain));
    let (b, other) = prefiltered(&cascades, settings(&cascades));
    let [a, b] = [&a, &b].map(|method| method.rectification.rectified.read(gpu()).unwrap());
    let off = a.iter().zip(&b).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("one cascade: {off} of {} texels off, radiance {:.3} %", a.len(), 100.0 * difference);
    assert!(off < a.len() / 500 && difference < 2e-3);
    let march = [&plain, &cascades].map(|case| marched(case, 512, Weighting::Transmittance));
    let difference = error::relative_rmse(&march[1].radiance, &march[0].radiance);
    println!("one cascade, marched: {:.3} %", 100.0 * difference);
    assert!(difference < 2e-3);
}

#[test]
fn cascades_show_what_the_single_map_shows() {
    let _turn = gpu::turn();
    let plain = Case::new("sun", sun(), None, None);
    let cascades = Case::new("cascades", sun(), None, Some(Cascades::new(3)));
    assert!(cascades.form.shadow_array && !cascades.form.local());
    let one = prefiltered(&plain, plain.settings()).1;
    let other = prefiltered(&cascades, cascades.settings()).1;
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("three cascades: {:.2} % from one map", 100.0 * difference);
    assert!(difference < 0.03);
}

#[test]
fn a_texture_colours_a_directional_light() {
    let _turn = gpu::turn();
    let case = Case::new("sun, texture", sun(), Some(panes()), None);
    let plain = Case::new("sun", sun(), None, None);
    // White lets through what is there without it.
    let white = Case::new("sun, white", sun(), Some(LightImage::from_function([4, 4], |_| Vec3::ONE)), None);
    let one = prefiltered(&plain, plain.settings()).1;
    let other = prefiltered(&white, white.settings()).1;
    let difference = error::relative_rmse(&other.radiance, &one.radiance);
    println!("white texture: {:.2} %", 100.0 * difference);
    assert!(difference < 0.01);
    let exact = |case: &Case| {
        case.with_reference(|scene, maps| {
            let scene_of_sun = reference::Scene {
                camera: scene.camera,
                light: gpu::reference_light(&case.stage.light),
                medium: scene.medium,
                depth: scene.depth,
                width: scene.width,
                height: scene.height,
            };
            reference::shadow_views_picture(&scene_of_sun, maps, scene.texture.as_ref(), Start::Eye, STRIDE)
        })
    };
    let rank = Settings { visibility: Visibility::Rank { bits: 12 }, ..case.settings() };
    // In thin air nothing is left of what the rays of a row share, their weights.
    let mut thin = Case::new("sun, texture, thin air", sun(), Some(panes()), None);
    thin.stage.medium = Medium { extinction: 1e-4, ..thin.stage.medium };
    thin.stage.medium_buffer = Buffer::uniform(gpu(), &thin.stage.medium);
    let in_thin_air = exact(&thin);
    let [bases, ranks] =
        [thin.settings(), rank].map(|settings| relative_rmse(&prefiltered(&thin, settings).1, &in_thin_air));
    println!("sun, texture, thin air: bases {:.2} %, rank queries {:.2} %", 100.0 * bases, 100.0 * ranks);
    assert!(ranks < 0.6 * bases, "{ranks} {bases}");
    let six = Settings { visibility: Visibility::Moments, ..case.settings() };
    let moments = relative_rmse(&prefiltered(&thin, six).1, &in_thin_air);
    println!("sun, texture, thin air: moments {:.2} %", 100.0 * moments);
    assert!(moments < ranks + MOMENTS, "{moments} {ranks}");
    let exact = exact(&case);
    let error = relative_rmse(&prefiltered(&case, case.settings()).1, &exact);
    let ranked = relative_rmse(&prefiltered(&case, rank).1, &exact);
    let march = relative_rmse(&marched(&case, 256, Weighting::Transmittance), &exact);
    println!(
        "sun, texture: bases {:.2} %, rank queries {:.2} %, marched {:.2} %",
        100.0 * error,
        100.0 * ranked,
        100.0 * march
    );
    let moments = relative_rmse(&prefiltered(&case, six).1, &exact);
    println!("sun, texture: moments {:.2} %", 100.0 * moments);
    assert!(error < 0.05, "{error}");
    assert!(ranked < 0.05, "{ranked}");
    assert!(moments < ranked + MOMENTS, "{moments} {ranked}");
    assert!(march < 0.02, "{march}");
}

#[test]
fn a_half_space_blocker_leaves_the_other_half() {
    let _turn = gpu::turn();
    // A spot straight above that shines down; everything beyond the plane x = x of the light is blocked right there.
    let light = Lighting::Spot {
        position: Vec3::new(0.0, 6.0, 0.0),
        target: Vec3::ZERO,
        outer_degrees: 60.0,
        // A wide fall-off, so that what is lit and what is not differ in it.
        inner_degrees: 5.0,
        intensity: Vec3::splat(100.0),
        radius: 0.02,
    };
    let mut case = Case::new("half space", light, None, None);
    let size = 512_usize;
    let inverse = case.stage.light.world_from_clip;
    let texels: Vec<f32> = (0..size * size)
        .map(|i| {
            let ndc = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) * 2.0 / size as f32 - 1.0;
            let point = inverse.project_point3(Vec3::new(ndc.x, -ndc.y, 0.5));
            if point.x > 0.0 { 0.0 } else { 1.0 }
        })
        .collect();
    case.stage.pictures.shadow_map = gpu::texture([size as u32; 2], R32Float, &texels);
    let half = case.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
    let found = prefiltered(&case, case.settings()).1;
    let error = relative_rmse(&found, &half);
    println!("half space: {:.2} %", 100.0 * error);
    assert!(error < 0.03, "{error}");
    let whole = case.empty();
    let whole = whole.with_reference(|scene, maps| scene.truth(maps, Start::Eye, STRIDE));
    let sum = |picture: &reference::Picture| picture.radiance().iter().sum::<f64>();
    assert!(sum(&half) < 0.8 * sum(&whole) && sum(&half) > 0.1 * sum(&whole));
}

// Any camera, any light, any input.

fn wild_depths(random: &mut Random, count: usize) -> Vec<f32> {
    let kind = random.below(3);
    (0..count)
        .map(|_| match (kind, random.below(8)) {
            (0, _) => random.unit() as f32,
            (1, 0..4) => random.unit() as f32,
            (_, 0) => f32::NAN,
            (_, 1) => f32::INFINITY,
            (_, 2) => -1.0,
            (_, 3) => 1e30,
            (_, 4) => f32::from_bits(random.bits()),
            (_, 5) => 0.0,
            _ => 1.0,
        })
        .collect()
}

/// A light that may be anywhere: next to the eye, in the picture, behind it, far away; and what it was made with.
fn wild_light(random: &mut Random, camera: &ReferenceCamera, point: bool) -> Light {
    let direction = gpu::host_vector(random.light(camera));
    let eye = gpu::host_vector(camera.eye);
    let distance = match random.below(4) {
        0 => 1e-6,
        1 => random.magnitude(1e-5, 1e-2) as f32,
        2 => random.magnitude(1e-2, 1e2) as f32,
        _ => random.magnitude(1e2, 1e5) as f32,
    };
    let position = eye + direction * distance;
    let near = random.magnitude(1e-3, 1.0) as f32;
    let far = near * random.magnitude(1.1, 1e5) as f32;
    let radius = random.magnitude(1e-6, 10.0) as f32;
    let bright = Vec3::new(random.magnitude(1e-3, 1e6) as f32, 1.0, 0.0);
    if point {
        return Light::point(position, bright, radius, near, far).unwrap();
    }
    // Towards the eye, away from it, past it, or anywhere.
    let away = gpu::host_vector(random.direction());
    let axis = match random.below(3) {
        0 => -direction + 0.3 * away,
        1 => direction + 0.3 * away,
        _ => away,
    };
    let outer = random.between(0.5, 80.0) as f32;
    let inner = if random.unit() < 0.2 { outer } else { outer * random.unit() as f32 };
    Light::spot(position, position + axis * 10.0, outer, inner, bright, radius, near, far).unwrap_or_else(
        |_| Light::spot(Vec3::ZERO, Vec3::X, outer, inner, bright, radius, near, far).unwrap(),
    )
}

#[test]
fn no_camera_light_or_input_gives_nan_or_a_value_out_of_range() {
    const COUNT: usize = 540;
    const PICTURE: [u32; 2] = [16, 8];
    const MAP: [u32; 2] = [16, 8];
    let _turn = gpu::turn();
    let mut random = Random(4048);
    let base = [
        LightForm { spot: true, ..LightForm::default() },
        LightForm { spot: true, texture: true, ..LightForm::default() },
        LightForm { point: true, shadow_array: true, ..LightForm::default() },
        LightForm { shadow_array: true, ..LightForm::default() },
        LightForm { texture: true, ..LightForm::default() },
        LightForm { shadow_array: true, texture: true, ..LightForm::default() },
    ];
    let camera = random.camera(2.0);
    let camera_buffer = Buffer::uniform(gpu(), &gpu::host_camera(&camera, PICTURE));
    let light_buffer = Buffer::uniform(gpu(), &wild_light(&mut random, &camera, false));
    let medium_buffer = Buffer::uniform(gpu(), &Medium::new(0.1, Vec3::ONE, 0.0, 10.0).unwrap());
    let cube = airlight::core::ShadowViews::cube(Vec3::ZERO, 0.1, 10.0).unwrap();
    let views_buffer = Buffer::uniform(gpu(), &cube);
    let depth = gpu::texture(PICTURE, R32Float, &[1.0; 128]);
    let shadow_map = gpu::texture([8, 8], R32Float, &[1.0; 64]);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
    let shadow_maps = Texture::array(gpu(), [8, 8, 6], R32Float, usage);
    let color =
        Texture::new(gpu(), [4, 4], wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let inputs = Inputs {
        camera: &camera_buffer,
        light: &light_buffer,
        medium: &medium_buffer,
        depth: &depth,
        shadow_map: &shadow_map,
        shadow_views: Some(&views_buffer),
        shadow_maps: Some(&shadow_maps),
        light_texture: Some(&color),
    };
    let methods: Vec<_> = base
        .iter()
        .flat_map(|form| {
            let rank = Visibility::Rank { bits: 8 };
            [
                (Weighting::Average, true, Visibility::Fourier),
                (Weighting::Transmittance, false, Visibility::Fourier),
                (Weighting::Average, false, rank),
                (Weighting::Transmittance, true, rank),
                (Weighting::Average, true, Visibility::Moments),
                (Weighting::Transmittance, false, Visibility::Moments),
            ]
            .map(|(weighting, epipole_march, visibility)| {
                let settings = Settings {
                    bases: 8,
                    map: MAP,
                    format: BasisFormat::Rgba16Float,
                    weighting,
                    epipole_march,
                    visibility,
                    light: *form,
                    ..Settings::default()
                };
                let method = Prefiltered::new(gpu(), shaders(), settings, PICTURE).unwrap();
                let bound = method.bind(gpu(), &inputs).unwrap();
                let march = March::of_light(gpu(), shaders(), *form, 24, weighting, PICTURE).unwrap();
                let along = airlight::scattering::Along::ShadowMap { steps: 24 };
                let march_bound = march.bind(gpu(), &inputs, &along).unwrap();
                (*form, method, bound, march, march_bound)
            })
        })
        .collect();
    let mut bright = 0;
    for index in 0..COUNT {
        let (form, method, bound, march, march_bound) = &methods[index % methods.len()];
        let aspect = random.between(0.5, 2.5);
        let camera = random.camera(aspect);
        let light = if form.local() {
            wild_light(&mut random, &camera, form.point)
        } else {
            let towards = random.light(&camera);
            let matrix = gpu::light_matrix(towards, camera.eye, random.magnitude(0.1, 1e3), 1.0);
            gpu::host_light(towards, matrix, 1.0, Vec3::new(random.magnitude(1e-3, 1e6) as f32, 1.0, 0.0))
        };
        let mut views = cube;
        if form.point {
            let near = random.magnitude(1e-3, 1.0) as f32;
            let far = near * random.magnitude(1.1, 1e5) as f32;
            views = airlight::core::ShadowViews::cube(light.position, near, far).unwrap();
        } else {
            views.count = 1 + random.below(6) as u32;
            for view in 0..views.count as usize {
                let towards = gpu::vector(light.direction);
                let matrix = gpu::light_matrix(towards, camera.eye, random.magnitude(0.1, 1e3), 1.0);
                views.clip_from_world[view] = gpu::host_matrix(matrix);
                views.world_from_clip[view] = gpu::host_matrix(matrix.inverse().unwrap());
            }
        }
        let medium = Medium::new(
            if random.unit() < 0.15 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 },
            Vec3::new(1.0, random.unit() as f32, 0.0),
            random.between(-0.999, 0.999) as f32,
            random.magnitude(1e-3, 1e7) as f32,
        )
        .unwrap();
        camera_buffer.write(gpu(), &gpu::host_camera(&camera, PICTURE));
        light_buffer.write(gpu(), &light);
        medium_buffer.write(gpu(), &medium);
        views_buffer.write(gpu(), &views);
        depth.write(gpu(), &wild_depths(&mut random, 128)).unwrap();
        shadow_map.write(gpu(), &wild_depths(&mut random, 64)).unwrap();
        shadow_maps.write(gpu(), &wild_depths(&mut random, 384)).unwrap();
        color.write(gpu(), &wild_depths(&mut random, 64)).unwrap();
        let mut encoder = gpu().encoder();
        method.record(&mut encoder, bound);
        march.record(&mut encoder, march_bound);
        gpu().submit(encoder).unwrap();
        let name = || format!("case {index}: {form:?} {camera:?} {light:?} {medium:?}");
        for (which, texture) in [&method.scattered, &march.scattered].into_iter().enumerate() {
            for (pixel, texel) in texture.read(gpu()).unwrap().chunks_exact(4).enumerate() {
                let fine = texel.iter().all(|v| v.is_finite() && *v >= 0.0) && texel[3] <= 1.001;
                assert!(fine, "picture {which}, pixel {pixel}: {texel:?}; {}", name());
                assert!(medium.extinction > 0.0 || texel[..3] == [0.0; 3], "{texel:?}; {}", name());
                bright += usize::from(texel[0] > 0.0);
            }
        }
        for z in method.rectification.rectified.read(gpu()).unwrap() {
            assert!((0.0..=1.0).contains(&z), "map: {z}; {}", name());
        }
        if method.prefilter.textures()[0].0 == "bases" {
            for basis in method.prefilter.stored().read(gpu()).unwrap() {
                assert!((-0.003..=1.003).contains(&basis), "basis: {basis}; {}", name());
            }
        }
        for slice in method.rectification.slices.read(gpu()).unwrap().chunks_exact(4) {
            let turn = std::f32::consts::PI * 1.000_001;
            let fine = slice.iter().all(|v| v.is_finite())
                && 0.0 <= slice[0]
                && slice[0] < slice[1]
                && slice[1] <= turn;
            assert!(fine, "slice: {slice:?}; {}", name());
            let local = 0.0 <= slice[2] && slice[2] < slice[3] && slice[3] <= turn;
            assert!(local || !form.local(), "slice: {slice:?}; {}", name());
        }
    }
    let share = bright as f64 / (COUNT * 256) as f64;
    println!("{COUNT} random cases; {:.0} % of the pixels lit", 100.0 * share);
    assert!((0.15..0.95).contains(&share), "the random cases are not varied enough: {share}");
}

#[test]
fn the_view_of_the_tests_is_forward() {
    // `Case` reads shadow maps and depth as forward.
    assert_eq!(gpu::torus_over_plane().view.depth, DepthRange::Forward);
}
