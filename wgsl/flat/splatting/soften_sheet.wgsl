// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/soften_sheet, permutation default
// summary: Blurs the layers of the shadow buffer from one sheet to the next, along columns, then along rows.
// source: Zhang and Crawfis, 5.1; see splatting/soft_shadow.
// note: Dispatch soften_across, then soften_down over the buffer behind each sheet, for each set of layers. Taps of layers that are
// note: smooth already lie apart. What lies outside of the buffer takes no light.
// binding number: which sheet.
// binding soft: the buffer.
// binding blurs: how each layer is blurred behind each sheet, 16 a sheet.
// binding layers: transmittances, layer after layer, row after row; in and out.
// binding softened: of the same size, between both entries.

// ---- airlight::splatting::blur ----
// summary: Kernels of separable blurs whose weights add up to 1 and whose variance is exactly what was asked for.
// source: Variances of blurs one after the other add up; so a blur that runs for many sheets needs each to be exact.

/// Greatest variance of one blur, in squares of the distance between its taps.
const MOST_VARIANCE: f32 = 16.0;
/// Weights of a kernel: of offsets 0 to 12.
const BLUR_WEIGHTS: u32 = 13u;

/// Offset of the last tap to each side, 0..12. `variance`: in squares of the distance between taps.
fn blur_radius(variance: f32) -> u32 {
    let reach = u32(clamp(ceil(3.0 * sqrt(max(variance, 0.0))), 1.0, f32(BLUR_WEIGHTS - 1u)));
    return select(select(reach, 1u, variance <= 0.5), 0u, variance <= 0.0);
}

/// The Gaussian at an offset, 1 in the middle; a variance below 0.5 counts as that.
fn blur_bell(variance: f32, offset: u32) -> f32 {
    return exp(-0.5 * f32(offset * offset) / max(variance, 0.5));
}

/// What `blur_weight` needs to know of a variance: the sum of the taps of `blur_bell`, their own variance, and how much the parabola bends.
fn blur_sums(variance: f32) -> vec3<f32> {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    var moments = vec3<f32>(1.0, 0.0, 0.0);
    for (var offset = 1u; offset <= blur_radius(asked); offset++) {
        let square = f32(offset * offset);
        moments += 2.0 * blur_bell(asked, offset) * vec3<f32>(1.0, square, square * square);
    }
    let own = moments.y / moments.x;
    return vec3<f32>(moments.x, own, (asked - own) / max(moments.z / moments.x - own * own, 1e-6));
}

/// Weight of the tap at an offset of 0 to 12 to either side, of a kernel with `sums` by `blur_sums`; 0 beyond its radius.
fn blur_weight(variance: f32, sums: vec3<f32>, offset: u32) -> f32 {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    let three = select(select(0.0, 0.5 * asked, offset == 1u), 1.0 - asked, offset == 0u);
    let mended = blur_bell(asked, offset) / sums.x * (1.0 + sums.z * (f32(offset * offset) - sums.y));
    return select(select(0.0, mended, offset <= blur_radius(asked)), three, asked <= 0.5);
}

// ---- airlight::splatting::sheets ----
// summary: Sheets: slabs of equal thickness one behind the other along the half-way vector between eye and light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 4.1, Fig. 5.

/// A sheet that is drawn. 16 bytes.
struct SheetNumber {
    /// From 0, the sheet nearest to the light.
    index: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

// ---- airlight::splatting::soft_shadow ----
// summary: Soft shadows of area lights: layers of the shadow buffer by depth, and how deep solids behind a surface are.
// source: Zhang and Crawfis, 5.1; Soler and Sillion, "Fast calculation of soft shadow textures using convolution" (1998).

/// Layers of the shadow buffer.
const SOFT_LAYERS: u32 = 16u;

/// How a layer is blurred from one sheet to the next. 16 bytes.
struct LayerBlur {
    /// Variance along columns and rows of the buffer, in squares of the taps' distance.
    variance: vec2<f32>,
    /// Distance of taps, texels.
    distance: vec2<u32>,
}

/// The shadow buffer's geometry, and solids. 32 bytes.
struct SoftLight {
    /// Texels of the shadow buffer.
    size: vec2<u32>,
    /// Side of a texel: metres of a directional light, metres per metre of distance of a light at a point.
    texel: vec2<f32>,
    /// Height of a light at a point along the sheets' normal, metres.
    height: f32,
    /// 1 of a light at a point, 0 of a directional one.
    local: u32,
    /// Depth of solids where their surface rises by a metre a metre, metres.
    filling: f32,
    /// Greatest depth of solids, metres.
    deepest: f32,
}

/// How many layers hold something when a sheet is reached; `index`: from 0, of the sheet.
fn layers_in_use(index: u32) -> u32 {
    return min(index, SOFT_LAYERS);
}

// ---- splatting/soften_sheet ----

@group(0) @binding(0) var<uniform> number: SheetNumber;
@group(0) @binding(1) var<uniform> soft: SoftLight;
@group(0) @binding(2) var<storage, read> blurs: array<LayerBlur>;
@group(0) @binding(3) var<storage, read_write> layers: array<f32>;
@group(0) @binding(4) var<storage, read_write> softened: array<f32>;

/// Weights of all layers' kernels.
var<workgroup> weights: array<f32, 208>;
/// Last offset and distance of taps of each layer.
var<workgroup> taps: array<vec2<i32>, 16>;

/// The kernel of a layer along an axis.
fn prepare(layer: u32, axis: u32) {
    if layer >= SOFT_LAYERS {
        return;
    }
    let blur = blurs[min(number.index * SOFT_LAYERS + layer, arrayLength(&blurs) - 1u)];
    let variance = clamp(blur.variance[axis], 0.0, MOST_VARIANCE);
    let sums = blur_sums(variance);
    for (var offset = 0u; offset < BLUR_WEIGHTS; offset++) {
        weights[layer * BLUR_WEIGHTS + offset] = blur_weight(variance, sums, offset);
    }
    let radius = blur_radius(variance);
    taps[layer] = vec2<i32>(i32(radius), i32(clamp(blur.distance[axis], 1u, 65536u)));
}

/// A texel of a layer before the blur.
fn texel_at(first: u32, texel: vec2<i32>, axis: u32) -> f32 {
    if any(texel < vec2<i32>(0)) || any(texel >= vec2<i32>(soft.size)) {
        return 1.0;
    }
    let place = first + u32(texel.y) * soft.size.x + u32(texel.x);
    if axis == 0u {
        return layers[min(place, arrayLength(&layers) - 1u)];
    }
    return softened[min(place, arrayLength(&softened) - 1u)];
}

/// Blurs a texel of all layers along an axis.
fn soften(pixel: vec2<u32>, axis: u32) {
    if any(pixel >= soft.size) {
        return;
    }
    let texel = vec2<i32>(pixel);
    for (var layer = 0u; layer < layers_in_use(number.index + 1u); layer++) {
        let first = layer * soft.size.x * soft.size.y;
        let tap = taps[layer];
        let along = select(vec2<i32>(0, tap.y), vec2<i32>(tap.y, 0), axis == 0u);
        var sum = texel_at(first, texel, axis) * weights[layer * BLUR_WEIGHTS];
        for (var offset = 1; offset <= tap.x; offset++) {
            let both = texel_at(first, texel + offset * along, axis) + texel_at(first, texel - offset * along, axis);
            sum += both * weights[layer * BLUR_WEIGHTS + u32(offset)];
        }
        let place = first + pixel.y * soft.size.x + pixel.x;
        if axis == 0u {
            softened[min(place, arrayLength(&softened) - 1u)] = sum;
        } else {
            layers[min(place, arrayLength(&layers) - 1u)] = sum;
        }
    }
}

@compute @workgroup_size(16, 8)
fn soften_across(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    prepare(thread, 0u);
    workgroupBarrier();
    soften(id.xy, 0u);
}

@compute @workgroup_size(16, 8)
fn soften_down(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    prepare(thread, 1u);
    workgroupBarrier();
    soften(id.xy, 1u);
}
