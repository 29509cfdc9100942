// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight transmittance`: each map against the reference, files against closed forms, each flag by what it changes. What
//! cannot be meant is tested in `transmittance_refusals.rs`.

use crate::command::{draws_finite, files, folder, succeeds, words};
use crate::npy;
use airlight_tests::error::{max_absolute, mean_absolute, relative_rmse};
use std::collections::BTreeMap;
use std::path::Path;

const SIZE: [usize; 2] = [64, 48];
const CLOUD: &str = "--volume cloud --voxels 32";
/// By parallel rays.
const ORTHOGRAPHIC: &str = "--volume cloud --voxels 32 --camera orthographic";
const PLUME: &str = "--volume plume --voxels 32";
const BURST: &str = "--particles burst --count 400";

/// What a run left behind.
struct Run {
    said: String,
    buffers: BTreeMap<String, (Vec<usize>, Vec<f32>)>,
}

impl Run {
    /// Runs the command at a small size.
    #[track_caller]
    fn new(at: &Path, flags: &str) -> Self {
        let folder = tempfile::tempdir_in(at).unwrap();
        let [out, buffers] = ["picture.exr", "buffers"].map(|name| folder.path().join(name));
        let (out, buffers) = (out.to_str().unwrap(), buffers.to_str().unwrap());
        let mut arguments = vec!["transmittance", "--out", out, "--buffers", buffers, "--size", "64x48"];
        if !flags.contains("--map-size") && !flags.contains("reference") {
            arguments.extend(["--map-size", "64"]);
        }
        arguments.extend(words(flags));
        let said = succeeds(at, &arguments).out;
        let mut arrays = BTreeMap::new();
        for path in files(Path::new(buffers)).keys() {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            if name != "order" {
                arrays.insert(name, npy::read_f32(path));
            }
        }
        for (name, (_, values)) in &arrays {
            assert!(values.iter().all(|value| value.is_finite()), "{flags}: {name} is not finite");
        }
        let picture = image::open(out).unwrap().into_rgba32f();
        assert_eq!([picture.width() as usize, picture.height() as usize], SIZE);
        let shown = &arrays["composed"].1;
        let same = picture.as_raw().iter().zip(shown).enumerate().all(|(i, (a, b))| i % 4 == 3 || a == b);
        assert!(same, "{flags}: the picture is not what was composed");
        Self { said, buffers: arrays }
    }

    /// Of the medium: radiance.
    fn radiance(&self) -> Vec<f32> {
        self.buffers["medium"].1.chunks_exact(4).flat_map(|pixel| pixel[..3].to_vec()).collect()
    }

    /// Of the medium: transmittance to the background.
    fn through(&self) -> Vec<f32> {
        self.buffers["medium"].1.chunks_exact(4).map(|pixel| pixel[3]).collect()
    }

    fn shape(&self, name: &str) -> &[usize] {
        &self.buffers[name].0
    }
}

#[track_caller]
fn hold(what: &str, found: f64, budget: f64) {
    println!("{what}: {found:.4}");
    assert!(found <= budget, "{what}: {found} exceeds {budget}");
}

#[test]
fn every_map_of_a_volume_is_near_the_reference() {
    let at = folder();
    let run = |map: &str| Run::new(at.path(), &format!("{CLOUD} --light directional:60,70 --map {map}"));
    let reference = run("reference");
    let expected = reference.radiance();
    let lit = expected.iter().filter(|value| **value > 0.1).count();
    let dark = reference.through().iter().filter(|through| **through < 0.1).count();
    assert!(lit > 600 && dark > 150, "{lit} values are lit, {dark} pixels are opaque");
    assert!(!reference.buffers.contains_key("coefficients"));
    let mut seen: Vec<Vec<f32>> = Vec::new();
    for (map, layers, budget) in [
        ("bounded", 2, 0.02),
        ("bounded --coefficients 4", 1, 0.06),
        ("bounded --coefficients 16", 4, 0.02),
        ("etm --coefficients 16", 4, 0.03),
        ("fom --coefficients 16", 4, 0.03),
        ("tfm --coefficients 16", 4, 0.04),
        ("tfm-fourier --coefficients 16", 4, 0.06),
        ("moments", 2, 0.2),
        ("trigonometric", 2, 0.25),
    ] {
        let found = run(map);
        let shape = if layers == 1 { vec![64, 64, 4] } else { vec![layers, 64, 64, 4] };
        assert_eq!(found.shape("coefficients"), shape, "{map}");
        assert_eq!(found.buffers.contains_key("intervals"), map.starts_with("bounded"));
        assert_eq!(found.through(), reference.through(), "{map}");
        let radiance = found.radiance();
        hold(map, relative_rmse(&radiance, &expected), budget);
        assert!(!seen.contains(&radiance), "{map} is another map");
        seen.push(radiance);
    }
}

#[test]
fn every_map_of_particles_is_near_the_reference() {
    let at = folder();
    let run = |map: &str| Run::new(at.path(), &format!("{BURST} --map {map}"));
    let best = run("reference");
    assert!(!best.buffers.contains_key("coefficients"));
    assert!(best.said.contains("particles: 400 of 400; none dropped"), "{}", best.said);
    assert_eq!(best.shape("transmittances"), [400]);
    let expected = best.radiance();
    assert!(expected.iter().filter(|value| **value > 0.1).count() > 400);
    for (map, budget) in [
        ("bounded", 0.05),
        ("bounded --coefficients 16", 0.05),
        ("etm --coefficients 16", 0.1),
        ("etm --coefficients 16 --format float16", 0.1),
        ("etm --coefficients 16 --splat blend", 0.1),
        ("etm --coefficients 16 --splat fixed", 0.1),
        ("fom --coefficients 16 --splat blend", 0.15),
        ("moments", 0.35),
        ("trigonometric", 0.4),
    ] {
        let found = run(map);
        assert_eq!(found.through(), best.through(), "{map}");
        hold(map, relative_rmse(&found.radiance(), &expected), budget);
        assert!(found.radiance() != expected, "{map} is another map");
    }
    let [fixed, blended] =
        ["fixed --format float16", "blend"].map(|splat| run(&format!("etm --splat {splat}")).buffers);
    let [fixed, blended] = [fixed, blended].map(|buffers| buffers["coefficients"].1.clone());
    let greatest = fixed.iter().copied().fold(0.0, f32::max);
    assert!(greatest > 0.5 && fixed != blended);
    hold("blended coefficients", mean_absolute(&fixed, &blended), 1e-3 * f64::from(greatest));
}

/// A box of even extinction, 8 x 4 x 4 voxels: alpha is exp(-extinction times length).
#[test]
fn files_have_the_extinction_that_they_say() {
    let at = folder();
    let at = at.path();
    let mut values = vec![3.0_f32; 128];
    npy::write_f32(&at.join("even.npy"), &[4, 4, 8], &values);
    let before = "--eye 0,0,9 --target 0,0,0 --reading nearest --background 0";
    let centre = |run: &Run| f64::from(run.through()[24 * 64 + 32]);
    for (flags, expected) in [
        ("--voxel 0.25 --extinction-scale 0.5", -1.5_f64),
        // The longest side is 4 m.
        ("--extinction-scale 0.5", -3.0),
        ("--voxel 0.25 --extinction-scale 0.5 --threshold 1", -1.0),
        // Optical depth 32 along the longest side, half of it here.
        ("--voxel 1", -16.0),
    ] {
        let run = Run::new(at, &format!("--volume even.npy {before} {flags}"));
        hold(flags, (centre(&run) - expected.exp()).abs(), 2e-3);
    }
    let stated = Run::new(at, &format!("--volume even.npy {before}")).said;
    assert!(stated.contains("extinction: 2.6667 1/m a unit of value above 0"), "{stated}");
    // Voxels that cannot be are empty, and counted.
    values[..64].fill(f32::NAN);
    values[0] = -7.0;
    values[1] = f32::INFINITY;
    npy::write_f32(&at.join("holes.npy"), &[4, 4, 8], &values);
    let run = Run::new(at, &format!("--volume holes.npy {before} --voxel 0.25 --extinction-scale 0.5"));
    assert!(run.said.contains("voxels: 128; taken as empty: 63 not finite, 1 negative"), "{}", run.said);
    hold("half of it", (centre(&run) - (-0.75_f64).exp()).abs(), 2e-3);
    // What is shipped.
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/assets");
    for (file, dense) in [("head_mri", 200..2000), ("stent_ct", 200..2500)] {
        let run = Run::new(at, &format!("--volume {assets}/{file}.nii.gz"));
        let seen = run.through().iter().filter(|through| **through < 0.7).count();
        println!("{file}: {seen} pixels");
        assert!(dense.contains(&seen), "{file} covers {seen} pixels");
    }
}

#[test]
fn particles_that_cannot_be_drawn_are_counted_and_leave_no_trace() {
    let at = folder();
    let at = at.path();
    let sound: Vec<f32> =
        (0..50_u8).flat_map(|i| [0.02 * f32::from(i), 0.1 * f32::from(i % 7), 0.0, 0.1, 5.0]).collect();
    npy::write_f32(&at.join("sound.npy"), &[50, 5], &sound);
    let mut wild = sound.clone();
    for row in [
        [f32::NAN, 0.0, 0.0, 0.1, 5.0],
        [0.0, 0.0, f32::INFINITY, 0.1, 5.0],
        [0.0, 0.0, 0.0, 0.0, 5.0],
        [0.0, 0.0, 0.0, -1.0, 5.0],
        [0.0, 0.0, 0.0, 1e30, 5.0],
        [0.0, 0.0, 0.0, 20.0, 5.0],
        [0.0, 0.0, 0.0, 0.1, -5.0],
        [1e9, 0.0, 0.0, 0.1, 5.0],
    ] {
        wild.extend(row);
    }
    npy::write_f32(&at.join("wild.npy"), &[58, 5], &wild);
    let [sound, wild] = ["sound", "wild"].map(|name| Run::new(at, &format!("--particles {name}.npy")));
    assert!(sound.said.contains("particles: 50 of 50; none dropped"), "{}", sound.said);
    let told = "particles: 50 of 58; dropped 2 not finite, 4 of zero, negative or huge radius, \
                1 of negative extinction, 1 outside of the map";
    assert!(wild.said.contains(told), "{}", wild.said);
    assert!(wild.buffers == sound.buffers);
    assert!(sound.through().iter().any(|through| *through < 0.5));
    // A box of the user's drops what lies beside it.
    let cut = Run::new(at, "--particles sound.npy --bounds -0.2,-0.2,-0.2,0.3,1,0.2");
    assert!(cut.said.contains("outside of the map"), "{}", cut.said);
}

/// Flags, each with what it changes and what it leaves as it is.
#[test]
fn each_flag_changes_what_it_is_for() {
    let at = folder();
    let run = |flags: &str| Run::new(at.path(), flags);
    let plain: BTreeMap<&str, Run> = [CLOUD, BURST, PLUME].map(|medium| (medium, run(medium))).into();
    for (medium, flag, changed, kept) in [
        (CLOUD, "--coefficients 16", "coefficients", "background"),
        (CLOUD, "--map-size 32", "coefficients", "background"),
        (CLOUD, "--format float16", "coefficients", "background"),
        (CLOUD, "--monotone", "medium", "coefficients"),
        (CLOUD, "--reading nearest", "medium", "background"),
        (CLOUD, "--extinction-scale 0.2", "medium", "background"),
        (CLOUD, "--seed 5", "coefficients", ""),
        (CLOUD, "--light directional:-70,20", "coefficients", "background"),
        (CLOUD, "--radiance 1,2,3", "medium", "coefficients"),
        (CLOUD, "--albedo 0.5", "medium", "coefficients"),
        (CLOUD, "--albedo 1,0.5,0.2", "medium", "coefficients"),
        (CLOUD, "--g -0.5", "medium", "coefficients"),
        (CLOUD, "--eye 0,3,9", "medium", "coefficients"),
        (CLOUD, "--target 1,0,0", "medium", "coefficients"),
        (CLOUD, "--fov 60", "background", "coefficients"),
        (CLOUD, "--background 0.1,0.2,0.3", "background", "medium"),
        (BURST, "--seed 5", "coefficients", ""),
        (BURST, "--extinction-scale 0.2", "coefficients", "background"),
        (BURST, "--bounds -1,-1,-1,1,1,1", "coefficients", ""),
        (BURST, "--monotone", "medium", "coefficients"),
        (PLUME, "--seed 5", "coefficients", ""),
    ] {
        let (of, found) = (&plain[medium], run(&format!("{medium} {flag}")));
        assert!(found.buffers[changed] != of.buffers[changed], "{flag} does not change {changed}");
        assert!(kept.is_empty() || found.buffers[kept] == of.buffers[kept], "{flag} changes {kept}");
    }
    // What the numbers mean.
    let half = run(&format!("{CLOUD} --albedo 0.49")).radiance();
    let expected: Vec<f32> = plain[CLOUD].radiance().iter().map(|value| 0.5 * value).collect();
    hold("half the albedo", relative_rmse(&half, &expected), 1e-3);
    assert_eq!(run("--particles burst --count 37").shape("transmittances"), [37]);
    assert_eq!(run(&format!("{CLOUD} --extinction-scale 0")).through(), vec![1.0; 64 * 48]);
    let flat = run(&format!("{CLOUD} --background 0.25,0.5,0.75"));
    let wanted = [0.25, 0.5, 0.75, 1.0].repeat(64 * 48);
    hold("a plain background", max_absolute(&flat.buffers["background"].1, &wanted), 1e-3);
}

#[test]
fn pictures_are_framed_by_what_is_in_them() {
    let at = folder();
    for (medium, least) in
        [(CLOUD, 0.1), (ORTHOGRAPHIC, 0.1), ("--volume plume --voxels 48", 0.03), (BURST, 0.05)]
    {
        let through = Run::new(at.path(), medium).through();
        let seen = through.iter().filter(|through| **through < 0.9).count() as f64 / through.len() as f64;
        println!("{medium}: {seen:.3} of the picture");
        assert!((least..0.7).contains(&seen), "{medium} fills {seen} of the picture");
        let border =
            (0..64).flat_map(|x| [x, 47 * 64 + x]).chain((0..48).flat_map(|y| [64 * y, 64 * y + 63]));
        for pixel in border {
            assert!(through[pixel] > 0.8, "{medium} is cut at {pixel}: {}", through[pixel]);
        }
    }
}

#[test]
fn exposure_is_of_png_and_quiet_says_nothing() {
    let at = folder();
    let run = |flags: &str| {
        let line = format!("transmittance {CLOUD} --size 32x24 --map-size 16 --out x.png {flags}");
        let said = succeeds(at.path(), &words(&line)).out;
        let picture = image::open(at.path().join("x.png")).unwrap().into_rgb8();
        let mean =
            picture.as_raw().iter().map(|v| f64::from(*v)).sum::<f64>() / picture.as_raw().len() as f64;
        (said, mean)
    };
    let (told, plain) = run("");
    assert_eq!(told, "x.png\n");
    let (quiet, bright) = run("--exposure 3 --quiet");
    assert_eq!(quiet, "");
    assert!(bright > plain + 20.0 && plain > 40.0, "{plain} {bright}");
}

#[test]
fn awkward_sizes_draw() {
    let at = folder();
    for flags in [
        "--volume cloud --voxels 4 --size 1x1 --map-size 1",
        "--volume plume --voxels 5 --size 3x2 --map-size 3 --map moments",
        "--particles burst --count 1 --size 1x3 --map-size 1 --map fom --splat blend",
        "--particles burst --count 1 --size 5x1 --map-size 2",
        "--volume cloud --voxels 4 --size 2x2 --eye 0,0,0.1 --target 0,0,-1 --light directional:0,90",
    ] {
        draws_finite(at.path(), &format!("transmittance --out x.exr {flags}"));
    }
}
