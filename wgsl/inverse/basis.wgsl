// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::basis
// summary: Fields as sums of basis functions, one a voxel: triangle or box functions.
// source: thesis 7.3.1.
// note: Weights are computed in 32 bits and by hand: texture units round them to 8 bits, and reading and adding up have to agree.
// note: Positions are in unit space; voxel i lies at (i + 0.5) / size. Beyond the outermost voxels triangles keep the value of the nearest.
// equation: triangle: φ_i(x) = Π axes max(0, 1 − |x size − ½ − i|), at the border held;  box: 1 in the voxel, else 0;  f(x) = Σ_i f_i φ_i(x)
// error: pictures are the product with the matrix of these within 1e-3 of f64, transposed pairs within 1e-5;
// error: test inverse/projection::pictures_are_products_with_a_matrix_and_back_projections_with_its_transpose.
// parameter unit: place in unit space, the volume being 0..1.
// parameter size: voxels along each axis, from 1 up.
// parameter voxel: numbers along each axis, from 0.
// parameter field: one texel a voxel, any float format.

/// A voxel and its basis function at some place.
struct Corner {
    /// The voxel.
    voxel: vec3<u32>,
    /// Its basis function there, 0..1.
    weight: f32,
}

/// One of the eight voxels about a place, and its triangle function there; the eight weights add up to 1. `corner`: 0 to 7, a bit an axis.
fn triangle_corner(unit: vec3<f32>, size: vec3<u32>, corner: u32) -> Corner {
    let last = vec3<f32>(size - vec3<u32>(1u));
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), last);
    let low = floor(place);
    let part = place - low;
    let upper = (vec3<u32>(corner, corner >> 1u, corner >> 2u) & vec3<u32>(1u)) == vec3<u32>(1u);
    let weights = select(vec3<f32>(1.0) - part, part, upper);
    // Upper ones that there are not have no weight.
    return Corner(vec3<u32>(select(low, min(low + 1.0, last), upper)), weights.x * weights.y * weights.z);
}

/// Weights along the axes of the voxel at `voxel` at a place, their product is the basis function: triangles.
fn triangle_weights(unit: vec3<f32>, voxel: vec3<u32>, size: vec3<u32>) -> vec3<f32> {
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), vec3<f32>(size - vec3<u32>(1u)));
    return max(vec3<f32>(1.0) - abs(place - vec3<f32>(voxel)), vec3<f32>(0.0));
}

/// The same of boxes: 1 in the voxel, 0 elsewhere.
fn box_weights(unit: vec3<f32>, voxel: vec3<u32>, size: vec3<u32>) -> vec3<f32> {
    return select(vec3<f32>(0.0), vec3<f32>(1.0), voxel_of_place(unit, size) == voxel);
}

/// The voxel in which a place lies; of one outside the nearest.
fn voxel_of_place(unit: vec3<f32>, size: vec3<u32>) -> vec3<u32> {
    let last = vec3<f32>(size - vec3<u32>(1u));
    return vec3<u32>(clamp(floor(unit * vec3<f32>(size)), vec3<f32>(0.0), last));
}

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

/// A field of box functions at a place.
fn box_field(field: texture_3d<f32>, unit: vec3<f32>) -> vec4<f32> {
    return textureLoad(field, voxel_of_place(unit, textureDimensions(field)), 0);
}
