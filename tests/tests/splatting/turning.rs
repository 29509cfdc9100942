// SPDX-License-Identifier: MIT OR Apache-2.0
//! The eye turns once around a cloud that is lit from the side: sheets turn with it, and at right angles to the light they turn
//! over. No picture may show when.

use crate::gpu::{gpu, shaders};
use crate::sheets::{colored, splats};
use airlight::core::{Camera, DepthRange, Light, PerspectiveView};
use airlight::data::{Volume, cloud};
use airlight::splatting::{SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, Splats};
use glam::Vec3;

const SIZE: [u32; 2] = [48, 32];
/// Sheets of the pictures that must not pop.
const COUNT: u32 = 128;
/// So few that they do.
const FEW: u32 = 12;
/// Frames of the turn.
const FRAMES: u32 = 180;
/// Between them, degrees.
const STEP: f32 = 360.0 / FRAMES as f32;

fn small_cloud() -> Volume {
    let mut volume = cloud([24, 14, 20], 5);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    volume
}

/// From the side, and from above by a little.
fn side_light(volume: &Volume) -> Light {
    let bounds = volume.bounds();
    let room = 0.7;
    Light::directional(Vec3::new(1.0, 0.35, 0.0), Vec3::splat(9.0), bounds.min - room, bounds.max + room)
        .unwrap()
}

fn eye_at(degrees: f32) -> Vec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    Vec3::new(9.0 * cosine, 2.0, 9.0 * sine)
}

/// Where eye and light are at right angles to each other on the turn, degrees.
fn right_angles() -> [f32; 2] {
    let cosine = -0.35 * 2.0 / 9.0_f32;
    [cosine.acos().to_degrees(), 360.0 - cosine.acos().to_degrees()]
}

/// Pictures of one cloud from anywhere on the turn.
struct Turn<'a> {
    picture: SheetPicture<'a>,
    light: Light,
}

impl<'a> Turn<'a> {
    fn new(volume: &Volume, splats: &'a Splats, count: u32) -> Self {
        let transfer = colored([Vec3::ONE; 2]);
        let settings = SheetSettings { count, light_size: [96; 2], ..SheetSettings::default() };
        let splats = std::slice::from_ref(splats);
        let inputs = SheetInputs::new(splats, &transfer);
        let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, SIZE).unwrap();
        Self { picture, light: side_light(volume) }
    }

    /// Luminance of the pixels, and whether sheets lie from front to back.
    fn luminances(&self, degrees: f32) -> (Vec<f64>, bool) {
        let (target, depth) = (Vec3::ZERO, DepthRange::Reversed);
        let view = PerspectiveView {
            eye: eye_at(degrees),
            target,
            field_of_view: 30.0,
            near: 0.1,
            far: 40.0,
            depth,
        };
        let camera = Camera::perspective(&view, SIZE).unwrap();
        let lighting = SheetLighting { g: 0.4, ambient: Vec3::splat(0.02), ..SheetLighting::new(4.0) };
        let frame = SheetFrame { camera, light: self.light, lighting };
        let sheets = self.picture.set(gpu(), &frame).unwrap();
        let mut encoder = gpu().encoder();
        self.picture.record(gpu(), &mut encoder).unwrap();
        gpu().submit(encoder).unwrap();
        let texels = self.picture.picture.read(gpu()).unwrap();
        let luminance = |texel: &[f32]| {
            let weighted =
                [0.2126, 0.7152, 0.0722].iter().zip(texel).map(|(weight, x)| weight * f64::from(*x));
            weighted.sum::<f64>()
        };
        (texels.chunks_exact(4).map(luminance).collect(), sheets.front_to_back == 1)
    }

    fn mean(&self, degrees: f32) -> f64 {
        mean(&self.luminances(degrees).0)
    }

    /// Change of mean luminance where sheets turn over, within a fiftieth of a degree, which moves nothing else; and the root of
    /// the mean square of changes of pixels over that of luminance.
    fn pop(&self, degrees: f32) -> [f64; 2] {
        let [(before, one), (behind, other)] = [-0.01, 0.01].map(|step| self.luminances(degrees + step));
        assert!(one != other, "sheets do not turn over at {degrees}");
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let changes = square(&mut before.iter().zip(&behind).map(|(a, b)| a - b));
        [mean(&behind) - mean(&before), changes / square(&mut before.iter().copied())]
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, b| a.max(b.abs()))
}

/// Changes between neighbours of a closed list.
fn changes(means: &[f64]) -> Vec<f64> {
    (0..means.len()).map(|i| means[(i + 1) % means.len()] - means[i]).collect()
}

/// Mean luminances of a turn.
fn around(turn: &Turn<'_>) -> Vec<f64> {
    (0..FRAMES).map(|frame| turn.mean(STEP * frame as f32)).collect()
}

/// Greatest change from frame to frame, and greatest change of that.
fn roughness(means: &[f64]) -> [f64; 2] {
    let first = changes(means);
    [greatest(first.iter().copied()), greatest(changes(&first).into_iter())]
}

#[test]
fn the_eye_turns_and_nothing_pops() {
    let volume = small_cloud();
    let splats = splats(&volume);
    let turn = Turn::new(&volume, &splats, COUNT);
    let means = around(&turn);
    let all = mean(&means);
    let [change, bend] = roughness(&means).map(|change| change / all);
    println!(
        "greatest change of mean luminance in {STEP} degrees {change:.5} of the mean of the turn, of that change {bend:.5}"
    );
    // Motion that is smooth changes half as much in half the time; a pop stays whole on one side of the middle.
    let steps = changes(&means);
    let mut steepest: Vec<usize> = (0..steps.len()).collect();
    steepest.sort_by(|a, b| steps[*b].abs().total_cmp(&steps[*a].abs()));
    let turned_over = right_angles().map(|degrees| (degrees / STEP) as usize);
    let mut half = 0.0_f64;
    for frame in steepest.iter().take(6).chain(&turned_over) {
        let middle = turn.mean(STEP * (*frame as f32 + 0.5));
        let end = means[(frame + 1) % means.len()];
        half = half.max((middle - means[*frame]).abs().max((end - middle).abs()) / all);
    }
    println!("greatest change in {} degree: {half:.5}", 0.5 * STEP);
    let pops = right_angles().map(|degrees| turn.pop(degrees).map(f64::abs));
    for (degrees, [pop, pixels]) in right_angles().iter().zip(pops) {
        println!("where sheets turn over, at {degrees:.1} degrees: {:.5}, pixels {pixels:.5}", pop / all);
    }
    assert!(change < 0.04 && bend < 0.006, "{change} {bend}");
    assert!(half < 0.6 * change, "{half} of {change}");
    assert!(pops.iter().all(|[pop, pixels]| *pop < 0.002 * all && *pixels < 0.005), "{pops:?}");

    // The same measures see a pop where there is one.
    let few = Turn::new(&volume, &splats, FEW);
    let bend = roughness(&around(&few))[1] / all;
    let pops = right_angles().map(|degrees| few.pop(degrees).map(f64::abs));
    println!("{FEW} sheets: change of the change {bend:.5}, where they turn over {pops:.5?}");
    assert!(bend > 0.012 && pops.iter().all(|[_, pixels]| *pixels > 0.1), "{bend} {pops:?}");
}
