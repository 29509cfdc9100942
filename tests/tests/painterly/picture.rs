// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paintings: strokes on what rays find in volumes, over a ground.

use crate::gpu::{Random, gpu, matrix, shaders};
use crate::painted::{Exhibit, SIZE, paint, place, settings, staying, style};
use crate::surfaces::{PLAIN, RAMP, head, reference_camera};
use airlight::Texture;
use airlight::data::{Volume, sphere_field};
use airlight::painterly::{
    IsoFrame, IsoRaycast, IsoSettings, IsoTargets, PainterlyStyle, Painting, Stroke, StrokeState,
};
use airlight_tests::error::mean_absolute;
use airlight_tests::linear;
use airlight_tests::reference::painterly::strokes::layer;
use airlight_tests::reference::painterly::{Solid, classify, trilinear};
use glam::{Mat4, Vec3};
use std::collections::HashMap;

const HEAD: [[f32; 4]; 4] = [[0.2, 0.1, 0.1, 0.0], [0.9, 0.7, 0.6, 0.25], [1.0, 0.9, 0.8, 1.0], [1.0; 4]];

fn head_exhibit() -> Exhibit {
    Exhibit::new(head(), None, &HEAD)
}

fn head_style() -> PainterlyStyle {
    style([0.08, 0.14, 1.0])
}

/// All bits that a frame leaves.
fn bits(painting: &Painting<'_>) -> Vec<Vec<u32>> {
    let IsoTargets { color, surface, flow, distance, .. } = painting.targets();
    let textures: [&Texture; 6] =
        [color, surface, flow, distance, &painting.strokes().density, &painting.picture];
    let mut all: Vec<_> = textures.iter().map(|texture| texture.read_words(gpu()).unwrap()).collect();
    all.push(painting.strokes().read_order(gpu()).unwrap());
    all
}

fn layers_seen(painting: &Painting<'_>, style: &PainterlyStyle) -> [f64; 3] {
    let targets = painting.targets();
    let distances = targets.distance.read(gpu()).unwrap();
    let ends = style.layers().map(|layer| f64::from(layer.threshold));
    let mut areas = [0.0; 3];
    for (texel, distance) in targets.surface.read(gpu()).unwrap().chunks_exact(4).zip(distances) {
        if distance >= 0.0
            && let Some(k) = layer(f64::from(texel[3]), ends)
        {
            areas[k] += 1.0;
        }
    }
    areas
}

#[test]
fn two_paintings_have_the_same_bits() {
    let exhibit = head_exhibit();
    let run = |seed| {
        let mut settings = settings(head_style(), SIZE);
        settings.strokes.seed = seed;
        let mut painting = exhibit.painting(settings);
        (0..6).for_each(|frame| paint(&mut painting, &exhibit.frame(SIZE, frame)));
        bits(&painting)
    };
    let (one, same, other) = (run(1), run(1), run(2));
    assert!(one[6].len() > 500, "{} strokes", one[6].len());
    assert!(one == same);
    assert!(
        one[..4] == other[..4] && one[5] != other[5],
        "another seed changes strokes, and nothing of the rays"
    );
}

/// What is solid of an exhibit in a frame, in f64.
fn solid<T>(exhibit: &Exhibit, frame: u32, of: impl FnOnce(&Solid<'_>) -> T) -> T {
    let volume = &exhibit.uploaded;
    let (scale, offset) = (f64::from(volume.scale), f64::from(volume.offset));
    let texels = volume.texture.read(gpu()).unwrap();
    let values: Vec<f64> = texels.iter().map(|texel| f64::from(*texel) * scale + offset).collect();
    let table: Vec<_> = exhibit.table.iter().map(|entry| entry.map(f64::from)).collect();
    let size = volume.size.map(|side| side as usize);
    of(&Solid {
        unit_from_world: matrix(exhibit.posed(frame)).inverse().unwrap(),
        value: &|unit| trilinear(size, &values, unit).clamp(0.0, 1.0),
        table: &table,
        iso_value: f64::from(exhibit.surface.iso_value),
        clip_planes: &[],
    })
}

/// Whether nothing solid lies before the point of a stroke.
fn is_seen(exhibit: &Exhibit, solid: &Solid<'_>, frame: u32, stroke: &Stroke) -> bool {
    let camera = reference_camera(&exhibit.frame(SIZE, frame).camera);
    let [x, y, z, _] =
        matrix(exhibit.posed(frame)).apply_point(linear::Vec3::from(stroke.point.to_array().map(f64::from)));
    let point = linear::Vec3::new(x, y, z);
    let Some([x, y, _]) = camera.project(point).filter(|[x, y, _]| x.abs() < 1.0 && y.abs() < 1.0) else {
        return false;
    };
    let direction = camera.ray([x, y]);
    let distance = (point - camera.origin([x, y])).dot(direction);
    let step = 0.5 * f64::from(exhibit.volume.voxel());
    (4..(distance / step) as usize).all(|k| !solid.holds(point - direction * (k as f64 * step)))
}

fn strokes_keep_to_their_points(exhibit: &Exhibit, style: PainterlyStyle) {
    const SETTLED: u32 = 8;
    let mut painting = exhibit.painting(settings(style, SIZE));
    (0..SETTLED).for_each(|frame| paint(&mut painting, &exhibit.frame(SIZE, frame)));
    let before = staying(&painting);
    assert!(before.len() > 300, "{}", before.len());
    // Points lie on the surface: the opacity there is the iso-value.
    let voxel = f64::from(exhibit.volume.voxel());
    let off = solid(exhibit, SETTLED - 1, |solid| {
        let world = matrix(exhibit.posed(SETTLED - 1));
        let off = before.iter().map(|stroke| {
            let unit = stroke.point.to_array().map(f64::from);
            let opacity = classify(solid.table, (solid.value)(unit.map(|u| u.clamp(0.0, 1.0))))[3];
            let [x, y, z, _] = world.apply_point(linear::Vec3::from(unit));
            let value = solid.gradient(linear::Vec3::new(x, y, z), 0.05 * voxel).length() * voxel;
            // Opacity changes by at least as much as the value, times the least slope of the table that is met.
            (opacity - solid.iso_value).abs() / (value * 0.5).max(0.01)
        });
        let mut off: Vec<f64> = off.collect();
        off.sort_by(f64::total_cmp);
        off[off.len() * 95 / 100]
    });
    println!("95 % of the points lie within {off:.3} voxels of the surface");
    assert!(off < 0.5, "{off}");

    let points: HashMap<u32, Vec3> = before.iter().map(|stroke| (stroke.hash, stroke.point)).collect();
    let mut places: HashMap<u32, [f64; 2]> = HashMap::new();
    let (mut drift, mut moved) = (0.0_f64, 0.0_f64);
    let end = SETTLED + 10;
    for frame in SETTLED..end {
        let mut step = exhibit.frame(SIZE, frame);
        (step.generation, step.deletion) = (false, false);
        paint(&mut painting, &step);
        let (camera, world) = (reference_camera(&step.camera), matrix(step.world_from_unit));
        for stroke in staying(&painting) {
            // Where it was put, not where it says that it is.
            let point = linear::Vec3::from(points[&stroke.hash].to_array().map(f64::from));
            let [x, y, z, _] = world.apply_point(point);
            let [x, y] = place(&camera, linear::Vec3::new(x, y, z)).unwrap();
            let found = stroke.position.to_array().map(f64::from);
            let pixels = |a: [f64; 2], b: [f64; 2]| {
                ((a[0] - b[0]) * f64::from(SIZE[0])).hypot((a[1] - b[1]) * f64::from(SIZE[1]))
            };
            drift = drift.max(pixels(found, [x, y]));
            if let Some(old) = places.insert(stroke.hash, [x, y]) {
                moved = moved.max(pixels([x, y], old));
            }
        }
    }
    println!("drift {drift:.5} pixels, at up to {moved:.2} pixels a frame");
    assert!(drift < 0.05 && moved > 0.8, "{drift} {moved}");

    let after: HashMap<u32, StrokeState> = painting
        .strokes()
        .read(gpu())
        .unwrap()
        .into_iter()
        .map(|stroke| (stroke.hash, stroke.state))
        .collect();
    let (mut seen, mut survive, mut hidden, mut linger) = (0.0, 0.0, 0.0, 0.0);
    solid(exhibit, end - 1, |solid| {
        for stroke in &before {
            let stays = f64::from(u8::from(after.get(&stroke.hash) == Some(&StrokeState::Stays)));
            if is_seen(exhibit, solid, end - 1, stroke) {
                (seen, survive) = (seen + 1.0, survive + stays);
            } else {
                (hidden, linger) = (hidden + 1.0, linger + stays);
            }
        }
    });
    println!("{survive} of {seen} that are seen survive, {linger} of {hidden} that are not");
    assert!(survive >= 0.9 * seen && seen > 250.0, "{survive} of {seen}");
    // A point that has just passed out of sight is within the tolerance for some pixels.
    assert!(hidden > 5.0 && linger <= 0.35 * hidden, "{linger} of {hidden}");
}

#[test]
fn strokes_keep_to_their_points_of_a_sphere() {
    let mut exhibit = Exhibit::new(sphere_field([40; 3], 0.6), Some([0.0, 1.0]), &RAMP);
    exhibit.turn = 3_f32.to_radians();
    strokes_keep_to_their_points(&exhibit, style([0.3, 0.6, 2.0]));
}

#[test]
fn strokes_keep_to_their_points_of_a_head() {
    strokes_keep_to_their_points(&head_exhibit(), head_style());
}

#[test]
fn half_the_rays_paint_a_picture_alike() {
    let exhibit = head_exhibit();
    let style = head_style();
    let run = |size: [u32; 2]| {
        let mut painting = exhibit.painting(settings(style, size));
        let mut frame = exhibit.frame(size, 0);
        paint(&mut painting, &frame);
        let counts = painting.strokes().read_counts(gpu()).unwrap();
        let areas = layers_seen(&painting, &style);
        frame.seconds = 1.0;
        paint(&mut painting, &frame);
        (counts.layers(), areas, painting.picture.read(gpu()).unwrap())
    };
    let (whole, half) = (run(SIZE), run(SIZE.map(|side| side / 2)));
    for (name, (counts, areas, _), scale) in [("whole", &whole, 1.0), ("half", &half, 0.25)] {
        for (k, layer) in style.layers().into_iter().enumerate() {
            let least =
                f64::from(layer.density.min) + 0.15 * f64::from(layer.density.max - layer.density.min);
            // An even brush of 0.8 is 204 of 255.
            let each = 0.01 * f64::from(layer.size).powi(2) * f64::from(layer.aspect) * scale * 0.8;
            let p = (least / each).min(f64::from(layer.probability));
            let (expected, sigma) = (p * areas[k], (p * (1.0 - p) * areas[k]).sqrt());
            let z = (f64::from(counts[k]) - expected) / sigma;
            println!("{name}, layer {k}: {} of {expected:.1} expected, {z:.2} sigma", counts[k]);
            assert!(expected > 20.0 && z.abs() < 4.0, "{name} {k}: {z}");
        }
    }
    let difference = mean_absolute(&whole.2, &half.2);
    let bare = mean_absolute(&whole.2, &vec![0.9_f32; whole.2.len()]);
    println!("mean difference {difference:.4}, to a canvas {bare:.4}");
    assert!(difference < 0.04 && bare > 2.0 * difference, "{difference} {bare}");
}

#[test]
fn another_iso_value_needs_no_other_ranges() {
    let mut exhibit = head_exhibit();
    let other = IsoSettings { iso_value: 0.12, ..IsoSettings::default() };
    let seen = |painting: &Painting<'_>| bits(painting)[..4].to_vec();
    let mut old = exhibit.painting(settings(head_style(), SIZE));
    paint(&mut old, &exhibit.frame(SIZE, 0));
    let first = seen(&old);
    paint(&mut old, &airlight::painterly::PaintingFrame { surface: &other, ..exhibit.frame(SIZE, 0) });
    let changed = seen(&old);
    paint(&mut old, &exhibit.frame(SIZE, 0));
    assert!(seen(&old) == first, "back to what was");
    drop(old);
    exhibit.surface = other;
    let mut new = exhibit.painting(settings(head_style(), SIZE));
    paint(&mut new, &exhibit.frame(SIZE, 0));
    assert!(seen(&new) == changed, "as if it had always been so");
    assert!(changed != first);

    // And as if nothing was ever passed over.
    let pass = IsoRaycast::new(gpu(), shaders(), PLAIN).unwrap();
    let bound = pass.bind(gpu(), &exhibit.uploaded, &exhibit.transfer, SIZE).unwrap();
    let still = IsoFrame::still(exhibit.frame(SIZE, 0).camera, exhibit.posed(0));
    pass.set(gpu(), &bound, &exhibit.uploaded, &still, &exhibit.surface, &exhibit.lighting).unwrap();
    let mut encoder = gpu().encoder();
    pass.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let IsoTargets { color, surface, flow, distance, .. } = &bound.targets;
    let plain = [color, surface, flow, distance].map(|texture| texture.read_words(gpu()).unwrap());
    assert!(changed == plain);
}

/// A colour of a texture of colours, straight between texels, clamped at its edge.
fn bilinear([width, height]: [usize; 2], texels: &[f32], [u, v]: [f64; 2]) -> [f64; 4] {
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let clamped = |at: f64, side: usize| at.clamp(0.0, (side - 1) as f64) as usize;
    let (left, top) = (x.floor(), y.floor());
    let mut sum = [0.0; 4];
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let weight = (1.0 - (x - left - dx).abs()) * (1.0 - (y - top - dy).abs());
        let place = clamped(top + dy, height) * width + clamped(left + dx, width);
        for (channel, sum) in sum.iter_mut().enumerate() {
            *sum += weight * f64::from(texels[4 * place + channel]);
        }
    }
    sum
}

#[test]
fn the_ground_is_a_mix_of_canvas_and_surface() {
    let exhibit = head_exhibit();
    for (size, underpainting) in [(SIZE, 1.0_f32), ([90, 50], 0.7), ([90, 50], 0.0)] {
        let mut settings = settings(head_style(), size);
        settings.canvas.underpainting = underpainting;
        let canvas = settings.canvas;
        let mut painting = exhibit.painting(settings);
        let mut frame = exhibit.frame(size, 0);
        frame.generation = false;
        paint(&mut painting, &frame);
        let color = painting.targets().color.read(gpu()).unwrap();
        let found = painting.picture.read(gpu()).unwrap();
        let (mut worst, mut covered) = (0.0_f64, 0);
        for (index, texel) in found.chunks_exact(4).enumerate() {
            let (x, y) = (index % SIZE[0] as usize, index / SIZE[0] as usize);
            let at = [(x as f64 + 0.5) / f64::from(SIZE[0]), (y as f64 + 0.5) / f64::from(SIZE[1])];
            let seen = bilinear(size.map(|side| side as usize), &color, at);
            covered += usize::from(seen[3] > 0.5);
            for (channel, ground) in canvas.color.to_array().map(f64::from).into_iter().enumerate() {
                let over = seen[channel] + (1.0 - seen[3]) * ground;
                let expected = ground + f64::from(underpainting) * (over - ground);
                worst = worst.max((f64::from(texel[channel]) - expected).abs());
            }
            assert_eq!(texel[3], 1.0);
        }
        println!("rays {size:?}, {underpainting}: {worst:.5} off, {covered} covered");
        // Filters weigh by 8 bits, and what is written are half floats.
        assert!(covered > 3000 && worst < 6e-3, "{worst}");
    }
}

#[test]
fn wild_volumes_leave_no_nan() {
    let mut random = Random(3);
    let mut volume = sphere_field([32; 3], 0.6);
    for value in volume.values.iter_mut() {
        if random.below(20) == 0 {
            *value = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e38, -1e38][random.below(5)];
        }
    }
    let space = |matrix: Mat4| Volume { world_from_unit: matrix, ..volume.clone() };
    let own = volume.world_from_unit;
    let view = Exhibit::new(volume.clone(), Some([0.0, 1.0]), &RAMP).view;
    for (what, volume) in [
        ("values", volume.clone()),
        ("a flat box", space(own * Mat4::from_scale(Vec3::new(1.0, 1e-4, 1.0)))),
        ("a mirrored box", space(own * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)))),
    ] {
        let exhibit = Exhibit { view, ..Exhibit::new(volume, Some([0.0, 1.0]), &RAMP) };
        let mut painting = exhibit.painting(settings(style([0.3, 0.6, 20.0]), SIZE));
        for number in 0..4 {
            let mut frame = exhibit.frame(SIZE, number);
            frame.seconds = [1.0, 0.0, f32::NAN, 1e30][number as usize];
            paint(&mut painting, &frame);
        }
        let targets = painting.targets();
        for texture in [&targets.color, &targets.surface, &targets.flow, &targets.distance, &painting.picture]
        {
            assert!(texture.read(gpu()).unwrap().iter().all(|value| value.is_finite()), "{what}");
        }
        assert!(painting.strokes().density.read(gpu()).unwrap().iter().all(|value| value.is_finite()));
        let strokes = painting.strokes().read(gpu()).unwrap();
        println!("{what}: {} strokes", strokes.len());
        assert!(strokes.iter().all(|s| s.point.is_finite() && s.color.is_finite() && s.opacity.is_finite()));
        assert!(what != "values" || strokes.len() > 100);
    }
}

#[test]
fn a_full_buffer_goes_on_and_counts_what_it_drops() {
    let exhibit = head_exhibit();
    let mut settings = settings(head_style(), SIZE);
    settings.strokes.capacity = 150;
    let mut painting = exhibit.painting(settings);
    let mut in_all = 0;
    for number in 0..6 {
        paint(&mut painting, &exhibit.frame(SIZE, number));
        let counts = painting.strokes().read_counts(gpu()).unwrap();
        in_all += counts.dropped;
        assert_eq!((counts.instances, counts.dropped_in_all, counts.frames), (150, in_all, number + 1));
        assert!(counts.dropped > 0);
        let mut hashes: Vec<u32> =
            painting.strokes().read(gpu()).unwrap().iter().map(|stroke| stroke.hash).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 150, "each once");
    }
}
