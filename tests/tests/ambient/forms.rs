// SPDX-License-Identifier: MIT OR Apache-2.0
//! Blurs, halves and settings of bent normals, and input that is broken.

use crate::gpu::{self, Random, gpu, texture};
use crate::seen::{self, SeenImages, cameras, from_above, seen, sharp};
use airlight::Texture;
use airlight::ambient::{AmbientError, BentForm, Blurring, OcclusionSettings, Sampling, SurfaceImages};
use airlight_tests::linear::Vec3;
use wgpu::TextureFormat::{R32Float, Rgba32Float};

const SIZE: [u32; 2] = [75, 53];
const ALL: [Sampling; 4] = [Sampling::Hemisphere, Sampling::Disc, Sampling::Horizon, Sampling::Bitmask];

/// A floor with a wall, its normals as bumpy as `bumps` says.
fn yard(bumps: f64) -> SeenImages {
    let surface = move |origin: Vec3, direction: Vec3| {
        let wall = (-0.6 - origin.x) / direction.x;
        let floor = -origin.y / direction.y;
        let bump =
            |place: Vec3| Vec3::new(bumps * (40.0 * place.x).sin(), 1.0, bumps * (37.0 * place.z).sin());
        let floor = (direction.y < 0.0).then(|| (floor, bump(origin + direction * floor).normalised()));
        let wall = (direction.x < 0.0 && wall > 0.0).then_some((wall, Vec3::new(1.0, 0.0, 0.0)));
        [floor, wall].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let [_, (_, reversed), _] = cameras(Vec3::new(1.5, 1.8, 0.6), Vec3::default(), 1.0);
    seen(reversed, SIZE, &surface)
}

fn settings() -> OcclusionSettings {
    OcclusionSettings::new(0.6)
}

#[test]
fn openness_alone_is_the_openness_beside_bent_normals() {
    let images = yard(0.1);
    for sampling in ALL {
        for blurring in [Blurring::Off, Blurring::Difference] {
            let form = BentForm { blurring, ..sharp(sampling) };
            let both = images.bent(form, &settings());
            let passes = seen::passes(BentForm { occlusion_only: true, ..form });
            let mut encoder = gpu().encoder();
            let alone = passes.record(gpu(), &mut encoder, images.images(), &settings()).unwrap();
            gpu().submit(encoder).unwrap();
            let alone = alone.read(gpu()).unwrap();
            let pairs = both.iter().zip(&alone).map(|((_, open), alone)| (open - f64::from(*alone)).abs());
            // One is stored as halves, twice where it is blurred.
            let worst = pairs.fold(0.0, f64::max);
            assert!(worst < 2e-3, "{sampling:?} {blurring:?}: {worst}");
            assert!(alone.iter().any(|open| *open < 0.8), "{sampling:?}: nothing is hidden");
        }
    }
}

#[test]
fn a_blur_of_differences_keeps_bumps_and_a_plain_one_loses_them() {
    // Bumps are only in the normals: rays see a flat floor, so an open place's bent normal is its bump's normal.
    let images = yard(0.25);
    let degrees = |blurring| {
        let bent = images.bent(BentForm { blurring, ..sharp(Sampling::Hemisphere) }, &settings());
        let far_from_the_wall = images.surfaces.iter().zip(&bent).filter_map(|(surface, (mean, _))| {
            let (place, normal) = (*surface)?;
            let cosine = mean.normalised().dot(normal);
            (place.x > 0.3).then(|| cosine.clamp(-1.0, 1.0).acos().to_degrees())
        });
        let all: Vec<f64> = far_from_the_wall.collect();
        assert!(all.len() > 300);
        all.iter().sum::<f64>() / all.len() as f64
    };
    let [difference, plain] = [degrees(Blurring::Difference), degrees(Blurring::Plain)];
    println!("from the bumpy normals: {difference:.2} degrees, by a plain blur {plain:.2}");
    assert!(difference < 3.0 && plain > 2.0 * difference, "{difference} {plain}");
}

#[test]
fn half_the_resolution_is_nearly_the_whole() {
    let images = yard(0.0);
    let form = BentForm { blurring: Blurring::Difference, ..sharp(Sampling::Hemisphere) };
    let whole = images.bent(form, &settings());
    let halved = images.bent(BentForm { halved: true, ..form }, &settings());
    let mut sum = [0.0; 2];
    let mut count = 0.0;
    for (surface, (whole, halved)) in images.surfaces.iter().zip(whole.iter().zip(&halved)) {
        if surface.is_none() {
            continue;
        }
        sum[0] += (whole.0 - halved.0).length();
        sum[1] += (whole.1 - halved.1).abs();
        count += 1.0;
    }
    println!("mean difference of directions {:.4}, of openness {:.4}", sum[0] / count, sum[1] / count);
    assert!(sum[0] / count < 0.03 && sum[1] / count < 0.03);
}

#[test]
fn half_the_resolution_keeps_to_its_side_of_an_edge() {
    // A block on a floor, from above: nothing hides its top, and it hides much of the floor beside it.
    let block = |x: f64, _: f64| Some((if x < -0.1 { 0.6 } else { 0.0 }, Vec3::new(0.0, 1.0, 0.0)));
    let images = from_above([40, 40], 1.0, true, &block);
    let settings = OcclusionSettings { samples: 16, steps: 12, ..OcclusionSettings::new(1.0) };
    let whole = images.bent(sharp(Sampling::Hemisphere), &settings);
    let halved = images.bent(BentForm { halved: true, ..sharp(Sampling::Hemisphere) }, &settings);
    // Means over the two columns on a side, which are one halved column, for all rows are alike.
    let side = |all: &[(Vec3, f64)], columns: std::ops::Range<usize>| {
        let rows = all.chunks_exact(40).skip(8).take(24);
        rows.flat_map(|row| row[columns.clone()].to_vec()).fold((Vec3::default(), 0.0), |sum, pixel| {
            (sum.0 + pixel.0 * (1.0 / 48.0), sum.1 + pixel.1 / 48.0)
        })
    };
    for (what, columns, open) in [("top", 16..18, 0.999..=1.001), ("floor", 18..20, 0.75..=0.9)] {
        let (whole, halved) = (side(&whole, columns.clone()), side(&halved, columns));
        println!("{what}: whole {whole:.3?}, halved {halved:.3?}");
        assert!(open.contains(&whole.1), "{what}: {whole:?}");
        assert!((whole.1 - halved.1).abs() < 0.012, "{what}: {whole:?} {halved:?}");
        assert!((whole.0 - halved.0).length() < 0.012, "{what}: {whole:?} {halved:?}");
    }
}

#[test]
fn noise_of_any_size_leaves_finite_parts_of_the_hemisphere() {
    let mut random = Random(41);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0, 1e30, -1e30, 0.0, 1.0];
    let mut any = |low: f64| {
        if random.unit() < 0.2 { wild[random.below(wild.len())] } else { random.between(low, 1.0) as f32 }
    };
    // Noise, and a picture at one depth with bumps that are alike enough to be blurred.
    let pictures = [([1, 1], true), ([3, 5], true), ([17, 9], true), ([17, 9], false)];
    let pictures = pictures.map(|(size, broken): ([u32; 2], bool)| {
        let pixels = (size[0] * size[1]) as usize;
        let depths: Vec<f32> = (0..pixels).map(|_| if broken { any(0.0) } else { 0.3 }).collect();
        let normal = |index: usize, part: f32| match index % 4 {
            _ if broken => part,
            1 => 1.0,
            _ => 0.5 * part.clamp(-1.0, 1.0),
        };
        let normals: Vec<f32> = (0..4 * pixels).map(|index| normal(index, any(-1.0))).collect();
        (size, texture(size, R32Float, &depths), texture(size, Rgba32Float, &normals))
    });
    let [_, (_, reference), _] = cameras(Vec3::new(1.5, 1.8, 0.6), Vec3::default(), 1.0);
    let mut forms = Vec::new();
    for sampling in ALL {
        let form = BentForm { blurring: Blurring::Difference, ..sharp(sampling) };
        forms.extend([sharp(sampling), BentForm { halved: true, ..form }]);
    }
    forms.push(BentForm { blurring: Blurring::Plain, ..sharp(Sampling::Disc) });
    forms.push(BentForm { occlusion_only: true, blurring: Blurring::Plain, ..sharp(Sampling::Disc) });
    // Few directions have long means.
    let few = OcclusionSettings { samples: 1, side: 2, ..settings() };
    for form in forms {
        let passes = seen::passes(form);
        for ((size, depth, normals), settings) in pictures.iter().flat_map(|p| [(p, settings()), (p, few)]) {
            let camera = gpu::host_camera(&reference, *size);
            let seen = SurfaceImages { camera: &camera, depth, normals };
            let mut encoder = gpu().encoder();
            let bent = passes.record(gpu(), &mut encoder, seen, &settings).unwrap();
            gpu().submit(encoder).unwrap();
            let found = bent.read(gpu()).unwrap();
            assert!(found.iter().all(|value| value.is_finite()), "{form:?} {size:?}");
            if form.occlusion_only {
                assert!(found.iter().all(|open| (0.0..=1.0).contains(open)), "{form:?} {size:?}");
                continue;
            }
            for texel in found.chunks_exact(4) {
                let length = Vec3::from([texel[0], texel[1], texel[2]]).length();
                // Directions are stored as halves.
                assert!(length < 1.001 && (0.0..=1.0).contains(&texel[3]), "{form:?} {size:?}: {texel:?}");
            }
        }
    }
}

#[test]
fn broken_depths_and_normals_leave_nothing_that_is_not_finite() {
    let images = yard(0.2);
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0, 1e30, 0.0];
    let mut depths = images.depths.clone();
    let mut normals = images.normals.read(gpu()).unwrap();
    for (index, depth) in depths.iter_mut().enumerate().filter(|(index, _)| index % 7 == 0) {
        *depth = wild[index % wild.len()];
    }
    for (index, value) in normals.iter_mut().enumerate().filter(|(index, _)| index % 5 == 0) {
        *value = wild[index % wild.len()];
    }
    normals[..400].fill(0.0);
    let image = |format, values: &[f32]| {
        let texture = Texture::storage(gpu(), SIZE, format);
        texture.write(gpu(), values).unwrap();
        texture
    };
    let (depth, normals) = (image(R32Float, &depths), image(Rgba32Float, &normals));
    let seen = SurfaceImages { camera: &images.camera, depth: &depth, normals: &normals };
    for sampling in ALL {
        for halved in [false, true] {
            let form = BentForm { blurring: Blurring::Difference, halved, ..sharp(sampling) };
            let passes = seen::passes(form);
            let mut encoder = gpu().encoder();
            let bent = passes.record(gpu(), &mut encoder, seen, &settings()).unwrap();
            gpu().submit(encoder).unwrap();
            let found = bent.read(gpu()).unwrap();
            assert!(found.iter().all(|value| value.is_finite()), "{sampling:?} {halved}");
            assert!(found.chunks_exact(4).all(|texel| (0.0..=1.001).contains(&texel[3])));
        }
    }
}

#[test]
fn impossible_settings_are_refused() {
    let images = yard(0.0);
    let passes = seen::passes(sharp(Sampling::Hemisphere));
    let possible = settings();
    for wrong in [
        OcclusionSettings { samples: 0, ..possible },
        OcclusionSettings { samples: 257, ..possible },
        OcclusionSettings { steps: 0, ..possible },
        OcclusionSettings { side: 0, ..possible },
        OcclusionSettings { side: 17, ..possible },
        OcclusionSettings { radius: 0.0, ..possible },
        OcclusionSettings { radius: f32::NAN, ..possible },
        OcclusionSettings { thickness: -1.0, ..possible },
        OcclusionSettings { bias: 1.5, ..possible },
    ] {
        let found = passes.record(gpu(), &mut gpu().encoder(), images.images(), &wrong);
        assert!(matches!(found, Err(AmbientError::Setting(_))), "{wrong:?}");
    }
}
