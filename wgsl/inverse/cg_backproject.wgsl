// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::cg_backproject
// summary: Which pixels and slices a voxel collects from when a picture is projected back into the volume.
// source: Klehm, "Stylized scattering", thesis, 7.4.1: the transpose of rendering.
// note: The thesis scatters from pixels to voxels, with additions that race. Here each voxel collects from the few pixels whose samples its
// note: basis function reaches, always in the same order. A sample lies on the middle plane of its slice: of rays that cross the slice whole where
// note: they cross that plane, of others beside a point of the slice. So a pixel with a sample in a support has its middle in the projection of
// note: the support on that plane, or of its extrusion over the slice; the projection of a box lies within that of its corners.

#import airlight::inverse::slice_steps::SliceView

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
    let count = f32(view.slices);
    let ends = vec2<f32>(dot(support.low, view.axis), dot(support.high, view.axis)) * count - 0.5;
    // At the ends of a support there is nothing, but at the faces of the box.
    return vec2<u32>(clamp(vec2<f32>(ceil(ends.x + 1e-3), floor(ends.y - 1e-3) + 1.0), vec2<f32>(0.0), vec2<f32>(count)));
}

/// Whether only rays that cross their slice whole have samples in the support.
fn only_whole_slices(view: SliceView, support: Support) -> bool {
    return all(support.low >= view.margin * (1.0 - view.axis)) && all(support.high <= 1.0 - view.margin * (1.0 - view.axis));
}

/// First column and row, and the last ones, of pixels whose rays may have a sample of a slice in a support; none where the first are greater.
/// `whole`: whether all these rays cross the slice whole, so that their samples are where they cross its middle plane.
fn pixels_of_slice(view: SliceView, support: Support, slice: u32, whole: bool) -> vec4<i32> {
    let across = vec3<f32>(1.0) - view.axis;
    let sides = (f32(slice) + select(vec2<f32>(0.0, 1.0), vec2<f32>(0.5), whole)) / f32(view.slices);
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
    let last = vec2<f32>(f32(view.width), f32(view.height)) - 1.0;
    // A box that reaches behind the eye may be seen anywhere.
    let anywhere = nearest <= 1e-6;
    let first_seen = clamp(ceil(begin - 0.51), vec2<f32>(0.0), last + 1.0);
    let last_seen = clamp(floor(end - 0.49), vec2<f32>(-1.0), last);
    return vec4<i32>(vec4<f32>(
        select(first_seen, vec2<f32>(0.0), anywhere),
        select(last_seen, last, anywhere)
    ));
}
