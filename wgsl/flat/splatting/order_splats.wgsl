// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/order_splats, permutation default
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

// ---- airlight::splatting::footprint ----
// summary: What a ray passes of a splat's kernel between two places, a section of its footprint.
// source: Zhang and Crawfis, 2.1 and 4.1; Mueller et al., "Splatting without the blur" (1999).

/// The kernel of all splats. 16 bytes.
struct Kernel {
    /// Standard deviation of the Gaussian, voxels.
    sigma: f32,
    /// Where the kernel ends, voxels; at most 3.5 sigma.
    radius: f32,
    /// Factor on sections, so that the kernel's integral is 1.
    scale: f32,
    /// The Gaussian at the radius.
    edge: f32,
}

// ---- airlight::splatting::sheets ----
// summary: Sheets: slabs of equal thickness one behind the other along the half-way vector between eye and light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 4.1, Fig. 5.

/// All sheets of a picture. 32 bytes.
struct Sheets {
    /// Unit normal in the world, from the side of the light on.
    normal: vec3<f32>,
    /// Where the first sheet begins: dot(normal, point), metres.
    first: f32,
    /// Of every sheet, metres, positive.
    thickness: f32,
    /// How many there are.
    count: u32,
    /// Sheets that one splat reaches at most.
    span: u32,
    /// 1 where the sheet nearest to the light is nearest to the eye as well, 0 where it is the farthest.
    front_to_back: u32,
}

/// Where a point lies along the normal, metres from the world's origin.
fn height_of(sheets: Sheets, point: vec3<f32>) -> f32 {
    return dot(sheets.normal, point);
}

/// The sheet in which a height lies; of what lies outside the nearest.
fn sheet_at(sheets: Sheets, height: f32) -> u32 {
    let last = f32(max(sheets.count, 1u) - 1u);
    return u32(clamp(floor((height - sheets.first) / sheets.thickness), 0.0, last));
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

/// Where voxel `index` lies in voxel space.
fn voxel_place(volume: SplatVolume, index: u32) -> vec3<f32> {
    let width = max(volume.size.x, 1u);
    let height = max(volume.size.y, 1u);
    let row = index / width;
    return vec3<f32>(f32(index - row * width), f32(row % height), f32(row / height));
}

/// The linear part of an affine matrix.
fn linear_part(matrix: mat4x4<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(matrix[0].xyz, matrix[1].xyz, matrix[2].xyz);
}

/// How far a splat of `radius` voxels reaches along a unit vector of the world, metres.
fn reach_along(volume: SplatVolume, direction: vec3<f32>, radius: f32) -> f32 {
    return radius * length(direction * linear_part(volume.world_from_voxel));
}

// ---- splatting/order_splats ----

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

@group(0) @binding(0) var<uniform> volume: SplatVolume;
@group(0) @binding(1) var<uniform> sheets: Sheets;
@group(0) @binding(2) var<uniform> kernel: Kernel;
@group(0) @binding(9) var<uniform> batch: SplatBatch;
@group(0) @binding(3) var<storage, read> splats: array<Splat>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> order: array<u32>;
@group(0) @binding(6) var<storage, read_write> ranges: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> draws: array<Draw>;
@group(0) @binding(8) var<storage, read_write> dispatches: array<array<vec4<u32>, 2>>;
@group(0) @binding(10) var<uniform> targets: SheetTargets;

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
