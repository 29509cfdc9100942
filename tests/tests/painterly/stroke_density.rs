// SPDX-License-Identifier: MIT OR Apache-2.0
//! Densities and pictures of strokes against sums and blends in f64 over the strokes that were read back.

use crate::gpu::gpu;
use crate::turning::{Show, Turning, even_brush, style};
use airlight::Texture;
use airlight::painterly::{BrushImage, Brushes, PainterlyStyle, Stroke, StrokeState};
use airlight_tests::parallel;
use airlight_tests::reference::painterly::strokes::{Quad, density};
use std::f64::consts::PI;

const SIZE: [u32; 2] = [200, 125];
const PICTURE: [u32; 2] = [400, 250];
/// Rasterisers round corners to a 256th of a pixel.
const SNAP: f64 = 1.5 / 256.0;

fn quad(stroke: &Stroke) -> Quad {
    Quad {
        middle: [0, 1].map(|axis| f64::from(stroke.position[axis]) * f64::from(PICTURE[axis])),
        length: f64::from(stroke.size),
        width: f64::from(stroke.size * stroke.aspect),
        orientation: f64::from(stroke.orientation),
    }
}

fn settled(style: PainterlyStyle, brushes: Brushes, step: u32) -> Show {
    let mut show = Show::new(Turning::ball(SIZE), style, brushes, |mut settings| {
        (settings.picture_size, settings.density_step) = (PICTURE, step);
        settings
    });
    for frame in 0..8 {
        show.frame(frame, |_| ());
    }
    show
}

/// Densities that the GPU adds up for strokes that stay as they are, against f64: the greatest difference, the greatest over what
/// rounding explains, the greatest density, and the number of texels in doubt. Half floats: each of n additions rounds by at
/// most 2^-10 of a sum that is at most the last, since adapters may round towards 0.
fn densities(show: &mut Show, anticipation: f64, brush: impl Fn([f64; 2]) -> f64 + Sync) -> [f64; 4] {
    // Density is of the strokes after their update: one more frame, of no time, in which none comes or goes.
    show.again(7, |step| (step.generation, step.deletion, step.seconds) = (false, false, 0.0));
    let strokes = show.read();
    let found = show.strokes.density.read(gpu()).unwrap();
    let [width, height, _] = show.strokes.density.size();
    let style = *show.strokes.style();
    let quads: [Vec<(Quad, f64)>; 3] = [0, 1, 2].map(|layer| {
        let of_layer = strokes.iter().filter(|stroke| stroke.layer == layer);
        let weighted = of_layer.map(|stroke| {
            let goal = if stroke.state == StrokeState::Stays { 1.0 } else { 0.0 };
            let opacity = f64::from(stroke.opacity);
            (quad(stroke), f64::from(style.density_unit) * (opacity + (goal - opacity) * anticipation))
        });
        weighted.collect()
    });
    let row = |y: usize| {
        let mut worst = [0.0_f64; 4];
        for x in 0..width as usize {
            let at = [x, y].map(|k| k as f64 + 0.5);
            let sides = [f64::from(PICTURE[0]) / f64::from(width), f64::from(PICTURE[1]) / f64::from(height)];
            for (layer, quads) in quads.iter().enumerate() {
                let (sum, count, doubtful) =
                    density(quads, [at[0] * sides[0], at[1] * sides[1]], SNAP * sides[0], &brush);
                if doubtful {
                    worst[3] += 1.0;
                } else {
                    let got = f64::from(found[4 * (y * width as usize + x) + layer]);
                    let (off, rounding) = ((got - sum).abs(), f64::from(count) * sum / 1024.0);
                    worst[0] = worst[0].max(off);
                    worst[1] = worst[1].max(off / (rounding + 1e-7));
                    worst[2] = worst[2].max(sum);
                }
            }
        }
        worst
    };
    let rows = parallel::rows(height as usize, row);
    let most = |k: usize| rows.iter().map(|row| row[k]).fold(0.0, f64::max);
    assert!(found.iter().skip(3).step_by(4).all(|x| *x == 0.0));
    [most(0), most(1), most(2), rows.iter().map(|row| row[3]).sum()]
}

#[test]
fn densities_are_the_sums_of_their_strokes() {
    // 100 texels by 63: the last row reaches beyond the picture, and is scaled like the others.
    for (step, anticipation) in [(4, 1.0), (2, 0.0), (4, 0.4)] {
        let of = PainterlyStyle { anticipation: anticipation as f32, ..style() };
        let mut show = settled(of, even_brush(0.6), step);
        let [worst, over_rounding, most, doubtful] = densities(&mut show, anticipation, |_| 0.6);
        println!(
            "step {step}, anticipation {anticipation}: off by {worst:.1e} of up to {most:.3}; {doubtful} texels in doubt"
        );
        println!("{over_rounding:.2} of what rounding explains");
        assert!(most > 0.05 && over_rounding < 1.0, "{over_rounding}");
        let texels = show.strokes.density.size();
        assert!(doubtful < 0.3 * f64::from(texels[0] * texels[1]), "{doubtful}");
    }
}

#[test]
fn densities_count_the_opacity_of_the_brush() {
    let shape = |c: [f64; 2]| 0.25 * (1.0 - (2.0 * PI * c[0]).cos()) * (1.0 - (2.0 * PI * c[1]).cos());
    let texels = (0..128 * 32).map(|k| {
        let alpha = shape([(f64::from(k % 128) + 0.5) / 128.0, (f64::from(k / 128) + 0.5) / 32.0]) as f32;
        [0.0, 0.0, 0.0, alpha]
    });
    let brush = Brushes::new(gpu(), &[BrushImage::new([128, 32], texels.collect()).unwrap()]).unwrap();
    assert!((brush.mean_opacity(None) - 0.25).abs() < 2e-3);
    let mut show = settled(style(), brush, 1);
    let [worst, _, most, doubtful] = densities(&mut show, 1.0, shape);
    println!("off by {worst:.1e} of up to {most:.3}; {doubtful} texels in doubt");
    // Mipmaps of the sources of a stroke a few pixels wide are blurred versions of the brush.
    assert!(worst < 0.12 * most, "{worst:e} {most}");
}

/// What is seen through and of strokes, blended in their order in f64: RGB and alpha of each pixel, and pixels in doubt.
fn blended(strokes: &[Stroke], order: &[u32], opacity: f64, ground: [f64; 4]) -> Vec<([f64; 4], bool)> {
    let quads: Vec<Quad> = strokes.iter().map(quad).collect();
    let row = |y: usize| -> Vec<_> {
        let pixel = |x: usize| {
            let at = [x as f64 + 0.5, y as f64 + 0.5];
            let (mut color, mut doubtful) = (ground, false);
            for index in order {
                let stroke = &strokes[*index as usize];
                let (inside, near) = quads[*index as usize].covers(at, SNAP);
                doubtful |= near;
                if inside {
                    let alpha = opacity * f64::from(stroke.opacity);
                    let tint = [stroke.color.x, stroke.color.y, stroke.color.z, 1.0].map(f64::from);
                    color = std::array::from_fn(|k| tint[k] * alpha + (1.0 - alpha) * color[k]);
                }
            }
            (color, doubtful)
        };
        (0..PICTURE[0] as usize).map(pixel).collect()
    };
    parallel::rows(PICTURE[1] as usize, row).into_iter().flatten().collect()
}

#[test]
fn pictures_at_full_size_are_strokes_blended_in_their_order() {
    // Brushes of no hue, so that tints come through: white, of 0.7 opacity.
    let opacity = (0.7_f32 * 255.0).round() / 255.0;
    let image = BrushImage::new([1, 1], vec![[opacity; 4]]).unwrap();
    let mut show = settled(style(), Brushes::new(gpu(), &[image]).unwrap(), 4);
    show.again(7, |step| step.seconds = 0.02);
    let picture = Texture::target(gpu(), PICTURE, wgpu::TextureFormat::Rgba16Float);
    let ground = [0.25, 0.5, 0.125, 1.0];
    picture.write(gpu(), &ground.repeat((PICTURE[0] * PICTURE[1]) as usize)).unwrap();
    let mut encoder = gpu().encoder();
    show.strokes.draw(gpu(), &mut encoder, &picture).unwrap();
    gpu().submit(encoder).unwrap();
    let found = picture.read(gpu()).unwrap();
    let order = show.strokes.read_order(gpu()).unwrap();
    let expected = blended(&show.read(), &order, f64::from(opacity), ground.map(f64::from));
    let (mut worst, mut doubtful, mut painted) = (0.0_f64, 0, 0);
    for (pixel, (color, doubt)) in found.chunks_exact(4).zip(&expected) {
        doubtful += usize::from(*doubt);
        painted += usize::from((color[0] - 0.25).abs() > 1e-6);
        if !doubt {
            let off = pixel.iter().zip(color).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            worst = worst.max(off);
        }
    }
    println!("off by {worst:.1e}; {doubtful} in doubt, {painted} painted of {}", expected.len());
    // Half floats, rounded at every stroke; the last few count.
    assert!(
        worst < 4e-3 && painted > expected.len() / 4 && doubtful < expected.len() / 10,
        "{worst:e} {doubtful}"
    );
}
