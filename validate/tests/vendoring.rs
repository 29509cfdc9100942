// SPDX-License-Identifier: MIT OR Apache-2.0
//! Exit codes and messages of `airlight-validate abi`, `flatten`, `vendor` and `verify`.
#![cfg(feature = "command")]
#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let program = env!("CARGO_BIN_EXE_airlight-validate");
    let Output { status, stdout, stderr } =
        Command::new(program).current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

#[test]
fn abi_holds_a_breaking_change_to_a_version() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = |name: &str, version: &str, binding: u32| {
        let text = format!(
            "{{\"format\": 1, \"version\": \"{version}\", \"modules\": [], \"passes\": [{{\"name\": \"a/p\", \"permutations\": \
             [{{\"name\": \"default\", \"bindings\": [{{\"name\": \"view\", \"binding\": {binding}}}]}}]}}]}}"
        );
        fs::write(folder.path().join(name), text).unwrap();
    };
    manifest("old", "0.1.0", 0);
    manifest("same", "0.1.1", 0);
    manifest("broken", "0.1.1", 1);
    manifest("bumped", "0.2.0", 1);
    let abi = |old: &str, new: &str| run(folder.path(), &["abi", old, new]);
    assert_eq!(abi("old", "old"), (0, String::new(), String::new()));
    assert_eq!(abi("old", "same").0, 0);
    let (code, listed, message) = abi("old", "broken");
    assert_eq!(code, 1);
    assert!(listed.starts_with("breaking: a/p:default, binding view, binding: 0 -> 1"), "{listed}");
    assert!(message.contains("it goes from 0.1.0 to 0.1.1"), "{message}");
    let (code, listed, _) = abi("old", "bumped");
    assert_eq!(code, 0);
    assert!(listed.contains("breaking: a/p:default"), "{listed}");
    fs::write(folder.path().join("other"), "{\"format\": 7}").unwrap();
    for (file, part) in [("none", "cannot read none"), ("other", "has format 7")] {
        let (code, _, message) = abi("old", file);
        assert_eq!(code, 2);
        assert!(message.contains("NEW: ") && message.contains(part), "{message}");
    }
}

#[test]
fn vendored_files_are_verified() {
    let folder = tempfile::tempdir().unwrap();
    let here = |arguments: &[&str]| run(folder.path(), arguments);
    let (code, _, message) = here(&["verify", "copy"]);
    assert_eq!(code, 2);
    assert!(message.contains("has no airlight.lock.json"), "{message}");
    let (code, _, message) = here(&["vendor", "copy", "--pass", "core/nothing"]);
    assert_eq!(code, 2);
    assert!(message.contains("core/scan"), "{message}");
    assert!(!folder.path().join("copy").exists());

    for form in ["naga_oil", "flat"] {
        let vendor = ["vendor", "copy", "--pass", "core/tonemap", "--form", form];
        assert_eq!(here(&vendor).0, 0);
        let (code, listed, _) = here(&["verify", "copy"]);
        assert_eq!(code, 0, "{listed}");
        assert!(
            listed.contains("UNLICENSE: unmodified") && listed.contains("all unmodified and current"),
            "{listed}"
        );
    }
    // The sources went when the flat files came.
    assert!(!folder.path().join("copy/core/color.wgsl").exists());

    let file = folder.path().join("copy/core/tonemap.wgsl");
    fs::write(&file, fs::read_to_string(&file).unwrap() + "// mine\n").unwrap();
    let (code, listed, _) = here(&["verify", "copy"]);
    assert_eq!(code, 1);
    assert!(listed.contains("tonemap.wgsl: locally changed\n"), "{listed}");
    let (code, listed, _) = here(&["verify", "copy", "--format", "github"]);
    assert_eq!((code, listed.lines().count()), (1, 1));
    assert!(listed.starts_with("::error file=copy"), "{listed}");
    let (code, listed, _) = here(&["verify", "copy", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&listed).unwrap();
    assert_eq!((code, &json["form"]), (1, &serde_json::json!("flat")));
    let states: Vec<_> = json["files"].as_array().unwrap().iter().map(|file| &file["state"]).collect();
    assert_eq!(states, ["unmodified", "unmodified", "unmodified", "changed"]);

    let again = ["vendor", "copy", "--pass", "core/tonemap", "--form", "flat"];
    let (code, _, message) = here(&again);
    assert_eq!(code, 1);
    assert!(message.contains("core/tonemap.wgsl was changed locally"), "{message}");
    assert_eq!(here(&[again.as_slice(), &["--force"]].concat()).0, 0);
    assert_eq!(here(&["verify", "copy"]).0, 0);
}

#[test]
fn flat_files_are_kept_fresh() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(run(folder.path(), &["vendor", "wgsl", "--pass", "core/resolve_depth"]).0, 0);
    let flatten = |more: &[&str]| run(folder.path(), &[&["flatten"], more].concat());
    let (code, _, message) = flatten(&["--check"]);
    assert_eq!(code, 1);
    assert!(message.contains("is missing; run `airlight-validate flatten wgsl`"), "{message}");
    assert_eq!(flatten(&[]).0, 0);
    assert_eq!(flatten(&["--check"]).0, 0);
    let flat = folder.path().join("wgsl/flat/core");
    let (_, printed, _) = run(folder.path(), &["flat", "core/resolve_depth:farthest"]);
    assert_eq!(fs::read_to_string(flat.join("resolve_depth.farthest.wgsl")).unwrap(), printed);
    fs::write(flat.join("old.wgsl"), "").unwrap();
    let (code, _, message) = flatten(&["--check"]);
    assert_eq!(code, 1);
    assert!(message.contains("old.wgsl is superfluous"), "{message}");
    assert_eq!(flatten(&["nowhere"]).0, 2);
}
