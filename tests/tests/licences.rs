// SPDX-License-Identifier: MIT OR Apache-2.0
//! Licences of the dependencies, licence lines of the sources, and no paths of the machine in any file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use spdx::{Expression, Licensee, ParseMode};

fn root() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().expect("the tests lie in the workspace").to_owned()
}

/// Whether a dependency may be used under one of `allowed`.
fn permitted(licence: &str, allowed: &[Licensee]) -> Result<bool, String> {
    // Old manifests have `/` for `OR`.
    let expression = Expression::parse_mode(licence, ParseMode::LAX).map_err(|error| error.to_string())?;
    Ok(expression.evaluate(|wanted| allowed.iter().any(|licensee| licensee.satisfies(wanted))))
}

fn allowed() -> Vec<Licensee> {
    let text = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml");
    let table: toml::Table = text.parse().expect("deny.toml is TOML");
    let list = table["licenses"]["allow"].as_array().expect("licenses.allow is a list");
    list.iter()
        .map(|entry| Licensee::parse(entry.as_str().expect("a string")).expect("an SPDX licence"))
        .collect()
}

#[test]
fn every_dependency_is_under_a_permitted_licence() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let metadata = |offline: bool| {
        let mut command = Command::new(&cargo);
        command.current_dir(root()).args(["metadata", "--format-version", "1", "--locked"]);
        command.args(offline.then_some("--offline")).output().expect("cargo runs")
    };
    // Without a network first; crates of other platforms may still have to be fetched.
    let offline = metadata(true);
    let output = if offline.status.success() { offline } else { metadata(false) };
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("a list of packages");
    assert!(packages.len() > 50, "{} packages are too few to be the graph", packages.len());

    let allowed = allowed();
    let mut wrong = Vec::new();
    for package in packages {
        let name = format!("{} {}", package["name"], package["version"]).replace('"', "");
        match package["license"].as_str() {
            None => wrong.push(format!("{name}: no licence expression")),
            Some(licence) => match permitted(licence, &allowed) {
                Ok(true) => {}
                Ok(false) => wrong.push(format!("{name}: {licence}")),
                Err(error) => wrong.push(format!("{name}: {licence:?} is no licence expression: {error}")),
            },
        }
    }
    assert!(wrong.is_empty(), "not permitted by deny.toml:\n{}", wrong.join("\n"));
}

#[test]
fn the_list_tells_licences_apart() {
    let allowed = allowed();
    for (licence, expected) in [
        ("MIT/Apache-2.0", true),
        ("GPL-3.0-only OR MIT", true),
        ("GPL-3.0-only", false),
        ("MIT AND MPL-2.0", false),
        ("Apache-2.0 WITH LLVM-exception", true),
        ("LGPL-2.1-or-later", false),
    ] {
        assert_eq!(permitted(licence, &allowed), Ok(expected), "{licence}");
    }
    assert!(permitted("proprietary, ask us", &allowed).is_err());
}

/// Files that git tracks or would, or without git all that are not built.
fn files() -> BTreeSet<PathBuf> {
    let listed = Command::new("git")
        .current_dir(root())
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .output();
    if let Ok(output) = listed
        && output.status.success()
    {
        let names = String::from_utf8(output.stdout).expect("file names are UTF-8");
        // A file that is deleted but not yet committed is still listed.
        return names
            .split_terminator('\0')
            .map(PathBuf::from)
            .filter(|f| root().join(f).is_file())
            .collect();
    }
    let mut found = BTreeSet::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder of the sources") {
            let entry = entry.expect("an entry of a folder");
            let path = folder.join(entry.file_name());
            let built = ["target", "gallery", ".git", "docs/book"].iter().any(|name| path == Path::new(name));
            if entry.file_type().expect("a type").is_dir() {
                folders.extend((!built).then_some(path));
            } else {
                found.insert(path);
            }
        }
    }
    found
}

/// The licence line that a file must have, if it must.
fn licence_line(path: &Path) -> Option<&'static str> {
    let name = path.file_name()?.to_str()?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let shader = extension == "wgsl" || name == "permutations";
    let source = ["rs", "toml", "sh", "yml", "yaml", "wesl"].contains(&extension)
        || ["Makefile", "run", "expected_failures", ".editorconfig", ".gitattributes"].contains(&name);
    if shader {
        Some("SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense")
    } else {
        source.then_some("SPDX-License-Identifier: MIT OR Apache-2.0")
    }
}

/// Whether one of the first three lines ends in `line`, after a comment mark.
fn has_line(text: &str, line: &str) -> bool {
    text.lines()
        .take(3)
        .any(|found| found.strip_suffix(line).is_some_and(|mark| mark == "// " || mark == "# "))
}

#[test]
fn every_source_file_has_its_licence_line() {
    let mut wrong = Vec::new();
    let mut checked = 0;
    for path in files() {
        let Some(line) = licence_line(&path) else { continue };
        checked += 1;
        let text = std::fs::read_to_string(root().join(&path)).expect("a source file is UTF-8");
        let shader_line = "SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense";
        let has_it = has_line(&text, line) || (path.starts_with("wgsl") && has_line(&text, shader_line));
        if !has_it {
            wrong.push(format!("{}: lacks `{line}`", path.display()));
        }
    }
    assert!(checked > 40, "{checked} files are too few to be the sources");
    assert!(wrong.is_empty(), "in the first three lines:\n{}", wrong.join("\n"));
}

#[test]
fn licence_lines_are_told_apart() {
    let both = "SPDX-License-Identifier: MIT OR Apache-2.0";
    assert!(has_line(&format!("#!/bin/sh\n# {both}\n"), both));
    assert!(has_line(&format!("// {both}\n"), both));
    assert!(!has_line(&format!("// {both} OR Unlicense\n"), both));
    assert!(!has_line(&format!("\n\n\n// {both}\n"), both));
    assert!(licence_line(Path::new("wgsl/core/camera.wgsl")).is_some_and(|line| line.ends_with("Unlicense")));
    assert_eq!(licence_line(Path::new("README.md")), None);
}

/// Where `folder` stands in `text` as a path of its own, not as the end of another.
fn names_folder(text: &[u8], folder: &[u8]) -> bool {
    let part_of_a_name = |byte: u8| byte.is_ascii_alphanumeric() || b"._-/".contains(&byte);
    text.windows(folder.len() + 1).enumerate().any(|(at, window)| {
        window.starts_with(folder)
            && window.ends_with(b"/")
            && !at.checked_sub(1).is_some_and(|before| part_of_a_name(text[before]))
    })
}

#[test]
fn no_file_names_a_folder_of_this_machine() {
    let root = root().canonicalize().expect("the workspace exists");
    let parent = root.parent().filter(|parent| parent.parent().is_some());
    let folders: Vec<&Path> = [Some(root.as_path()), parent].into_iter().flatten().collect();
    let mut wrong = Vec::new();
    for path in files() {
        let bytes = std::fs::read(root.join(&path)).expect("a tracked file");
        for folder in &folders {
            if names_folder(&bytes, folder.as_os_str().as_encoded_bytes()) {
                wrong.push(path.display().to_string());
            }
        }
    }
    assert!(wrong.is_empty(), "these files name {}:\n{}", folders[0].display(), wrong.join("\n"));
}

#[test]
fn folders_are_found_as_paths_of_their_own() {
    let text = b"see \"/srv/build/airlight/target\" and docs/srv/build/x";
    assert!(names_folder(text, b"/srv/build"));
    assert!(!names_folder(text, b"/srv/buil"));
    assert!(!names_folder(b"docs/srv/build/x", b"/srv/build"));
    assert!(!names_folder(b"", b"/srv/build"));
}

#[test]
fn the_shaders_carry_the_licences_of_the_repository() {
    for (file, text) in airlight_wgsl::LICENCES {
        assert_eq!(text, std::fs::read_to_string(root().join(file)).expect("a licence"), "{file}");
    }
}
