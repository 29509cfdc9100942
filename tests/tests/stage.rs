// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights, cameras and shadow maps of the stage: pictures of a plate over a floor against the f64 radiance of every
//! pixel, whose shadow is found by a ray through the plate.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::core::{Cascades, DepthRange, LightError, OrthographicView, PerspectiveView, Sky, View};
use airlight::data::{LightImage, Mesh, plane};
use airlight::scattering::Medium;
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Lighting, Pass, Setting, Shaders, Stage, StageError};
use airlight_tests::linear;
use airlight_tests::reference::light::Light;
use glam::{Mat4, Vec2, Vec3};
use gpu::{gpu, vector};
use std::f64::consts::PI;

const PICTURE: [u32; 2] = [120, 80];
const MAP: [u32; 2] = [2048, 2048];
const ALBEDO: Vec3 = Vec3::new(0.6, 0.5, 0.3);
/// The plate: x and z from -HALF to HALF, at this height.
const HALF: f64 = 1.4;
const HEIGHT: f64 = 1.5;
const FAR: f32 = 40.0;

fn mesh() -> Mesh {
    let mut mesh = plane(Vec2::splat(16.0), 4);
    mesh.append(
        &plane(Vec2::splat(2.0 * HALF as f32), 1)
            .transformed(Mat4::from_translation(Vec3::Y * HEIGHT as f32)),
    );
    mesh.with_albedo(ALBEDO)
}

fn sky() -> Sky {
    Sky::new(Vec3::new(0.1, 0.2, 0.4), Vec3::new(0.3, 0.2, 0.2), Vec3::splat(0.05))
}

fn setting<'a>(mesh: &'a Mesh, view: View, light: Lighting) -> Setting<'a> {
    let medium = Medium::new(0.05, Vec3::splat(0.9), 0.2, FAR).unwrap();
    Setting { mesh, view, light, light_texture: None, cascades: None, sky: sky(), medium, samples: 1 }
}

fn stage(setting: &Setting<'_>) -> Stage {
    Stage::new(gpu(), gpu::raster(), setting, PICTURE, MAP).unwrap()
}

fn perspective(depth: DepthRange, far: f32) -> View {
    View::Perspective(PerspectiveView {
        eye: Vec3::new(1.0, 4.5, 7.5),
        target: Vec3::new(0.4, 0.3, 0.0),
        field_of_view: 50.0,
        near: 0.1,
        far,
        depth,
    })
}

/// An orthographic view whose rays pass its eye after `back` metres: where its eye lies is of no consequence.
fn orthographic(depth: DepthRange, back: f32) -> View {
    let (eye, target) = (Vec3::new(-6.0, 7.0, 4.0), Vec3::new(0.0, 0.5, 0.0));
    let shift = (target - eye).normalize() * back;
    View::Orthographic(OrthographicView {
        eye: eye + shift,
        target: target + shift,
        height: 7.0,
        near: 0.5 - back,
        far: FAR - back,
        depth,
    })
}

fn views() -> [(&'static str, View); 6] {
    [
        ("forward", perspective(DepthRange::Forward, FAR)),
        ("reversed", perspective(DepthRange::Reversed, FAR)),
        ("forward infinite", perspective(DepthRange::Forward, f32::INFINITY)),
        ("reversed infinite", perspective(DepthRange::Reversed, f32::INFINITY)),
        ("orthographic forward", orthographic(DepthRange::Forward, 0.0)),
        ("orthographic reversed", orthographic(DepthRange::Reversed, 15.0)),
    ]
}

/// Origin and unit direction of the view ray through a position in pixels, from the words of the view.
fn view_ray(view: &View, x: f64, y: f64) -> (linear::Vec3, linear::Vec3) {
    let (width, height) = (f64::from(PICTURE[0]), f64::from(PICTURE[1]));
    let (eye, target) = (vector(view.eye()), vector(view.target()));
    let forward = (target - eye).normalised();
    let right = forward.cross(linear::Vec3::new(0.0, 1.0, 0.0)).normalised();
    let up = right.cross(forward);
    let across = right * ((2.0 * x / width - 1.0) * width / height) + up * (1.0 - 2.0 * y / height);
    match view {
        View::Perspective(of) => {
            let tangent = (0.5 * f64::from(of.field_of_view).to_radians()).tan();
            (eye, (forward + across * tangent).normalised())
        }
        View::Orthographic(of) => (eye + across * (0.5 * f64::from(of.height)), forward),
    }
}

/// Where a line meets the horizontal plane at `height`, and the parameter there.
fn at_height(from: linear::Vec3, direction: linear::Vec3, height: f64) -> (linear::Vec3, f64) {
    let t = (height - from.y) / direction.y;
    (from + direction * t, t)
}

/// How far a point of the plate's plane is inside the plate (positive) or outside.
fn inside_plate(point: linear::Vec3) -> f64 {
    HALF - point.x.abs().max(point.z.abs())
}

/// The surface that a view ray meets; none close to an edge.
fn surface(view: &View, x: f64, y: f64) -> Option<linear::Vec3> {
    let (origin, direction) = view_ray(view, x, y);
    assert!(direction.y < -0.05, "all rays of these views go down");
    let (top, _) = at_height(origin, direction, HEIGHT);
    let (floor, _) = at_height(origin, direction, 0.0);
    let edge = inside_plate(top).abs() > 0.08 && floor.x.abs().max(floor.z.abs()) < 7.9;
    edge.then_some(if inside_plate(top) > 0.0 { top } else { floor })
}

fn reference(light: &Lighting) -> Light {
    match *light {
        Lighting::Directional { towards, .. } => Light::Directional { towards: vector(towards).normalised() },
        Lighting::Spot { position, target, outer_degrees, inner_degrees, radius, .. } => Light::Spot {
            position: vector(position),
            axis: (vector(target) - vector(position)).normalised(),
            inner: f64::from(inner_degrees).to_radians(),
            outer: f64::from(outer_degrees).to_radians(),
            radius: f64::from(radius),
        },
        Lighting::Point { position, radius, .. } => {
            Light::Point { position: vector(position), radius: f64::from(radius) }
        }
    }
}

fn radiance(light: &Lighting) -> Vec3 {
    match *light {
        Lighting::Directional { radiance, .. } => radiance,
        Lighting::Spot { intensity, .. } | Lighting::Point { intensity, .. } => intensity,
    }
}

/// Whether the plate lies between a point of the floor and the light; none close to the edge of its shadow.
fn lit(light: &Light, point: linear::Vec3) -> Option<bool> {
    if point.y > 0.5 * HEIGHT {
        return Some(true);
    }
    let (through, _) = at_height(point, light.towards(point), HEIGHT);
    let inside = inside_plate(through);
    (inside.abs() > 0.08).then_some(inside < 0.0)
}

const SUN: Lighting =
    Lighting::Directional { towards: Vec3::new(0.5, 1.0, 0.3), radiance: Vec3::new(5.0, 4.0, 3.0) };
const SPOT: Lighting = Lighting::Spot {
    position: Vec3::new(-1.5, 5.0, 1.0),
    target: Vec3::new(0.5, 0.0, 0.0),
    outer_degrees: 32.0,
    inner_degrees: 20.0,
    intensity: Vec3::new(90.0, 80.0, 60.0),
    radius: 0.3,
};
const LAMP: Lighting = Lighting::Point {
    position: Vec3::new(0.3, 3.0, -0.2),
    intensity: Vec3::new(30.0, 24.0, 12.0),
    radius: 0.1,
};

/// Compares a picture with its reference: every pixel that is not on an edge, and their depths.
fn check(name: &str, setting: &Setting<'_>, texture: impl Fn(&Stage, linear::Vec3) -> [f64; 3]) {
    let stage = stage(setting);
    let picture = stage.pictures.surface.read(gpu()).unwrap();
    let depths = stage.pictures.depth.read(gpu()).unwrap();
    let light = reference(&setting.light);
    let strength = radiance(&setting.light).to_array().map(f64::from);
    let sky = sky();
    let ambient = (sky.zenith + sky.horizon) * 0.5;
    let matrix = gpu::matrix(stage.camera.clip_from_world);
    let (mut worst, mut depth_error, mut bright, mut dark) = ((0.0_f64, 0, 0), 0.0_f64, 0, 0);
    for i in 0..(PICTURE[0] * PICTURE[1]) as usize {
        let (x, y) = (i % PICTURE[0] as usize, i / PICTURE[0] as usize);
        let Some(point) = surface(&setting.view, x as f64 + 0.5, y as f64 + 0.5) else { continue };
        let [_, _, z, w] = matrix.apply_point(point);
        depth_error = depth_error.max((f64::from(depths[i]) - z / w).abs());
        let Some(lit) = lit(&light, point) else { continue };
        let factor = if lit { light.irradiance(point) * light.towards(point).y } else { 0.0 };
        if factor > 1e-3 {
            bright += 1;
        } else if !lit {
            dark += 1;
        }
        let color = texture(&stage, point);
        for channel in 0..3 {
            let irradiance = strength[channel] * color[channel] * factor;
            let exact = f64::from(ALBEDO[channel]) * (irradiance / PI + f64::from(ambient[channel]));
            let error = (f64::from(picture[4 * i + channel]) - exact).abs() / (exact + 0.05);
            if error > worst.0 {
                worst = (error, x, y);
            }
        }
    }
    println!(
        "{name}: {:.2e} at ({}, {}), depth {depth_error:.1e}, {bright} lit, {dark} dark",
        worst.0, worst.1, worst.2
    );
    assert!(bright > 500 && dark > 100, "{name}: {bright} lit and {dark} dark pixels prove too little");
    assert!(worst.0 < 2e-3, "{name}: {worst:?}");
    assert!(depth_error < 1e-6, "{name}: depth {depth_error:e}");
}

fn white(_: &Stage, _: linear::Vec3) -> [f64; 3] {
    [1.0; 3]
}

#[test]
fn every_light_falls_on_surfaces_in_every_camera() {
    let mesh = mesh();
    for (name, view) in views() {
        for (kind, light) in [("sun", SUN), ("spot", SPOT), ("lamp", LAMP)] {
            check(&format!("{kind}, {name}"), &setting(&mesh, view, light), white);
        }
        let cascades = Setting { cascades: Some(Cascades::new(3)), ..setting(&mesh, view, SUN) };
        check(&format!("cascades, {name}"), &cascades, white);
    }
}

#[test]
fn textures_colour_the_light_over_the_whole_map() {
    let mesh = mesh();
    // A ramp is its own linear interpolation.
    let image = LightImage::from_function([32, 16], |uv| Vec3::new(uv.x, uv.y, 1.0 - 0.5 * uv.x));
    let ramp = |stage: &Stage, point: linear::Vec3| {
        let [x, y, _, w] = gpu::matrix(stage.light.clip_from_world).apply_point(point);
        let (u, v) = (0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w);
        let held = |value: f64, count: f64| value.clamp(0.5 / count, 1.0 - 0.5 / count);
        let (u, v) = (held(u, 32.0), held(v, 16.0));
        [u, v, 1.0 - 0.5 * u]
    };
    for light in [SUN, SPOT] {
        let textured = Setting {
            light_texture: Some(&image),
            ..setting(&mesh, perspective(DepthRange::Forward, FAR), light)
        };
        check(&format!("textured {light}"), &textured, ramp);
    }
    let both = Setting {
        light_texture: Some(&image),
        cascades: Some(Cascades::new(4)),
        ..setting(&mesh, perspective(DepthRange::Reversed, FAR), SUN)
    };
    check("textured cascades", &both, ramp);
}

/// All samples of a multisampled depth texture, four a pixel.
fn samples(stage: &Stage) -> Vec<f32> {
    let folder = gpu::copy_of_wgsl();
    let text = "@group(#{GROUP}) @binding(0) var depth: texture_depth_multisampled_2d;
        @group(#{GROUP}) @binding(1) var<storage, read_write> samples: array<f32>;
        @compute @workgroup_size(8, 8)
        fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
            let size = textureDimensions(depth);
            if any(id.xy >= size) { return; }
            for (var s = 0; s < 4; s++) {
                samples[4u * (id.y * size.x + id.x) + u32(s)] = textureLoad(depth, id.xy, s);
            }
        }";
    std::fs::write(folder.path().join("core/passes/gather.wgsl"), text).unwrap();
    let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
    let pass = Pass::compute_with(gpu(), &shaders, "core/gather", &Definitions::new()).unwrap();
    let to = Buffer::storage(gpu(), u64::from(PICTURE[0] * PICTURE[1] * 16));
    let bound = pass.bind(gpu(), &[("depth", (&stage.pictures.depth).into()), ("samples", (&to).into())]);
    let mut encoder = gpu().encoder();
    pass.dispatch(&mut encoder, &bound.unwrap(), [PICTURE[0], PICTURE[1], 1]);
    gpu().submit(encoder).unwrap();
    // A texture of one sample a pixel is told apart before the device is asked.
    let single = self::stage(&Setting { samples: 1, ..setting(&mesh(), views()[0].1, SUN) });
    let error = pass.bind(gpu(), &[("depth", (&single.pictures.depth).into()), ("samples", (&to).into())]);
    assert!(error.err().unwrap().to_string().contains("multisampled"));
    to.read_floats(gpu()).unwrap()
}

#[test]
fn several_samples_keep_their_depths_and_resolve_their_colours() {
    let mesh = mesh();
    for (name, view) in views() {
        let single = stage(&setting(&mesh, view, SPOT));
        let several = stage(&Setting { samples: 4, ..setting(&mesh, view, SPOT) });
        assert_eq!(several.pictures.depth.raw.sample_count(), 4);
        assert!(several.pictures.depth.read(gpu()).is_err());
        let depths = samples(&several);
        let (one, four) =
            (single.pictures.surface.read(gpu()).unwrap(), several.pictures.surface.read(gpu()).unwrap());
        let matrix = gpu::matrix(single.camera.clip_from_world);
        let depth_at = |point: linear::Vec3| {
            let [_, _, z, w] = matrix.apply_point(point);
            z / w
        };
        let (mut inner, mut edges, mut spread) = (0, 0, 0);
        for y in 1..PICTURE[1] as usize - 1 {
            for x in 1..PICTURE[0] as usize - 1 {
                let i = y * PICTURE[0] as usize + x;
                // Depths of the plane of the surface at the corners of the pixel bound those of its samples.
                let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
                    .map(|(u, v)| surface(&view, x as f64 + u, y as f64 + v));
                let found = depths[4 * i..4 * i + 4].iter().map(|d| f64::from(*d));
                let same = |h: f64| corners.iter().all(|c| c.is_some_and(|c| (c.y - h).abs() < 1e-9));
                if same(0.0) || same(HEIGHT) {
                    let bounds = corners.iter().flatten().map(|c| depth_at(*c));
                    let low = bounds.clone().fold(f64::INFINITY, f64::min) - 3e-6;
                    let high = bounds.fold(f64::NEG_INFINITY, f64::max) + 3e-6;
                    assert!(
                        found.clone().all(|d| (low..=high).contains(&d)),
                        "{name} ({x}, {y}): {depths:?}"
                    );
                    spread += usize::from(found.clone().any(|d| (d - f64::from(depths[4 * i])).abs() > 1e-7));
                }
                let near: Vec<f32> = (0..9)
                    .map(|k| one[4 * ((y + k / 3 - 1) * PICTURE[0] as usize + x + k % 3 - 1)])
                    .collect();
                let (low, high) = near.iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
                let value = four[4 * i];
                assert!(
                    (low * 0.97..=high * 1.03).contains(&value),
                    "{name} ({x}, {y}): {value} {low} {high}"
                );
                // Two colours meet, and the samples' mean is neither of them.
                let [to_low, to_high] = [low, high]
                    .map(|end: f32| near.iter().chain([&value]).map(move |v| (v / end - 1.0).abs()));
                let either: Vec<f32> = to_low.zip(to_high).map(|(a, b)| a.min(b)).collect();
                if high - low < 0.05 * high {
                    inner += 1;
                } else if either[..9].iter().all(|error| *error < 0.05) {
                    edges += usize::from(either[9] > 0.1);
                }
            }
        }
        println!("{name}: {inner} inside, {edges} between, {spread} pixels of differing samples");
        assert!(inner > 1000 && edges > 15 && spread > 2000, "{name}: {inner} {edges} {spread}");
    }
}

#[test]
fn what_cannot_be_is_refused_and_said() {
    let mesh = mesh();
    let good = setting(&mesh, perspective(DepthRange::Forward, FAR), SUN);
    let image = LightImage::from_function([2, 2], |_| Vec3::ONE);
    let refused =
        |setting: Setting<'_>| Stage::new(gpu(), gpu::raster(), &setting, [16, 16], [16, 16]).err().unwrap();
    for samples in [0, 2, 8] {
        assert!(matches!(refused(Setting { samples, ..good }), StageError::Samples(_)));
    }
    let light = |setting| match refused(setting) {
        StageError::Light(error) => error,
        other => panic!("{other}"),
    };
    let cascades = Some(Cascades::new(2));
    assert_eq!(light(Setting { light: SPOT, cascades, ..good }), LightError::CascadesOfLocal);
    assert_eq!(light(Setting { light: LAMP, cascades, ..good }), LightError::CascadesOfLocal);
    assert_eq!(light(Setting { cascades: Some(Cascades::new(9)), ..good }), LightError::Cascades(9));
    let light_texture = Some(&image);
    assert_eq!(light(Setting { light: LAMP, light_texture, ..good }), LightError::TextureOfPoint);
    let Lighting::Spot { position, .. } = SPOT else { panic!("no spot") };
    let nowhere = Lighting::Spot {
        position,
        target: position,
        outer_degrees: 30.0,
        inner_degrees: 20.0,
        intensity: Vec3::ONE,
        radius: 0.1,
    };
    assert!(matches!(light(Setting { light: nowhere, ..good }), LightError::Aim { .. }));
    let wide = LightImage::from_function([9000, 1], |_| Vec3::ONE);
    assert!(matches!(refused(Setting { light_texture: Some(&wide), ..good }), StageError::Size(_)));
    // A point light stands in the way of nothing, and an empty scene is lit as well.
    let empty = Mesh::default();
    for light in [SUN, SPOT, LAMP] {
        assert!(Stage::new(gpu(), gpu::raster(), &setting(&empty, good.view, light), [8, 8], [8, 8]).is_ok());
    }
}
