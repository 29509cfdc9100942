// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::stylize::tf_layers
// summary: Layers of a transfer function: solid colours, gradients and pictures, blended over what lies below.
// source: thesis 6.2.2, Figure 6.10; Porter and Duff (1984); W3C, "Compositing and blending level 1", 9.1.
// note: All colours are linear and premultiplied. Multiplying is that of W3C: where nothing lies below, the layer shows.
// equation: over: c + b (1 − α_c);  multiply: c (1 − α_b) + b (1 − α_c) + c b;  add: c + b, all premultiplied
// equation: share = <x − from, to − from> / |to − from|², cut to 0..1
// error: within 4e-3, as half floats hold it; test stylize/transfer/layers::layers_are_blended_as_the_equations_say.
// parameter position: 0..1 in x and y.
// parameter from_position, to_position: 0..1 in x and y.
// parameter picture: premultiplied linear RGBA.
// parameter blend: OVER, MULTIPLY or ADD.
// parameter color, below: premultiplied linear RGBA.

/// The same colour everywhere.
const SOLID: u32 = 0u;
/// From one colour to another along a line.
const GRADIENT: u32 = 1u;
/// A picture over the whole square: an image, or what constraints diffuse to.
const PICTURE: u32 = 2u;

/// The layer covers what lies below by its alpha.
const OVER: u32 = 0u;
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
