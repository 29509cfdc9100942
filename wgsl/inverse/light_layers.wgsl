// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::light_layers
// summary: A light's view of a volume in layers across its way, which hold how dense what it passes is: an opacity shadow map.
// source: Kim and Neumann, "Opacity shadow maps" (2001); Klehm, "Stylized scattering", thesis, 2.4.3.
// note: Layers hold the mean extinction from where a ray enters the box, not the optical depth: the depth bends at the faces of the box, where
// note: values between rays that have entered and rays that have not would be wrong; the mean goes on smoothly. The depth at a point is the
// note: mean times its own way in the box, which is known exactly, and so a medium that is even everywhere has no error at all.
// note: Layers lie across the axis of the light, so that every ray of it crosses all of them, one after the other.

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

/// Where a ray of the map begins to count, in lengths of its direction: where it enters the box, and of one that goes by closely where it enters
/// a box that is two texels larger, so that points of the box that lie next to it find what they would.
fn layers_begin(view: SliceView, ray: SliceRay, along: vec2<f32>) -> f32 {
    let edges = vec3<f32>(length(view.edge_x), length(view.edge_y), length(view.edge_z));
    let texel = (edges.x + edges.y + edges.z) / f32(max(min(view.width, view.height), 1u));
    let room = 2.0 * texel / max(edges, vec3<f32>(1e-20));
    let shrunk = vec3<f32>(1.0) + 2.0 * room;
    let inner = ray_span(ray, 3e38);
    let outer = ray_span(SliceRay((ray.origin + room) / shrunk, ray.direction / shrunk, ray.metres), 3e38);
    let first = -along.x / along.y;
    return max(first, select(select(first, outer.x, outer.y > outer.x), inner.x, inner.y > inner.x));
}

/// How far light comes through the box to a point of it, metres. `pixel`: where the light sees it, of `pixel_of`.
fn way_to(layers: LightLayers, view: SliceView, unit: vec3<f32>, pixel: vec2<f32>) -> f32 {
    let ray = slice_ray(view, pixel);
    let along = layers_along(layers, ray);
    let place = (dot(layers.layer_of, vec4<f32>(unit, 1.0)) - along.x) / along.y;
    return max(place - ray_span(ray, 3e38).x, 0.0) * ray.metres;
}

/// Where a light sees a point of the box, pixels; of one that it does not see somewhere in the view.
fn pixel_of(view: SliceView, unit: vec3<f32>) -> vec2<f32> {
    let point = vec4<f32>(unit, 1.0);
    let pixel = vec2<f32>(dot(view.column_of, point), dot(view.row_of, point)) / max(dot(view.divisor_of, point), 1e-12);
    return clamp(pixel, vec2<f32>(0.0), vec2<f32>(f32(view.width), f32(view.height)));
}

/// Where a point of the box lies in the map, 0..1.
fn place_in_layers(layers: LightLayers, view: SliceView, unit: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let layer = clamp(dot(layers.layer_of, vec4<f32>(unit, 1.0)), 0.0, f32(view.slices));
    // Layers are stored from the first side to the last, one more than there are.
    return vec3<f32>(pixel / vec2<f32>(f32(view.width), f32(view.height)), (layer + 0.5) / (f32(view.slices) + 1.0));
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
