// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/solid_bricks, permutation default
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

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// The distance where no brick is occupied.
const NOTHING_NEAR: u32 = 4096u;

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

// ---- airlight::core::transfer_function ----
// summary: What colour and opacity a value of a volume has, by a table.
// source: none; the usual 1D transfer function, dissertation on painterly volume rendering, 4.1.1.

/// Colour, linear RGB, and opacity 0..1 of a value 0..1; beyond that the end of the table. `transfer`: one row, linear RGB and
/// opacity, rgba16float or rgba8unorm; `linear_sampler`: linear, clamped to the edge.
fn classified(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    let width = f32(textureDimensions(transfer).x);
    return textureSampleLevel(transfer, linear_sampler, vec2<f32>((value * (width - 1.0) + 0.5) / width, 0.5), 0.0);
}

// ---- airlight::core::volume ----
// summary: A volume in the world: its box, voxels and how a ray passes it.
// source: none; the slab test of ray tracing.

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

// ---- airlight::painterly::iso_surface ----
// summary: Iso-surface of classified opacity in a volume: crossing, gradient, Phong lighting, flow and occlusion of a surface point.
// source: dissertation on painterly volume rendering, 4.1.1 to 4.1.6, Eq. 4.1 and 4.2.

/// Which surface of a volume is seen, and how it is found. 224 bytes.
struct IsoSurface {
    /// Unit space of the volume to the world, metres, in the previous frame; affine.
    previous_world_from_unit: mat4x4<f32>,
    /// Planes in the world: what lies where dot(xyz, point) + w < 0 is cut away. The first `clip_count` of them.
    clip_planes: array<vec4<f32>, 8>,
    /// Opacity from which on the volume is solid, above 0.
    iso_value: f32,
    /// Added to texels after their scale to give values 0..1.
    value_offset: f32,
    /// Shortest side of a voxel, metres.
    voxel: f32,
    /// View rays end here, metres, positive.
    distance_limit: f32,
    /// How many clip planes there are, 0..8.
    clip_count: u32,
    /// How often the step in which the surface is met is halved before the secant, 0..32.
    refinements: u32,
    /// Number of the frame, for jittered starts.
    frame: u32,
    reserved: u32,
}

/// The value 0..1 of a texel; one that is not finite counts as 0.
fn value_of_texel(texel: f32, scale: f32, offset: f32) -> f32 {
    return clamp(finite_or(texel, 0.0) * scale + offset, 0.0, 1.0);
}

/// What is counted of the table's entries for solid values, lower than the iso-value by more than filters round.
fn solid_threshold(iso_value: f32) -> f32 {
    return iso_value * (1.0 - 1e-5);
}

/// Entries of a table of `entries` that lie between two values 0..1, ends excluded: the first and the one behind the last.
fn entries_between(least: f32, greatest: f32, entries: u32) -> vec2<u32> {
    let last = f32(max(entries, 1u) - 1u);
    let first = clamp(floor(least * last) + 1.0, 0.0, last + 1.0);
    return vec2<u32>(u32(first), u32(clamp(ceil(greatest * last), first, last + 1.0)));
}

// ---- painterly/solid_bricks ----

@group(0) @binding(0) var<uniform> volume: VolumeSpace;
@group(0) @binding(1) var<uniform> surface: IsoSurface;
@group(0) @binding(2) var transfer: texture_2d<f32>;
@group(0) @binding(3) var linear_sampler: sampler;
@group(0) @binding(4) var ranges: texture_3d<f32>;
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var distances: texture_storage_3d<r32uint, write>;

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
