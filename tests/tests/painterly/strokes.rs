// SPDX-License-Identifier: MIT OR Apache-2.0
//! Strokes on a ball that turns: they follow it, stay while it shows them, hide where it does not, and repeat bit for bit.

use crate::gpu::gpu;
use crate::turning::{Show, Turning, even_brush, paint, reference, style};
use airlight::Texture;
use airlight::painterly::{Brushes, Orientation, PainterlyStyle, Stroke, StrokeState};
use airlight_tests::linear::Vec3;
use airlight_tests::reference::camera::{Camera, OrthographicView};
use airlight_tests::reference::painterly::strokes::half_turn;
use std::collections::HashMap;

const SIZE: [u32; 2] = [400, 250];

/// Strokes that had some time to settle.
fn settled(turning: Turning, style: PainterlyStyle, frames: u32) -> Show {
    let mut show = Show::new(turning, style, even_brush(1.0), |settings| settings);
    for frame in 0..frames {
        show.frame(frame, |_| ());
    }
    show
}

fn orthographic(size: [u32; 2]) -> Turning {
    let view = OrthographicView {
        eye: Vec3::new(1.0, 0.9, 6.0),
        target: Vec3::new(0.0, 0.0, 0.0),
        up: Vec3::new(0.0, 1.0, 0.0),
        half_height: 1.15,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        depth: 20.0,
        reversed: true,
    };
    Turning { camera: Camera::orthographic(&view), ..Turning::ball(size) }
}

#[test]
fn strokes_keep_to_their_points_and_stay_while_these_are_seen() {
    for turning in [Turning::ball(SIZE), orthographic(SIZE)] {
        let mut show = settled(turning, style(), 15);
        let before: Vec<Stroke> =
            show.read().into_iter().filter(|stroke| stroke.state == StrokeState::Stays).collect();
        assert!(before.len() > 3000, "{}", before.len());
        let mut drift = 0.0_f64;
        let mut moved = 0.0_f64;
        let mut places: HashMap<u32, [f64; 2]> = HashMap::new();
        for frame in 15..25 {
            show.frame(frame, |step| (step.generation, step.deletion) = (false, false));
            let posed = show.turning.posed(frame);
            for stroke in show.read().iter().filter(|stroke| stroke.state == StrokeState::Stays) {
                let point = reference(stroke.point);
                // On the ball.
                assert!(((point - Vec3::new(0.5, 0.5, 0.5)).length() - 0.45).abs() < 2e-5);
                let [x, y] = posed.place(&show.turning.camera, point).unwrap();
                let at = stroke.position.to_array().map(f64::from);
                let off = [(at[0] - x) * f64::from(SIZE[0]), (at[1] - y) * f64::from(SIZE[1])];
                drift = drift.max(off[0].hypot(off[1]));
                let now = [x * f64::from(SIZE[0]), y * f64::from(SIZE[1])];
                if let Some(old) = places.insert(stroke.hash, now) {
                    moved = moved.max((now[0] - old[0]).hypot(now[1] - old[1]));
                }
            }
        }
        println!("drift {drift:.4} pixels, at up to {moved:.2} pixels a frame");
        assert!(drift < 0.02 && moved > 1.0, "{drift} {moved}");

        let posed = show.turning.posed(24);
        let after: HashMap<u32, StrokeState> =
            show.read().into_iter().map(|stroke| (stroke.hash, stroke.state)).collect();
        let (mut seen, mut survive, mut hidden, mut wrong) = (0, 0, 0, 0);
        for stroke in &before {
            let facing = posed.facing(&show.turning.camera, reference(stroke.point));
            let state = after.get(&stroke.hash);
            if facing > 0.0 {
                seen += 1;
                survive += usize::from(state == Some(&StrokeState::Stays));
            } else if facing < -0.1 {
                hidden += 1;
                wrong += usize::from(matches!(state, Some(StrokeState::Stays | StrokeState::Leaves)));
            }
        }
        println!("{survive} of {seen} survive; {hidden} are hidden");
        assert!(f64::from(survive as u32) >= 0.97 * f64::from(seen), "{survive} of {seen}");
        assert!(hidden > 10 && wrong == 0, "{wrong} of {hidden} hidden strokes stay");
    }
}

#[test]
fn what_comes_before_the_surface_hides_its_strokes() {
    let mut show = settled(Turning::ball(SIZE), style(), 6);
    let before = show.read();
    // Something in front of the left half of the picture, of the same layers.
    let mut sights = show.turning.sights(5);
    for (index, sight) in sights.iter_mut().enumerate() {
        if let Some(sight) = sight.as_mut().filter(|_| index % 400 < 200) {
            sight.distance -= 0.5;
        }
    }
    show.targets.write(&sights, show.turning.magnitude);
    show.again(5, |step| (step.generation, step.deletion) = (false, false));
    let after: HashMap<u32, StrokeState> = show.read().into_iter().map(|s| (s.hash, s.state)).collect();
    let (mut left, mut right) = (0, 0);
    for stroke in before.iter().filter(|stroke| stroke.state == StrokeState::Stays) {
        let state = after.get(&stroke.hash).copied().unwrap_or(StrokeState::Gone);
        let column = stroke.position.x * 400.0;
        if column < 199.0 {
            left += 1;
            assert!(matches!(state, StrokeState::Hidden | StrokeState::Gone), "{column}: {state:?}");
        } else if column > 201.0 {
            right += 1;
            assert_eq!(state, StrokeState::Stays, "{column}");
        }
    }
    assert!(left > 500 && right > 500);
}

/// The words of all buffers that count, and a picture.
fn everything(show: &Show) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let picture = Texture::target(gpu(), SIZE, wgpu::TextureFormat::Rgba16Float);
    let mut encoder = gpu().encoder();
    show.strokes.draw(gpu(), &mut encoder, &picture).unwrap();
    gpu().submit(encoder).unwrap();
    let strokes = show.read().into_iter().flat_map(|stroke| {
        let numbers = [stroke.point.x, stroke.point.y, stroke.point.z, stroke.opacity, stroke.orientation];
        let colors = [stroke.color.x, stroke.color.y, stroke.color.z, stroke.position.x, stroke.position.y];
        let bits = numbers.into_iter().chain(colors).map(f32::to_bits);
        bits.chain([stroke.hash, stroke.layer, stroke.state as u32]).collect::<Vec<_>>()
    });
    (strokes.collect(), show.strokes.read_order(gpu()).unwrap(), picture.read_words(gpu()).unwrap())
}

#[test]
fn two_runs_give_the_same_bits_and_another_seed_does_not() {
    let run = |seed| {
        let brushes = Brushes::procedural(gpu()).unwrap();
        let mut show = Show::new(Turning::ball(SIZE), style(), brushes, |mut settings| {
            settings.seed = seed;
            settings
        });
        for frame in 0..12 {
            show.frame(frame, |_| ());
        }
        everything(&show)
    };
    let (first, again, other) = (run(1), run(1), run(2));
    assert!(first.0.len() > 13 * 3000);
    assert!(first.0 == again.0 && first.1 == again.1 && first.2 == again.2);
    assert!(first.0 != other.0 && first.2 != other.2);
}

#[test]
fn coarse_strokes_come_first_and_old_ones_before_new_ones() {
    let mut show = settled(Turning::ball(SIZE), style(), 5);
    let old = show.read();
    let counts = show.frame(5, |_| ());
    let strokes = show.read();
    let order = show.strokes.read_order(gpu()).unwrap();
    assert_eq!(order.len(), strokes.len());
    let keys: Vec<(u32, u32)> = order.iter().map(|index| (strokes[*index as usize].layer, *index)).collect();
    assert!(keys.is_sorted_by(|a, b| a < b));
    let layers = [0, 1, 2].map(|layer| strokes.iter().filter(|s| s.layer == layer).count() as u32);
    assert_eq!(counts.layers(), layers);
    assert_eq!((counts.draws, counts.first_vertex, counts.first_instance), (1, 0, 0));
    assert_eq!((counts.instances as usize, counts.vertices), (strokes.len(), 6 * counts.instances));
    // Survivors in their order, then those that were born.
    let survivors = strokes.len() - counts.born as usize;
    assert!(counts.born > 10 && survivors > 1000);
    let places: HashMap<u32, usize> = old.iter().enumerate().map(|(k, s)| (s.hash, k)).collect();
    let kept: Vec<_> = strokes[..survivors].iter().map(|stroke| places[&stroke.hash]).collect();
    assert!(kept.is_sorted());
    assert!(strokes[survivors..].iter().all(|stroke| !places.contains_key(&stroke.hash)));
}

#[test]
fn strokes_take_color_and_orientation_from_their_surface() {
    let mut show = settled(Turning::ball(SIZE), style(), 1);
    let posed = show.turning.posed(0);
    let camera = show.turning.camera;
    let along = |stroke: &Stroke| {
        let point = reference(stroke.point);
        let outwards = point - Vec3::new(0.5, 0.5, 0.5);
        let pixel = |p: Vec3| {
            let [x, y] = posed.place(&camera, p).unwrap();
            [x * f64::from(SIZE[0]), y * f64::from(SIZE[1])]
        };
        let (from, to) = (pixel(point), pixel(point + outwards * 1e-4));
        (to[1] - from[1]).atan2(to[0] - from[0]) + std::f64::consts::FRAC_PI_2
    };
    let born = show.read();
    for stroke in &born {
        let painted = paint(reference(stroke.point));
        let off = [stroke.color.x, stroke.color.y, stroke.color.z];
        let off = off.iter().zip(painted).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3, "{off}");
        assert_eq!(stroke.state, StrokeState::Stays);
        assert!((stroke.opacity * 255.0 - 1.0).abs() < 1e-3);
        let facing = posed.facing(&camera, reference(stroke.point));
        if facing < 0.95 {
            // Normals are half floats.
            let off = half_turn(f64::from(stroke.orientation) - along(stroke)).abs();
            assert!(off < 0.02, "{off} at {facing}");
        }
    }
    // Curvature is taken where it is wanted, and there is any.
    let style = PainterlyStyle { orientation: Orientation::Curvature, angle: 0.0, ..style() };
    assert!(show.strokes.set_style(style).is_err());
    let mut curved = Show::new(Turning::ball(SIZE), style, even_brush(1.0), |settings| settings);
    curved.targets.write(&curved.turning.sights(0), curved.turning.magnitude);
    let (sine, cosine) = (2.0_f32 * 0.6).sin_cos();
    let values: Vec<f32> = (0..SIZE[1])
        .flat_map(|y| (0..SIZE[0]).map(move |_| y))
        .flat_map(|y| if y < 125 { [0.0, 0.0, cosine, sine] } else { [0.0; 4] })
        .collect();
    curved.targets.curvature.write(gpu(), &values).unwrap();
    curved.again(0, |_| ());
    for stroke in curved.read() {
        let expected = if stroke.position.y < 0.5 { 0.6 } else { along(&stroke) };
        if posed.facing(&camera, reference(stroke.point)) < 0.95 {
            assert!(half_turn(f64::from(stroke.orientation) - expected).abs() < 0.02);
        }
    }
}
