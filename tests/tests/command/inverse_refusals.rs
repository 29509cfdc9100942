// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse` with files, views, numbers and flags that cannot be meant, alone or together.

use crate::command::{self, folder, refuses, words};
use crate::painted_views::{SIZE, view, volume};
use std::path::Path;

const FRONT: [f32; 3] = [0.0, 0.0, 9.0];

/// A volume, a target, and a file of views that is sound.
fn prepared() -> tempfile::TempDir {
    let folder = folder();
    let at = folder.path();
    volume(&at.join("box.npy"), |_| [1.0]);
    let picture = |name: &str, size: [u32; 2], value: u8| {
        image::RgbImage::from_pixel(size[0], size[1], image::Rgb([value; 3])).save(at.join(name)).unwrap();
    };
    picture("grey.png", SIZE, 100);
    picture("black.png", SIZE, 0);
    picture("white.png", SIZE, 255);
    picture("small.png", [8, 8], 100);
    std::fs::write(at.join("v.toml"), view("front", FRONT, "target = \"grey.png\"")).unwrap();
    folder
}

#[track_caller]
fn refused(at: &Path, line: &str, code: i32, parts: &[&str]) {
    refuses(at, &words(&format!("inverse {line}")), code, parts);
}

#[test]
fn flags_that_cannot_be_meant_are_refused() {
    let folder = prepared();
    let at = folder.path();
    refused(at, "paint", 2, &["paint"]);
    refused(at, "render --volume box.npy --out out", 2, &["--views"]);
    refused(at, "solve --volume box.npy --views v.toml --out out", 2, &["--for"]);
    let render = |flags: &str, code: i32, parts: &[&str]| {
        let volume = if flags.contains("--volume") { "" } else { "--volume box.npy" };
        refused(at, &format!("render {volume} --views v.toml --out out {flags}"), code, parts);
    };
    render("--volume clowd", 2, &["--volume", "`clowd`", "cloud, clouds, plume, smoke", ".nii.gz"]);
    render("--volume none.npy", 1, &["--volume", "none.npy", "check the path"]);
    render("--volume box.npy --voxels 9", 2, &["--voxels", "--resolution"]);
    render("--volume box.npy --seed 9", 2, &["--seed"]);
    render("--volume cloud --voxel 9", 2, &["--voxel", ".npy"]);
    render("--volume cloud --voxels 3", 2, &["--voxels", "3"]);
    render("--extinction-scale -1", 2, &["--extinction-scale", "0 to 1e6"]);
    render("--ambient -1", 2, &["--ambient", "0 to 10000"]);
    render("--emission -1", 2, &["--emission", "0 to 10000"]);
    render("--albedo 0,1,1.5", 2, &["--albedo", "0 to 1 "]);
    render("--albedo white", 2, &["--albedo", "`white`", ".nii.gz"]);
    render("--albedo none.npy", 1, &["--albedo", "none.npy", "check the path"]);
    render("--steps 0", 2, &["--steps", "0"]);
    render("--steps 2049", 2, &["--steps", "2049"]);
    let solve = |flags: &str, parts: &[&str]| {
        refused(at, &format!("solve --volume box.npy --views v.toml --out out {flags}"), 2, parts);
    };
    solve(
        "--for light,volume",
        &["--for", "`light,volume`", "emission, albedo, emission,albedo, extinction or light"],
    );
    solve("--for emission,emission", &["--for", "`emission,emission`"]);
    for count in ["0", "1025", "-1"] {
        solve(&format!("--for albedo --iterations {count}"), &["--iterations", count]);
    }
    for flag in ["--laplacian", "--smallness", "--oneness"] {
        solve(&format!("--for albedo {flag} -1"), &[flag, "0 to 1000000"]);
        solve(&format!("--for albedo {flag} nan"), &[flag, "nan"]);
    }
    for flag in ["--resolution", "--emission-resolution", "--albedo-resolution"] {
        solve(&format!("--for emission,albedo {flag} 0"), &[flag, "0"]);
        solve(&format!("--for emission,albedo {flag} 2049"), &[flag, "2049"]);
    }
    solve("--for albedo --emission-resolution 8", &["--emission-resolution", "--for emission"]);
    solve("--for extinction --albedo-resolution 8", &["--albedo-resolution", "--for albedo"]);
    solve("--for extinction --basis box", &["--basis", "straight"]);
    solve("--for albedo --medium-radiance 0.1", &["--medium-radiance", "--for extinction"]);
    solve("--for extinction --medium-radiance -1", &["--medium-radiance", "0 to 10000"]);
    solve("--for albedo --most-depth 3", &["--most-depth", "--for extinction"]);
    solve("--for extinction --most-depth 0", &["--most-depth", "0.01 to 80"]);
    solve("--for albedo --channels two", &["--channels", "two"]);
    solve("--for albedo --hull", &["--hull", "v.toml", "mask"]);
}

#[test]
fn light_and_refraction_that_cannot_be_meant_are_refused() {
    let folder = prepared();
    let at = folder.path();
    image::Rgb32FImage::from_pixel(4, 2, image::Rgb([1.0, -1.0, 0.5])).save(at.join("negative.exr")).unwrap();
    volume(&at.join("zero.npy"), |[x, _, _]| [if x < 0.0 { 0.0 } else { 1.5 }]);
    volume(&at.join("colours.npy"), |_| [1.0, 1.1, 1.2]);
    let render = |flags: &str, code: i32, parts: &[&str]| {
        refused(at, &format!("render --volume box.npy --views v.toml --out out {flags}"), code, parts);
    };
    render("--light sun", 2, &["--light", "`sun`", "directional:135,40"]);
    render("--light area:0,0,3", 2, &["--light", "soft shadows", "directional, spot or point"]);
    render("--light directional:0,91", 2, &["--light", "91", "-90 to 90"]);
    render("--light point:1,2,3 --ambient 1", 2, &["--ambient", "--light: leave it out"]);
    render("--environment grey.png --ambient 1", 2, &["--ambient", "--environment"]);
    render("--radiance 3", 2, &["--radiance", "leave it out"]);
    render("--light point:1,2,3 --radiance -3", 2, &["--radiance", "0 to 10000"]);
    render("--light point:1,2,3 --radiance 1 --radiance 2", 2, &["--radiance", "once a light"]);
    render("--environment none.exr", 1, &["--environment", "none.exr", "no such file"]);
    render("--environment negative.exr", 1, &["--environment", "negative.exr", "negative", "repair"]);
    for count in ["0", "4097"] {
        render(&format!("--environment-lights {count}"), 2, &["--environment-lights", count]);
    }
    render("--light-resolution 0", 2, &["--light-resolution", "0"]);
    render("--refraction-step 0.1", 2, &["--refraction-step", "give --refraction"]);
    render("--refraction box.npy --refraction-step 0", 2, &["--refraction-step", "0"]);
    render("--refraction box.npy --refraction-step 1e-5", 2, &["--refraction-step", "longer steps"]);
    render("--refraction none.npy", 1, &["--refraction", "none.npy", "check the path"]);
    render("--refraction box.txt", 2, &["--refraction", "`box.txt`", ".npy"]);
    render("--refraction zero.npy", 1, &["--refraction", "zero.npy", "6912 voxels", "0.01 to 100"]);
    render("--refraction colours.npy", 1, &["--refraction", "colours.npy", "one number a voxel"]);
    let solve = |flags: &str, code: i32, parts: &[&str]| {
        refused(at, &format!("solve --volume box.npy --views v.toml --out out {flags}"), code, parts);
    };
    for flag in ["--lights 32", "--upper", "--light-strategy stored"] {
        let name = words(flag)[0];
        solve(&format!("--for albedo {flag}"), 2, &[name, "--for light"]);
    }
    for count in ["15", "257"] {
        solve(&format!("--for light --lights {count}"), 2, &["--lights", count]);
    }
    solve("--for light --light-strategy columns", 2, &["--light-strategy", "columns"]);
    solve("--for light --basis box", 2, &["--basis", "straight"]);
    solve("--for albedo --refraction box.npy --hull", 2, &["--hull", "--refraction"]);
    solve("--for light --albedo 0", 1, &["--for light", "nothing scatters", "--albedo"]);
    solve("--for light --extinction-scale 0", 1, &["--for light", "nothing scatters"]);
    // Views with lights of their own.
    let own = |more: &str, flags: &str, code: i32, parts: &[&str]| {
        let target = "target = \"grey.png\"";
        std::fs::write(at.join("own.toml"), view("front", FRONT, &format!("{target}\n{more}"))).unwrap();
        refused(at, &format!("solve --volume box.npy --views own.toml {flags}"), code, parts);
    };
    let map = "environment = \"grey.png\"";
    own(map, "--for light --out out", 2, &["--for light", "`front`", "leave it out"]);
    let missing = "environment = \"none.exr\"";
    own(missing, "--for albedo --out out", 1, &["--views", "`front`", "environment", "none.exr"]);
    // Maps are not replaced.
    std::fs::create_dir(at.join("job")).unwrap();
    std::fs::copy(at.join("grey.png"), at.join("job/solved_front.png")).unwrap();
    let inside = "environment = \"job/solved_front.png\"";
    own(inside, "--for albedo --out job", 1, &["--out", "solved_front.png", "would be replaced"]);
    std::fs::copy(at.join("negative.exr"), at.join("job/environment.exr")).unwrap();
    let line =
        "solve --volume box.npy --views v.toml --for light --environment job/environment.exr --out job";
    refused(at, line, 1, &["--out", "environment.exr", "would be replaced"]);
}

#[test]
fn views_that_cannot_be_solved_are_refused() {
    let folder = prepared();
    let at = folder.path();
    let with = |views: &str, flags: &str, parts: &[&str]| {
        std::fs::write(at.join("w.toml"), views).unwrap();
        refused(at, &format!("solve --volume box.npy --views w.toml --out out {flags}"), 1, parts);
    };
    let bad = |more: &str, parts: &[&str]| with(&view("front", FRONT, more), "--for albedo", parts);
    refused(at, "render --volume box.npy --views none.toml --out out", 1, &["--views", "none.toml"]);
    with("", "--for albedo", &["--views", "w.toml", "at least one"]);
    bad("", &["--views", "`front`", "no target"]);
    bad("target = \"none.png\"", &["--views", "`front`", "none.png", "no such file"]);
    bad("target = \"small.png\"", &["--views", "`front`", "8x8", "48x36"]);
    bad("target = \"grey.png\"\nweights = \"black.png\"", &["--views", "`front`", "all weights", "zero"]);
    let mut light = image::Rgb32FImage::from_pixel(SIZE[0], SIZE[1], image::Rgb([0.5; 3]));
    light.put_pixel(3, 2, image::Rgb([0.5, f32::NAN, 0.5]));
    light.save(at.join("nan.exr")).unwrap();
    bad("target = \"nan.exr\"", &["--views", "`front`", "not finite", "column 3 of row 2"]);
    // The box reaches to 2 m.
    let target = "target = \"grey.png\"";
    let away = view("away", FRONT, target).replace("target = [0, 0, 0]", "target = [0, 9, 9]");
    with(&away, "--for albedo", &["--views", "`away` misses the volume", "[-2", "[2", "move its camera"]);
    let near = vec![6.9_f32; (SIZE[0] * SIZE[1]) as usize];
    let exr: Vec<f32> = near.iter().flat_map(|depth| [*depth; 3]).collect();
    image::Rgb32FImage::from_raw(SIZE[0], SIZE[1], exr).unwrap().save(at.join("near.exr")).unwrap();
    bad(&format!("{target}\ndepth = \"near.exr\""), &["`front` misses the volume", "surface"]);
    let both = view("a", FRONT, target) + &view("a", FRONT, target);
    with(&both, "--for albedo", &["--views", "`a` is taken"]);
}

#[test]
fn what_leaves_nothing_to_solve_is_refused() {
    let folder = prepared();
    let at = folder.path();
    let with = |more: &str, flags: &str, parts: &[&str]| {
        std::fs::write(at.join("w.toml"), view("front", FRONT, &format!("target = \"grey.png\"\n{more}")))
            .unwrap();
        refused(at, &format!("solve --volume box.npy --views w.toml --out out {flags}"), 1, parts);
    };
    let pixels = (3 * SIZE[0] * SIZE[1]).to_string();
    with("", "--for extinction", &["no pixel", &format!("{pixels} show nothing"), "background"]);
    with(
        "background = \"#202020\"",
        "--for extinction",
        &["no pixel", &format!("{pixels} are beyond the background")],
    );
    with("mask = \"black.png\"", "--for extinction --hull", &["--for extinction", "no voxel"]);
    with("", "--for albedo --extinction-scale 0", &["--for albedo", "no voxel"]);
    let bytes = (16_u64 << 27).to_string();
    with("", "--for albedo --resolution 512", &["--resolution", "512x512x512", &bytes, "--channels one"]);
    let wide = view("wide", FRONT, "target = \"wide.png\"").replace("size = [48, 36]", "size = [2100, 2]");
    image::RgbImage::new(2100, 2).save(at.join("wide.png")).unwrap();
    std::fs::write(at.join("wide.toml"), wide).unwrap();
    refused(
        at,
        "solve --volume box.npy --views wide.toml --out out --for albedo",
        1,
        &["`wide` of 2100x2", "2048", "smaller size"],
    );
}

#[test]
fn what_was_painted_is_not_replaced() {
    let folder = prepared();
    let at = folder.path();
    std::fs::create_dir(at.join("job")).unwrap();
    for name in ["v.toml", "grey.png", "box.npy"] {
        std::fs::copy(at.join(name), at.join("job").join(name.replace("v.toml", "views.toml"))).unwrap();
    }
    let text = view("grey", FRONT, "target = \"grey.png\"");
    std::fs::write(at.join("job/views.toml"), &text).unwrap();
    let render = "render --volume box.npy --views job/views.toml --out";
    refused(at, &format!("{render} job"), 1, &["--out", "job/views.toml", "would be replaced"]);
    std::fs::write(at.join("job/v.toml"), &text).unwrap();
    refused(
        at,
        "render --volume box.npy --views job/v.toml --out job/../job",
        1,
        &["--out", "grey.png", "would be replaced"],
    );
    let solve = "solve --volume box.npy --views job/v.toml --for albedo";
    std::fs::copy(at.join("box.npy"), at.join("job/albedo.npy")).unwrap();
    let own = "--albedo job/albedo.npy --out job";
    refused(at, &format!("{solve} {own}"), 1, &["--out", "job/albedo.npy", "would be replaced"]);
    std::fs::write(at.join("file"), "").unwrap();
    refused(at, &format!("{solve} --out file"), 1, &["--out", "file", "folder"]);
    std::fs::create_dir_all(at.join("taken/report.json")).unwrap();
    refused(at, &format!("{solve} --out taken"), 1, &["--out", "report.json is a folder"]);
}

/// Properties of files that say where they lie have to lie where the volume does.
#[test]
fn properties_elsewhere_are_refused() {
    let folder = prepared();
    let at = folder.path();
    command::succeeds(
        at,
        &words("inverse solve --volume box.npy --views v.toml --for albedo --iterations 1 --out out"),
    );
    let same = "inverse render --volume box.npy --views v.toml --out again --albedo out/albedo.nii.gz";
    command::succeeds(at, &words(same));
    refused(
        at,
        "render --volume box.npy --voxel 0.2 --views v.toml --out more --albedo out/albedo.nii.gz",
        1,
        &["--albedo", "albedo.nii.gz", "lies elsewhere", "resample"],
    );
}
