// SPDX-License-Identifier: MIT OR Apache-2.0
//! Extinction transmittance maps of volumes: closed forms of slabs and boxes, ends, the monotone window, places outside,
//! bad input.

use crate::gpu::{Random, gpu, shaders};
use crate::probing::hold;
use crate::rays::{Medium, RANGE, Rays, ask, light_along_z, medium};
use airlight::core::{Light, Reading, VolumeTexture};
use airlight::data::{Particle, Particles, Volume, cloud, plume};
use airlight::transmittance::{
    Form, MapSettings, ParticleBuffer, Precision, SplatFixed, TransmittanceError, TransmittanceMap, Voxels,
};
use airlight_tests::parallel;
use airlight_tests::reference::transmittance::{Basis, Profile, Series};
use glam::{Mat4, Vec3};
use std::f64::consts::{PI, SQRT_2};

const LENGTH: usize = 64;

/// A box of extinction from voxel `from` to voxel `to`, of optical depth `total`.
#[derive(Clone, Copy)]
struct Slab {
    from: usize,
    to: usize,
    total: f64,
}

impl Slab {
    fn ray(&self) -> Vec<f32> {
        let extinction = self.total * LENGTH as f64 / ((self.to - self.from) as f64 * RANGE);
        (0..LENGTH).map(|i| if (self.from..self.to).contains(&i) { extinction as f32 } else { 0.0 }).collect()
    }

    /// Eq. 3 in closed form, f64, with `count` coefficients in units of the range; and by how much it may be off where
    /// each coefficient is off by `rounding` of itself.
    fn series(&self, count: usize, depth: f64, rounding: f64) -> (f64, f64) {
        let (a, b) = (self.from as f64 / LENGTH as f64, self.to as f64 / LENGTH as f64);
        let mut sum = self.total * depth;
        let mut off = rounding * sum;
        for j in 1..count {
            let order = j as f64 * PI;
            let coefficient =
                self.total * SQRT_2 * ((order * b).sin() - (order * a).sin()) / (order * (b - a));
            let term = coefficient * SQRT_2 * (order * depth).sin() / order;
            sum += term;
            off += rounding * term.abs();
        }
        ((-sum).exp().clamp(0.0, 1.0), (off - sum).exp().min(1.0) * off)
    }
}

fn slabs() -> Vec<Slab> {
    let spans = [(0, 64), (0, 1), (63, 64), (20, 40), (5, 8), (31, 33), (0, 32), (12, 60)];
    let totals = [0.01, 0.5, 2.0, 4.0];
    spans.iter().flat_map(|(from, to)| totals.map(|total| Slab { from: *from, to: *to, total })).collect()
}

fn depths() -> Vec<f64> {
    (0..=64).map(|i| f64::from(i) / 64.0).chain([1e-4, 0.333, 0.9999]).collect()
}

#[test]
fn slabs_and_boxes_are_their_truncated_series_in_closed_form() {
    let slabs = slabs();
    let rays = Rays { extinctions: slabs.iter().map(Slab::ray).collect() };
    let depths = depths();
    for (precision, budget) in [(Precision::Single, 1e-4), (Precision::Half, 1e-3)] {
        for count in [4, 8, 16] {
            let settings = MapSettings { precision, ..rays.settings(Form::Extinction, count) };
            let found = rays.transmittances(settings, false, &depths);
            let mut worst = 0.0_f64;
            for (slab, found) in slabs.iter().zip(&found) {
                for (depth, found) in depths.iter().zip(found) {
                    assert!((0.0..=1.0).contains(found), "{found}");
                    let half_ulp = if precision == Precision::Half { 2.0_f64.powi(-11) } else { 0.0 };
                    let (expected, off) = slab.series(count as usize, *depth, half_ulp);
                    let error = (expected - f64::from(*found)).abs();
                    assert!(error <= off + 1e-5, "{error:e} of at most {off:e}");
                    // Half floats of an optical depth of 4 round by as much as 1.6e-3.
                    if precision == Precision::Single || slab.total <= 2.0 {
                        worst = worst.max(error);
                    }
                }
            }
            hold(&format!("{precision:?}, {count} coefficients"), worst, budget);
            // The far side, and the near one.
            for (slab, found) in slabs.iter().zip(&found) {
                let end = (-slab.total).exp();
                let error = (end - f64::from(found[64])).abs();
                assert!(error <= if precision == Precision::Half { 5e-4 } else { 2e-6 }, "{error:e}");
                assert!((f64::from(found[0]) - 1.0).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn an_even_slab_over_the_range_is_exact() {
    let slab = Slab { from: 0, to: LENGTH, total: 5.0 };
    let rays = Rays { extinctions: vec![slab.ray()] };
    for form in [Form::Extinction, Form::Bounded, Form::Opacity] {
        for count in [4, 16] {
            let found = rays.transmittances(rays.settings(form, count), false, &depths());
            let pairs = depths().into_iter().zip(&found[0]);
            let worst = pairs.map(|(x, t)| ((-5.0 * x).exp() - f64::from(*t)).abs()).fold(0.0, f64::max);
            hold(&format!("{form:?} {count}"), worst, 3e-6);
        }
    }
}

#[test]
fn the_monotone_window_never_rises_and_the_plain_series_does() {
    let mut random = Random(11);
    let kinds = [Medium::Smoke, Medium::Boxes];
    let extinctions =
        (0..32).map(|i| medium(kinds[i % 2], LENGTH, 8.0, &mut random)).collect::<Vec<Vec<f32>>>();
    let rays = Rays { extinctions };
    let depths: Vec<f64> = (0..=256).map(|i| f64::from(i) / 256.0).collect();
    let rise = |monotone: bool, count: u32| {
        let found = rays.transmittances(rays.settings(Form::Extinction, count), monotone, &depths);
        found.iter().flat_map(|ray| ray.windows(2)).map(|pair| pair[1] - pair[0]).fold(0.0_f32, f32::max)
    };
    for count in [4, 8, 16] {
        hold(&format!("rise with the window, {count}"), f64::from(rise(true, count)), 2e-6);
    }
    let plain = rise(false, 4);
    println!("greatest rise between neighbours without: {plain}");
    assert!(plain > 0.005, "the test sees no ringing");
}

#[test]
fn depth_may_run_either_way_and_places_outside_are_lit() {
    let rays = Rays { extinctions: vec![Slab { from: 8, to: 24, total: 1.5 }.ray(); 3] };
    let inside = [rays.point(1, 0.3), rays.point(2, 0.8)];
    let outside = [
        Vec3::new(0.0, 0.0, 4.5),
        Vec3::new(4.2, 0.0, -3.0),
        Vec3::new(0.0, -4.1, -3.0),
        Vec3::new(f32::NAN, 0.0, 0.0),
        Vec3::new(0.0, f32::INFINITY, 0.0),
    ];
    let behind = Vec3::new(0.1, 0.0, -30.0);
    for form in Form::ALL {
        let settings = rays.settings(form, 8);
        let of = |far_depth| {
            let map = rays.map(settings, &light_along_z(far_depth)).unwrap();
            let points = [&inside[..], &outside, &[behind]].concat();
            ask(&map, false, &points)
        };
        let (forward, reversed) = (of(1.0), of(0.0));
        for (a, b) in forward.iter().zip(&reversed) {
            assert!((a - b).abs() < 1e-4, "{form:?}: {forward:?}, {reversed:?}");
        }
        assert!(forward[2..7].iter().all(|t| *t == 1.0), "{form:?}: {forward:?}");
        let end = (-1.5_f32).exp();
        let budget = if matches!(form, Form::Function | Form::FunctionPeriodic) { 0.5 } else { 2e-3 };
        assert!((forward[7] - end).abs() < budget, "{form:?}: {} instead of {end}", forward[7]);
    }
}

#[test]
fn wild_values_leave_no_trace() {
    let clean = Slab { from: 10, to: 30, total: 1.0 }.ray();
    let mut wild = clean.clone();
    for (i, value) in [f32::NAN, f32::INFINITY, -1.0, f32::NEG_INFINITY].into_iter().enumerate() {
        wild[40 + i] = value;
    }
    let huge = vec![3e38; LENGTH];
    for form in Form::ALL {
        let with = |ray: &Vec<f32>| {
            let rays = Rays { extinctions: vec![ray.clone()] };
            rays.transmittances(rays.settings(form, 8), false, &depths()).concat()
        };
        assert_eq!(with(&clean), with(&wild), "{form:?}");
        assert!(with(&huge).iter().all(|t| (0.0..=1.0).contains(t)), "{form:?}: {:?}", with(&huge));
        assert!(with(&vec![0.0; LENGTH]).iter().all(|t| (t - 1.0).abs() < 1e-5), "{form:?}");
    }
}

/// Turned volumes under a slanting light, trilinear: against a march in f64 through the same values.
#[test]
fn a_cloud_and_a_plume_under_a_slanting_light_are_marched_truly() {
    let mut random = Random(3);
    let media = [
        ("cloud", cloud([40, 24, 32], 9), [[3e-3, 0.025], [3e-3, 0.025]]),
        ("plume", plume([32, 80, 32], 9), [[3e-3, 0.035], [1.5e-3, 0.02]]),
    ];
    for (name, mut volume, budgets) in media {
        volume.world_from_unit = Mat4::from_rotation_y(0.6) * volume.world_from_unit;
        let towards = Vec3::new(0.5, 0.8, 0.3);
        let light = Light::directional_leaning(towards, Vec3::ONE, volume.occupied_points()).unwrap();
        let uploaded = VolumeTexture::new(gpu(), &volume, 1.0, Reading::Linear).unwrap();
        // Where there is anything to be lit.
        let points: Vec<Vec3> = std::iter::repeat_with(|| [0; 3].map(|_| random.unit()))
            .filter(|unit| trilinear(&volume, *unit) > 0.05)
            .take(2000)
            .map(|unit| volume.world_from_unit.transform_point3(Vec3::from(unit.map(|x| x as f32))))
            .collect();
        let found_by = |form| {
            let settings = MapSettings::new(form, 16, [256, 256]);
            let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
            let voxels = Voxels::new(gpu(), shaders(), settings, Reading::Linear).unwrap();
            let bound = voxels.bind(gpu(), &map, &uploaded).unwrap();
            let mut encoder = gpu().encoder();
            voxels.record(&mut encoder, &bound);
            gpu().submit(encoder).unwrap();
            ask(&map, false, &points)
        };
        let plain = found_by(Form::Extinction);
        let errors = |found: &[f32], count: usize, of: &(dyn Fn(Vec3) -> f64 + Sync)| {
            let error = |i: usize| (of(points[i]) - f64::from(found[i])).abs();
            let errors = parallel::rows(count, error);
            (errors.iter().sum::<f64>() / count as f64, errors.iter().fold(0.0, |a: f64, b| a.max(*b)))
        };
        // What the map's resolution, half floats of the volume and its steps leave.
        let (mean, greatest) = errors(&plain, 60, &|point| series_at(&volume, &light, point));
        hold(&format!("{name}, from the truncated series, mean"), mean, 2e-3);
        hold(&format!("{name}, from the truncated series, greatest"), greatest, 0.02);
        // And what truncation leaves.
        for ((form, found), budgets) in
            [(Form::Extinction, &plain), (Form::Bounded, &found_by(Form::Bounded))].into_iter().zip(budgets)
        {
            let truth = |point| marched(&volume, point, light.direction);
            let (mean, greatest) = errors(found, points.len(), &truth);
            hold(&format!("{name}, {form:?}, 16 coefficients, mean"), mean, budgets[0]);
            hold(&format!("{name}, {form:?}, 16 coefficients, greatest"), greatest, budgets[1]);
        }
        let deep = points.iter().filter(|point| marched(&volume, **point, light.direction) < 0.5).count();
        println!("{name}: {deep} of {} points in shadow", points.len());
        assert!(deep > 500);
    }
}

/// Turned volumes in a map that is fitted to their occupied voxels: the range is shorter, and before it, behind it and
/// beside it everything is as it was.
#[test]
fn a_fitted_range_leaves_nothing_out() {
    let mut random = Random(17);
    for (name, mut volume) in [("cloud", cloud([40, 24, 32], 9)), ("plume", plume([32, 80, 32], 9))] {
        volume.world_from_unit = Mat4::from_rotation_y(0.6) * volume.world_from_unit;
        let bounds = volume.bounds();
        let towards = Vec3::new(0.5, 0.8, 0.3);
        let whole = Light::directional(towards, Vec3::ONE, bounds.min, bounds.max).unwrap();
        let fitted = Light::directional_leaning(towards, Vec3::ONE, volume.occupied_points()).unwrap();
        let range = |light: &Light| light.world_from_clip.z_axis.truncate().length();
        println!("{name}: {} m of {} m", range(&fitted), range(&whole));
        assert!(range(&fitted) < 0.45 * range(&whole));
        // Anywhere about the volume, most of it empty.
        let points: Vec<Vec3> = (0..2000)
            .map(|_| Vec3::from([0; 3].map(|_| random.between(-0.1, 1.1) as f32)))
            .map(|unit| volume.world_from_unit.transform_point3(unit))
            .collect();
        let outside = points.iter().map(|point| fitted.clip_from_world.project_point3(*point));
        let outside =
            outside.filter(|clip| clip.z < 0.0 || clip.z > 1.0 || clip.truncate().abs().max_element() > 1.0);
        assert!(outside.count() > 300);
        let settings = MapSettings::new(Form::Bounded, 16, [256, 256]);
        let map = TransmittanceMap::new(gpu(), settings, &fitted).unwrap();
        let one = ParticleBuffer::new(gpu(), &Particles::default()).unwrap();
        let refused = SplatFixed::new(gpu(), shaders(), settings).unwrap().bind(gpu(), &map, &one);
        assert!(matches!(refused, Err(TransmittanceError::Leaning)));
        let voxels = Voxels::new(gpu(), shaders(), settings, Reading::Linear).unwrap();
        let uploaded = VolumeTexture::new(gpu(), &volume, 1.0, Reading::Linear).unwrap();
        let mut encoder = gpu().encoder();
        voxels.record(&mut encoder, &voxels.bind(gpu(), &map, &uploaded).unwrap());
        gpu().submit(encoder).unwrap();
        let found = ask(&map, false, &points);
        let error = |i: usize| (marched(&volume, points[i], fitted.direction) - f64::from(found[i])).abs();
        let errors = parallel::rows(points.len(), error);
        hold(&format!("{name}, mean"), errors.iter().sum::<f64>() / points.len() as f64, 2e-3);
        hold(&format!("{name}, greatest"), errors.iter().fold(0.0, |a: f64, b| a.max(*b)), 0.03);
    }
}

/// A ball in a map that is as large as it: its chord in closed form before, in and behind it.
#[test]
fn a_ball_in_a_fitted_map_is_its_chord() {
    let balls = [Particle { position: Vec3::new(1.0, 2.0, -1.0), radius: 0.5, extinction: 1.6 }];
    let particles = Particles { list: balls.to_vec() };
    let light =
        Light::directional_around_balls(Vec3::new(0.5, 0.8, 0.3), Vec3::ONE, particles.balls()).unwrap();
    let settings = MapSettings::new(Form::Bounded, 16, [255, 255]);
    let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
    let buffer = ParticleBuffer::new(gpu(), &particles).unwrap();
    let splat = SplatFixed::new(gpu(), shaders(), settings).unwrap();
    let mut encoder = gpu().encoder();
    splat.record(&mut encoder, &splat.bind(gpu(), &map, &buffer).unwrap()).unwrap();
    gpu().submit(encoder).unwrap();
    // Away from the light through the middle, which is that of a texel: 3 m before it to 3 m behind it.
    let along = |i: i32| 0.1 * i as f32 - 3.0;
    let points: Vec<Vec3> = (0..=60).map(|i| balls[0].position - along(i) * light.direction).collect();
    for (i, found) in ask(&map, false, &points).into_iter().enumerate() {
        let passed = f64::from(along(i as i32) + 0.5).clamp(0.0, 1.0);
        let error = (f64::from(found) - (-1.6 * passed).exp()).abs();
        assert!(error < 2e-4, "{passed}: {error}");
    }
}

/// Transmittance by the series of 16 cosines of extinction along the light ray of a point, in f64.
fn series_at(volume: &Volume, light: &Light, point: Vec3) -> f64 {
    const STEPS: usize = 512;
    let into = volume.world_from_unit.as_dmat4().inverse();
    let range = light.world_from_clip.as_dmat4().z_axis.truncate().length();
    let depth = light.clip_from_world.as_dmat4().project_point3(point.as_dvec3()).z * range;
    let near = point.as_dvec3() + depth * light.direction.as_dvec3();
    let value = |i: usize| {
        let away = (i as f64 + 0.5) / STEPS as f64 * range;
        let unit = into.transform_point3(near - away * light.direction.as_dvec3());
        let inside = unit.min_element() >= 0.0 && unit.max_element() <= 1.0;
        if inside { trilinear(volume, unit.to_array()) } else { 0.0 }
    };
    let profile = Profile::of_steps(range, &(0..STEPS).map(value).collect::<Vec<_>>());
    (-Series::of_extinction(&profile, Basis::Cosine, 16).integral(depth)).exp().min(1.0)
}

/// Transmittance from a point to the light by 400 steps and trilinear reads in f64.
fn marched(volume: &Volume, point: Vec3, towards: Vec3) -> f64 {
    let into = volume.world_from_unit.as_dmat4().inverse();
    let step = 8.0 / 400.0;
    let optical_depth: f64 = (0..400)
        .map(|i| into.transform_point3(point.as_dvec3() + (f64::from(i) + 0.5) * step * towards.as_dvec3()))
        .filter(|unit| unit.min_element() >= 0.0 && unit.max_element() <= 1.0)
        .map(|unit| trilinear(volume, unit.to_array()) * step)
        .sum();
    (-optical_depth).exp()
}

fn trilinear(volume: &Volume, unit: [f64; 3]) -> f64 {
    let mut sum = 0.0;
    for corner in 0..8_usize {
        let (mut weight, mut index, mut stride) = (1.0, 0, 1);
        for (axis, unit) in unit.iter().enumerate() {
            let size = volume.size[axis] as usize;
            let at = unit * size as f64 - 0.5;
            let upper = corner >> axis & 1 == 1;
            let part = at - at.floor();
            weight *= if upper { part } else { 1.0 - part };
            let place = (at.floor() as i64 + i64::from(upper)).clamp(0, size as i64 - 1);
            index += place as usize * stride;
            stride *= size;
        }
        sum += weight * f64::from(volume.values[index]);
    }
    sum
}

#[test]
fn impossible_maps_are_errors() {
    let light = light_along_z(1.0);
    let of = |form, coefficients, size, precision| {
        let settings = MapSettings { precision, ..MapSettings::new(form, coefficients, size) };
        TransmittanceMap::new(gpu(), settings, &light).err()
    };
    for count in [0, 3, 5, 12, 32] {
        let error = of(Form::Extinction, count, [4, 4], Precision::Single);
        assert!(matches!(error, Some(TransmittanceError::Coefficients { .. })), "{count}");
    }
    let error = of(Form::PowerMoments, 4, [4, 4], Precision::Single).unwrap();
    assert!(error.to_string().ends_with("take 8"), "{error}");
    let half = of(Form::TrigonometricMoments, 8, [4, 4], Precision::Half);
    assert!(matches!(half, Some(TransmittanceError::HalfMoments(_))));
    let size = of(Form::Extinction, 4, [0, 4], Precision::Single);
    assert!(matches!(size, Some(TransmittanceError::Size { .. })));
    let flat = Light { world_from_clip: Mat4::ZERO, ..light };
    let settings = MapSettings::new(Form::Extinction, 4, [4, 4]);
    let none = TransmittanceMap::new(gpu(), settings, &flat);
    assert!(matches!(none, Err(TransmittanceError::Range(range)) if range == 0.0));
    let map = TransmittanceMap::new(gpu(), settings, &light).unwrap();
    let other = MapSettings::new(Form::Bounded, 4, [4, 4]);
    let voxels = Voxels::new(gpu(), shaders(), other, Reading::Nearest).unwrap();
    let volume = VolumeTexture::new(gpu(), &cloud([4, 4, 4], 1), 1.0, Reading::Nearest).unwrap();
    assert!(matches!(voxels.bind(gpu(), &map, &volume), Err(TransmittanceError::OtherMap { .. })));
}
