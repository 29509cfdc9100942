// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions against f64: diffusion, layers, the place of a ray, what is made of a colour; and picks, key frames and
//! files that move from scene to scene.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;
#[path = "support/wild_function.rs"]
mod wild_function;

use airlight::core::{Camera, Light};
use airlight::scattering::{Along, Inputs, March, Medium, Weighting};
use airlight::stylize::{
    Baker, Blend, Color, Constraint, Keyed, Layer, Mode, Phase, PickScene, Place, RayProperty, Restyle,
    Source, Transfer, TransferError, TransferFunction, TransferImage, TransferSettings, read_transfer,
};
use airlight::{Buffer, Pass, Stage, Texture};
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::stylize::transfer as reference;
use glam::{Vec2, Vec3, Vec4};
use gpu::{Random, gpu, shaders};
use probing::{f, hold, worst};
use std::collections::BTreeMap;
use std::sync::OnceLock;
use wgpu::TextureFormat::{R32Float, Rgba16Float};
use wild_function::wild_function;

/// Half a step of rgba16float below 1.
const HALF_FLOAT: f64 = 2.5e-4;

fn baker() -> &'static Baker {
    static BAKER: OnceLock<Baker> = OnceLock::new();
    BAKER.get_or_init(|| Baker::new(gpu(), shaders()).unwrap())
}

fn transfer(size: u32, layers: Vec<Layer>) -> Transfer {
    Transfer { size, settings: TransferSettings::default(), layers }
}

fn baked(of: &Transfer) -> Vec<[f64; 4]> {
    texels(&baker().bake(gpu(), of, None).unwrap())
}

fn texels(texture: &Texture) -> Vec<[f64; 4]> {
    let values = texture.read(gpu()).unwrap();
    values.chunks_exact(4).map(|c| std::array::from_fn(|i| f(c[i]))).collect()
}

fn color(rgb: [f32; 3], alpha: f32) -> Color {
    Color { rgb: rgb.into(), alpha }
}

fn at(x: f32, y: f32, color: Color) -> Constraint {
    Constraint { place: Place::At(Vec2::new(x, y)), color }
}

fn diffusion(constraints: Vec<Constraint>) -> Layer {
    Layer::new(Source::Diffusion(constraints))
}

fn random_color(random: &mut Random) -> Color {
    let [r, g, b, a] = [0; 4].map(|_| random.unit() as f32);
    color([r, g, b], a)
}

/// Premultiplied, as the references take it.
fn premultiplied(of: &Color) -> [f64; 4] {
    let a = f(of.alpha);
    [f(of.rgb.x) * a, f(of.rgb.y) * a, f(of.rgb.z) * a, a]
}

fn straight(of: &Color) -> [f64; 4] {
    [f(of.rgb.x), f(of.rgb.y), f(of.rgb.z), f(of.alpha)]
}

fn greatest(found: &[[f64; 4]], expected: &[[f64; 4]]) -> f64 {
    assert_eq!(found.len(), expected.len());
    worst(found.iter().flatten().copied().zip(expected.iter().flatten().copied()))
}

// Diffusion.

#[test]
fn diffusion_is_within_a_step_of_the_converged_solution() {
    let _turn = gpu::turn();
    let mut random = Random(11);
    let mut overall = 0.0_f64;
    let cases = [
        (256, &[2, 3, 8, 64][..]),
        (255, &[2, 5, 33]),
        (129, &[1, 2, 6, 64]),
        (101, &[3, 17]),
        (37, &[1, 2, 9, 64]),
        (33, &[2, 4]),
        (17, &[2, 5, 20]),
        (16, &[2, 7]),
        (5, &[1, 3]),
        (2, &[2]),
        (1, &[1, 3]),
    ];
    for (size, counts) in cases {
        for count in counts {
            let constraints: Vec<_> = (0..*count)
                .map(|_| at(random.unit() as f32, random.unit() as f32, random_color(&mut random)))
                .collect();
            let given: Vec<_> = constraints
                .iter()
                .map(|constraint| match &constraint.place {
                    Place::At(at) => ([f(at.x), f(at.y)], premultiplied(&constraint.color)),
                    _ => unreachable!(),
                })
                .collect();
            let expected = reference::diffused(&given, size as usize);
            let error = greatest(&baked(&transfer(size, vec![diffusion(constraints)])), &expected);
            println!("{count} constraints on {size}: {error:.1e}");
            overall = overall.max(error);
        }
    }
    // Nearly all of it is rounding to rgba16float, twice: the layer, and the function.
    hold("diffusion", overall, 1.0 / 255.0);
    hold("diffusion, as the book has it", overall, 1.0 / 3.0 / 255.0);
}

#[test]
fn one_constraint_is_flat_and_two_are_a_gradient() {
    let _turn = gpu::turn();
    let one = baked(&transfer(256, vec![diffusion(vec![at(0.3, 0.7, color([0.25, 0.5, 0.75], 0.5))])]));
    assert!(one.iter().all(|texel| *texel == [0.125, 0.25, 0.375, 0.5]), "one constraint is one colour");
    // From left to right at the height of both, nothing turns back.
    let ends = vec![at(0.1, 0.5, color([0.0, 0.0, 0.0], 1.0)), at(0.9, 0.5, color([1.0, 0.5, 0.0], 1.0))];
    let two = baked(&transfer(255, vec![diffusion(ends)]));
    let row: Vec<f64> = (0..255).map(|x| two[127 * 255 + x][0]).collect();
    // Beyond them it turns back a little: the border reflects.
    assert!(row[25..230].windows(2).all(|pair| pair[1] >= pair[0]), "{row:?}");
    assert!(row[33..222].windows(20).all(|far| far[19] > far[0] + 0.01), "it ascends: {row:?}");
    assert!(two.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "nothing exceeds the constraints");
    assert!((row[127] - 0.5).abs() < 1e-3 && row[25] == 0.0 && row[229] == 1.0);
}

#[test]
fn transparency_takes_its_colour_along() {
    let _turn = gpu::turn();
    let ends = vec![at(0.25, 0.5, color([1.0, 0.0, 0.0], 1.0)), at(0.75, 0.5, color([0.0, 0.0, 1.0], 0.0))];
    let found = baked(&transfer(129, vec![diffusion(ends)]))[64 * 129 + 64];
    let expected = [0.5, 0.0, 0.0, 0.5];
    hold("halfway from red to nothing: half-transparent red", greatest(&[found], &[expected]), 1e-3);
}

// Layers.

/// A layer's straight colour at a position, before opacity.
fn layer_color(layer: &Layer, [x, y]: [f64; 2], size: u32) -> [f64; 4] {
    let unmultiplied = |c: [f64; 4]| {
        let a = if c[3] > 0.0 { c[3] } else { 1.0 };
        [c[0] / a, c[1] / a, c[2] / a, c[3]]
    };
    match &layer.source {
        Source::Solid(of) => straight(of),
        Source::Gradient([(from, first), (to, second)]) => {
            let along = [f(to.x) - f(from.x), f(to.y) - f(from.y)];
            let length = along[0].hypot(along[1]);
            let share = ((x - f(from.x)) * along[0] + (y - f(from.y)) * along[1]) / (length * length);
            let share = share.clamp(0.0, 1.0);
            let (a, b) = (premultiplied(first), premultiplied(second));
            unmultiplied(std::array::from_fn(|i| a[i] * (1.0 - share) + b[i] * share))
        }
        Source::Image(image) => {
            let texel =
                image.texels[((y * f64::from(size)) as u32 * size + (x * f64::from(size)) as u32) as usize];
            unmultiplied(texel.to_array().map(f))
        }
        Source::Diffusion(_) => unreachable!(),
    }
}

#[test]
fn layers_are_blended_as_the_equations_say() {
    let _turn = gpu::turn();
    let mut random = Random(23);
    let mut error = 0.0_f64;
    for stack in 0..40 {
        let size = [24, 17, 40][stack % 3];
        let count = 1 + random.below(4);
        let layers: Vec<Layer> = (0..count)
            .map(|_| {
                let source = match random.below(3) {
                    0 => Source::Solid(random_color(&mut random)),
                    1 => Source::Gradient([0; 2].map(|_| {
                        let place = Vec2::new(random.unit() as f32, random.unit() as f32);
                        (place, random_color(&mut random))
                    })),
                    _ => Source::Image(TransferImage {
                        size: [size, size],
                        // As the texture holds them.
                        texels: (0..size * size)
                            .map(|_| {
                                let of = random_color(&mut random).premultiplied();
                                Vec4::from(of.to_array().map(|v| half::f16::from_f32(v).to_f32()))
                            })
                            .collect(),
                    }),
                };
                let blend = [Blend::Over, Blend::Multiply, Blend::Add][random.below(3)];
                Layer { source, blend, opacity: if random.unit() < 0.5 { 1.0 } else { random.unit() as f32 } }
            })
            .collect();
        let expected: Vec<[f64; 4]> = (0..size * size)
            .map(|i| {
                let position = [i % size, i / size].map(|p| (f64::from(p) + 0.5) / f64::from(size));
                let mut below = [0.0; 4];
                for layer in &layers {
                    let mut source = layer_color(layer, position, size);
                    source[3] *= f(layer.opacity);
                    let blend = match layer.blend {
                        Blend::Over => reference::Blend::Over,
                        Blend::Multiply => reference::Blend::Multiply,
                        Blend::Add => reference::Blend::Add,
                    };
                    below = reference::blend(blend, source, below);
                }
                [below[0] * below[3], below[1] * below[3], below[2] * below[3], below[3]]
            })
            .collect();
        let found = baked(&transfer(size, layers.clone()));
        let worst = greatest(&found, &expected);
        assert!(worst < 4e-3, "{worst:e}: {layers:?}");
        error = error.max(worst);
    }
    // Each of up to four layers is rounded to rgba16float, sums up to 4.
    hold("layers", error, 4e-3);
}

// The place of a ray, and what is made of a colour.

/// A picture that no method drew: any camera, any light, any depth, any scattered light.
struct Synthetic {
    reference: ReferenceCamera,
    camera: Camera,
    light: Light,
    source: reference::Source,
    medium: Medium,
    buffers: [Buffer; 3],
    depth: Texture,
    shadow_map: Texture,
    scattered: Texture,
}

const SIZE: [u32; 2] = [24, 16];

impl Synthetic {
    fn new(random: &mut Random) -> Self {
        let reference = random.camera(1.5);
        let camera = gpu::host_camera(&reference, SIZE);
        let towards = random.light(&reference);
        let matrix = gpu::light_matrix(towards, linear::Vec3::new(0.0, 0.0, 0.0), 10.0, 1.0);
        let radiance = Vec3::from([0; 3].map(|_| random.between(0.0, 12.0) as f32));
        let mut light = gpu::host_light(towards, matrix, 1.0, radiance);
        let mut source = reference::Source::Towards(gpu::vector(light.direction));
        if random.unit() < 0.4 {
            let place = reference.eye + random.direction() * random.between(1.0, 8.0);
            light = Light { kind: 2, position: gpu::host_vector(place), radius: 0.1, ..light };
            source = reference::Source::At(gpu::vector(light.position));
        }
        let [width, height] = SIZE.map(|side| side as usize);
        let depth: Vec<f32> = (0..width * height)
            .map(|i| {
                if random.unit() < 0.2 {
                    return reference.far_depth as f32;
                }
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                let point = reference.eye + reference.ray(ndc) * random.magnitude(0.5, 40.0);
                reference.project(point).unwrap()[2].clamp(0.0, 1.0) as f32
            })
            .collect();
        let scattered: Vec<f32> = (0..width * height)
            .flat_map(|_| [0, 1, 2, 3].map(|i| random.between(0.0, if i == 3 { 1.0 } else { 6.0 }) as f32))
            .collect();
        let medium = Medium::new(0.05, Vec3::ONE, random.between(-0.9, 0.9) as f32, 20.0).unwrap();
        let buffers = [
            Buffer::uniform(gpu(), &camera),
            Buffer::uniform(gpu(), &light),
            Buffer::uniform(gpu(), &medium),
        ];
        let depth = gpu::texture(SIZE, R32Float, &depth);
        let shadow_map = gpu::texture([1, 1], R32Float, &[1.0]);
        let scattered = gpu::texture(SIZE, Rgba16Float, &scattered);
        Self { reference, camera, light, source, medium, buffers, depth, shadow_map, scattered }
    }

    fn inputs(&self) -> Inputs<'_> {
        let [camera, light, medium] = &self.buffers;
        Inputs {
            camera,
            light,
            medium,
            depth: &self.depth,
            shadow_map: &self.shadow_map,
            shadow_views: None,
            shadow_maps: None,
            light_texture: None,
        }
    }

    fn scene<'a>(&'a self, movements: &'a BTreeMap<String, Vec3>) -> PickScene<'a> {
        let (camera, medium, inputs) = (&self.camera, &self.medium, self.inputs());
        PickScene { camera, medium, inputs, scattered: &self.scattered, movements }
    }

    /// The property of every pixel.
    fn properties(&self, of: RayProperty, limit: f64) -> Vec<f64> {
        let [width, height] = SIZE.map(|side| side as usize);
        let depth = self.depth.read(gpu()).unwrap();
        let scattered = texels(&self.scattered);
        let of = match of {
            RayProperty::Visibility => reference::Property::Visibility,
            RayProperty::Depth => reference::Property::Depth,
            RayProperty::LightAngle => reference::Property::LightAngle,
            RayProperty::PictureAngle => reference::Property::PictureAngle,
            RayProperty::VisibleDepth => unreachable!(),
        };
        (0..width * height)
            .map(|i| {
                let ndc = ReferenceCamera::pixel_ndc(i % width, i / width, width, height);
                let ray = [scattered[i][3], self.reference.distance(ndc, f(depth[i])), limit];
                reference::property(of, &self.reference, 1.5, ndc, self.source, ray)
            })
            .collect()
    }

    /// Sine of the angle between the ray of each pixel and the light.
    fn sines(&self) -> Vec<f64> {
        let angles = self.properties(RayProperty::LightAngle, 1.0);
        angles.into_iter().map(|angle| (angle * std::f64::consts::PI).sin()).collect()
    }
}

fn all_pixels() -> Vec<Place> {
    (0..SIZE[0] * SIZE[1]).map(|i| Place::Pixel([i % SIZE[0], i / SIZE[0]])).collect()
}

#[test]
fn rays_lie_where_their_properties_say() {
    let _turn = gpu::turn();
    let mut random = Random(37);
    use RayProperty::{Depth, LightAngle, PictureAngle, Visibility};
    let mut errors = [0.0_f64; 4];
    let (mut held, mut all) = (0, 0);
    for _ in 0..30 {
        let picture = Synthetic::new(&mut random);
        let movements = BTreeMap::new();
        let limit = random.between(2.0, 30.0) as f32;
        let sines = picture.sines();
        for (across, down) in [(Visibility, Depth), (LightAngle, PictureAngle)] {
            let settings =
                TransferSettings { across, down, depth_limit: Some(limit), ..TransferSettings::default() };
            let places =
                baker().positions(gpu(), &settings, &all_pixels(), &picture.scene(&movements)).unwrap();
            for (property, found) in [
                (across, places.iter().map(|place| f(place.x)).collect::<Vec<_>>()),
                (down, places.iter().map(|place| f(place.y)).collect()),
            ] {
                for ((found, expected), sine) in
                    found.iter().zip(picture.properties(property, f(limit))).zip(&sines)
                {
                    let mut off = (found - expected).abs();
                    if property == PictureAngle {
                        // Looking at the light there is no direction; and after 1 follows 0.
                        all += 1;
                        if *sine < 0.05 || expected.is_nan() {
                            continue;
                        }
                        held += 1;
                        off = off.min(1.0 - off);
                    }
                    assert!(!off.is_nan());
                    let error = &mut errors[property as usize];
                    *error = error.max(off);
                }
            }
        }
    }
    assert!(held * 10 > all * 8, "{held} of {all} pixels say where the light lies");
    hold("visibility", errors[0], 1e-6);
    hold("depth", errors[1], 1e-4);
    // The arc cosine loses half the digits at both ends.
    hold("angle to the light", errors[2], 5e-4);
    hold("angle in the picture", errors[3], 1e-4);
}

/// A smooth function: the filter of a sampler has only 8 bits between two texels.
fn smooth_map(random: &mut Random, size: u32) -> Texture {
    let phases: Vec<f64> = (0..12).map(|_| random.between(0.0, 6.3)).collect();
    let values: Vec<f32> = (0..size * size)
        .flat_map(|i| {
            let [x, y] = [i % size, i / size].map(|p| 2.0 * f64::from(p) / f64::from(size));
            let wave =
                |k: usize| 0.5 + 0.5 * (x * phases[k] * 0.5 + y * phases[k + 4] * 0.5 + phases[k + 8]).sin();
            let alpha = wave(3);
            [wave(0) * alpha, wave(1) * alpha, wave(2) * alpha, alpha].map(|v| v as f32)
        })
        .collect();
    gpu::texture([size, size], Rgba16Float, &values)
}

fn restyle(picture: &Synthetic, function: &TransferFunction, map: &Texture) -> Texture {
    let inputs = picture.inputs();
    let restyle = Restyle::new(gpu(), shaders(), function, &inputs, SIZE).unwrap();
    let uniform = Buffer::uniform(gpu(), function);
    let bound = restyle.bind(gpu(), &inputs, &picture.scattered, map, &uniform).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    restyle.restyled
}

#[test]
fn every_mode_makes_of_a_colour_what_it_should() {
    let _turn = gpu::turn();
    let mut random = Random(41);
    let mut error = 0.0_f64;
    for round in 0..24 {
        let picture = Synthetic::new(&mut random);
        let map = smooth_map(&mut random, 32);
        let settings = TransferSettings {
            across: [RayProperty::Visibility, RayProperty::Depth, RayProperty::LightAngle][round % 3],
            down: [RayProperty::Depth, RayProperty::LightAngle, RayProperty::Visibility][round % 3],
            mode: [Mode::Replace, Mode::Light, Mode::Scattering][round / 3 % 3],
            phase: if round % 2 == 0 { Phase::Constant } else { Phase::HenyeyGreenstein },
            strength: if round % 4 == 0 { 1.0 } else { random.unit() as f32 },
            brightness: random.between(0.0, 3.0) as f32,
            g: (round % 5 != 0).then(|| random.between(-0.8, 0.8) as f32),
            ..TransferSettings::default()
        };
        let function = settings.function(&picture.medium);
        let found = texels(&restyle(&picture, &function, &map));
        let (scattered, map) = (texels(&picture.scattered), texels(&map));
        let x = picture.properties(settings.across, f(function.depth_limit));
        let y = picture.properties(settings.down, f(function.depth_limit));
        let angles = picture.properties(RayProperty::LightAngle, 1.0);
        let light = picture.light.radiance.to_array().map(f);
        let mode = match settings.mode {
            Mode::Replace => reference::Mode::Replace,
            Mode::Light => reference::Mode::Light,
            Mode::Scattering => reference::Mode::Scattering,
        };
        let g = (settings.phase == Phase::HenyeyGreenstein).then_some(f(function.g));
        for i in 0..found.len() {
            let color = reference::lookup(&map, 32, [x[i], y[i]]);
            let cosine = (angles[i] * std::f64::consts::PI).cos();
            let of = [f(settings.strength), f(settings.brightness), cosine];
            let radiance = [scattered[i][0], scattered[i][1], scattered[i][2]];
            let of_color = |color| reference::restyled(mode, g, color, of, radiance, light);
            let expected = of_color(color);
            // Errors of the function's colour grow with what it is multiplied by.
            let white = of_color([1.0; 4]);
            for k in 0..3 {
                let scale = 1.0 + white[k] + radiance[k];
                error = error.max((found[i][k] - expected[k]).abs() / scale);
            }
            assert!((found[i][3] - scattered[i][3]).abs() < 1e-6, "visibility stays");
        }
    }
    hold("restyled light", error, 2e-3);
}

#[test]
fn strength_leads_from_one_light_to_the_other() {
    let _turn = gpu::turn();
    let mut random = Random(43);
    let picture = Synthetic::new(&mut random);
    let map = smooth_map(&mut random, 8);
    let light = |strength: f32| {
        let settings = TransferSettings { strength, ..TransferSettings::default() };
        texels(&restyle(&picture, &settings.function(&picture.medium), &map))
    };
    assert_eq!(light(0.0), texels(&picture.scattered), "without strength nothing changes");
    let (full, half) = (light(1.0), light(0.5));
    let middle: Vec<[f64; 4]> = full
        .iter()
        .zip(texels(&picture.scattered))
        .map(|(a, b)| std::array::from_fn(|i| 0.5 * (a[i] + b[i])))
        .collect();
    hold("halfway", greatest(&half, &middle), 6e-3);
}

#[test]
fn nothing_but_numbers_leaves_the_pass() {
    let _turn = gpu::turn();
    let mut random = Random(47);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 6e4, -6e4, 0.0];
    for round in 0..12 {
        let mut picture = Synthetic::new(&mut random);
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        let mut any = |count: usize| (0..count).map(|_| wild[random.below(6)]).collect::<Vec<_>>();
        picture.depth = gpu::texture(SIZE, R32Float, &any(pixels));
        picture.scattered = gpu::texture(SIZE, Rgba16Float, &any(4 * pixels));
        let map = gpu::texture([4, 4], Rgba16Float, &any(64));
        picture.light.radiance = Vec3::splat([0.0, 3e38, -3e38][round % 3]);
        picture.buffers[1] = Buffer::uniform(gpu(), &picture.light);
        let function = wild_function(&mut random, round);
        let found = restyle(&picture, &function, &map).read(gpu()).unwrap();
        assert!(found.iter().all(|value| value.is_finite()), "{function:?}");
        // The compute form says the same.
        let pass = Pass::compute(gpu(), shaders(), "stylize/transfer", "default").unwrap();
        let restyled = Texture::storage(gpu(), SIZE, Rgba16Float);
        let (uniform, sampler) = (Buffer::uniform(gpu(), &function), airlight::Sampler::linear(gpu()));
        let inputs = picture.inputs();
        let bound = pass
            .bind(
                gpu(),
                &[
                    ("camera", inputs.camera.into()),
                    ("light", inputs.light.into()),
                    ("transfer_function", (&uniform).into()),
                    ("depth", inputs.depth.into()),
                    ("scattered", (&picture.scattered).into()),
                    ("transfer_map", (&map).into()),
                    ("transfer_sampler", (&sampler).into()),
                    ("restyled", (&restyled).into()),
                ],
            )
            .unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [SIZE[0], SIZE[1], 1]);
        gpu().submit(encoder).unwrap();
        assert_eq!(restyled.read(gpu()).unwrap(), found);
    }
}

// Picks.

const PICTURE: [u32; 2] = [96, 72];

fn marched(stage: &Stage) -> Texture {
    let along = Along::ShadowMap { steps: 64 };
    let march = March::new(gpu(), shaders(), &along, Weighting::Average, PICTURE).unwrap();
    let bound = march.bind(gpu(), &stage.inputs(), &along).unwrap();
    let mut encoder = gpu().encoder();
    march.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    march.scattered
}

fn scene<'a>(
    stage: &'a Stage,
    scattered: &'a Texture,
    movements: &'a BTreeMap<String, Vec3>,
) -> PickScene<'a> {
    PickScene { camera: &stage.camera, medium: &stage.medium, inputs: stage.inputs(), scattered, movements }
}

#[test]
fn a_picked_pixel_has_its_colour_and_a_point_that_of_its_pixel() {
    let _turn = gpu::turn();
    let of = gpu::torus_over_plane();
    let stage = of.stage(PICTURE, [512, 512]);
    let scattered = marched(&stage);
    let movements = BTreeMap::from([("torus".to_owned(), Vec3::new(0.4, -0.3, 0.2))]);
    let scene = scene(&stage, &scattered, &movements);
    let camera = gpu::reference_camera(&of.view, PICTURE);
    let point = Vec3::new(-0.3, 2.2, 0.5);
    let pixel_of = |point: Vec3| {
        let [x, y, _] = camera.project(gpu::vector(point)).unwrap();
        [((x + 1.0) / 2.0 * 96.0) as u32, ((1.0 - y) / 2.0 * 72.0) as u32]
    };
    let followed = Place::Point { point, follow: Some("torus".to_owned()) };
    let moved = point + movements["torus"];
    let places = [
        Place::Point { point, follow: None },
        Place::Pixel(pixel_of(point)),
        followed.clone(),
        Place::Pixel(pixel_of(moved)),
    ];
    let settings = TransferSettings { depth_limit: Some(12.0), ..TransferSettings::default() };
    let found = baker().positions(gpu(), &settings, &places, &scene).unwrap();
    assert_eq!((found[0], found[2]), (found[1], found[3]));
    assert!(found[0].distance(found[2]) > 1e-3, "the object moved: {found:?}");
    // What a pick says is what the picture holds.
    let [x, y] = pixel_of(point);
    let (visibility, depth) = (
        texels(&scattered)[(y * 96 + x) as usize][3],
        f(stage.pictures.depth.read(gpu()).unwrap()[(y * 96 + x) as usize]),
    );
    let distance = camera.distance(ReferenceCamera::pixel_ndc(x as usize, y as usize, 96, 72), depth);
    hold("visibility of a pick", (f(found[0].x) - visibility).abs(), 1e-6);
    hold("depth of a pick", (f(found[0].y) - (distance / 12.0).min(1.0)).abs(), 1e-4);

    // The picked pixel, and all that are like it, have the constraint's colour.
    let red = color([0.9, 0.1, 0.2], 1.0);
    let mut style = transfer(
        256,
        vec![diffusion(vec![
            Constraint { place: followed, color: red },
            at(0.0, 0.0, color([0.0, 0.0, 1.0], 1.0)),
            at(1.0, 1.0, color([0.0, 1.0, 0.0], 1.0)),
        ])],
    );
    style.settings = settings;
    let map = baker().bake(gpu(), &style, Some(&scene)).unwrap();
    let function = settings.function(&stage.medium);
    let restyle = Restyle::new(gpu(), shaders(), &function, &stage.inputs(), PICTURE).unwrap();
    let bound =
        restyle.bind(gpu(), &stage.inputs(), &scattered, &map, &Buffer::uniform(gpu(), &function)).unwrap();
    let mut encoder = gpu().encoder();
    restyle.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let [x, y] = pixel_of(moved);
    let found = texels(&restyle.restyled)[(y * 96 + x) as usize];
    hold("the picked pixel", worst([(found[0], 0.9), (found[1], 0.1), (found[2], 0.2)].into_iter()), 1e-3);
}

#[test]
fn impossible_picks_are_errors() {
    let _turn = gpu::turn();
    let stage = gpu::torus_over_plane().stage(PICTURE, [64, 64]);
    let scattered = marched(&stage);
    let movements = BTreeMap::from([("torus".to_owned(), Vec3::ZERO)]);
    let scene = scene(&stage, &scattered, &movements);
    let settings = TransferSettings::default();
    let refused = |place: Place| baker().positions(gpu(), &settings, &[place], &scene).unwrap_err();
    let point = |point: Vec3, follow: Option<&str>| Place::Point { point, follow: follow.map(str::to_owned) };
    for (place, message) in [
        (Place::Pixel([96, 0]), "pick 1: pixel 96, 0 lies outside the picture of 96x72"),
        (Place::Pixel([0, 72]), "pick 1: pixel 0, 72 lies outside the picture of 96x72"),
        (point(Vec3::new(-2.5, 1.8, 9.0), None), "pick 1: the point [-2.5, 1.8, 9] lies outside the picture"),
        (point(Vec3::new(50.0, 1.0, 0.0), None), "pick 1: the point [50, 1, 0] lies outside the picture"),
        (point(Vec3::NAN, None), "pick 1: the point [NaN, NaN, NaN] lies outside the picture"),
        (point(Vec3::ZERO, Some("tree")), "pick 1: the scene has no object `tree` to follow; it has `torus`"),
    ] {
        assert_eq!(refused(place).to_string(), message);
    }
    let style = transfer(
        8,
        vec![diffusion(vec![Constraint { place: Place::Pixel([1, 1]), color: color([1.0; 3], 1.0) }])],
    );
    let error = baker().bake(gpu(), &style, None).err().unwrap();
    assert!(
        matches!(&error, TransferError::NeedsScene { key } if key == "layer[0].constraint[0]"),
        "{error}"
    );
}

#[test]
fn the_mean_place_of_lit_points_is_found_by_marching() {
    let _turn = gpu::turn();
    let of = gpu::torus_over_plane();
    let stage = of.stage(PICTURE, [512, 512]);
    let scattered = marched(&stage);
    let movements = BTreeMap::new();
    let settings = TransferSettings {
        across: RayProperty::VisibleDepth,
        down: RayProperty::Depth,
        depth_limit: Some(10.0),
        ..TransferSettings::default()
    };
    let pixels: Vec<[u32; 2]> = (0..300).map(|i| [i * 37 % 96, i * 11 % 72]).collect();
    let places: Vec<_> = pixels.iter().map(|pixel| Place::Pixel(*pixel)).collect();
    let found = baker().positions(gpu(), &settings, &places, &scene(&stage, &scattered, &movements)).unwrap();
    // By brute force in f64.
    let camera = gpu::reference_camera(&of.view, PICTURE);
    let map = stage.pictures.shadow_map.read(gpu()).unwrap();
    let depth = stage.pictures.depth.read(gpu()).unwrap();
    let matrix = gpu::matrix(stage.light.clip_from_world);
    let mut shadowed = 0;
    let mut errors: Vec<f64> = Vec::new();
    for ([x, y], found) in pixels.iter().zip(&found) {
        let ndc = ReferenceCamera::pixel_ndc(*x as usize, *y as usize, 96, 72);
        let distance = camera.distance(ndc, f(depth[(y * 96 + x) as usize])).min(10.0);
        let lit: Vec<f64> = (0..4000)
            .map(|i| distance * (f64::from(i) + 0.5) / 4000.0)
            .filter(|along| {
                let [u, v, z, _] = matrix.apply_point(camera.eye + camera.ray(ndc) * *along);
                let [u, v] = [(0.5 + 0.5 * u) * 512.0, (0.5 - 0.5 * v) * 512.0];
                let inside = (0.0..512.0).contains(&u) && (0.0..512.0).contains(&v);
                !inside || z <= f(map[v as usize * 512 + u as usize])
            })
            .collect();
        let mean = if lit.is_empty() { distance / 2.0 } else { lit.iter().sum::<f64>() / lit.len() as f64 };
        shadowed += usize::from((mean - distance / 2.0).abs() > 0.05);
        errors.push((f(found.x) * 10.0 - mean).abs() / distance);
    }
    errors.sort_by(f64::total_cmp);
    assert!(shadowed > 60, "{shadowed} rays pass through shadow");
    hold("mean place of lit points, median", errors[errors.len() / 2], 2e-3);
    // One of 96 samples more or less is half a hundredth of the ray.
    hold("mean place of lit points, 95 of 100", errors[errors.len() * 95 / 100], 1e-2);
}

// Key frames and files.

#[test]
fn key_frames_are_mixed_linearly() {
    let _turn = gpu::turn();
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
    let _turn = gpu::turn();
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
