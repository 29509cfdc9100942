// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Finds the voxels of a volume above a threshold, in the order of their numbers.
// source: Zhang and Crawfis, 4.1, step 3: only relevant voxels are projected.
// note: Dispatch mark_voxels, scan `marks` with `core/scan`, dispatch gather_splats; both over `count` voxels and one more, in
// note: rows of 65535 groups. Values that are not finite are below every threshold.
// binding volume: the volume.
// binding batch: which of its voxels are looked at.
// binding values: the volume, any float format.
// binding marks: out of mark_voxels, 1 for each voxel that is drawn and a 0 at the end; for gather_splats their exclusive prefix sums.
// binding splats: out of gather_splats, the splats.

#import airlight::core::finite::is_finite
#import airlight::splatting::splat::{Splat, SplatVolume, SplatBatch}

@group(#{GROUP}) @binding(0) var<uniform> volume: SplatVolume;
@group(#{GROUP}) @binding(1) var<uniform> batch: SplatBatch;
@group(#{GROUP}) @binding(2) var values: texture_3d<f32>;
@group(#{GROUP}) @binding(3) var<storage, read_write> marks: array<u32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> splats: array<Splat>;

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
