// SPDX-License-Identifier: MIT OR Apache-2.0
//! Soft shadows between sheets: penumbras of half-planes have the width that geometry says, at any tilt and distance, and a ball's
//! shadow is that of a ball.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;
#[path = "support/sheets.rs"]
mod sheets;
#[path = "support/soft.rs"]
mod soft;

use airlight::core::{Camera, DepthRange, Light, OrthographicView};
use airlight::data::cloud;
use airlight::splatting::{
    LightTransport, SheetFrame, SheetInputs, SheetLighting, SheetPicture, SheetSettings, SoftPlane,
    SoftShadows, Splats, SplattingError,
};
use airlight_tests::reference::splatting::Kernel;
use airlight_tests::reference::splatting::area_light::{Square, meets_ball};
use glam::{DVec3, Vec3};
use gpu::{Probe, gpu, shaders};
use probing::{f, hold, worst};
use sheets::{colored, metres, shoot, splats};
use soft::{Lit, crossings, vector};

fn parallel(direction: Vec3, height: f32, side: u32) -> Camera {
    let view = OrthographicView {
        eye: -60.0 * direction,
        target: Vec3::ZERO,
        height,
        near: 0.0,
        far: 120.0,
        depth: DepthRange::Forward,
    };
    Camera::orthographic(&view, [side; 2]).unwrap()
}

fn sun(towards: Vec3) -> Light {
    Light::directional(towards, Vec3::ONE, Vec3::splat(-9.0), Vec3::splat(9.0)).unwrap()
}

fn lamp(position: Vec3) -> Light {
    Light::point(position, Vec3::ONE, 0.05, 0.05, 100.0).unwrap()
}

#[test]
fn kernels_of_blurs_have_the_variance_that_was_asked_for() {
    let probe = Probe {
        head: "#import airlight::splatting::blur::{blur_sums, blur_weight}",
        body: "let v = input(0u); let sums = blur_sums(v);
               for (var i = 0u; i < 14u; i++) { output(i, blur_weight(v, sums, i)); }",
        inputs: 1,
        outputs: 14,
    };
    let values: Vec<f32> = (0..=1600).map(|i| i as f32 / 100.0).collect();
    let found = probe.run(&values);
    let moments = |kernel: &[f32]| {
        let both = |i: usize| if i == 0 { 1.0 } else { 2.0 };
        let sum = |power: i32| -> f64 {
            kernel.iter().enumerate().map(|(i, w)| both(i) * f(*w) * (i as f64).powi(power)).sum()
        };
        [sum(0), sum(2)]
    };
    let all: Vec<[f64; 2]> = found.chunks_exact(14).map(moments).collect();
    assert!(
        found.iter().all(|weight| *weight >= 0.0) && found.chunks_exact(14).all(|kernel| kernel[13] == 0.0)
    );
    hold("sum of weights", worst(all.iter().map(|m| (m[0], 1.0))), 5e-7);
    let variances = all.iter().zip(&values).map(|(m, v)| (m[1] / f(*v).max(1.0), f(*v) / f(*v).max(1.0)));
    hold("variance of kernels, relative", worst(variances), 2e-6);
}

/// Corners of the box of the half-plane scenes.
fn corners() -> Vec<Vec3> {
    let side = |bit: i32, [low, high]: [f32; 2]| if bit & 1 == 1 { high } else { low };
    (0..8)
        .map(|i| Vec3::new(side(i, [-4.0, 4.0]), side(i >> 1, [-8.0, 0.5]), side(i >> 2, [-3.0, 3.0])))
        .collect()
}

/// Half-planes across y: height of each, and the range of x that it covers.
fn half_planes(all: &[(f64, [f64; 2])]) -> impl Fn(DVec3, DVec3) -> Option<[f64; 2]> {
    move |origin, way| {
        let place = |(height, [low, high]): &(f64, [f64; 2])| {
            let place = (height - origin.y) / way.y;
            let x = (origin + way * place).x;
            (x >= *low && x < *high).then_some(place)
        };
        all.iter().filter_map(place).reduce(f64::min).map(|place| [place; 2])
    }
}

/// Of points at a depth below a half-plane at `height`, the place on the light at which its edge at `edge` is seen: slope or metres.
fn place_on_light(light: &Light, point: DVec3, height: f64, edge: f64) -> f64 {
    if light.kind == 0 {
        let towards = light.direction.as_dvec3();
        return (point.x - edge) / (height - point.y) + towards.x / towards.y;
    }
    let middle = light.position.as_dvec3();
    let along = (height - point.y) / (middle.y - point.y);
    (point.x + (middle.x - point.x) * along - edge) / along
}

#[test]
fn penumbras_of_half_planes_have_their_width_at_any_tilt() {
    let _turn = gpu::turn();
    let (side, count) = (160, 64);
    let cases = [
        (sun(Vec3::Y), 10.0_f32),
        (sun(Vec3::new(0.1, 1.0, 0.2)), 10.0),
        (lamp(Vec3::new(0.4, 6.0, 0.0)), 2.4),
    ];
    for (light, size) in cases {
        let width =
            if light.kind == 0 { 2.0 * (f64::from(size).to_radians() / 2.0).tan() } else { f64::from(size) };
        for angle in [0.0_f32, 60.0, 120.0] {
            for axis in [Vec3::X, Vec3::Z] {
                let (sine, cosine) = angle.to_radians().sin_cos();
                let view = axis * sine - Vec3::Y * cosine;
                let lit = Lit::new(light, view, count, &corners(), side, &SoftShadows::new(size));
                let heights = lit.heights(half_planes(&[(0.0, [-1e9, 0.0])]));
                let depths = [1.5, 4.0, 7.0];
                let at = depths.map(|depth| lit.sheet_of(Vec3::new(0.0, -depth as f32, 0.0)));
                for ((depth, sheet), [shares, _]) in depths.iter().zip(at).zip(lit.shadows(&heights, &at)) {
                    let points = lit.points(lit.middle(sheet));
                    let of_depth = points.iter().zip(&shares).filter(|(point, _)| {
                        (-point.y / depth - 1.0).abs() < 0.25 && point.z.abs() < 1.5 && point.x.abs() < 3.0
                    });
                    let profile: Vec<(f64, f64)> = of_depth
                        .map(|(point, share)| (place_on_light(&light, *point, 0.0, 0.0), f(*share)))
                        .collect();
                    let [low, middle, high] = crossings(&profile, width);
                    let found = (high - low) / (0.8 * width);
                    let shift = middle / width;
                    println!(
                        "light {}, eye at {angle} about {axis:?}, {depth} m behind: width {found:.3}, middle off by {shift:.3} of it",
                        light.kind
                    );
                    // An edge of heights lies between texels: up to half of one, as it is seen on the light.
                    let texel = f64::from(lit.plane.light.texel.max_element());
                    let far = light.position.as_dvec3().y;
                    let texel =
                        if light.kind == 0 { texel / depth } else { texel * far * (far + depth) / depth };
                    let most = 0.05 + 0.6 * texel / width;
                    assert!((found - 1.0).abs() < 0.1 && shift.abs() < most, "{angle} {axis} {depth}");
                }
            }
        }
    }
}

#[test]
fn two_half_planes_have_a_penumbra_each() {
    let _turn = gpu::turn();
    let light = sun(Vec3::Y);
    let width = 2.0 * 5.0_f64.to_radians().tan();
    for angle in [0.0_f32, 60.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let view = Vec3::new(0.0, -cosine, sine);
        let lit = Lit::new(light, view, 64, &corners(), 160, &SoftShadows::new(10.0));
        let heights = lit.heights(half_planes(&[(0.0, [-1e9, -1.0]), (-4.0, [1.0, 1e9])]));
        let sheet = lit.sheet_of(Vec3::new(0.0, -7.0, 0.0));
        let [shares, _] = &lit.shadows(&heights, &[sheet])[0];
        let points = lit.points(lit.middle(sheet));
        for (edge, height) in [(-1.0, 0.0), (1.0, -4.0)] {
            let own = points.iter().zip(shares).filter(|(point, _)| {
                (point.y + 7.0).abs() < 0.7
                    && point.z.abs() < 1.5
                    && point.x * edge > 0.0
                    && point.x.abs() < 2.5
            });
            let profile: Vec<(f64, f64)> =
                own.map(|(point, share)| (place_on_light(&light, *point, height, edge), f(*share))).collect();
            let [low, middle, high] = crossings(&profile, width);
            let found = (high - low).abs() / (0.8 * width);
            println!(
                "eye at {angle}, edge at {height} m: width {found:.3}, middle off by {:.3} of it",
                middle / width
            );
            assert!((found - 1.0).abs() < 0.1 && (middle / width).abs() < 0.05, "{angle} {edge}");
        }
    }
}

#[test]
fn a_slab_of_splats_has_the_same_penumbra() {
    let _turn = gpu::turn();
    let kernel = Kernel::new(0.7, 2.25);
    let step = 2.25 / 4000.0;
    let fourth = |i: u32| {
        let r = (f64::from(i) + 0.5) * step;
        r.powi(4) * kernel.value(r * r) * step
    };
    let own = 4.0 / 3.0 * std::f64::consts::PI * (0..4000).map(fourth).sum::<f64>();
    let transfer = colored([Vec3::ONE; 2]);
    let settings = SheetSettings { count: 64, light_size: [128; 2], ..SheetSettings::default() };
    for (light, size) in [(sun(Vec3::Y), 14.0_f32), (lamp(Vec3::new(0.0, 60.0, 0.0)), 16.0)] {
        for layer in [30.0_f32, 14.0] {
            // One layer of voxels up to x = 0.
            let volume = metres([40, 40, 24], |place| {
                let inside = place.x < 0.0 && (place.y + 20.0 - layer - 0.5).abs() < 0.1;
                f32::from(u8::from(inside)) * 0.5
            });
            let splats = splats(&volume);
            let height = f64::from(layer) + 0.5 - 20.0;
            for angle in [0.0_f32, 60.0, 120.0] {
                for (thick, dense) in [(0.4_f32, false), (12.0, true)] {
                    let (sine, cosine) = angle.to_radians().sin_cos();
                    let view = Vec3::new(0.0, -cosine, sine);
                    let soft = SoftShadows::new(size);
                    let settings = SheetSettings { transport: LightTransport::Soft(soft), ..settings };
                    let lighting = SheetLighting::new(thick);
                    let frame = SheetFrame { camera: parallel(view, 30.0, 8), light, lighting };
                    let size = [8; 2];
                    let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
                    let picture = SheetPicture::new(gpu(), shaders(), inputs, settings, size).unwrap();
                    let sheets = picture.set(gpu(), &frame).unwrap();
                    let mut encoder = gpu().encoder();
                    picture.record(gpu(), &mut encoder).unwrap();
                    gpu().submit(encoder).unwrap();
                    let shadow = picture.shadow().read(gpu()).unwrap();
                    let hull: Vec<Vec3> = (0..8)
                        .map(|i| {
                            let side = |bit: i32, half: f32| if i >> bit & 1 == 1 { half } else { -half };
                            Vec3::new(side(0, 21.75), side(1, 21.75), side(2, 13.75))
                        })
                        .collect();
                    let plane = SoftPlane::new(&soft, &frame, &sheets, &hull, [128; 2]).unwrap();
                    let lit = Lit { light, sheets, plane };
                    let points = lit.points(lit.middle(64));
                    // Shares of what the slab takes where it is whole.
                    let whole = 1.0 - f64::from(-0.5 * thick).exp();
                    // The tilted end of the sheets under the slab's edge.
                    let target = points
                        .iter()
                        .map(|p| (p.x.hypot(p.z), p.y))
                        .reduce(|a, b| if a.0 < b.0 { a } else { b });
                    let target = target.unwrap().1;
                    let own_depth = height - target;
                    let profile: Vec<(f64, f64)> = points
                        .iter()
                        .zip(shadow.chunks_exact(4))
                        .filter(|(point, _)| {
                            (point.y - target).abs() < 9.0 && point.z.abs() < 6.0 && point.x.abs() < 14.0
                        })
                        .map(|(point, texel)| {
                            (place_on_light(&light, *point, height, 0.0), 1.0 - (1.0 - f(texel[0])) / whole)
                        })
                        .collect();
                    let way = light.position.as_dvec3().y;
                    // The kernel's own blur, seen on the light.
                    let (width, seen) = if light.kind == 0 {
                        (2.0 * (f64::from(soft.size).to_radians() / 2.0).tan(), own.sqrt() / own_depth)
                    } else {
                        (f64::from(soft.size), own.sqrt() * (way - target) / own_depth)
                    };
                    let [low, middle, high] = crossings(&profile, width);
                    let expected = 2.563 * ((0.312 * width).powi(2) + seen * seen).sqrt();
                    let (found, shift) = ((high - low) / expected, middle / width);
                    println!(
                        "light {}, slab {own_depth} m before, eye at {angle}, extinction {thick}: width {found:.3}, off by {shift:.3}",
                        light.kind
                    );
                    // Sheets of a dense slab shade each other's edge as if by chance, and where they are tilted light leaks
                    // where layers meet: a known failure, which fails here once it is none.
                    let right = (found - 1.0).abs() < 0.1 && shift.abs() < 0.1;
                    assert!(right != dense, "{layer} {angle} {thick}");
                }
            }
        }
    }
}

/// Greatest and root mean square difference of a ball's shadow from what rays say; least share of the light.
fn ball(lit: &Lit, square: &Square, depth: f32) -> [f64; 3] {
    let surfaces = |origin: DVec3, way: DVec3| {
        let along = -origin.dot(way);
        let square = 1.0 - (origin.length_squared() - along * along);
        (square > 0.0).then(|| [along - square.sqrt(), along + square.sqrt()])
    };
    let sheet = lit.sheet_of(Vec3::new(0.0, -depth, 0.0));
    let [shares, _] = &lit.shadows(&lit.heights(surfaces), &[sheet])[0];
    let points = lit.points(lit.middle(sheet));
    let (mut most, mut squares, mut least, mut count) = (0.0_f64, 0.0, 1.0_f64, 0.0);
    for (index, (point, share)) in points.iter().zip(shares).enumerate() {
        // A quarter of the texels will do.
        if index % 4 > 0 || point.y > -1.2 || point.x.hypot(point.z) > 2.2 {
            continue;
        }
        let ball = |origin, way, limit| meets_ball(vector(DVec3::ZERO), 1.0, origin, way, limit);
        let error = f(*share) - square.seen(vector(*point), 24, ball);
        most = most.max(error.abs());
        squares += error * error;
        least = least.min(f(*share));
        count += 1.0;
    }
    [most, (squares / count).sqrt(), least]
}

#[test]
fn a_ball_casts_the_shadow_of_a_ball() {
    let _turn = gpu::turn();
    let far =
        (sun(Vec3::Y), 10.0_f32, Square::Far { towards: vector(DVec3::Y), angle: 10.0_f64.to_radians() });
    let middle = vector(DVec3::Y * 9.0);
    let near = (lamp(Vec3::Y * 9.0), 1.5, Square::Near { middle, facing: vector(DVec3::Y), side: 1.5 });
    let side = |bit: i32, [low, high]: [f32; 2]| if bit & 1 == 1 { high } else { low };
    let corners: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new(side(i, [-2.2, 2.2]), side(i >> 1, [-5.0, 1.1]), side(i >> 2, [-2.2, 2.2])))
        .collect();
    let mut leaks = Vec::new();
    for (light, size, square) in [far, near] {
        for angle in [0.0_f32, 60.0, 120.0] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let view = Vec3::new(0.0, -cosine, sine);
            for depth in if angle == 120.0 { vec![4.0] } else { vec![2.5, 4.0] } {
                let of = |deepest: f32| {
                    let soft = SoftShadows { deepest, ..SoftShadows::new(size) };
                    ball(&Lit::new(light, view, 64, &corners, 128, &soft), &square, depth)
                };
                let [most, mean, least] = of(1e6);
                let [thin, thin_mean, thin_least] = of(0.0);
                println!(
                    "light {}, eye at {angle}, {depth} m behind: {most:.3} at most, {mean:.4} RMS, umbra {least:.4}; \
                     not filled {thin:.3}, {thin_mean:.4}, {thin_least:.4}",
                    light.kind
                );
                // The greatest differences are those of a Gaussian from a ramp, and of heights from an edge between texels.
                assert!(
                    most < 0.12 && mean < 0.03 && least < 0.005,
                    "{angle} {depth}: {most} {mean} {least}"
                );
                assert!(thin_mean >= mean && thin_least >= least, "{angle} {depth}");
                leaks.push(thin_least);
            }
        }
    }
    // Of the surface alone the umbra is not dark.
    assert!(leaks.iter().any(|leak| *leak > 0.02), "{leaks:?}");
}

#[test]
fn a_point_of_light_casts_hard_shadows() {
    let _turn = gpu::turn();
    let mut volume = cloud([24, 14, 20], 5);
    volume.values.iter_mut().for_each(|value| *value /= 3.0);
    let bounds = volume.bounds();
    let splats = splats(&volume);
    let transfer = colored([Vec3::ONE, Vec3::new(0.9, 0.5, 0.2)]);
    for degrees in [35.0_f32, 140.0] {
        let angle = degrees.to_radians();
        let way = Vec3::new(angle.sin(), -0.2, -angle.cos()).normalize();
        let view = Vec3::NEG_Z;
        let margin = 0.05 * (bounds.max - bounds.min).max_element();
        let light = Light::directional(-way, Vec3::ONE, bounds.min - margin, bounds.max + margin).unwrap();
        let height = 1.2 * (bounds.max - bounds.min).max_element();
        let frame =
            SheetFrame { camera: parallel(view, height, 40), light, lighting: SheetLighting::new(4.0) };
        let settings = SheetSettings { count: 32, light_size: [128; 2], ..SheetSettings::default() };
        let hard = shoot(&splats, &transfer, settings, &frame);
        let shot = |size: f32| {
            let transport = LightTransport::Soft(SoftShadows::new(size));
            shoot(&splats, &transfer, SheetSettings { transport, ..settings }, &frame)
        };
        let error = |soft: &sheets::Shot| {
            let pairs = hard.picture.iter().zip(&soft.picture).filter(|(a, _)| **a < 0.9999);
            let (squares, all) =
                pairs.fold((0.0, 0.0), |(s, a), (x, y)| (s + f(x - y).powi(2), a + f(*x).powi(2)));
            (squares / all).sqrt()
        };
        let (none, some) = (error(&shot(0.0)), error(&shot(20.0)));
        println!("light at {degrees}: a point of light is off by {none:.5}, one of 20 degrees by {some:.4}");
        assert!(none < 0.01 && some > 2.0 * none, "{degrees}: {none} {some}");
    }
}

#[test]
fn nonsense_leaves_no_hole() {
    let _turn = gpu::turn();
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -3e38, 1e30, -1e30, 0.0];
    for light in [sun(Vec3::Y), lamp(Vec3::Y * 6.0)] {
        for size in [0.0, if light.kind == 0 { 60.0 } else { 1e6 }] {
            let lit = Lit::new(light, Vec3::new(0.0, -0.5, 0.8), 40, &corners(), 40, &SoftShadows::new(size));
            let first = (0..1600).map(|i| wild[(i * 7) % 8]).collect();
            let last = (0..1600).map(|i| wild[(i * 5 + i / 40) % 8]).collect();
            for pictures in lit.shadows(&[first, last], &[0, 17, 39]) {
                let sound = |share: &f32| (0.0..=1.0).contains(share);
                assert!(pictures.iter().flatten().all(sound), "{light:?} {size}");
            }
        }
    }
    let mut volume = cloud([12, 14, 10], 5);
    for (place, value) in [f32::NAN, f32::INFINITY, -1.0, 3e38].into_iter().enumerate() {
        volume.values[700 + place] = value;
    }
    let splats = splats(&volume);
    for extinction in [0.0, 1e6] {
        let transport = LightTransport::Soft(SoftShadows::new(30.0));
        let settings =
            SheetSettings { count: 20, light_size: [40; 2], transport, ..SheetSettings::default() };
        let lighting = SheetLighting::new(extinction);
        let frame = SheetFrame { camera: parallel(Vec3::NEG_Z, 3.0, 16), light: sun(Vec3::X), lighting };
        assert!(shoot(&splats, &colored([Vec3::ONE; 2]), settings, &frame).is_sound());
    }
}

#[test]
fn impossible_lights_are_refused() {
    let splats = Splats::new(gpu(), shaders(), &metres([4; 3], |_| 0.5), 0.0, None).unwrap();
    let transfer = colored([Vec3::ONE; 2]);
    let new = |soft: SoftShadows, side: u32| {
        let transport = LightTransport::Soft(soft);
        let settings =
            SheetSettings { count: 8, light_size: [side; 2], transport, ..SheetSettings::default() };
        let inputs = SheetInputs::new(std::slice::from_ref(&splats), &transfer);
        SheetPicture::new(gpu(), shaders(), inputs, settings, [8; 2])
    };
    let set = |soft: SoftShadows, light: Light| {
        let frame =
            SheetFrame { camera: parallel(Vec3::NEG_Z, 9.0, 8), light, lighting: SheetLighting::new(1.0) };
        new(soft, 16).unwrap().set(gpu(), &frame).map(|_| ())
    };
    assert!(matches!(new(SoftShadows::new(1.0), 6000), Err(SplattingError::Setting(_))));
    for soft in [
        SoftShadows::new(-1.0),
        SoftShadows::new(f32::NAN),
        SoftShadows::new(61.0),
        SoftShadows { filling: f32::NAN, ..SoftShadows::new(1.0) },
        SoftShadows { deepest: -1.0, ..SoftShadows::new(1.0) },
    ] {
        assert!(matches!(set(soft, sun(Vec3::Y)), Err(SplattingError::Setting(_))), "{soft:?}");
    }
    assert!(set(SoftShadows::new(1.0), sun(Vec3::Y)).is_ok());
    assert!(set(SoftShadows::new(61.0), lamp(Vec3::Y * 20.0)).is_ok());
    for place in [Vec3::ZERO, Vec3::Y * 2.0, Vec3::splat(f32::MAX)] {
        let light = Light { position: place, ..lamp(Vec3::Y) };
        assert!(
            matches!(set(SoftShadows::new(1.0), light), Err(SplattingError::LightBehind { .. })),
            "{place}"
        );
    }
}
