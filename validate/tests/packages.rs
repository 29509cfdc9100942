// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the crate and the npm package of `wgsl/` hold.
#![allow(clippy::unwrap_used, missing_docs)]

use airlight_validate::files_below;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn text(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn the_crate_holds_every_shader_and_nothing_of_npm() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root()).args([
        "package",
        "-p",
        "airlight-wgsl",
        "--list",
        "--allow-dirty",
        "--offline",
    ]);
    let output = command.output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{errors}");
    assert_eq!(errors, "", "cargo warns");
    let listed = String::from_utf8(output.stdout).unwrap().replace('\\', "/");
    let listed: BTreeSet<String> = listed.lines().map(str::to_owned).collect();

    let mut expected = files_below(&root().join("wgsl"), "wgsl").unwrap();
    assert!(expected.len() > 150, "{} shaders are too few to be the library", expected.len());
    expected.extend(airlight_wgsl::SYSTEMS.iter().map(|system| format!("{}/permutations", system.name)));
    for file in ["manifest.json", "README.md", "LICENSE-MIT", "LICENSE-APACHE", "UNLICENSE", "src/lib.rs"] {
        expected.insert(file.to_owned());
    }
    let missing: Vec<&String> = expected.difference(&listed).collect();
    assert!(missing.is_empty(), "not in the package: {missing:?}");
    let foreign =
        |file: &&String| file.ends_with(".js") || file.ends_with(".ts") || file.ends_with("package.json");
    assert_eq!(listed.iter().find(foreign), None);
}

#[test]
fn both_packages_have_one_version_and_licence() {
    let npm: serde_json::Value = serde_json::from_str(&text("wgsl/package.json")).unwrap();
    assert_eq!(npm["name"], "airlight-wgsl");
    // The crates of the workspace share theirs.
    assert_eq!(npm["version"], env!("CARGO_PKG_VERSION"));
    let licence = npm["license"].as_str().unwrap();
    assert!(text("wgsl/Cargo.toml").contains(&format!("license = \"{licence}\"")), "{licence}");
    for file in ["LICENSE-MIT", "LICENSE-APACHE", "UNLICENSE"] {
        assert_eq!(text(&format!("wgsl/{file}")), text(file), "{file}");
    }
}
