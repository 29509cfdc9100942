// SPDX-License-Identifier: MIT OR Apache-2.0
//! Particles splatted into transmittance maps: against stretches of balls in f64, in any order, and what is dropped.

use crate::gpu::{Random, gpu, shaders};
use crate::probing::hold;
use crate::rays::{HALF, RANGE, ask, light_along_z};
use airlight::data::{Particle, Particles, burst};
use airlight::transmittance::{
    CheckParticles, Form, MapSettings, ParticleBuffer, ParticleCounts, Precision, Splat, SplatFixed,
    TransmittanceError, TransmittanceMap,
};
use airlight_tests::reference::transmittance::{Basis, Profile, Series, Stretch};
use glam::Vec3;

const SIDE: u32 = 64;
/// Metres of a texel.
const TEXEL: f64 = RANGE / SIDE as f64;

fn settings(form: Form, coefficients: u32, precision: Precision) -> MapSettings {
    MapSettings { precision, ..MapSettings::new(form, coefficients, [SIDE, SIDE]) }
}

/// The map of particles, and what was counted.
fn splatted(settings: MapSettings, particles: &Particles, fixed: bool) -> (TransmittanceMap, ParticleCounts) {
    let map = TransmittanceMap::new(gpu(), settings, &light_along_z(1.0)).unwrap();
    let buffer = ParticleBuffer::new(gpu(), particles).unwrap();
    let check = CheckParticles::new(gpu(), shaders()).unwrap();
    let checked = check.bind(gpu(), &map, &buffer).unwrap();
    let mut encoder = gpu().encoder();
    check.record(&mut encoder, &checked, &buffer).unwrap();
    if fixed {
        let splat = SplatFixed::new(gpu(), shaders(), settings).unwrap();
        let bound = splat.bind(gpu(), &map, &buffer).unwrap();
        splat.record(&mut encoder, &bound).unwrap();
    } else {
        let splat = Splat::new(gpu(), shaders(), settings).unwrap();
        let bound = splat.bind(gpu(), &map, &buffer).unwrap();
        splat.record(&mut encoder, &bound, &map, &buffer);
    }
    gpu().submit(encoder).unwrap();
    let counts = buffer.read_counts(gpu()).unwrap();
    (map, counts)
}

/// Where the light ray of a texel lies, metres.
fn texel_ray(texel: [usize; 2]) -> [f64; 2] {
    [(texel[0] as f64 + 0.5) * TEXEL - HALF, HALF - (texel[1] as f64 + 0.5) * TEXEL]
}

fn point(texel: [usize; 2], depth: f64) -> Vec3 {
    let [x, y] = texel_ray(texel);
    Vec3::new(x as f32, y as f32, (HALF - depth * RANGE) as f32)
}

/// The stretches of balls that a light ray meets, cut to the range; balls wider than 1.25 texels.
fn profile(particles: &Particles, texel: [usize; 2]) -> Profile {
    let [x, y] = texel_ray(texel);
    let stretch = |particle: &Particle| {
        let [px, py, pz] = particle.position.to_array().map(f64::from);
        let radius = f64::from(particle.radius);
        assert!(radius > 1.25 * TEXEL);
        let square = radius * radius - (x - px).powi(2) - (y - py).powi(2);
        let (half, middle) = (square.max(0.0).sqrt(), HALF - pz);
        let (from, to) = ((middle - half).clamp(0.0, RANGE), (middle + half).clamp(0.0, RANGE));
        (square > 0.0 && to > from).then(|| Stretch { from, to, extinction: f64::from(particle.extinction) })
    };
    Profile { range: RANGE, stretches: particles.list.iter().filter_map(stretch).collect() }
}

/// Balls in and about the map, some of them across its ends.
fn balls(count: usize, seed: u64) -> Particles {
    let mut random = Random(seed);
    let ball = |_| Particle {
        position: Vec3::from([0; 3].map(|_| random.between(-4.3, 4.3) as f32)),
        radius: random.between(0.2, 1.2) as f32,
        extinction: random.between(0.0, 0.3) as f32,
    };
    Particles { list: (0..count).map(ball).collect() }
}

fn shuffled(particles: &Particles, seed: u64) -> Particles {
    let mut random = Random(seed);
    let mut list = particles.list.clone();
    for i in (1..list.len()).rev() {
        list.swap(i, random.below(i + 1));
    }
    Particles { list }
}

#[test]
fn balls_are_the_series_of_their_chords() {
    let particles = balls(250, 21);
    let mut random = Random(8);
    let texels: Vec<[usize; 2]> = (0..150).map(|_| [random.below(64), random.below(64)]).collect();
    let depths = [0.1, 0.3, 0.45, 0.6, 0.85, 1.0];
    let places = || texels.iter().flat_map(|texel| depths.map(|depth| (*texel, depth)));
    let points: Vec<Vec3> = places().map(|(texel, depth)| point(texel, depth)).collect();
    let profiles: Vec<Profile> = texels.iter().map(|texel| profile(&particles, *texel)).collect();
    assert!(profiles.iter().filter(|p| p.stretches.len() > 3).count() > 30, "rays should meet several balls");
    let cases = [
        (Form::Extinction, 4, Precision::Single, true, 2e-5),
        (Form::Extinction, 16, Precision::Single, true, 5e-5),
        (Form::Opacity, 8, Precision::Single, true, 5e-5),
        (Form::Bounded, 4, Precision::Single, true, 1e-4),
        (Form::Extinction, 4, Precision::Half, true, 1e-3),
        (Form::Extinction, 4, Precision::Half, false, 3e-3),
        (Form::Extinction, 8, Precision::Half, false, 3e-3),
        (Form::Extinction, 16, Precision::Half, false, 3e-3),
        (Form::Opacity, 4, Precision::Half, false, 3e-3),
    ];
    for (form, count, precision, fixed, budget) in cases {
        let (map, counts) = splatted(settings(form, count, precision), &particles, fixed);
        assert_eq!((counts.kept + counts.dropped(), counts.overflows), (250, 0));
        let found = ask(&map, false, &points);
        let mut worst = 0.0_f64;
        for (profile, found) in profiles.iter().zip(found.chunks(depths.len())) {
            let cut = if form == Form::Bounded { profile.occupied() } else { Some((0.0, RANGE)) };
            let basis = if form == Form::Opacity { Basis::Period } else { Basis::Cosine };
            for (depth, found) in depths.iter().zip(found) {
                let expected = cut.map_or(1.0, |(from, to)| {
                    let series = Series::of_extinction(&profile.cut(from, to), basis, count as usize);
                    (-series.integral((depth * RANGE - from).clamp(0.0, to - from))).exp().min(1.0)
                });
                worst = worst.max((expected - f64::from(*found)).abs());
            }
        }
        hold(&format!("{form:?} {count} {precision:?}, fixed {fixed}"), worst, budget);
    }
}

#[test]
fn fixed_point_does_not_know_the_order() {
    let particles = burst(3000, 4);
    let forms = [
        (Form::Extinction, 4),
        (Form::Extinction, 16),
        (Form::Bounded, 4),
        (Form::Opacity, 4),
        (Form::PowerMoments, 8),
        (Form::TrigonometricMoments, 8),
    ];
    for (form, count) in forms {
        let of = |particles: &Particles| {
            let (map, counts) = splatted(settings(form, count, Precision::Single), particles, true);
            let intervals = map.intervals.as_ref().map(|texture| texture.read_words(gpu()).unwrap());
            assert_eq!((counts.kept, counts.overflows), (3000, 0));
            (map.coefficients.read_words(gpu()).unwrap(), intervals)
        };
        let first = of(&particles);
        assert!(first.0.iter().filter(|word| **word != 0).count() > 1000);
        assert!(of(&shuffled(&particles, 5)) == first, "{form:?} {count}");
    }
}

#[test]
fn more_particles_than_a_row_of_workgroups_count_once_each() {
    let few = balls(5, 12);
    // Clear balls before them fill the row of 65535 workgroups; the rest of the next row has no particle.
    let clear = few.list.iter().map(|ball| Particle { extinction: 0.0, ..*ball });
    let list: Vec<_> = clear.cycle().take(65_534).chain(few.list.iter().copied()).collect();
    for form in [Form::Extinction, Form::Bounded] {
        let of = |particles: &Particles| {
            let (map, counts) = splatted(settings(form, 4, Precision::Single), particles, true);
            assert_eq!((counts.kept as usize, counts.overflows), (particles.list.len(), 0));
            map.coefficients.read_words(gpu()).unwrap()
        };
        let alone = of(&few);
        assert!(alone.iter().any(|word| *word != 0));
        assert!(of(&Particles { list: list.clone() }) == alone, "{form:?}");
    }
}

#[test]
fn blending_changes_by_half_a_unit_a_particle_at_most() {
    let particles = balls(150, 31);
    for count in [4, 16] {
        let of = |particles: &Particles| {
            let (map, _) = splatted(settings(Form::Extinction, count, Precision::Half), particles, false);
            map.coefficients.read(gpu()).unwrap()
        };
        let (first, second) = (of(&particles), of(&shuffled(&particles, 6)));
        let (mut changed, mut most) = (0, 0.0_f64);
        for (i, (a, b)) in first.iter().zip(&second).enumerate() {
            let texel = i / 4 % (64 * 64);
            let met = profile(&particles, [texel % 64, texel / 64]);
            let (n, total) = (met.stretches.len() as f64, met.optical_depth(RANGE));
            // No partial sum exceeds the root of two times the optical depth.
            let half_unit = 2.0_f64.powi(-11) * 2.0_f64.sqrt() * total;
            let change = f64::from((a - b).abs());
            changed += usize::from(change > 0.0);
            most = most.max(change / half_unit.max(1e-7));
            assert!(change <= n * half_unit + 1e-7, "texel {texel}: {a} and {b}, {n} particles");
        }
        println!(
            "{count} coefficients: {changed} of {} change, by {most:.2} half units at most",
            first.len()
        );
        assert!(changed > 0, "half floats that never round");
    }
}

#[test]
fn what_cannot_be_is_dropped_and_counted() {
    let good = balls(20, 41);
    let fine = Particle { position: Vec3::ZERO, radius: 0.5, extinction: 1.0 };
    let with = |change: fn(&mut Particle)| {
        let mut particle = fine;
        change(&mut particle);
        particle
    };
    let bad: [(&str, Vec<Particle>); 4] = [
        (
            "not finite",
            vec![
                with(|p| p.position.x = f32::NAN),
                with(|p| p.position.z = f32::INFINITY),
                with(|p| p.radius = f32::NAN),
                with(|p| p.extinction = f32::NEG_INFINITY),
            ],
        ),
        ("radius", vec![with(|p| p.radius = 0.0), with(|p| p.radius = -1.0), with(|p| p.radius = 9.0)]),
        ("extinction", vec![with(|p| p.extinction = -0.1)]),
        (
            "outside",
            vec![
                with(|p| p.position.z = 5.0),
                with(|p| p.position.z = -4.6),
                with(|p| p.position.x = 4.7),
                with(|p| p.position.y = -1e30),
                with(|p| p.position.x = 3e38),
            ],
        ),
    ];
    for (fixed, precision) in [(true, Precision::Single), (false, Precision::Half)] {
        let settings = settings(Form::Extinction, 8, precision);
        let (clean, before) = splatted(settings, &good, fixed);
        let mut all = good.clone();
        for (_, particles) in &bad {
            all.list.extend(particles);
        }
        let (map, counts) = splatted(settings, &all, fixed);
        let expected =
            ParticleCounts { not_finite: 4, radius: 3, extinction: 1, outside: before.outside + 5, ..before };
        assert_eq!(counts, expected);
        assert_eq!(
            clean.coefficients.read_words(gpu()).unwrap(),
            map.coefficients.read_words(gpu()).unwrap()
        );
        // Without any particle nothing is in the way.
        let (none, counts) = splatted(settings, &Particles::default(), fixed);
        assert_eq!(counts, ParticleCounts::default());
        assert!(ask(&none, false, &[Vec3::ZERO, Vec3::NEG_Z]).iter().all(|t| *t == 1.0));
    }
}

#[test]
fn small_balls_keep_their_extinction() {
    let mut random = Random(51);
    let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
    for _ in 0..60 {
        let radius = random.magnitude(0.005, 1.2 * TEXEL);
        let position = Vec3::from([0; 3].map(|_| random.between(-2.0, 2.0) as f32));
        let extinction = 5.0 / radius;
        let particle = Particle { position, radius: radius as f32, extinction: extinction as f32 };
        let particles = Particles { list: vec![particle] };
        let (map, _) = splatted(settings(Form::Extinction, 4, Precision::Single), &particles, true);
        let coefficients = map.coefficients.read(gpu()).unwrap();
        let sum: f64 = coefficients.iter().step_by(4).map(|value| f64::from(*value)).sum();
        let truth = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * extinction;
        let ratio = sum * TEXEL * TEXEL / truth;
        least = least.min(ratio);
        greatest = greatest.max(ratio);
    }
    println!("extinction times volume, over that of the ball: {least:.3} to {greatest:.3}");
    assert!(least > 0.9 && greatest < 1.12);
}

#[test]
fn impossible_splats_are_errors_and_overflows_are_counted() {
    for form in [Form::Function, Form::FunctionPeriodic] {
        let fixed = SplatFixed::new(gpu(), shaders(), settings(form, 4, Precision::Single));
        assert!(matches!(fixed, Err(TransmittanceError::Splat(..))));
        let blended = Splat::new(gpu(), shaders(), settings(form, 4, Precision::Half));
        assert!(matches!(blended, Err(TransmittanceError::Splat(..))));
    }
    let single = Splat::new(gpu(), shaders(), settings(Form::Extinction, 4, Precision::Single));
    assert!(matches!(single, Err(TransmittanceError::Blend(Precision::Single))));
    let large = MapSettings::new(Form::Extinction, 16, [4096, 4096]);
    assert!(matches!(SplatFixed::new(gpu(), shaders(), large), Err(TransmittanceError::Sums { .. })));
    let dense = Particle { position: Vec3::ZERO, radius: 0.5, extinction: 1e4 };
    let some = settings(Form::Extinction, 4, Precision::Single);
    for (count, overflows) in [(80, false), (300, true)] {
        let particles = Particles { list: vec![dense; count] };
        let (map, counts) = splatted(some, &particles, true);
        assert_eq!(counts.overflows > 0, overflows, "{counts:?}");
        assert!(ask(&map, false, &[Vec3::ZERO])[0].is_finite());
    }
    // Half floats that overflow are read as 0.
    let particles = Particles { list: vec![dense; 1500] };
    let (map, _) = splatted(settings(Form::Extinction, 4, Precision::Half), &particles, false);
    assert!(ask(&map, false, &[Vec3::ZERO, Vec3::NEG_Z])[0].is_finite());
}
