// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests that need a device share: the device itself, probes of single shader functions, and bridges from the host's
//! types to the references'; random numbers and small scenes.
//!
//! `AIRLIGHT_MUTATE='FILE|OLD|NEW'` replaces text in a copy of the shaders before they are composed:
//! a test that still passes with a broken shader proves nothing.
//!
//! `AIRLIGHT_CAPTURE=FOLDER` records every pass with its inputs and results, see `airlight::capture`.
#![allow(dead_code, clippy::unwrap_used)]

#[path = "gpu/random.rs"]
mod random;
#[path = "gpu/scenes.rs"]
mod scenes;

// No test needs all of them.
#[allow(unused_imports)]
pub use {random::Random, scenes::*};

use airlight::capture::Recorder;
use airlight::core::{Camera, DepthRange, Light, PerspectiveView};
use airlight::scattering::{Medium, Rectification, Weighting};
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Gpu, Pass, Shaders, Texture};
use airlight_tests::linear;
use airlight_tests::reference::camera::{self, Camera as ReferenceCamera};
use airlight_tests::reference::scattering as reference;
use glam::{Mat4, Vec2, Vec3};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

static GPU: OnceLock<Gpu> = OnceLock::new();
static RECORDER: OnceLock<Arc<Recorder>> = OnceLock::new();

/// The device of this test binary.
pub fn gpu() -> &'static Gpu {
    thread_local!(static SETTLED: Settled = const { Settled });
    SETTLED.with(|_| ());
    GPU.get_or_init(|| match pollster::block_on(Gpu::new()) {
        Ok(gpu) => match std::env::var_os("AIRLIGHT_CAPTURE") {
            None => gpu,
            Some(folder) => {
                let recorder = Arc::new(Recorder::new(&gpu, Path::new(&folder)).unwrap());
                gpu.watched_by(RECORDER.get_or_init(|| recorder).clone())
            }
        },
        Err(error) => panic!("{error}"),
    })
}

/// Notes where passes are recorded that the snapshot `name` holds what was read last.
pub fn note_snapshot(name: &str) {
    if let Some(recorder) = RECORDER.get() {
        recorder.snapshot(name).unwrap();
    }
}

/// Waits at the end of a test's thread until the driver's own thread has nothing left to do.
///
/// Lavapipe frees dropped pipelines on that thread and after a submission has signalled its end. The device lives in a `static`,
/// so nothing else would wait for it, and a process that exits meanwhile crashes in the destructors of LLVM.
struct Settled;

impl Drop for Settled {
    fn drop(&mut self) {
        let Some(gpu) = GPU.get() else { return };
        // The first frees what was dropped before, the second signals after that.
        gpu.queue.submit([]);
        gpu.queue.submit([]);
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    }
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
