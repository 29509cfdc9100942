// SPDX-License-Identifier: MIT OR Apache-2.0
//! The whole check on small libraries, without programs from outside.

#![allow(clippy::unwrap_used)]
use super::*;

const MODULE: &str = "#define_import_path airlight::core::leaf\nfn twice(x: f32) -> f32 { return 2.0 * x; }\nfn look(t: texture_2d<f32>, s: sampler, uv: vec2<f32>) -> vec4<f32> { return textureSampleLevel(t, s, uv, 0.0); }\n";
const PASS: &str = "#import airlight::core::leaf\nstruct Settings { color: vec3<f32>, gain: f32 }\n@group(#{GROUP}) @binding(0) var<uniform> settings: Settings;\n@group(#{GROUP}) @binding(1) var picture: texture_2d<f32>;\n@group(#{GROUP}) @binding(2) var linear: sampler;\n@group(#{GROUP}) @binding(3) var output: texture_storage_2d<rgba16float, write>;\n@group(#{GROUP}) @binding(4) var<storage, read_write> cells: array<u32>;\n@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n    let color = leaf::look(picture, linear, vec2<f32>(id.xy)) * leaf::twice(settings.gain);\n    textureStore(output, id.xy, color);\n    cells[id.x] = 1u;\n}\n";

fn check(module: &str, pass: &str) -> Report {
    let library = Library::from_text(
        &[("core/leaf.wgsl", module)],
        &[("core/passes/pass.wgsl", pass)],
        &[("core", "pass\n+ default:\n")],
    );
    run(&library, &Options { path: Some(OsString::new()), ..Options::default() }).unwrap()
}

/// The check and the place of each finding.
fn found(module: &str, pass: &str) -> Vec<(String, String)> {
    let report = check(module, pass);
    let place = |finding: &Finding| match finding.line {
        Some(line) => format!("{}:{line}", finding.file),
        None => finding.file.clone(),
    };
    report.findings.iter().map(|finding| (finding.check.clone(), place(finding))).collect()
}

fn pair(check: &str, place: &str) -> (String, String) {
    (check.to_owned(), place.to_owned())
}

#[test]
fn a_sound_library_is_clean_and_says_what_it_skipped() {
    let report = check(MODULE, PASS);
    assert_eq!(report.findings, []);
    assert_eq!((report.modules, report.permutations), (1, 1));
    assert_eq!(report.skipped.len(), Tool::ALL.len());
}

#[test]
fn an_error_in_a_module_is_reported_once_at_its_own_line() {
    let module = MODULE.replace("2.0 * x", "2u * x");
    assert_eq!(found(&module, PASS), [pair("compose", "core/leaf.wgsl:2")]);
}

#[test]
fn an_error_in_an_unused_function_is_found() {
    let module = format!("{MODULE}fn unused() -> u32 {{ return 1.0; }}\n");
    assert_eq!(found(&module, PASS), [pair("compose", "core/leaf.wgsl:4")]);
    // The composer validates what is used only.
    let module = format!("{MODULE}fn unused() -> f32 {{ return 1u; }}\n");
    assert_eq!(found(&module, PASS), [pair("unused-broken", "core/leaf.wgsl:4")]);
    // Nothing imports it: then it is an error like others.
    let pass = "@compute @workgroup_size(1) fn main() {}";
    assert_eq!(found(&module, pass), [pair("compose", "core/leaf.wgsl:4")]);
}

#[test]
fn formats_limits_and_padding_are_checked() {
    let pass = PASS.replace("rgba16float", "rg8unorm");
    assert!(found(MODULE, &pass).contains(&pair("formats", "core/passes/pass.wgsl:6")));
    let pass = PASS.replace("workgroup_size(8, 8)", "workgroup_size(32, 32)");
    assert_eq!(found(MODULE, &pass), [pair("limits", "core/passes/pass.wgsl:8")]);
    let pass = PASS.replace("color: vec3<f32>, gain: f32", "gain: f32, color: vec3<f32>");
    assert_eq!(found(MODULE, &pass), [pair("padding", "core/passes/pass.wgsl:2")]);
}

#[test]
fn what_the_flat_form_loses_is_found() {
    let pass = PASS.replace(
        "color: vec3<f32>, gain: f32",
        "color: vec3<f32>, @size(20) gain: f32, b: vec3<f32>, c: f32",
    );
    assert!(found(MODULE, &pass).contains(&pair("flat", "core/passes/pass.wgsl")));
}

#[test]
fn what_glsl_cannot_have_is_an_unexpected_failure() {
    // One texture with two samplers.
    let pass = PASS
        .replace(
            "var linear: sampler;",
            "var linear: sampler;\n@group(#{GROUP}) @binding(9) var nearest: sampler;",
        )
        .replace("* leaf::twice", "+ leaf::look(picture, nearest, vec2<f32>(id.xy)) * leaf::twice");
    assert_eq!(found(MODULE, &pass), [pair("glsl", "core/passes/pass.wgsl:9")]);
}

#[cfg(unix)]
#[test]
fn the_other_compiler_reads_the_expressions_of_the_sources() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("tint");
    // Refuses what naga's writer leaves out.
    let script = "#!/bin/sh\nfor file; do :; done\nwhile IFS= read -r line; do case \"$line\" in *refused*)\necho \
        '[{\"severity\":\"error\",\"message\":\"no\",\"range\":{\"start\":{\"line\":1,\"column\":1}}}]'\nexit 1;;\n\
        esac; done <\"$file\"\n";
    std::fs::write(&program, script).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let found = |pass: &str| {
        let library = Library::from_text(
            &[("core/leaf.wgsl", MODULE)],
            &[("core/passes/pass.wgsl", pass)],
            &[("core", "pass\n+ default:\n")],
        );
        let options = Options { path: Some(folder.path().into()), ..Options::default() };
        let findings = run(&library, &options).unwrap().findings;
        findings.into_iter().map(|finding| (finding.check, finding.file)).collect::<Vec<_>>()
    };
    assert_eq!(found(PASS), []);
    let pass = PASS.replace("    cells[id.x] = 1u;", "    // This is refused.\n    cells[id.x] = 1u;");
    assert_eq!(found(&pass), [pair("tint", "core/passes/pass.wgsl")]);
}

#[test]
fn a_required_program_that_is_absent_is_a_finding() {
    let library = Library::from_text(&[("core/leaf.wgsl", MODULE)], &[], &[]);
    let options = Options { require: vec![Tool::Tint], path: Some(OsString::new()), ..Options::default() };
    let report = run(&library, &options).unwrap();
    assert!(!report.is_clean());
    assert_eq!(report.findings[0].check, "tint");
}

#[test]
fn a_module_is_checked_with_the_definitions_of_its_passes() {
    let module = format!("{MODULE}#ifdef SIZED\nconst SIZE: u32 = #{{SIZED}}u;\n#endif\n");
    let library = Library::from_text(
        &[("core/leaf.wgsl", &module)],
        &[("core/passes/pass.wgsl", PASS)],
        &[("core", "pass\n+ default:\n+ four: SIZED=4 OTHER\n")],
    );
    let sets: Vec<String> = subjects(&library)
        .iter()
        .filter_map(|subject| match subject {
            Subject::Module { definitions, .. } => Some(definitions.to_string()),
            Subject::Pass { .. } => None,
        })
        .collect();
    assert_eq!(sets, ["", "SIZED=4"]);
}
