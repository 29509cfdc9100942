// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/transfer_layer, permutation default
// summary: A layer of a transfer function, blended over the layers below it.
// source: thesis 6.2.2, Figure 6.10.
// note: Non-finite texels are transparent.
// binding layer: the layer; without MIX.
// binding below: what lies below, or the first function; premultiplied linear RGBA of the size of `composed`.
// binding picture: the layer's picture, or the second function; premultiplied linear RGBA of any size, any float format that filters.
// binding picture_sampler: linear, clamped to the edge.
// binding composed: out, premultiplied linear RGBA, rgba16float.

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

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::stylize::tf_layers ----
// summary: Layers of a transfer function: solid colours, gradients and pictures, blended over what lies below.
// source: thesis 6.2.2, Figure 6.10; Porter and Duff (1984); W3C, "Compositing and blending level 1", 9.1.

/// From one colour to another along a line.
const GRADIENT: u32 = 1u;
/// A picture over the whole square: an image, or what constraints diffuse to.
const PICTURE: u32 = 2u;

/// The layer darkens what lies below.
const MULTIPLY: u32 = 1u;
/// The layer is added to what lies below.
const ADD: u32 = 2u;

/// A layer. 64 bytes.
struct TransferLayer {
    /// Colour of a solid layer and of a gradient's begin, premultiplied linear RGBA.
    first: vec4<f32>,
    /// Colour of a gradient's end, premultiplied linear RGBA.
    second: vec4<f32>,
    /// Where a gradient begins, 0..1 in x and y.
    from_position: vec2<f32>,
    /// Where it ends.
    to_position: vec2<f32>,
    /// SOLID, GRADIENT or PICTURE.
    kind: u32,
    /// OVER, MULTIPLY or ADD.
    blend: u32,
    /// Factor on colour and alpha, 0..1.
    opacity: f32,
    reserved: f32,
}

/// How far `position` lies on the way between two positions, 0..1; 1 everywhere where they are the same.
fn gradient_share(position: vec2<f32>, from_position: vec2<f32>, to_position: vec2<f32>) -> f32 {
    let along = to_position - from_position;
    let square = dot(along, along);
    let share = dot(position - from_position, along) / max(square, 1e-30);
    return select(clamp(share, 0.0, 1.0), 1.0, square < 1e-30);
}

/// Colour of a layer at `position`, 0..1, premultiplied; `picture`: that of its picture there.
fn layer_color(layer: TransferLayer, position: vec2<f32>, picture: vec4<f32>) -> vec4<f32> {
    let share = gradient_share(position, layer.from_position, layer.to_position);
    var color = layer.first;
    color = select(color, mix(layer.first, layer.second, share), layer.kind == GRADIENT);
    color = select(color, picture, layer.kind == PICTURE);
    return color * clamp(layer.opacity, 0.0, 1.0);
}

/// A layer's colour blended over the colour `below`, both premultiplied. Colours of a sum may exceed its alpha.
fn blended(blend: u32, color: vec4<f32>, below: vec4<f32>) -> vec4<f32> {
    let over = color + below * (1.0 - color.a);
    let product = color * (1.0 - below.a) + below * (1.0 - color.a) + color * below;
    var result = over;
    result = select(result, product, blend == MULTIPLY);
    result = select(result, color + below, blend == ADD);
    let rgb = clamp(result.rgb, vec3<f32>(0.0), vec3<f32>(65504.0));
    return vec4<f32>(rgb, clamp(result.a, 0.0, 1.0));
}

// ---- stylize/transfer_layer ----

/// Of two functions.
struct TransferShare {
    /// Part of the second, 0..1; the first has the rest.
    second: f32,
    reserved_a: f32,
    reserved_b: f32,
    reserved_c: f32,
}

@group(0) @binding(0) var<uniform> layer: TransferLayer;
@group(0) @binding(1) var below: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var picture_sampler: sampler;
@group(0) @binding(4) var composed: texture_storage_2d<rgba16float, write>;

/// A texel with what is not finite replaced by 0.
fn cleaned(color: vec4<f32>) -> vec4<f32> {
    let rgb = clamp(finite_or_rgb(color.rgb, 0.0), vec3<f32>(0.0), vec3<f32>(65504.0));
    return vec4<f32>(rgb, clamp(finite_or(color.a, 0.0), 0.0, 1.0));
}

@compute @workgroup_size(16, 8)
fn compose(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(composed);
    if any(id.xy >= size) {
        return;
    }
    let position = (vec2<f32>(id.xy) + 0.5) / vec2<f32>(size);
    let above = cleaned(textureSampleLevel(picture, picture_sampler, position, 0.0));
    let under = cleaned(textureLoad(below, id.xy, 0));
    let color = blended(layer.blend, layer_color(layer, position, above), under);
    textureStore(composed, id.xy, color);
}
