// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of both kinds, sound and broken.

use super::*;
use crate::data::random::Random;

const SQUARE: &str =
    "mtllib nowhere.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl gone\nf 1 2 3 4\n";

fn load(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    load_mesh(&path)
}

fn message(name: &str, bytes: &[u8]) -> String {
    load(name, bytes).expect_err("a broken file").to_string()
}

/// A glTF file with two triangles as a strip, moved and mirrored by two nested nodes.
fn gltf(change: impl Fn(String) -> String, bytes: &[u8]) -> Vec<u8> {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"children":[1],"translation":[0,0,5]}},{{"mesh":0,"scale":[-1,1,1]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.25,0.5,1,1]}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5,"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":8}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        bytes.len()
    );
    glb(&change(text), bytes)
}

fn glb(text: &str, bytes: &[u8]) -> Vec<u8> {
    let mut text = text.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |n: usize| u32::try_from(n).expect("small").to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(word(28 + text.len() + bytes.len()));
    file.extend(word(text.len()));
    file.extend(b"JSON");
    file.extend(text);
    file.extend(word(bytes.len()));
    file.extend(b"BIN\0");
    file.extend(bytes);
    file
}

fn strip() -> Vec<u8> {
    let mut bytes = Vec::new();
    for value in [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.0f32] {
        bytes.extend(value.to_le_bytes());
    }
    for index in [0u16, 1, 2, 3] {
        bytes.extend(index.to_le_bytes());
    }
    bytes
}

#[test]
fn an_obj_polygon_without_its_material_file() {
    let mesh = load("a.obj", SQUARE.as_bytes()).expect("a square");
    assert_eq!(mesh.triangle_count(), 2);
    assert!(mesh.normals.iter().all(|n| *n == Vec3::Z));
    assert!(mesh.albedos.iter().all(|a| *a == DEFAULT_ALBEDO));
}

#[test]
fn obj_materials_and_vertex_colours_become_albedos() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("a.mtl"), "newmtl red\nKd 0.8 0.1 0.2\n").expect("a file");
    let path = folder.path().join("a.obj");
    std::fs::write(&path, SQUARE.replace("nowhere", "a").replace("gone", "red")).expect("a file");
    let mesh = load_mesh(&path).expect("a square");
    assert!(mesh.albedos.iter().all(|a| *a == Vec3::new(0.8, 0.1, 0.2)));

    let coloured = b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
    assert_eq!(load("b.obj", coloured).expect("a triangle").albedos, [Vec3::X, Vec3::Y, Vec3::Z]);
}

#[test]
fn a_gltf_strip_under_two_nodes() {
    let mesh = load("a.glb", &gltf(|t| t, &strip())).expect("two triangles");
    assert_eq!(mesh.triangle_count(), 2);
    let bounds = mesh.bounds().expect("vertices");
    assert_eq!((bounds.min, bounds.max), (Vec3::new(-1., 0., 5.), Vec3::new(0., 1., 5.)));
    assert!(mesh.normals.iter().all(|n| (*n - Vec3::Z).length() < 1e-6), "the mirror keeps the front");
    assert_eq!(mesh.albedos[0], Vec3::new(0.25, 0.5, 1.0));
    let fan = load("a.glb", &gltf(|t| t.replace("\"mode\":5", "\"mode\":6"), &strip())).expect("a fan");
    assert_eq!(fan.triangle_count(), 2);
    let points = message("a.glb", &gltf(|t| t.replace("\"mode\":5", "\"mode\":0"), &strip()));
    assert!(points.contains("no triangles"), "{points}");
}

#[test]
fn a_gltf_cycle_of_nodes_ends() {
    let cycle = gltf(|t| t.replace("\"mesh\":0,", "\"mesh\":0,\"children\":[0],"), &strip());
    assert_eq!(load("a.glb", &cycle).expect("each node once").triangle_count(), 2);
}

#[test]
fn errors_name_the_file_and_the_fault() {
    let missing = load_mesh("no/such/file.obj").expect_err("nothing there").to_string();
    assert!(missing.contains("no/such/file.obj") && missing.contains("no such"), "{missing}");
    let cases: &[(&str, &[u8], &[&str])] = &[
        ("a.stl", b"solid", &["a.stl", "\"stl\"", ".glb"]),
        ("noextension", b"solid", &["noextension", ".obj"]),
        ("a.obj", b"", &["a.obj", "no triangles"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["no triangles"]),
        ("a.obj", b"v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n", &["line 2", "position"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 x", &["line 5", "face"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", &["line 5", "out of bounds"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999\n", &["line 4"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", &["a.obj"]),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["a.obj"]),
        ("a.obj", b"v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", &["vertex 1", "not finite"]),
        ("a.obj", b"v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n", &["vertex 1", "not finite"]),
        ("a.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", &["no extent"]),
        ("a.gltf", b"{", &["a.gltf", "no valid glTF"]),
        ("a.glb", b"glTF", &["a.glb", "no valid glTF"]),
        ("a.gltf", b"{\"asset\":{\"version\":\"2.0\"}}", &["no triangles"]),
    ];
    for (name, bytes, parts) in cases {
        let message = message(name, bytes);
        for part in *parts {
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    let broken = |from: &str, to: &str| message("a.glb", &gltf(|t| t.replace(from, to), &strip()));
    let mut far = strip();
    far[50] = 9;
    let far = message("a.glb", &gltf(|t| t, &far));
    assert!(far.contains("index 9 is out of range"), "{far}");
    let cases = [
        ("\"byteLength\":48", "\"byteLength\":40", "shorter"),
        ("\"byteOffset\":48", "\"byteOffset\":4800000000", "shorter"),
        ("\"count\":4,\"type\":\"VEC3\"", "\"count\":40000000,\"type\":\"VEC3\"", "shorter"),
        ("\"count\":4,\"type\":\"VEC3\"", "\"count\":18446744073709551615,\"type\":\"VEC3\"", "vertices"),
        ("5126", "5121", "a.glb"),
        ("\"mesh\":0", "\"mesh\":7", "a.glb"),
        (
            "\"scene\":0",
            "\"scene\":0,\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
            "without compression",
        ),
    ];
    for (from, to, part) in cases {
        let message = broken(from, to);
        assert!(message.contains(part), "{to}: {message}");
    }
    let other = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"gone.bin","byteLength":4}]}"#;
    assert!(message("a.gltf", other.as_bytes()).contains("one folder"));
}

#[test]
fn garbage_never_panics() {
    let mut random = Random::new(11);
    let obj = "mtllib x.mtl\nv 0 0 0 1 1 1\nv 1 0 0\nvt 0 1\nvn 0 0 1\nv 1 1 0\ng a\nusemtl b\n\
               f 1/1/1 2/1/1 3//1\ns off\nf -1 -2 -3\nl 1 2\np 1\nv 0 1\nf 1 2 3 4 5\n";
    let binary = gltf(|t| t, &strip());
    let folder = tempfile::tempdir().expect("a temporary folder");
    for round in 0..2000 {
        let (name, seed): (&str, &[u8]) =
            if round % 2 == 0 { ("a.obj", obj.as_bytes()) } else { ("a.glb", &binary) };
        let mut bytes = seed.to_vec();
        match round / 2 % 3 {
            0 => bytes.truncate(random.below(seed.len())),
            1 => bytes.iter_mut().for_each(|b| *b = random.next_u32() as u8),
            _ => {}
        }
        for _ in 0..random.below(6) {
            if !bytes.is_empty() {
                let place = random.below(bytes.len());
                let digits = b"0123456789-./ \nfv\xff{}";
                bytes[place] = digits[random.below(digits.len())];
            }
        }
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).expect("a file");
        if let Ok(mesh) = load_mesh(&path) {
            assert_eq!(mesh.validate(), Ok(()));
        }
    }
}
