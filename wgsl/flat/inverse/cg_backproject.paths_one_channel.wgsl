// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: inverse/cg_backproject, permutation paths_one_channel (PATHS)
// summary: Projects a picture back into the volume: the product with the transpose of W, in which each voxel collects.
// source: thesis 7.4.1; see the module of this name.
// note: Dispatch over the voxels for each view and each group of its rows; `collected` adds up, from zero on. No additions race: results are
// note: the same bits in every run.
// definition PATHS: weights of extinction, the lengths of steps.
// binding view: the view.
// binding spans: which part of each ray lies in the volume, rg32float.
// binding rows: which rows of the picture.
// binding grid: the voxels.
// binding picture: what is projected back; with PATHS.
// binding weighed: of inverse/weigh_slices.
// binding solved: 0 where a voxel is not solved for: it stays as it is. A number a voxel, x fastest.
// binding collected: in and out, a number a voxel; four with RGB, of which the last stays as it is.

// ---- airlight::inverse::basis ----
// summary: Fields as sums of basis functions, one a voxel: triangle or box functions.
// source: thesis 7.3.1.

/// Weights along the axes of the voxel at `voxel` at a place, their product is the basis function: triangles.
fn triangle_weights(unit: vec3<f32>, voxel: vec3<u32>, size: vec3<u32>) -> vec3<f32> {
    let place = clamp(unit * vec3<f32>(size) - 0.5, vec3<f32>(0.0), vec3<f32>(size - vec3<u32>(1u)));
    return max(vec3<f32>(1.0) - abs(place - vec3<f32>(voxel)), vec3<f32>(0.0));
}

// ---- airlight::inverse::channels ----
// summary: One number or three a voxel and a pixel.
// source: none; arithmetic of one and of three is the same.

/// The channel of a texel.
fn channels_of(texel: vec4<f32>) -> f32 {
    return texel.x;
}

/// The number itself.
fn all_channels(value: f32) -> f32 {
    return value;
}

// ---- airlight::inverse::slice_steps ----
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).

/// Most slices of a volume.
const MOST_SLICES: u32 = 4096u;

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

/// Rows of a picture. 16 bytes.
struct PictureRows {
    /// From 0 at the top.
    first: u32,
    /// How many.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
}

/// Voxels of what is solved for. 16 bytes.
struct VoxelGrid {
    /// Along x, y and z, each from 1 up.
    size: vec3<u32>,
    reserved_a: u32,
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

/// What a ray has of a slice.
struct SlicePart {
    /// Its middle, moved to the middle plane of the slice.
    place: vec3<f32>,
    /// How long it is, metres; 0 where the ray has nothing of the slice.
    metres: f32,
}

/// The ray through a position in pixels; (0.5, 0.5) is the middle of the first.
fn slice_ray(view: SliceView, pixel: vec2<f32>) -> SliceRay {
    let origin = view.origin + pixel.x * view.origin_right + pixel.y * view.origin_down;
    let direction = view.direction + pixel.x * view.direction_right + pixel.y * view.direction_down;
    let metres = direction.x * view.edge_x + direction.y * view.edge_y + direction.z * view.edge_z;
    return SliceRay(origin, direction, length(metres));
}

/// What a ray has of a slice within its span.
fn slice_part(view: SliceView, ray: SliceRay, span: vec2<f32>, slice: u32) -> SlicePart {
    let speed = dot(ray.direction, view.axis);
    let start = dot(ray.origin, view.axis);
    let sides = vec2<f32>(f32(slice), f32(slice + 1u)) / f32(view.slices);
    let still = abs(speed) < 1e-20;
    let crossings = (sides - start) / select(speed, 1.0, still);
    let within = start >= sides.x && start < sides.y;
    let begin = max(span.x, select(min(crossings.x, crossings.y), select(3e38, -3e38, within), still));
    let end = min(span.y, select(max(crossings.x, crossings.y), select(-3e38, 3e38, within), still));
    let part = max(end - begin, 0.0);
    let middle = ray.origin + ray.direction * (begin + 0.5 * part);
    return SlicePart(middle + view.axis * (0.5 * (sides.x + sides.y) - dot(middle, view.axis)), part * ray.metres);
}

// ---- airlight::inverse::cg_backproject ----
// summary: Which pixels and slices a voxel collects from when a picture is projected back into the volume.
// source: thesis 7.4.1: the transpose of rendering.

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

// ---- inverse/cg_backproject ----

@group(0) @binding(0) var<uniform> view: SliceView;
@group(0) @binding(1) var spans: texture_2d<f32>;
@group(0) @binding(2) var<uniform> rows: PictureRows;
@group(0) @binding(3) var<uniform> grid: VoxelGrid;
@group(0) @binding(4) var picture: texture_2d<f32>;
@group(0) @binding(5) var weighed: texture_3d<f32>;
@group(0) @binding(6) var<storage, read> solved: array<f32>;
@group(0) @binding(7) var<storage, read_write> collected: array<f32>;

/// Pixels in the rows that are projected back, and in the picture.
fn in_rows(pixels: vec4<i32>) -> vec4<i32> {
    let first = i32(rows.first);
    let last = vec2<i32>(textureDimensions(spans)) - 1;
    let end = min(first + i32(rows.count) - 1, last.y);
    return vec4<i32>(pixels.x, max(pixels.y, first), min(pixels.z, last.x), min(pixels.w, end));
}

/// Where `weighed` has a pixel's step in a slice.
fn step_of(column: i32, row: i32, slice: u32) -> vec3<u32> {
    return vec3<u32>(u32(column), u32(row) - rows.first, 0u);
}

@compute @workgroup_size(8, 4, 4)
fn cg_backproject(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id >= grid.size) {
        return;
    }
    let index = (id.z * grid.size.y + id.y) * grid.size.x + id.x;
    if index >= arrayLength(&solved) || solved[index] == 0.0 {
        return;
    }
    var sum = all_channels(0.0);
    let support = support_of(id, grid.size, 1.0);
    let all_slices = slices_of_support(view, support);
    // Where rays cross slices whole their samples are where they cross the middle plane, which is less to work out. Loops that end at once are skipped
    // where branches that nothing takes would not be.
    let whole = only_whole_slices(view, support);
    let slices = vec2<u32>(all_slices.x, select(all_slices.y, all_slices.x, whole));
    for (var slice = slices.y; slice < select(all_slices.x, all_slices.y, whole); slice++) {
        let crossings = crossings_of_slice(view, id, grid.size, slice);
        let pixels = in_rows(pixels_of_plane(view, support, slice));
        for (var row = pixels.y; row <= pixels.w; row++) {
            for (var column = pixels.x; column <= pixels.z; column++) {
                let weight = crossing_weight(crossings, vec2<f32>(f32(column), f32(row)));
                let sent = channels_of(textureLoad(weighed, step_of(column, row, slice), 0));
                // Rays that pass beside the voxel may have no step there.
                sum += select(all_channels(0.0), weight * sent, weight > 0.0);
            }
        }
    }
    for (var slice = slices.x; slice < slices.y; slice++) {
        let pixels = in_rows(pixels_of_slice(view, support, slice));
        for (var row = pixels.y; row <= pixels.w; row++) {
            for (var column = pixels.x; column <= pixels.z; column++) {
                let pixel = vec2<u32>(u32(column), u32(row));
                let span = textureLoad(spans, pixel, 0).xy;
                let part = slice_part(view, slice_ray(view, vec2<f32>(pixel) + 0.5), span, slice);
                let weights = triangle_weights(part.place, id, grid.size);
                let weight = weights.x * weights.y * weights.z;
                sum += weight * part.metres * channels_of(textureLoad(picture, pixel, 0));
            }
        }
    }
    collected[min(index, arrayLength(&collected) - 1u)] += sum;
}
