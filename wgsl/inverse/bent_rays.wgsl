// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::bent_rays
// summary: View rays that an index of refraction bends inside the box, in steps of one length; a picture and its back-projection take the same.
// source: Ihrke et al., "Eikonal rendering" (2007); thesis 7.3.
// note: Euler forward: x += ds v / |v|, v += ds grad n, and v is scaled to |v| = n. Errors fall with the step. The gradient is of central
// note: differences over half a voxel to both sides; the index goes on beyond the outermost voxels as all fields of triangles do.
// note: Rays are straight up to the box and are not refracted by its faces. They end where they leave it, at a surface, whose depth counts along
// note: the bend, or after `most` steps. A sample lies in the middle of its step; the last step is as long as there is way left.
// note: The index is kept to 0.01..100; what is not finite counts as 1.
// equation: d(n v) / ds = ∇n, |v| = 1:  x ← x + ds v,  v ← (n v + ds ∇n) / |n v + ds ∇n|
// error: rays and their weights within 1e-4, transposed pairs 1e-6;
// error: test inverse/bent::bent_rays_are_those_of_the_reference_and_scatter_with_the_same_weights.
// error: where the index rises evenly errors fall with the step;
// error: test inverse/bent::an_index_that_rises_evenly_bends_rays_upwards_along_catenaries.
// parameter world: direction in the world, metres.
// parameter refraction: index of refraction, one texel a voxel; 0.01..100.
// parameter unit: place in unit space.
// parameter place: in unit space.
// parameter along: direction in unit space, per metre.
// parameter step: length of a step, metres, above 0.

#import airlight::core::finite::finite_or
#import airlight::inverse::slice_steps::{SliceView, SliceRay, SlicePart}
#import airlight::inverse::basis::triangle_field

/// Gradients of the three coordinates of the box in the world, 1/m.
struct BoxSlopes {
    /// Of the first coordinate.
    along_x: vec3<f32>,
    /// Of the second.
    along_y: vec3<f32>,
    /// Of the third.
    along_z: vec3<f32>,
}

/// A bent ray before a step.
struct BentRay {
    /// Where it is, in unit space.
    place: vec3<f32>,
    /// Unit vector in the world.
    direction: vec3<f32>,
    /// Index of refraction where it is.
    index: f32,
    /// Metres from where it entered the box to where it ends at the latest.
    reach: f32,
    /// Whole steps that it has taken.
    taken: u32,
}

/// Gradients of the coordinates of a view's box.
fn box_slopes(view: SliceView) -> BoxSlopes {
    let size = max(max(length(view.edge_x), length(view.edge_y)), max(length(view.edge_z), 1e-30));
    // Of edges of about a metre, so that no product is too great or too small.
    let edge_x = view.edge_x / size;
    let edge_y = view.edge_y / size;
    let edge_z = view.edge_z / size;
    let across = cross(edge_y, edge_z);
    let volume = dot(edge_x, across);
    let scale = 1.0 / (size * select(volume, 1e-30, abs(volume) < 1e-30));
    return BoxSlopes(across * scale, cross(edge_z, edge_x) * scale, cross(edge_x, edge_y) * scale);
}

/// A direction of the world in unit space, per metre.
fn unit_direction(slopes: BoxSlopes, world: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(slopes.along_x, world), dot(slopes.along_y, world), dot(slopes.along_z, world));
}

/// The index of refraction at a place.
fn index_at(refraction: texture_3d<f32>, unit: vec3<f32>) -> f32 {
    return clamp(finite_or(triangle_field(refraction, unit).x, 1.0), 0.01, 100.0);
}

/// Gradient of the index in the world, 1/m.
fn index_slope(refraction: texture_3d<f32>, slopes: BoxSlopes, unit: vec3<f32>) -> vec3<f32> {
    let size = vec3<f32>(textureDimensions(refraction));
    let aside = 0.5 / size;
    let x = index_at(refraction, unit + vec3<f32>(aside.x, 0.0, 0.0)) - index_at(refraction, unit - vec3<f32>(aside.x, 0.0, 0.0));
    let y = index_at(refraction, unit + vec3<f32>(0.0, aside.y, 0.0)) - index_at(refraction, unit - vec3<f32>(0.0, aside.y, 0.0));
    let z = index_at(refraction, unit + vec3<f32>(0.0, 0.0, aside.z)) - index_at(refraction, unit - vec3<f32>(0.0, 0.0, aside.z));
    return slopes.along_x * (x * size.x) + slopes.along_y * (y * size.y) + slopes.along_z * (z * size.z);
}

/// A ray where it enters the box. `span`: of inverse/ray_spans with BENT.
fn bent_ray(refraction: texture_3d<f32>, view: SliceView, ray: SliceRay, span: vec2<f32>) -> BentRay {
    let metres = ray.direction.x * view.edge_x + ray.direction.y * view.edge_y + ray.direction.z * view.edge_z;
    let place = ray.origin + ray.direction * span.x;
    let inside = span.y > span.x;
    return BentRay(
        select(vec3<f32>(0.5), place, inside),
        metres / max(ray.metres, 1e-30),
        index_at(refraction, place),
        select(0.0, min((span.y - span.x) * ray.metres, 1e30), inside),
        0u
    );
}

/// Metres to where a ray leaves the box; not above 0 for one on a face, on its way out.
fn way_out(place: vec3<f32>, along: vec3<f32>) -> f32 {
    let still = abs(along) < vec3<f32>(1e-20);
    let safe = select(along, vec3<f32>(1.0), still);
    let ways = (select(vec3<f32>(0.0), vec3<f32>(1.0), along > vec3<f32>(0.0)) - place) / safe;
    let way = select(ways, vec3<f32>(3e38), still);
    return min(min(way.x, way.y), way.z);
}

/// What is next of a ray; 0 metres of one that has ended.
fn part_ahead(slopes: BoxSlopes, ray: BentRay, step: f32) -> SlicePart {
    let along = unit_direction(slopes, ray.direction);
    let left = ray.reach - f32(ray.taken) * step;
    let metres = max(min(step, min(left, way_out(ray.place, along))), 0.0);
    return SlicePart(ray.place + along * (0.5 * metres), metres);
}

/// The ray after a part.
fn after_part(refraction: texture_3d<f32>, slopes: BoxSlopes, ray: BentRay, part: SlicePart, step: f32) -> BentRay {
    let place = ray.place + unit_direction(slopes, ray.direction) * step;
    let turned = ray.direction * ray.index + index_slope(refraction, slopes, ray.place) * step;
    let size = length(turned);
    // A force that takes all its way away leaves a ray as it is.
    let direction = select(ray.direction, turned / max(size, 1e-20), size > 1e-20);
    let ended = part.metres < step;
    return BentRay(
        select(place, ray.place, ended),
        direction,
        index_at(refraction, place),
        select(ray.reach, 0.0, ended),
        ray.taken + 1u
    );
}

/// What is next of a ray, which goes on behind it; 0 metres of one that has ended.
fn next_part(refraction: texture_3d<f32>, slopes: BoxSlopes, ray: ptr<function, BentRay>, step: f32) -> SlicePart {
    let part = part_ahead(slopes, *ray, step);
    *ray = after_part(refraction, slopes, *ray, part, step);
    return part;
}
