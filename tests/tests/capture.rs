// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a recorder of passes writes is what the device held before and after.
#![allow(clippy::unwrap_used)]

#[path = "support/gpu.rs"]
mod gpu;

use airlight::capture::Recorder;
use airlight::core::TonemapParameters;
use airlight::validate::{Definitions, Library};
use airlight::{Buffer, Gpu, Pass, Shaders, Texture};
use gpu::{gpu, shaders};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use wgpu::TextureFormat::{Rgba8Unorm, Rgba16Float};

const SIZE: [u32; 2] = [5, 3];

/// The test's device again, recorded into `folder`.
fn recorded(folder: &Path) -> (Gpu, Arc<Recorder>) {
    let Gpu { adapter, device, queue, .. } = gpu();
    let gpu = Gpu::from_device(adapter.clone(), device.clone(), queue.clone());
    let recorder = Arc::new(Recorder::new(&gpu, folder).unwrap());
    (gpu.watched_by(recorder.clone()), recorder)
}

fn radiance(gpu: &Gpu) -> Texture {
    let radiance = Texture::storage(gpu, SIZE, Rgba16Float);
    let values: Vec<f32> = (0..60).map(|k| k as f32 / 32.0).collect();
    radiance.write(gpu, &values).unwrap();
    radiance
}

/// Tone maps a picture.
fn tonemap(gpu: &Gpu, radiance: &Texture, times: usize) -> Texture {
    let parameters = TonemapParameters { exposure: 1.0, dither: 0.0, reserved_a: 0.0, reserved_b: 0.0 };
    let parameters = Buffer::uniform(gpu, &parameters);
    let pass = Pass::compute(gpu, shaders(), "core/tonemap", "default").unwrap();
    let picture = Texture::storage(gpu, SIZE, Rgba8Unorm);
    let resources =
        [("parameters", (&parameters).into()), ("radiance", radiance.into()), ("picture", (&picture).into())];
    let bound = pass.bind(gpu, &resources).unwrap();
    let mut encoder = gpu.encoder();
    for _ in 0..times {
        pass.dispatch(&mut encoder, &bound, [SIZE[0], SIZE[1], 1]);
    }
    gpu.submit(encoder).unwrap();
    picture
}

fn case(folder: &Path, number: usize) -> Value {
    let text = fs::read_to_string(folder.join(format!("cases/{number}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn count(folder: &Path, part: &str) -> usize {
    fs::read_dir(folder.join(part)).unwrap().count()
}

/// The blob of a resource of a case, `when` is `before` or `after`.
fn blob(folder: &Path, resource: &Value, when: &str) -> Vec<u8> {
    fs::read(folder.join("blobs").join(resource[when].as_str().unwrap())).unwrap()
}

/// The resource that a case's binding names.
fn bound<'a>(case: &'a Value, bindings: &'a Value, name: &str) -> &'a Value {
    let binding = bindings.as_array().unwrap().iter().find(|binding| binding["name"] == name).unwrap();
    &case["resources"][binding["bound"]["resource"].as_u64().unwrap() as usize]
}

#[test]
fn a_dispatch_is_recorded_with_its_contents() {
    let folder = tempfile::tempdir().unwrap();
    let (gpu, recorder) = recorded(folder.path());
    let given = radiance(&gpu);
    let picture = tonemap(&gpu, &given, 1);
    let bytes: Vec<u8> =
        picture.read(&gpu).unwrap().iter().map(|value| (value * 255.0).round() as u8).collect();
    recorder.snapshot("picture").unwrap();

    assert_eq!(count(folder.path(), "cases"), 1);
    let case = case(folder.path(), 0);
    assert_eq!(case["key"], "core/tonemap:default tonemap");
    let bindings = &case["run"]["bindings"];
    let written = bound(&case, bindings, "picture");
    assert_eq!(blob(folder.path(), written, "after"), bytes);
    assert!(bytes.iter().any(|byte| *byte != 0));
    assert!(blob(folder.path(), written, "before").iter().all(|byte| *byte == 0));
    let read = bound(&case, bindings, "radiance");
    let halves: Vec<u8> =
        given.read(&gpu).unwrap().iter().flat_map(|v| half::f16::from_f32(*v).to_le_bytes()).collect();
    assert_eq!(blob(folder.path(), read, "before"), halves);
    assert_eq!(read["after"], Value::Null);

    let flat = fs::read_to_string(folder.path().join("shaders/0.wgsl")).unwrap();
    let composed = shaders().compose("core/tonemap", "default").unwrap();
    assert_eq!(flat, airlight::validate::flat::write(&composed).unwrap());
    let snapshots = fs::read_to_string(folder.path().join("snapshots.jsonl")).unwrap();
    let snapshot: Value = serde_json::from_str(&snapshots).unwrap();
    assert_eq!((&snapshot["key"], &snapshot["output"]), (&case["key"], &"picture".into()));
}

#[test]
fn some_runs_of_a_pass_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (gpu, _) = recorded(folder.path());
    tonemap(&gpu, &radiance(&gpu), 6);
    // The first, the second, the fourth.
    assert_eq!(count(folder.path(), "cases"), 3);
}

#[test]
fn without_a_recorder_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let (recorded, _) = recorded(folder.path());
    tonemap(gpu(), &radiance(gpu()), 1);
    recorded.submit(recorded.encoder()).unwrap();
    assert_eq!(["cases", "blobs", "shaders"].map(|part| count(folder.path(), part)), [0; 3]);
    tonemap(&recorded, &radiance(&recorded), 1);
    assert_eq!(count(folder.path(), "cases"), 1);
}

/// Every second number of a buffer, in as many groups as another buffer says; then a picture of it.
const PASS: &str = "
struct Numbers { count: u32, scale: vec3<f32>, values: array<vec2<u32>> }
@group(#{GROUP}) @binding(0) var<storage, read_write> numbers: Numbers;
@compute @workgroup_size(8)
fn grow(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&numbers.values) { numbers.values[id.x].y = id.x + numbers.count; }
}
@vertex fn vertex_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(4.0 * f32(index & 1u) - 1.0, 2.0 * f32(index & 2u) - 1.0, 0.5, 1.0);
}
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(position.xy / 8.0, 0.25, 1.0);
}
";

#[test]
fn an_indirect_dispatch_and_a_picture_are_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let (gpu, _) = recorded(folder.path());
    let shaders = Shaders::from_library(Library::builtin().with_pass("core", "grown", PASS));
    let pass = Pass::compute_with(&gpu, &shaders, "core/grown", &Definitions::new()).unwrap();
    let bytes: Vec<u8> = (0..24_u32).flat_map(u32::to_le_bytes).collect();
    let numbers = Buffer::with_bytes(&gpu, &bytes, wgpu::BufferUsages::STORAGE);
    let groups: Vec<u8> = [9_u32, 1, 1, 1].iter().flat_map(|word| word.to_le_bytes()).collect();
    let groups = Buffer::with_bytes(&gpu, &groups, wgpu::BufferUsages::INDIRECT);
    let mut encoder = gpu.encoder();
    let resources = pass.bind(&gpu, &[("numbers", (&numbers).into())]).unwrap();
    pass.dispatch_indirect(&mut encoder, &resources, "grow", (&groups, 4)).unwrap();
    let picture =
        Pass::picture(&gpu, &shaders, "core/grown", &Definitions::new(), "fragment", Rgba16Float).unwrap();
    let target = Texture::target(&gpu, SIZE, Rgba16Float);
    picture.fill(&mut encoder, &picture.bind(&gpu, &[]).unwrap(), &target);
    gpu.submit(encoder).unwrap();

    let dispatch = case(folder.path(), 0);
    let written = bound(&dispatch, &dispatch["run"]["bindings"], "numbers");
    assert_eq!(blob(folder.path(), written, "before"), bytes);
    assert_eq!(blob(folder.path(), written, "after"), numbers.read(&gpu).unwrap());
    assert_eq!(written["words"], serde_json::json!({ "head": "u...fff.", "repeated": "uu" }));
    let indirect = &dispatch["run"]["groups"];
    assert_eq!(indirect["offset"], 4);
    let place = indirect["buffer"].as_u64().unwrap() as usize;
    assert_eq!(blob(folder.path(), &dispatch["resources"][place], "before"), groups.read(&gpu).unwrap());

    let drawn = case(folder.path(), 1);
    let color = &drawn["run"]["colors"][0];
    assert_eq!(color["load"], serde_json::json!([0.0, 0.0, 0.0, 1.0]));
    let written = &drawn["resources"][color["resource"].as_u64().unwrap() as usize];
    let halves: Vec<u8> =
        target.read(&gpu).unwrap().iter().flat_map(|v| half::f16::from_f32(*v).to_le_bytes()).collect();
    assert_eq!(blob(folder.path(), written, "after"), halves);
}
