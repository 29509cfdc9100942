// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights found in pictures of a volume: products with the matrix of all lights, and clamped conjugate gradients, against f64.

use crate::gpu::{self, Random, gpu, shaders};
use crate::projectors::cameras_about;
use airlight::core::Camera;
use airlight::data::disc_lights;
use airlight::inverse::{
    Channels, InverseError, LightMaps, LightPasses, LightSolver, LightStrategy, LightUnknown, Medium,
    Projector, ProjectorForm, SliceView, Solved, Target,
};
use airlight::{Lighting, Texture};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::inverse::{
    Grid, Matrix, Problem, Regulariser, Slices, View, VolumeBox, bounded, light_columns, straight,
};
use glam::{Mat4, Quat};
use std::sync::Arc;

const EXTINCTION: [u32; 3] = [14, 12, 13];
const ALBEDO: [u32; 3] = [6, 5, 7];
/// Of light volumes.
const SIZE: [u32; 3] = [12, 11, 10];
const VIEW: [u32; 2] = [30, 22];
const SLICES: u32 = 20;
const LIGHTS: usize = 16;
/// What channels of the extinction are multiplied by.
const FACTORS: [f32; 3] = [1.0, 0.5, 2.0];
const STRATEGIES: [LightStrategy; 2] = [LightStrategy::Volumes, LightStrategy::Columns];

fn count(size: &[u32]) -> usize {
    size.iter().map(|side| *side as usize).product()
}

fn placed() -> Mat4 {
    Mat4::from_rotation_translation(Quat::from_rotation_y(0.4), glam::Vec3::ZERO)
        * Mat4::from_scale(glam::Vec3::new(2.0, 1.8, 1.6))
        * Mat4::from_translation(glam::Vec3::splat(-0.5))
}

/// Numbers of a texture's channels from one number and a factor for each channel.
fn spread(values: &[f32], channels: Channels, factors: [f32; 3]) -> Vec<f32> {
    let rgb = |value: &f32| [factors[0] * value, factors[1] * value, factors[2] * value, 0.0];
    match channels {
        Channels::One => values.to_vec(),
        Channels::Rgb => values.iter().flat_map(rgb).collect(),
    }
}

fn volume(size: [u32; 3], values: &[f32], channels: Channels, factors: [f32; 3]) -> Texture {
    let format = match channels {
        Channels::One => wgpu::TextureFormat::R32Float,
        Channels::Rgb => wgpu::TextureFormat::Rgba32Float,
    };
    let texture = Texture::volume(gpu(), size, format);
    texture.write(gpu(), &spread(values, channels, factors)).unwrap();
    texture
}

/// One channel of numbers of a texture.
fn grid(size: [u32; 3], values: &[f32], channels: Channels, channel: usize) -> Grid {
    let own = values.iter().skip(channel).step_by(channels.numbers()).copied();
    Grid { size: size.map(|side| side as usize), values: own.map(f64::from).collect() }
}

fn cameras() -> Vec<(ReferenceCamera, Camera)> {
    let eyes = [[0.3, 0.4, 4.0], [3.6, -1.2, 0.9], [-2.4, 1.9, -2.2], [-1.0, -3.4, 1.0]];
    cameras_about(&eyes, 0.65, VIEW)
}

/// Pictures that are wanted of each view, and weights of their pixels.
type Wanted<'a> = (&'a [Vec<f32>], &'a [Vec<f32>]);

/// A medium, and what lights make it scatter, as the host and as the reference have them.
struct Case {
    channels: Channels,
    extinction: Vec<f32>,
    albedo: Vec<f32>,
    /// Voxels of light volumes.
    size: [u32; 3],
    /// Of each light, as the GPU computed it.
    volumes: Vec<Vec<f32>>,
}

impl Case {
    /// A dense ball in the light of sixteen discs: in a thin one light from one side is as good as from the other.
    fn new(channels: Channels, size: [u32; 3], random: &mut Random) -> Self {
        let density = |unit: Vec3| {
            let way = unit - Vec3::new(0.5, 0.5, 0.5);
            12.0 * (1.0 - 4.0 * way.dot(way)).max(0.0)
        };
        let dense = Grid::from_fn(EXTINCTION.map(|side| side as usize), density);
        let dense: Vec<f32> =
            dense.values.iter().map(|value| (value * random.between(0.6, 1.4)) as f32).collect();
        let albedo: Vec<f32> = (0..count(&ALBEDO)).map(|_| random.between(0.4, 1.0) as f32).collect();
        let texture = volume(EXTINCTION, &dense, channels, FACTORS);
        let discs = disc_lights(LIGHTS as u32, false);
        let groups: Vec<Vec<Lighting>> =
            (0..LIGHTS).map(|disc| discs.lights(disc, 3).into_iter().map(Lighting::from).collect()).collect();
        let maps = LightMaps { texels: 24, layers: 24, shadow_texels: 64 };
        let passes = LightPasses::new(gpu(), shaders(), channels).unwrap().with_maps(maps).unwrap();
        let volumes = passes.scattered_each(gpu(), &texture, placed(), size, &groups, None).unwrap();
        Self {
            channels,
            size,
            extinction: spread(&dense, channels, FACTORS),
            albedo: spread(&albedo, channels, [1.0; 3]),
            volumes: volumes.iter().map(|volume| volume.read(gpu()).unwrap()).collect(),
        }
    }

    fn texture(&self, size: [u32; 3], values: &[f32]) -> Texture {
        let format = match self.channels {
            Channels::One => wgpu::TextureFormat::R32Float,
            Channels::Rgb => wgpu::TextureFormat::Rgba32Float,
        };
        let texture = Texture::volume(gpu(), size, format);
        texture.write(gpu(), values).unwrap();
        texture
    }

    /// A solver for pictures that are wanted; black ones and even weights where there are none.
    fn solver(&self, strategy: LightStrategy, wanted: Option<Wanted<'_>>, smallness: f32) -> LightSolver {
        let form = ProjectorForm::new(Solved::Albedo, self.channels);
        let projector = Projector::new(gpu(), shaders(), form).unwrap();
        let medium = Arc::new(Medium {
            extinction: self.texture(EXTINCTION, &self.extinction),
            scattered: self.texture(ALBEDO, &self.albedo),
            index: None,
        });
        let mut targets = Vec::new();
        for (place, (_, camera)) in cameras().iter().enumerate() {
            let view = SliceView::new(camera, placed(), EXTINCTION, SLICES).unwrap();
            let view = projector.view(gpu(), &view, None).unwrap();
            let pixels = count(&VIEW);
            let (wanted, weights) = wanted
                .map(|(wanted, weights)| (wanted[place].clone(), weights[place].clone()))
                .unwrap_or((vec![0.0; self.channels.numbers() * pixels], vec![1.0; pixels]));
            targets.push(Target { view, medium: Arc::clone(&medium), wanted, weights });
        }
        let unknown = LightUnknown {
            volumes: self.volumes.iter().map(|values| self.texture(self.size, values)).collect(),
            start: vec![0.0; self.channels.numbers() * LIGHTS],
            smallness,
            strategy,
        };
        LightSolver::new(gpu(), shaders(), projector, targets, unknown).unwrap()
    }

    /// T of each view, one channel.
    fn matrices(&self, channel: usize) -> Vec<Matrix> {
        let volume_box = VolumeBox::new(gpu::matrix(placed())).unwrap();
        let extinction = grid(EXTINCTION, &self.extinction, self.channels, channel);
        let albedo = grid(ALBEDO, &self.albedo, self.channels, channel);
        let volumes: Vec<Grid> =
            self.volumes.iter().map(|values| grid(self.size, values, self.channels, channel)).collect();
        cameras()
            .iter()
            .map(|(camera, _)| {
                let view = View::new(camera, VIEW.map(|side| side as usize));
                let cut = Slices::of_view(
                    &volume_box,
                    &view,
                    EXTINCTION.map(|side| side as usize),
                    SLICES as usize,
                );
                light_columns(
                    &view.rays(|ray| straight(&volume_box, &cut, ray)),
                    &extinction,
                    &albedo,
                    &volumes,
                )
            })
            .collect()
    }
}

/// Greatest difference, of the greatest value of the second.
fn off(found: impl IntoIterator<Item = f64>, expected: &[f64]) -> f64 {
    let most = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let differences = found.into_iter().zip(expected).map(|(found, expected)| (found - expected).abs());
    differences.fold(0.0, f64::max) / most
}

fn channel_of(values: &[f32], channels: Channels, channel: usize) -> impl Iterator<Item = f64> {
    values.iter().skip(channel).step_by(channels.numbers()).copied().map(f64::from)
}

#[test]
fn discs_of_light_make_even_surroundings() {
    // Clear air scatters what comes from everywhere: a radiance of 1 is a radiance of 1.
    let texture = volume([2; 3], &[0.0; 8], Channels::One, FACTORS);
    let discs = disc_lights(32, false);
    let lights: Vec<Lighting> = (0..32).flat_map(|disc| discs.lights(disc, 2)).map(Lighting::from).collect();
    let passes = LightPasses::new(gpu(), shaders(), Channels::One).unwrap();
    let found = passes.scattered(gpu(), &texture, placed(), [5, 4, 3], &lights, None).unwrap();
    let expected = 32.0 * discs.solid_angle() / (4.0 * std::f32::consts::PI);
    for value in found.read(gpu()).unwrap() {
        assert!((value - expected).abs() < 1e-5 && (value - 1.0).abs() < 0.01, "{value} {expected}");
    }
}

#[test]
fn both_ways_multiply_with_the_matrix_of_lights_and_its_transpose() {
    let mut random = Random(21);
    // More groups of voxels than a group has threads, and fewer.
    for (channels, size) in [(Channels::One, [40, 24, 23]), (Channels::Rgb, SIZE)] {
        let case = Case::new(channels, size, &mut random);
        let numbers = channels.numbers();
        let mut some = |count: usize, low: f64| -> Vec<f32> {
            (0..count).map(|_| random.between(low, 1.0) as f32).collect()
        };
        let coefficients = some(numbers * LIGHTS, 0.0);
        let sent: Vec<Vec<f32>> = cameras().iter().map(|_| some(numbers * count(&VIEW), -0.5)).collect();
        let [volumes, columns] = STRATEGIES.map(|strategy| {
            let solver = case.solver(strategy, None, 0.0);
            let pictures = solver.pictures(gpu(), &coefficients).unwrap().concat();
            // Twice, so that nothing of the first time is left.
            solver.products(gpu(), &sent).unwrap();
            (pictures, solver.products(gpu(), &sent).unwrap())
        });
        let used = if channels == Channels::One { 1 } else { 3 };
        for channel in 0..used {
            let own = |values: &[f32]| -> Vec<f64> { channel_of(values, channels, channel).collect() };
            let apart = [off(own(&volumes.0), &own(&columns.0)), off(own(&volumes.1), &own(&columns.1))];
            let matrix = Matrix::stacked(&case.matrices(channel));
            let expected = matrix.apply(&own(&coefficients));
            let back = matrix.apply_transposed(&own(&sent.concat()));
            let errors = [off(own(&volumes.0), &expected), off(own(&volumes.1), &back)];
            println!(
                "{channels:?} {channel}: ways apart {:.1e} {:.1e}, from f64 {:.1e} {:.1e}",
                apart[0], apart[1], errors[0], errors[1]
            );
            assert!(apart.iter().all(|error| *error < 1e-5), "{apart:?}");
            assert!(errors.iter().all(|error| *error < 1e-4), "{errors:?}");
        }
    }
}

#[test]
fn lights_come_back_from_their_own_pictures() {
    let mut random = Random(8);
    let case = Case::new(Channels::Rgb, SIZE, &mut random);
    // Some lights are black.
    let known: Vec<f32> = (0..4 * LIGHTS)
        .map(|place| if place % 4 == 3 { 0.0 } else { random.between(-0.3, 2.0).max(0.0) as f32 })
        .collect();
    let most = known.iter().copied().fold(0.0, f32::max);
    for strategy in STRATEGIES {
        let pictures = case.solver(strategy, None, 0.0).pictures(gpu(), &known).unwrap();
        let weights = vec![vec![1.0; count(&VIEW)]; pictures.len()];
        let mut solver = case.solver(strategy, Some((&pictures, &weights)), 0.0);
        let mut worst = 0.0;
        for iteration in 1..=200 {
            solver.iterate(gpu()).unwrap();
            if [6, 16, 60, 120, 200].contains(&iteration) {
                let found = solver.coefficients(gpu()).unwrap();
                let off = found.iter().zip(&known).enumerate().filter(|(place, _)| place % 4 != 3);
                worst = off.map(|(_, (a, b))| (a - b).abs()).fold(0.0, f32::max) / most;
                println!("{strategy:?}: {:.2} % off after {iteration} iterations", 100.0 * worst);
                assert!(found.iter().all(|value| *value >= 0.0));
            }
        }
        let residuals: Vec<f32> =
            solver.residuals(gpu()).unwrap().iter().map(|rgb| rgb.iter().sum()).collect();
        assert!(residuals.len() == 200 && residuals[5] < 0.02 * residuals[0], "{residuals:?}");
        assert!(worst < 0.02, "{strategy:?}: {worst}");
    }
}

#[test]
fn impossible_pictures_have_their_least_squares() {
    let mut random = Random(13);
    let case = Case::new(Channels::One, SIZE, &mut random);
    let mut some = |low: f64, high: f64| -> Vec<Vec<f32>> {
        let one = |_| (0..count(&VIEW)).map(|_| random.between(low, high).max(-0.2) as f32).collect();
        (0..cameras().len()).map(one).collect()
    };
    // Of a light that no lights have: dark spots next to bright ones.
    let wanted = some(-0.4, 0.8);
    let weights: Vec<Vec<f32>> = some(-0.5, 1.0)
        .into_iter()
        .map(|view| view.into_iter().map(|weight: f32| weight.max(0.0)).collect())
        .collect();
    let matrix = Matrix::stacked(&case.matrices(0));
    let all = |rows: &[Vec<f32>]| -> Vec<f64> { rows.concat().into_iter().map(f64::from).collect() };
    let (targets, rows) = (all(&wanted), all(&weights));
    let smallness = 0.001_f32;
    let problem = Problem {
        matrix: &matrix,
        targets: &targets,
        weights: &rows,
        unknown: &[true; LIGHTS],
        regularisers: &[Regulariser { laplacian: 0.0, zero: f64::from(smallness), one: 0.0 }],
    };
    let normal = problem.normal();
    let best = problem.cost(&normal.expand(&bounded(&normal, f64::INFINITY).unwrap()));
    let nothing = problem.cost(&[0.0; LIGHTS]);
    for strategy in STRATEGIES {
        let mut solver = case.solver(strategy, Some((&wanted, &weights)), smallness);
        for _ in 0..150 {
            solver.iterate(gpu()).unwrap();
        }
        let found: Vec<f64> = solver.coefficients(gpu()).unwrap().into_iter().map(f64::from).collect();
        assert!(found.iter().all(|value| value.is_finite() && *value >= 0.0), "{found:?}");
        let left = (problem.cost(&found) - best) / (nothing - best);
        let dark = found.iter().filter(|value| **value == 0.0).count();
        println!("{strategy:?}: {left:.1e} of the way is left; {dark} lights are black");
        let residuals = solver.residuals(gpu()).unwrap();
        assert!(residuals[149][0] < residuals[0][0] && dark > 0, "{residuals:?}");
        assert!(left > -1e-6 && left < 1e-6, "{strategy:?}: {left}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let form = |solved| ProjectorForm::new(solved, Channels::One);
    let texture = |size: [u32; 3]| volume(size, &vec![1.0; count(&size)], Channels::One, FACTORS);
    let camera = Camera { viewport: glam::Vec2::splat(256.0), ..cameras()[0].1 };
    let refusal = |solved: Solved, volumes: Vec<Texture>, start: Vec<f32>, smallness: f32, strategy| {
        let projector = Projector::new(gpu(), shaders(), form(solved)).unwrap();
        let medium =
            Arc::new(Medium { extinction: texture([2; 3]), scattered: texture([1; 3]), index: None });
        let view = SliceView::new(&camera, placed(), [2; 3], 4).unwrap();
        let view = projector.view(gpu(), &view, None).unwrap();
        let (wanted, weights) = (vec![0.0; 65536], vec![1.0; 65536]);
        let target = Target { view, medium, wanted, weights };
        let unknown = LightUnknown { volumes, start, smallness, strategy };
        LightSolver::new(gpu(), shaders(), projector, vec![target], unknown).err()
    };
    let (albedo, few) = (Solved::Albedo, LightStrategy::Columns);
    let refused = refusal(Solved::Emission, vec![texture([2; 3])], vec![0.0], 0.0, few);
    assert!(matches!(refused, Some(InverseError::LightProjector)));
    let refused = refusal(albedo, vec![], vec![], 0.0, few);
    assert!(matches!(refused, Some(InverseError::Setting(_))));
    let refused = refusal(albedo, vec![texture([2; 3]), texture([3; 3])], vec![0.0; 2], 0.0, few);
    assert!(matches!(refused, Some(InverseError::Count { .. })));
    let refused = refusal(albedo, vec![texture([2; 3])], vec![0.0; 2], 0.0, few);
    assert!(matches!(refused, Some(InverseError::Count { .. })));
    for (start, smallness) in [(f32::NAN, 0.0), (-1.0, 0.0), (0.0, f32::NAN), (0.0, -1.0)] {
        let refused = refusal(albedo, vec![texture([2; 3])], vec![start], smallness, few);
        assert!(matches!(refused, Some(InverseError::Setting(_))), "{start} {smallness}");
    }
    // 1000 pictures of 256 x 256 numbers are 250 MiB; as volumes they are nothing.
    let many = || (0..1000).map(|_| texture([1; 3])).collect::<Vec<_>>();
    let refused = refusal(albedo, many(), vec![0.0; 1000], 0.0, few).unwrap();
    assert!(matches!(refused, InverseError::LightColumns { bytes: 262_144_000, .. }), "{refused}");
    assert!(refused.to_string().contains("light volumes"), "{refused}");
    assert!(refusal(albedo, many(), vec![0.0; 1000], 0.0, LightStrategy::Volumes).is_none());
}
