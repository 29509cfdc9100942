// SPDX-License-Identifier: MIT OR Apache-2.0
//! Clamped conjugate gradients on the GPU against exact bounded least squares in f64.

use crate::gpu::{self, Random, gpu, shaders};
use crate::projectors::cameras_about;
use airlight::Texture;
use airlight::core::Camera;
use airlight::inverse::{
    Basis, Channels, Fields, InverseError, Medium, Projector, ProjectorForm, Regulariser, SliceView, Solved,
    Solver, Target, Transpose, Unknown,
};
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::inverse::{
    Basis as ReferenceBasis, Grid, Matrix, Medium as ReferenceMedium, Part, Problem, Property,
    Regulariser as ReferenceRegulariser, Slices, View, VolumeBox, bounded, straight, touched,
};
use glam::Mat4;
use std::sync::Arc;

const EXTINCTION: [u32; 3] = [8, 7, 6];
const GRIDS: [[u32; 3]; 2] = [[6, 5, 4], [4, 5, 6]];
const SIZE: [u32; 2] = [22, 18];
const SLICES: u32 = 11;

fn count(size: [u32; 3]) -> usize {
    size.iter().map(|side| *side as usize).product()
}

fn reference_size(size: [u32; 3]) -> [usize; 3] {
    size.map(|side| side as usize)
}

fn volume(size: [u32; 3], values: &[f32]) -> Texture {
    let texture = Texture::volume(gpu(), size, wgpu::TextureFormat::R32Float);
    texture.write(gpu(), values).unwrap();
    texture
}

fn grid(size: [u32; 3], values: &[f32]) -> Grid {
    Grid { size: reference_size(size), values: values.iter().copied().map(f64::from).collect() }
}

fn placed() -> Mat4 {
    Mat4::from_scale(glam::Vec3::new(2.0, 1.8, 1.6)) * Mat4::from_translation(glam::Vec3::splat(-0.5))
}

fn cameras() -> Vec<(ReferenceCamera, Camera)> {
    cameras_about(&[[0.3, 0.4, 4.0], [3.6, 0.8, 0.9], [-2.4, 1.9, 2.2]], 0.6, SIZE)
}

/// A problem for both sides.
struct Case {
    solved: Solved,
    regulariser: [f32; 3],
    high: f32,
}

/// Residuals of the GPU's iterations, the cost of its solution and of the exact one, and that of nothing.
fn solve(case: &Case, iterations: u32, random: &mut Random) -> (Vec<f32>, [f64; 3]) {
    let mut numbers = |count: usize, low: f64, high: f64| -> Vec<f32> {
        (0..count).map(|_| random.between(low, high).max(0.0) as f32).collect()
    };
    // Empty in places: voxels that nothing says anything about are not solved for.
    let extinction = numbers(count(EXTINCTION), -1.5, 2.0);
    let scattered = numbers(1, 0.8, 0.8);
    let pixels = count([SIZE[0], SIZE[1], 1]);
    // No volume has these pictures.
    let wanted: Vec<Vec<f32>> = cameras().iter().map(|_| numbers(pixels, -0.2, 1.0)).collect();
    let weights: Vec<Vec<f32>> = cameras().iter().map(|_| numbers(pixels, -0.3, 1.0)).collect();
    let indices = match case.solved {
        Solved::Both => vec![0, 1],
        Solved::Albedo => vec![1],
        _ => vec![0],
    };
    let property = |i: usize| match (case.solved, i) {
        (Solved::Extinction, _) => Property::Extinction,
        (_, 0) => Property::Emission,
        _ => Property::Albedo,
    };
    let part = |i: usize| Part {
        property: property(i),
        size: reference_size(GRIDS[i]),
        basis: ReferenceBasis::Trilinear,
    };
    let parts: Vec<Part> = indices.iter().map(|i| part(*i)).collect();
    let dense = grid(EXTINCTION, &extinction);
    let unknown: Vec<Vec<bool>> = parts.iter().map(|part| touched(part, &dense)).collect();

    let [laplacian, smallness, oneness] = case.regulariser;
    let own: Vec<Unknown> = parts
        .iter()
        .zip(&indices)
        .zip(&unknown)
        .map(|((part, i), solved)| Unknown {
            size: GRIDS[*i],
            solved: solved.clone(),
            start: vec![0.0; part.columns()],
            high: case.high,
            regulariser: Regulariser { laplacian, smallness, oneness },
        })
        .collect();
    let medium = Arc::new(Medium {
        extinction: volume(EXTINCTION, &extinction),
        scattered: volume([1; 3], &scattered),
        index: None,
    });
    let form = ProjectorForm {
        solved: case.solved,
        channels: Channels::One,
        basis: Basis::Triangle,
        transpose: Transpose::Collect,
        refraction: None,
    };
    let projector = Projector::new(gpu(), shaders(), form).unwrap();
    let mut targets = Vec::new();
    for ((_, camera), (wanted, weights)) in cameras().iter().zip(wanted.iter().zip(&weights)) {
        let view = SliceView::new(camera, placed(), EXTINCTION, SLICES).unwrap();
        let view = projector.view(gpu(), &view, None).unwrap();
        let (wanted, weights) = (wanted.clone(), weights.clone());
        targets.push(Target { view, medium: Arc::clone(&medium), wanted, weights });
    }
    let mut solver = Solver::new(gpu(), shaders(), projector, targets, &own).unwrap();
    for _ in 0..iterations {
        solver.iterate(gpu()).unwrap();
    }
    let residuals = solver.residuals(gpu()).unwrap().iter().map(|row| row[0]).collect();
    let found: Vec<f64> = solver.solutions(gpu()).unwrap().concat().into_iter().map(f64::from).collect();
    assert!(found.iter().all(|value| (0.0..=f64::from(case.high)).contains(value)));

    let volume_box = VolumeBox::new(gpu::matrix(placed())).unwrap();
    let known = ReferenceMedium { extinction: dense, scattered: grid([1; 3], &scattered) };
    let matrices: Vec<Matrix> = cameras()
        .iter()
        .map(|(camera, _)| {
            let view = View::new(camera, SIZE.map(|side| side as usize));
            let cut = Slices::of_view(&volume_box, &view, reference_size(EXTINCTION), SLICES as usize);
            Matrix::new(&view.rays(|ray| straight(&volume_box, &cut, ray)), &known, &parts)
        })
        .collect();
    let matrix = Matrix::stacked(&matrices);
    let all = |rows: &[Vec<f32>]| -> Vec<f64> { rows.concat().into_iter().map(f64::from).collect() };
    let [zero, one, laplacian] = [smallness, oneness, laplacian].map(f64::from);
    let regularisers = vec![ReferenceRegulariser { laplacian, zero, one }; parts.len()];
    let unknown = unknown.concat();
    let (targets, weights) = (all(&wanted), all(&weights));
    let problem = Problem {
        matrix: &matrix,
        targets: &targets,
        weights: &weights,
        unknown: &unknown,
        regularisers: &regularisers,
    };
    let normal = problem.normal();
    let best = normal.expand(&bounded(&normal, f64::from(case.high)).unwrap());
    let nothing = vec![0.0; best.len()];
    (residuals, [&found, &best, &nothing].map(|values| problem.cost(values)))
}

#[test]
fn iterations_come_to_the_least_squares_between_bounds() {
    let mut random = Random(11);
    for case in [
        Case { solved: Solved::Emission, regulariser: [0.01, 0.01, 0.0], high: 1e30 },
        Case { solved: Solved::Albedo, regulariser: [0.02, 0.0, 0.03], high: 1.0 },
        Case { solved: Solved::Both, regulariser: [0.01, 0.02, 0.0], high: 1.0 },
        Case { solved: Solved::Extinction, regulariser: [0.01, 0.01, 0.0], high: 0.5 },
    ] {
        let (residuals, [found, best, nothing]) = solve(&case, 60, &mut random);
        let left = (found - best) / (nothing - best);
        println!(
            "{:?}: {:.1e} of the way is left after 60 iterations; residuals {:.4} {:.4} {:.4} {:.4}",
            case.solved, left, residuals[0], residuals[3], residuals[6], residuals[59]
        );
        assert!(residuals.len() == 60 && residuals[59] < residuals[0], "{residuals:?}");
        assert!(left > -1e-9 && left < 1e-9, "{:?}: {left}", case.solved);
    }
}

#[test]
fn own_pictures_come_back() {
    let size = [16; 3];
    let field = |f: &dyn Fn(glam::Vec3) -> [f32; 3]| -> Vec<f32> {
        (0..count(size))
            .flat_map(|i| {
                let at = glam::UVec3::new(i as u32 % 16, i as u32 / 16 % 16, i as u32 / 256);
                let [r, g, b] = f((at.as_vec3() + 0.5) / 16.0 - 0.5);
                [r, g, b, 0.0]
            })
            .collect()
    };
    let rgba = |size: [u32; 3], values: &[f32]| {
        let texture = Texture::volume(gpu(), size, wgpu::TextureFormat::Rgba32Float);
        texture.write(gpu(), values).unwrap();
        texture
    };
    // A coloured ball that glows at one end and is lit from one side.
    let extinction = field(&|at| [4.0, 5.0, 6.0].map(|k| k * (1.0 - 4.0 * at.length_squared()).max(0.0)));
    let light = field(&|at| [1.0 + at.x, 0.9, 0.8 - at.y]);
    let emission = field(&|at| [0.6 * (0.5 + at.z), 0.3 * (0.5 + at.y), 0.1]);
    let albedo = field(&|at| [0.8 - 0.5 * at.x, 0.5, 0.5 + 0.6 * at.z]);
    let medium =
        Arc::new(Medium { extinction: rgba(size, &extinction), scattered: rgba(size, &light), index: None });
    let form = ProjectorForm {
        solved: Solved::Both,
        channels: Channels::Rgb,
        basis: Basis::Triangle,
        transpose: Transpose::Collect,
        refraction: None,
    };
    let projector = Projector::new(gpu(), shaders(), form).unwrap();
    let textures = [rgba(size, &emission), rgba(size, &albedo)];
    let pixels = count([SIZE[0], SIZE[1], 1]);
    let targets = cameras()
        .iter()
        .map(|(_, camera)| {
            let view = SliceView::new(camera, placed(), size, 24).unwrap();
            let view = projector.view(gpu(), &view, None).unwrap();
            let fields = Fields { emission: &textures[0], albedo: &textures[1], extinction: &textures[0] };
            let mut encoder = gpu().encoder();
            projector.render(gpu(), &mut encoder, &view, &medium, fields).unwrap();
            gpu().submit(encoder).unwrap();
            let wanted = view.rendered.read(gpu()).unwrap();
            Target { view, medium: Arc::clone(&medium), wanted, weights: vec![1.0; pixels] }
        })
        .collect();
    let touched = extinction.chunks_exact(4).map(|voxel| voxel[0] > 0.0).collect::<Vec<_>>();
    let unknown = |high: f32| Unknown {
        size,
        solved: touched.clone(),
        start: vec![0.0; 4 * count(size)],
        high,
        regulariser: Regulariser { laplacian: 1e-6, smallness: 0.0, oneness: 0.0 },
    };
    let mut solver =
        Solver::new(gpu(), shaders(), projector, targets, &[unknown(1e30), unknown(1.0)]).unwrap();
    for _ in 0..31 {
        solver.iterate(gpu()).unwrap();
    }
    let residuals: Vec<f32> = solver.residuals(gpu()).unwrap().iter().map(|rgb| rgb.iter().sum()).collect();
    // From nothing, so that what was wrong at first are the pictures themselves.
    let left = [6, 30].map(|iterations| residuals[iterations] / residuals[0]);
    println!("squares that are left after 6 and 30 iterations: {:.1e} {:.1e}", left[0], left[1]);
    // What lies deep in the medium comes last. The root is the error of radiance: 1 %.
    assert!(left[0] < 0.02 && left[1] < 1e-4, "{residuals:?}");
    let all = solver.solutions(gpu()).unwrap();
    assert!(all[0].iter().all(|value| *value >= 0.0));
    assert!(all[1].iter().all(|value| (0.0..=1.0).contains(value)));
}

#[test]
fn numbers_that_do_not_fit_are_refused() {
    let unknown = Unknown {
        size: [2; 3],
        solved: vec![true; 8],
        start: vec![0.0; 8],
        high: 1.0,
        regulariser: Regulariser::default(),
    };
    let short = Unknown { start: vec![0.0; 7], ..unknown.clone() };
    for unknowns in [vec![], vec![short], vec![unknown.clone(), unknown]] {
        let form = ProjectorForm {
            solved: Solved::Emission,
            channels: Channels::One,
            basis: Basis::Triangle,
            transpose: Transpose::Collect,
            refraction: None,
        };
        let projector = Projector::new(gpu(), shaders(), form).unwrap();
        let refused = Solver::new(gpu(), shaders(), projector, Vec::new(), &unknowns);
        assert!(matches!(refused.err(), Some(InverseError::Count { .. })));
    }
}
