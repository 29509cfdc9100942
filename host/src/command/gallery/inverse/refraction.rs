// SPDX-License-Identifier: MIT OR Apache-2.0
//! A tree that grows, hidden in the extinction of a sphere of glass that bends rays (thesis Fig. 7.7).

use super::super::album::{Album, Section};
use super::super::studio::Studio;
use super::super::transmittance::sky::directions;
use super::easel::{Pose, RGB, decibels, fidelity, pixels, solve_size};
use super::glass::{Glass, HALF, RADIUS, STEP, room};
use crate::command::CommandError;
use crate::command::inverse::field::{Field, colours, numbers};
use crate::command::inverse::paint::{Canvas, Tree};
use crate::core::Camera;
use crate::inverse::{
    Fields, LogTargets, Medium, Projector, ProjectorForm, Regulariser, SliceView, Solved, Solver, Target,
    Unknown, log_targets,
};
use glam::{Vec2, Vec3};
use std::sync::Arc;
use std::time::Instant;

/// Voxels along a side.
const SIDE: u32 = 64;
/// Degrees from side to side; opposite sides would see the same, mirrored.
const TURN: f32 = 45.0;
/// Greatest optical depth that is painted.
const MOST_DEPTH: f32 = 3.0;
const EXPOSURE: f32 = 0.9;
/// Of pictures that are solved for.
const COLUMNS: u32 = 288;
/// Pixels without paint count so much.
const ELSEWHERE: f32 = 0.15;

fn pose(azimuth: f32) -> Pose {
    Pose::around(Vec3::ZERO, [6.5, 0.0], azimuth, 21.0)
}

/// From a sapling to the whole tree.
fn tree(stage: u8) -> Tree {
    let growth = [0.3, 0.55, 0.78, 1.0][usize::from(stage.min(3))];
    let leaves = [
        Vec3::new(0.30, 0.55, 0.12),
        Vec3::new(0.22, 0.48, 0.10),
        Vec3::new(0.14, 0.38, 0.09),
        Vec3::new(0.62, 0.30, 0.05),
    ][usize::from(stage.min(3))];
    Tree {
        foot: Vec2::new(0.0, -0.56),
        height: 1.0,
        seed: 4,
        growth,
        wood: Vec3::new(0.12, 0.06, 0.035),
        leaves: Some(leaves),
    }
}

/// A view of the glass.
struct Look {
    camera: Camera,
    size: [u32; 2],
    /// What is seen through clear glass and beside it.
    clear: Vec<Vec3>,
    /// 1 where there is glass.
    glass: Vec<f32>,
}

impl Look {
    fn new(glass: &Glass, azimuth: f32, size: [u32; 2]) -> Result<Self, CommandError> {
        let pose = pose(azimuth);
        let camera = pose.camera(size)?;
        // Bent rays by half of the pixels along each side.
        let half = size.map(|side| side.div_ceil(2));
        let ways = directions(&pose.camera(half)?, half).into_iter();
        let bent = ways.map(|way| room(glass.leaves(pose.eye, way).unwrap_or(way))).collect();
        let bent = Field { size: [half[0], half[1], 1], values: bent }.resized([size[0], size[1], 1]);
        let ways = directions(&camera, size);
        let away = |way: &Vec3| (pose.eye - pose.eye.dot(*way) * *way).length();
        // A pixel at the rim is part of both.
        let pixel = 2.0 * (0.5 * pose.field_of_view.to_radians()).tan() * pose.eye.length() / size[1] as f32;
        let inside: Vec<f32> =
            ways.iter().map(|way| (0.5 + (RADIUS - away(way)) / pixel).clamp(0.0, 1.0)).collect();
        let clear = ways.iter().zip(&bent.values).zip(&inside);
        let clear = clear.map(|((way, bent), inside)| {
            // Glass reflects at its rim.
            let grazing = (away(way) / RADIUS).min(1.0).powi(14);
            room(*way).lerp(*bent * (1.0 - 0.55 * grazing), *inside)
        });
        Ok(Self { camera, size, clear: clear.collect(), glass: inside })
    }

    /// The picture that is wanted, and how much each pixel counts.
    fn target(&self, stage: u8) -> (Vec<Vec3>, Vec<f32>) {
        let painted = tree(stage).paint(&Canvas::new(self.size, self.clear.clone()));
        let parts = painted.canvas.pixels().iter().zip(&self.clear).zip(&self.glass);
        let picture = parts.map(|((tree, clear), glass)| clear.lerp(tree.min(*clear), *glass));
        let weights = painted.coverage.iter().zip(&self.glass);
        let weights = weights.map(|(paint, glass)| glass * (ELSEWHERE + (1.0 - ELSEWHERE) * paint));
        (picture.collect(), weights.collect())
    }
}

/// Optical depths of all channels. Their own weights, which make them errors of radiance where a solution is near, would let what is dark
/// and far away still count for nothing.
fn depths(wanted: &[Vec3], look: &Look, weights: &[f32]) -> Result<Vec<f32>, CommandError> {
    let one = |channel: usize| {
        let [picture, clear] =
            [wanted, &look.clear].map(|of| of.iter().map(|color| color[channel]).collect::<Vec<f32>>());
        log_targets(&picture, &clear, weights, 0.0, MOST_DEPTH)
    };
    let rows: Vec<LogTargets> = (0..3).map(one).collect::<Result<_, _>>()?;
    let at = |pixel: usize| [0, 1, 2].map(|channel| rows[channel].depths[pixel]);
    Ok((0..wanted.len()).flat_map(|pixel| Vec3::from(at(pixel)).extend(0.0).to_array()).collect())
}

/// The section.
pub fn section(studio: &Studio, folder: &str) -> Result<Section, CommandError> {
    let (gpu, shaders) = (&studio.gpu, &studio.shaders);
    let glass = Glass::new(0.22, 0.10, 3);
    let form = ProjectorForm { refraction: Some(STEP), ..ProjectorForm::new(Solved::Extinction, RGB) };
    let nothing = Field::constant(Vec3::ZERO);
    let medium = Arc::new(Medium {
        extinction: nothing.texture(gpu, RGB)?,
        scattered: nothing.texture(gpu, RGB)?,
        index: Some(glass.texture(gpu)?),
    });
    let rays = |camera: &Camera| SliceView::new(camera, Glass::place(), [SIDE; 3], SIDE);

    let begun = Instant::now();
    let projector = Projector::new(gpu, shaders, form)?;
    let mut targets = Vec::new();
    for stage in 0..4_u8 {
        let look = Look::new(&glass, TURN * f32::from(stage), solve_size(studio.size, COLUMNS))?;
        let (wanted, weights) = look.target(stage);
        let wanted = depths(&wanted, &look, &weights)?;
        let view = projector.view(gpu, &rays(&look.camera)?, None)?;
        targets.push(Target { view, medium: Arc::clone(&medium), wanted, weights });
    }
    let inside = |i: u32| {
        let voxel = Vec3::new((i % SIDE) as f32, (i / SIDE % SIDE) as f32, (i / (SIDE * SIDE)) as f32);
        ((voxel + 0.5) / SIDE as f32 * 2.0 - 1.0).length() * HALF < RADIUS
    };
    let solved: Vec<bool> = (0..SIDE * SIDE * SIDE).map(inside).collect();
    let start = numbers(&vec![Vec3::splat(0.02); solved.len()], RGB);
    let regulariser = Regulariser { laplacian: 1e-4, ..Regulariser::default() };
    let unknown = Unknown { size: [SIDE; 3], solved, start, high: 1e30, regulariser };
    let mut solver = Solver::new(gpu, shaders, projector, targets, &[unknown])?;
    for _ in 0..12 {
        solver.iterate(gpu)?;
    }
    let values = solver.solutions(gpu)?.into_iter().next().unwrap_or_default();
    let found = Field { size: [SIDE; 3], values: colours(&values, RGB) }.texture(gpu, RGB)?;
    let seconds = begun.elapsed().as_secs_f64();

    let renderer = Projector::new(gpu, shaders, form)?;
    let seen = |look: &Look| -> Result<Vec<Vec3>, CommandError> {
        let view = renderer.view(gpu, &rays(&look.camera)?, None)?;
        let mut encoder = gpu.encoder();
        let fields = Fields { emission: &found, albedo: &found, extinction: &found };
        renderer.render(gpu, &mut encoder, &view, &medium, fields)?;
        gpu.submit(encoder)?;
        let depths = colours(&view.rendered.read(gpu)?, RGB);
        Ok(depths.iter().zip(&look.clear).map(|(depth, clear)| *clear * (-*depth).exp()).collect())
    };
    let show = |radiance: &[Vec3]| pixels(studio, radiance, studio.size, EXPOSURE);
    let about = "Four stages of a tree are painted onto four sides of a sphere of glass with streaks, before a bright room. Extinction of each channel is solved for along the bent rays: who stands at the right place sees a tree, who stands elsewhere a cloud of colours.";
    let mut album = Album::new(&studio.out, folder, "Trees in glass".to_owned(), about.to_owned())?;
    let mut facts = Vec::new();
    let mut results = Vec::new();
    for stage in 0..4_u8 {
        let look = Look::new(&glass, TURN * f32::from(stage), studio.size)?;
        let wanted = show(&look.target(stage).0)?;
        let result = show(&seen(&look)?)?;
        album.add_tile(
            format!("{stage}_target.png"),
            format!("Target {}", stage + 1),
            studio.size,
            &wanted,
        )?;
        facts.push((format!("side {}", stage + 1), decibels(fidelity(&result, &wanted, &look.glass))));
        results.push((format!("{stage}_result.png"), format!("Result {}", stage + 1), result));
    }
    let glassy = Look::new(&glass, 0.0, studio.size)?;
    for azimuth in [22.5, 67.5, 250.0] {
        let look = Look::new(&glass, azimuth, studio.size)?;
        results.push((
            format!("between_{azimuth}.png"),
            format!("In between, from {azimuth}°"),
            show(&seen(&look)?)?,
        ));
    }
    results.push(("clear.png".to_owned(), "Original: clear glass".to_owned(), show(&glassy.clear)?));
    for (file, caption, shown) in &results {
        album.add_tile(file.as_str(), caption.as_str(), studio.size, shown)?;
    }
    facts.into_iter().for_each(|(what, value)| album.fact(what, value));
    album.fact("three channels from four views", format!("{seconds:.1} s"));
    album.finish_with_sheet(
        4,
        "Targets, results from the same sides, and views in between with the clear glass",
    )
}
