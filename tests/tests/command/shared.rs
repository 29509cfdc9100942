// SPDX-License-Identifier: MIT OR Apache-2.0
//! The command as a person meets it: `list`, `info`, and what `scattering` does with bad input.
//! `airlight run` is tested in `run.rs` and `run_refusals.rs`.

use crate::command::{airlight, airlight_with, files, folder, refuses, succeeds};
use airlight_wgsl::{MODULES, PASSES};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn summary(source: &str) -> &str {
    source.lines().find_map(|line| line.strip_prefix("// summary: ")).unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let ended = succeeds(folder, arguments);
    serde_json::from_str(&ended.out).unwrap_or_else(|error| panic!("{error}: {}", ended.out))
}

fn find<'a>(list: &'a Value, key: &str, name: &str) -> &'a Value {
    let found = list.as_array().unwrap().iter().find(|item| item[key] == name);
    found.unwrap_or_else(|| panic!("no {name} in {list}"))
}

#[test]
fn list_has_every_pass_and_module_with_its_summary() {
    let at = folder();
    let text = succeeds(at.path(), &["list"]).out;
    let value = json(at.path(), &["list", "--json"]);
    for (name, source) in PASSES.iter().map(|pass| (pass.name, pass.source)) {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(name));
        assert!(line.is_some_and(|line| line.ends_with(summary(source))), "{name}: {text}");
        assert_eq!(find(&value["passes"], "name", name)["summary"], summary(source));
    }
    for (path, source) in MODULES.iter().map(|module| (module.path, module.source)) {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(path));
        assert!(line.is_some_and(|line| line.ends_with(summary(source))), "{path}: {text}");
        assert_eq!(find(&value["modules"], "path", path)["summary"], summary(source));
    }
    assert_eq!(value["passes"].as_array().unwrap().len(), PASSES.len());
    assert_eq!(value["modules"].as_array().unwrap().len(), MODULES.len());

    let core = json(at.path(), &["list", "core", "--json"]);
    let passes = core["passes"].as_array().unwrap();
    assert_eq!(passes.len(), PASSES.iter().filter(|pass| pass.name.starts_with("core/")).count());
    assert!(passes.iter().all(|pass| pass["name"].as_str().unwrap().starts_with("core/")));
}

#[test]
fn list_of_a_pass_says_what_run_needs() {
    let at = folder();
    let scan = json(at.path(), &["list", "core/scan", "--json"]);
    assert_eq!(scan["permutation"], "default");
    let entry = find(&scan["entry_points"], "name", "scan_blocks");
    assert_eq!(
        (&entry["stage"], &entry["workgroup_size"]),
        (&Value::from("compute"), &Value::from(vec![256, 1, 1]))
    );
    let sums = find(&scan["bindings"], "name", "block_sums");
    assert_eq!(sums["kind"], "storage array<u32>, read and written");
    assert!(sums["text"].as_str().unwrap().starts_with("one per block of 1024 values"), "{sums}");
    let parameters = find(&scan["structs"], "name", "ScanParameters");
    assert_eq!(parameters["size"], 16);
    let count = find(&parameters["members"], "name", "count");
    assert_eq!((&count["type"], &count["offset"]), (&Value::from("u32"), &Value::from(0)));

    // Another permutation has other bindings; the definitions are told.
    let text = succeeds(at.path(), &["list", "scattering/filter"]).out;
    for part in [
        "BASES=32",
        "average",
        "a multiple of 4 from 4 to 128",
        "medium: uniform Medium, 32 bytes",
        "12  extinction",
    ] {
        assert!(text.contains(part), "`{part}` is missing: {text}");
    }
    let text = succeeds(at.path(), &["list", "scattering/filter:average"]).out;
    assert!(!text.contains("uniform Medium") && text.contains("Bindings of other permutations"), "{text}");
    for permutation in ["march:default", "march:shadow_map"] {
        let text = succeeds(at.path(), &["list", &format!("scattering/{permutation}")]).out;
        assert_eq!(text.contains("shadow_map: 2d texture"), permutation.ends_with("shadow_map"), "{text}");
    }
    let text = succeeds(at.path(), &["list", "airlight::core::phase"]).out;
    assert!(text.contains("fn henyey_greenstein("), "{text}");
}

#[test]
fn list_refuses_names_that_are_not_there() {
    let at = folder();
    refuses(at.path(), &["list", "nope"], 2, &["`nope`", "core, inverse, painterly"]);
    refuses(at.path(), &["list", "core/nope"], 2, &["core/nope", "core/scan"]);
    refuses(at.path(), &["list", "core/scan:nope"], 2, &["core/scan", "nope", "default"]);
    refuses(at.path(), &["list", "airlight::nope"], 2, &["airlight::nope", "airlight::core::phase"]);
    refuses(at.path(), &["list", "--shaders", "nowhere"], 1, &["--shaders", "nowhere"]);
    refuses(at.path(), &["nope"], 2, &["nope"]);
    assert_eq!(airlight(at.path(), &[]).code, 2);
}

#[test]
fn info_names_the_adapter_and_the_limits_in_force() {
    let at = folder();
    let text = succeeds(at.path(), &["info"]).out;
    let value = |name: &str| {
        let line = text.lines().find_map(|line| line.trim_start().strip_prefix(name));
        line.unwrap_or_else(|| panic!("no {name}: {text}")).trim().to_owned()
    };
    for name in ["adapter ", "type ", "back end ", "driver "] {
        assert!(!value(name).is_empty(), "{text}");
    }
    assert_eq!(value("width and height of a texture"), "8192");
    assert_eq!(value("storage buffer "), "128 MiB");
    assert_eq!(value("workgroups a dimension"), "65535");
}

#[test]
fn without_an_adapter_there_is_a_remedy() {
    let at = folder();
    let nowhere = at.path().join("no-driver.json").display().to_string();
    let none = [("VK_DRIVER_FILES", nowhere.as_str()), ("VK_ICD_FILENAMES", nowhere.as_str())];
    let ended = airlight_with(at.path(), &["info"], &none);
    assert_eq!(ended.code, 1, "{ended:?}");
    assert!(
        ended.err.starts_with("airlight: no GPU adapter") && ended.err.contains("mesa-vulkan-drivers"),
        "{ended:?}"
    );
    assert_eq!(ended.err.lines().count(), 1, "{ended:?}");
    assert_eq!(ended.out, "");
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn scene() -> TempDir {
    let at = folder();
    std::fs::write(at.path().join("mesh.obj"), TETRAHEDRON).unwrap();
    std::fs::write(at.path().join("empty.obj"), "").unwrap();
    std::fs::write(at.path().join("nothing.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    std::fs::write(at.path().join("beyond.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").unwrap();
    std::fs::write(at.path().join("infinite.obj"), "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(at.path().join("garbage.obj"), [0xff_u8, 0xfe, 0, 1, 2, 3, 0x80, 0x81].repeat(50))
        .unwrap();
    std::fs::write(at.path().join("garbage.glb"), [0xff_u8, 0xfe, 0, 1, 2, 3, 0x80, 0x81].repeat(50))
        .unwrap();
    std::fs::write(at.path().join("mesh.txt"), "no mesh").unwrap();
    std::fs::write(at.path().join("old.png"), "old").unwrap();
    std::fs::create_dir(at.path().join("folder.png")).unwrap();
    at
}

const SMALL: [&str; 6] = ["--map", "64x64", "--size", "32x24", "--bases", "8"];

/// `airlight scattering` at a small size, with flags that take the place of its own.
fn scattering<'a>(changed: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["scattering"];
    let mut own: Vec<&'a str> = SMALL.to_vec();
    own.extend(["--mesh", "mesh.obj", "--out", "old.png"]);
    for pair in own.chunks(2) {
        let spelled = format!("{}=", pair[0]);
        if !changed.iter().any(|argument| *argument == pair[0] || argument.starts_with(&spelled)) {
            arguments.extend(pair);
        }
    }
    arguments.extend(changed);
    arguments
}

#[test]
fn scattering_refuses_meshes_that_are_none() {
    let at = scene();
    for file in [
        "missing.obj",
        "empty.obj",
        "nothing.obj",
        "beyond.obj",
        "infinite.obj",
        "garbage.obj",
        "garbage.glb",
        "mesh.txt",
        "folder.png",
    ] {
        refuses(at.path(), &scattering(&["--mesh", file]), 1, &["--mesh", file]);
    }
    refuses(at.path(), &scattering(&["--mesh", "mesh.obj", "--mesh", "missing.obj"]), 1, &["missing.obj"]);
    refuses(at.path(), &["scattering", "--out", "x.png"], 2, &["--mesh"]);
    refuses(at.path(), &["scattering", "--mesh", "mesh.obj"], 2, &["--out"]);
}

#[test]
fn scattering_refuses_what_cannot_be_meant() {
    let at = scene();
    let bad = |changed: &[&str], parts: &[&str]| refuses(at.path(), &scattering(changed), 2, parts);
    bad(&["--eye=1,2,3", "--target=1,2,3"], &["--eye", "--target", "1, 2, 3"]);
    for vector in ["1,2", "1,2,3,4", "1,nan,3", "inf,0,0", "a,b,c", ""] {
        bad(&[&format!("--eye={vector}")], &["--eye", vector]);
        bad(&[&format!("--target={vector}")], &["--target", vector]);
    }
    for fov in ["0", "-10", "180", "nan", "wide"] {
        bad(&[&format!("--fov={fov}")], &["--fov", fov]);
    }
    bad(&["--near", "0"], &["--near", "0"]);
    bad(&["--near", "2", "--far", "1"], &["--near", "--far", "2", "1"]);
    bad(&["--far", "nan"], &["--far", "nan"]);
    for light in ["sun", "directional:1", "directional:0,91", "directional:nan,0", "spot:1,2"] {
        bad(&["--light", light], &["--light", light]);
    }
    for value in ["-1", "nan", "inf", "2000000", "thick"] {
        bad(&[&format!("--extinction={value}")], &["--extinction", value]);
    }
    for value in ["-0.1", "1.1", "nan"] {
        bad(&[&format!("--albedo={value}")], &["--albedo", value]);
    }
    for value in ["-1", "1", "nan"] {
        bad(&[&format!("--g={value}")], &["--g", value]);
    }
    for value in ["33", "0", "132", "-4", "many"] {
        bad(&[&format!("--bases={value}")], &["--bases", value]);
    }
    for value in ["0x10", "10", "axb", "-1x5"] {
        bad(&[&format!("--size={value}")], &["--size", value]);
        bad(&[&format!("--map={value}")], &["--map", value]);
    }
    bad(&["--size", "100000x10"], &["--size", "100000x10", "8192"]);
    bad(&["--map", "10x100000"], &["--map", "10x100000", "8192"]);
    bad(&["--method", "magic"], &["--method", "magic", "fourier", "march"]);
    bad(&["--out", "x.gif"], &["--out", "x.gif"]);
    bad(&["--nope", "1"], &["--nope"]);
}

#[test]
fn scattering_refuses_places_that_cannot_be_written() {
    let at = scene();
    let bad = |changed: &[&str], parts: &[&str]| refuses(at.path(), &scattering(changed), 1, parts);
    bad(&["--out", "no/such/x.png"], &["--out", "no/such"]);
    bad(&["--out", "old.png/x.png"], &["--out", "old.png"]);
    bad(&["--out", "folder.png"], &["--out", "folder.png"]);
    // Neither picture nor part of the buffers.
    bad(&["--out", "x.png", "--buffers", "mesh.obj/buffers"], &["--buffers", "mesh.obj"]);
}

/// The picture, and the alpha-free values of its pixels.
fn pixels(path: &Path) -> (u32, u32, Vec<u8>) {
    let picture = image::open(path).unwrap().to_rgb8();
    (picture.width(), picture.height(), picture.into_raw())
}

#[test]
fn scattering_draws_and_zero_extinction_is_a_clear_picture() {
    let at = scene();
    let before = files(at.path()).len();
    for (name, more) in [
        ("clear", &["--extinction", "0"][..]),
        ("clear_march", &["--extinction", "0", "--method", "march"]),
        ("hazy", &["--extinction", "0.4"]),
        ("hazy_march", &["--extinction", "0.4", "--method", "march"]),
    ] {
        let file = format!("{name}.png");
        let ended = airlight(at.path(), &[&scattering(&["--out", &file])[..], more].concat());
        assert_eq!(ended.code, 0, "{name}: {ended:?}");
        assert!(!ended.err.contains("panicked"), "{name}: {ended:?}");
    }
    assert_eq!(files(at.path()).len(), before + 4);
    let [clear, clear_march, hazy, hazy_march] = ["clear", "clear_march", "hazy", "hazy_march"]
        .map(|name| pixels(&at.path().join(format!("{name}.png"))));
    assert_eq!((clear.0, clear.1), (32, 24));
    let values = clear.2.iter().max().unwrap() - clear.2.iter().min().unwrap();
    assert!(values > 20, "the clear picture shows nothing: a range of {values}");
    // Without a medium the methods have nothing to differ by.
    assert_eq!(clear, clear_march);
    let difference = |a: &[u8], b: &[u8]| {
        let sum: u64 = a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        sum as f64 / a.len() as f64
    };
    let (medium, methods) = (difference(&clear.2, &hazy.2), difference(&hazy.2, &hazy_march.2));
    assert!(medium > 4.0, "the medium changes the picture by {medium} only");
    assert!(methods < 0.25 * medium, "methods differ by {methods}, the medium by {medium}");
}

#[test]
fn scattering_writes_its_buffers_on_request() {
    let at = scene();
    succeeds(at.path(), &scattering(&["--out", "x.png", "--buffers", "buffers", "--quiet"]));
    let arrays: Vec<_> = files(&at.path().join("buffers")).into_keys().collect();
    assert!(arrays.len() >= 4, "{arrays:?}");
    for path in arrays {
        assert_eq!(path.extension().unwrap(), "npy", "{}", path.display());
        assert_eq!(std::fs::read(&path).unwrap()[..6], *b"\x93NUMPY", "{}", path.display());
    }
}
