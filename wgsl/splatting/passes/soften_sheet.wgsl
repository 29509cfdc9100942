// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Blurs the layers of the shadow buffer from one sheet to the next, along columns, then along rows.
// source: Zhang and Crawfis, 5.1; see splatting/soft_shadow.
// note: Dispatch soften_across, then soften_down over the buffer behind each sheet, for each set of layers. Taps of layers that are
// note: smooth already lie apart. What lies outside of the buffer takes no light.
// binding number: which sheet.
// binding soft: the buffer.
// binding blurs: how each layer is blurred behind each sheet, 16 a sheet.
// binding layers: transmittances, layer after layer, row after row; in and out.
// binding softened: of the same size, between both entries.

#import airlight::splatting::blur::{BLUR_WEIGHTS, MOST_VARIANCE, blur_radius, blur_sums, blur_weight}
#import airlight::splatting::sheets::SheetNumber
#import airlight::splatting::soft_shadow::{SOFT_LAYERS, LayerBlur, SoftLight, layers_in_use}

@group(#{GROUP}) @binding(0) var<uniform> number: SheetNumber;
@group(#{GROUP}) @binding(1) var<uniform> soft: SoftLight;
@group(#{GROUP}) @binding(2) var<storage, read> blurs: array<LayerBlur>;
@group(#{GROUP}) @binding(3) var<storage, read_write> layers: array<f32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> softened: array<f32>;

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
