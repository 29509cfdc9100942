// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is in the way of a place on a floor, by every sampler, against integrals over the hemisphere in f64: a bar that floats, the
//! fall-off, the bias, what lies beside the picture and behind surfaces.

use crate::gpu::gpu;
use crate::seen::{SeenImages, cameras, from_above, seen, sharp};
use airlight::Texture;
use airlight::ambient::{OcclusionSettings, Sampling, SurfaceImages};
use airlight_tests::linear::Vec3;
use std::f64::consts::TAU;
use wgpu::TextureFormat::Rgba32Float;

const ALL: [Sampling; 4] = [Sampling::Hemisphere, Sampling::Disc, Sampling::Horizon, Sampling::Bitmask];
const UP: Vec3 = Vec3::new(0.0, 1.0, 0.0);
/// Sides of the square picture.
const PIXELS: u32 = 64;
/// Half of what it shows, metres.
const HALF: f64 = 1.5;
const PIXEL: f64 = 2.0 * HALF / PIXELS as f64;
/// How high the bar floats over the floor y = 0, metres.
const HIGH: f64 = 0.5;
/// Where it begins and ends beside the middle of the picture, towards -x, metres: between pixels.
const BAR: [f64; 2] = [9.0 * PIXEL, 19.0 * PIXEL];

/// A long bar along z over a floor, from above. `tilt`: how far the floor goes down below the bar, radians.
fn bar(tilt: f64) -> SeenImages {
    from_above([PIXELS; 2], HALF, true, &|x, _| {
        let over = (-BAR[1]..-BAR[0]).contains(&x);
        Some(if over { (HIGH, UP) } else { (x * tilt.tan(), Vec3::new(-tilt.sin(), tilt.cos(), 0.0)) })
    })
}

/// How much an occluder at a distance counts: (1 - (d/r)^2)^2.
fn fall_off(metres: f64, radius: f64) -> f64 {
    (1.0 - (metres / radius).powi(2)).max(0.0).powi(2)
}

/// Where a direction passes the bar, metres along the floor from a place `aside` of the middle: where it comes under it and leaves it.
fn under(direction: Vec3, aside: f64) -> Option<[f64; 2]> {
    let slant = -direction.x / direction.x.hypot(direction.z);
    (slant > 1e-9).then(|| BAR.map(|edge| (edge + aside) / slant))
}

/// Visibility of directions about the place `aside` of the middle, metres; without one an outlier.
type Visibility<'a> = &'a dyn Fn(Vec3, f64) -> Option<f64>;

/// Mean direction and openness of eight pixels in the middle of the picture: Listing 3.1 with midpoints instead of samples.
fn expected(tilt: f64, visibility: Visibility<'_>) -> (Vec3, f64) {
    let (mut sum, mut total) = (Vec3::default(), 0.0);
    for column in 0..8 {
        let aside = (f64::from(column) - 3.5) * PIXEL;
        let (mut direction_sum, mut visible, mut open, mut known) = (Vec3::default(), 0.0, 0.0, 0.0);
        for (i, j) in (0..96).flat_map(|i| (0..192).map(move |j| (i, j))) {
            let (height, turn) = ((f64::from(i) + 0.5) / 96.0, TAU * (f64::from(j) + 0.5) / 192.0);
            let across = (1.0 - height * height).sqrt();
            let (aslant, (sine, cosine)) = (across * turn.cos(), tilt.sin_cos());
            let direction = Vec3::new(
                aslant * cosine - height * sine,
                aslant * sine + height * cosine,
                across * turn.sin(),
            );
            let free = visibility(direction, aside);
            direction_sum = direction_sum + direction * free.unwrap_or(1.0);
            visible += free.unwrap_or(1.0);
            open += free.unwrap_or(0.0);
            known += f64::from(u8::from(free.is_some()));
        }
        sum = sum + direction_sum * (open / known / visible);
        total += open / known;
    }
    (sum * (1.0 / total), total / 8.0)
}

/// Finds the same on the GPU over a level floor, and holds it.
fn hold(what: &str, sampling: Sampling, settings: &OcclusionSettings, visibility: Visibility<'_>) -> f64 {
    hold_tilted(0.0, what, sampling, settings, visibility)
}

/// The same over a floor that is tilted.
fn hold_tilted(
    tilt: f64,
    what: &str,
    sampling: Sampling,
    settings: &OcclusionSettings,
    visibility: Visibility<'_>,
) -> f64 {
    let (mean, open) = bar(tilt).bent_at(sharp(sampling), settings, Vec3::default());
    let wanted = expected(tilt, visibility);
    println!("{what}: open {open:.3} of {:.3}, mean {mean:.3?} of {:.3?}", wanted.1, wanted.0);
    assert!((open - wanted.1).abs() < 0.015, "{what}: {open} instead of {}", wanted.1);
    assert!((mean - wanted.0).length() < 0.015, "{what}: {mean:?} instead of {:?}", wanted.0);
    open
}

fn settings(thickness: f64) -> OcclusionSettings {
    let radius = 1.5;
    OcclusionSettings {
        thickness: thickness as f32,
        samples: 16,
        steps: 32,
        ..OcclusionSettings::new(radius)
    }
}

#[test]
fn a_marched_direction_is_blocked_within_the_bar_and_unknown_below_it() {
    let open = [0.1, 0.2, 0.6].map(|thickness| {
        let visibility = |direction: Vec3, aside: f64| {
            let Some([first, last]) = under(direction, aside) else { return Some(1.0) };
            let across = direction.x.hypot(direction.z);
            let (last, slope) = (last.min(1.5 * across), direction.y / across);
            let lower = HIGH - thickness;
            if first >= last || slope * first >= HIGH {
                Some(1.0)
            } else if slope * last <= lower {
                None
            } else {
                Some(1.0 - fall_off(first.max(lower / slope).hypot(HIGH), 1.5))
            }
        };
        hold(&format!("{thickness} m thick"), Sampling::Hemisphere, &settings(thickness), &visibility)
    });
    assert!(open[0] > open[2] + 0.04, "{open:?}");
}

#[test]
fn a_plate_further_up_than_its_thickness_leaves_the_normal_and_says_nothing() {
    // One step: all directions of a pixel reach a quarter of the radius, below the plate's underside.
    let reach = 0.45;
    let one_step = |thickness: f64| OcclusionSettings {
        thickness: thickness as f32,
        samples: 256,
        steps: 1,
        side: 1,
        ..OcclusionSettings::new(4.0 * reach as f32)
    };
    let visibility = |thickness: f64| {
        move |direction: Vec3, aside: f64| {
            let along = reach * direction.x.hypot(direction.z);
            let below = under(direction, aside).is_some_and(|[first, last]| along > first && along < last);
            let blocked = fall_off(along.hypot(HIGH), 4.0 * reach);
            if !below {
                Some(1.0)
            } else if HIGH - reach * direction.y < thickness {
                Some(1.0 - blocked)
            } else {
                None
            }
        }
    };
    // The place from which the bar begins 0.2 m aside.
    let images = bar(0.0);
    let near = |thickness: f64| {
        let place = Vec3::new(0.2 - BAR[0], 0.0, 0.0);
        let all = images.bent(sharp(Sampling::Hemisphere), &one_step(thickness));
        let row = all.chunks_exact(PIXELS as usize).nth(30).unwrap();
        row[((place.x + HALF) / PIXEL) as usize]
    };
    let (mean, open) = near(0.04);
    println!("below: {mean:?} {open}");
    assert!(open == 1.0 && (mean - UP * 0.5).length() < 0.01, "{mean:?} {open}");
    let (mean, open) = near(0.6);
    println!("within: {mean:?} {open}");
    assert!(open < 0.8 && mean.normalised().x > 0.1, "{mean:?} {open}");
    hold("one step within", Sampling::Hemisphere, &one_step(0.6), &visibility(0.6));
    hold("one step, half below", Sampling::Hemisphere, &one_step(0.4), &visibility(0.4));
}

#[test]
fn points_of_a_disc_are_blocked_by_all_that_rises_there() {
    let visibility = |direction: Vec3, aside: f64| {
        let along = 1.5 * direction.x.hypot(direction.z);
        let met = under(direction, aside).is_some_and(|[first, last]| along > first && along < last);
        Some(if met { 1.0 - fall_off(along.hypot(HIGH), 1.5) } else { 1.0 })
    };
    hold("disc", Sampling::Disc, &settings(0.1), &visibility);
}

#[test]
fn a_horizon_rises_as_the_fall_off_of_what_is_seen_allows() {
    let visibility = |direction: Vec3, aside: f64| {
        let horizon = under(direction, aside).map_or(0.0, |[first, _]| {
            let away = (first + 0.5 * PIXEL).hypot(HIGH);
            HIGH / away * fall_off(away, 1.5)
        });
        Some(f64::from(u8::from(direction.y > horizon)))
    };
    let settings = OcclusionSettings { samples: 8, steps: 64, ..settings(0.1) };
    hold("horizon", Sampling::Horizon, &settings, &visibility);
}

/// Blocked between the bar's front edge and its far edge, `thickness` below its top, as far as it is in the picture. `tilt`: of the floor.
fn behind_bits(radius: f64, thickness: f64, tilt: f64) -> impl Fn(Vec3, f64) -> Option<f64> {
    move |direction, aside| {
        let Some([first, last]) = under(direction, aside) else { return Some(1.0) };
        let shown = HALF * direction.x.hypot(direction.z) / direction.z.abs().max(1e-9);
        let (first, last) = (first + 0.5 * PIXEL, (last - 0.5 * PIXEL).min(shown));
        let high = HIGH - aside * tilt.tan();
        let angle = direction.x.hypot(direction.z).atan2(direction.y);
        // An occluder counts for as many pixels of the pattern as its fall-off says.
        let parts = (0..32).map(|part| {
            let limit = radius * (1.0 - ((f64::from(part) + 0.5) / 32.0).sqrt()).sqrt();
            let last = last.min((limit * limit - high * high).max(0.0).sqrt());
            let hit = first < last && angle > first.atan2(high) && angle < last.atan2(high - thickness);
            f64::from(u8::from(!hit)) / 32.0
        });
        Some(parts.sum())
    }
}

#[test]
fn light_passes_under_a_thin_bar_and_not_under_a_thick_one() {
    let bits = |thickness: f64| OcclusionSettings { samples: 8, steps: 64, ..settings(thickness) };
    let open = [0.1, 0.3, 0.6].map(|thickness| {
        let what = format!("bits, {thickness} m thick");
        hold(&what, Sampling::Bitmask, &bits(thickness), &behind_bits(1.5, thickness, 0.0))
    });
    assert!(open[0] > open[1] + 0.02 && open[1] > open[2] + 0.02, "{open:?}");
    // Thickness is along the view, whichever way the floor faces.
    let tilt = 0.6;
    hold_tilted(tilt, "tilted floor", Sampling::Bitmask, &bits(0.3), &behind_bits(1.5, 0.3, tilt));
    // One slice a pixel, for every pixel of the pattern another.
    let one = OcclusionSettings { samples: 1, steps: 192, radius: 9.0, ..bits(0.6) };
    hold("one slice", Sampling::Bitmask, &one, &behind_bits(9.0, 0.6, 0.0));
}

#[test]
fn steps_are_taken_at_every_part_of_them() {
    // One step, at the square of a part that differs between pixels: only some of them meet the bar.
    let (radius, thickness) = (2.4, 0.6);
    let one = OcclusionSettings { radius: radius as f32, samples: 12, steps: 1, ..settings(thickness) };
    for sampling in [Sampling::Hemisphere, Sampling::Horizon, Sampling::Bitmask] {
        let visibility = |direction: Vec3, aside: f64| {
            let Some([first, last]) = under(direction, aside) else { return Some(1.0) };
            let across = direction.x.hypot(direction.z);
            let blocked = (0..64).map(|part| {
                let reach = radius * ((f64::from(part) + 0.5) / 64.0).powi(2);
                let along = if sampling == Sampling::Hemisphere { reach * across } else { reach };
                let weight = fall_off(along.hypot(HIGH), radius);
                if along < first || along > last || along * direction.z.abs() > HALF * across {
                    return 0.0;
                }
                let angle = across.atan2(direction.y);
                match sampling {
                    Sampling::Horizon => f64::from(u8::from(direction.y < weight * HIGH / along.hypot(HIGH))),
                    // Below the bar's top, or from its front edge down.
                    Sampling::Hemisphere if reach * direction.y < HIGH => weight,
                    Sampling::Bitmask if angle > along.atan2(HIGH) => weight,
                    _ => 0.0,
                }
            });
            Some(1.0 - blocked.sum::<f64>() / 64.0)
        };
        hold(&format!("{sampling:?}, one step"), sampling, &one, &visibility);
    }
}

#[test]
fn what_rises_by_less_than_the_bias_hides_nothing() {
    // A valley whose sides rise by 3 degrees each: the sine of one's elevation over the other is at most 0.105.
    let slope = 3.0_f64.to_radians();
    let valley = |x: f64, _: f64| {
        Some((x.abs() * slope.tan(), Vec3::new(-x.signum() * slope.sin(), slope.cos(), 0.0)))
    };
    let images = from_above([32, 32], 1.0, true, &valley);
    for sampling in ALL {
        let least = |bias: f32| {
            let settings =
                OcclusionSettings { bias, thickness: 4.0, steps: 8, ..OcclusionSettings::new(3.0) };
            let all = images.bent(sharp(sampling), &settings);
            all.into_iter().map(|(_, open)| open).fold(1.0, f64::min)
        };
        let [above, below] = [least(0.12), least(0.03)];
        assert!(above == 1.0 && below < 0.97, "{sampling:?}: {above} {below}");
    }
}

#[test]
fn what_is_not_in_the_picture_is_free() {
    // Were the first pixel taken for what is outside, its column would hide most of the last pixels' hemispheres.
    let column = |x: f64, z: f64| Some((if x < -0.875 && z < -0.875 { 1.5 } else { 0.0 }, UP));
    let images = from_above([16, 16], 1.0, true, &column);
    for sampling in ALL {
        let settings = OcclusionSettings { thickness: 4.0, steps: 8, ..OcclusionSettings::new(6.0) };
        let all = images.bent(sharp(sampling), &settings);
        let last: f64 = all.chunks_exact(16).map(|row| row[15].1 / 16.0).sum();
        assert!(last > 0.97, "{sampling:?}: {last}");
        let least = all.iter().map(|(_, open)| *open).fold(1.0, f64::min);
        assert!(least < 0.92, "{sampling:?}: the column hides nothing");
    }
}

#[test]
fn pixels_without_a_surface_are_open_and_hide_nothing() {
    let surface = |origin: Vec3, direction: Vec3| {
        let way = (-2.0 - origin.y) / direction.y;
        ((origin + direction * way).x > 0.0).then_some((way, UP))
    };
    for (name, camera) in cameras(Vec3::new(0.0, 1.0, 0.1), Vec3::new(0.0, -2.0, 0.0), 1.0) {
        let images = seen(camera, [24, 24], &surface);
        assert!(images.surfaces.iter().filter(|seen| seen.is_some()).count().abs_diff(288) < 60);
        for sampling in ALL {
            let settings = OcclusionSettings { thickness: 8.0, steps: 8, ..OcclusionSettings::new(4.0) };
            for (seen, (mean, open)) in images.surfaces.iter().zip(images.bent(sharp(sampling), &settings)) {
                assert_eq!(open, 1.0, "{name} {sampling:?}");
                assert!(seen.is_some() || mean == Vec3::default(), "{name} {sampling:?}: {mean:?}");
                assert!(seen.is_none() || mean.dot(UP) > 0.3, "{name} {sampling:?}: {mean:?}");
            }
        }
    }
}

#[test]
fn every_pixel_has_its_own_surface() {
    // Every second pixel has one, at the border as well.
    let size = [9, 7];
    let odd = |x: f64, z: f64| (((x + 4.5).floor() + (z + 3.5).floor()) as i32) % 2 == 1;
    let images = from_above(size, 3.5, true, &|x, z| odd(x, z).then_some((0.0, UP)));
    for sampling in ALL {
        let all = images.bent(sharp(sampling), &settings(0.1));
        for (pixel, (mean, _)) in all.into_iter().enumerate() {
            assert_eq!(mean == Vec3::default(), images.surfaces[pixel].is_none(), "{sampling:?} {pixel}");
        }
    }
}

#[test]
fn normals_count_by_direction_and_are_towards_the_viewer_where_there_are_none() {
    let images = bar(0.0);
    let settings = OcclusionSettings { samples: 4, ..settings(0.3) };
    for sampling in ALL {
        let right = images.bent(sharp(sampling), &settings);
        for (what, normal) in [("none", [0.0; 3]), ("long", [0.0, 7.0, 0.0]), ("NaN", [f32::NAN; 3])] {
            let normals = Texture::storage(gpu(), [PIXELS; 2], Rgba32Float);
            let texel = [normal[0], normal[1], normal[2], 1.0];
            normals.write(gpu(), &texel.repeat((PIXELS * PIXELS) as usize)).unwrap();
            let seen = SurfaceImages { normals: &normals, ..images.images() };
            let found = images.bent_of(seen, sharp(sampling), &settings);
            let off = right.iter().zip(&found).map(|(a, b)| (a.0 - b.0).length() + (a.1 - b.1).abs());
            let off = off.sum::<f64>() / right.len() as f64;
            assert!(off < 1e-3, "{sampling:?} {what}: {off}");
        }
    }
}

#[test]
fn patterns_repeat_over_their_square_and_frames_change_them() {
    let images = bar(0.0);
    // Beside the bar all rows see the same, but by other directions.
    let rows = |side: u32, frame: u32, sampling| {
        let settings = OcclusionSettings { side, frame, samples: 2, ..settings(0.3) };
        let settings = OcclusionSettings { radius: 1.2, ..settings };
        let all = images.bent(sharp(sampling), &settings);
        let columns = 24..35;
        let row = |row: usize| all[row * PIXELS as usize..][columns.clone()].to_vec();
        [28, 29, 32].map(row)
    };
    let alike = |a: &[(Vec3, f64)], b: &[(Vec3, f64)]| {
        let pairs = a.iter().zip(b);
        pairs.filter(|(a, b)| (a.0 - b.0).length() < 2e-3 && (a.1 - b.1).abs() < 2e-3).count()
    };
    for sampling in ALL {
        let [first, next, fourth] = rows(4, 0, sampling);
        assert!(alike(&first, &fourth) >= 10, "{sampling:?}: the pattern does not repeat");
        assert!(alike(&first, &next) <= 7, "{sampling:?}: the pattern is too small");
        let [first, next, fourth] = rows(1, 0, sampling);
        assert!(alike(&first, &next) >= 10 && alike(&first, &fourth) >= 10, "{sampling:?}: too large");
        let [moved, ..] = rows(1, 1, sampling);
        assert!(alike(&first, &moved) <= 4, "{sampling:?}: the frame changes nothing");
    }
}
