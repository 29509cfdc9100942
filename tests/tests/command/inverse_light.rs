// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight inverse` with lights, surroundings, light that is solved for, bent rays and views of several lightings.

use crate::command::{folder, succeeds, words};
use crate::painted_views::{EYES, SIDE, ball, read, view, views, volume};
use airlight::data::{Environment, load_environment};
use glam::Vec3;
use serde_json::Value;
use std::path::Path;

fn run(at: &Path, line: &str) -> String {
    succeeds(at, &words(&format!("inverse {line}"))).out
}

fn radiance(path: &Path) -> Vec<f32> {
    image::open(path).unwrap().into_rgb32f().into_raw()
}

/// Root of the mean square.
fn apart(found: &[f32], wanted: &[f32]) -> f64 {
    let squares = found.iter().zip(wanted).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / found.len() as f64).sqrt()
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("report.json")).unwrap()).unwrap()
}

/// `key` of all views of a stage.
fn of_views(stage: &Value, key: &str) -> Vec<f64> {
    stage["views"].as_array().unwrap().iter().map(|view| view[key].as_f64().unwrap()).collect()
}

fn least(numbers: &[f64]) -> f64 {
    numbers.iter().copied().fold(f64::INFINITY, f64::min)
}

fn vector(of: &Value) -> Vec3 {
    let numbers: Vec<f32> = of.as_array().unwrap().iter().map(|n| n.as_f64().unwrap() as f32).collect();
    Vec3::from_slice(&numbers)
}

/// A map of surroundings from a function of directions.
fn surroundings(path: &Path, radiance: impl Fn(Vec3) -> Vec3) {
    let map = Environment::from_function([32, 16], radiance).unwrap();
    let values = map.texels().iter().flat_map(|texel| texel.to_array()).collect();
    image::Rgb32FImage::from_raw(32, 16, values).unwrap().save(path).unwrap();
}

/// A ball of constant albedo, and views of it.
fn prepared() -> tempfile::TempDir {
    let folder = folder();
    ball(folder.path());
    std::fs::write(folder.path().join("plain.toml"), views("background = [0.05, 0.1, 0.2]")).unwrap();
    folder
}

const BALL: &str = "--volume ball.npy --extinction-scale 4";
const LIGHTS: &str =
    "--light directional:30,40 --light directional:-100,10 --radiance 8,5,2 --radiance 2,4,9";

#[test]
fn clear_air_scatters_what_lights_send() {
    let folder = folder();
    let at = folder.path();
    volume(&at.join("block.npy"), |_| [1.0]);
    let parallel = "[[view]]\nname = \"front\"\nsize = [9, 9]\n\
                    camera = { eye = [0, 0, 9], target = [0, 0, 0], height = 1 }\n";
    std::fs::write(at.join("v.toml"), parallel).unwrap();
    surroundings(&at.join("even.exr"), |_| Vec3::new(0.7, 0.2, 1.5));
    surroundings(&at.join("south.exr"), |towards| Vec3::splat(if towards.z > 0.0 { 3.0 } else { 0.0 }));
    // Two metres of so little that nothing is lost on the way, and all of what is scattered counts.
    let scale = 1e-3_f32;
    let scattered = |flags: &str| {
        let line = format!(
            "render --volume block.npy --voxel {} --extinction-scale {scale} --views v.toml --out out --albedo 1 {flags}",
            2.0 / SIDE as f32
        );
        run(at, &line);
        // The pixel in the middle.
        let found = Vec3::from_slice(&radiance(&at.join("out/front.exr"))[3 * 40..]);
        found / (1.0 - (-2.0 * scale).exp())
    };
    let sphere = 4.0 * std::f32::consts::PI;
    let usual = Vec3::new(12.0, 10.5, 8.4);
    for (flags, expected) in [
        ("--environment even.exr --environment-lights 3", Vec3::new(0.7, 0.2, 1.5)),
        ("--environment south.exr --environment-lights 12", Vec3::splat(1.5)),
        ("--light directional:20,50", usual / sphere),
        ("--light directional:20,50 --radiance 3", Vec3::splat(3.0) / sphere),
        (
            "--light directional:20,50 --light directional:0,0 --radiance 1,2,3",
            Vec3::new(2.0, 4.0, 6.0) / sphere,
        ),
        (
            "--light directional:20,50 --light directional:0,0 --radiance 1,2,3 --radiance 5,0,0",
            Vec3::new(6.0, 2.0, 3.0) / sphere,
        ),
        (
            "--environment even.exr --light directional:20,50 --environment-lights 3",
            Vec3::new(0.7, 0.2, 1.5) + usual / sphere,
        ),
        ("--light directional:20,50 --light-resolution 2", usual / sphere),
    ] {
        let found = scattered(flags);
        println!("{flags}: {:.4}", found / expected);
        assert!((found / expected - 1.0).abs().max_element() < 0.005, "{flags}: {found} {expected}");
    }
    // Lights far away are as bright in the middle as directional ones, and nearly so elsewhere.
    for flags in ["--light point:0,0,60", "--light spot:0,0,60,0,0,0,20"] {
        let found = scattered(flags) / (usual / sphere);
        assert!((found - 1.0).abs().max_element() < 0.02, "{flags}: {found}");
    }
}

#[test]
fn light_is_found_and_then_the_volume() {
    let folder = prepared();
    let at = folder.path();
    let albedo = "--albedo 0.9,0.8,0.7";
    run(at, &format!("render {BALL} {albedo} --views plain.toml {LIGHTS} --out lit"));
    // Coarse, so that it is fast.
    let solve = |flags: &str, out: &str| {
        let flags = format!("{flags} --light-resolution 14");
        println!("{}", run(at, &format!("solve {BALL} {albedo} --views lit/views.toml --out {out} {flags}")));
        report(&at.join(out))
    };
    let both = solve("--for light --for emission,albedo --lights 32", "both");
    let [light, more] = [0, 1].map(|stage| &both["stages"][stage]);
    let [before, after] = ["psnr_before", "psnr_after"].map(|key| of_views(light, key));
    assert!(before.iter().all(|psnr| *psnr < 20.0), "{before:?}");
    assert!(least(&after) >= 30.0, "{after:?}");
    // What is kept is the best of all iterations.
    let residuals: Vec<f64> =
        light["residuals"].as_array().unwrap().iter().map(|residual| residual.as_f64().unwrap()).collect();
    assert!(residuals.len() == 7 && residuals[6] < 1.001 * least(&residuals), "{residuals:?}");
    // The same light goes on (thesis, Fig. 7.11).
    assert_eq!(of_views(more, "psnr_before"), after);
    let then = of_views(more, "psnr_after");
    assert!(then.iter().zip(&after).all(|(then, after)| *then > after + 6.0), "{then:?}");
    assert!(["albedo.npy", "environment.exr"].iter().all(|name| at.join("both").join(name).exists()));

    let found = |report: &Value| -> Vec<(Vec3, Vec3)> {
        let discs = report["stages"][0]["light"]["discs"].as_array().unwrap().clone();
        discs.iter().map(|disc| (vector(&disc["towards"]), vector(&disc["radiance"]))).collect()
    };
    let discs = found(&both);
    assert_eq!(discs.len(), 32);
    // Light comes from where it came, each colour from where most of it did.
    let [one, other] = [(30.0_f32, 40.0_f32), (-100.0, 10.0)].map(|(azimuth, elevation)| {
        let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
        Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
    });
    for (channel, from) in
        [(0, 8.0 * one + 2.0 * other), (1, 5.0 * one + 4.0 * other), (2, 2.0 * one + 9.0 * other)]
    {
        let mean: Vec3 = discs.iter().map(|(towards, own)| own[channel] * *towards).sum();
        let along = mean.normalize().dot(from.normalize());
        println!("channel {channel}: {:.1} degrees off", along.min(1.0).acos().to_degrees());
        assert!(along > 0.9, "{mean} {from}");
    }
    // The map of them makes the same pictures.
    let map = load_environment(at.join("both/environment.exr")).unwrap();
    assert_eq!(map.size(), [256, 128]);
    let alone = solve("--for light --lights 32 --light-strategy stored", "light");
    run(
        at,
        &format!(
            "render {BALL} {albedo} --views plain.toml --environment light/environment.exr --environment-lights 40 --light-resolution 14 --out again"
        ),
    );
    for name in ["v0", "v3"] {
        let [again, solved, wanted] =
            [format!("again/{name}.exr"), format!("light/solved_{name}.exr"), format!("lit/{name}.exr")]
                .map(|path| radiance(&at.join(path)));
        let off = apart(&again, &solved);
        println!("by the map {off:.5}, solved {:.5}", apart(&solved, &wanted));
        assert!(off < 0.01, "{name}: {off}");
    }
    // Both strategies find the same.
    for ((_, one), (_, other)) in found(&alone).into_iter().zip(&discs) {
        assert!((one - *other).abs().max_element() < 0.02, "{one} {other}");
    }
    let upper = solve("--for light --lights 16 --upper --channels one --iterations 3", "upper");
    let discs = found(&upper);
    assert!(discs.len() == 16 && discs.iter().all(|(towards, own)| towards.y > 0.0 && own.x == own.z));
    let map = load_environment(at.join("upper/environment.exr")).unwrap();
    assert!(map.radiance(Vec3::NEG_Y) == Vec3::ZERO && map.radiance(Vec3::Y).x > 0.0);
}

#[test]
fn an_index_of_refraction_bends_rays_in_pictures_and_solves() {
    let folder = prepared();
    let at = folder.path();
    volume(&at.join("even.npy"), |_| [1.4]);
    volume(&at.join("lens.npy"), |[x, y, z]| [1.0 + 0.5 * (1.0 - (x * x + y * y + z * z) / 0.9).max(0.0)]);
    let render = |flags: &str, out: &str| {
        let inner = "--emission glow.npy --albedo paint.npy --light directional:30,40";
        run(at, &format!("render {BALL} {inner} --views plain.toml --out {out} {flags}"));
        radiance(&at.join(out).join("v2.exr"))
    };
    let straight = render("", "straight");
    let even = apart(&render("--refraction even.npy", "even"), &straight);
    let bent = render("--refraction lens.npy", "bent");
    let step = apart(&render("--refraction lens.npy --refraction-step 0.02", "fine"), &bent);
    println!("even {even:.5}, bent {:.5}, shorter steps {step:.5}", apart(&bent, &straight));
    assert!(even < 0.002 && step < 0.01 && step > 1e-6, "{even} {step}");
    assert!(apart(&bent, &straight) > 0.03);

    let solve = |flags: &str| {
        let line = "--emission glow.npy --views bent/views.toml --laplacian 1e-4 --channels one --out out";
        println!("{}", run(at, &format!("solve {BALL} {line} {flags}")));
        of_views(&report(&at.join("out"))["stages"][0], "psnr_after")
    };
    let with = solve("--for albedo --refraction lens.npy --iterations 3 --light directional:30,40");
    let without = solve("--for albedo --iterations 3 --light directional:30,40");
    assert!(least(&with) > 40.0 && least(&without) < least(&with) - 6.0, "{with:?} {without:?}");
    let line = "--for light --albedo paint.npy --lights 16 --iterations 4 --light-resolution 14";
    let lit = solve(&format!("{line} --refraction lens.npy"));
    assert!(least(&lit) > 29.0, "{lit:?}");
    // What is seen through it: extinction from nothing, before white.
    std::fs::write(at.join("white.toml"), views("background = [1, 1, 1]")).unwrap();
    let line = "--albedo 0 --views white.toml --refraction lens.npy --out through";
    run(at, &format!("render --volume ball.npy --extinction-scale 1 {line}"));
    let line = "--volume ball.npy --extinction-scale 0 --for extinction --laplacian 1e-4 --channels one --iterations 6 --out out";
    println!("{}", run(at, &format!("solve {line} --views through/views.toml --refraction lens.npy")));
    let found = of_views(&report(&at.join("out"))["stages"][0], "psnr_after");
    assert!(least(&found) > 35.0, "{found:?}");
}

/// Views of one volume, each eye once in the morning and once in the evening.
#[test]
fn one_volume_is_found_from_views_of_several_lightings() {
    let folder = prepared();
    let at = folder.path();
    for (name, side) in [("morning", 1.0), ("evening", -1.0)] {
        surroundings(&at.join(format!("{name}.exr")), |towards| {
            let near = (towards.x * side).max(0.0).powi(4);
            Vec3::new(0.1, 0.15, 0.3) + near * Vec3::new(6.0, 4.0, 2.0)
        });
    }
    let of = |morning: &str, evening: &str| {
        let both = |(i, eye): (usize, &[f32; 3])| {
            [("m", morning, 6), ("e", evening, 18)].map(|(letter, map, time)| {
                let more = format!("environment = \"{map}.exr\"\ntime = {time}");
                view(&format!("{letter}{i}"), *eye, &more)
            })
        };
        EYES.iter().enumerate().flat_map(both).collect::<String>()
    };
    std::fs::write(at.join("v.toml"), of("morning", "evening")).unwrap();
    let lights = "--environment-lights 6";
    run(at, &format!("render {BALL} --albedo paint.npy --views v.toml --out seen {lights}"));
    let [morning, evening] = ["m0", "e0"].map(|name| radiance(&at.join(format!("seen/{name}.exr"))));
    println!("lightings {:.4} apart", apart(&morning, &evening));
    assert!(apart(&morning, &evening) > 0.02);
    let solve = |views: &str| {
        let line = format!(
            "solve {BALL} --views seen/{views} --for albedo --laplacian 1e-4 --iterations 4 --out out {lights}"
        );
        println!("{}", run(at, &line));
        let found = of_views(&report(&at.join("out"))["stages"][0], "psnr_after");
        (least(&found), read(&at.join("out/albedo.npy")).1)
    };
    // The folder of what was rendered names the maps.
    let (right, found) = solve("views.toml");
    let text = std::fs::read_to_string(at.join("seen/views.toml")).unwrap();
    let swapped = text.replace("morning", "noon").replace("evening", "morning").replace("noon", "evening");
    assert_eq!((swapped != text, text.matches("/morning.exr").count()), (true, EYES.len()));
    std::fs::write(at.join("seen/swapped.toml"), swapped).unwrap();
    let (wrong, other) = solve("swapped.toml");
    assert!(right > 40.0 && wrong < right - 10.0, "{right} {wrong}");
    let paint = read(&at.join("paint.npy")).1;
    let dense = read(&at.join("ball.npy")).1;
    // Of voxels that are well seen.
    let error = |albedo: &[f32]| {
        let seen = |values: &[f32]| -> Vec<f32> {
            let dense = values.chunks_exact(3).zip(&dense).filter(|(_, dense)| **dense > 0.1);
            dense.flat_map(|(voxel, _)| voxel.to_vec()).collect()
        };
        apart(&seen(albedo), &seen(&paint))
    };
    println!("albedo {:.4} off, with the wrong light {:.4}", error(&found), error(&other));
    assert!(error(&found) < 0.6 * error(&other));
}
