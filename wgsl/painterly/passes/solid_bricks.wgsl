// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: In which bricks of a volume anything may be solid: whether opacity reaches the iso-value between least and greatest value.
// source: none; the greatest of a piecewise straight function over an interval, by counts of its corners that are high enough.
// note: `count_entries` is dispatched once, as one workgroup, then `solid_bricks` over all bricks; both again when the table or the
// note: iso-value changes. Ranges of bricks stay as they are. `core/brick_distances` then spreads what is written.
// binding volume: the scale of texels.
// binding surface: iso-value and offset of texels.
// binding transfer: finite colour and opacity of values 0..1, one row.
// binding linear_sampler: linear, clamped to the edge.
// binding ranges: least and greatest texel of each brick and one voxel around it, of `core/brick_ranges`.
// binding counts: for each entry of the table, how many before it are solid; one more than entries.
// binding distances: out, r32uint, a texel a brick: 0 where anything may be solid, else NOTHING_NEAR.

#import airlight::core::bricks::NOTHING_NEAR
#import airlight::core::volume::VolumeSpace
#import airlight::core::transfer_function::classified
#import airlight::painterly::iso_surface::{
    IsoSurface, value_of_texel, solid_threshold, entries_between
}

@group(#{GROUP}) @binding(0) var<uniform> volume: VolumeSpace;
@group(#{GROUP}) @binding(1) var<uniform> surface: IsoSurface;
@group(#{GROUP}) @binding(2) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(3) var linear_sampler: sampler;
@group(#{GROUP}) @binding(4) var ranges: texture_3d<f32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> counts: array<u32>;
@group(#{GROUP}) @binding(6) var distances: texture_storage_3d<r32uint, write>;

const THREADS: u32 = 64u;
/// More than filters round, in values 0..1.
const ROUNDING: f32 = 1e-5;

var<workgroup> of_chunks: array<u32, 64>;

fn is_solid_entry(entry: u32) -> u32 {
    return u32(textureLoad(transfer, vec2<u32>(entry, 0u), 0).w >= solid_threshold(surface.iso_value));
}

@compute @workgroup_size(64)
fn count_entries(@builtin(local_invocation_index) thread: u32) {
    let entries = textureDimensions(transfer).x;
    let chunk = (entries + THREADS - 1u) / THREADS;
    let begin = min(thread * chunk, entries);
    let end = min(begin + chunk, entries);
    var own = 0u;
    for (var i = begin; i < end; i++) {
        own += is_solid_entry(i);
    }
    of_chunks[thread] = own;
    workgroupBarrier();
    var before = 0u;
    for (var i = 0u; i < thread; i++) {
        before += of_chunks[i];
    }
    for (var i = begin; i < end; i++) {
        counts[min(i, arrayLength(&counts) - 1u)] = before;
        before += is_solid_entry(i);
    }
    if thread == THREADS - 1u {
        counts[min(entries, arrayLength(&counts) - 1u)] = before;
    }
}

@compute @workgroup_size(8, 4, 2)
fn solid_bricks(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= textureDimensions(distances)) {
        return;
    }
    let range = textureLoad(ranges, id, 0).xy;
    let low = value_of_texel(range.x, volume.value_scale, surface.value_offset);
    let high = value_of_texel(range.y, volume.value_scale, surface.value_offset);
    let least = max(min(low, high) - ROUNDING, 0.0);
    let greatest = min(max(low, high) + ROUNDING, 1.0);
    let ends = max(classified(transfer, linear_sampler, least).w, classified(transfer, linear_sampler, greatest).w);
    let between = entries_between(least, greatest, textureDimensions(transfer).x);
    let known = min(between, vec2<u32>(arrayLength(&counts) - 1u));
    let corners = counts[known.y] > counts[known.x];
    let solid = ends >= solid_threshold(surface.iso_value) || corners;
    textureStore(distances, id, vec4<u32>(select(NOTHING_NEAR, 0u, solid)));
}
