// SPDX-License-Identifier: MIT OR Apache-2.0
//! How many strokes there are: as many as chance gives by expectation, and within the bounds of density while the shape turns.

use crate::gpu::gpu;
use crate::turning::{Show, Turning, even_brush, style};
use airlight::painterly::{Brushes, PainterlyStyle, STYLES, StrokeState, parse_style};
use airlight_tests::reference::camera::Camera;
use airlight_tests::reference::painterly::strokes::layer;

/// Pixels of each layer of what is seen.
fn areas(turning: &Turning, frame: u32) -> [f64; 3] {
    let mut areas = [0.0; 3];
    for sight in turning.sights(frame).iter().flatten() {
        let magnitude = f64::from((turning.magnitude)(sight.point) as f32);
        areas[layer(magnitude, [0.1, 0.3, 1.0]).unwrap()] += 1.0;
    }
    areas
}

#[test]
fn first_strokes_are_as_many_as_expected_in_each_layer() {
    let size = [480, 300];
    let table = |name: &str| {
        let (_, text) = STYLES.iter().find(|(known, _)| *known == name).unwrap();
        parse_style(name, text).unwrap()
    };
    // Table 5.1 where the probability of placement bounds births, and a style of small strokes where the gap does.
    let all = |style: PainterlyStyle| {
        let mut style = PainterlyStyle { density_margin: 0.0, ..style };
        for layer in [&mut style.coarse, &mut style.medium, &mut style.fine] {
            (layer.brush, layer.opacity) = (Some(0), 0.8);
        }
        style
    };
    let mut scarce = all(style());
    scarce.coarse.density.min = 0.01;
    scarce.fine.probability = 0.02;
    let mut bounded = [0, 0];
    for (name, style) in [("a", all(table("a"))), ("c", all(table("c"))), ("scarce", scarce)] {
        let picture = if name == "scarce" { size } else { [1280, 800] };
        let mut show = Show::new(Turning::ball(size), style, even_brush(0.5), |mut settings| {
            settings.picture_size = picture;
            settings
        });
        let pixels = areas(&show.turning, 0);
        let counts = show.frame(0, |_| ());
        let scale = f64::from(size[0] * size[1]) / f64::from(picture[0] * picture[1]);
        // An even brush of a half is 128 of 255.
        let each = |k: usize| {
            let layer = style.layers()[k];
            f64::from(layer.size).powi(2) * f64::from(layer.aspect) * scale * 128.0 / 255.0
                * f64::from(layer.opacity)
        };
        for (k, layer) in style.layers().into_iter().enumerate() {
            let filling = f64::from(layer.density.min) / (f64::from(style.density_unit) * each(k));
            let p = filling.min(f64::from(layer.probability));
            bounded[usize::from(filling < f64::from(layer.probability))] += 1;
            let (expected, sigma) = (p * pixels[k], (p * (1.0 - p) * pixels[k]).sqrt());
            let z = (f64::from(counts.layers()[k]) - expected) / sigma;
            println!("{name}, layer {k}: {} of {expected:.1} expected, {z:.2} sigma", counts.layers()[k]);
            assert!(expected > 8.0 && z.abs() < 4.0, "{name} {k}: {z}");
        }
    }
    assert!(bounded.iter().all(|count| *count >= 2), "both bounds are met: {bounded:?}");
}

/// Mean density of each layer over its own texels, and of each of its tiles of 32 by 32 pixels that it covers a quarter of.
fn densities(show: &Show, frame: u32) -> [(f64, Vec<f64>); 3] {
    let found = show.strokes.density.read(gpu()).unwrap();
    let [width, height, _] = show.strokes.density.size().map(|side| side as usize);
    let posed = show.turning.posed(frame);
    let side = 8;
    let tiles = [width.div_ceil(side), height.div_ceil(side)];
    [0, 1, 2].map(|k| {
        let mut sums = vec![(0.0, 0.0); tiles[0] * tiles[1]];
        for y in 0..height {
            for x in 0..width {
                let ndc = Camera::pixel_ndc(x, y, width, height);
                let Some(sight) = posed.sight(&show.turning.camera, ndc) else { continue };
                if layer((show.turning.magnitude)(sight.point), [0.1, 0.3, 1.0]) == Some(k) {
                    let tile = &mut sums[y / side * tiles[0] + x / side];
                    *tile = (tile.0 + f64::from(found[4 * (y * width + x) + k]), tile.1 + 1.0);
                }
            }
        }
        let (sum, count) = sums.iter().fold((0.0, 0.0), |all, tile| (all.0 + tile.0, all.1 + tile.1));
        let covered = sums.iter().filter(|tile| tile.1 >= (side * side) as f64 / 4.0);
        (sum / count, covered.map(|tile| tile.0 / tile.1).collect())
    })
}

#[test]
fn densities_stay_within_their_bounds_while_the_shape_turns() {
    let mut show = Show::new(Turning::ball([640, 400]), style(), even_brush(1.0), |mut settings| {
        settings.picture_size = [1280, 800];
        settings
    });
    for frame in 0..=60 {
        show.frame(frame, |_| ());
    }
    let bounds = style().coarse.density;
    let (least, most) = (f64::from(bounds.min), f64::from(bounds.max));
    for (k, (mean, tiles)) in densities(&show, 60).into_iter().enumerate() {
        let inside = tiles.iter().filter(|tile| (least..=most).contains(tile)).count();
        let below = tiles.iter().filter(|tile| **tile < least).count();
        let strokes = show.read();
        let staying =
            strokes.iter().filter(|s| s.layer as usize == k && s.state == StrokeState::Stays).count();
        println!(
            "layer {k}: mean {mean:.4}, {inside} of {} tiles inside, {below} below; {staying} stay",
            tiles.len()
        );
        assert!((least..=most).contains(&mean), "{mean}");
        assert!(tiles.len() > 20 && 20 * inside >= 19 * tiles.len(), "{inside} of {}", tiles.len());
    }
}

#[test]
fn what_is_too_dense_is_thinned_out_to_the_maximum_at_once() {
    // Bounds that are lowered once strokes lie densely.
    let mut show = Show::new(Turning::ball([400, 250]), style(), even_brush(1.0), |settings| settings);
    for _ in 0..4 {
        show.frame(0, |_| ());
    }
    let mut lower = PainterlyStyle { density_margin: 0.0, ..style() };
    for layer in [&mut lower.coarse, &mut lower.medium, &mut lower.fine] {
        (layer.density.min, layer.density.max) = (0.0, 0.03);
    }
    show.strokes.set_style(lower).unwrap();
    let before = densities(&show, 0);
    show.again(0, |step| step.generation = false);
    // Those that fade out count no more.
    show.again(0, |step| (step.generation, step.deletion) = (false, false));
    for (k, ((dense, _), (thin, _))) in before.into_iter().zip(densities(&show, 0)).enumerate() {
        println!("layer {k}: {dense:.4} thinned to {thin:.4}");
        assert!(dense > 0.08 && (thin / 0.03 - 1.0).abs() < 0.12, "{dense} {thin}");
    }
}

#[test]
fn the_dense_style_has_thirty_to_fifty_thousand_strokes() {
    let (_, text) = STYLES.iter().find(|(name, _)| *name == "dense").unwrap();
    let style = parse_style("dense", text).unwrap();
    // A ball of nine tenths of the height covers 0.4 of the picture; sources of half its size.
    let turning = Turning::ball_within([640, 400], 0.3303);
    let share = areas(&turning, 0).iter().sum::<f64>() / 256_000.0;
    assert!((share - 0.4).abs() < 0.01, "{share}");
    let mut show = Show::new(turning, style, Brushes::procedural(gpu()).unwrap(), |mut settings| {
        settings.picture_size = [1280, 800];
        settings
    });
    for frame in 0..60 {
        let counts = show.frame(frame, |_| ());
        if frame % 10 == 9 {
            let strokes = show.read();
            let staying = strokes.iter().filter(|stroke| stroke.state == StrokeState::Stays).count();
            println!("frame {frame}: {counts:?}, {staying} stay");
        }
        assert_eq!(counts.dropped, 0);
        if frame >= 40 {
            assert!((30_000..=50_000).contains(&counts.instances), "{counts:?}");
        }
    }
}
