// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::light_layers
// summary: A light's view of a volume in layers across its way, which hold optical depth: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); thesis 2.4.3.
// note: Layers hold the optical depth from the first one on, as if the medium went on beyond the faces of its box with what is outermost: so it
// note: bends nowhere, and values between rays are right also next to the faces, where some have entered and others have not. The depth
// note: of a point is what lies between it and the place where its own ray enters the box, which is known exactly.
// note: Layers lie across the axis of the light, so that every ray of it crosses all of them, one after the other.
// equation: layer k holds the optical depth from the first layer to k along the light's ray;  τ(point) = τ(own layer) − τ(layer of entry)
// error: optical depths within 1e-6; test inverse/preparation::optical_depths_are_those_of_the_reference.
// error: light of many directions: 0.003 rms, 0.015 at most; test inverse/light::light_of_many_directions_is_that_of_fine_marching.
// parameter unit: place in unit space.
// parameter pixel: position in the light's view, pixels.
// parameter layer: 0 .. slices, fractional.
// parameter direction: of any length, from the light.

#import airlight::inverse::slice_steps::{SliceView, SliceRay, slice_ray, ray_span}

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
