// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::inverse::slice_steps
// summary: View rays in steps from slice to slice of a volume's box; a picture and its back-projection take the same.
// source: thesis 7.4.1 and Listing 7.1; slices along the main axis after Joseph (1982).
// note: The listing lacks the length of a step and has the wrong sign in the exponent: a step of length d through extinction s takes up
// note: 1 - exp(-s d). Here the steps of one ray add up to its way in the box, the last one before a surface too, so that the weights
// note: of a ray add up to 1 - transmittance.
// note: A sample lies on its slice's middle plane: where a ray crosses it, or, of a ray that enters or ends within the slice, beside the middle of
// note: what it has of the slice.
// note: All positions are in unit space: the box 0..1 of the volume.
// equation: ray(p) = (o + x o_right + y o_down) + t (d + x d_right + y d_down);  slice k: k / n ≤ axis · x < (k + 1) / n
// equation: weights of a ray: T_k (1 − exp(−σ_k d_k)),  T_k = exp(−Σ_(i<k) σ_i d_i);  Σ = 1 − T
// error: pictures within 1e-3 of the f64 matrix; test inverse/projection::pictures_are_products_with_a_matrix_and_back_projections_with_its_transpose.
// parameter pixel: position in the picture, pixels.
// parameter limit: metres, from 0 up.
// parameter span: part of the ray in the box, in lengths of its direction.
// parameter step: number of the step, first .. end - 1 of the walk.
// parameter slice: number, 0 .. slices - 1.

/// Most slices of a volume.
const MOST_SLICES: u32 = 4096u;
/// Most steps of any bent ray.
const MOST_RAY_STEPS: u32 = 65536u;

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

/// Steps of rays. 16 bytes.
struct RaySteps {
    /// Length of a step of a bent ray, metres, above 0.
    metres: f32,
    /// Most steps of a bent ray, 0..MOST_RAY_STEPS.
    most: u32,
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

/// The slices of a ray, nearest first: steps count from `first` to before `end`.
struct SliceWalk {
    /// The first slice from the low side of the axis.
    first: u32,
    /// The one past the last.
    end: u32,
    /// Whether the nearest is the first.
    climbs: bool,
}

/// First slice of a ray's span and the one past the last, from the low side of the axis.
fn slices_of(view: SliceView, ray: SliceRay, span: vec2<f32>) -> vec2<u32> {
    let ends = dot(ray.origin, view.axis) + dot(ray.direction, view.axis) * span;
    let count = f32(min(view.slices, MOST_SLICES));
    // One more to each side: an end that rounding has put into the neighbour.
    let low = clamp(floor(min(ends.x, ends.y) * count - 0.01), 0.0, count);
    let high = clamp(ceil(max(ends.x, ends.y) * count + 0.01), low, count);
    return select(vec2<u32>(0u), vec2<u32>(vec2<f32>(low, high)), span.y > span.x);
}

/// The slices of a ray's span in its order.
fn slice_walk(view: SliceView, ray: SliceRay, span: vec2<f32>) -> SliceWalk {
    let slices = slices_of(view, ray, span);
    return SliceWalk(slices.x, slices.y, dot(ray.direction, view.axis) >= 0.0);
}

/// The slice of a step.
fn slice_of_step(walk: SliceWalk, step: u32) -> u32 {
    return select(walk.end - 1u - (step - walk.first), step, walk.climbs);
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

/// Metres that a ray has of a slice that it crosses whole within the box.
fn whole_slice_metres(view: SliceView, ray: SliceRay) -> f32 {
    let speed = abs(dot(ray.direction, view.axis)) * f32(view.slices);
    return select(ray.metres / max(speed, 1e-30), 0.0, speed == 0.0);
}
