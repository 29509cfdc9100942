// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: transmittance/voxels, permutation power (COEFFICIENTS=8 POWER)
// summary: Builds a transmittance map from a volume: the light ray of each texel is marched and projected.
// source: Gautron et al., "Extinction transmittance maps" (2011), Eq. 1; Delalandre et al. (2011) with FUNCTION.
// note: Steps are of a voxel at most and of equal length from where the ray enters the volume to where it leaves it; the sample in
// note: the middle stands for the whole step, whose projection is exact. Values that are not finite or negative are 0.
// note: Runs of samples among empty bricks are passed over; what is found is the same without them.
// note: BOUNDED marches twice: for the steps that hold anything, then for the projection.
// definition COEFFICIENTS: numbers a texel, four a layer: 4, 8 or 16, of the moments 8; 4 where it is not given.
// definition POWER: six power moments.
// binding light: the directional light of the map.
// binding volume: where the volume lies.
// binding extinction: the volume, any float format; with LINEAR one that filters.
// binding brick_distances: of core/brick_distances, for the volume; or a single 0.
// binding coefficients: out, the layers of the map.

// ---- airlight::core::bricks ----
// summary: Bricks of voxels over a volume, by which a march passes over empty space without a change of what it meets.
// source: Levoy, "Efficient ray tracing of volume data" (1990); distances after Cohen and Sheffer, "Proximity clouds" (1994).

/// Voxels along a brick.
const BRICK: u32 = 8u;
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

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light and its standard shadow map. 192 bytes.
struct Light {
    /// World to the shadow map's clip space; affine for a directional light, unused with an array of shadow maps.
    clip_from_world: mat4x4<f32>,
    /// Its inverse.
    world_from_clip: mat4x4<f32>,
    /// Unit vector TOWARDS a directional light; of a spot, the reverse of the axis along which it shines.
    direction: vec3<f32>,
    /// Depth of an empty texel of the shadow map, farthest from the light: 1 forward, 0 reversed.
    far_depth: f32,
    /// Linear RGB: for a directional light the irradiance at normal incidence; for one at a point its radiant
    /// intensity, the irradiance at a distance of one metre.
    radiance: vec3<f32>,
    /// DIRECTIONAL, SPOT or POINT.
    kind: u32,
    /// Where a spot or point light is, metres.
    position: vec3<f32>,
    /// Radius of a spot or point light, metres, positive: nearer to it the fall-off with distance stops.
    radius: f32,
    /// Cosines of the half angles inside which a spot shines fully, and outside which not at all.
    spot_cosines: vec2<f32>,
    reserved_a: f32,
    reserved_b: f32,
}

/// The point in the world, metres, at a position in texels and a depth 0..1 of a map with the matrix
/// `world_from_clip`. `size`: of the map in texels.
fn point_from_texels(world_from_clip: mat4x4<f32>, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    let ndc = (texels / size) * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    let point = world_from_clip * vec4<f32>(ndc, depth, 1.0);
    return point.xyz / max(point.w, 1e-12);
}

/// The point in the world, metres, at a position in texels and a depth 0..1 of the shadow map.
fn shadow_point(light: Light, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    return point_from_texels(light.world_from_clip, size, texels, depth);
}

// ---- airlight::core::moment_bounds ----
// summary: Six moments of a distribution on -1..1, and the bounds that they give of its share beyond a place.
// source: Algorithm 1 of Peters et al., "Improved moment shadow maps for translucent occluders, soft shadows and single scattering" (2017).

/// Means of the Chebyshev polynomials T_1 to T_6.
struct Moments {
    /// Of degree 1, 2 and 3, -1..1.
    low: vec3<f32>,
    /// Of degree 4, 5 and 6, -1..1.
    high: vec3<f32>,
}

/// T_1, T_2, T_3 at `z`.
fn chebyshev(z: f32) -> vec3<f32> {
    return vec3<f32>(z, 2.0 * z * z - 1.0, z * (4.0 * z * z - 3.0));
}

/// Moments of a single place `z`, -1..1.
fn moments_at(z: f32) -> Moments {
    let low = chebyshev(z);
    let high = vec3<f32>(2.0 * low.y * low.y, 2.0 * low.y * low.z, 2.0 * low.z * low.z);
    return Moments(low, high - vec3<f32>(1.0, low.x, 1.0));
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

// ---- airlight::transmittance::light_space ----
// summary: Places in a transmittance map: texels across the light, and the depth along it.
// source: core/light for the clip space of a directional light.

/// A depth of the light's clip space as a depth of the map or back: 0 near, 1 far.
fn forward_depth(light: Light, clip_depth: f32) -> f32 {
    return select(1.0 - clip_depth, clip_depth, light.far_depth > 0.5);
}

/// The point in the world, metres, at a position in texels and a depth 0..1.
fn map_point(light: Light, size: vec2<f32>, texels: vec2<f32>, depth: f32) -> vec3<f32> {
    return shadow_point(light, size, texels, forward_depth(light, depth));
}

/// The range d of the map, metres: how far apart depths 0 and 1 are.
fn map_range(light: Light) -> f32 {
    return length(light.world_from_clip[2].xyz);
}

// ---- airlight::transmittance::medium ----
// summary: Single scattering of a directional light along a view ray through a medium of varying extinction.
// source: the equation of radiative transfer without multiple scattering; Gautron et al. (2011) for what lights a step.

/// More than any extinction may be, 1/m.
const GREATEST_EXTINCTION: f32 = 1e6;

/// Extinction in 1/m of a value of the volume's texture; 0 for what is not finite or negative.
fn extinction_of_value(value: f32, volume: VolumeSpace) -> f32 {
    return clamp(finite_or(value * volume.value_scale, 0.0), 0.0, GREATEST_EXTINCTION);
}

// ---- airlight::transmittance::transmittance_moments ----
// summary: Transmittance from moments of optical depth along a light ray: six of powers, or two complex trigonometric ones.
// source: Muenstermann, Krumpen, Klein, Peters, "Moment-based order-independent transparency" (PACMCGIT 1(1), 2018).

/// Nodes and weights of Gauss and Legendre on -1..1, exact to degree 7.
const GAUSS_NODES: vec2<f32> = vec2<f32>(0.3399810435848563, 0.8611363115940526);
const GAUSS_WEIGHTS: vec2<f32> = vec2<f32>(0.3260725774312731, 0.1739274225687269);

/// The six moments of a stretch of optical depth 1 around `middle`, `half` to both sides, 0..1 over the range.
fn stretch_moments(middle: f32, half: f32) -> Moments {
    var sum = Moments(vec3<f32>(0.0), vec3<f32>(0.0));
    for (var node = 0u; node < 4u; node++) {
        let offset = select(GAUSS_NODES.x, GAUSS_NODES.y, node > 1u) * select(1.0, -1.0, (node & 1u) == 1u);
        let weight = select(GAUSS_WEIGHTS.x, GAUSS_WEIGHTS.y, node > 1u);
        let own = moments_at(clamp(2.0 * (middle + half * offset) - 1.0, -1.0, 1.0));
        sum = Moments(sum.low + weight * own.low, sum.high + weight * own.high);
    }
    return sum;
}

/// What a stretch of optical depth 1 adds to one of two layers: 1, moments 1 to 3; moments 4 to 6.
fn power_layer(middle: f32, half: f32, layer: u32) -> vec4<f32> {
    let moments = stretch_moments(middle, half);
    return select(vec4<f32>(1.0, moments.low), vec4<f32>(moments.high, 0.0), layer == 1u);
}

// ---- airlight::transmittance::map_form ----
// summary: Callback: what a stretch of extinction adds to the layers of a map, by whichever form the pass was built for.
// source: the algorithm modules of the forms.

/// Layers of a map.
const LAYERS: u32 = u32(8) / 4u;

/// What a stretch of optical depth 1 adds to each layer.
struct Contribution {
    /// Layer by layer.
    layers: array<vec4<f32>, LAYERS>,
}

/// What the stretch around `middle`, `half` to both sides, 0..1 over the range or the interval, adds.
fn contribution(middle: f32, half: f32) -> Contribution {
    var all: Contribution;
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] = power_layer(middle, half, layer);
    }
    return all;
}

/// Even stretches one after the other along a light ray, each as long as the way from one middle to the next. Those of a series
/// share all but the basis at their middles, which a rotation leads on: no sine a stretch.
struct Walk {
    /// Middle of the stretch, 0..1.
    middle: f32,
    /// From one middle to the next.
    step: f32,
}

/// A walk that begins at the stretch around `middle`; stretches are `step` long, 0..1. Rounding grows by about 1e-7 a stretch:
/// begin anew every 16 of them or so.
fn walk_from(middle: f32, step: f32) -> Walk {
    return Walk(middle, step);
}

/// At the next stretch.
fn walk_on(walk: Walk) -> Walk {
    return Walk(walk.middle + walk.step, walk.step);
}

/// `sums`, and `weight` times what the stretch adds, but for the factor of `walk_sum`.
fn walk_add(sums: Contribution, walk: Walk, weight: f32) -> Contribution {
    var all = sums;
    let own = contribution(walk.middle, 0.5 * walk.step);
    for (var layer = 0u; layer < LAYERS; layer++) {
        all.layers[layer] += weight * own.layers[layer];
    }
    return all;
}

/// The sums of `walk_add` over stretches that are `step` long, as sums of `contribution`.
fn walk_sum(sums: Contribution, step: f32) -> Contribution {
    return sums;
}

// ---- transmittance/voxels ----

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<uniform> volume: VolumeSpace;
@group(0) @binding(2) var extinction: texture_3d<f32>;
@group(0) @binding(4) var coefficients: texture_storage_2d_array<rgba32float, write>;
const GREATEST: f32 = 1e30;

@group(0) @binding(6) var brick_distances: texture_3d<u32>;

/// Extinction at a place in unit space, 1/m.
fn extinction_at(unit: vec3<f32>) -> f32 {
    let value = textureLoad(extinction, voxel_at(unit, textureDimensions(extinction)), 0).x;
    return extinction_of_value(value, volume);
}

@compute @workgroup_size(16, 8)
fn march_voxels(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(coefficients);
    if any(id.xy >= size) {
        return;
    }
    let texels = vec2<f32>(id.xy) + 0.5;
    let near = map_point(light, vec2<f32>(size), texels, 0.0);
    let far = map_point(light, vec2<f32>(size), texels, 1.0);
    let origin = (volume.unit_from_world * vec4<f32>(near, 1.0)).xyz;
    let along = (volume.unit_from_world * vec4<f32>(far - near, 0.0)).xyz;
    let part = segment_in_box(origin, along);
    let range = map_range(light);
    let steps = march_steps((part.y - part.x) * range, volume);
    let depth_step = (part.y - part.x) / f32(steps);
    let metres = depth_step * range;
    let step = depth_step * along;

    let scale = 1.0;
    let near_side = 0.0;
    let walk_step = depth_step * scale;
    var sums: Contribution;
    for (var layer = 0u; layer < LAYERS; layer++) {
        sums.layers[layer] = vec4<f32>(0.0);
    }
    for (var next = 0u; next < steps;) {
        let at = origin + (part.x + (f32(next) + 0.5) * depth_step) * along;
        let run = run_of_samples(brick_distances, textureDimensions(extinction), at, step, next, steps);
        // A run among occupied bricks is at most some 14 voxels long: what a walk may be.
        var walk = walk_from((part.x + (f32(run.begin) + 0.5) * depth_step - near_side) * scale, walk_step);
        for (var i = run.begin; i < run.end; i++) {
            let depth = part.x + (f32(i) + 0.5) * depth_step;
            let optical_depth = extinction_at(origin + depth * along) * metres;
            let weight = optical_depth;
            sums = walk_add(sums, walk, weight);
            walk = walk_on(walk);
        }
        next = run.end;
    }
    sums = walk_sum(sums, walk_step);
    for (var layer = 0u; layer < LAYERS; layer++) {
        textureStore(coefficients, id.xy, layer, clamp(sums.layers[layer], vec4<f32>(-GREATEST), vec4<f32>(GREATEST)));
    }
}
