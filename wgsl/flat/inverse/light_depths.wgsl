// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/light_depths, permutation default (RGB)
// summary: What a light passes on its way through a volume: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); see inverse/light_layers.
// note: Dispatch over the texels of a light's view. Beyond the box there is what is outermost in it.
// definition RGB: three channels, each by itself; else one.
// binding view: of the light; its slices are how many layers there are.
// binding layers: where they lie.
// binding extinction: of the medium, 1/m.
// binding depths: out, optical depth from the first layer to the sides of layers: columns, rows, layers and one; r32float, rgba32float with RGB.

// ---- airlight::inverse::basis ----
// summary: Fields as sums of basis functions, one a voxel: triangle or box functions.
// source: thesis 7.3.1.

/// A field of triangle functions at a place.
fn triangle_field(field: texture_3d<f32>, unit: vec3<f32>) -> vec4<f32> {
    let size = textureDimensions(field);
    let last = vec3<f32>(size - vec3<u32>(1u));
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), last);
    let low = floor(place);
    let part = place - low;
    let near = vec3<u32>(low);
    let far = vec3<u32>(min(low + 1.0, last));
    let a = mix(textureLoad(field, near, 0), textureLoad(field, vec3<u32>(far.x, near.yz), 0), part.x);
    let b = mix(textureLoad(field, vec3<u32>(near.x, far.y, near.z), 0), textureLoad(field, vec3<u32>(far.xy, near.z), 0), part.x);
    let c = mix(textureLoad(field, vec3<u32>(near.xy, far.z), 0), textureLoad(field, vec3<u32>(far.x, near.y, far.z), 0), part.x);
    let d = mix(textureLoad(field, vec3<u32>(near.x, far.yz), 0), textureLoad(field, far, 0), part.x);
    return mix(mix(a, b, part.y), mix(c, d, part.y), part.z);
}

// ---- airlight::inverse::channels ----
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.

/// The channels of a texel.
fn channels_of(texel: vec4<f32>) -> vec3<f32> {
    return texel.rgb;
}

/// The texel of channels.
fn texel_of(value: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(value, 1.0);
}

/// The same number in all channels.
fn all_channels(value: f32) -> vec3<f32> {
    return vec3<f32>(value);
}

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// A view of the volume: rays are affine in the pixel. 208 bytes.
struct SliceView {
    /// Where the ray through the corner of the picture begins.
    origin: vec3<f32>,
    /// How many slices, 1..MOST_SLICES.
    slices: u32,
    /// Direction of that ray, of any length.
    direction: vec3<f32>,
    reserved_a: u32,
    /// What a pixel to the right adds to the origin.
    origin_right: vec3<f32>,
    /// Of the picture, pixels.
    width: u32,
    /// What a pixel to the right adds to the direction.
    direction_right: vec3<f32>,
    /// Of the picture, pixels.
    height: u32,
    /// What a pixel down adds to the origin.
    origin_down: vec3<f32>,
    reserved_b: u32,
    /// What a pixel down adds to the direction.
    direction_down: vec3<f32>,
    reserved_c: u32,
    /// Unit vector across slices: an axis of the box.
    axis: vec3<f32>,
    /// How far from faces across the slices samples may lie of rays that do not cross their slice whole, of the box: anywhere from 1 on.
    margin: f32,
    /// Homogeneous column, in pixels, of a point (x, y, z, 1).
    column_of: vec4<f32>,
    /// Homogeneous row.
    row_of: vec4<f32>,
    /// What both are divided by.
    divisor_of: vec4<f32>,
    /// Edge of the box along x, in the world, metres.
    edge_x: vec3<f32>,
    reserved_e: u32,
    /// Edge along y.
    edge_y: vec3<f32>,
    reserved_f: u32,
    /// Edge along z.
    edge_z: vec3<f32>,
    reserved_g: u32,
}

/// A view ray.
struct SliceRay {
    /// Where it begins.
    origin: vec3<f32>,
    /// Of any length.
    direction: vec3<f32>,
    /// Metres that one length of `direction` is.
    metres: f32,
}

/// The ray through a position in pixels; (0.5, 0.5) is the middle of the first.
fn slice_ray(view: SliceView, pixel: vec2<f32>) -> SliceRay {
    let origin = view.origin + pixel.x * view.origin_right + pixel.y * view.origin_down;
    let direction = view.direction + pixel.x * view.direction_right + pixel.y * view.direction_down;
    let metres = direction.x * view.edge_x + direction.y * view.edge_y + direction.z * view.edge_z;
    return SliceRay(origin, direction, length(metres));
}

// ---- airlight::inverse::light_layers ----
// summary: A light's view of a volume in layers across its way, which hold optical depth: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); thesis 2.4.3.

/// Layers of a light's view. 96 bytes.
struct LightLayers {
    /// From the box 0..1 of the volume to the world, metres; affine.
    world_from_unit: mat4x4<f32>,
    /// What gives the layer of a point (x, y, z, 1) of the box: 0 where the box begins, as many as there are where it ends.
    layer_of: vec4<f32>,
    /// Voxels of scattered light along x, y and z.
    size: vec3<u32>,
    /// Face of the cube around a point light that this is the view of, +x -x +y -y +z -z; EVERY_FACE of other lights.
    face: u32,
}

/// Layer where a ray begins, and layers that it crosses for one length of its direction.
fn layers_along(layers: LightLayers, ray: SliceRay) -> vec2<f32> {
    return vec2<f32>(dot(layers.layer_of, vec4<f32>(ray.origin, 1.0)), max(dot(layers.layer_of.xyz, ray.direction), 1e-20));
}

// ---- inverse/light_depths ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var<uniform> layers: LightLayers;
@group(0) @binding(2) var extinction: texture_3d<f32>;
@group(0) @binding(3) var depths: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(16, 8)
fn light_depths(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(view.width, view.height)) {
        return;
    }
    let ray = slice_ray(view, vec2<f32>(id.xy) + 0.5);
    let along = layers_along(layers, ray);
    var depth = all_channels(0.0);
    textureStore(depths, vec3<u32>(id.xy, 0u), texel_of(depth));
    let step = 1.0 / along.y;
    for (var layer = 0u; layer < min(view.slices, textureDimensions(depths).z); layer++) {
        let place = ray.origin + ray.direction * ((f32(layer) + 0.5 - along.x) * step);
        depth += channels_of(triangle_field(extinction, place)) * (step * ray.metres);
        textureStore(depths, vec3<u32>(id.xy, layer + 1u), texel_of(depth));
    }
}
