// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of volumes and of particles that are lit through transmittance maps, against marches and sorted blending in f64.
//!
//! `--nocapture` prints what was measured.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/probing.rs"]
mod probing;

use airlight::core::{Camera, DepthRange, Light, OrthographicView, PerspectiveView, View};
use airlight::data::{Particle, Particles, Volume, burst, cloud};
use airlight::transmittance::{
    Composite, Form, MapSettings, MediumLighting, MediumView, ParticleBuffer, ParticlePicture, Precision,
    Reading, SplatFixed, TransmittanceError, TransmittanceMap, VolumePicture, VolumeTexture, Voxels,
};
use airlight::validate::Definitions;
use airlight::{Buffer, Pass, Resource, Texture};
use airlight_tests::error::relative_rmse;
use airlight_tests::linear;
use airlight_tests::reference::camera::Camera as ReferenceCamera;
use airlight_tests::reference::transmittance::{Ball, Grid, View as ReferenceView};
use glam::{Mat4, Vec3};
use gpu::{Random, gpu, matrix, shaders, vector};
use probing::hold;
use std::f64::consts::PI;

const SIZE: [u32; 2] = [64, 48];
const PIXELS: usize = 64 * 48;

/// A camera, a depth buffer and a light, on both sides.
struct Setting {
    camera: Camera,
    light: Light,
    lighting: MediumLighting,
    depth: Vec<f32>,
}

impl Setting {
    fn new(view: &View, towards: Vec3, bounds: [Vec3; 2], lighting: MediumLighting) -> Self {
        let camera = Camera::new(view, SIZE).unwrap();
        let light = Light::directional(towards, Vec3::new(3.0, 2.5, 2.0), bounds[0], bounds[1]).unwrap();
        Self { camera, light, lighting, depth: vec![camera.far_depth; PIXELS] }
    }

    fn with<T>(&self, of: impl FnOnce(&MediumView<'_>) -> T) -> T {
        let depth = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::R32Float);
        depth.write(gpu(), &self.depth).unwrap();
        let [camera, lighting] =
            [Buffer::uniform(gpu(), &self.camera), Buffer::uniform(gpu(), &self.lighting)];
        of(&MediumView { camera: &camera, lighting: &lighting, depth: &depth })
    }

    /// The volume through a map, or by the reference that the shader has.
    fn volume(&self, volume: &Volume, reading: Reading, map: Option<MapSettings>) -> Vec<f32> {
        let uploaded = VolumeTexture::new(gpu(), volume, 1.0, reading).unwrap();
        self.with(|view| {
            let mut encoder = gpu().encoder();
            let bound = if let Some(settings) = map {
                let map = TransmittanceMap::new(gpu(), settings, &self.light).unwrap();
                let voxels = Voxels::new(gpu(), shaders(), settings, reading).unwrap();
                voxels.record(&mut encoder, &voxels.bind(gpu(), &map, &uploaded).unwrap());
                let pass = VolumePicture::new(gpu(), shaders(), settings, false, reading).unwrap();
                let bound = pass.bind(gpu(), view, &map, &uploaded).unwrap();
                pass.record(&mut encoder, &bound);
                bound
            } else {
                let light = Buffer::uniform(gpu(), &self.light);
                let pass = VolumePicture::reference(gpu(), shaders(), reading).unwrap();
                let bound = pass.bind_reference(gpu(), view, &light, &uploaded).unwrap();
                pass.record(&mut encoder, &bound);
                bound
            };
            gpu().submit(encoder).unwrap();
            bound.picture.read(gpu()).unwrap()
        })
    }

    /// The particles, and the transmittances at their middles.
    fn particles(&self, particles: &Particles, settings: MapSettings) -> (Vec<f32>, Vec<f32>) {
        let map = TransmittanceMap::new(gpu(), settings, &self.light).unwrap();
        let buffer = ParticleBuffer::new(gpu(), particles).unwrap();
        let splat = SplatFixed::new(gpu(), shaders(), settings).unwrap();
        let splatted = splat.bind(gpu(), &map, &buffer).unwrap();
        self.with(|view| {
            let pass = ParticlePicture::new(gpu(), shaders(), settings, false).unwrap();
            let bound = pass.bind(gpu(), view, &map, &buffer).unwrap();
            let mut encoder = gpu().encoder();
            splat.record(&mut encoder, &splatted).unwrap();
            pass.record(gpu(), &mut encoder, &bound).unwrap();
            gpu().submit(encoder).unwrap();
            let mut lit = bound.transmittances.read_floats(gpu()).unwrap();
            lit.truncate(particles.list.len());
            (bound.picture.read(gpu()).unwrap(), lit)
        })
    }

    fn reference<T>(&self, of: impl FnOnce(&ReferenceView<'_>) -> T) -> T {
        let far = f64::from(self.camera.far_depth);
        let camera = ReferenceCamera::from_matrix(matrix(self.camera.clip_from_world), far).unwrap();
        of(&ReferenceView {
            camera: &camera,
            width: SIZE[0] as usize,
            height: SIZE[1] as usize,
            depth: &self.depth,
            distance_limit: f64::from(self.lighting.distance_limit),
            light: vector(self.light.direction),
            radiance: self.light.radiance.to_array().map(f64::from),
            albedo: self.lighting.albedo.to_array().map(f64::from),
            g: f64::from(self.lighting.g),
        })
    }

    /// The volume in f64, steps a quarter of a voxel.
    fn marched(&self, volume: &Volume, linear: bool) -> Vec<f64> {
        let grid = Grid {
            size: volume.size.map(|side| side as usize),
            values: &volume.values,
            unit_from_world: matrix(volume.world_from_unit).inverse().unwrap(),
            linear,
        };
        let bounds = volume.bounds();
        let centre = vector(0.5 * (bounds.min + bounds.max));
        let radius = 0.5 * f64::from((bounds.max - bounds.min).length());
        let step = 0.25 * f64::from(volume.voxel());
        self.reference(|view| view.marched(|p| grid.extinction(p), (centre, radius), step))
    }
}

fn lighting() -> MediumLighting {
    MediumLighting::new(Vec3::new(0.95, 0.9, 0.8), 0.4, 100.0).unwrap()
}

fn perspective(eye: Vec3, depth: DepthRange) -> View {
    PerspectiveView { eye, target: Vec3::ZERO, field_of_view: 40.0, near: 0.1, far: 60.0, depth }.into()
}

fn orthographic(eye: Vec3, height: f32, depth: DepthRange) -> View {
    OrthographicView { eye, target: Vec3::ZERO, height, near: 0.0, far: 20.0, depth }.into()
}

fn bounds(volume: &Volume) -> [Vec3; 2] {
    [volume.bounds().min, volume.bounds().max]
}

/// Radiance alone, or transmittance to the background alone.
fn split<T: Copy>(picture: &[T]) -> (Vec<T>, Vec<T>) {
    let radiance = picture.chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
    (radiance, picture.chunks_exact(4).map(|pixel| pixel[3]).collect())
}

fn a_cloud() -> (Volume, Setting) {
    let mut volume = cloud([40, 24, 32], 9);
    volume.world_from_unit = Mat4::from_rotation_y(0.6) * volume.world_from_unit;
    let view = perspective(Vec3::new(4.0, 2.0, 8.0), DepthRange::Forward);
    let setting = Setting::new(&view, Vec3::new(0.5, 0.8, 0.3), bounds(&volume), lighting());
    (volume, setting)
}

#[test]
fn a_cloud_through_maps_is_the_march_in_f64() {
    let _turn = gpu::turn();
    let (volume, setting) = a_cloud();
    let truth = setting.marched(&volume, true);
    let (radiance, through) = split(&truth);
    assert!(through.iter().filter(|t| **t < 0.1).count() > 200, "the cloud is thin");
    let check = |what: &str, map: Option<MapSettings>, budget: f64| {
        let (found, seen) = split(&setting.volume(&volume, Reading::Linear, map));
        hold(what, relative_rmse(&found, &radiance), budget);
        hold("transmittance to the background", relative_rmse(&seen, &through), 0.005);
        found
    };
    let brute = check("reference", None, 0.01);
    for (form, count, budget) in
        [(Form::Extinction, 4, 0.03), (Form::Extinction, 16, 0.015), (Form::Bounded, 4, 0.015)]
    {
        let settings = MapSettings::new(form, count, [128, 128]);
        let found = check(&format!("{form:?} {count}"), Some(settings), budget);
        hold("the same against the shader's reference", relative_rmse(&found, &brute), budget);
    }
}

#[test]
fn surfaces_cut_the_medium_before_any_camera() {
    let _turn = gpu::turn();
    let (volume, _) = a_cloud();
    let views = [
        perspective(Vec3::new(1.0, 3.0, 7.0), DepthRange::Reversed),
        orthographic(Vec3::new(-4.0, 3.0, 8.0), 6.0, DepthRange::Forward),
        orthographic(Vec3::new(-4.0, -3.0, 8.0), 6.0, DepthRange::Reversed),
        // Within the medium.
        perspective(Vec3::new(0.3, 0.2, 0.4), DepthRange::Forward),
    ];
    for view in views {
        let mut setting = Setting::new(&view, Vec3::new(-0.5, 0.8, 0.3), bounds(&volume), lighting());
        let whole = setting.volume(&volume, Reading::Nearest, None);
        let middle = setting.camera.clip_from_world * Vec3::new(-0.2, -0.2, 0.1).extend(1.0);
        for (i, depth) in setting.depth.iter_mut().enumerate() {
            if i % 64 < 40 {
                *depth = middle.z / middle.w;
            }
        }
        let found = setting.volume(&volume, Reading::Nearest, None);
        assert_eq!(found[160..256], whole[160..256]);
        let (radiance, through) = split(&found);
        let (expected, left) = split(&setting.marched(&volume, false));
        // Steps of a voxel that do not meet the voxels' faces.
        hold("radiance", relative_rmse(&radiance, &expected), 0.05);
        hold("transmittance", relative_rmse(&through, &left), 0.03);
        let cut = relative_rmse(&through, &split(&whole).1);
        assert!(cut > 0.1, "the surface cuts nothing: {cut}");
    }
}

#[test]
fn an_even_box_is_its_closed_form() {
    let _turn = gpu::turn();
    let extinction = 0.8_f64;
    let values = vec![extinction as f32; 512];
    let space = Mat4::from_translation(Vec3::NEG_ONE) * Mat4::from_scale(Vec3::splat(2.0));
    let volume = Volume::new([8; 3], values, space).unwrap();
    let view = orthographic(Vec3::new(0.0, 0.0, 5.0), 1.9, DepthRange::Forward);
    let setting = Setting::new(&view, Vec3::Y, bounds(&volume), lighting());
    let phase = airlight_tests::reference::phase::henyey_greenstein(0.0, 0.4);
    for (map, budget) in
        [(None, 1e-3), (Some(MapSettings::new(Form::Bounded, 4, [256, 256])), 5e-3)]
    {
        let found = setting.volume(&volume, Reading::Nearest, map);
        let mut worst = 0.0_f64;
        for (i, pixel) in found.chunks_exact(4).enumerate() {
            // Across the middle, where rays enter by the front.
            if (10..54).contains(&(i % 64)) {
                let below = 1.0 - 0.95 * (1.0 - 2.0 * ((i / 64) as f64 + 0.5) / 48.0);
                let through = (-2.0 * extinction).exp();
                let lit = (-extinction * below).exp() * (1.0 - through) * phase;
                worst = worst.max((f64::from(pixel[0]) / (0.95_f32 as f64 * 3.0 * lit) - 1.0).abs());
                worst = worst.max((f64::from(pixel[3]) / through - 1.0).abs());
            }
        }
        hold(&format!("{map:?}"), worst, budget);
    }
}

/// Thin, of albedo 1 and without preference: over the sphere it sends what it takes from the light.
#[test]
fn a_thin_medium_scatters_what_it_takes() {
    let _turn = gpu::turn();
    let mut volume = cloud([20, 12, 16], 3);
    let voxel: f64 = volume.world_from_unit.determinant().abs() as f64 / f64::from(20 * 12 * 16);
    volume.values.iter_mut().for_each(|value| *value *= 1e-3);
    let taken = 3.0 * voxel * volume.values.iter().map(|v| f64::from(*v)).sum::<f64>();
    let scatters = MediumLighting::new(Vec3::ONE, 0.0, 100.0).unwrap();
    for eye in [Vec3::new(0.0, 0.0, 9.0), Vec3::new(5.0, 6.0, -3.0)] {
        let view = orthographic(eye, 8.0, DepthRange::Forward);
        let setting = Setting::new(&view, Vec3::new(0.3, 1.0, 0.2), bounds(&volume), scatters);
        let pixel = (8.0 / 48.0_f64).powi(2);
        for map in [None, Some(MapSettings::new(Form::Extinction, 4, [64, 64]))] {
            let found = setting.volume(&volume, Reading::Nearest, map);
            let sent: f64 = found.chunks_exact(4).map(|p| f64::from(p[0]) * pixel * 4.0 * PI).sum();
            hold("power sent over power taken, less one", (sent / taken - 1.0).abs(), 0.02);
        }
    }
}

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
    let _turn = gpu::turn();
    let particles = burst(400, 5);
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
        let settings = MapSettings::new(Form::Extinction, 16, [256, 256]);
        let (found, lit) = setting.particles(&particles, settings);
        let exact = setting.reference(|view| view.at_middles(&balls));
        let given: Vec<f64> = lit.iter().map(|t| f64::from(*t)).collect();
        let off: f64 = exact.iter().zip(&given).map(|(a, b)| (a - b).abs()).sum::<f64>() / 400.0;
        hold("transmittance at the middles, mean", off, 0.03);
        let (radiance, through) = split(&found);
        let (same, left) = split(&setting.reference(|view| view.blended(&balls, &given)));
        let (truth, _) = split(&setting.reference(|view| view.blended(&balls, &exact)));
        hold("blended, light given", relative_rmse(&radiance, &same), 0.005);
        hold("blended, transmittance", relative_rmse(&through, &left), 0.005);
        hold("blended and lit", relative_rmse(&radiance, &truth), 0.05);
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
fn wild_particles_leave_no_trace_and_wild_depths_are_far() {
    let _turn = gpu::turn();
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
    let (mut volume, mut setting) = a_cloud();
    for (i, value) in volume.values.iter_mut().enumerate().step_by(7) {
        *value = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3e38, 60000.0][i / 7 % 5];
    }
    setting.depth[..64].fill(f32::NAN);
    for map in [None, Some(MapSettings::new(Form::Extinction, 4, [32, 32]))] {
        for reading in [Reading::Linear, Reading::Nearest] {
            let picture = setting.volume(&volume, reading, map);
            assert!(picture.iter().all(|v| v.is_finite()) && picture.iter().any(|v| *v > 0.01));
        }
    }
}

#[test]
fn compute_is_the_same_picture_and_it_goes_over_a_background() {
    let _turn = gpu::turn();
    let (volume, setting) = a_cloud();
    let drawn = setting.volume(&volume, Reading::Linear, None);
    let uploaded = VolumeTexture::new(gpu(), &volume, 1.0, Reading::Linear).unwrap();
    let definitions = Definitions::new().flag("REFERENCE").flag("LINEAR");
    let pass = Pass::compute_with(gpu(), shaders(), "transmittance/march_volume", &definitions).unwrap();
    let picture = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::Rgba16Float);
    let (light, sampler) = (Buffer::uniform(gpu(), &setting.light), airlight::Sampler::linear(gpu()));
    setting.with(|view| {
        let resources: [(&str, Resource<'_>); 8] = [
            ("camera", view.camera.into()),
            ("light", (&light).into()),
            ("lighting", view.lighting.into()),
            ("volume", (&uploaded.space).into()),
            ("extinction", (&uploaded.texture).into()),
            ("volume_sampler", (&sampler).into()),
            ("depth", view.depth.into()),
            ("picture", (&picture).into()),
        ];
        let bound = pass.bind(gpu(), &resources).unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [SIZE[0], SIZE[1], 1]);
        gpu().submit(encoder).unwrap();
    });
    let computed = picture.read(gpu()).unwrap();
    hold("compute against fragment", airlight_tests::error::max_absolute(&computed, &drawn), 1e-3);
    let surface = Texture::storage(gpu(), SIZE, wgpu::TextureFormat::Rgba16Float);
    surface.write(gpu(), &[0.5, f32::NAN, 2.0, 1.0].repeat(PIXELS)).unwrap();
    let over = Composite::new(gpu(), shaders()).unwrap().run(gpu(), &surface, &picture).unwrap();
    for (found, pixel) in over.read(gpu()).unwrap().chunks_exact(4).zip(computed.chunks_exact(4)) {
        for (i, behind) in [0.5, 0.0, 2.0].into_iter().enumerate() {
            let expected = pixel[i] + pixel[3] * behind;
            assert!((found[i] - expected).abs() <= 1e-3 * expected + 1e-6, "{found:?} {pixel:?}");
        }
    }
}

#[test]
fn impossible_pictures_are_errors() {
    let _turn = gpu::turn();
    for (albedo, g, limit, name) in [
        (1.1, 0.0, 10.0, "albedo"),
        (f32::NAN, 0.0, 10.0, "albedo"),
        (0.5, 1.0, 10.0, "g"),
        (0.5, 0.0, 0.0, "distance limit"),
        (0.5, 0.0, f32::INFINITY, "distance limit"),
    ] {
        let error = MediumLighting::new(Vec3::splat(albedo), g, limit).unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
    let (volume, setting) = a_cloud();
    let settings = MapSettings { precision: Precision::Half, ..MapSettings::new(Form::Extinction, 4, [8, 8]) };
    let map = TransmittanceMap::new(gpu(), settings, &setting.light).unwrap();
    let [nearest, linear] = [Reading::Nearest, Reading::Linear]
        .map(|reading| VolumeTexture::new(gpu(), &volume, 1.0, reading).unwrap());
    let lit = VolumePicture::new(gpu(), shaders(), settings, true, Reading::Linear).unwrap();
    let reference = VolumePicture::reference(gpu(), shaders(), Reading::Linear).unwrap();
    let other = MapSettings { coefficients: 8, ..settings };
    let eight = VolumePicture::new(gpu(), shaders(), other, false, Reading::Linear).unwrap();
    let particles = ParticlePicture::new(gpu(), shaders(), other, false).unwrap();
    let buffer = ParticleBuffer::new(gpu(), &burst(3, 1)).unwrap();
    setting.with(|view| {
        use TransmittanceError as E;
        assert!(lit.bind(gpu(), view, &map, &linear).is_ok());
        assert!(matches!(lit.bind(gpu(), view, &map, &nearest), Err(E::Pass(_))));
        assert!(matches!(eight.bind(gpu(), view, &map, &linear), Err(E::OtherMap { .. })));
        assert!(matches!(particles.bind(gpu(), view, &map, &buffer), Err(E::OtherMap { .. })));
        assert!(matches!(reference.bind(gpu(), view, &map, &linear), Err(E::Reference(_))));
        assert!(matches!(lit.bind_reference(gpu(), view, &map.light, &linear), Err(E::Reference(_))));
    });
}
