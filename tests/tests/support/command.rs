// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command `airlight` as a person starts it, and what every refusal must look like.
#![allow(dead_code, clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// An empty folder, gone with what is returned.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Arguments from one line; none of them has a space in it.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// A release binary of the workspace, beside the one that runs this test.
pub fn binary(name: &str) -> PathBuf {
    let own = std::env::current_exe().unwrap();
    // target/release/deps/<this test>
    let folder = own.parent().and_then(Path::parent).unwrap();
    let binary = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(
        binary.is_file(),
        "there is no {}: run `cargo build --release --workspace --bins` first",
        binary.display()
    );
    binary
}

/// How a run of the command ended.
#[derive(Debug)]
pub struct Ended {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// Runs `airlight` in `folder`, with further variables of the environment.
pub fn airlight_with(folder: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Ended {
    let output = Command::new(binary("airlight"))
        .args(arguments)
        .current_dir(folder)
        // Without it the Vulkan loader's window system layer complains on standard error.
        .env("XDG_RUNTIME_DIR", std::env::temp_dir())
        .envs(variables.iter().copied())
        .output()
        .unwrap();
    Ended {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Runs `airlight` in `folder`.
pub fn airlight(folder: &Path, arguments: &[&str]) -> Ended {
    airlight_with(folder, arguments, &[])
}

/// Runs `airlight` and expects success.
#[track_caller]
pub fn succeeds(folder: &Path, arguments: &[&str]) -> Ended {
    let ended = airlight(folder, arguments);
    assert_eq!(ended.code, 0, "airlight {}\n{}", arguments.join(" "), ended.err);
    ended
}

/// Runs a line that writes `x.exr`, and expects a finite number everywhere in it.
#[track_caller]
pub fn draws_finite(folder: &Path, line: &str) {
    succeeds(folder, &words(line));
    let picture = image::open(folder.join("x.exr")).unwrap().into_rgba32f();
    assert!(picture.as_raw().iter().all(|value| value.is_finite()), "{line}");
}

/// Every file below a folder with its contents.
pub fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                found.insert(path.clone(), Vec::new());
                open.push(path);
            } else {
                // Those that are large are large on purpose, and told apart by their size.
                let length = path.metadata().unwrap().len();
                let contents = if length > 1 << 24 {
                    length.to_le_bytes().to_vec()
                } else {
                    std::fs::read(&path).unwrap()
                };
                found.insert(path, contents);
            }
        }
    }
    found
}

/// Runs `airlight` and expects one clear error: its exit code, one line on standard error (clap may take more), every
/// one of `parts` in it, no panic, and not one file made or changed.
#[track_caller]
pub fn refuses(folder: &Path, arguments: &[&str], code: i32, parts: &[&str]) {
    let before = files(folder);
    let ended = airlight(folder, arguments);
    let told = format!("airlight {}\nended with {} and said: {}", arguments.join(" "), ended.code, ended.err);
    assert_eq!(ended.code, code, "{told}");
    assert!(!ended.err.contains("panicked"), "{told}");
    // clap starts with `error:`; it knows only misuse.
    let clap = ended.err.starts_with("error: ");
    assert!(if clap { code == 2 } else { ended.err.starts_with("airlight: ") }, "{told}");
    assert!(clap || ended.err.trim_end().lines().count() == 1, "more than a line: {told}");
    for part in parts {
        assert!(ended.err.contains(part), "`{part}` is missing: {told}");
    }
    assert!(files(folder) == before, "files were made or changed: {told}");
}

/// As [`refuses`], and before any work of a GPU: where there is no adapter the same is said.
#[track_caller]
pub fn refuses_first(folder: &Path, arguments: &[&str], code: i32, parts: &[&str]) {
    refuses(folder, arguments, code, parts);
    let nowhere = folder.join("no-driver.json").display().to_string();
    let none = [("VK_DRIVER_FILES", nowhere.as_str()), ("VK_ICD_FILENAMES", nowhere.as_str())];
    let ended = airlight_with(folder, arguments, &none);
    let told = format!("airlight {}\nended with {} and said: {}", arguments.join(" "), ended.code, ended.err);
    assert!(ended.code == code && !ended.err.contains("no GPU adapter"), "{told}");
}
