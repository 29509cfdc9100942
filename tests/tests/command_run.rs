// SPDX-License-Identifier: MIT OR Apache-2.0
//! `airlight run`: passes on arrays against closed forms, and every way to ask for what cannot be.
#![allow(clippy::unwrap_used)]

#[path = "support/command.rs"]
mod command;
#[path = "support/npy.rs"]
mod npy;

use command::{airlight, files, refuses, succeeds};
use std::f64::consts::PI;
use std::path::Path;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The tone curve and the sRGB encoding of core/color, from their published formulas.
fn toned(x: f64) -> f64 {
    let curve = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    255.0 * if curve <= 0.003_130_8 { 12.92 * curve } else { 1.055 * curve.powf(1.0 / 2.4) - 0.055 }
}

#[track_caller]
fn assert_picture(path: &Path, shape: &[usize], expected: &[f64]) {
    let (found_shape, found) = npy::read_u8(path);
    assert_eq!(found_shape, shape);
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((f64::from(*found) - expected).abs() <= 0.55, "value {index}: {found}, not {expected}");
    }
}

#[test]
fn tonemap_follows_its_formula_for_floats_of_any_size_and_bytes() {
    let at = folder();
    let values: Vec<f32> = (0..2 * 3 * 3).map(|index| 0.002 * 1.6_f32.powi(index)).collect();
    let expected: Vec<f64> = values
        .chunks(3)
        .flat_map(|rgb| {
            [
                toned(2.0 * f64::from(rgb[0])),
                toned(2.0 * f64::from(rgb[1])),
                toned(2.0 * f64::from(rgb[2])),
                255.0,
            ]
        })
        .collect();
    npy::write_f32(&at.path().join("a.npy"), &[2, 3, 3], &values);
    let wide: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
    npy::write_f64(&at.path().join("b.npy"), &[2, 3, 3], &wide);
    for file in ["a", "b"] {
        let (input, output) = (format!("radiance={file}.npy"), format!("picture={file}_out.npy:2,3"));
        succeeds(
            at.path(),
            &[
                "run",
                "core/tonemap",
                "--in",
                &input,
                "--set",
                "parameters.exposure=2",
                "--over",
                "3,2",
                "--out",
                &output,
            ],
        );
        assert_picture(&at.path().join(format!("{file}_out.npy")), &[2, 3, 4], &expected);
    }

    // Bytes stand for 0..1; the struct's name does for the binding's; --size for the shape.
    let bytes: Vec<u8> = (0..16).map(|index| index * 17).collect();
    npy::write_u8(&at.path().join("c.npy"), &[2, 2, 4], &bytes);
    succeeds(
        at.path(),
        &[
            "run",
            "core/tonemap:default",
            "--in",
            "radiance=c.npy",
            "--set",
            "TonemapParameters.exposure=1",
            "--dispatch",
            "1",
            "--size",
            "2x2",
            "--out",
            "picture=c_out.npy",
        ],
    );
    let expected: Vec<f64> = (0..16)
        .map(|index| if index % 4 == 3 { 255.0 } else { toned(f64::from(bytes[index]) / 255.0) })
        .collect();
    assert_picture(&at.path().join("c_out.npy"), &[2, 2, 4], &expected);
}

#[test]
fn scan_runs_by_entry_point_and_its_buffers_go_round() {
    let at = folder();
    let count = 2500;
    let values: Vec<u32> = (0..count).map(|index| index * 7919 % 1000).collect();
    npy::write_u32(&at.path().join("v.npy"), &[count as usize], &values);
    let set = format!("parameters.count={count}");
    succeeds(
        at.path(),
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--set",
            &set,
            "--in",
            "values=v.npy",
            "--dispatch",
            "3",
            "--out",
            "values=scanned.npy",
            "--out",
            "block_sums=sums.npy:3",
        ],
    );

    let (shape, scanned) = npy::read_u32(&at.path().join("scanned.npy"));
    assert_eq!(shape, [2500]);
    for (block, found) in scanned.chunks(1024).enumerate() {
        let mut sum = 0;
        for (index, found) in found.iter().enumerate() {
            assert_eq!(*found, sum, "block {block}, value {index}");
            sum += values[block * 1024 + index];
        }
    }
    let (shape, sums) = npy::read_u32(&at.path().join("sums.npy"));
    assert_eq!(shape, [3]);
    let expected: Vec<u32> = values.chunks(1024).map(|block| block.iter().sum()).collect();
    assert_eq!(sums, expected);

    let before = [0, sums[0], sums[0] + sums[1]];
    npy::write_u32(&at.path().join("before.npy"), &[3], &before);
    succeeds(
        at.path(),
        &[
            "run",
            "core/scan",
            "--entry",
            "add_offsets",
            "--set",
            &set,
            "--in",
            "values=scanned.npy",
            "--in",
            "block_sums=before.npy",
            "--over",
            "640,1,1",
            "--out",
            "values=done.npy:50,50:i32",
        ],
    );
    let (shape, done) = npy::read_i32(&at.path().join("done.npy"));
    assert_eq!(shape, [50, 50]);
    let mut sum = 0;
    for (index, found) in done.iter().enumerate() {
        assert_eq!(found.cast_unsigned(), sum, "value {index}");
        sum += values[index];
    }
}

/// Basis `index` (from 0) of Eq. 4.7 of a blocker at depth `z`, as it is stored, 0..1. Of `bases`, blockers are
/// moved by 0.6 / M, at most 0.04, and not beyond 1.
fn stored_basis(index: usize, bases: usize, z: f64) -> f64 {
    let z = (z + (0.6 / bases as f64).min(0.04)).min(1.0);
    let angle = PI * (2.0 * (index / 2) as f64 + 1.0) * z;
    0.5 + 0.5 * if index.is_multiple_of(2) { angle.sin() } else { angle.cos() }
}

#[track_caller]
fn assert_bases(found: &[f64], bases: usize, rows: &[[f64; 4]], ratio: f64, tolerance: f64) {
    for layer in 0..bases / 4 {
        for (row, depths) in rows.iter().enumerate() {
            for column in 0..4 {
                for channel in 0..4 {
                    let basis = 4 * layer + channel;
                    let weights: Vec<f64> = (0..=column as i32).map(|i| ratio.powi(i)).collect();
                    let sum: f64 =
                        weights.iter().zip(depths).map(|(w, z)| w * stored_basis(basis, bases, *z)).sum();
                    let expected = sum / weights.iter().sum::<f64>();
                    let at = ((layer * rows.len() + row) * 4 + column) * 4 + channel;
                    let error = (found[at] - expected).abs();
                    assert!(
                        error <= tolerance,
                        "basis {basis} at {row},{column}: {} not {expected}",
                        found[at]
                    );
                }
            }
        }
    }
}

#[test]
fn filter_makes_the_means_that_its_equations_say() {
    let at = folder();
    let rows = [[0.25, 0.25, 0.25, 0.25], [0.0, 0.0, 0.5, 1.0], [0.1, 0.9, 0.3, 0.7]];
    let values: Vec<f32> = rows.iter().flatten().map(|z| *z as f32).collect();
    npy::write_f32(&at.path().join("map.npy"), &[3, 4], &values);

    succeeds(
        at.path(),
        &[
            "run",
            "scattering/filter:average_rgba16float",
            "--in",
            "rectified=map.npy",
            "--over",
            "3,4",
            "--out",
            "bases=average.npy:8,3,4",
        ],
    );
    let (shape, found) = npy::read_f32(&at.path().join("average.npy"));
    assert_eq!(shape, [8, 3, 4, 4]);
    let found: Vec<f64> = found.into_iter().map(f64::from).collect();
    assert_bases(&found, 32, &rows, 1.0, 6e-4);

    // Fewer bases by definition; weights that halve from texel to texel: extinction * radius_max / (4 * reference) = ln 2.
    let slice = [0.0, 1.0, 8.0, 2.0].repeat(3);
    npy::write_f32(&at.path().join("slices.npy"), &[1, 3, 4], &slice);
    let set = format!("medium.extinction={}", std::f64::consts::LN_2);
    succeeds(
        at.path(),
        &[
            "run",
            "scattering/filter",
            "--define",
            "BASES=8",
            "--define",
            "BASES_PER_THREAD=4",
            "--in",
            "rectified=map.npy",
            "--in",
            "slices=slices.npy",
            "--set",
            &set,
            "--over",
            "3,2",
            "--out",
            "bases=weighted.npy:2,3,4",
        ],
    );
    let (shape, found) = npy::read_u8(&at.path().join("weighted.npy"));
    assert_eq!(shape, [2, 3, 4, 4]);
    let found: Vec<f64> = found.into_iter().map(|value| f64::from(value) / 255.0).collect();
    assert_bases(&found, 8, &rows, 0.5, 0.51 / 255.0);
}

/// A camera as raw words, looking along -z from the origin with a field of view of 90 degrees and depths 0..1.
fn camera() -> Vec<f32> {
    let (near, far) = (0.1_f64, 10.0);
    let (a, b) = (far / (near - far), far * near / (near - far));
    // Columns.
    let clip_from_world =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, a, -1.0], [0.0, 0.0, b, 0.0]];
    let world_from_clip =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0 / b], [0.0, 0.0, -1.0, a / b]];
    let mut words: Vec<f32> =
        [clip_from_world, world_from_clip].iter().flatten().flatten().map(|word| *word as f32).collect();
    // Eye, depth of the near plane; viewport, depth of the far plane, perspective.
    words.extend([0.0, 0.0, 0.0, 0.0, 8.0, 8.0, 1.0, f32::from_bits(0)]);
    words
}

#[test]
fn a_full_screen_pass_draws_the_sky() {
    let at = folder();
    npy::write_f32(&at.path().join("camera.npy"), &[40], &camera());
    succeeds(
        at.path(),
        &[
            "run",
            "core/raster",
            "--entry",
            "fragment_background",
            "--vertex",
            "vertex_background",
            "--size",
            "8x8",
            "--in",
            "camera=camera.npy",
            "--set",
            "sky.zenith=1,2,3",
            "--set",
            "Sky.horizon=0.5,0.25,0",
            "--set",
            "sky.ground=0,0,8",
            "--out",
            "color=sky.npy",
        ],
    );
    let (shape, sky) = npy::read_f32(&at.path().join("sky.npy"));
    assert_eq!(shape, [8, 8, 4]);
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
    for row in 0..8 {
        for column in 0..8 {
            let (x, y) = ((f64::from(column) + 0.5) / 4.0 - 1.0, 1.0 - (f64::from(row) + 0.5) / 4.0);
            let up = y / (x * x + y * y + 1.0).sqrt();
            let (zenith, horizon, ground) = ([1.0, 2.0, 3.0], [0.5, 0.25, 0.0], [0.0, 0.0, 8.0]);
            let t = (-up / 0.12).clamp(0.0, 1.0);
            let expected = if up >= 0.0 {
                mix(horizon, zenith, up.sqrt())
            } else {
                mix(horizon, ground, t * t * (3.0 - 2.0 * t))
            };
            let place = ((row * 8 + column) * 4) as usize;
            for channel in 0..3 {
                let found = f64::from(sky[place + channel]);
                assert!(
                    (found - expected[channel]).abs() < 1e-4,
                    "{row},{column}: {found}, not {}",
                    expected[channel]
                );
            }
            assert_eq!(sky[place + 3], 1.0);
        }
    }
}

#[test]
fn a_struct_that_one_pass_writes_is_the_uniform_of_the_next() {
    let at = folder();
    let folder = at.path();
    npy::write_f32(&folder.join("camera.npy"), &[40], &camera());
    succeeds(
        folder,
        &[
            "run",
            "scattering/slices",
            "--in",
            "camera=camera.npy",
            "--set",
            "light.direction=0,1,0",
            "--set",
            "medium.distance_limit=10",
            "--over",
            "8",
            "--out",
            "frame=frame.npy",
            "--out",
            "slices=slices.npy:1,8",
        ],
    );
    let (shape, frame) = npy::read_f32(&folder.join("frame.npy"));
    assert_eq!(shape, [32]);
    // light, towards it; the number of rows is where the layout says.
    assert_eq!(frame[..3], [0.0, 1.0, 0.0]);
    assert_eq!(frame[11], 8.0);
    let (shape, slices) = npy::read_f32(&folder.join("slices.npy"));
    assert_eq!(shape, [1, 8, 4]);
    assert!(slices.iter().all(|value| value.is_finite()));

    // Without a blocker anywhere every depth of the rectified map is 1.
    npy::write_f32(&folder.join("shadow.npy"), &[4, 4], &[1.0; 16]);
    succeeds(
        folder,
        &[
            "run",
            "scattering/rectify",
            "--in",
            "frame=frame.npy",
            "--in",
            "slices=slices.npy",
            "--in",
            "shadow_map=shadow.npy",
            "--set",
            "light.far_depth=1",
            "--over",
            "5,8",
            "--out",
            "rectified=map.npy:8,5",
        ],
    );
    let (shape, map) = npy::read_f32(&folder.join("map.npy"));
    assert_eq!(shape, [8, 5]);
    assert_eq!(map, [1.0; 40]);
}

/// Passes of the tests' own, for what the library's do not have yet.
const MIXED: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Everything that can be bound.
struct Inner { scale: vec2<f32>, count: u32 }
struct Parameters { turn: mat2x2<f32>, inner: array<Inner, 2>, shift: i32 }
@group(#{GROUP}) @binding(0) var<uniform> parameters: Parameters;
@group(#{GROUP}) @binding(1) var volume: texture_3d<f32>;
@group(#{GROUP}) @binding(2) var image: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var image_sampler: sampler;
@group(#{GROUP}) @binding(4) var ids: texture_2d<u32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> results: array<vec4<f32>>;
@group(#{GROUP}) @binding(6) var marks: texture_storage_2d<r32uint, read_write>;
@group(#{GROUP}) @binding(7) var<storage, read> points: array<vec3<f32>>;
@group(#{GROUP}) @binding(8) var<uniform> again: Parameters;
@compute @workgroup_size(1)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let turned = parameters.turn * vec2<f32>(1.0, 10.0);
    results[4u * id.x] = vec4<f32>(turned, f32(parameters.inner[1].count), f32(parameters.shift));
    results[4u * id.x + 1u] = vec4<f32>(
        textureLoad(volume, vec3<u32>(1u, 0u, 1u), 0).x,
        textureSampleLevel(image, image_sampler, vec2<f32>(0.5, 0.25), 0.0).y,
        f32(textureLoad(ids, vec2<u32>(1u, 1u), 0).x), f32(arrayLength(&results))
    );
    results[4u * id.x + 2u] = vec4<f32>(points[1], f32(arrayLength(&points)));
    results[4u * id.x + 3u] = vec4<f32>(parameters.inner[0].scale, again.inner[0].scale);
}
@compute @workgroup_size(2, 2)
fn mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let old = textureLoad(marks, id.xy).x;
    textureStore(marks, id.xy, vec4<u32>(old * 2u + id.x + u32(parameters.shift), 0u, 0u, 0u));
}
";

const DEPTHS: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: What run cannot make.
@group(#{GROUP}) @binding(0) var depths: texture_depth_2d;
@group(#{GROUP}) @binding(1) var<storage, read_write> results: array<f32>;
@compute @workgroup_size(1)
fn depth_main() { results[0] = textureLoad(depths, vec2<u32>(0u), 0); }
@vertex
fn two_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return vec4<f32>(f32(index)); }
struct Two { @location(0) a: vec4<f32>, @location(1) b: vec4<f32> }
@fragment
fn two() -> Two { return Two(vec4<f32>(1.0), vec4<f32>(2.0)); }
@fragment
fn three() -> @location(0) vec3<f32> { return vec3<f32>(1.0); }
";

const BROKEN: &str = "// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Wrong.
@compute @workgroup_size(1)
fn broken() { let x: u32 = 1.5; }
";

fn own_shaders(folder: &Path) {
    let passes = folder.join("own/t/passes");
    std::fs::create_dir_all(&passes).unwrap();
    for (name, text) in [("mixed", MIXED), ("depths", DEPTHS), ("broken", BROKEN)] {
        std::fs::write(passes.join(format!("{name}.wgsl")), text).unwrap();
    }
    std::fs::write(
        folder.join("own/t/permutations"),
        "mixed\n+ default:\ndepths\n+ default:\nbroken\n+ default:\n",
    )
    .unwrap();
}

#[test]
fn shaders_of_a_folder_get_every_kind_of_resource() {
    let at = folder();
    let folder = at.path();
    own_shaders(folder);
    npy::write_f32(&folder.join("volume.npy"), &[2, 1, 3], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // Two rows, two columns, two channels: 0.25 down is the centre of the first row, 0.5 between its columns.
    npy::write_f32(&folder.join("image.npy"), &[2, 2, 2], &[0.0, 1.0, 0.0, 2.0, 0.0, 9.0, 0.0, 9.0]);
    npy::write_u32(&folder.join("ids.npy"), &[2, 2], &[0, 0, 0, 77]);
    npy::write_f32(
        &folder.join("points.npy"),
        &[3, 4],
        &[0.0, 0.0, 0.0, 0.0, 1.5, 2.5, 3.5, 9.0, 0.0, 0.0, 0.0, 0.0],
    );
    succeeds(
        folder,
        &[
            "run",
            "t/mixed",
            "--shaders",
            "own",
            "--entry",
            "gather",
            "--dispatch",
            "1",
            "--set",
            "parameters.turn=1,2,3,4",
            "--set",
            "parameters.inner[1].count=12",
            "--set",
            "parameters.shift=-3",
            "--set",
            "parameters.inner[0].scale=0.5,-0.5",
            "--set",
            "again.inner[0].scale=7,8",
            "--in",
            "volume=volume.npy",
            "--in",
            "image=image.npy",
            "--in",
            "ids=ids.npy",
            "--in",
            "points=points.npy",
            "--out",
            "results=results.npy:5,4",
        ],
    );
    let (shape, results) = npy::read_f32(&folder.join("results.npy"));
    assert_eq!(shape, [5, 4]);
    let expected = [
        // Columns (1, 2) and (3, 4) times (1, 10).
        [31.0, 42.0, 12.0, -3.0],
        [4.0, 1.5, 77.0, 5.0],
        [1.5, 2.5, 3.5, 3.0],
        [0.5, -0.5, 7.0, 8.0],
        [0.0; 4],
    ];
    assert_eq!(results, expected.concat());

    // The other entry point asks for nothing that only the first one uses; its texture is both given and kept.
    npy::write_u32(&folder.join("marks.npy"), &[2, 2], &[1, 20_000_001, 3, 4]);
    succeeds(
        folder,
        &[
            "run",
            "t/mixed",
            "--shaders",
            "own",
            "--entry",
            "mark",
            "--over",
            "2,2",
            "--set",
            "parameters.shift=5",
            "--in",
            "marks=marks.npy",
            "--out",
            "marks=marked.npy",
        ],
    );
    let (shape, marked) = npy::read_u32(&folder.join("marked.npy"));
    assert_eq!(shape, [2, 2]);
    assert_eq!(marked, [7, 40_000_008, 11, 14]);

    let listed = succeeds(folder, &["list", "--shaders", "own", "t"]);
    assert!(listed.out.contains("t/mixed   Everything that can be bound."), "{}", listed.out);
}

/// Input for the refusals: fine files and broken ones.
fn stage() -> TempDir {
    let at = folder();
    let folder = at.path();
    own_shaders(folder);
    npy::write_f32(&folder.join("hdr.npy"), &[2, 3, 3], &[0.5; 18]);
    npy::write_f32(&folder.join("flat.npy"), &[18], &[0.5; 18]);
    npy::write_f32(&folder.join("five.npy"), &[2, 3, 5], &[0.5; 30]);
    npy::write_f32(&folder.join("none.npy"), &[0, 3], &[]);
    npy::write_f32(&folder.join("huge.npy"), &[1, 2], &[1.0, 70000.0]);
    npy::write_f32(&folder.join("camera.npy"), &[40], &camera());
    npy::write_f32(&folder.join("wide.npy"), &[1, 8193], &[0.5; 8193]);
    npy::write_u32(&folder.join("v.npy"), &[8], &[1; 8]);
    npy::write_u32(&folder.join("ids.npy"), &[2, 3], &[1; 6]);
    npy::write_u8(&folder.join("bytes.npy"), &[8], &[1; 8]);
    std::fs::write(folder.join("empty.npy"), "").unwrap();
    std::fs::write(folder.join("garbage.npy"), "this is no array at all, but long enough for one").unwrap();
    let whole = std::fs::read(folder.join("hdr.npy")).unwrap();
    std::fs::write(folder.join("cut.npy"), &whole[..whole.len() - 5]).unwrap();
    std::fs::write(folder.join("old.npy"), "old").unwrap();
    std::fs::create_dir(folder.join("folder.npy")).unwrap();
    at
}

/// `tonemap` with one thing different: the arguments that replace those with the same flag and name.
fn tonemap<'a>(changed: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["run", "core/tonemap", "--set", "parameters.exposure=1"];
    if !changed.contains(&"--in") {
        arguments.extend(["--in", "radiance=hdr.npy"]);
    }
    if !changed.contains(&"--out") {
        arguments.extend(["--out", "picture=old.npy:2,3"]);
    }
    if !changed.iter().any(|argument| ["--over", "--dispatch"].contains(argument)) {
        arguments.extend(["--over", "3,2"]);
    }
    arguments.extend(changed);
    arguments
}

#[test]
fn names_that_are_not_there_are_told_with_those_that_are() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| refuses(at.path(), arguments, 2, parts);
    bad(&["run", "core/nope", "--dispatch", "1"], &["core/nope", "core/tonemap", "scattering/filter"]);
    bad(&["run", "core/tonemap:nope"], &["core/tonemap", "nope", "default"]);
    bad(&["run", "tonemap"], &["`tonemap`", "SYSTEM/PASS"]);
    bad(&["run"], &["SYSTEM/PASS"]);
    bad(&tonemap(&["--nope", "1"]), &["--nope"]);
    bad(
        &tonemap(&["--in", "radianc=hdr.npy"]),
        &["--in radianc=hdr.npy", "`radianc`", "`radiance` (2d texture of float)"],
    );
    bad(
        &tonemap(&["--out", "pictur=x.npy:2,3"]),
        &["--out pictur=x.npy", "`picture` (2d storage texture rgba8unorm)"],
    );
    bad(&tonemap(&["--out", "radiance=x.npy:2,3"]), &["--out radiance=x.npy", "is not written", "`picture`"]);
    bad(
        &tonemap(&["--set", "parameters.exposur=1"]),
        &["--set parameters.exposur=1", "exposure (f32), dither (f32)"],
    );
    bad(&tonemap(&["--set", "parameters.exposure.x=1"]), &["f32 is no struct"]);
    bad(&tonemap(&["--set", "parameters=1"]), &["--set parameters=1", "is a struct", "exposure (f32)"]);
    bad(&tonemap(&["--set", "param.exposure=1"]), &["`param`", "parameters (TonemapParameters)"]);
    bad(&tonemap(&["--set", "radiance.x=1"]), &["`radiance`", "is no uniform", "parameters"]);
    bad(&tonemap(&["--entry", "nope"]), &["--entry", "`nope`", "tonemap (compute)"]);
    bad(&tonemap(&["--vertex", "nope"]), &["--vertex", "`nope`", "compute"]);
    bad(&tonemap(&["--define", "NOPE=1"]), &["--define", "`NOPE`", "none"]);
    bad(
        &["run", "scattering/filter", "--define", "BASE=8"],
        &["--define", "`BASE`", "BASES, BASES_PER_THREAD, COLORS"],
    );
    bad(
        &["run", "core/scan", "--dispatch", "1"],
        &["--entry", "scan_blocks (compute), add_offsets (compute)"],
    );
    bad(
        &[
            "run",
            "t/mixed",
            "--shaders",
            "own",
            "--entry",
            "gather",
            "--dispatch",
            "1",
            "--set",
            "Parameters.shift=1",
        ],
        &["several uniforms are a Parameters", "parameters", "again"],
    );
    bad(
        &["run", "t/mixed", "--shaders", "own", "--entry", "mark", "--dispatch", "1", "--in", "ids=ids.npy"],
        &["t/mixed (mark)", "`ids`", "`marks`"],
    );
}

#[test]
fn numbers_that_cannot_be_meant_are_told() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| refuses(at.path(), arguments, 2, parts);
    for value in ["nan", "inf", "-inf", "1e99", "abc", "1;2"] {
        let set = format!("parameters.exposure={value}");
        bad(&tonemap(&["--set", &set]), &[&set, "finite number"]);
    }
    bad(&tonemap(&["--set", "parameters.exposure=1,2"]), &["parameters.exposure=1,2", "takes 1"]);
    bad(&tonemap(&["--set", "parameters.exposure="]), &["parameters.exposure="]);
    for value in ["-1", "1.5", "4294967296"] {
        let set = format!("parameters.count={value}");
        bad(
            &[
                "run",
                "core/scan",
                "--entry",
                "scan_blocks",
                "--dispatch",
                "1",
                "--in",
                "values=v.npy",
                "--out",
                "block_sums=x.npy:1",
                "--set",
                &set,
            ],
            &[&set, "whole number"],
        );
    }
    bad(&tonemap(&["--define", "BASES=1.5"]), &["BASES=1.5"]);
    for value in ["0", "1,0", "1,2,3,4", "x", "1.5"] {
        bad(&tonemap(&["--dispatch", value]), &["--dispatch", value]);
        bad(&tonemap(&["--over", value]), &["--over", value]);
    }
    bad(&tonemap(&["--dispatch", "65536"]), &["--dispatch", "65536", "65535"]);
    bad(&tonemap(&["--over", "1,600000"]), &["--over", "1,600000", "75000", "65535"]);
    bad(&tonemap(&["--over", "1", "--dispatch", "1"]), &["--over", "--dispatch"]);
    bad(
        &["run", "core/tonemap", "--in", "radiance=hdr.npy", "--out", "picture=x.npy:2,3"],
        &["--dispatch", "--over"],
    );
    for shape in ["0,3", "2", "2,3,4", "a,b", "-1,3", ""] {
        bad(&tonemap(&["--out", &format!("picture=x.npy:{shape}")]), &["picture=x.npy"]);
    }
    bad(&tonemap(&["--out", "picture=x.npy:2,3:u32"]), &["picture=x.npy", "u32"]);
    bad(&tonemap(&["--out", "picture=x.npy:2,3:f64"]), &["f64", "f32, u32 or i32"]);
    bad(&tonemap(&["--out", "picture=x.png:2,3"]), &["picture=x.png", ".npy"]);
    bad(&tonemap(&["--size", "3x2"]), &["--size 3x2"]);
    bad(&tonemap(&["--size", "0x2"]), &["--size", "0x2"]);
}

#[test]
fn what_is_missing_or_given_twice_is_told() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| refuses(at.path(), arguments, 2, parts);
    bad(
        &["run", "core/tonemap", "--over", "3,2"],
        &["--in radiance=FILE.npy", "--out picture=FILE.npy:HEIGHT,WIDTH", "rgba8unorm"],
    );
    bad(&tonemap(&["--out", "picture=x.npy"]), &["--out picture=x.npy", "HEIGHT,WIDTH"]);
    bad(
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=v.npy",
            "--out",
            "block_sums=x.npy",
        ],
        &["--out block_sums=x.npy", "COUNT"],
    );
    bad(
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=v.npy",
            "--in",
            "block_sums=v.npy",
        ],
        &["--out", "values", "block_sums"],
    );
    bad(&tonemap(&["--in", "radiance=hdr.npy", "--in", "radiance=hdr.npy"]), &["`radiance` is given twice"]);
    bad(
        &tonemap(&["--out", "picture=x.npy:2,3", "--out", "picture=y.npy:2,3"]),
        &["`picture` is given twice"],
    );
    bad(
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=v.npy",
            "--out",
            "values=x.npy",
            "--out",
            "block_sums=x.npy:1",
        ],
        &["--out block_sums=x.npy", "same file"],
    );
    bad(
        &[
            "run",
            "scattering/evaluate",
            "--entry",
            "evaluate",
            "--dispatch",
            "1",
            "--in",
            "bases_sampler=hdr.npy",
        ],
        &["bases_sampler", "sampler"],
    );
    bad(
        &[
            "run",
            "t/depths",
            "--shaders",
            "own",
            "--entry",
            "depth_main",
            "--dispatch",
            "1",
            "--in",
            "depths=hdr.npy",
            "--out",
            "results=x.npy:1",
        ],
        &["--in depths=hdr.npy", "depth texture"],
    );
    bad(
        &[
            "run",
            "t/depths",
            "--shaders",
            "own",
            "--entry",
            "depth_main",
            "--dispatch",
            "1",
            "--out",
            "results=x.npy:1",
        ],
        &["`depths` (2d texture of depth)", "no array can fill"],
    );
}

#[test]
fn full_screen_passes_that_cannot_be_drawn_are_told() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| {
        let mut all = vec!["run", "core/raster", "--in", "camera=camera.npy"];
        all.extend(arguments);
        refuses(at.path(), &all, 2, parts);
    };
    let draw = ["--entry", "fragment_background", "--out", "color=x.npy"];
    let with = |more: &[&'static str]| [&draw, more].concat();
    bad(&with(&[]), &["--size", "fragment_background"]);
    bad(&with(&["--size", "8x8", "--dispatch", "1"]), &["--dispatch", "fragment"]);
    bad(&with(&["--size", "8x8", "--over", "1"]), &["--over", "fragment"]);
    bad(&with(&["--size", "10000x10"]), &["--size", "10000x10", "8192"]);
    bad(&with(&["--size", "8x8", "--vertex", "nope"]), &["--vertex", "`nope`", "vertex_background (vertex)"]);
    bad(
        &with(&["--size", "8x8", "--vertex", "vertex_shadow"]),
        &["--vertex", "vertex_shadow", "position: vec3<f32>"],
    );
    bad(&with(&["--size", "8x8", "--out", "picture=y.npy"]), &["picture", "`color`"]);
    bad(&["--entry", "fragment_background", "--size", "8x8"], &["--out color=FILE.npy"]);
    bad(
        &["--entry", "fragment_background", "--size", "8x8", "--out", "color=x.npy:8,9"],
        &["color=x.npy", "8,8"],
    );
    bad(
        &["--entry", "fragment_surface", "--size", "8x8", "--out", "color=x.npy"],
        &["vertex_background does not write", "fragment_surface", "world: vec3<f32>"],
    );
    bad(
        &["--entry", "vertex_background", "--size", "8x8"],
        &["--entry", "vertex_background", "fragment_background"],
    );
    for (entry, part) in [("two", "2 targets"), ("three", "vec3<f32>")] {
        refuses(
            at.path(),
            &[
                "run",
                "t/depths",
                "--shaders",
                "own",
                "--entry",
                entry,
                "--size",
                "8x8",
                "--out",
                "color=x.npy",
            ],
            2,
            &[entry, part],
        );
    }
}

#[test]
fn files_that_do_not_fit_are_told() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| refuses(at.path(), arguments, 1, parts);
    for (file, part) in [
        ("missing.npy", "missing.npy"),
        ("empty.npy", "empty.npy"),
        ("garbage.npy", "garbage.npy"),
        ("cut.npy", "cut.npy"),
        ("folder.npy", "folder.npy"),
        ("flat.npy", "(18); `radiance` takes (height, width)"),
        ("five.npy", "(2, 3, 5)"),
        ("none.npy", "(0, 3)"),
        ("ids.npy", "not u32"),
        ("wide.npy", "8193"),
    ] {
        let input = format!("radiance={file}");
        bad(&tonemap(&["--in", &input]), &["--in radiance", file, part]);
    }
    let scan = |values: &'static str, sums: &'static str| {
        [
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            values,
            "--in",
            sums,
            "--out",
            "values=x.npy",
        ]
    };
    bad(&scan("values=hdr.npy", "block_sums=v.npy"), &["values=hdr.npy", "array<u32>", "not f32"]);
    bad(&scan("values=bytes.npy", "block_sums=v.npy"), &["values=bytes.npy", "not u8"]);
    bad(&scan("values=none.npy", "block_sums=v.npy"), &["values=none.npy"]);
    bad(
        &[
            "run",
            "scattering/filter:average",
            "--dispatch",
            "1",
            "--in",
            "rectified=five.npy",
            "--out",
            "bases=x.npy:8,2,3",
        ],
        &["rectified=five.npy", "(2, 3, 5)"],
    );
    bad(
        &[
            "run",
            "core/raster",
            "--entry",
            "fragment_background",
            "--size",
            "8x8",
            "--in",
            "camera=v.npy",
            "--out",
            "color=x.npy",
        ],
        &["camera=v.npy", "8 numbers", "Camera takes 40"],
    );
    let mixed = |more: &[&'static str]| {
        let mut all = vec![
            "run",
            "t/mixed",
            "--shaders",
            "own",
            "--entry",
            "gather",
            "--dispatch",
            "1",
            "--out",
            "results=x.npy:16",
        ];
        for (name, input) in [
            ("volume", "volume=five.npy"),
            ("image", "image=hdr.npy"),
            ("ids", "ids=ids.npy"),
            ("points", "points=camera.npy"),
        ] {
            let other = more.iter().find(|input| input.split('=').next() == Some(name));
            all.extend(["--in", other.copied().unwrap_or(input)]);
        }
        all
    };
    succeeds(at.path(), &mixed(&[]));
    std::fs::remove_file(at.path().join("x.npy")).unwrap();
    bad(&mixed(&["volume=flat.npy"]), &["volume=flat.npy", "(depth, height, width)"]);
    bad(&mixed(&["image=huge.npy"]), &["image=huge.npy", "70000", "65504"]);
    bad(&mixed(&["ids=hdr.npy"]), &["ids=hdr.npy", "takes u32, not f32"]);
    bad(&mixed(&["points=hdr.npy"]), &["points=hdr.npy", "18 numbers", "multiple of 4"]);
    let marks = ["run", "t/mixed", "--shaders", "own", "--entry", "mark", "--dispatch", "1"];
    refuses(
        at.path(),
        &[&marks[..], &["--in", "marks=ids.npy", "--out", "marks=x.npy:3,2"]].concat(),
        2,
        &["--out marks=x.npy", "--in"],
    );
    bad(
        &[&marks[..], &["--in", "marks=hdr.npy", "--out", "marks=x.npy"]].concat(),
        &["marks=hdr.npy", "3 channels"],
    );
    refuses(
        at.path(),
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=v.npy",
            "--out",
            "values=x.npy:9",
            "--out",
            "block_sums=y.npy:1",
        ],
        2,
        &["--out values=x.npy", "9", "8"],
    );

    bad(&["run", "core/tonemap", "--shaders", "nowhere"], &["--shaders", "nowhere"]);
    bad(&["run", "t/broken", "--shaders", "own", "--dispatch", "1"], &["t/passes/broken.wgsl:4"]);
}

#[test]
fn sizes_over_the_limits_of_the_device_are_told() {
    let at = stage();
    let bad = |arguments: &[&str], parts: &[&str]| refuses(at.path(), arguments, 2, parts);
    bad(&tonemap(&["--out", "picture=x.npy:9000,10"]), &["--out picture=x.npy", "9000", "8192"]);
    bad(
        &[
            "run",
            "core/tonemap",
            "--in",
            "radiance=hdr.npy",
            "--over",
            "1",
            "--size",
            "100000x10",
            "--out",
            "picture=x.npy",
        ],
        &["100000", "8192"],
    );
    bad(
        &[
            "run",
            "scattering/filter:average",
            "--in",
            "rectified=hdr.npy",
            "--over",
            "1",
            "--out",
            "bases=x.npy:257,2,3",
        ],
        &["257 layers", "256"],
    );
    bad(
        &[
            "run",
            "scattering/filter:average_rgba16float",
            "--in",
            "rectified=hdr.npy",
            "--over",
            "1",
            "--out",
            "bases=x.npy:256,1024,1024",
        ],
        &["bases=x.npy", "2147483648 bytes", "268435456"],
    );
    for shape in ["33554433", "65536,513", "4294967295,4294967295,4294967295,4294967295,4294967295"] {
        let output = format!("block_sums=x.npy:{shape}");
        bad(
            &[
                "run",
                "core/scan",
                "--entry",
                "scan_blocks",
                "--dispatch",
                "1",
                "--in",
                "values=v.npy",
                "--out",
                &output,
            ],
            &["--out block_sums=x.npy", "134217728 bytes"],
        );
    }

    // 128 MiB and one word of zeros, without taking the disk.
    let words = (32 << 20) + 1;
    let header = npy::encoded("<u4", &[words], &[]);
    let length = (header.len() + 4 * words) as u64;
    std::fs::write(at.path().join("large.npy"), header).unwrap();
    let file = std::fs::OpenOptions::new().write(true).open(at.path().join("large.npy")).unwrap();
    file.set_len(length).unwrap();
    refuses(
        at.path(),
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=large.npy",
            "--out",
            "block_sums=x.npy:1",
        ],
        1,
        &["--in values=large.npy", "134217728 bytes"],
    );
}

#[test]
fn what_cannot_be_written_is_told_and_nothing_is_lost() {
    let at = stage();
    let bad = |output: &str, part: &str| {
        refuses(at.path(), &tonemap(&["--out", output]), 1, &["--out picture=", part])
    };
    bad("picture=no/such/x.npy:2,3", "no/such");
    bad("picture=old.npy/x.npy:2,3", "old.npy");
    bad("picture=folder.npy:2,3", "folder");
    // One that can be written goes unwritten with one that cannot.
    refuses(
        at.path(),
        &[
            "run",
            "core/scan",
            "--entry",
            "scan_blocks",
            "--dispatch",
            "1",
            "--in",
            "values=v.npy",
            "--out",
            "values=x.npy",
            "--out",
            "block_sums=no/y.npy:1",
        ],
        1,
        &["--out block_sums=no/y.npy"],
    );

    // Success replaces the old file and leaves nothing beside it.
    let before = files(at.path()).len();
    let ended = airlight(at.path(), &tonemap(&[]));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{ended:?}");
    assert_eq!(files(at.path()).len(), before);
    assert_eq!(npy::read_u8(&at.path().join("old.npy")).0, [2, 3, 4]);
}
