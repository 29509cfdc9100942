// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight-validate check` and `explain` on trees of others; the documentation of both.

#![cfg(feature = "command")]
#![allow(clippy::unwrap_used)]
use airlight_validate::check::Lint;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

const GOOD: &str = "@group(0) @binding(0) var<storage, read_write> cells: array<u32>;\n@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n    cells[id.x] = id.y;\n}\n";

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in files {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn command(arguments: &[&str], folder: &Path, path: Option<&str>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_airlight-validate"));
    command.args(arguments).current_dir(folder);
    if let Some(path) = path {
        command.env("PATH", path);
    }
    command.output().unwrap()
}

/// Exit code and what is printed, without programs from outside.
fn run(arguments: &[&str], folder: &Path) -> (i32, String) {
    let output = command(arguments, folder, Some(""));
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}

#[test]
fn exit_codes_and_forms() {
    let tree = folder(&[("a/good.wgsl", GOOD), ("a/bad.wgsl", &GOOD.replace("id.y", "1.5"))]);
    let (code, text) = run(&["check", "a/good.wgsl"], tree.path());
    assert_eq!(code, 0, "{text}");
    assert!(text.ends_with("checked 0 modules, 1 permutation: clean\n"), "{text}");
    let (code, text) = run(&["check", "a", "--quiet"], tree.path());
    assert_eq!(code, 1);
    assert!(text.starts_with("a/bad.wgsl:3:"), "{text}");
    let (_, text) = run(&["check", "a", "--format", "github"], tree.path());
    assert!(text.starts_with("::error file=a/bad.wgsl,line=3,col="), "{text}");
    let (_, text) = run(&["check", "a", "--format", "json"], tree.path());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["findings"][0]["check"], "compose");
    assert_eq!((json["errors"].as_u64(), json["permutations"].as_u64()), (Some(1), Some(2)));
    let (code, text) = run(&["check", "a", "--allow", "compose"], tree.path());
    assert_eq!(code, 0, "{text}");
}

#[test]
fn misuse_is_two_and_says_what_there_is() {
    let tree = folder(&[("empty/a.txt", ""), ("a/good.wgsl", GOOD)]);
    let cases: [(&[&str], &str); 8] = [
        (&["check", "gone"], "does not exist"),
        (&["check", "empty"], "holds no `.wgsl`"),
        (&["check", "a", "--allow", "tinted"], "uniformity"),
        (&["check", "a", "--define", "A=x"], "A=x"),
        (&["check", "a", "--permutations", "gone"], "--permutations `gone`"),
        (&["check", "a", "--module-dir", "gone"], "--module-dir `gone`"),
        (&["check", "--define", "A"], "need DIR"),
        (&["explain", "tinted"], "uniformity"),
    ];
    for (arguments, part) in cases {
        let (code, text) = run(arguments, tree.path());
        assert_eq!(code, 2, "{arguments:?}: {text}");
        assert!(text.contains(part), "{arguments:?}: {text}");
    }
}

#[test]
fn flags_reach_the_check() {
    let shader = "#import m::one::f\n#ifdef BAD\nconst x: u32 = 1.5;\n#endif\n@compute @workgroup_size(#{SIZE}) fn main() { _ = f(); }\n";
    let tree = folder(&[
        ("s/a.wgsl", shader),
        ("s/permutations", "a.wgsl\n+ default:\n"),
        ("list", "a.wgsl\n+ default:\n+ bad: BAD\n"),
        ("lib/one.wgsl", "#define_import_path m::one\nfn f() -> u32 { return 1u; }\n"),
    ]);
    let (code, text) = run(&["check", "s", "--quiet"], tree.path());
    assert_eq!((code, text.contains("unresolved-import")), (1, true), "{text}");
    let arguments = ["check", "s", "--module-dir", "lib", "--define", "SIZE=8", "--define", "OTHER"];
    let (code, text) = run(&arguments, tree.path());
    assert_eq!(code, 0, "{text}");
    let (code, text) = run(&[&arguments[..], &["--permutations", "list"]].concat(), tree.path());
    assert_eq!((code, text.contains("s/a.wgsl:3:7")), (1, true), "{text}");
    assert!(text.contains("(s/a.wgsl:bad)"), "{text}");
}

#[test]
fn explain_lists_and_explains() {
    let tree = folder(&[]);
    let (code, text) = run(&["explain"], tree.path());
    assert_eq!((code, text.lines().count()), (0, Lint::all().count()));
    for lint in Lint::all() {
        let (code, text) = run(&["explain", lint.name], tree.path());
        assert_eq!(code, 0);
        assert!(text.contains(lint.why) && text.contains(lint.mend), "{text}");
    }
}

/// With Tint, a finding in a composed file has the place in the module's own file.
#[test]
fn tint_speaks_of_the_source() {
    let path = std::env::var("PATH").unwrap_or_default();
    if !std::env::split_paths(&path).any(|folder| folder.join("tint").is_file()) {
        assert!(!std::env::var("AIRLIGHT_REQUIRE").is_ok_and(|required| required.contains("tint")));
        return;
    }
    let module = "#define_import_path m::wait\n\nfn wait(i: u32) {\n    let j = i * 2u;\n    if j < 4u {\n        workgroupBarrier();\n    }\n}\n";
    let shader = "#import m::wait::wait\n@compute @workgroup_size(8) fn main(@builtin(local_invocation_index) i: u32) {\n    wait(i);\n}\n";
    let plain = GOOD.replace("    cells", "    /* é */ if id.x > 2u { workgroupBarrier(); }\n    cells");
    let tree = folder(&[("wait.wgsl", module), ("s.wgsl", shader), ("plain.wgsl", &plain)]);
    let output = command(&["check", ".", "--quiet", "--require", "tint"], tree.path(), None);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("wait.wgsl:6:9: error: [uniformity]"), "{text}");
    assert!(text.contains("plain.wgsl:3:28: error: [uniformity]"), "{text}");
}

#[test]
fn the_page_has_the_table_of_lints() {
    let page = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/src/checking.md");
    let text = fs::read_to_string(page).unwrap();
    assert!(text.contains(&Lint::table()), "docs/src/checking.md should hold this table:\n{}", Lint::table());
    for flag in ["--define", "--permutations", "--module-dir", "--format", "--require", "--allow", "--quiet"]
    {
        assert!(text.contains(&format!("`{flag}")), "{flag}");
    }
}

/// The action names only flags that the command has, and every input of it is used.
#[test]
fn the_action_fits_the_command() {
    let action = fs::read_to_string(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("action.yml")).unwrap();
    let help = run(&["check", "--help"], &std::env::temp_dir()).1;
    let flags: Vec<&str> = action.split_whitespace().filter(|word| word.starts_with("--")).collect();
    for flag in flags.iter().map(|flag| flag.trim_end_matches([')', '"', ';'])) {
        let is_cargo = matches!(flag, "--locked" | "--path" | "--git" | "--root" | "--quiet");
        assert!(is_cargo || help.contains(flag), "{flag}");
    }
    let inputs = action.split("inputs:").nth(1).unwrap().split("\nruns:").next().unwrap();
    let names = inputs.lines().filter(|line| line.starts_with("  ") && !line.starts_with("    "));
    for name in names.map(|line| line.trim().trim_end_matches(':')) {
        assert!(action.contains(&format!("${{{{ inputs.{name} }}}}")), "{name}");
    }
}
