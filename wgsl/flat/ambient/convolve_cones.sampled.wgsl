// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/convolve_cones, permutation sampled (SAMPLED)
// summary: An environment map convolved with cones of eight angles, for each texel of octahedral maps.
// source: O. Klehm, thesis, Section 3.3.3, Eq. 3.9; its t is wrong as printed, 1 / (1 - cos(angle)): see ambient/cone_light.
// note: L_c is t / pi times the integral of L cos over the cap. With t = 1 / sin^2(angle) that is the mean of L under the weight cos,
// note: and it is computed as one: the sum of weights stands for pi sin^2(angle), so that constant light is exact at any resolution.
// note: The exact form sums over all texels of the map; a texel that the edge of a cone crosses counts by the part inside,
// note: along the gradient of the cosine: the map should have 64 rows or more, and at most
// note: 512x256 texels for software drivers that end loops. An invocation is a texel of the cones' maps, x alone, `side^2` of them.
// note: With SAMPLED the rings between neighbouring angles are sampled instead, RING_DIRECTIONS each, evenly in solid angle times
// note: cosine, at the level of the chain whose texels are as large as a direction's share; cones add up their rings. For light
// note: that moves: edges of cones are as soft as those texels, and rows near the poles less filtered than the others.
// definition SAMPLED: rings are sampled in a chain of levels.
// binding radiance: linear RGB, finite, latitude-longitude as in ambient/environment: rgba32float, with SAMPLED rgba16float with levels, each half the one before.
// binding radiance_sampler: linear within and between levels, repeating in u; with SAMPLED only.
// binding cones: out, rgba16float, 8 layers of side texels squared, as ambient/cone_light reads them.

// ---- airlight::ambient::environment ----
// summary: Environment maps: directions and solid angles of the texels of a latitude-longitude picture.
// source: the unit sphere; a zone between two elevations has 2 pi times the difference of their sines (Archimedes).

/// Half a turn, radians.
const HALF_TURN: f32 = 3.14159265;

/// Coordinates 0..1 in the map of a unit vector; to be read with a sampler that repeats in the first.
fn environment_coordinates(direction: vec3<f32>) -> vec2<f32> {
    // The angle of the null vector is undefined: at the poles any column will do.
    let level = select(direction.xz, vec2<f32>(0.0, -1.0), all(direction.xz == vec2<f32>(0.0)));
    let right_of_middle = atan2(level.x, -level.y);
    let down = atan2(max(length(direction.xz), 1e-20), direction.y);
    return vec2<f32>(0.5 + 0.5 * right_of_middle / HALF_TURN, down / HALF_TURN);
}

// ---- airlight::ambient::octahedral ----
// summary: Directions as texels of a square: an octahedron unfolded about the y axis, whose edges are middles of texels.
// source: Engelhardt and Dachsbacher, "Octahedron environment maps" (2008).

/// -1 for negative numbers, else 1.
fn signs(x: vec2<f32>) -> vec2<f32> {
    return select(vec2<f32>(-1.0), vec2<f32>(1.0), x >= vec2<f32>(0.0));
}

/// The unit vector of a place in the square, -1..1.
fn octahedral_direction(place: vec2<f32>) -> vec3<f32> {
    let height = 1.0 - abs(place.x) - abs(place.y);
    let below = (1.0 - abs(place.yx)) * signs(place);
    let flat_part = select(below, place, height >= 0.0);
    return normalize(vec3<f32>(flat_part.x, height, flat_part.y));
}

/// The unit vector of the middle of texel 0..side-1 of the map.
fn octahedral_texel_direction(texel: vec2<u32>, side: u32) -> vec3<f32> {
    return octahedral_direction(2.0 * vec2<f32>(texel) / f32(side - 1u) - 1.0);
}

// ---- airlight::ambient::cone_light ----
// summary: Light from far away that comes in through a cone, looked up by the cone's direction and angle.
// source: O. Klehm, thesis, Section 3.3.3 and 3.3.4, Eq. 3.7 to 3.10.

/// Number of angles.
const CONE_LAYERS: u32 = 8u;
/// From one layer's angle to the next: 11.25 degrees in radians.
const CONE_ANGLE_STEP: f32 = 0.19634954;

/// The half angle of a layer's cone, radians.
fn cone_layer_angle(layer: u32) -> f32 {
    return CONE_ANGLE_STEP * f32(layer + 1u);
}

// ---- ambient/convolve_cones ----

@group(0) @binding(0) var radiance: texture_2d<f32>;
@group(0) @binding(1) var radiance_sampler: sampler;
@group(0) @binding(2) var cones: texture_storage_2d_array<rgba16float, write>;

/// The greatest half float.
const MOST_HALF: f32 = 65504.0;

fn store_cone(texel: vec2<u32>, layer: u32, light: vec3<f32>) {
    textureStore(cones, texel, layer, vec4<f32>(min(light, vec3<f32>(MOST_HALF)), 1.0));
}

/// Directions in a ring.
const RING_DIRECTIONS: u32 = 32u;
/// From one direction's azimuth to the next: the golden angle, radians.
const GOLDEN_ANGLE: f32 = 2.3999632;

@compute @workgroup_size(64)
fn convolve_cones(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = textureDimensions(cones).x;
    let texel = vec2<u32>(id.x % width, id.x / width);
    if texel.y >= width {
        return;
    }
    let axis = octahedral_texel_direction(texel, width);
    // Level steps of the map that all directions of a ring share.
    let texel_side = HALF_TURN / f32(textureDimensions(radiance).y);
    let other = select(vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(1.0, 0.0, 0.0), abs(axis.y) > 0.9);
    let right = normalize(cross(other, axis));
    let up = cross(axis, right);
    var sum = vec3<f32>(0.0);
    var inner = 0.0;
    for (var layer = 0u; layer < CONE_LAYERS; layer++) {
        let angle = cone_layer_angle(layer);
        let outer = sin(angle) * sin(angle);
        let solid_angle = 2.0 * HALF_TURN * (cos(angle - cone_layer_angle(0u)) - cos(angle));
        let level = max(0.0, log2(sqrt(solid_angle / f32(RING_DIRECTIONS)) / texel_side));
        var ring = vec3<f32>(0.0);
        for (var i = 0u; i < RING_DIRECTIONS; i++) {
            // Even in the square of the sine, which is what the cosine's weight asks for.
            let square = mix(inner, outer, (f32(i) + 0.5) / f32(RING_DIRECTIONS));
            let around = GOLDEN_ANGLE * f32(layer * RING_DIRECTIONS + i);
            let across = sqrt(square) * (cos(around) * right + sin(around) * up);
            let direction = across + sqrt(1.0 - square) * axis;
            ring += textureSampleLevel(radiance, radiance_sampler, environment_coordinates(direction), level).rgb;
        }
        sum += (outer - inner) / f32(RING_DIRECTIONS) * ring;
        inner = outer;
        store_cone(texel, layer, sum / outer);
    }
}
