// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single changes of a small manifest, and what each is.

#![allow(clippy::unwrap_used)]
use super::*;
use serde_json::json;

fn manifest() -> Value {
    json!({
        "format": 1, "version": "0.1.0",
        "modules": [{ "path": "a::m", "file": "a/m.wgsl", "imports": [] }],
        "passes": [{ "name": "a/p", "file": "a/passes/p.wgsl", "imports": ["a::m"], "permutations": [{
            "name": "default", "definitions": { "N": 4 },
            "needs": { "features": ["f16"], "limits": { "maxStorageTexturesPerShaderStage": 5 } },
            "entry_points": [
                { "name": "run", "stage": "compute", "bindings": ["view", "map"], "workgroup_size": [8, 8, 1],
                  "uses": { "uniform_buffers": 1 } },
                { "name": "draw", "stage": "fragment", "bindings": ["view"],
                  "inputs": [{ "location": 0, "name": "uv", "type": "vec2<f32>" }],
                  "outputs": [{ "location": 0, "name": "", "type": "vec4<f32>" }], "uses": {} }],
            "bindings": [
                { "group": 0, "binding": 0, "name": "view", "kind": "uniform", "type": "View", "size": 16, "entry_points": ["run", "draw"] },
                { "group": 0, "binding": 1, "name": "map", "kind": "texture", "filtered": true, "entry_points": ["run"] },
                { "group": 0, "binding": 2, "name": "list", "kind": "storage", "access": "read", "min_size": 4, "entry_points": ["run"] }],
            "structs": [{ "name": "View", "size": 16, "align": 4, "members": [
                { "name": "gain", "type": "f32", "offset": 0, "size": 4 }] }]
        }] }]
    })
}

/// What a change of the manifest is.
fn effects(change: impl Fn(&mut Value)) -> Vec<Effect> {
    let (old, mut new) = (manifest(), manifest());
    change(&mut new);
    let comparison = compare(&old, &new);
    assert!(!comparison.render().is_empty());
    comparison.changes.iter().map(|change| change.effect).collect()
}

fn set(pointer: &str, value: Value) -> Vec<Effect> {
    effects(|manifest| *manifest.pointer_mut(pointer).unwrap() = value.clone())
}

fn push(pointer: &str, value: Value) -> Vec<Effect> {
    effects(|manifest| manifest.pointer_mut(pointer).unwrap().as_array_mut().unwrap().push(value.clone()))
}

fn remove(pointer: &str, index: usize) -> Vec<Effect> {
    effects(|manifest| drop(manifest.pointer_mut(pointer).unwrap().as_array_mut().unwrap().remove(index)))
}

const P: &str = "/passes/0/permutations/0";

#[test]
fn equal_manifests_have_no_changes_in_any_order() {
    assert_eq!(compare(&manifest(), &manifest()).changes, []);
    let mut turned = manifest();
    turned.pointer_mut(&format!("{P}/bindings")).unwrap().as_array_mut().unwrap().reverse();
    turned.pointer_mut(&format!("{P}/entry_points")).unwrap().as_array_mut().unwrap().reverse();
    assert_eq!(compare(&manifest(), &turned).changes, []);
}

#[test]
fn additions_are_compatible() {
    use Effect::Compatible;
    let permutation = manifest().pointer(P).unwrap().clone();
    let mut other = permutation.clone();
    other["name"] = json!("other");
    assert_eq!(push("/passes/0/permutations", other), [Compatible]);
    let mut pass = manifest()["passes"][0].clone();
    pass["name"] = json!("a/q");
    assert_eq!(push("/passes", pass), [Compatible]);
    assert_eq!(push("/modules", json!({ "path": "a::n", "file": "a/n.wgsl", "imports": [] })), [Compatible]);
    assert_eq!(push("/modules/0/imports", json!("a::k")), [Compatible]);
    assert_eq!(push(&format!("{P}/structs"), json!({ "name": "New", "size": 4 })), [Compatible]);
    assert_eq!(push(&format!("{P}/entry_points/1/outputs"), json!({ "location": 1 })), [Compatible]);
    // A new entry point, and a new binding that it alone uses.
    let both = effects(|manifest| {
        let permutation = manifest.pointer_mut(P).unwrap();
        let entry = json!({ "name": "more", "stage": "compute", "bindings": ["extra", "view"] });
        permutation["entry_points"].as_array_mut().unwrap().push(entry);
        let binding = json!({ "group": 0, "binding": 9, "name": "extra", "entry_points": ["more"] });
        permutation["bindings"].as_array_mut().unwrap().push(binding);
        permutation["bindings"][0]["entry_points"].as_array_mut().unwrap().push(json!("more"));
    });
    assert_eq!(both, [Compatible; 3]);
}

#[test]
fn what_is_loosened_is_compatible() {
    let of = |part: &str| format!("{P}/{part}");
    let cases = [
        set(&of("bindings/0/size"), json!(12)),
        set(&of("bindings/2/min_size"), json!(0)),
        set(&of("bindings/1/filtered"), json!(false)),
        set(&of("needs/limits/maxStorageTexturesPerShaderStage"), json!(4)),
        set(&of("needs/limits"), json!({})),
        remove(&of("needs/features"), 0),
        remove(&of("entry_points/1/inputs"), 0),
        set(&of("entry_points/1/inputs/0/name"), json!("place")),
        set(&of("entry_points/0/uses/uniform_buffers"), json!(2)),
        set("/version", json!("0.1.1")),
    ];
    for (case, effects) in cases.iter().enumerate() {
        assert_eq!(effects, &[Effect::Compatible], "case {case}");
    }
}

#[test]
fn what_a_host_notices_is_breaking() {
    let of = |part: &str| format!("{P}/{part}");
    let binding = json!({ "group": 0, "binding": 5, "name": "new", "entry_points": ["run"] });
    let cases = [
        remove("/modules", 0),
        remove("/passes", 0),
        remove("/passes/0/permutations", 0),
        remove(&of("entry_points"), 0),
        remove(&of("bindings"), 1),
        remove(&of("structs"), 0),
        remove(&of("structs/0/members"), 0),
        remove(&of("entry_points/0/bindings"), 0),
        remove(&of("entry_points/1/outputs"), 0),
        push(&of("bindings"), binding),
        push(&of("structs/0/members"), json!({ "name": "x" })),
        push(&of("entry_points/0/bindings"), json!("list")),
        push(&of("entry_points/1/inputs"), json!({ "location": 1 })),
        push(&of("needs/features"), json!("timestamps")),
        set(&of("needs/limits/maxStorageTexturesPerShaderStage"), json!(6)),
        set(&of("definitions/N"), json!(8)),
        set(&of("definitions"), json!({ "N": 4, "MORE": true })),
        set(&of("entry_points/0/stage"), json!("vertex")),
        set(&of("entry_points/0/workgroup_size"), json!([16, 8, 1])),
        set(&of("entry_points/1/inputs/0/type"), json!("vec3<f32>")),
        set(&of("bindings/0/group"), json!(1)),
        set(&of("bindings/0/binding"), json!(7)),
        set(&of("bindings/0/kind"), json!("storage")),
        set(&of("bindings/0/type"), json!("Other")),
        set(&of("bindings/0/size"), json!(32)),
        set(&of("bindings/2/access"), json!("read_write")),
        set(&of("bindings/2/min_size"), json!(8)),
        set(&of("structs/0/size"), json!(8)),
        set(&of("structs/0/align"), json!(16)),
        set(&of("structs/0/members/0/offset"), json!(4)),
        set(&of("structs/0/members/0/type"), json!("u32")),
        set("/modules/0/file", json!("b/m.wgsl")),
    ];
    for (case, effects) in cases.iter().enumerate() {
        assert_eq!(effects, &[Effect::Breaking], "case {case}");
    }
    // The other way round, what was loosened is tightened.
    let mut filtered = manifest();
    *filtered.pointer_mut(&of("bindings/1/filtered")).unwrap() = json!(false);
    assert!(compare(&filtered, &manifest()).is_breaking());
}

#[test]
fn a_rename_is_a_removal_and_an_addition() {
    use Effect::{Breaking, Compatible};
    assert_eq!(set("/passes/0/name", json!("a/q")), [Breaking, Compatible]);
    assert_eq!(set(&format!("{P}/name"), json!("other")), [Breaking, Compatible]);
    assert_eq!(set(&format!("{P}/bindings/0/name"), json!("camera")), [Breaking, Breaking]);
}

#[test]
fn lines_name_the_place_and_both_values() {
    let mut new = manifest();
    *new.pointer_mut(&format!("{P}/bindings/0/group")).unwrap() = json!(1);
    let text = compare(&manifest(), &new).render();
    assert_eq!(text, "breaking: a/p:default, binding view, group: 0 -> 1 (what is bound no longer fits)\n");
}

#[test]
fn what_several_permutations_share_is_said_once() {
    let many = |size: u32| {
        let mut manifest = manifest();
        let permutation = manifest.pointer(P).unwrap().clone();
        let list = manifest.pointer_mut("/passes/0/permutations").unwrap();
        *list = (0..5)
            .map(|number| {
                let mut permutation = permutation.clone();
                permutation["name"] = json!(format!("n{number}"));
                permutation["structs"][0]["size"] = json!(size);
                permutation
            })
            .collect();
        manifest
    };
    let comparison = compare(&many(16), &many(32));
    assert_eq!(comparison.changes.len(), 5);
    let text = comparison.render();
    assert_eq!(text.lines().count(), 1);
    assert!(text.contains("a/p:n0, a/p:n1, a/p:n2 and 2 more, struct View, size: 16 -> 32"), "{text}");
}

#[test]
fn what_is_no_manifest_is_said() {
    let text = manifest().to_string();
    assert_eq!(read(&text).unwrap(), manifest());
    for (text, part) in [
        ("{", "no JSON"),
        ("[]", "no `format`"),
        ("{\"format\": 2}", "has format 2"),
        ("{\"format\": \"1\"}", "has format \"1\""),
        ("{\"format\": 1, \"modules\": []}", "no list `passes`"),
        ("{\"format\": 1, \"modules\": {}, \"passes\": []}", "no list `modules`"),
    ] {
        assert!(read(text).unwrap_err().contains(part), "{text}");
    }
}
