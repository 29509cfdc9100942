// SPDX-License-Identifier: MIT OR Apache-2.0
//! Trees of others, without programs from outside.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::check::{self, Report};
use std::{ffi::OsString, time::Instant};

/// Writes files below a folder.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in files {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn report(folder: &Path, options: &Options) -> Report {
    let library = open(folder, options).unwrap();
    check::run(&library, &check::Options { path: Some(OsString::new()), ..Default::default() }).unwrap()
}

/// `check file:line:column` of each finding.
fn found(report: &Report, folder: &Path) -> Vec<String> {
    let prefix = format!("{}/", folder.display());
    let number = |number: Option<u32>| number.map_or("-".to_owned(), |number| number.to_string());
    let findings = report.findings.iter();
    findings
        .map(|finding| {
            let file = finding.file.replace(&prefix, "");
            format!("{} {file}:{}:{}", finding.check, number(finding.line), number(finding.column))
        })
        .collect()
}

fn check(files: &[(&str, &str)]) -> (Vec<String>, Report) {
    let folder = folder(files);
    let report = report(folder.path(), &Options::default());
    (found(&report, folder.path()), report)
}

const VIEW: &str =
    "#define_import_path engine_render::view\n\nstruct View { world: mat4x4<f32>, exposure: f32 }\n";
const MATH: &str = "#define_import_path engine_render::maths\nconst PI: f32 = 3.14159;\nfn square(x: f32) -> f32 { return x * x; }\n";
const SHADER: &str = "#import engine_render::view::View\n#import engine_render::maths as maths\n#import \"post/tone.wgsl\" as tone\n@group(0) @binding(0) var<uniform> view: View;\n@fragment fn fragment(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> {\n    return vec4<f32>(tone::map(maths::square(uv.x)) * view.exposure);\n}\n";
const TONE: &str = "#import engine_render::maths::PI\nfn map(x: f32) -> f32 { return x / PI; }\n";
const PLAIN: &str = "@group(0) @binding(0) var<storage, read_write> cells: array<u32>;\n@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n    cells[id.x] = id.y;\n}\n";

#[test]
fn a_sound_tree_of_any_layout_is_clean() {
    let (found, report) = check(&[
        ("render/view.wgsl", VIEW),
        ("maths.wgsl", MATH),
        ("assets/a/shader.wgsl", SHADER),
        ("assets/post/tone.wgsl", TONE),
        ("plain.wgsl", PLAIN),
        (".git/no.wgsl", "no shader"),
        ("notes.txt", "no shader"),
    ]);
    assert_eq!(found, [""; 0], "{report:?}");
    assert_eq!((report.modules, report.permutations), (3, 2));
}

#[test]
fn errors_have_the_place_in_the_source() {
    let plain = format!("\u{feff}{}", PLAIN.replace("id.y", "é + 1u").replace('\n', "\r\n"));
    let tone = TONE.replace("x / PI", "x / PI + 1u");
    let shader = SHADER.replace("view.exposure", "view.exposition");
    let files = [("view.wgsl", VIEW), ("maths.wgsl", MATH), ("shader.wgsl", &shader), ("plain.wgsl", &plain)];
    assert_eq!(
        check(&files).0,
        ["unresolved-import shader.wgsl:3:9", "compose plain.wgsl:3:19"]
            .map(str::to_owned)
            .into_iter()
            .rev()
            .collect::<Vec<_>>()
    );
    let files =
        [("view.wgsl", VIEW), ("maths.wgsl", MATH), ("shader.wgsl", &shader), ("post/tone.wgsl", TONE)];
    assert_eq!(check(&files).0, ["compose shader.wgsl:6:60"]);
    let files =
        [("view.wgsl", VIEW), ("maths.wgsl", MATH), ("shader.wgsl", SHADER), ("post/tone.wgsl", &tone)];
    assert_eq!(check(&files).0, ["compose post/tone.wgsl:2:1"]);
}

#[test]
fn what_cannot_be_resolved_is_said_once_and_the_rest_goes_on() {
    let (found, report) = check(&[
        ("a.wgsl", "#define_import_path t::a\n#import gone::b\nfn f() {}\n"),
        ("c.wgsl", "#define_import_path t::c\n#import t::a\nfn f() { a::f(); }\n"),
        ("d.wgsl", "#import t::c\n@compute @workgroup_size(1) fn main() { c::f(); }\n"),
        ("broken.wgsl", "fn f() -> u32 { return 1.5; }\n"),
    ]);
    assert_eq!(found, ["unresolved-import a.wgsl:2:9", "compose broken.wgsl:1:1"]);
    let skipped: Vec<&String> =
        report.skipped.iter().filter(|text| text.contains("not checked, because")).collect();
    assert_eq!(skipped.len(), 2, "{skipped:?}");
    assert!(skipped.iter().all(|text| text.contains("a.wgsl imports `gone::b`")), "{skipped:?}");
}

#[test]
fn cycles_and_duplicates_are_located() {
    let (found, report) = check(&[
        ("a.wgsl", "#define_import_path t::a\n  #import t::b\nfn f() { b::f(); }\n"),
        ("b.wgsl", "#define_import_path t::b\n#import t::a::f\nfn g() { f(); }\n"),
        ("c.wgsl", "#import t::a\n@compute @workgroup_size(1) fn main() { a::f(); }\n"),
        ("self.wgsl", "#define_import_path t::own\nfn f() {}\n"),
        ("twice.wgsl", "// again\n #define_import_path t::own\nfn f() {}\n"),
    ]);
    assert_eq!(found, ["import-cycle a.wgsl:2:11", "duplicate-module twice.wgsl:2:2"]);
    let cycle = &report.findings[0].message;
    assert!(cycle.contains("t::a -> t::b -> t::a"), "{cycle}");
    assert!(report.skipped.iter().any(|text| text.contains("c.wgsl: not checked, because")));
}

#[test]
fn definitions_reach_every_file_and_permutations_their_own() {
    let shader = "#ifdef BAD\nconst x: u32 = 1.5;\n#endif\nconst N: u32 = #{COUNT}u;\n@compute @workgroup_size(#{COUNT}) fn main() { _ = N; }\n";
    let tree = folder(&[
        ("s/a.wgsl", shader),
        ("list", "s/a.wgsl\n+ fine:\n+ worse: BAD COUNT=300\nnone.wgsl\n+ default:\n"),
    ]);
    let without = found(&report(tree.path(), &Options::default()), tree.path());
    assert_eq!(without, ["compose s/a.wgsl:4:16"], "{without:?}");
    let definitions: Definitions = "COUNT=4".parse().unwrap();
    let options = Options { definitions, ..Options::default() };
    assert_eq!(found(&report(tree.path(), &options), tree.path()), [""; 0]);
    let options = Options { permutations: Some(tree.path().join("list")), ..options };
    let report = report(tree.path(), &options);
    let found = found(&report, tree.path());
    assert_eq!(found[0], "permutations list:4:-");
    assert!(found[1].starts_with("compose s/a.wgsl:2:"), "{found:?}");
    assert_eq!(report.findings[1].permutation.as_deref(), Some("worse"));
    assert_eq!(report.permutations, 2);
}

#[test]
fn module_folders_are_read_and_not_reported() {
    let external = folder(&[("view.wgsl", VIEW), ("bad.wgsl", "#define_import_path ext::bad\nfn f( {\n")]);
    let tree = folder(&[(
        "s.wgsl",
        "#import engine_render::view::View\n@group(0) @binding(0) var<uniform> v: View;\n@compute @workgroup_size(1) fn main() { _ = v.exposure; }\n",
    )]);
    let alone = found(&report(tree.path(), &Options::default()), tree.path());
    assert_eq!(alone, ["unresolved-import s.wgsl:1:9"]);
    let module_dirs = vec![external.path().to_owned()];
    let report = report(tree.path(), &Options { module_dirs, ..Options::default() });
    assert_eq!(found(&report, tree.path()), [""; 0]);
    assert_eq!((report.modules, report.permutations), (0, 1));
}

#[test]
fn an_error_in_a_part_that_nothing_uses_has_its_own_name() {
    let maths = format!("{MATH}fn unused() -> f32 {{\n    return 1u;\n}}\n");
    let (found, _) =
        check(&[("v.wgsl", VIEW), ("m.wgsl", &maths), ("s.wgsl", SHADER), ("post/tone.wgsl", TONE)]);
    assert_eq!(found, ["unused-broken m.wgsl:4:1"]);
}

#[test]
fn limits_and_formats_point_at_the_declaration() {
    let plain = PLAIN.replace("(64)", "(32, 32)").replace("cells:", "cells: array<u32>;\n  @group(0) @binding(1) var t: texture_storage_2d<rgba16float, read_write>;\n@group(1) @binding(0) var<storage, read_write> more:").replace("cells[id.x] = id.y;", "cells[id.x] = id.y;\n textureStore(t, id.xy, vec4<f32>());");
    assert_eq!(check(&[("p.wgsl", &plain)]).0, ["formats p.wgsl:2:29", "limits p.wgsl:4:37"]);
}

#[test]
fn plain_barriers_in_a_branch_are_seen_without_tint() {
    let plain = "@compute @workgroup_size(8) fn main(@builtin(local_invocation_index) i: u32) {\n    if i < 4u {\n        workgroupBarrier();\n    }\n}\n";
    assert_eq!(check(&[("p.wgsl", plain)]).0, ["uniformity p.wgsl:3:9"]);
    let composed = format!("#ifdef NEVER\n#endif\n{plain}");
    assert_eq!(check(&[("p.wgsl", &composed)]).0, ["uniformity p.wgsl:5:9"]);
}

#[test]
fn files_that_are_no_text_are_findings() {
    let tree = folder(&[
        ("good.wgsl", PLAIN),
        ("deep.wgsl", &format!("fn f() {{\nlet a = {}1;}}", "(".repeat(100_000))),
    ]);
    fs::write(tree.path().join("bad.wgsl"), b"// caf\xc3\xa9\n  \xff\xfe").unwrap();
    fs::write(tree.path().join("large.wgsl"), "// long\n".repeat(200_000)).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(tree.path(), tree.path().join("loop")).unwrap();
        std::os::unix::fs::symlink(tree.path().join("nowhere"), tree.path().join("gone.wgsl")).unwrap();
    }
    let found = found(&report(tree.path(), &Options::default()), tree.path());
    let mut expected =
        vec!["unreadable bad.wgsl:2:3", "nesting deep.wgsl:2:2006", "unreadable large.wgsl:-:-"];
    if cfg!(unix) {
        expected.insert(2, "unreadable gone.wgsl:-:-");
    }
    assert_eq!(found, expected);
}

#[test]
fn misuse_says_what_to_do() {
    let empty = folder(&[("a.txt", "")]);
    assert!(open(empty.path(), &Options::default()).unwrap_err().contains("holds no `.wgsl`"));
    assert!(open(Path::new("/no/such"), &Options::default()).unwrap_err().contains("does not exist"));
    let tree = folder(&[("a.wgsl", PLAIN)]);
    let options = Options { permutations: Some("/no/list".into()), ..Options::default() };
    assert!(open(tree.path(), &options).unwrap_err().contains("--permutations"));
    let options = Options { module_dirs: vec!["/no/dir".into()], ..Options::default() };
    assert!(open(tree.path(), &options).unwrap_err().contains("--module-dir"));
    let mut definitions = Definitions::new();
    assert!(define(&mut definitions, "A=1.5").is_err() && define(&mut definitions, "A B").is_err());
    define(&mut definitions, "A=2u").unwrap();
    assert_eq!(definitions.to_string(), "A=2u");
}

#[test]
fn the_layout_is_told_by_permutations() {
    let own = folder(&[("core/permutations", ""), ("core/a.wgsl", "")]);
    assert!(is_airlight_layout(own.path()));
    assert!(!is_airlight_layout(folder(&[("permutations", ""), ("core/a.wgsl", "")]).path()));
    assert!(!is_airlight_layout(Path::new("/no/such")));
}

/// A part of the shipped library, laid out otherwise, checks clean as a tree.
#[test]
fn a_vendored_copy_of_some_modules_is_clean() {
    let tree = tempfile::tempdir().unwrap();
    for module in airlight_wgsl::MODULES.iter().filter(|module| module.file.starts_with("core/")) {
        fs::write(tree.path().join(module.file.replace('/', "_")), module.source).unwrap();
    }
    let report = report(tree.path(), &Options::default());
    assert_eq!(report.findings, []);
    assert!(report.modules > 10);
}

/// No lint fires on the shaders that ship.
#[test]
fn the_shipped_shaders_have_no_lints() {
    let library = Library::builtin();
    let mut texts = Vec::new();
    for pass in library.passes() {
        for permutation in library.permutations(&pass.name).unwrap() {
            texts.push((pass.file.as_str(), &permutation.definitions));
            texts.extend(
                library
                    .closure(&pass.imports)
                    .iter()
                    .map(|module| (module.file.as_str(), &permutation.definitions)),
            );
        }
    }
    assert_eq!(check::lint::shaders(&library, texts.into_iter()), []);
}

#[test]
fn a_hundred_files_take_seconds() {
    let mut files = Vec::new();
    for index in 0..50 {
        let import =
            if index > 0 { format!("#import many::m{}x as before\n", index - 1) } else { String::new() };
        let call = if index > 0 { "before::f(x)" } else { "x" };
        files.push((format!("m/{index}.wgsl"), format!("#define_import_path many::m{index}x\n{import}fn f(x: f32) -> f32 {{ return {call} + 1.0; }}\n")));
        files.push((format!("s/{index}.wgsl"), format!("#import many::m{index}x as own\n@group(0) @binding(0) var<storage, read_write> b: array<f32>;\n@compute @workgroup_size(1) fn main() {{ b[0] = own::f(1.0); }}\n")));
    }
    let files: Vec<(&str, &str)> = files.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    let start = Instant::now();
    let (found, report) = check(&files);
    let taken = start.elapsed();
    assert_eq!(found, [""; 0]);
    assert_eq!((report.modules, report.permutations), (50, 50));
    assert!(taken.as_secs_f32() < 20.0, "{taken:?}");
    println!("100 files in {:.2} s", taken.as_secs_f32());
}
