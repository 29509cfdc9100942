// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering`: what its flags do, two eyes, and awkward sizes. Every light against a march is in
//! `scattering.rs`.

use crate::command::{draws_finite, succeeds};
use crate::hall::{EYE, scene};
use crate::hall_runs::{Run, SUN};
use airlight_tests::error::relative_rmse;
use glam::Vec3;

#[test]
fn two_eyes_see_what_each_would() {
    let at = scene();
    let at = at.path();
    // The camera's right is +x turned towards -z, seen from (0.5, 1.2, 6) at (0, 1.1, 0).
    let look = Vec3::new(-0.5, -0.1, -6.0);
    let right = look.cross(Vec3::Y).normalize() * 0.2;
    for (light, method, reason) in [
        ("directional:95,35", "auto", "epipolar (rank queries need"),
        ("directional:95,35", "fourier", "projective"),
        ("spot:-2,4,1,0,0.5,0,30", "auto", "epipolar (rows of a spot"),
    ] {
        let own = format!("--light {light} --method {method} --radiance 20,20,20 --near 0.05 --far 14");
        let both = Run::new(at, "hall.obj", &format!("{EYE} {own} --stereo 0.4"));
        assert!(both.reason().starts_with(reason), "{}", both.said);
        for (name, side) in [("left_", -right), ("right_", right)] {
            let eye = Vec3::new(0.5, 1.2, 6.0) + side;
            let target = eye + look;
            let at_eye = format!(
                "--eye {},{},{} --target {},{},{}",
                eye.x, eye.y, eye.z, target.x, target.y, target.z
            );
            let one = Run::new(at, "hall.obj", &format!("{at_eye} {own}"));
            for buffer in ["scattered", "composed", "rectified"] {
                let [both, one] = [&both.buffers[&format!("{name}{buffer}")], &one.buffers[buffer]];
                let error = relative_rmse(&both.1, &one.1);
                println!("{light} {name}{buffer}: {error:.1e}");
                assert!(error < 0.01, "{light} {name}{buffer}: {error}");
            }
        }
        let [left, right] = ["left_", "right_"].map(|name| both.radiance(&format!("{name}scattered")));
        assert!(relative_rmse(&left, &right) > 0.03, "both eyes see the same");
    }
}

#[test]
fn flags_of_the_filter_reach_it() {
    let at = scene();
    let setup = format!("{SUN} --rectification epipolar --extinction 0.2");
    let run = |own: &str| Run::new(at.path(), "hall.obj", &format!("{setup}{own}")).buffers;
    for (method, flag, changed) in [
        ("fourier", " --reference optimum", "slices"),
        ("fourier", " --regions 3", "bases"),
        ("fourier", " --average", "bases"),
        ("fourier", " --half", "bases"),
        ("fourier", " --bases 16", "bases"),
        ("rank", " --bits 10", "rank_starts"),
        ("rank", " --average", "rank_cells"),
        ("wavelet --average", " --bits 10", "wavelet"),
        ("moments", " --average", "moments"),
    ] {
        let method = format!(" --method {method}");
        let [plain, other] = ["", flag].map(|flag| run(&format!("{method}{flag}")));
        assert!(other[changed] != plain[changed], "{flag} does not change {changed}");
    }
    // Flags of Fourier bases ask for them.
    for flag in [" --bases 16", " --half", " --regions 2"] {
        assert!(run(flag).contains_key("bases"), "{flag}");
    }
    assert!(run("").contains_key("rank_cells"));
}

#[test]
fn jitter_moves_samples_and_the_frame_moves_them_again() {
    let at = scene();
    let at = at.path();
    let run = |flags: &str| Run::new(at, "hall.obj", &format!("{SUN} --method march {flags}"));
    let exact = run("--steps 512").radiance("scattered");
    let plain = run("--steps 8").radiance("scattered");
    for jitter in ["gradient", "blue-noise"] {
        let [first, again, second] = ["", " --frame 0", " --frame 1"]
            .map(|frame| run(&format!("--steps 8 --jitter {jitter}{frame}")).radiance("scattered"));
        assert!(first == again && first != second && first != plain, "{jitter}");
        for picture in [&first, &second] {
            let error = relative_rmse(picture, &exact);
            println!("{jitter}: {error:.4}");
            assert!(error < 0.15, "{jitter}: {error}");
        }
    }
}

#[test]
fn the_rows_are_told_unless_quiet() {
    let at = scene();
    let run = |flags: &[&str]| {
        let own = ["scattering", "--mesh", "hall.obj", "--out", "x.png", "--size", "32x24", "--map", "64x64"];
        succeeds(at.path(), &[&own[..], flags].concat()).out
    };
    let told = run(&[]);
    assert_eq!(told.lines().count(), 2, "{told}");
    assert!(told.starts_with("rectification: ") && told.ends_with("x.png\n"), "{told}");
    assert_eq!(run(&["--quiet"]), "");
}

#[test]
fn awkward_sizes_draw() {
    let at = scene();
    for flags in [
        "--size 1x1 --map 1x1 --shadow-map 1x1 --bases 4 --splits 4",
        "--size 5x3 --map 2x3 --shadow-map 1x1 --bases 4 --regions 8 --resolution quarter",
        "--size 1x1 --map 3x1 --bases 4 --light point:0,3,0 --resolution half",
        "--size 3x2 --map 1x2 --bases 4 --shadow-map 1x2 --light spot:0,4,0,0,0,0.1,30 --light-texture glass.png",
        "--size 1x1 --map 1x1 --shadow-map 1x1 --method rank",
        "--size 5x3 --map 33x2 --shadow-map 1x1 --method rank --bits 8 --resolution quarter --start near-plane",
        "--size 3x2 --map 33x2 --shadow-map 1x2 --light spot:0,4,0,0,0,0.1,30 --light-texture glass.png --method rank",
        "--size 3x2 --map 33x2 --shadow-map 2x2 --light point:0,3,0 --method rank --bits 8",
        "--size 3x2 --map 31x2 --shadow-map 2x2 --rectification projective --splits 4",
        "--size 3x2 --map 1x2 --shadow-map 1x2 --method moments --start near-plane",
        "--size 3x2 --map 1x2 --shadow-map 1x2 --light spot:0,4,0,0,0,0.1,30 --light-texture glass.png --method moments",
        "--size 3x2 --map 9x2 --shadow-map 2x2 --light point:0,3,0 --method moments",
        "--size 3x2 --map 31x2 --shadow-map 2x2 --rectification projective --method moments --splits 4",
        "--size 3x5 --map 65x2 --shadow-map 1x1 --method wavelet --average --bits 10 --start near-plane",
        // Wider than rank queries take: bases.
        "--size 3x2 --map 2049x2 --shadow-map 2x2",
    ] {
        draws_finite(at.path(), &format!("scattering --mesh hall.obj --out x.exr {flags}"));
    }
}
