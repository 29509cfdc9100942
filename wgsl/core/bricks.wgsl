// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::bricks
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).
// note: A brick is 8 x 8 x 8 voxels. Its range of values covers those and one voxel around them, all that trilinear reads inside
// note: of it touch. Its distance is Chebyshev's, in bricks, to the nearest occupied one: 0 where it is occupied itself.
// note: A texture of distances of one texel, 0, skips nothing: for a volume without bricks.
// equation: distance(b) = min over occupied bricks o of max(|bx − ox|, |by − oy|, |bz − oz|)
// equation: samples = 1 + floor(min over axes of (wall − unit) / step − MARGIN), wall: where the bricks that are alike end
// error: exact: no sample among other bricks is passed over;
// error: test core/bricks::runs_of_samples_stay_among_bricks_that_are_alike_and_end_no_sooner_than_they_must.
// error: ranges hold all that a trilinear read touches; test core/bricks::ranges_hold_all_that_a_trilinear_read_in_a_brick_touches.
// parameter unit: place in unit space, the volume being 0..1.
// parameter size: voxels of the volume along each axis, from 1 up.

/// Voxels along a brick.
const BRICK: u32 = 8u;
/// The distance where no brick is occupied.
const NOTHING_NEAR: u32 = 4096u;
/// What samples of a march may lie beyond the place that they are reckoned to be, in samples.
const MARGIN: f32 = 0.01;

/// Bricks along each axis of a volume of `size` voxels.
fn brick_count(size: vec3<u32>) -> vec3<u32> {
    return (size + vec3<u32>(BRICK - 1u)) / BRICK;
}

/// The brick of a place in unit space; outside of the volume the nearest inside.
fn brick_at(unit: vec3<f32>, size: vec3<u32>) -> vec3<u32> {
    let last = vec3<f32>(max(brick_count(size), vec3<u32>(1u)) - 1u);
    return vec3<u32>(clamp(floor(unit * vec3<f32>(size) / f32(BRICK)), vec3<f32>(0.0), last));
}

/// How many samples of a march, with that at `unit`, lie among bricks that are alike: in this one if it is occupied
/// (`distance` 0), else among the empty ones around it. At least 1. `step`: from sample to sample, in unit space.
fn samples_alike(unit: vec3<f32>, step: vec3<f32>, size: vec3<u32>, distance: u32) -> u32 {
    let side = f32(BRICK) / vec3<f32>(size);
    let brick = vec3<f32>(brick_at(unit, size));
    let reach = f32(max(distance, 1u));
    let wall = side * select(brick - (reach - 1.0), brick + reach, step > vec3<f32>(0.0));
    let still = abs(step) < vec3<f32>(1e-12);
    let samples = select((wall - unit) / select(step, vec3<f32>(1.0), still), vec3<f32>(8192.0), still);
    return 1u + u32(clamp(min(min(samples.x, samples.y), samples.z) - MARGIN, 0.0, 8192.0));
}

/// Samples of a march that lie among bricks that are alike.
struct Run {
    /// The first that may hold something; `end` where none does.
    begin: u32,
    /// The first of the next run.
    end: u32,
}

/// The run that begins with sample `i` of `steps`, at `unit`. `distances`: of the bricks of a volume of `size` voxels; `step`:
/// from sample to sample, in unit space.
fn run_of_samples(
    distances: texture_3d<u32>, size: vec3<u32>, unit: vec3<f32>, step: vec3<f32>, i: u32, steps: u32
) -> Run {
    let brick = min(brick_at(unit, size), textureDimensions(distances) - 1u);
    let distance = textureLoad(distances, brick, 0).x;
    let end = min(i + samples_alike(unit, step, size, distance), steps);
    return Run(select(end, i, distance == 0u), end);
}
