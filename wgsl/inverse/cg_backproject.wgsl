// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::cg_backproject
// summary: Which pixels and slices a voxel collects from when a picture is projected back into the volume.
// source: thesis 7.4.1: the transpose of rendering.
// note: The thesis scatters from pixels to voxels, with additions that race. Here each voxel collects from the few pixels whose samples its
// note: basis function reaches, always in the same order. A sample lies on the middle plane of its slice: of rays that cross the slice whole where
// note: they cross that plane, of others beside a point of the slice. So a pixel with a sample in a support has its middle in the projection of
// note: the support on that plane, or of its extrusion over the slice; the projection of a box lies within that of its corners.
// equation: (W' y)_i = Σ over pixels p, slices s of w_ps φ_i(x_ps) y_p, in a fixed order
// error: transposed pairs within 1e-5: <Wx, y> = <x, W'y>;
// error: test inverse/projection::pictures_are_products_with_a_matrix_and_back_projections_with_its_transpose.
// error: no pixel is left out behind the eye; test inverse/projection::planes_that_go_on_behind_the_eye_are_collected_from_all_their_pixels.
// parameter voxel: numbers along each axis, from 0.
// parameter size: voxels along each axis, from 1 up.
// parameter axis: unit vector, one of x, y and z.
// parameter vector: of unit space or voxels.
// parameter slice: number, 0 .. slices - 1.
// parameter pixel: column and row of a pixel's middle less a half: (0, 0) the first.
// parameter begin, end: corners of a part of the picture, pixels.

#import airlight::inverse::slice_steps::{SliceView, MOST_SLICES}
#import airlight::inverse::basis::triangle_weights

/// The part of the volume's box in which a basis function is not 0.
struct Support {
    /// Its least corner, 0..1.
    low: vec3<f32>,
    /// Its greatest corner, 0..1.
    high: vec3<f32>,
}

/// The support of a voxel's basis function. `reach`: in voxels from the voxel's middle: 1 of triangles, 0.5 of boxes.
fn support_of(voxel: vec3<u32>, size: vec3<u32>, reach: f32) -> Support {
    let middle = vec3<f32>(voxel) + 0.5;
    // Outermost voxels reach to the faces of the box.
    let low = select(middle - reach, vec3<f32>(0.0), voxel == vec3<u32>(0u));
    let high = select(middle + reach, vec3<f32>(size), voxel + 1u == size);
    return Support(low / vec3<f32>(size), high / vec3<f32>(size));
}

/// First slice whose middle plane crosses the support and the one past the last.
fn slices_of_support(view: SliceView, support: Support) -> vec2<u32> {
    let count = f32(min(view.slices, MOST_SLICES));
    let ends = vec2<f32>(dot(support.low, view.axis), dot(support.high, view.axis)) * count - 0.5;
    // At the ends of a support there is nothing, but at the faces of the box.
    return vec2<u32>(clamp(vec2<f32>(ceil(ends.x + 1e-3), floor(ends.y - 1e-3) + 1.0), vec2<f32>(0.0), vec2<f32>(count)));
}

/// Whether only rays that cross their slice whole have samples in the support.
fn only_whole_slices(view: SliceView, support: Support) -> bool {
    return all(support.low >= view.margin * (1.0 - view.axis)) && all(support.high <= 1.0 - view.margin * (1.0 - view.axis));
}

/// Of a slice's middle plane where rays cross it, as seen from a voxel. For each pixel (x, y) the sum first + x right + y down has the two offsets
/// across the slice from the voxel's middle, in voxels, times the third number.
struct Crossings {
    /// At the pixel (0, 0).
    first: vec3<f32>,
    /// What a pixel to the right adds.
    right: vec3<f32>,
    /// What a pixel down adds.
    down: vec3<f32>,
    /// Weight of the voxel's triangle function along the axis.
    weight: f32,
}

/// A vector's two components across an axis.
fn across_axis(axis: vec3<f32>, vector: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(dot(axis.zxy, vector), dot(axis.yzx, vector));
}

/// Where rays cross a slice. Rays share their origin or their direction, so products of what changes of both vanish.
fn crossings_of_slice(view: SliceView, voxel: vec3<u32>, size: vec3<u32>, slice: u32) -> Crossings {
    let middle = (f32(slice) + 0.5) / f32(view.slices);
    let origin = view.origin + 0.5 * (view.origin_right + view.origin_down);
    let direction = view.direction + 0.5 * (view.direction_right + view.direction_down);
    let until = middle - dot(origin, view.axis);
    let speeds = vec3<f32>(
        dot(direction, view.axis),
        dot(view.direction_right, view.axis),
        dot(view.direction_down, view.axis)
    );
    let scale = across_axis(view.axis, vec3<f32>(size));
    let less = across_axis(view.axis, vec3<f32>(voxel)) + 0.5;
    let first = across_axis(view.axis, origin * speeds.x + until * direction);
    let right = across_axis(view.axis, origin * speeds.y + view.origin_right * speeds.x
        + until * view.direction_right - dot(view.origin_right, view.axis) * direction);
    let down = across_axis(view.axis, origin * speeds.z + view.origin_down * speeds.x
        + until * view.direction_down - dot(view.origin_down, view.axis) * direction);
    let height = triangle_weights(vec3<f32>(middle), voxel, size);
    return Crossings(
        vec3<f32>(first * scale - less * speeds.x, speeds.x),
        vec3<f32>(right * scale - less * speeds.y, speeds.y),
        vec3<f32>(down * scale - less * speeds.z, speeds.z),
        dot(height, view.axis)
    );
}

/// Weight of a voxel's triangle function where a pixel's ray crosses a slice; not for voxels at faces of the box.
fn crossing_weight(crossings: Crossings, pixel: vec2<f32>) -> f32 {
    // In this order compilers take what stays in a row out of its loop.
    let place = (crossings.first + pixel.y * crossings.down) + pixel.x * crossings.right;
    let weights = max(vec2<f32>(1.0) - abs(place.xy * (1.0 / place.z)), vec2<f32>(0.0));
    return weights.x * weights.y * crossings.weight;
}

/// Pixels whose middles lie in a part of the picture: first column and row, and the last ones; none where the first are greater.
fn pixels_between(view: SliceView, begin: vec2<f32>, end: vec2<f32>) -> vec4<i32> {
    let last = vec2<f32>(f32(view.width), f32(view.height)) - 1.0;
    let first_seen = clamp(ceil(begin - 0.51), vec2<f32>(0.0), last + 1.0);
    return vec4<i32>(vec4<f32>(first_seen, clamp(floor(end - 0.49), vec2<f32>(-1.0), last)));
}

/// Pixels whose rays may cross a slice's middle plane in a support, where the plane is before the eye.
fn pixels_of_plane(view: SliceView, support: Support, slice: u32) -> vec4<i32> {
    let across = vec3<f32>(1.0) - view.axis;
    let low = support.low * across + view.axis * (f32(slice) + 0.5) / f32(view.slices);
    let sides = (support.high - support.low) * across;
    let one = sides * view.axis.yzx;
    let other = sides * view.axis.zxy;
    let first = vec3<f32>(dot(view.column_of, vec4<f32>(low, 1.0)), dot(view.row_of, vec4<f32>(low, 1.0)), dot(view.divisor_of, vec4<f32>(low, 1.0)));
    let right = vec3<f32>(dot(view.column_of.xyz, one), dot(view.row_of.xyz, one), dot(view.divisor_of.xyz, one));
    let down = vec3<f32>(dot(view.column_of.xyz, other), dot(view.row_of.xyz, other), dot(view.divisor_of.xyz, other));
    let a = first.xy / max(first.z, 1e-20);
    let b = (first.xy + right.xy) / max(first.z + right.z, 1e-20);
    let c = (first.xy + down.xy) / max(first.z + down.z, 1e-20);
    let d = (first.xy + right.xy + down.xy) / max(first.z + right.z + down.z, 1e-20);
    // A plane that reaches behind the eye may be seen anywhere.
    let behind = first.z + min(right.z, 0.0) + min(down.z, 0.0) <= 1e-6;
    let seen = pixels_between(view, min(min(a, b), min(c, d)), max(max(a, b), max(c, d)));
    return select(seen, vec4<i32>(0, 0, i32(view.width) - 1, i32(view.height) - 1), behind);
}

/// Pixels whose rays may have a sample of a slice in a support.
fn pixels_of_slice(view: SliceView, support: Support, slice: u32) -> vec4<i32> {
    let across = vec3<f32>(1.0) - view.axis;
    let sides = vec2<f32>(f32(slice), f32(slice + 1u)) / f32(view.slices);
    let low = support.low * across + view.axis * sides.x;
    let high = support.high * across + view.axis * sides.y;
    var begin = vec2<f32>(3e38);
    var end = vec2<f32>(-3e38);
    var nearest = 3e38;
    for (var corner = 0u; corner < 8u; corner++) {
        let upper = (vec3<u32>(corner, corner >> 1u, corner >> 2u) & vec3<u32>(1u)) == vec3<u32>(1u);
        let point = vec4<f32>(select(low, high, upper), 1.0);
        let divisor = dot(view.divisor_of, point);
        nearest = min(nearest, divisor);
        let pixel = vec2<f32>(dot(view.column_of, point), dot(view.row_of, point)) / max(divisor, 1e-20);
        begin = min(begin, pixel);
        end = max(end, pixel);
    }
    // A box that reaches behind the eye may be seen anywhere.
    return select(
        pixels_between(view, begin, end),
        vec4<i32>(0, 0, i32(view.width) - 1, i32(view.height) - 1),
        nearest <= 1e-6
    );
}
