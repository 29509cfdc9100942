// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse`: pictures against closed forms, and volumes found again from their own pictures. What cannot be meant is tested in
//! `inverse_refusals.rs`.

use crate::command::{self, files, folder, succeeds, words};
use crate::painted_views::{SIDE, SIZE, ball, read, view, views, volume};
use airlight::data::load_channels;
use serde_json::Value;
use std::path::Path;

fn run(at: &Path, line: &str) -> command::Ended {
    succeeds(at, &words(&format!("inverse {line}")))
}

fn radiance(path: &Path) -> Vec<f32> {
    image::open(path).unwrap().into_rgb32f().into_raw()
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("report.json")).unwrap()).unwrap()
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// `key` of all views of a stage.
fn of_views(stage: &Value, key: &str) -> Vec<f64> {
    stage["views"].as_array().unwrap().iter().map(|view| view[key].as_f64().unwrap()).collect()
}

const RENDER: &str =
    "render --volume ball.npy --extinction-scale 2 --views plain.toml --emission glow.npy --albedo paint.npy";

/// A folder with a ball and what was rendered of it, to be painted on.
fn rendered() -> tempfile::TempDir {
    let folder = folder();
    ball(folder.path());
    std::fs::write(folder.path().join("plain.toml"), views("background = [0.05, 0.1, 0.2]")).unwrap();
    run(folder.path(), &format!("{RENDER} --ambient 0.9,1,1.1 --out painted"));
    folder
}

#[test]
fn a_block_has_its_closed_form() {
    let folder = folder();
    let at = folder.path();
    volume(&at.join("block.npy"), |_| [1.0]);
    let parallel = "[[view]]\nname = \"front\"\nsize = [40, 30]\nbackground = [0.5, 0.25, 1]\n\
                    camera = { eye = [0, 0, 9], target = [0, 0, 0], height = 3 }\n";
    std::fs::write(at.join("v.toml"), parallel).unwrap();
    // A box of 2 m.
    let line = format!(
        "render --volume block.npy --voxel {} --extinction-scale 0.5 --views v.toml --out out --emission 0.3,0.1,0 --albedo 0.5 --ambient 0.4,0.2,1",
        2.0 / SIDE as f32
    );
    let told = run(at, &line).out;
    assert!(told.ends_with("views.toml\n"), "{told}");
    let names: Vec<_> =
        files(&at.join("out")).into_keys().map(|path| path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["front.exr", "front.png", "views.toml"]);
    let found = radiance(&at.join("out/front.exr"));
    let through = (-1.0_f32).exp();
    let [block, empty] = [[0.3 + 0.2, 0.1 + 0.1, 0.5], [0.5, 0.25, 1.0]];
    for (pixel, found) in found.chunks_exact(3).enumerate() {
        let (column, row) = (pixel % 40, pixel / 40);
        let inside = (10..30).contains(&column) && (5..25).contains(&row);
        for channel in 0..3 {
            let within = (1.0 - through) * block[channel] + through * empty[channel];
            let expected = if inside { within } else { empty[channel] };
            assert!((found[channel] - expected).abs() < 1e-5, "{pixel}: {found:?}");
        }
    }
    let quiet = run(at, &format!("{line} --quiet")).out;
    assert_eq!(quiet, "");
}

#[test]
fn emission_and_albedo_are_found_again_from_their_pictures() {
    let folder = rendered();
    let at = folder.path();
    let told = run(
        at,
        "solve --volume ball.npy --extinction-scale 2 --views painted/views.toml --for emission,albedo \
         --ambient 0.9,1,1.1 --iterations 12 --laplacian 1e-4 --out solved",
    )
    .out;
    println!("{told}");
    let out = at.join("solved");
    let report = report(&out);
    let stage = &report["stages"][0];
    let residuals = numbers(&stage["residuals"]);
    assert_eq!(
        (residuals.len(), &stage["iterations"], &report["cancelled"]),
        (13, &12.into(), &false.into())
    );
    assert!(residuals.windows(2).all(|pair| pair[1] < pair[0]), "{residuals:?}");
    assert!(residuals[6] < 0.02 * residuals[0], "{residuals:?}");
    let [before, after] = ["psnr_before", "psnr_after"].map(|key| of_views(stage, key));
    assert!(after.len() == 4 && after.iter().all(|psnr| *psnr >= 30.0), "{after:?}");
    assert!(before.iter().all(|psnr| *psnr < 25.0), "{before:?}");
    // What the report says is what the pictures show.
    let target = image::open(at.join("painted/v1.png")).unwrap().into_rgb8();
    let shown = image::open(out.join("solved_v1.png")).unwrap().into_rgb8();
    let squares =
        target.as_raw().iter().zip(shown.as_raw()).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    let psnr = -10.0 * (squares.sum::<f64>() / target.as_raw().len() as f64 / 255.0_f64.powi(2)).log10();
    assert!((psnr - after[1]).abs() < 0.5 || psnr.min(after[1]) > 45.0, "{psnr} {}", after[1]);
    let [found, wanted] = ["solved/solved_v2.exr", "painted/v2.exr"].map(|name| radiance(&at.join(name)));
    let mean =
        found.iter().zip(&wanted).map(|(a, b)| f64::from((a - b).powi(2))).sum::<f64>() / found.len() as f64;
    assert!(mean.sqrt() < 0.01, "{mean}");
    for pair in [[0, 1], [1, 2], [2, 3]] {
        let between = image::open(out.join(format!("between_v{}_v{}.png", pair[0], pair[1]))).unwrap();
        assert_eq!([between.width(), between.height()], SIZE);
        let [low, high] =
            between.into_rgb8().as_raw().iter().fold([255, 0], |[l, h], v| [l.min(*v), h.max(*v)]);
        assert!(high > low + 40, "{pair:?}");
    }
    for (name, high) in [("emission", f32::INFINITY), ("albedo", 1.0)] {
        let (shape, values) = read(&out.join(format!("{name}.npy")));
        assert_eq!(shape, [SIDE, SIDE, SIDE, 3]);
        assert!(values.iter().all(|value| (0.0..=high).contains(value)));
        let placed = load_channels(out.join(format!("{name}.nii.gz")), 1.0).unwrap();
        let corner = placed[0].world_from_unit.transform_point3(glam::Vec3::ZERO);
        assert!(placed.len() == 3 && corner.distance(glam::Vec3::splat(-2.0)) < 1e-5, "{corner}");
        assert!(placed[2].values.iter().eq(values.iter().skip(2).step_by(3)), "the same in both");
        let solved = stage["volumes"][name]["solved"].as_u64().unwrap() as usize;
        assert!((1000..SIDE * SIDE * SIDE / 2).contains(&solved), "{solved}");
        let filled = values.chunks_exact(3).filter(|voxel| voxel.iter().any(|value| *value > 0.0)).count();
        assert!(filled <= solved && 2 * filled > solved, "{filled} of {solved}");
    }
    // Solved volumes go in again, and show what was solved.
    run(
        at,
        "render --volume ball.npy --extinction-scale 2 --views plain.toml --ambient 0.9,1,1.1 --out again \
         --emission solved/emission.npy --albedo solved/albedo.npy",
    );
    let again = radiance(&at.join("again/v2.exr"));
    assert!(again.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-5));
}

#[test]
fn flags_change_what_they_say() {
    let folder = rendered();
    let at = folder.path();
    let solve = |flags: &str| {
        run(
            at,
            &format!(
                "solve --volume ball.npy --extinction-scale 2 --views painted/views.toml --ambient 0.9,1,1.1 --out out {flags} --iterations 4"
            ),
        );
        report(&at.join("out"))
    };
    let shape = |name: &str| read(&at.join("out").join(name)).0;
    let share = |report: &Value| {
        let residuals = numbers(&report["stages"][0]["residuals"]);
        residuals[residuals.len() - 1] / residuals[0]
    };
    let plain = solve("--for emission,albedo");
    let kept = read(&at.join("out/emission.npy")).1;
    solve("--for emission,albedo");
    assert_eq!(read(&at.join("out/emission.npy")).1, kept, "twice");
    assert_eq!(plain["stages"][0]["volumes"]["emission"]["voxels"], serde_json::json!([24, 24, 24]));
    let coarse = solve("--for emission,albedo --resolution 12 --albedo-resolution 7");
    assert_eq!([shape("emission.npy"), shape("albedo.npy")], [[12, 12, 12, 3], [7, 7, 7, 3]]);
    assert!(share(&coarse) < 0.1 && share(&coarse) != share(&plain));
    let one = solve("--for emission,albedo --channels one");
    assert_eq!(shape("albedo.npy"), [SIDE; 3]);
    assert!(one["channels"] == "one" && share(&one) < 0.1);
    let boxes = solve("--for emission,albedo --basis box --resolution 10");
    assert!(boxes["basis"] == "box" && share(&boxes) < 0.3 && share(&boxes) != share(&plain));
    let all = solve("--for emission,albedo --keep-empty");
    assert_eq!(all["stages"][0]["volumes"]["emission"]["solved"], (SIDE * SIDE * SIDE) as u64);
    // The other property stays as it is given: with the right one the pictures can be had.
    for (own, other) in [("emission", "--albedo paint.npy"), ("albedo", "--emission glow.npy")] {
        let _ = std::fs::remove_dir_all(at.join("out"));
        let right = solve(&format!("--for {own} {other}"));
        let made = |name: &str| at.join(format!("out/{name}.npy")).exists();
        assert!(made(own) && made("emission") != made("albedo"));
        assert!(share(&right) < 0.05, "{own}: {}", share(&right));
    }
    // Regularisers: of nothing, of one, and of slopes.
    let mean = |name: &str| {
        let values = read(&at.join(format!("out/{name}.npy"))).1;
        let some: Vec<f64> =
            values.iter().filter(|value| **value > 0.0).map(|value| f64::from(*value)).collect();
        some.iter().sum::<f64>() / values.len() as f64
    };
    let [smallness, none, oneness] = ["--smallness 0.1", "", "--oneness 0.1"].map(|flags| {
        solve(&format!("--for albedo --emission glow.npy {flags}"));
        mean("albedo")
    });
    assert!(smallness < 0.98 * none && none < 0.98 * oneness, "{smallness} {none} {oneness}");
    let [rough, smooth] = ["--laplacian 0", "--laplacian 1"].map(|flags| {
        solve(&format!("--for albedo --emission glow.npy --albedo 0 {flags}"));
        let values = read(&at.join("out/albedo.npy")).1;
        values.windows(4).map(|pair| f64::from((pair[3] - pair[0]).powi(2))).sum::<f64>()
            / mean("albedo").powi(2)
    });
    assert!(smooth < 0.7 * rough, "{smooth} {rough}");
    let fewer = solve("--for emission,albedo --steps 9");
    assert!(fewer["steps"] == 9 && share(&fewer) != share(&plain));
}

/// A ball that is densest in its middle, before a white wall, seen along the axes and across.
#[test]
fn extinction_is_found_from_what_is_seen_through_it() {
    let folder = folder();
    let at = folder.path();
    volume(&at.join("box.npy"), |_| [1.0]);
    let (radius, extinction) = (1.4_f32, [2.0_f32, 1.0, 0.4]);
    let mut text = String::new();
    for (i, eye) in [[0.0, 0.0, 9.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.01], [6.0, 0.0, 6.0], [-6.0, 0.0, 6.0]]
        .into_iter()
        .enumerate()
    {
        let [x, y, z]: [f32; 3] = eye;
        text += &format!(
            "[[view]]\nname = \"s{i}\"\nsize = [48, 36]\ntarget = \"ball.exr\"\nmask = \"mask.png\"\nbackground = [1, 1, 1]\n\
             camera = {{ eye = [{x:?}, {y:?}, {z:?}], target = [0, 0, 0], height = 3.6 }}\n"
        );
    }
    std::fs::write(at.join("v.toml"), text).unwrap();
    // Where extinction falls with the square of the distance, of each metre of the middle's: the integral of 1 - r^2 / R^2.
    let path = |x: u32, y: u32| {
        let [right, down] = [(x as f32 + 0.5 - 24.0) * 0.1, (y as f32 + 0.5 - 18.0) * 0.1];
        let left = (radius * radius - right * right - down * down).max(0.0);
        4.0 / 3.0 * left.powf(1.5) / (radius * radius)
    };
    // From all directions the same.
    let picture = |medium: [f32; 3]| {
        image::Rgb32FImage::from_fn(48, 36, |x, y| {
            let through = extinction.map(|extinction| (-extinction * path(x, y)).exp());
            image::Rgb([0, 1, 2].map(|c| medium[c] + (1.0 - medium[c]) * through[c]))
        })
    };
    picture([0.0; 3]).save(at.join("ball.exr")).unwrap();
    image::GrayImage::from_fn(48, 36, |x, y| image::Luma([if path(x, y) > 0.0 { 255 } else { 0 }]))
        .save(at.join("mask.png"))
        .unwrap();
    let solve = |flags: &str| {
        let line = "solve --volume box.npy --extinction-scale 0 --views v.toml --for extinction --iterations 10 --laplacian 1e-4 --out out";
        println!("{}", run(at, &format!("{line} {flags}")).out);
        report(&at.join("out"))
    };
    // By channel, of the greatest: how far voxels are from the ball, and how much lies beyond it, in the mean.
    let errors = || {
        let (shape, values) = read(&at.join("out/extinction.npy"));
        assert_eq!(shape, [SIDE, SIDE, SIDE, 3]);
        let (mut squares, mut beyond) = ([0.0_f32; 3], [0.0_f32; 3]);
        for (i, voxel) in values.chunks_exact(3).enumerate() {
            let at = |i: usize| ((2 * i + 1) as f32 / SIDE as f32 - 1.0) * 2.0;
            let away: f32 = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(|i| at(i).powi(2)).iter().sum();
            for c in 0..3 {
                let found = voxel[c] / extinction[c];
                squares[c] += (found - (1.0 - away / (radius * radius)).max(0.0)).powi(2);
                beyond[c] += if away > radius * radius { found } else { 0.0 };
            }
        }
        let voxels = (SIDE * SIDE * SIDE) as f32;
        [squares.map(|sum| (sum / voxels).sqrt()), beyond.map(|sum| sum / voxels)]
    };
    let plain = solve("");
    let stage = &plain["stages"][0];
    let residuals = numbers(&stage["residuals"]);
    assert!(residuals.len() == 11 && residuals[10] < 0.003 * residuals[0], "{residuals:?}");
    let psnr = of_views(stage, "psnr_after");
    assert!(psnr.iter().all(|psnr| *psnr > 40.0), "{psnr:?}");
    let depths = &stage["views"][0]["optical_depths"];
    assert_eq!((&depths["kept"], &depths["dropped"]), (&(3 * 48 * 36).into(), &0.into()), "{depths}");
    let [off, beyond] = errors();
    println!("off {off:?}, beyond {beyond:?}");
    assert!(off.iter().all(|off| *off < 0.02) && beyond.iter().all(|beyond| *beyond < 0.002));
    // Within the masks alone.
    let hull = solve("--hull");
    let solved = hull["stages"][0]["volumes"]["extinction"]["solved"].as_u64().unwrap();
    assert!((2500..9000).contains(&solved), "{solved}");
    let [nearer, emptier] = errors();
    assert!(emptier[0] < 0.7 * beyond[0] && nearer[0] < off[0], "{nearer:?} {emptier:?}");
    // A medium that shines, and paint that no extinction makes.
    let shining = [0.2, 0.0, 0.4];
    let mut painted = picture(shining);
    painted.put_pixel(0, 0, image::Rgb([1.5; 3]));
    painted.put_pixel(1, 0, image::Rgb([-0.1; 3]));
    painted.save(at.join("ball.exr")).unwrap();
    let clamped = solve("--medium-radiance 0.2,0,0.4 --most-depth 3");
    let depths = &clamped["stages"][0]["views"][3]["optical_depths"];
    assert_eq!(depths["clamped_beyond_background"], 3, "{depths}");
    let deep = (0..48 * 36).filter(|i| extinction[0] * path(i % 48, i / 48) > 3.0).count() as u64;
    assert!(deep > 50 && depths["clamped_beyond_medium"] == deep + 3, "{deep} {depths}");
    // Then the same pictures by what glows and scatters in it.
    picture(shining).save(at.join("ball.exr")).unwrap();
    let both = solve("--medium-radiance 0.2,0,0.4 --for emission,albedo --channels one");
    assert_eq!([&both["stages"][0]["for"], &both["stages"][1]["for"]], ["extinction", "emission,albedo"]);
    assert_eq!(read(&at.join("out/albedo.npy")).0, [SIDE; 3]);
    let [first, second] = [0, 1].map(|stage| of_views(&both["stages"][stage], "psnr_after"));
    assert!(first.iter().chain(&second).all(|psnr| *psnr > 35.0), "{first:?} {second:?}");
}

/// Ctrl-C writes what there is.
#[cfg(unix)]
#[test]
fn interrupted_solves_keep_what_they_have() {
    let folder = rendered();
    let at = folder.path();
    let line = "inverse solve --volume ball.npy --extinction-scale 2 --views painted/views.toml --for emission,albedo --iterations 1024 --out out";
    // Where nothing was done yet there is nothing to keep: again, with more time.
    let mut ended = false;
    for seconds in [2, 6, 18, 54] {
        let mut child = std::process::Command::new(command::binary("airlight"))
            .args(words(line))
            .current_dir(at)
            .env("XDG_RUNTIME_DIR", std::env::temp_dir())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_secs(seconds));
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        ended = child.wait().unwrap().success();
        if ended {
            break;
        }
        assert!(!at.join("out").exists());
    }
    assert!(ended);
    let report = report(&at.join("out"));
    let iterations = report["stages"][0]["iterations"].as_u64().unwrap();
    println!("{iterations} iterations");
    assert!(report["cancelled"] == true && (1..1024).contains(&iterations), "{iterations}");
    assert_eq!(read(&at.join("out/emission.npy")).0, [SIDE, SIDE, SIDE, 3]);
    assert!(!files(at).keys().any(|path| path.to_string_lossy().contains(".airlight-")));
}

#[test]
fn awkward_sizes_are_solved() {
    let folder = folder();
    let at = folder.path();
    let target = "target = \"t.png\"\nbackground = \"#f0f0f0\"";
    std::fs::write(at.join("v.toml"), view("only", [0.0, 0.0, 9.0], target)).unwrap();
    image::RgbImage::from_pixel(SIZE[0], SIZE[1], image::Rgb([200, 100, 30])).save(at.join("t.png")).unwrap();
    for flags in [
        "--volume cloud --voxels 5 --resolution 1 --for emission,albedo",
        "--volume plume --voxels 4 --resolution 9 --for emission --steps 1 --basis box",
        "--volume smoke --voxels 6 --for extinction --for albedo --channels one --iterations 1",
    ] {
        run(at, &format!("solve {flags} --views v.toml --out out"));
        for (path, _) in files(&at.join("out")) {
            if path.extension().is_some_and(|ending| ending == "npy") {
                assert!(read(&path).1.iter().all(|value| value.is_finite() && *value >= 0.0), "{flags}");
            }
        }
    }
}
