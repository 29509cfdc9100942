// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass that lights surfaces, with mean directions that are given, in light whose cones have a closed form.

use crate::gpu::{Random, gpu, shaders};
use crate::seen::{cameras, seen};
use airlight::Texture;
use airlight::ambient::{ConeLight, ConeLightForm, Method, ShadePass};
use airlight::data::Environment;
use airlight_tests::linear::Vec3;
use std::f64::consts::{FRAC_PI_2, PI};
use wgpu::TextureFormat::Rgba32Float;

const SIZE: [u32; 2] = [40, 30];
/// How radiance of each channel grows with the direction, from 1 in the middle.
const SLOPES: [[f64; 3]; 3] = [[0.6, 0.0, -0.7], [0.0, 0.9, 0.0], [-0.5, -0.6, 0.5]];

/// Mean radiance of a cone, weighted by the cosine, where radiance is 1 + <slope, direction>: the mean cosine is
/// 2/3 (1 - cos^3 a) / sin^2 a.
fn exact_cone(slope: [f64; 3], axis: Vec3, angle: f64) -> f64 {
    let cosine = 2.0 / 3.0 * (1.0 - angle.cos().powi(3)) / angle.sin().powi(2);
    1.0 + cosine * axis.dot(Vec3::from(slope))
}

/// Straight between the eight angles that are kept; below the first it is the first.
fn cone(slope: [f64; 3], axis: Vec3, angle: f64) -> f64 {
    let step = PI / 16.0;
    let layer = (angle / step - 1.0).clamp(0.0, 7.0);
    let low = layer.floor().min(6.0);
    let [a, b] = [low, low + 1.0].map(|layer| exact_cone(slope, axis, step * (layer + 1.0)));
    a + (b - a) * (layer - low)
}

struct Pixel {
    normal: Vec3,
    albedo: [f64; 3],
    mean: Vec3,
    open: f64,
}

fn radiance(pixel: &Pixel, method: Method, printed: bool, channel: usize) -> f64 {
    let length = pixel.mean.length();
    let axis = pixel.mean.normalised();
    let facing = axis.dot(pixel.normal).max(0.0);
    let share = if printed { pixel.open * facing } else { 2.0 * pixel.open * length * facing };
    let slope = SLOPES[channel];
    let light = match method {
        Method::Occlusion => pixel.open * cone(slope, pixel.normal, FRAC_PI_2),
        Method::Normals => share * cone(slope, axis, FRAC_PI_2),
        Method::Cones => share * cone(slope, axis, FRAC_PI_2 * (1.0 - (2.0 * length - 1.0).max(0.0))),
        Method::ExactCones => share * cone(slope, axis, (2.0 * length - 1.0).clamp(0.0, 1.0).acos()),
    };
    pixel.albedo[channel] * light
}

#[test]
fn every_method_has_the_radiance_of_its_formula() {
    // A disc that leaves the corners of the picture empty.
    let surface = |origin: Vec3, direction: Vec3| {
        let way = -origin.y / direction.y;
        let place = origin + direction * way;
        (place.length() < 1.0).then(|| (way, Vec3::new(0.0, 1.0, 0.0)))
    };
    let [_, (_, camera), _] = cameras(Vec3::new(0.0, 3.0, 0.1), Vec3::default(), 1.0);
    let mut images = seen(camera, SIZE, &surface);
    let mut random = Random(21);
    let pixels: Vec<Pixel> = (0..SIZE[0] * SIZE[1])
        .map(|_| {
            let normal = random.direction();
            let bent = (normal * 1.5 + random.direction()).normalised();
            let half = |value: f64| f64::from(half::f16::from_f64(value));
            let mean = Vec3::from((bent * random.between(0.35, 0.97)).to_array().map(half));
            let albedo = [0; 3].map(|_| f64::from(random.unit() as f32));
            Pixel { normal, albedo, mean, open: half(random.unit()) }
        })
        .collect();
    let image = |texel: &dyn Fn(&Pixel) -> [f64; 4]| {
        let values: Vec<f32> = pixels.iter().flat_map(texel).map(|value| value as f32).collect();
        let texture = Texture::storage(gpu(), SIZE, Rgba32Float);
        texture.write(gpu(), &values).unwrap();
        texture
    };
    let with = |vector: Vec3, last: f64| [vector.x, vector.y, vector.z, last];
    images.normals = image(&|pixel| with(pixel.normal * 3.0, 1.0));
    let albedos = image(&|pixel| with(Vec3::from(pixel.albedo), 1.0));
    let bent = image(&|pixel| with(pixel.mean, pixel.open));
    let map = Environment::from_function([512, 256], |d| {
        let direction = Vec3::from(d.to_array().map(f64::from));
        glam::Vec3::from(SLOPES.map(|slope| (1.0 + Vec3::from(slope).dot(direction)) as f32))
    });
    let light =
        ConeLight::new(gpu(), shaders(), &map.unwrap(), ConeLightForm { side: 65, sampled: false }).unwrap();
    for method in [Method::Occlusion, Method::Normals, Method::Cones, Method::ExactCones] {
        for printed in [false, true] {
            let shade = ShadePass::new(gpu(), shaders(), method, printed).unwrap();
            let mut encoder = gpu().encoder();
            let picture =
                shade.record(gpu(), &mut encoder, images.images(), &albedos, &bent, &light.cones).unwrap();
            gpu().submit(encoder).unwrap();
            let texels = picture.read(gpu()).unwrap();
            let (mut worst, mut drawn) = (0.0_f64, 0);
            for ((texel, pixel), surface) in texels.chunks_exact(4).zip(&pixels).zip(&images.surfaces) {
                if surface.is_none() {
                    assert_eq!(texel, [0.0; 4]);
                    continue;
                }
                assert_eq!(texel[3], 1.0);
                drawn += 1;
                for (channel, value) in texel[..3].iter().enumerate() {
                    let expected = radiance(pixel, method, printed, channel);
                    worst = worst.max((f64::from(*value) - expected).abs() / expected.max(1.0));
                }
            }
            println!("{method:?} printed {printed}: {worst:.1e} of radiance");
            assert!(drawn > 500 && drawn < 1100, "{drawn}");
            // Straight between texels 1/32 apart in the square, in which directions turn up to thrice as fast: 1.2 * 9 / 8 / 32²,
            // and kept as halves, twice, all of it times a share of up to 2.
            assert!(worst < 5e-3, "{method:?} printed {printed}: {worst}");
        }
    }
}
