// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight splatting`: files against closed forms, lights against each other, each flag by what it changes. What cannot be
//! meant is tested in `splatting_refusals.rs`.

use crate::command::{Ended, draws_finite, files, folder, succeeds, words};
use crate::npy;
use airlight_tests::error::relative_rmse;
use image::AnimationDecoder;
use std::collections::BTreeMap;
use std::path::Path;

const CLOUD: &str = "--volume cloud --voxels 24";

/// What a run left behind.
struct Run {
    ended: Ended,
    buffers: BTreeMap<String, Vec<f32>>,
}

impl Run {
    /// Runs the command at a small size.
    #[track_caller]
    fn new(at: &Path, flags: &str) -> Self {
        let folder = tempfile::tempdir_in(at).unwrap();
        let [out, buffers] = ["picture.exr", "buffers"].map(|name| folder.path().join(name));
        let (out, buffers) = (out.to_str().unwrap(), buffers.to_str().unwrap());
        let mut arguments = vec!["splatting", "--out", out, "--buffers", buffers];
        for (flag, value) in [("--size", "48x32"), ("--sheets", "16"), ("--light-size", "32")] {
            if !flags.contains(flag) {
                arguments.extend([flag, value]);
            }
        }
        arguments.extend(words(flags));
        let ended = succeeds(at, &arguments);
        let mut arrays = BTreeMap::new();
        for path in files(Path::new(buffers)).keys() {
            let (_, values) = npy::read_f32(path);
            assert!(
                values.iter().all(|value| value.is_finite()),
                "{flags}: {} is not finite",
                path.display()
            );
            arrays.insert(path.file_stem().unwrap().to_str().unwrap().to_owned(), values);
        }
        assert_eq!(arrays.keys().collect::<Vec<_>>(), ["background", "composed", "light_left", "medium"]);
        let picture = image::open(out).unwrap().into_rgba32f();
        let shown = &arrays["composed"];
        assert!(picture.as_raw().iter().zip(shown).enumerate().all(|(i, (a, b))| i % 4 == 3 || a == b));
        Self { ended, buffers: arrays }
    }

    fn through(&self) -> Vec<f32> {
        self.buffers["medium"].chunks_exact(4).map(|pixel| pixel[3]).collect()
    }

    fn radiance(&self) -> Vec<f32> {
        self.buffers["medium"].chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect()
    }
}

/// A .npy volume of 12 x 12 x 12 voxels, `value` in the 8 x 8 x 8 in its middle, else 0.
fn block(path: &Path, value: f32) {
    let inside = |i: usize| (2..10).contains(&i);
    let voxel = |i: usize| if inside(i % 12) && inside(i / 12 % 12) && inside(i / 144) { value } else { 0.0 };
    npy::write_f32(path, &[12, 12, 12], &(0..1728).map(voxel).collect::<Vec<_>>());
}

#[test]
fn files_have_the_extinction_that_is_said() {
    let at = folder();
    let at = at.path();
    block(&at.join("block.npy"), 3.0);
    std::fs::write(
        at.join("half.toml"),
        "range = [0, 6]\n[[point]]\nvalue = 0\ncolor = [1, 1, 1]\nopacity = 0\n\
         [[point]]\nvalue = 6\ncolor = [1, 1, 1]\nopacity = 1\n",
    )
    .unwrap();
    let before = "--volume block.npy --camera orthographic --eye 0,0,9 --target 0,0,0 --height 0.5";
    for (flags, depth) in [
        // Eight voxels of 0.25 m.
        ("--voxel 0.25 --extinction-scale 0.5", 1.0_f64),
        ("--voxel 0.25 --extinction-scale 2 --transfer half.toml", 2.0),
        // The longest side is 4 m, 8 of 12 voxels of it full.
        ("--extinction-scale 0.5", 4.0 / 3.0),
        ("", 200.0 / 3.0),
        ("--voxel 0.25 --extinction-scale 0", 0.0),
        ("--voxel 0.25 --extinction-scale 0.5 --threshold 3", 0.0),
    ] {
        let found = f64::from(Run::new(at, &format!("{before} {flags}")).through()[16 * 48 + 24]);
        println!("{flags}: {found} of {}", (-depth).exp());
        assert!((found - (-depth).exp()).abs() < 4e-3, "{flags}: {found}");
    }
    let said = Run::new(at, &format!("{before} --voxel 0.25")).ended.out;
    for line in ["values: 0 to 3; left out up to 0", "splats: 512 of 1728 voxels", "sheets: 16 of 0."] {
        assert!(said.contains(line), "{line}: {said}");
    }
    // Scaled and moved out of sight, and two at once.
    let two =
        Run::new(at, &format!("{before} --voxel 0.25 --extinction-scale 0.5 --volume block.npy@0,0,-4"));
    let found = f64::from(two.through()[16 * 48 + 24]);
    assert!((found - (-2.0_f64).exp()).abs() < 4e-3, "{found}");
    let scaled =
        "--camera orthographic --eye 0,0,9 --target 0,0,0 --height 0.5 --voxel 0.25 --extinction-scale 0.5";
    for (place, depth) in [("@0,0,0,2,90", 2.0_f64), ("@7,0,0", 0.0)] {
        let found = Run::new(at, &format!("--volume block.npy{place} {scaled}")).through()[16 * 48 + 24];
        assert!((f64::from(found) - (-depth).exp()).abs() < 4e-3, "{place}: {found}");
    }
}

#[test]
fn scans_are_seen() {
    let at = folder();
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/assets");
    for (file, transfer, dense) in
        [("head_mri", "head", 150..1200), ("stent_ct", "stent", 60..1200), ("stent_ct", "vessels", 50..1300)]
    {
        let flags = format!("--volume {assets}/{file}.nii.gz --transfer {transfer} --shading phong");
        let run = Run::new(at.path(), &flags);
        let seen = run.through().iter().filter(|through| **through < 0.7).count();
        println!("{file} {transfer}: {seen} pixels; {}", run.ended.out);
        assert!(dense.contains(&seen), "{file} covers {seen} pixels");
    }
}

#[test]
fn nothing_to_see_is_a_picture_and_a_warning() {
    let at = folder();
    let at = at.path();
    npy::write_f32(&at.join("empty.npy"), &[4, 4, 4], &[0.0; 64]);
    npy::write_f32(&at.join("wild.npy"), &[2, 2, 2], &[f32::NAN; 8]);
    block(&at.join("block.npy"), 1.0);
    for flags in ["--volume empty.npy", "--volume wild.npy", "--volume block.npy --threshold 7"] {
        let run = Run::new(at, &format!("{flags} --background 0.25"));
        assert!(run.ended.err.contains("airlight: warning: --volume: no voxel exceeds"), "{}", run.ended.err);
        assert!(run.through().iter().all(|through| *through == 1.0), "{flags}");
        assert!(run.buffers["composed"].chunks_exact(4).all(|pixel| pixel[..3] == [0.25; 3]), "{flags}");
    }
    let said = Run::new(at, "--volume wild.npy").ended.out;
    assert!(said.contains("voxels: 8; taken as the least value: 8 not finite"), "{said}");
    assert!(!Run::new(at, "--volume block.npy").ended.err.contains("warning"));
}

#[test]
fn a_light_texture_colours_the_whole_shadow_buffer() {
    let at = folder();
    let at = at.path();
    npy::write_f32(&at.join("empty.npy"), &[4, 4, 4], &[0.0; 64]);
    // Red above, green below; white at the left, black at the right.
    let color = |x: u32, y: u32| match (x < 2, y < 2) {
        (true, true) => image::Rgb([255, 0, 0]),
        (true, false) => image::Rgb([0, 255, 0]),
        _ => image::Rgb([0, 0, 0_u8]),
    };
    image::RgbImage::from_fn(4, 4, color).save(at.join("slide.png")).unwrap();
    for light in ["directional:10,60", "spot:0,9,0,0.1,0,0,20", "point:3,8,2"] {
        let run = |flags: &str| {
            let flags =
                format!("--volume empty.npy --radiance 8,8,8 --light {light} --light-size 16 {flags}");
            Run::new(at, &flags).buffers["light_left"].clone()
        };
        assert!(run("").chunks_exact(4).all(|texel| texel[..3] == [8.0; 3]), "{light}");
        let textured = run("--light-texture slide.png");
        for (x, y, expected) in
            [(2, 2, [8.0, 0.0, 0.0]), (2, 13, [0.0, 8.0, 0.0]), (13, 2, [0.0; 3]), (13, 13, [0.0; 3])]
        {
            let texel = 4 * (16 * y + x);
            let found = &textured[texel..texel + 3];
            assert!(
                found.iter().zip(expected).all(|(a, b): (&f32, f32)| (a - b).abs() < 0.02),
                "{light}: {found:?}"
            );
        }
    }
}

/// From far away a light at a point is a directional one.
#[test]
fn far_lights_are_parallel() {
    let at = folder();
    let run = |light: &str| {
        Run::new(at.path(), &format!("{CLOUD} --ambient 0 --light-size 64 --radiance 9,8,7 --light {light}"))
            .radiance()
    };
    // Elevation of 60 degrees, azimuth of 0: 70 m away.
    let sun = run("directional:0,60");
    let place = "0,60.6218,35";
    let scaled = |light: &str| {
        Run::new(
            at.path(),
            &format!("{CLOUD} --ambient 0 --light-size 64 --radiance 44100,39200,34300 --light {light}"),
        )
        .radiance()
    };
    for light in [format!("point:{place}"), format!("spot:{place},0,0,0,6,5.9")] {
        let error = relative_rmse(&scaled(&light), &sun);
        println!("{light}: {error}");
        assert!(error < 0.06, "{light}: {error}");
    }
    // Without a radiance the middle is as bright.
    let usual = |light: &str| Run::new(at.path(), &format!("{CLOUD} --ambient 0 --light {light}")).radiance();
    let error = relative_rmse(&usual("point:0,24,14"), &usual("directional:0,60"));
    assert!(error < 0.25, "{error}");
    assert!(relative_rmse(&run("directional:0,-60"), &sun) > 0.3);
}

#[test]
fn every_flag_changes_the_picture() {
    let at = folder();
    let at = at.path();
    image::RgbImage::from_fn(4, 4, |x, _| image::Rgb([60 * x as u8; 3])).save(at.join("slide.png")).unwrap();
    let plain = Run::new(at, CLOUD).buffers["composed"].clone();
    let mut seen = vec![("", plain.clone())];
    for flags in [
        "--volume cloud@0.5,0,0",
        "--volume plume",
        "--volume smoke",
        "--volume clouds",
        "--transfer smoke",
        "--extinction-scale 1",
        "--threshold 1.5",
        "--seed 2",
        "--shading phong",
        "--albedo 0.5",
        "--albedo 1,0.9,0.5",
        "--g -0.5",
        "--ambient 0",
        "--ambient 0.2,0.1,0",
        "--sheets 5",
        "--light-size 8",
        "--light directional:200,10",
        "--light spot:0,9,0,0,0,0,15",
        "--light point:0,6,1",
        "--radiance 5,6,7",
        "--light-texture slide.png",
        "--eye 5,1,6",
        "--target 0.5,0,0",
        "--fov 20",
        "--camera orthographic",
        "--camera orthographic --height 3",
        "--background 0.5",
    ] {
        let found = Run::new(at, &format!("{CLOUD} {flags}")).buffers["composed"].clone();
        for (other, values) in &seen {
            assert!(*values != found, "`{flags}` is as `{other}`");
        }
        seen.push((flags, found));
    }
    let finer = Run::new(at, "--volume cloud --voxels 30").buffers["composed"].clone();
    assert!(finer != plain && relative_rmse(&finer, &plain) < 0.25);
    assert!(Run::new(at, CLOUD).buffers["composed"] == plain, "twice");
}

#[test]
fn meshes_and_light_that_spreads_are_in_the_picture() {
    let at = folder();
    let at = at.path();
    // A square of 2 m in the middle of the cloud, that leans towards eye and light.
    let corners = "v -1 -0.7 0.7\nv 1 -0.7 0.7\nv 1 0.7 -0.7\nv -1 0.7 -0.7\nf 1 2 3\nf 1 3 4\n";
    std::fs::write(at.join("square.obj"), corners).unwrap();
    let run = |flags: &str| Run::new(at, &format!("{CLOUD} --light-size 64 {flags}"));
    let mean = |run: &Run| {
        let all = run.radiance();
        all.iter().sum::<f32>() / all.len() as f32
    };
    let [none, forward, back, sweeps] = ["", "--forward", "--back", "--back --sweeps 4"].map(run);
    let means = [&none, &forward, &back, &sweeps].map(mean);
    println!("none, forward, back, four sweeps: {means:?}");
    assert!(means[1] > 1.1 * means[0] && means[2] > 1.02 * means[1] && means[3] > means[2], "{means:?}");
    // Light does not change what is seen through.
    assert!(none.through() == sweeps.through() && none.through().iter().all(|through| *through > 0.0));
    for [cone, path] in [["20", "0.1"], ["80", "1"]] {
        let other = run(&format!("--forward --cone {cone} --free-path {path}"));
        assert!(mean(&other) > mean(&none) && mean(&other) != mean(&forward));
    }
    for light in ["directional:70,60", "point:5,9,4"] {
        let area = match light {
            "point:5,9,4" => "area:5,9,4,2",
            _ => "area:70,60,20",
        };
        for flags in ["", "--forward", "--back"] {
            let mesh = run(&format!("--light {light} {flags} --mesh square.obj"));
            let opaque = mesh.through().iter().filter(|through| **through == 0.0).count();
            assert!((20..800).contains(&opaque), "{light} {flags}: {opaque}");
        }
        let hard = run(&format!("--light {light} --mesh square.obj@0,2,0"));
        let soft = run(&format!("--light {area} --soft --mesh square.obj@0,2,0"));
        let differ = relative_rmse(
            &soft.radiance(),
            &hard.radiance().iter().map(|x| f64::from(*x)).collect::<Vec<_>>(),
        );
        println!("{area}: {differ}");
        assert!((0.005..0.5).contains(&differ), "{area}: {differ}");
    }
}

#[test]
fn exposure_is_of_png_and_quiet_says_nothing() {
    let at = folder();
    let run = |flags: &str| {
        let line = format!("splatting {CLOUD} --size 32x24 --sheets 8 --light-size 16 --out x.png {flags}");
        let said = succeeds(at.path(), &words(&line)).out;
        let picture = image::open(at.path().join("x.png")).unwrap().into_rgb8();
        let sum: f64 = picture.as_raw().iter().map(|v| f64::from(*v)).sum();
        (said, sum / picture.as_raw().len() as f64)
    };
    let (told, plain) = run("");
    assert!(told.ends_with("x.png\n"), "{told}");
    let (quiet, bright) = run("--exposure 3 --quiet");
    assert_eq!(quiet, "");
    assert!(bright > plain + 20.0 && plain > 40.0, "{plain} {bright}");
}

#[test]
fn frames_turn_the_eye() {
    let at = folder();
    let at = at.path();
    let own = "--size 24x16 --sheets 8 --light-size 16 --eye 0,1,9 --target 0,0,0";
    let draw = |flags: &str| succeeds(at, &words(&format!("splatting {CLOUD} {own} --out x.png {flags}")));
    let picture = |name: &str| image::open(at.join(name)).unwrap().into_rgb8();
    draw("--frames 2..4 --turn 45 --rate 8");
    let frames: Vec<_> = [2, 3, 4].map(|frame| picture(&format!("x.000{frame}.png"))).into();
    let opened = std::io::BufReader::new(std::fs::File::open(at.join("x.png")).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(opened).unwrap().apng().unwrap();
    let shown = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(shown.len(), 3);
    for (shown, frame) in shown.iter().zip(&frames) {
        assert!(image::DynamicImage::from(shown.buffer().clone()).into_rgb8() == *frame);
        assert_eq!(shown.delay().numer_denom_ms(), (125, 1));
    }
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    // A quarter of a turn and half a one, from +z towards +x.
    for (frame, eye) in [(2, "9,1,0"), (4, "0,1,-9")] {
        let line = format!(
            "splatting {CLOUD} --size 24x16 --sheets 8 --light-size 16 --eye {eye} --target 0,0,0 --out y.png"
        );
        succeeds(at, &words(&line));
        let (still, turned) = (picture("y.png"), &frames[frame - 2]);
        let most = still.as_raw().iter().zip(turned.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most.unwrap() <= 3, "{frame}: {most:?}");
    }
    draw("");
    let still = picture("x.png");
    draw("--frames 0..0");
    assert!(still == picture("x.0000.png"));
}

#[test]
fn awkward_sizes_draw() {
    let at = folder();
    for flags in [
        "--volume cloud --voxels 4 --size 1x1 --light-size 1 --sheets 1",
        "--volume plume --voxels 5 --size 3x2 --light-size 3 --sheets 300",
        "--volume smoke --voxels 4 --size 1x3 --eye 0,1,0 --target 0,1,-1 --light directional:0,90",
        "--volume cloud --voxels 6 --size 5x1 --eye 0,9,0 --target 0,0,0.001 --light directional:0,90",
        "--volume cloud --voxels 6 --size 5x4 --eye 0,0,9 --target 0,0,0 --light directional:180,0",
        "--volume cloud --voxels 6 --size 5x4 --light point:0,6,0",
    ] {
        draws_finite(at.path(), &format!("splatting --out x.exr {flags}"));
    }
}
