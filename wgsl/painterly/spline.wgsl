// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::spline
// summary: A volume filtered by the cubic B-spline: its value, gradient and second derivatives.
// source: Sigg and Hadwiger, "Fast third-order texture filtering", GPU Gems 2 (2005), chapter 20.
// note: Values are those of texels, voxel i lying at (i + 0.5) / size; beyond the outer voxels as there. The spline smooths, by a
// note: sixth of the square of a voxel times the second derivative along each axis, and does not pass through the voxels.
// note: `spline_value` takes 8 trilinear fetches, `spline_gradient` 24. Pairs of weights of second derivatives differ in sign, so that
// note: the whole jet would take 92; by 64 loads without a filter it is cheaper and exact, and each voxel that is not finite is
// note: replaced by itself instead of with all that a filter has mixed it into.
// equation: f(x) = Σ_i v_i β³(x − i);  weights ⅙ ((1−a)³, 4 − 6a² + 3a³, 4 − 6b² + 3b³, a³), b = 1 − a;  slopes and bends are their derivatives
// equation: two weights w₀, w₁ of one sign: (w₀ + w₁) fetch(i + w₁ / (w₀ + w₁))
// error: 64 loads within 1e-5 of the sum over all voxels, fetches within 1/256;
// error: test painterly/curvature_functions::fetches_and_loads_are_the_sum_over_all_voxels.
// parameter weights: of four voxels, the first two and the last two of one sign each.
// parameter unit: place in unit space, the volume being 0..1.
// parameter size: voxels along each axis.
// parameter values: one texel a voxel, a format that filters.
// parameter linear_sampler: linear, clamped to the edge.
// parameter scale, offset: from texels to values 0..1.
// parameter inside: 0..1 voxel.

#import airlight::painterly::iso_surface::value_of_texel

/// Weights of the four voxels around a place, along one axis.
struct SplineAxis {
    /// Of the value; sum 1.
    weights: vec4<f32>,
    /// Of its change a voxel; sum 0.
    slopes: vec4<f32>,
    /// Of the change of that a voxel; sum 0.
    bends: vec4<f32>,
}

/// Four weights of one axis as two fetches between voxels.
struct SplinePair {
    /// Where to fetch, in voxels, voxel i lying at i.
    places: vec2<f32>,
    /// What the fetches are multiplied by.
    shares: vec2<f32>,
}

/// Value and derivatives at a place.
struct SplineJet {
    /// 0..1.
    value: f32,
    /// Change of the value a voxel along each axis.
    gradient: vec3<f32>,
    /// Change of the gradient a voxel along each axis; symmetric.
    hessian: mat3x3<f32>,
}

/// Weights for a place `inside` voxels, 0..1, behind the second of four.
fn spline_axis(inside: f32) -> SplineAxis {
    let a = inside;
    let b = 1.0 - a;
    return SplineAxis(
        vec4<f32>(b * b * b, 4.0 + a * a * (3.0 * a - 6.0), 4.0 + b * b * (3.0 * b - 6.0), a * a * a) / 6.0,
        0.5 * vec4<f32>(-b * b, a * (3.0 * a - 4.0), b * (4.0 - 3.0 * b), a * a),
        vec4<f32>(b, 3.0 * a - 2.0, 1.0 - 3.0 * a, a),
    );
}

/// Two fetches for weights, the first two and the last two of which have one sign each. `second`: number of the second voxel.
fn spline_pair(weights: vec4<f32>, second: f32) -> SplinePair {
    let shares = weights.xz + weights.yw;
    return SplinePair(second + vec2<f32>(-1.0, 1.0) + weights.yw / shares, shares);
}

/// A place in unit space in voxels, voxel i lying at i; at most a voxel outside.
fn spline_place(unit: vec3<f32>, size: vec3<f32>) -> vec3<f32> {
    return clamp(unit * size - 0.5, vec3<f32>(-1.0), size);
}

/// A trilinear fetch. `voxel`: in voxels, voxel i lying at i; `scale`, `offset`: from texels to values.
fn spline_fetch(values: texture_3d<f32>, linear_sampler: sampler, voxel: vec3<f32>, scale: f32, offset: f32) -> f32 {
    let unit = (voxel + 0.5) / vec3<f32>(textureDimensions(values));
    return value_of_texel(textureSampleLevel(values, linear_sampler, unit, 0.0).x, scale, offset);
}

/// The sum over 64 voxels that pairs of the three axes stand for, by 8 fetches.
fn spline_sum(
    values: texture_3d<f32>, linear_sampler: sampler, x: SplinePair, y: SplinePair, z: SplinePair, scale: f32, offset: f32
) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k < 2u; k++) {
        for (var j = 0u; j < 2u; j++) {
            let left = vec3<f32>(x.places.x, y.places[j], z.places[k]);
            let right = vec3<f32>(x.places.y, left.yz);
            let row = x.shares.x * spline_fetch(values, linear_sampler, left, scale, offset)
                + x.shares.y * spline_fetch(values, linear_sampler, right, scale, offset);
            sum += y.shares[j] * z.shares[k] * row;
        }
    }
    return sum;
}

/// Value 0..1 at a place in unit space, by 8 trilinear fetches. `linear_sampler`: clamped to the edge; `scale`, `offset`: from
/// texels to values.
fn spline_value(values: texture_3d<f32>, linear_sampler: sampler, unit: vec3<f32>, scale: f32, offset: f32) -> f32 {
    let place = spline_place(unit, vec3<f32>(textureDimensions(values)));
    let second = floor(place);
    let inside = place - second;
    return spline_sum(
        values, linear_sampler, spline_pair(spline_axis(inside.x).weights, second.x),
        spline_pair(spline_axis(inside.y).weights, second.y), spline_pair(spline_axis(inside.z).weights, second.z), scale, offset
    );
}

/// Change of the value a voxel along each axis at a place in unit space, by 24 trilinear fetches.
fn spline_gradient(values: texture_3d<f32>, linear_sampler: sampler, unit: vec3<f32>, scale: f32, offset: f32) -> vec3<f32> {
    let place = spline_place(unit, vec3<f32>(textureDimensions(values)));
    let second = floor(place);
    let inside = place - second;
    var gradient = vec3<f32>(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let x = spline_axis(inside.x);
        let y = spline_axis(inside.y);
        let z = spline_axis(inside.z);
        gradient[axis] = spline_sum(
            values, linear_sampler, spline_pair(select(x.weights, x.slopes, axis == 0u), second.x),
            spline_pair(select(y.weights, y.slopes, axis == 1u), second.y),
            spline_pair(select(z.weights, z.slopes, axis == 2u), second.z), scale, offset
        );
    }
    return gradient;
}

/// Values of four voxels along x. `first`: the first of them, which may lie outside.
fn spline_row(values: texture_3d<f32>, first: vec3<i32>, scale: f32, offset: f32) -> vec4<f32> {
    let last = vec3<i32>(textureDimensions(values)) - 1;
    let beside = clamp(first.yz, vec2<i32>(0), last.yz);
    var row = vec4<f32>(0.0);
    for (var i = 0; i < 4; i++) {
        let texel = textureLoad(values, vec3<i32>(clamp(first.x + i, 0, last.x), beside), 0).x;
        row[i] = value_of_texel(texel, scale, offset);
    }
    return row;
}

/// Value and derivatives at a place in unit space, by 64 loads. `scale`, `offset`: from texels to values.
fn spline_jet(values: texture_3d<f32>, unit: vec3<f32>, scale: f32, offset: f32) -> SplineJet {
    let place = spline_place(unit, vec3<f32>(textureDimensions(values)));
    let second = floor(place);
    let inside = place - second;
    let x = spline_axis(inside.x);
    let y = spline_axis(inside.y);
    let z = spline_axis(inside.z);
    var value = 0.0;
    var gradient = vec3<f32>(0.0);
    // Second derivatives: xx, yy, zz and xy, xz, yz.
    var pure = vec3<f32>(0.0);
    var mixed = vec3<f32>(0.0);
    for (var k = 0; k < 4; k++) {
        // Sums over a slice: of value, slope and bend along x; of value and slope that slope along y; of what bends along y.
        var level = vec3<f32>(0.0);
        var sloping = vec2<f32>(0.0);
        var bent = 0.0;
        for (var j = 0; j < 4; j++) {
            let row = spline_row(values, vec3<i32>(second) + vec3<i32>(-1, j - 1, k - 1), scale, offset);
            let along = vec3<f32>(dot(row, x.weights), dot(row, x.slopes), dot(row, x.bends));
            level += y.weights[j] * along;
            sloping += y.slopes[j] * along.xy;
            bent += y.bends[j] * along.x;
        }
        value += z.weights[k] * level.x;
        gradient += vec3<f32>(z.weights[k] * vec2<f32>(level.y, sloping.x), z.slopes[k] * level.x);
        pure += vec3<f32>(z.weights[k] * vec2<f32>(level.z, bent), z.bends[k] * level.x);
        mixed += vec3<f32>(z.weights[k] * sloping.y, z.slopes[k] * vec2<f32>(level.y, sloping.x));
    }
    return SplineJet(value, gradient, mat3x3<f32>(
        vec3<f32>(pure.x, mixed.x, mixed.y),
        vec3<f32>(mixed.x, pure.y, mixed.z),
        vec3<f32>(mixed.y, mixed.z, pure.z),
    ));
}
