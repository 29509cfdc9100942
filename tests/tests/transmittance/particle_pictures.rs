// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of particles that are lit through transmittance maps, against sorted blending in f64.

use crate::gpu::Random;
use crate::media::{PIXELS, Setting, lighting, orthographic, perspective, split};
use crate::probing::hold;
use airlight::core::{DepthRange, View};
use airlight::data::{Particle, Particles, burst};
use airlight::transmittance::{Form, MapSettings};
use airlight_tests::error::relative_rmse;
use airlight_tests::linear;
use airlight_tests::reference::phase::henyey_greenstein;
use airlight_tests::reference::transmittance::Ball;
use glam::Vec3;
use std::f64::consts::PI;

fn particles_setting(particles: &Particles, view: &View) -> Setting {
    let bounds = particles.bounds().unwrap();
    Setting::new(view, Vec3::new(0.6, 0.7, 0.2), [bounds.min, bounds.max], lighting())
}

fn balls(particles: &Particles) -> Vec<Ball> {
    let ball = |p: &Particle| Ball {
        middle: linear::Vec3::from(p.position.to_array()),
        radius: f64::from(p.radius),
        extinction: f64::from(p.extinction),
    };
    particles.list.iter().map(ball).collect()
}

#[test]
fn particles_are_blended_as_in_f64_in_any_order() {
    let mut particles = burst(400, 5);
    // None so small that it is widened.
    particles.list.iter_mut().for_each(|particle| particle.radius = particle.radius.max(0.15));
    let balls = balls(&particles);
    let views = [
        perspective(Vec3::new(2.0, 1.5, 5.0), DepthRange::Forward),
        orthographic(Vec3::new(-3.0, 1.5, 6.0), 4.5, DepthRange::Reversed),
        // Within the medium, and within some particles.
        perspective(particles.list[7].position + 0.02, DepthRange::Reversed),
    ];
    for view in views {
        let mut setting = particles_setting(&particles, &view);
        let middle = setting.camera.clip_from_world * Vec3::new(-0.3, -0.2, -0.1).extend(1.0);
        if middle.w > 0.5 {
            setting.depth[..PIXELS / 2].fill(middle.z / middle.w);
        }
        let settings = MapSettings::new(Form::Bounded, 16, [256, 256]);
        let (found, lit) = setting.particles(&particles, settings);
        let exact = setting.reference(|view| view.at_middles(&balls));
        let given: Vec<f64> = lit.iter().map(|t| f64::from(*t)).collect();
        let off: f64 = exact.iter().zip(&given).map(|(a, b)| (a - b).abs()).sum::<f64>() / 400.0;
        hold("transmittance at the middles, mean", off, 0.006);
        let (radiance, through) = split(&found);
        let (same, left) = split(&setting.reference(|view| view.blended(&balls, &given)));
        let (truth, _) = split(&setting.reference(|view| view.blended(&balls, &exact)));
        hold("blended, light given", relative_rmse(&radiance, &same), 0.002);
        hold("blended, transmittance", relative_rmse(&through, &left), 0.004);
        hold("blended and lit", relative_rmse(&radiance, &truth), 0.03);
        let mut shuffled = particles.clone();
        let mut random = Random(8);
        for i in (1..shuffled.list.len()).rev() {
            shuffled.list.swap(i, (random.unit() * (i + 1) as f64) as usize);
        }
        assert_ne!(shuffled, particles);
        assert_eq!(setting.particles(&shuffled, settings).0, found);
    }
}

#[test]
fn the_reference_sums_over_all_particles() {
    let mut particles = burst(400, 5);
    particles.list.iter_mut().for_each(|particle| particle.radius = particle.radius.max(0.15));
    let balls = balls(&particles);
    let view = perspective(Vec3::new(2.0, 1.5, 5.0), DepthRange::Forward);
    let setting = particles_setting(&particles, &view);
    let (picture, lit) = setting.summed(&particles);
    let exact = setting.reference(|view| view.at_middles(&balls));
    let worst = exact.iter().zip(&lit).map(|(a, b)| (a - f64::from(*b)).abs()).fold(0.0, f64::max);
    hold("summed, greatest", worst, 1e-5);
    assert!(exact.iter().filter(|t| **t < 0.5).count() > 50);
    let (radiance, _) = split(&picture);
    let (truth, _) = split(&setting.reference(|view| view.blended(&balls, &exact)));
    hold("summed and blended", relative_rmse(&radiance, &truth), 0.002);
    // What is dropped dims nothing, and one alone is dimmed by its own half.
    let mut wild = particles.clone();
    let at = Particle { position: Vec3::ZERO, radius: 0.3, extinction: 2.0 };
    wild.list.insert(20, Particle { position: Vec3::new(f32::NAN, 0.0, 0.0), ..at });
    wild.list.insert(0, Particle { extinction: -1.0, ..at });
    wild.list.push(Particle { radius: f32::INFINITY, ..at });
    wild.list.push(Particle { position: Vec3::new(0.0, 1e30, 0.0), ..at });
    let (same, with_dropped) = setting.summed(&wild);
    assert_eq!(same, picture);
    assert_eq!(with_dropped.iter().filter(|t| **t == -1.0).count(), 4);
    let (_, alone) = setting.summed(&Particles { list: vec![at] });
    assert!((alone[0] - (-0.6_f32).exp()).abs() < 1e-6, "{}", alone[0]);
    assert!(setting.summed(&Particles::default()).1.is_empty());
}

/// Balls far below a pixel are widened: what they send in all stays.
#[test]
fn the_smallest_particles_keep_what_they_send() {
    let settings = MapSettings::new(Form::Extinction, 4, [64, 64]);
    let mut random = Random(4);
    for view in [
        perspective(Vec3::new(0.0, 0.0, 5.0), DepthRange::Forward),
        orthographic(Vec3::new(0.0, 0.0, 5.0), 4.0, DepthRange::Forward),
    ] {
        for radius in [0.02_f32, 0.06, 0.2] {
            let position = Vec3::new(random.unit() as f32, random.unit() as f32, 0.0) * 0.1;
            let one = Particles { list: vec![Particle { position, radius, extinction: 0.05 / radius }] };
            let setting = particles_setting(&one, &view);
            let (picture, lit) = setting.particles(&one, settings);
            let height = if setting.camera.projection == 1 { 4.0 } else { 10.0 * 20_f64.to_radians().tan() };
            let ray = (position - Vec3::new(0.0, 0.0, 5.0)).normalize();
            let cosine =
                if setting.camera.projection == 1 { -Vec3::Z } else { ray }.dot(setting.light.direction);
            let source = 0.95 * 3.0 * henyey_greenstein(f64::from(cosine), 0.4) * f64::from(lit[0]);
            let sent: f64 = picture.chunks_exact(4).map(|p| f64::from(p[0])).sum::<f64>() / source;
            // Extinction times volume; thin enough.
            let expected = 0.05 * 4.0 / 3.0 * PI * f64::from(radius).powi(2);
            let ratio = sent * (height / 48.0).powi(2) / expected;
            println!("{radius} m: {ratio:.3} of what it is to send");
            assert!((0.85..1.13).contains(&ratio), "{ratio}");
        }
    }
}

#[test]
fn wild_particles_leave_no_trace_and_wild_depths_are_far() {
    let clean = burst(60, 2);
    let mut wild = clean.clone();
    for value in [f32::NAN, f32::INFINITY, -1.0, 1e30, 3e38] {
        let at = Particle { position: Vec3::ZERO, radius: 0.3, extinction: 2.0 };
        wild.list.insert(20, Particle { position: Vec3::new(value, 0.0, 30.0), ..at });
        wild.list.push(Particle { radius: value, ..at });
        if value < 0.0 || !value.is_finite() {
            wild.list.insert(0, Particle { extinction: value, ..at });
        }
    }
    let view = perspective(Vec3::new(2.0, 1.5, 5.0), DepthRange::Forward);
    let mut setting = particles_setting(&clean, &view);
    let settings = MapSettings::new(Form::Extinction, 4, [64, 64]);
    let (found, _) = setting.particles(&clean, settings);
    assert_eq!(setting.particles(&wild, settings).0, found);
    for (i, depth) in setting.depth.iter_mut().enumerate() {
        *depth = [f32::NAN, f32::INFINITY, 1.0, f32::NEG_INFINITY][i % 4];
    }
    assert_eq!(setting.particles(&clean, settings).0, found);
    // No particle at all, one without extinction, and one as dense as can be.
    let (empty, _) = setting.particles(&Particles::default(), settings);
    assert!(empty.chunks_exact(4).all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]));
    for extinction in [0.0, 3e38] {
        let one = Particle { position: Vec3::ZERO, radius: 0.5, extinction };
        let (picture, _) = setting.particles(&Particles { list: vec![one] }, settings);
        assert!(picture.iter().all(|value| value.is_finite()));
        let dark = picture.chunks_exact(4).filter(|pixel| pixel[3] < 1e-6).count();
        assert_eq!(dark > 50, extinction > 0.0, "{dark}");
    }
}
