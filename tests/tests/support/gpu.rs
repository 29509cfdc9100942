// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests that need a device share: the device itself, probes of single shader functions,
//! bridges from the host's types to the references', and small scenes of the tests' own, which no
//! change of the gallery's art touches.
//!
//! `AIRLIGHT_MUTATE='FILE|OLD|NEW'` replaces text in a copy of the shaders before they are composed:
//! a test that still passes with a broken shader proves nothing.
#![allow(dead_code, clippy::unwrap_used)]

use airlight::core::{Camera, DepthRange, Light, PerspectiveView, Raster, Sky};
use airlight::data::{Mesh, TreeParameters, plane, torus, tree};
use airlight::scattering::{Medium, Rectification, Weighting};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Gpu, Lighting, Pass, Setting, Shaders, Stage, Texture};
use airlight_tests::linear;
use airlight_tests::reference::camera::{self, Camera as ReferenceCamera};
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec2, Vec3};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The device of this test binary.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| match pollster::block_on(Gpu::new()) {
        Ok(gpu) => gpu,
        Err(error) => panic!("{error}"),
    })
}

/// One test at a time: a software adapter shares the cores with the references, and both use all of them.
pub fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The shaders under test: those that ship, or a mutation of them.
pub fn shaders() -> &'static Shaders {
    static SHADERS: OnceLock<Shaders> = OnceLock::new();
    SHADERS.get_or_init(|| match std::env::var("AIRLIGHT_MUTATE") {
        Ok(_) => Shaders::from_library(Library::from_directory(copy_of_wgsl().path()).unwrap()),
        Err(_) => Shaders::builtin(),
    })
}

/// The folder `wgsl` of the repository.
pub fn wgsl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl")
}

/// A copy of the shaders in a folder of its own, with `AIRLIGHT_MUTATE` applied.
pub fn copy_of_wgsl() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for system in airlight_wgsl::SYSTEMS {
        std::fs::create_dir_all(folder.path().join(system.name).join("passes")).unwrap();
        std::fs::write(folder.path().join(system.name).join("permutations"), system.permutations).unwrap();
    }
    let modules = airlight_wgsl::MODULES.iter().map(|module| (module.file, module.source));
    for (file, source) in modules.chain(airlight_wgsl::PASSES.iter().map(|pass| (pass.file, pass.source))) {
        let mut source = source.to_owned();
        if let Ok(mutation) = std::env::var("AIRLIGHT_MUTATE") {
            let [name, old, new] = mutation.split('|').collect::<Vec<_>>().try_into().expect("FILE|OLD|NEW");
            if name == file {
                assert!(source.contains(old), "{file} has no `{old}`");
                source = source.replace(old, new);
            }
        }
        std::fs::write(folder.path().join(file), source).unwrap();
    }
    folder
}

/// A piece of WGSL that is run once for each record of the input.
pub struct Probe<'a> {
    /// `#import` lines and helper functions.
    pub head: &'a str,
    /// Statements: `input(k)` is the k-th number of the record, `output(k, x)` sets one of the result.
    pub body: &'a str,
    /// Numbers in a record.
    pub inputs: usize,
    /// Numbers in a result.
    pub outputs: usize,
}

impl Probe<'_> {
    /// The results, one after the other.
    pub fn run(&self, values: &[f32]) -> Vec<f32> {
        self.run_with(values, &[])
    }

    /// Like `run` with textures besides, which `head` declares.
    pub fn run_with(&self, values: &[f32], textures: &[(&str, &Texture)]) -> Vec<f32> {
        assert!(values.len().is_multiple_of(self.inputs) && !values.is_empty());
        let records = values.len() / self.inputs;
        let folder = copy_of_wgsl();
        let text = format!(
            "{head}
            @group(#{{GROUP}}) @binding(0) var<storage, read> inputs: array<f32>;
            @group(#{{GROUP}}) @binding(1) var<storage, read_write> outputs: array<f32>;
            var<private> record: u32;
            fn input(index: u32) -> f32 {{ return inputs[record * {inputs}u + index]; }}
            fn output(index: u32, value: f32) {{ outputs[record * {outputs}u + index] = value; }}
            @compute @workgroup_size(64)
            fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
                if id.x >= {records}u {{ return; }}
                record = id.x;
                {body}
            }}",
            head = self.head,
            body = self.body,
            inputs = self.inputs,
            outputs = self.outputs,
        );
        std::fs::write(folder.path().join("core/passes/probe.wgsl"), text).unwrap();
        let shaders = Shaders::from_library(Library::from_directory(folder.path()).unwrap());
        let pass = match Pass::compute_with(gpu(), &shaders, "core/probe", &Definitions::new()) {
            Ok(pass) => pass,
            Err(error) => panic!("the probe does not compose: {error}"),
        };
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let from = Buffer::with_bytes(gpu(), &bytes, wgpu::BufferUsages::STORAGE);
        let to = Buffer::storage(gpu(), (records * self.outputs * 4) as u64);
        let mut resources = vec![("inputs", (&from).into()), ("outputs", (&to).into())];
        resources.extend(textures.iter().map(|(name, texture)| (*name, (*texture).into())));
        let bound = pass.bind(gpu(), &resources).unwrap();
        let mut encoder = gpu().encoder();
        pass.dispatch(&mut encoder, &bound, [records as u32, 1, 1]);
        gpu().submit(encoder).unwrap();
        let mut results = to.read_floats(gpu()).unwrap();
        results.truncate(records * self.outputs);
        results
    }
}

/// A vector of the references.
pub fn vector(v: Vec3) -> linear::Vec3 {
    linear::Vec3::from(v.to_array())
}

/// A vector of the host's.
pub fn host_vector(v: linear::Vec3) -> Vec3 {
    Vec3::from(v.to_array().map(|x| x as f32))
}

/// A matrix of the references.
pub fn matrix(m: Mat4) -> linear::Mat4 {
    linear::Mat4::from(m.to_cols_array())
}

/// A matrix of the host's, rounded from f64.
pub fn host_matrix(m: linear::Mat4) -> Mat4 {
    Mat4::from_cols_array_2d(&m.columns.map(|column| column.map(|x| x as f32)))
}

/// The uniform of a reference's camera, rounded to f32.
pub fn host_camera(camera: &ReferenceCamera, viewport: [u32; 2]) -> Camera {
    Camera {
        clip_from_world: host_matrix(camera.clip_from_world),
        world_from_clip: host_matrix(camera.world_from_clip),
        eye: host_vector(camera.eye),
        near_depth: 1.0 - camera.far_depth as f32,
        viewport: Vec2::new(viewport[0] as f32, viewport[1] as f32),
        far_depth: camera.far_depth as f32,
        projection: 0,
    }
}

/// The f64 camera of a view, composed as the host composes it but in f64 throughout.
pub fn reference_camera(view: &PerspectiveView, viewport: [u32; 2]) -> ReferenceCamera {
    let (eye, target) = (vector(view.eye), vector(view.target));
    let level = (target - eye).normalised().cross(linear::Vec3::new(0.0, 1.0, 0.0)).length() >= 1e-4;
    let up = if level { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
    ReferenceCamera::perspective(&camera::View {
        eye,
        target,
        up: up.into(),
        fov_y: f64::from(view.field_of_view).to_radians(),
        aspect: f64::from(viewport[0]) / f64::from(viewport[1]),
        near: f64::from(view.near),
        far: f64::from(view.far),
        reversed: view.depth == DepthRange::Reversed,
    })
}

/// The reference's medium. Albedos of the tests are grey.
pub fn reference_medium(medium: &Medium) -> reference::Medium {
    reference::Medium {
        extinction: f64::from(medium.extinction),
        albedo: f64::from(medium.albedo.x),
        g: f64::from(medium.g),
        distance_limit: f64::from(medium.distance_limit),
    }
}

/// The reference's light.
pub fn reference_light(light: &Light) -> reference::Light {
    reference::Light {
        direction: vector(light.direction),
        radiance: light.radiance.to_array().map(f64::from),
    }
}

/// The reference's rectification of a camera and light, with the slices that the GPU computed.
pub fn read_back(
    camera: &ReferenceCamera,
    light: Vec3,
    distance_limit: f32,
    map: &Rectification,
) -> reference::Rectification {
    let [width, height, _] = map.rectified.size();
    let mut rectification = reference::Rectification::new(
        camera,
        vector(light),
        f64::from(distance_limit),
        width as usize,
        height as usize,
    );
    let texels = map.slices.read(gpu()).unwrap();
    for (slice, texel) in rectification.slices.iter_mut().zip(texels.chunks_exact(4)) {
        slice.theta_min = f64::from(texel[0]);
        slice.theta_max = f64::from(texel[1]);
        slice.r_max = f64::from(texel[2]);
    }
    rectification
}

/// The passes that draw meshes.
pub fn raster() -> &'static Raster {
    static RASTER: OnceLock<Raster> = OnceLock::new();
    RASTER.get_or_init(|| Raster::new(gpu(), shaders()).unwrap())
}

/// A scene of the tests.
pub struct TestScene {
    /// What is drawn.
    pub mesh: Mesh,
    /// The camera.
    pub view: PerspectiveView,
    /// Unit vector TOWARDS the light.
    pub light: Vec3,
    /// Radiance of the light.
    pub radiance: Vec3,
    /// The air.
    pub medium: Medium,
}

impl TestScene {
    /// The scene on the GPU.
    pub fn stage(&self, viewport: [u32; 2], shadow_map: [u32; 2]) -> Stage {
        let sky = Sky::new(Vec3::new(0.2, 0.3, 0.5), Vec3::splat(0.4), Vec3::splat(0.1));
        let setting = Setting {
            mesh: &self.mesh,
            view: self.view.into(),
            light: Lighting::directional(self.light, self.radiance),
            light_texture: None,
            cascades: None,
            sky,
            medium: self.medium,
            samples: 1,
        };
        Stage::new(gpu(), raster(), &setting, viewport, shadow_map).unwrap()
    }
}

/// A torus over a plane; the light stands beside the picture.
pub fn torus_over_plane() -> TestScene {
    let mut mesh = plane(Vec2::splat(12.0), 2).with_albedo(Vec3::new(0.4, 0.4, 0.35));
    let ring = torus(1.2, 0.4, 48, 20).with_albedo(Vec3::new(0.7, 0.25, 0.15));
    mesh.append(&ring.transformed(Mat4::from_translation(Vec3::Y * 1.8) * Mat4::from_rotation_x(1.0)));
    TestScene {
        mesh,
        view: PerspectiveView {
            eye: Vec3::new(-2.5, 1.8, 5.0),
            target: Vec3::new(0.1, 1.5, 0.0),
            field_of_view: 45.0,
            near: 0.1,
            far: 20.0,
            depth: DepthRange::Forward,
        },
        light: Vec3::new(0.55, 0.75, -0.4).normalize(),
        radiance: Vec3::new(12.0, 11.0, 10.0),
        medium: Medium::new(0.08, Vec3::splat(0.95), 0.3, 20.0).unwrap(),
    }
}

/// A small tree with 600 leaves; the light stands behind it, in the picture.
pub fn small_tree() -> TestScene {
    let mut mesh = plane(Vec2::splat(16.0), 2).with_albedo(Vec3::new(0.2, 0.25, 0.1));
    mesh.append(&tree(&TreeParameters {
        seed: 7,
        leaves: 600,
        leaf_length: 0.4,
        ..TreeParameters::default()
    }));
    TestScene {
        mesh,
        view: PerspectiveView {
            eye: Vec3::new(0.4, 1.4, 8.0),
            target: Vec3::new(0.0, 3.2, 0.0),
            field_of_view: 60.0,
            near: 0.1,
            far: 30.0,
            depth: DepthRange::Forward,
        },
        light: Vec3::new(0.12, 0.5, -0.86).normalize(),
        radiance: Vec3::new(14.0, 12.0, 9.0),
        medium: Medium::new(0.05, Vec3::splat(0.95), 0.5, 30.0).unwrap(),
    }
}

/// Gives the reference's view of a scene, and the rectification that the GPU made.
fn with_scene<T>(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    of: impl FnOnce(&reference::Scene<'_>, &reference::Rectification) -> T,
) -> T {
    let [width, height, _] = stage.pictures.depth.size();
    let camera = reference_camera(view, [width, height]);
    let rectification = read_back(&camera, stage.light.direction, stage.medium.distance_limit, map);
    let depth = stage.pictures.depth.read(gpu()).unwrap();
    let scene = reference::Scene {
        camera: &camera,
        light: reference_light(&stage.light),
        medium: reference_medium(&stage.medium),
        depth: &depth,
        width: width as usize,
        height: height as usize,
    };
    of(&scene, &rectification)
}

/// The exact f64 picture of a scene over the rectified map that the GPU made.
pub fn exact_picture(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    stride: usize,
) -> reference::Picture {
    let rectified = map.rectified.read(gpu()).unwrap();
    with_scene(stage, view, map, |scene, rectification| {
        reference::picture(scene, rectification, &rectified, stride)
    })
}

/// The view ray of a pixel.
pub struct PixelRay {
    /// Unit vector.
    pub direction: linear::Vec3,
    /// Metres to the surface or the limit.
    pub distance: f64,
    /// The rows on both sides of it.
    pub rows: [usize; 2],
    /// Share of the second of them.
    pub share: f64,
}

impl PixelRay {
    /// The row next to it.
    pub fn nearest(&self) -> usize {
        self.rows[usize::from(self.share >= 0.5)]
    }

    /// Where it ends in row `j`. `extinction`: 1/m.
    pub fn end(&self, map: &reference::Rectification, j: usize, extinction: f64) -> reference::RowEnd {
        map.row_end(j, self.direction, self.distance, extinction)
    }
}

/// What `of` says of every pixel's ray and of the rectification that the GPU made, row after row.
pub fn of_pixels<T: Send>(
    stage: &Stage,
    view: &PerspectiveView,
    map: &Rectification,
    of: impl Fn(&reference::Rectification, &PixelRay) -> T + Sync,
) -> Vec<T> {
    with_scene(stage, view, map, |scene, rectification| {
        let pixel = |x: usize, y: usize| {
            let (direction, distance) = scene.view_ray(x, y);
            let (first, second, share) =
                rectification.rows(rectification.frame.polar_direction(direction).phi);
            of(rectification, &PixelRay { direction, distance, rows: [first, second], share })
        };
        let row = |y: usize| (0..scene.width).map(|x| pixel(x, y)).collect::<Vec<_>>();
        airlight_tests::parallel::rows(scene.height, row).into_iter().flatten().collect()
    })
}

/// A storage texture of one layer with values.
pub fn texture(size: [u32; 2], format: wgpu::TextureFormat, values: &[f32]) -> Texture {
    let texture = Texture::storage(gpu(), size, format);
    texture.write(gpu(), values).unwrap();
    texture
}

/// The name of a weighting, for messages.
pub fn weighting_name(weighting: Weighting) -> &'static str {
    match weighting {
        Weighting::Average => "average",
        Weighting::Transmittance => "transmittance",
    }
}

/// Uniform random numbers, the same from run to run.
pub struct Random(pub u64);

impl Random {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In [low, high), the logarithm uniform.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// 0 .. count − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// All 32 bits.
    pub fn bits(&mut self) -> u32 {
        (self.unit() * 4_294_967_296.0) as u32
    }

    /// A unit vector.
    pub fn direction(&mut self) -> linear::Vec3 {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            let v = linear::Vec3::from(v);
            if (0.01..1.0).contains(&v.length()) {
                return v.normalised();
            }
        }
    }

    /// A perspective camera: any direction, any depth convention.
    pub fn camera(&mut self, aspect: f64) -> ReferenceCamera {
        let eye = self.direction() * self.between(0.0, 30.0);
        ReferenceCamera::perspective(&camera::View {
            eye,
            target: eye + self.direction(),
            up: self.direction(),
            fov_y: self.between(0.2, 2.2),
            aspect,
            near: 0.1,
            far: if self.unit() < 0.3 { f64::INFINITY } else { self.between(5.0, 200.0) },
            reversed: self.unit() < 0.5,
        })
    }

    /// A direction towards a light: in the picture, behind, at a corner, an edge or the middle of it,
    /// at right angles to the view, or anywhere.
    pub fn light(&mut self, camera: &ReferenceCamera) -> linear::Vec3 {
        let inside = [self.between(-1.0, 1.0), self.between(-1.0, 1.0)];
        match self.below(10) {
            0 | 1 => camera.ray(inside),
            2 | 3 => -camera.ray(inside),
            4 => camera.ray([inside[0].signum(), inside[1]]),
            5 => camera.ray([inside[0].signum(), inside[1].signum()]),
            6 if inside[0] > 0.0 => camera.forward,
            6 => -camera.forward,
            7 => camera.up,
            _ => self.direction(),
        }
    }
}

/// The clip matrix of an orthographic light: `half` metres to every side of `centre`.
pub fn light_matrix(towards: linear::Vec3, centre: linear::Vec3, half: f64, far_depth: f64) -> linear::Mat4 {
    let l = towards.normalised();
    let other = linear::Vec3::from(if l.y.abs() > 0.9 { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] });
    let right = other.cross(l).normalised();
    let up = l.cross(right);
    let row = |d: linear::Vec3, s: f64, shift: f64| [s * d.x, s * d.y, s * d.z, shift - s * d.dot(centre)];
    let along = if far_depth > 0.5 { -0.5 } else { 0.5 };
    linear::Mat4::from_rows([
        row(right, 1.0 / half, 0.0),
        row(up, 1.0 / half, 0.0),
        row(l, along / half, 0.5),
        [0.0, 0.0, 0.0, 1.0],
    ])
}

/// The uniform of a light of that matrix.
pub fn host_light(
    towards: linear::Vec3,
    clip_from_world: linear::Mat4,
    far_depth: f64,
    radiance: Vec3,
) -> Light {
    Light {
        clip_from_world: host_matrix(clip_from_world),
        world_from_clip: host_matrix(clip_from_world.inverse().unwrap()),
        direction: host_vector(towards.normalised()),
        far_depth: far_depth as f32,
        radiance,
        kind: 0,
        position: Vec3::ZERO,
        radius: 0.0,
        spot_cosines: Vec2::ZERO,
        reserved_a: 0.0,
        reserved_b: 0.0,
    }
}

/// A spot beside the picture that shines through the torus.
pub fn spot() -> Lighting {
    Lighting::Spot {
        position: Vec3::new(3.5, 4.5, -2.0),
        target: Vec3::new(0.0, 1.2, 0.2),
        outer_degrees: 32.0,
        inner_degrees: 20.0,
        intensity: Vec3::new(120.0, 100.0, 80.0),
        radius: 0.05,
    }
}

/// A point light inside the ring, in the picture.
pub fn point() -> Lighting {
    Lighting::Point {
        position: Vec3::new(0.3, 2.2, -1.2),
        intensity: Vec3::new(60.0, 50.0, 40.0),
        radius: 0.05,
    }
}
