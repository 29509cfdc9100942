// SPDX-License-Identifier: MIT OR Apache-2.0
//! `wgsl/manifest.json` is what the shaders say.
#![allow(clippy::unwrap_used)]

use airlight_validate::{Library, manifest};
use std::path::Path;

#[test]
fn the_committed_manifest_is_fresh() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl/manifest.json");
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    let fresh = manifest::render(&Library::builtin()).unwrap();
    let different = committed.lines().zip(fresh.lines()).enumerate().find(|(_, (old, new))| old != new);
    if let Some((line, (old, new))) = different {
        panic!(
            "wgsl/manifest.json:{}: `{old}` should be `{new}`; run `airlight-validate manifest`",
            line + 1
        );
    }
    assert!(
        committed.trim_end() == fresh.trim_end(),
        "wgsl/manifest.json has {} lines instead of {}; run `airlight-validate manifest`",
        committed.lines().count(),
        fresh.lines().count()
    );
}

#[test]
fn the_manifest_does_not_depend_on_where_the_shaders_are_read_from() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../wgsl");
    let from_files = manifest::render(&Library::from_directory(&folder).unwrap()).unwrap();
    assert_eq!(from_files, manifest::render(&Library::builtin()).unwrap());
    serde_json::from_str::<serde_json::Value>(&from_files).unwrap();
}
