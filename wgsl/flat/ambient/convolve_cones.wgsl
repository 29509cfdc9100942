// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: ambient/convolve_cones, permutation default
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
// binding radiance: linear RGB, finite, latitude-longitude as in ambient/environment: rgba32float, with SAMPLED rgba16float with levels, each half the one before.
// binding cones: out, rgba16float, 8 layers of side texels squared, as ambient/cone_light reads them.

// ---- airlight::ambient::environment ----
// summary: Environment maps: directions and solid angles of the texels of a latitude-longitude picture.
// source: the unit sphere; a zone between two elevations has 2 pi times the difference of their sines (Archimedes).

/// Half a turn, radians.
const HALF_TURN: f32 = 3.14159265;

/// The unit vector towards a place of the map, in coordinates 0..1 from its upper left corner.
fn environment_direction(coordinates: vec2<f32>) -> vec3<f32> {
    let right_of_middle = 2.0 * HALF_TURN * (coordinates.x - 0.5);
    let down = HALF_TURN * coordinates.y;
    let level = sin(down);
    return vec3<f32>(level * sin(right_of_middle), cos(down), -level * cos(right_of_middle));
}

/// Difference of the sines of elevation between two heights of the map, 0..1 from the top, `begin` above `end`: over
/// a column of width w (0..1) the solid angle is 2 pi w times this.
fn zone_height(begin: f32, end: f32) -> f32 {
    // The difference of two cosines, without its cancellation.
    return 2.0 * sin(0.5 * HALF_TURN * (begin + end)) * sin(0.5 * HALF_TURN * (end - begin));
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

// ---- ambient/convolve_cones ----

@group(0) @binding(0) var radiance: texture_2d<f32>;
@group(0) @binding(2) var cones: texture_storage_2d_array<rgba16float, write>;

/// The greatest half float.
const MOST_HALF: f32 = 65504.0;

fn store_cone(texel: vec2<u32>, layer: u32, light: vec3<f32>) {
    textureStore(cones, texel, layer, vec4<f32>(min(light, vec3<f32>(MOST_HALF)), 1.0));
}

/// Divisor where a map is so coarse that a cone holds no texel's middle.
const LEAST_WEIGHT: f32 = 1e-20;
/// Cosines of the angles of the narrow four layers: 11.25, 22.5, 33.75 and 45 degrees.
const NARROW_EDGES: vec4<f32> = vec4<f32>(0.98078528, 0.92387953, 0.83146961, 0.70710678);
/// Those of the wide four: 56.25, 67.5, 78.75 and 90 degrees.
const WIDE_EDGES: vec4<f32> = vec4<f32>(0.55557023, 0.38268343, 0.19509032, 0.0);
/// Texels of the map that are read together.
const TILE: u32 = 64u;

/// Unit vector towards each texel, and its solid angle up to a factor that all share.
var<workgroup> tile_directions: array<vec4<f32>, TILE>;
/// Radiance of each, and the square of the tangent of its elevation.
var<workgroup> tile_radiance: array<vec4<f32>, TILE>;

/// Puts texel `index` of the map, row by row, into place `local` of the tile.
fn fetch(index: u32, local: u32) {
    let size = textureDimensions(radiance);
    let texel = vec2<u32>(index % size.x, index / size.x);
    if texel.y >= size.y {
        // Behind the last texel of the map, where that is no multiple of the tile.
        tile_directions[local] = vec4<f32>(0.0);
        tile_radiance[local] = vec4<f32>(0.0);
        return;
    }
    let towards = environment_direction((vec2<f32>(texel) + 0.5) / vec2<f32>(size));
    let rows = f32(size.y);
    let height = zone_height(f32(texel.y) / rows, f32(texel.y + 1u) / rows);
    let tangent_square = towards.y * towards.y / dot(towards.xz, towards.xz);
    tile_directions[local] = vec4<f32>(towards, height * rows);
    tile_radiance[local] = vec4<f32>(textureLoad(radiance, texel, 0).rgb, tangent_square);
}

/// Sums over texels for the four narrow cones and the four wide ones.
struct Sums {
    /// Weights.
    narrow_weight: vec4<f32>,
    /// Weights times red.
    narrow_red: vec4<f32>,
    /// Weights times green.
    narrow_green: vec4<f32>,
    /// Weights times blue.
    narrow_blue: vec4<f32>,
    /// Weights.
    wide_weight: vec4<f32>,
    /// Weights times red.
    wide_red: vec4<f32>,
    /// Weights times green.
    wide_green: vec4<f32>,
    /// Weights times blue.
    wide_blue: vec4<f32>,
}

/// Adds texel `i` of the tile to the cones about `axis`; `sharpness` in texels a radian.
fn gather(sums: ptr<function, Sums>, axis: vec3<f32>, sharpness: f32, i: u32) {
    let towards = tile_directions[i];
    let cosine = dot(axis, towards.xyz);
    if cosine > 0.0 {
        let light = tile_radiance[i];
        // The cosine's change over the texel, up and sideways: its gradient has the sine's length, and the part of it
        // along the row is shortened by the cosine of the elevation.
        let sideways = axis.x * towards.z - axis.z * towards.x;
        let change = 1.0 - cosine * cosine - sideways * sideways * light.w;
        let steepness = sharpness * inverseSqrt(max(change, 1e-6));
        let weight = cosine * towards.w;
        let narrow = weight * saturate((cosine - NARROW_EDGES) * steepness + 0.5);
        let wide = weight * saturate((cosine - WIDE_EDGES) * steepness + 0.5);
        (*sums).narrow_weight += narrow;
        (*sums).narrow_red += light.x * narrow;
        (*sums).narrow_green += light.y * narrow;
        (*sums).narrow_blue += light.z * narrow;
        (*sums).wide_weight += wide;
        (*sums).wide_red += light.x * wide;
        (*sums).wide_green += light.y * wide;
        (*sums).wide_blue += light.z * wide;
    }
}

@compute @workgroup_size(64)
fn convolve_cones(
    @builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32
) {
    let width = textureDimensions(cones).x;
    let texel = vec2<u32>(id.x % width, id.x / width);
    let axis = octahedral_texel_direction(min(texel, vec2<u32>(width - 1u)), width);
    let size = textureDimensions(radiance);
    let sharpness = f32(size.y) / HALF_TURN;
    var sums = Sums();
    let count = size.x * size.y;
    for (var begin = 0u; begin < count; begin += TILE) {
        workgroupBarrier();
        fetch(begin + local, local);
        workgroupBarrier();
        // Four at a time: a software driver ends loops after 65535 turns in all.
        for (var i = 0u; i < TILE; i += 4u) {
            gather(&sums, axis, sharpness, i);
            gather(&sums, axis, sharpness, i + 1u);
            gather(&sums, axis, sharpness, i + 2u);
            gather(&sums, axis, sharpness, i + 3u);
        }
    }
    if texel.y >= width {
        return;
    }
    for (var layer = 0u; layer < 4u; layer++) {
        let narrow = vec3<f32>(sums.narrow_red[layer], sums.narrow_green[layer], sums.narrow_blue[layer]);
        store_cone(texel, layer, narrow / max(sums.narrow_weight[layer], LEAST_WEIGHT));
        let wide = vec3<f32>(sums.wide_red[layer], sums.wide_green[layer], sums.wide_blue[layer]);
        store_cone(texel, layer + 4u, wide / max(sums.wide_weight[layer], LEAST_WEIGHT));
    }
}
