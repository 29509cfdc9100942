// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/scatter_light, permutation default (RGB)
// summary: Radiance that each voxel would scatter in every direction if its albedo were 1: light of one view of a light is added.
// source: thesis 2.4.3, Eq. 2.16 with an isotropic phase function; see inverse/light_layers.
// note: Dispatch over the voxels for each view of each light. Irradiance over 4 pi, times transmittance, times what surfaces let pass.
// definition RGB: three channels; else the first alone.
// binding view: of the light, as in inverse/light_depths.
// binding layers: where they lie, and how many voxels there are.
// binding light: the light, with the matrix of its shadow map.
// binding depths: of inverse/light_depths.
// binding sums: in and out, numbers a voxel, x fastest: one; four with RGB, of which the last stays as it is.

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

/// Unit vector from `point`, metres in the world, TOWARDS the light; zero where a light at a point is right there.
fn direction_to_light(light: Light, point: vec3<f32>) -> vec3<f32> {
    let between = light.position - point;
    let local = between * inverseSqrt(max(dot(between, between), 1e-30));
    return select(local, light.direction, light.kind == DIRECTIONAL);
}

/// Angular fall-off, 0..1, along the light ray with the unit vector `towards` TOWARDS the light: of a spot 1 inside
/// the inner cone, 0 outside the outer one, smooth between; of every other light 1.
fn angular_falloff(light: Light, towards: vec3<f32>) -> f32 {
    // Not smoothstep: WGSL leaves it open what that is between two equal edges.
    let above = dot(towards, light.direction) - light.spot_cosines.y;
    let unit = clamp(above / max(light.spot_cosines.x - light.spot_cosines.y, 1e-6), 0.0, 1.0);
    return select(1.0, unit * unit * (3.0 - 2.0 * unit), light.kind == SPOT);
}

/// What `radiance` is multiplied by to give the irradiance at normal incidence of `point`, metres in the world, in clear
/// air without blockers: 1 for a directional light, else `angular_falloff` over the square of the distance in 1/m^2,
/// softened by the light's radius.
fn light_falloff(light: Light, point: vec3<f32>) -> f32 {
    let between = light.position - point;
    let square = dot(between, between) + light.radius * light.radius;
    let local = angular_falloff(light, direction_to_light(light, point)) / max(square, 1e-12);
    return select(local, 1.0, light.kind == DIRECTIONAL);
}

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

/// The part of a ray in the box up to `limit` metres from where the ray begins, in lengths of its direction; none where the second is not
/// the greater.
fn ray_span(ray: SliceRay, limit: f32) -> vec2<f32> {
    let still = abs(ray.direction) < vec3<f32>(1e-20);
    let safe = select(ray.direction, vec3<f32>(1.0), still);
    let low = -ray.origin / safe;
    let high = (vec3<f32>(1.0) - ray.origin) / safe;
    let inside = (ray.origin >= vec3<f32>(0.0)) & (ray.origin <= vec3<f32>(1.0));
    let enters = select(min(low, high), vec3<f32>(0.0), still);
    let leaves = select(max(low, high), select(vec3<f32>(-1.0), vec3<f32>(3e38), inside), still);
    let begins = max(max(enters.x, enters.y), max(enters.z, 0.0));
    let ends = min(min(leaves.x, leaves.y), leaves.z);
    return vec2<f32>(begins, min(ends, max(limit, 0.0) / max(ray.metres, 1e-30)));
}

// ---- airlight::inverse::light_layers ----
// summary: A light's view of a volume in layers across its way, which hold optical depth: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); thesis 2.4.3.

/// A cube's face that is all directions.
const EVERY_FACE: u32 = 6u;

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

/// Where a light sees a point of the box, pixels; of one that it does not see somewhere in the view.
fn pixel_of(view: SliceView, unit: vec3<f32>) -> vec2<f32> {
    let point = vec4<f32>(unit, 1.0);
    let pixel = vec2<f32>(dot(view.column_of, point), dot(view.row_of, point)) / max(dot(view.divisor_of, point), 1e-12);
    return clamp(pixel, vec2<f32>(0.0), vec2<f32>(f32(view.width), f32(view.height)));
}

/// Layer of a point of the box, and of the place where light enters that comes to it. `pixel`: where the light sees it, of `pixel_of`.
fn layers_to(layers: LightLayers, view: SliceView, unit: vec3<f32>, pixel: vec2<f32>) -> vec2<f32> {
    let ray = slice_ray(view, pixel);
    let along = layers_along(layers, ray);
    let own = dot(layers.layer_of, vec4<f32>(unit, 1.0));
    // Rounding may put the point itself before the face.
    return vec2<f32>(own, min(along.x + along.y * ray_span(ray, 3e38).x, own));
}

/// Where a layer at a pixel lies in the map, 0..1.
fn place_in_layers(view: SliceView, pixel: vec2<f32>, layer: f32) -> vec3<f32> {
    let count = f32(view.slices);
    // They are stored from the first side to the last, one more than there are.
    return vec3<f32>(pixel / vec2<f32>(f32(view.width), f32(view.height)), (clamp(layer, 0.0, count) + 0.5) / (count + 1.0));
}

/// Face of a cube that a direction from its middle goes through; of an edge the first of its faces.
fn cube_face(direction: vec3<f32>) -> u32 {
    let size = abs(direction);
    let other = select(2u, 1u, size.y >= size.z);
    let axis = select(other, 0u, size.x >= max(size.y, size.z));
    return 2u * axis + select(0u, 1u, direction[axis] < 0.0);
}

/// Whether this view of a light is the one for a direction from it.
fn face_holds(layers: LightLayers, direction: vec3<f32>) -> bool {
    return layers.face >= EVERY_FACE || cube_face(direction) == layers.face;
}

// ---- inverse/scatter_light ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var<uniform> layers: LightLayers;
@group(0) @binding(2) var<uniform> light: Light;
@group(0) @binding(3) var depths: texture_3d<f32>;
@group(0) @binding(4) var<storage, read_write> sums: array<f32>;

/// One over all directions, 1/sr.
const ISOTROPIC: f32 = 0.07957747;

@compute @workgroup_size(8, 4, 4)
fn scatter_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= layers.size) {
        return;
    }
    let unit = (vec3<f32>(id) + 0.5) / vec3<f32>(layers.size);
    let point = (layers.world_from_unit * vec4<f32>(unit, 1.0)).xyz;
    if !face_holds(layers, -direction_to_light(light, point)) {
        return;
    }
    let pixel = pixel_of(view, unit);
    let between = layers_to(layers, view, unit, pixel);
    let behind = channels_of(triangle_field(depths, place_in_layers(view, pixel, between.x)));
    let before = channels_of(triangle_field(depths, place_in_layers(view, pixel, between.y)));
    let depth = max(behind - before, all_channels(0.0));
    var share = ISOTROPIC * light_falloff(light, point);
    let radiance = share * channels_of(vec4<f32>(light.radiance, 0.0)) * exp(-depth);
    let index = (id.z * layers.size.y + id.y) * layers.size.x + id.x;
    for (var channel = 0u; channel < 3u; channel++) {
        sums[min(4u * index + channel, arrayLength(&sums) - 1u)] += radiance[channel];
    }
}
