// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::volume
// summary: A volume in the world: its box, voxels and how a ray passes it.
// source: none; the slab test of ray tracing.
// note: Unit space is the box 0..1 of the volume, texture coordinates of the 3D texture; voxel i lies at (i + 0.5) / size.
// equation: slab test: t_axis = (0 − o) / d and (1 − o) / d;  begins = max of the lesser, ends = min of the greater, within 0..1
// equation: steps = ⌈metres / step_length⌉, from 1 to MOST_STEPS
// error: parts of segments within 1e-5; test core/bricks::segments_enter_and_leave_the_box_where_they_do_in_f64.
// error: steps and voxels exact; test core/bricks::steps_and_voxels_are_counted.
// parameter unit: place in unit space, the volume being 0..1.
// parameter metres: from 0 up.
// parameter size: voxels along each axis, from 1 up.

/// A volume in the world. 144 bytes.
struct VolumeSpace {
    /// World, metres, to unit space; affine.
    unit_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_unit: mat4x4<f32>,
    /// What values of the texture are multiplied by: to give extinction in 1/m, say; from 0 up.
    value_scale: f32,
    /// Metres from one sample of a march to the next at most, positive: a voxel.
    step_length: f32,
    reserved_a: f32,
    reserved_b: f32,
}

/// Most samples of a march through one volume.
const MOST_STEPS: f32 = 8192.0;

/// The part of a segment that lies in the box: from and to, 0..1; equal where it misses. `origin`, `along`: of the
/// segment, in unit space.
fn segment_in_box(origin: vec3<f32>, along: vec3<f32>) -> vec2<f32> {
    let still = abs(along) < vec3<f32>(1e-20);
    let safe = select(along, vec3<f32>(1.0), still);
    let a = -origin / safe;
    let b = (vec3<f32>(1.0) - origin) / safe;
    let inside = (origin >= vec3<f32>(0.0)) & (origin <= vec3<f32>(1.0));
    let enters = select(min(a, b), vec3<f32>(0.0), still);
    let leaves = select(max(a, b), select(vec3<f32>(-1.0), vec3<f32>(1.0), inside), still);
    let begins = max(max(enters.x, enters.y), max(enters.z, 0.0));
    return vec2<f32>(begins, max(begins, min(min(leaves.x, leaves.y), min(leaves.z, 1.0))));
}

/// How many samples a march of `metres` takes.
fn march_steps(metres: f32, volume: VolumeSpace) -> u32 {
    // A whole number of voxels stays that number.
    return u32(clamp(ceil(metres / max(volume.step_length, 1e-6) - 1e-3), 1.0, MOST_STEPS));
}

/// The voxel of a volume of `size` voxels at a place in unit space; outside the nearest inside.
fn voxel_at(unit: vec3<f32>, size: vec3<u32>) -> vec3<u32> {
    let last = vec3<f32>(size - vec3<u32>(1u));
    return vec3<u32>(clamp(floor(unit * vec3<f32>(size)), vec3<f32>(0.0), last));
}

/// A length in metres that no segment in the box exceeds.
fn metres_across(volume: VolumeSpace) -> f32 {
    let space = volume.world_from_unit;
    return length(space[0].xyz) + length(space[1].xyz) + length(space[2].xyz);
}
