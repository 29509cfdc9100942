// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight scattering` with every light and every input, each against a march of the same setup. What flags do
//! is tested in `scattering_flags.rs`, flags that cannot be meant in `scattering_refusals.rs`, bad files and numbers in `shared.rs`.

use crate::hall::{EYE, scene};
use crate::hall_runs::{Run, SIZE, SUN};
use airlight_tests::error::relative_rmse;
use std::path::Path;

/// Setups with a light each.
const SPOT: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light spot:-2,4,1,0,0.5,0,30";
const POINT: &str = "--eye 0.5,1.2,6 --target 0,1.1,0 --light point:-1.5,1.5,0.5";
const ORTHOGRAPHIC: &str =
    "--camera orthographic --eye 0.5,2,6 --target 0,1.1,0 --height 5 --near 1 --far 14";

/// Runs a setup by rows, `own` being flags that a march has none of, and by a march of 512 steps; the first must have
/// chosen the rows `reason` and agree within `tolerance`, which the shadows are well above.
#[track_caller]
fn agrees(at: &Path, setup: &str, own: &str, reason: &str, tolerance: f64) {
    let found = Run::new(at, "hall.obj", &format!("{setup} {own}"));
    let marched = Run::new(at, "hall.obj", &format!("{setup} --method march --steps 512"));
    let bare = Run::new(at, "bare.obj", &format!("{setup} --method march --steps 64"));
    assert!(found.reason().starts_with(reason), "{setup} {own}: {}", found.said);
    assert_eq!(marched.reason(), "none (--method march)");
    for name in marched.buffers.keys().filter(|name| name.ends_with("scattered")) {
        let exact = marched.radiance(name);
        let error = relative_rmse(&found.radiance(name), &exact);
        let shadows = relative_rmse(&marched.visibility(name), &bare.visibility(name));
        let mean = exact.iter().map(|value| f64::from(*value)).sum::<f64>() / exact.len() as f64;
        println!("{setup} {own}: {name} off by {error:.4}, shadows {shadows:.3}, mean {mean:.3}");
        assert!(error <= tolerance, "{setup} {own}: {name} is off by {error:.4}, {tolerance} is allowed");
        assert!(shadows > 2.0 * tolerance, "{setup}: shadows of {shadows:.4} show nothing");
        assert!(mean > 1e-3, "{setup}: {name} is black");
    }
}

#[test]
fn rows_of_a_directional_light_agree_with_the_march() {
    let at = scene();
    let at = at.path();
    agrees(at, SUN, "", "epipolar (rank queries need", 0.015);
    agrees(at, SUN, "--method rank --bits 8", "epipolar (rank queries need", 0.02);
    agrees(at, &format!("{SUN} --average"), "--method wavelet", "epipolar (", 0.015);
    agrees(at, SUN, "--method moments", "epipolar (moments", 0.03);
    agrees(at, SUN, "--method moments --splits 3", "projective (the light is outside", 0.03);
    agrees(at, SUN, "--method moments --rectification projective", "projective (as asked for)", 0.03);
    agrees(at, SUN, "--method fourier", "projective (", 0.03);
    agrees(at, SUN, "--rectification projective --splits 4", "projective (as asked for)", 0.015);
    agrees(
        at,
        SUN,
        "--rectification projective --splits 4 --method fourier",
        "projective (as asked for)",
        0.03,
    );
    agrees(at, SUN, "--method rank --splits 3", "projective (the light is outside", 0.015);
    let rows = &Run::new(at, "hall.obj", &format!("{SUN} --splits 4")).buffers["rows"];
    // The words of the uniform; the number of splits is an integer.
    assert_eq!((rows.0[0], rows.1[22].to_bits()), (24, 4));
    agrees(at, SUN, "--rectification epipolar", "epipolar (as asked for)", 0.03);
    agrees(at, SUN, "--reference optimum --regions 3", "epipolar (--reference", 0.03);
    let ahead = format!("{EYE} --light directional:185,12");
    // Rows around a light in the picture hold rays of all angles, which share their weights; plain means are exact.
    agrees(at, &ahead, "", "epipolar (rank queries need", 0.05);
    agrees(at, &format!("{ahead} --average"), "", "epipolar (rank queries need", 0.02);
    agrees(at, &ahead, "--half --bases 64", "epipolar (the light is in the picture", 0.06);
    agrees(at, &format!("{ahead} --average"), "--half --bases 64", "epipolar (the light is in", 0.03);
    agrees(at, &format!("{SUN} --average"), "--regions 4 --splits 2", "projective (", 0.04);
}

#[test]
fn depth_of_every_kind_is_taken() {
    let at = scene();
    let at = at.path();
    agrees(at, &format!("{SUN} --depth-range reversed"), "", "epipolar (rank queries need", 0.015);
    agrees(at, &format!("{SUN} --depth-range infinite --far 14"), "", "epipolar (rank queries need", 0.015);
    agrees(at, &format!("{SUN} --depth-range reversed"), "--method fourier", "projective (", 0.03);
    agrees(at, &format!("{SUN} --depth-range infinite --far 14"), "--method fourier", "projective (", 0.03);
    agrees(at, &format!("{POINT} --depth-range infinite"), "", "epipolar (", 0.03);
    agrees(at, &format!("{SUN} --samples 4"), "--rectification epipolar", "epipolar (", 0.03);
    // Several samples change the edges of the picture, and nothing but those.
    let [one, four] = ["1", "4"]
        .map(|n| Run::new(at, "hall.obj", &format!("{SUN} --method march --steps 64 --samples {n}")).buffers);
    let pairs = one["depth"].1.iter().zip(&four["depth"].1);
    let changed = pairs.filter(|(a, b)| (**a - **b).abs() > 1e-3 * **a).count();
    assert_eq!(one["depth"].0, [SIZE[1], SIZE[0]]);
    assert_eq!(four["depth"].0, [SIZE[1], SIZE[0]]);
    assert!((20..1500).contains(&changed), "{changed} depths changed");
}

#[test]
fn orthographic_cameras_are_rectified_or_marched() {
    let at = scene();
    let at = at.path();
    let sun = format!("{ORTHOGRAPHIC} --light directional:95,35");
    agrees(at, &sun, "--start near-plane", "projective (", 0.05);
    agrees(at, &sun, "--method moments", "projective (", 0.05);
    agrees(at, &format!("{sun} --depth-range reversed"), "--resolution half", "projective (", 0.05);
    for (light, reason) in [
        ("--light point:-1.5,1.5,0.5", "none, marched instead (an orthographic"),
        ("--light directional:95,35 --cascades 2", "none, marched instead (an orthographic"),
        // Along the view: the target is at (-0.5, -0.9, -6) from the eye.
        ("--light directional:4.7636,8.4993", "none, marched instead (the "),
    ] {
        agrees_exactly(at, &format!("{ORTHOGRAPHIC} {light}"), reason);
    }
    // No flag but the camera: the mesh is framed.
    let framed = Run::new(at, "hall.obj", "--camera orthographic");
    let [lit, seen] =
        [("scattered", 3, 0.05..1.01), ("depth", 0, 0.05..0.95)].map(|(name, channel, range)| {
            let (shape, values) = &framed.buffers[name];
            let texels = values.chunks_exact(if shape.len() == 3 { 4 } else { 1 });
            texels.filter(|texel| range.contains(&texel[channel])).count()
        });
    assert!(lit > 3000 && seen > 200, "{lit} pixels are lit, {seen} see the mesh");
}

/// Where rows do not exist the picture is the march's.
#[track_caller]
fn agrees_exactly(at: &Path, setup: &str, reason: &str) {
    let found = Run::new(at, "hall.obj", setup);
    let marched = Run::new(at, "hall.obj", &format!("{setup} --method march"));
    assert!(found.reason().starts_with(reason), "{setup}: {}", found.said);
    assert!(found.buffers["scattered"] == marched.buffers["scattered"], "{setup}");
    let mean = found.radiance("scattered").iter().sum::<f32>() / found.buffers["scattered"].1.len() as f32;
    assert!(mean > 1e-4, "{setup}: black");
}

#[test]
fn spots_and_point_lights_agree_with_the_march() {
    let at = scene();
    let at = at.path();
    agrees(at, SPOT, "", "epipolar (rows of a spot", 0.08);
    agrees(at, SPOT, "--half --bases 64 --rectification epipolar", "epipolar (as asked for)", 0.06);
    agrees(at, POINT, "", "epipolar (rows of a spot", 0.03);
    agrees(at, SPOT, "--method moments", "epipolar (rows of a spot", 0.08);
    agrees(at, POINT, "--method moments", "epipolar (rows of a spot", 0.04);
    agrees(at, &format!("{POINT} --average"), "", "epipolar (", 0.03);
    agrees_exactly(at, &format!("{EYE} --light point:0.5,1.2,6"), "none, marched instead (the eye is 0 m");
}

#[test]
fn light_textures_and_cascades_agree_with_the_march() {
    let at = scene();
    let at = at.path();
    agrees(at, &format!("{SUN} --light-texture glass.png"), "", "epipolar (a light texture", 0.04);
    agrees(at, &format!("{SPOT} --light-texture glass.png"), "", "epipolar (", 0.1);
    let moments = "--method moments";
    agrees(at, &format!("{SUN} --light-texture glass.png"), moments, "epipolar (a light texture", 0.04);
    agrees(at, &format!("{SPOT} --light-texture glass.png"), moments, "epipolar (", 0.1);
    agrees(at, &format!("{SUN} --cascades 3"), moments, "epipolar (cascades", 0.03);
    agrees(at, &format!("{SUN} --cascades 3"), "--regions 2", "epipolar (cascades", 0.03);
    agrees(at, &format!("{SUN} --cascades 2 --light-texture glass.png"), "", "epipolar (", 0.04);
    let glass = Run::new(at, "hall.obj", &format!("{SUN} --light-texture glass.png --method march"));
    let white = Run::new(at, "hall.obj", &format!("{SUN} --method march"));
    let changed = relative_rmse(&glass.radiance("scattered"), &white.radiance("scattered"));
    assert!(changed > 0.2, "the texture changes the light by {changed} only");
    let cascades = Run::new(at, "hall.obj", &format!("{SUN} --cascades 3"));
    assert_eq!(cascades.buffers["shadow_maps"].0, [3, 256, 256]);
}

#[test]
fn fewer_pixels_agree_with_the_march_of_all() {
    let at = scene();
    let at = at.path();
    // The march is full; its own reduction is compared as well.
    agrees_with_full(at, SUN, "--resolution half", [48, 32], 0.04);
    agrees_with_full(at, SUN, "--rectification epipolar --resolution quarter", [24, 16], 0.06);
    agrees_with_full(at, SUN, "--method march --resolution quarter", [24, 16], 0.06);
    agrees_with_full(at, SPOT, "--resolution half", [48, 32], 0.1);
}

#[track_caller]
fn agrees_with_full(at: &Path, setup: &str, own: &str, [width, height]: [usize; 2], tolerance: f64) {
    let found = Run::new(at, "hall.obj", &format!("{setup} {own}"));
    let full = Run::new(at, "hall.obj", &format!("{setup} --method march"));
    let error = relative_rmse(&found.radiance("scattered"), &full.radiance("scattered"));
    println!("{setup} {own}: {error:.4}");
    assert!(error <= tolerance, "{setup} {own}: off by {error}, {tolerance} is allowed");
    assert_eq!(found.buffers["reduced_scattered"].0, [height, width, 4]);
    assert_eq!(found.buffers["reduced_depth"].0, [height, width]);
    assert_eq!(found.buffers["scattered"].0, [SIZE[1], SIZE[0], 4]);
}

#[test]
fn light_before_the_near_plane_is_left_out() {
    let at = scene();
    let at = at.path();
    // All is lit before the plane: what lies there has a closed form.
    let (extinction, near) = (0.08, 1.5);
    let setup = format!("{SUN} --near {near} --fov 40 --g 0 --albedo 1 --radiance 10,10,10 --far 16");
    let from_eye = Run::new(at, "hall.obj", &format!("{setup} --method march --steps 512"));
    let (half_height, half_width) = {
        let tangent = 20f64.to_radians().tan();
        (tangent, tangent * SIZE[0] as f64 / SIZE[1] as f64)
    };
    let exact: Vec<f64> = from_eye
        .radiance("scattered")
        .iter()
        .enumerate()
        .map(|(i, radiance)| {
            let (x, y) = (i / 3 % SIZE[0], i / 3 / SIZE[0]);
            let place = |at: usize, of: usize| (at as f64 + 0.5) / of as f64 * 2.0 - 1.0;
            let slant =
                (1.0 + (half_width * place(x, SIZE[0])).powi(2) + (half_height * place(y, SIZE[1])).powi(2))
                    .sqrt();
            let before = extinction * near * slant;
            let skipped = 10.0 / (4.0 * std::f64::consts::PI) * (1.0 - (-before).exp());
            (f64::from(*radiance) - skipped) * before.exp()
        })
        .collect();
    for own in ["--rectification epipolar", "--rectification projective", "--resolution half"] {
        let found = Run::new(at, "hall.obj", &format!("{setup} --start near-plane {own}"));
        let error = relative_rmse(&found.radiance("scattered"), &exact);
        let changed = relative_rmse(&from_eye.radiance("scattered"), &exact);
        println!("near plane {own}: {error:.4}, the stretch before it {changed:.3}");
        assert!(error < 0.03, "{own}: {error}");
        assert!(changed > 0.1, "the stretch before the plane is {changed} only");
    }
}
