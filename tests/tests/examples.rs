// SPDX-License-Identifier: MIT OR Apache-2.0
//! The examples that are programs: `examples/wgpu` from nothing but the files that its README lists, against its blessed
//! picture and against the same scene through the host.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/snapshot.rs"]
mod snapshot;

use airlight::Stage;
use airlight::core::{DepthRange, PerspectiveView, Raster, Sky, Tonemap};
use airlight::data::Mesh;
use airlight::scattering::{Composite, Medium, Prefiltered, Settings, Visibility};
use airlight::stage::{Lighting, Setting};
use airlight_example_wgpu as example;
use glam::Vec3;
use gpu::{gpu, shaders};
use snapshot::{Picture, assert_picture};
use std::path::{Path, PathBuf};

const SIZE: [u32; 2] = [320, 180];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn bunny() -> PathBuf {
    repository().join("host/assets/bunny.obj")
}

/// The picture of the example, whose shaders are those of a folder that holds what its README says and nothing else.
fn picture_of_the_example() -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let readme = std::fs::read_to_string(repository().join("examples/wgpu/README.md")).unwrap();
    let mut copied = 0;
    for word in readme.split_whitespace().filter(|word| word.ends_with(".wgsl")) {
        let to = folder.path().join(word);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(repository().join("wgsl/flat").join(word), to).unwrap();
        copied += 1;
    }
    assert_eq!(copied, 7, "the README lists the flat files");
    let picture = example::render(folder.path(), &bunny(), SIZE).unwrap();
    Picture { size: SIZE, pixels: picture.into_raw() }
}

/// The same scene through the host, with its own raster, its own shadow map and its own composition of the modules.
fn picture_of_the_host() -> Picture {
    let scene = example::scene(&bunny(), SIZE).unwrap();
    let [positions, normals, albedos] =
        [0, 1, 2].map(|part| scene.mesh.vertices.iter().map(|vertex| vertex[part]).collect());
    let mesh = Mesh { positions, normals, albedos, indices: scene.mesh.indices };
    let view = PerspectiveView {
        eye: example::EYE,
        target: example::TARGET,
        field_of_view: example::FIELD_OF_VIEW,
        near: example::NEAR,
        far: example::FAR,
        depth: DepthRange::Forward,
    };
    let color = |color: [f32; 4]| Vec3::new(color[0], color[1], color[2]);
    let air = scene.medium;
    let setting = Setting {
        mesh: &mesh,
        view: view.into(),
        light: Lighting::directional(scene.light.direction, scene.light.radiance),
        light_texture: None,
        cascades: None,
        sky: Sky::new(color(scene.sky.zenith), color(scene.sky.horizon), color(scene.sky.ground)),
        medium: Medium::new(air.extinction, air.albedo, air.g, air.distance_limit).unwrap(),
        samples: 1,
    };
    let raster = Raster::new(gpu(), shaders()).unwrap();
    let stage = Stage::new(gpu(), &raster, &setting, SIZE, [2048, 2048]).unwrap();
    let inputs = stage.inputs();
    let visibility = Visibility::Rank { bits: 12 };
    let settings = Settings { map: [1024, 1024], visibility, ..Settings::default() };
    let method = Prefiltered::new(gpu(), shaders(), settings, SIZE).unwrap();
    let bound = method.bind(gpu(), &inputs).unwrap();
    let mut encoder = gpu().encoder();
    method.record(&mut encoder, &bound);
    gpu().submit(encoder).unwrap();
    let composite = Composite::new(gpu(), shaders()).unwrap();
    let composed = composite.run(gpu(), &inputs, &stage.pictures.surface, &method.scattered).unwrap();
    let tonemap = Tonemap::new(gpu(), shaders()).unwrap();
    Picture { size: SIZE, pixels: tonemap.run(gpu(), &composed, scene.exposure).unwrap() }
}

#[test]
fn plain_wgpu_draws_what_the_host_draws() {
    let _turn = gpu::turn();
    let picture = picture_of_the_example();
    let (structure, mean) = picture.similarity(&picture_of_the_host());
    assert!(
        structure > 0.98 && mean < 1.0,
        "structural similarity {structure:.4}, mean difference {mean:.2}"
    );
    assert_picture("example_wgpu", &gpu().description(), &picture, 0.995);
}
