// SPDX-License-Identifier: MIT OR Apache-2.0
//! The examples: `examples/wgpu` from nothing but the files that its README lists, against its blessed picture and against
//! the same scene through the host; the shader of `examples/bevy` against Bevy's declarations.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;
#[path = "support/snapshot.rs"]
mod snapshot;

use airlight::core::{DepthRange, PerspectiveView, Raster, Sky, Tonemap};
use airlight::data::Mesh;
use airlight::scattering::{Composite, Medium, Prefiltered, Settings, Visibility};
use airlight::{Lighting, Setting, Stage};
use airlight_example_wgpu as example;
use glam::Vec3;
use gpu::{gpu, shaders};
use naga_oil::compose::{ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue};
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
    Picture { size: SIZE, pixels: example::render(folder.path(), &bunny(), SIZE).unwrap() }
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
    let picture = picture_of_the_example();
    let (structure, mean) = picture.similarity(&picture_of_the_host());
    assert!(
        structure > 0.98 && mean < 1.0,
        "structural similarity {structure:.4}, mean difference {mean:.2}"
    );
    assert_picture("example_wgpu", &gpu().description(), &picture, 0.995);
}

/// What the shader of `examples/bevy` imports of Bevy 0.18, declared as there.
const BEVY: [&str; 5] = [
    "#define_import_path bevy_pbr::forward_io
    struct VertexOutput {
        @builtin(position) position: vec4<f32>,
        @location(0) world_position: vec4<f32>,
        @location(1) world_normal: vec3<f32>,
    }",
    "#define_import_path bevy_pbr::mesh_view_bindings
    struct View { world_position: vec3<f32>, exposure: f32 }
    struct DirectionalLight { color: vec4<f32>, direction_to_light: vec3<f32> }
    struct Lights { directional_lights: array<DirectionalLight, 1u> }
    @group(0) @binding(0) var<uniform> view: View;
    @group(0) @binding(1) var<uniform> lights: Lights;",
    "#define_import_path bevy_pbr::prepass_utils
    fn prepass_depth(frag_coord: vec4<f32>, sample_index: u32) -> f32 { return frag_coord.z; }",
    "#define_import_path bevy_pbr::shadows
    fn fetch_directional_shadow(
        light_id: u32, frag_position: vec4<f32>, surface_normal: vec3<f32>, view_z: f32
    ) -> f32 { return view_z; }",
    "#define_import_path bevy_pbr::view_transformations
    fn frag_coord_to_ndc(frag_coord: vec4<f32>) -> vec3<f32> { return frag_coord.xyz; }
    fn position_ndc_to_world(ndc_pos: vec3<f32>) -> vec3<f32> { return ndc_pos; }
    fn position_world_to_view(world_pos: vec3<f32>) -> vec3<f32> { return world_pos; }",
];

#[test]
fn the_shader_for_bevy_composes_from_the_modules() {
    let mut composer = Composer::default();
    let modules = airlight_wgsl::MODULES.iter().map(|module| (module.source, module.file));
    for (source, file_path) in modules.chain(BEVY.map(|source| (source, "bevy"))) {
        let descriptor = ComposableModuleDescriptor { source, file_path, ..Default::default() };
        composer.add_composable_module(descriptor).unwrap();
    }
    let source = std::fs::read_to_string(repository().join("examples/bevy/src/air.wgsl")).unwrap();
    let shader_defs = [("MATERIAL_BIND_GROUP".to_owned(), ShaderDefValue::UInt(3))].into();
    let descriptor =
        NagaModuleDescriptor { source: &source, file_path: "air.wgsl", shader_defs, ..Default::default() };
    let module = composer.make_naga_module(descriptor).unwrap_or_else(|error| panic!("{}", error.inner));
    let medium = module
        .global_variables
        .iter()
        .find(|(_, global)| global.binding.is_some_and(|binding| (binding.group, binding.binding) == (3, 0)));
    let (_, medium) = medium.expect("the uniform of the material");
    assert_eq!(module.types[medium.ty].inner.size(module.to_ctx()), 32, "the struct of src/main.rs");
}
