// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/find_splats, permutation default
// summary: Finds the voxels of a volume above a threshold, in the order of their numbers.
// source: Zhang and Crawfis, 4.1, step 3: only relevant voxels are projected.
// note: Dispatch mark_voxels, scan `marks` with `core/scan`, dispatch gather_splats; both over `count` voxels and one more, in
// note: rows of 65535 groups. Values that are not finite are below every threshold.
// binding volume: the volume.
// binding batch: which of its voxels are looked at.
// binding values: the volume, any float format.
// binding marks: out of mark_voxels, 1 for each voxel that is drawn and a 0 at the end; for gather_splats their exclusive prefix sums.
// binding splats: out of gather_splats, the splats.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// ---- airlight::splatting::splat ----
// summary: Splats: voxels above a threshold, where they lie, and the quad that covers one in a picture.
// source: Zhang and Crawfis, 2.1 and 4.1, steps 3 and 12 to 14.

/// A voxel that is drawn. 8 bytes.
struct Splat {
    /// Number of the voxel, x fastest, then y.
    voxel: u32,
    /// Its value.
    value: f32,
}

/// A volume of splats. 144 bytes.
struct SplatVolume {
    /// Voxel space to the world, metres; affine.
    world_from_voxel: mat4x4<f32>,
    /// Its inverse.
    voxel_from_world: mat4x4<f32>,
    /// Voxels along x, y and z.
    size: vec3<u32>,
    /// Voxels of no greater value are left out.
    threshold: f32,
}

/// Voxels or splats that are looked at together. 16 bytes.
struct SplatBatch {
    /// Number of the first.
    first: u32,
    /// How many.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
}

// ---- splatting/find_splats ----

@group(0) @binding(0) var<uniform> volume: SplatVolume;
@group(0) @binding(1) var<uniform> batch: SplatBatch;
@group(0) @binding(2) var values: texture_3d<f32>;
@group(0) @binding(3) var<storage, read_write> marks: array<u32>;
@group(0) @binding(4) var<storage, read_write> splats: array<Splat>;

/// The splat of a voxel, of value 0 where it is none; `index`: within the batch.
fn splat_of(index: u32) -> Splat {
    let voxel = batch.first + index;
    let width = max(volume.size.x, 1u);
    let height = max(volume.size.y, 1u);
    let row = voxel / width;
    let value = textureLoad(values, vec3<u32>(voxel - row * width, row % height, row / height), 0).x;
    let drawn = index < batch.count && is_finite(value) && value > volume.threshold;
    return Splat(voxel, select(0.0, clamp(value, 0.0, 65504.0), drawn));
}

@compute @workgroup_size(256)
fn mark_voxels(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.y * groups.x * 256u + id.x;
    if index < min(batch.count + 1u, arrayLength(&marks)) {
        marks[index] = select(0u, 1u, splat_of(index).value > 0.0);
    }
}

@compute @workgroup_size(256)
fn gather_splats(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.y * groups.x * 256u + id.x;
    if index < min(batch.count, arrayLength(&marks) - 1u) {
        let place = marks[index];
        if marks[index + 1u] != place && place < arrayLength(&splats) {
            splats[place] = splat_of(index);
        }
    }
}
