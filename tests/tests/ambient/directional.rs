// SPDX-License-Identifier: MIT OR Apache-2.0
//! Screen-space directional occlusion, the competitor of bent cones: that it is what its name says, and its error and noise
//! beside theirs.

use crate::competitors;
use crate::cones;
use crate::gpu::{self, gpu, host_vector};
use crate::seen::{self, SeenImages, cameras};
use crate::standing::{self, Standing, low_passed};
use airlight::Texture;
use airlight::ambient::{Method, OcclusionSettings, SurfaceImages, environment_texture};
use airlight::command::ssdo::{Spread, Ssdo, lights_buffer};
use airlight::data::Environment;
use airlight::scenes::ambient_scenes;
use airlight_tests::error;
use airlight_tests::linear::Vec3;
use std::f64::consts::PI;
use wgpu::TextureFormat::Rgba32Float;

/// Directions of a picture without noise.
const MANY: u32 = 256;

/// The picture of the competitor.
fn gathered(
    seen: SurfaceImages<'_>,
    settings: &OcclusionSettings,
    albedos: &Texture,
    map: &Environment,
    spread: Spread,
) -> Vec<f32> {
    let ssdo = Ssdo::new(gpu(), competitors::shaders(), spread).unwrap();
    let mut encoder = gpu().encoder();
    let picture = if spread == Spread::Lights {
        let lights = lights_buffer(gpu(), map, settings);
        ssdo.record(gpu(), &mut encoder, seen, settings, albedos, &lights)
    } else {
        let radiance = environment_texture(gpu(), map).unwrap();
        ssdo.record(gpu(), &mut encoder, seen, settings, albedos, &radiance)
    }
    .unwrap();
    gpu().submit(encoder).unwrap();
    picture.read(gpu()).unwrap()
}

/// Colours of pictures where there is a surface.
fn colours(picture: &[f32]) -> Vec<f32> {
    picture.chunks_exact(4).filter(|t| t[3] == 1.0).flat_map(|t| [t[0], t[1], t[2]]).collect()
}

/// Difference between two pictures, RMS over RMS of the second.
fn difference(picture: &[f32], other: &[f32]) -> f64 {
    error::relative_rmse(&colours(picture), &colours(other))
}

/// Slopes of the light 1 + <slope, direction>, a channel each.
fn slopes() -> [Vec3; 3] {
    [Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.8, 0.1, -0.3), Vec3::new(-0.5, -0.4, 0.6)]
}

/// Light that is linear in the direction: 1 + <slope, direction>.
fn linear_light() -> Environment {
    let slopes = slopes().map(host_vector);
    let radiance = |direction| glam::Vec3::from(slopes.map(|slope| 1.0 + slope.dot(direction)));
    Environment::from_function([256, 128], radiance).unwrap()
}

/// Colour of each pixel of pictures in closed form, the albedo grey of 0.5 undone.
fn lit_by_linear_light(images: &SeenImages, settings: &OcclusionSettings, spread: Spread) -> Vec<[f64; 3]> {
    let [width, height] = images.size;
    let albedos = gpu::texture(images.size, Rgba32Float, &vec![0.5; (4 * width * height) as usize]);
    let picture = gathered(images.images(), settings, &albedos, &linear_light(), spread);
    let texel = |t: &[f32]| [0, 1, 2].map(|c| 2.0 * f64::from(t[c]));
    picture.chunks_exact(4).map(texel).collect()
}

#[test]
fn linear_light_on_what_is_open_has_its_closed_form() {
    // A ball before nothing. With a bias of 1 nothing rises over its tangent planes.
    let ball = |origin: Vec3, direction: Vec3| {
        let along = origin.dot(direction);
        let within = along * along - origin.dot(origin) + 1.0;
        (within > 0.0).then(|| {
            let way = -along - within.sqrt();
            (way, (origin + direction * way).normalised())
        })
    };
    let open = OcclusionSettings { bias: 1.0, ..OcclusionSettings::new(0.5) };
    for (name, camera) in cameras(Vec3::new(1.0, 2.0, 2.5), Vec3::default(), 1.2) {
        let images = seen::seen(camera, [96, 96], &ball);
        for spread in [Spread::Cosine, Spread::Even, Spread::Lights] {
            let error = |settings| {
                let (mut worst, mut squares, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
                let pixels = lit_by_linear_light(&images, &settings, spread);
                for (found, surface) in pixels.iter().zip(&images.surfaces) {
                    let Some((_, normal)) = *surface else {
                        assert_eq!(*found, [0.0; 3]);
                        continue;
                    };
                    for (value, slope) in found.iter().zip(slopes()) {
                        // (1/pi) times the integral of (1 + <s, d>) <n, d> over the hemisphere.
                        let error = value - (1.0 + 2.0 / 3.0 * slope.dot(normal));
                        worst = worst.max(error.abs());
                        squares += error * error;
                        count += 1.0;
                    }
                }
                (worst, (squares / count).sqrt())
            };
            let (worst, _) = error(OcclusionSettings { samples: 256, side: 1, ..open });
            let (_, few) = error(open);
            let (_, unblurred) = error(OcclusionSettings { side: 1, ..open });
            println!(
                "{name} {spread:?}: 256 directions off by {worst:.4} at most, 8 by {unblurred:.4}, 8 of 8x8 pixels by {few:.4}"
            );
            // Half of the lights are below the horizon, and none knows the cosine: more noise.
            let most = if spread == Spread::Lights { 0.05 } else { 0.02 };
            assert!(worst < 0.02 && few < most && few < unblurred, "{worst} {few} {unblurred}");
        }
    }
}

#[test]
fn a_wall_takes_the_light_of_its_half() {
    // The wall is the plane x = 0, seen from x > 0, on the floor y = 0.
    let surface = |origin: Vec3, direction: Vec3| {
        let (wall, floor) = (-origin.x / direction.x, -origin.y / direction.y);
        let wall = (direction.x < 0.0 && wall > 0.0).then_some((wall, Vec3::new(1.0, 0.0, 0.0)));
        let floor = (direction.y < 0.0 && floor > 0.0).then_some((floor, Vec3::new(0.0, 1.0, 0.0)));
        [wall, floor].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let place = Vec3::new(0.13, 0.0, 0.0);
    for (name, camera) in cameras(Vec3::new(5.0, 6.0, 0.8), place, 3.5).into_iter().skip(1) {
        let images = seen::seen(camera, [384, 384], &surface);
        for spread in [Spread::Cosine, Spread::Even] {
            let at = images.reference.project(place).unwrap();
            let side = f64::from(images.size[0]);
            let pixel =
                (0.5 * (1.0 - at[1]) * side) as usize * side as usize + (0.5 * (1.0 + at[0]) * side) as usize;
            let found = lit_by_linear_light(&images, &seen::many(20.0), spread)[pixel];
            // Of what an open floor has, 1 + 2/3 <s, y>: integrals of 1, y and x times y over the quarter of the sphere with
            // x > 0, over pi.
            let open = slopes().map(|s| 1.0 + 2.0 / 3.0 * s.y);
            let expected = slopes().map(|s| 0.5 + s.y / 3.0 + 2.0 * s.x / (3.0 * PI));
            let shares = [found, expected].map(|light| [0, 1, 2].map(|c| light[c] / open[c]));
            println!("{name} {spread:?}: shares {:.4?}, expected {:.4?}", shares[0], shares[1]);
            assert!((0..3).all(|c| (shares[0][c] - shares[1][c]).abs() < 0.03), "{shares:?}");
        }
    }
}

/// Cones with 8 directions, by both angles, against 16 of the competitor. Most of the error against rays is of the screen, and of
/// both; noise is the difference to what a method becomes with very many directions.
#[test]
fn cones_of_8_directions_are_no_worse_than_16_look_ups() {
    let mut noises = Vec::new();
    for scene in ambient_scenes().unwrap() {
        let (name, standing) = (scene.name, Standing::new(&scene, [112, 84]));
        for file in ["forest.exr", "sunset.exr"] {
            let (map, host_map) = low_passed(file);
            let light = cones::lit(&host_map, 33, false);
            let truth = standing.truth(&map);
            let of = |samples| OcclusionSettings { samples, ..standing.settings };
            let albedos = &standing.geometry.albedos;
            let ssdo =
                |samples, spread| gathered(standing.images(), &of(samples), albedos, &host_map, spread);
            let cones = |samples, method| standing.drawn(&light.cones, method, false, &of(samples));
            let screen = ssdo(MANY, Spread::Cosine);
            // Error against rays, noise, and error against what the screen sees.
            let measured = |what: &str, picture: &[f32], limit: &[f32]| {
                let error = standing::error(picture, &truth);
                let [noise, of_screen] = [limit, &screen].map(|other| difference(picture, other));
                println!(
                    "{name} {file} {what}: {error:.4}, noise {noise:.4}, {of_screen:.4} from what the screen sees"
                );
                (error, noise)
            };
            let looked_up = [8, 16]
                .map(|samples| measured(&format!("SSDO {samples}"), &ssdo(samples, Spread::Cosine), &screen));
            measured("SSDO, many", &screen, &screen);
            let even = measured("SSDO 16, even", &ssdo(16, Spread::Even), &ssdo(MANY, Spread::Even));
            let by_cones = [Method::Cones, Method::ExactCones]
                .map(|method| measured(&format!("{method:?} 8"), &cones(8, method), &cones(MANY, method)));
            for (error, _) in by_cones {
                assert!(error <= looked_up[1].0, "{error} {}", looked_up[1].0);
            }
            assert!(looked_up[1].1 < looked_up[0].1, "{looked_up:?}");
            noises.push([by_cones[0].1, by_cones[1].1, looked_up[1].1, even.1]);
        }
    }
    let all = |i: usize| noises.iter().map(|noise| noise[i] * noise[i]).sum::<f64>().sqrt();
    let [printed, exact, cosine, even] = [0, 1, 2, 3].map(all);
    println!("noise of all: cones {printed:.4} {exact:.4}, SSDO 16 {cosine:.4}, even {even:.4}");
    assert!(printed < cosine && exact < cosine && cosine < even, "{noises:?}");
}
