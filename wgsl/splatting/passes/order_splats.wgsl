// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: The first sheet that each splat reaches, and after the sort by it where the splats of each sheet lie.
// source: Zhang and Crawfis, 4.1, step 4: bucket sort along the half-way vector.
// note: Dispatch first_sheets over the splats, in rows of 65535 groups, sort `keys` and `order` with `core/sort`, dispatch
// note: sheet_ranges over the sheets. A splat reaches `span` sheets at most, so that those of a sheet are one stretch of the order.
// binding volume: the volume.
// binding sheets: the sheets.
// binding kernel: the kernel.
// binding batch: how many splats there are.
// binding splats: the splats.
// binding keys: out of first_sheets, the first sheet of each splat; for sheet_ranges sorted.
// binding order: out of first_sheets, the number of each splat, to be sorted along.
// binding ranges: out of sheet_ranges, of each sheet the first place in the order and how many there are.
// binding draws: out of sheet_ranges, of each sheet the arguments of an indirect draw of its splats.
// binding targets: groups of the passes over the picture and over the shadow buffer.
// binding dispatches: out of sheet_ranges, of each sheet that has splats the arguments of an indirect dispatch over the picture, then
// binding dispatches: of one over the shadow buffer, eight words; zeros before.

#import airlight::splatting::footprint::Kernel
#import airlight::splatting::sheets::{Sheets, height_of, sheet_at}
#import airlight::splatting::splat::{Splat, SplatVolume, SplatBatch, voxel_place, reach_along}

/// Arguments of an indirect draw. 16 bytes.
struct Draw {
    /// Vertices of an instance.
    vertices: u32,
    /// Instances.
    instances: u32,
    /// Number of the first vertex, 0.
    first_vertex: u32,
    /// Number of the first instance, 0: others need a feature.
    first_instance: u32,
}

/// Groups of the passes over pictures. 16 bytes.
struct SheetTargets {
    /// Columns and rows over the picture.
    picture: vec2<u32>,
    /// Columns and rows over the shadow buffer.
    shadow: vec2<u32>,
}

@group(#{GROUP}) @binding(0) var<uniform> volume: SplatVolume;
@group(#{GROUP}) @binding(1) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(2) var<uniform> kernel: Kernel;
@group(#{GROUP}) @binding(9) var<uniform> batch: SplatBatch;
@group(#{GROUP}) @binding(3) var<storage, read> splats: array<Splat>;
@group(#{GROUP}) @binding(4) var<storage, read_write> keys: array<u32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> order: array<u32>;
@group(#{GROUP}) @binding(6) var<storage, read_write> ranges: array<vec2<u32>>;
@group(#{GROUP}) @binding(7) var<storage, read_write> draws: array<Draw>;
@group(#{GROUP}) @binding(8) var<storage, read_write> dispatches: array<array<vec4<u32>, 2>>;
@group(#{GROUP}) @binding(10) var<uniform> targets: SheetTargets;

@compute @workgroup_size(256)
fn first_sheets(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.y * groups.x * 256u + id.x;
    if index >= min(batch.count, min(arrayLength(&splats), min(arrayLength(&keys), arrayLength(&order)))) {
        return;
    }
    let middle = (volume.world_from_voxel * vec4<f32>(voxel_place(volume, splats[index].voxel), 1.0)).xyz;
    let begins = height_of(sheets, middle) - reach_along(volume, sheets.normal, kernel.radius);
    keys[index] = sheet_at(sheets, begins);
    order[index] = index;
}

/// How many sorted keys are below `key`.
fn keys_below(key: u32) -> u32 {
    var low = 0u;
    var high = min(batch.count, arrayLength(&keys));
    while low < high {
        let middle = (low + high) / 2u;
        let below = keys[middle] < key;
        low = select(low, middle + 1u, below);
        high = select(middle, high, below);
    }
    return low;
}

@compute @workgroup_size(64)
fn sheet_ranges(@builtin(global_invocation_id) id: vec3<u32>) {
    let sheet = id.x;
    if sheet >= min(sheets.count, min(arrayLength(&ranges), min(arrayLength(&draws), arrayLength(&dispatches)))) {
        return;
    }
    let first = keys_below(max(sheet + 1u, sheets.span) - sheets.span);
    let count = keys_below(sheet + 1u) - first;
    ranges[sheet] = vec2<u32>(first, count);
    draws[sheet] = Draw(6u, count, 0u, 0u);
    // Batches of splats come one after the other.
    if count > 0u {
        dispatches[sheet][0] = vec4<u32>(targets.picture, 1u, 0u);
        dispatches[sheet][1] = vec4<u32>(targets.shadow, 1u, 0u);
    }
}
