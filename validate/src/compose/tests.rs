// SPDX-License-Identifier: MIT OR Apache-2.0
//! Composition, names, and the places of errors.

#![allow(clippy::unwrap_used)]
use super::*;

const LEAF: &str = "// SPDX\n#define_import_path airlight::core::leaf\n/* é */ const SCALE: f32 = 2.0;\nstruct Ray { origin: vec4<f32>, direction: vec4<f32> }\nfn twice(x: f32) -> f32 { return x * SCALE; }\nfn same(x: f32) -> f32 { return x; }\n";
const MIDDLE: &str = "// SPDX\n#define_import_path airlight::core::middle\n#import airlight::core::leaf::{\n    twice,\n    Ray,\n}\nfn four(r: Ray) -> f32 { return twice(r.origin.x) + twice(r.origin.x); }\nfn same(x: f32) -> f32 { return x + 1.0; }\n";
const PASS: &str = "#import airlight::core::leaf\n#import airlight::core::middle::four\n@group(#{GROUP}) @binding(0) var<uniform> ray: leaf::Ray;\n@group(#{GROUP}) @binding(1) var<storage, read_write> output: array<f32>;\n@compute @workgroup_size(8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n    output[id.x] = four(ray) + leaf::same(f32(#{BASES})) + airlight::core::middle::same(1.0);\n}\n";

fn library(leaf: &str, middle: &str, pass: &str) -> Library {
    Library::from_text(
        &[("core/leaf.wgsl", leaf), ("core/middle.wgsl", middle)],
        &[("core/passes/pass.wgsl", pass)],
        &[("core", "pass\n+ default: BASES=4\n")],
    )
}

fn definitions() -> Definitions {
    Definitions::new().set("BASES", 4)
}

/// The error of composing, as `file:line:column` and message.
fn error(leaf: &str, middle: &str, pass: &str) -> (String, String) {
    let error = library(leaf, middle, pass).compose("core/pass", &definitions()).unwrap_err();
    (error.location().unwrap().to_string(), error.message())
}

#[test]
fn names_are_readable_and_unambiguous() {
    let composed = library(LEAF, MIDDLE, PASS).compose("core/pass", &definitions()).unwrap();
    let functions: Vec<&str> =
        composed.module.functions.iter().filter_map(|(_, f)| f.name.as_deref()).collect();
    assert!(functions.contains(&"twice"), "{functions:?}");
    assert!(functions.contains(&"four"), "{functions:?}");
    assert!(functions.contains(&"leaf_same"), "{functions:?}");
    assert!(functions.contains(&"middle_same"), "{functions:?}");
    let reflection = composed.reflect();
    assert_eq!(reflection.structs[0].name, "Ray");
    assert!(!format!("{:?}", composed.module).contains("naga_oil"));
}

#[test]
fn the_group_is_zero_unless_set() {
    let library = library(LEAF, MIDDLE, PASS);
    let group = |definitions: &Definitions| {
        library.compose("core/pass", definitions).unwrap().reflect().bindings[0].group
    };
    assert_eq!(group(&definitions()), 0);
    assert_eq!(group(&definitions().set("GROUP", 2)), 2);
}

#[test]
fn a_parse_error_in_the_middle_of_a_chain_is_located() {
    let leaf = LEAF.replace("return x * SCALE", "return x * SCALES");
    let (place, message) = error(&leaf, MIDDLE, PASS);
    assert_eq!(place, "core/leaf.wgsl:5:38");
    assert!(message.contains("SCALES"), "{message}");
    let middle = MIDDLE.replace("+ twice", "+ twise");
    let (place, message) = error(LEAF, &middle, PASS);
    assert!(place.starts_with("core/middle.wgsl:7:"), "{place}");
    assert!(message.contains("twise"), "{message}");
    assert!(!message.contains("naga_oil"), "{message}");
}

#[test]
fn a_syntax_error_after_replaced_names_is_located() {
    let middle = MIDDLE.replace("twice(r.origin.x);", "twice(r.origin.x)) ;");
    let (place, _) = error(LEAF, &middle, PASS);
    assert_eq!(place, "core/middle.wgsl:7:70");
}

#[test]
fn an_error_found_by_validation_is_located() {
    // Assigning through a missing return value type is only found after composition.
    let leaf = LEAF.replace("{ return x; }", "{ }");
    let (place, message) = error(&leaf, MIDDLE, PASS);
    assert!(place.starts_with("core/leaf.wgsl:6"), "{place}: {message}");
    assert!(!message.contains("naga_oil"), "{message}");
    let pass = PASS.replace("@workgroup_size(8)", "@workgroup_size(0)");
    let (place, _) = error(LEAF, MIDDLE, &pass);
    assert!(place.starts_with("core/passes/pass.wgsl"), "{place}");
}

#[test]
fn a_validation_error_in_the_pass_is_located() {
    let pass = PASS.replace("output[id.x] =", "workgroupBarrier();\n if four(ray) > 0.0 { output[id.y] = f32(textureDimensions(t).x); } output[id.x] =");
    let pass = format!(
        "{pass}@group(0) @binding(2) var t: texture_storage_2d<rgba16float, read_write>;\nfn f(x: f32) -> f32 {{ }}\n"
    );
    let (place, message) = error(LEAF, MIDDLE, &pass);
    assert!(place.starts_with("core/passes/pass.wgsl:10"), "{place}: {message}");
}

#[test]
fn a_missing_import_is_located_used_or_not() {
    let middle = MIDDLE.replace("#import airlight::core::leaf::{", "#import airlight::core::leave::{");
    let (place, message) = error(LEAF, &middle, PASS);
    assert_eq!(place, "core/middle.wgsl:4:5");
    assert!(message.contains("airlight::core::leave::twice"), "{message}");
    let pass = format!("{PASS}#import airlight::core::nowhere\n");
    let (place, message) = error(LEAF, MIDDLE, &pass);
    assert_eq!(place, "core/passes/pass.wgsl:8:9");
    assert!(message.contains("airlight::core::nowhere"), "{message}");
}

#[test]
fn a_missing_definition_is_located() {
    let pass = format!("{PASS}// {}\n#if SIZE == 4\n#endif\n", "#{BASES} ".repeat(9));
    let (place, message) = error(LEAF, MIDDLE, &pass);
    assert_eq!(place, "core/passes/pass.wgsl:9");
    assert!(message.contains("SIZE"), "{message}");
}

#[test]
fn unused_functions_of_a_module_are_checked() {
    let middle = format!("{MIDDLE}fn unused() -> f32 {{ return 1u; }}\n");
    let library = library(LEAF, &middle, PASS);
    // The pass does not import `unused`; the module alone must fail.
    let error = library.compose_module("airlight::core::middle", &Definitions::new()).unwrap_err();
    assert_eq!(error.location().unwrap().file, "core/middle.wgsl");
    assert_eq!(error.location().unwrap().line, Some(9));
}

#[test]
fn a_module_alone_keeps_all_of_its_items() {
    let library = library(LEAF, MIDDLE, PASS);
    let composed = library.compose_module("airlight::core::leaf", &Definitions::new()).unwrap();
    let functions: Vec<&str> =
        composed.module.functions.iter().filter_map(|(_, f)| f.name.as_deref()).collect();
    assert_eq!(functions, ["twice", "same"]);
}

#[test]
fn a_name_that_importers_cannot_use_is_an_error() {
    let leaf = format!("{LEAF}struct Pair {{ x1: f32, y: f32 }}\n");
    let library = library(&leaf, MIDDLE, PASS);
    let error = library.compose_module("airlight::core::leaf", &Definitions::new()).unwrap_err();
    assert_eq!(error.location().unwrap().file, "core/leaf.wgsl");
    assert!(error.message().contains("x1"), "{error}");
}

#[test]
fn what_cannot_be_imported_says_so() {
    let leaf = format!("{LEAF}const HALF = 0.5;\noverride speed: f32 = 1.0;\n");
    for (item, part) in [("HALF", "without a type"), ("speed", "pipeline override")] {
        let pass = PASS.replace("f32(#{BASES})", &format!("leaf::{item}"));
        let (place, message) = error(&leaf, MIDDLE, &pass);
        assert!(place.starts_with("core/passes/pass.wgsl:6:"), "{place}");
        assert!(message.contains(part), "{message}");
    }
    let leaf = format!("{LEAF}alias Pair = vec2<f32>;\n");
    let (place, message) = error(&leaf, MIDDLE, PASS);
    assert_eq!(place, "core/leaf.wgsl:7");
    assert!(message.contains("alias"), "{message}");
}

#[test]
fn optional_features_are_rejected() {
    let pass = format!("{PASS}@compute @workgroup_size(1) fn other() {{ let x = subgroupAdd(1u); }}\n");
    let (place, _) = error(LEAF, MIDDLE, &pass);
    assert!(place.starts_with("core/passes/pass.wgsl"), "{place}");
}

#[test]
fn unknown_names_list_the_known_ones() {
    let library = library(LEAF, MIDDLE, PASS);
    let error = library.compose("core/passs", &Definitions::new()).unwrap_err().to_string();
    assert!(error.contains("core/pass"), "{error}");
    let error = library.permutation("core/pass", "half").unwrap_err().to_string();
    assert!(error.contains("default"), "{error}");
    let error = library.compose_module("nope", &Definitions::new()).unwrap_err().to_string();
    assert!(error.contains("airlight::core::leaf"), "{error}");
}

#[test]
fn virtual_functions_and_their_overrides_get_names() {
    let leaf = format!(
        "{LEAF}virtual fn shade(x: f32) -> f32 {{ return x; }}\nfn use_shade() -> f32 {{ return shade(2.0); }}\n"
    );
    let pass = format!(
        "{PASS}override fn leaf::shade(x: f32) -> f32 {{ return leaf::shade(x) * 3.0; }}\n@compute @workgroup_size(1) fn other() {{ output[0] = leaf::use_shade(); }}\n"
    );
    let composed = library(&leaf, MIDDLE, &pass).compose("core/pass", &definitions()).unwrap();
    let functions: Vec<&str> =
        composed.module.functions.iter().filter_map(|(_, f)| f.name.as_deref()).collect();
    assert!(functions.contains(&"shade") && functions.contains(&"shade_override"), "{functions:?}");
}

#[test]
fn the_shipped_lists_agree_with_the_sources() {
    let library = Library::builtin();
    for (module, shipped) in library.modules().iter().zip(airlight_wgsl::MODULES) {
        for import in &module.imports {
            assert!(
                shipped.imports.contains(&import.as_str()),
                "{}: wgsl/src/list.rs does not list the import {import}",
                module.file
            );
        }
    }
    assert_eq!(library.unlisted, []);
}
