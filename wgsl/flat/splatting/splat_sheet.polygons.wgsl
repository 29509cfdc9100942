// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/splat_sheet, permutation polygons (POLYGONS)
// summary: Adds up the splats of a sheet: the mean value of the volume along each ray's way through it.
// source: Zhang and Crawfis, 4.1, steps 12 to 15 and Fig. 7.
// note: Drawn indirectly, an instance of six vertices a splat, added to a cleared rgba16float target; with the
// note: eye's camera for the picture and with the light's for its shadows. Depth does not clip. Splats around the eye are left out.
// note: Values are added in parts that half floats hold exactly: software adapters cut half floats off when they blend, which
// note: would lose up to three percent.
// note: With POLYGONS sections end at a surface, and the mean stays that of the whole way through the sheet.
// definition POLYGONS: what lies behind a surface is left out.
// binding camera: the eye's camera or the light's.
// binding volume: the volume.
// binding sheets: the sheets.
// binding kernel: the kernel.
// binding number: which sheet.
// binding splats: the splats.
// binding order: numbers of splats, sorted by the first sheet that they reach; not with SCANNING.
// binding ranges: of each sheet its stretch of the order; not with SCANNING.
// binding heights: of the first surface along each ray, along the normal of the sheets, metres, NO_SURFACE where there is none, r32float; with
// binding heights: POLYGONS only.

// ---- airlight::core::camera ----
// summary: View rays, distances and frustum planes from a camera's matrices, for any depth convention.
// source: homogeneous unprojection; planes after Gribb and Hartmann, "Fast extraction of viewing frustum planes" (2001).

/// Orthographic projection: view rays are parallel and leave the near plane.
const ORTHOGRAPHIC: u32 = 1u;

/// A camera, as an engine hands it over. 160 bytes.
struct Camera {
    /// View-projection matrix, world to clip.
    clip_from_world: mat4x4<f32>,
    /// Its inverse, clip to world.
    world_from_clip: mat4x4<f32>,
    /// Position of the eye in the world, metres; unused by an orthographic camera.
    eye: vec3<f32>,
    /// Clip depth of the near plane: 0 forward, 1 reversed.
    near_depth: f32,
    /// Width and height of the picture in pixels.
    viewport: vec2<f32>,
    /// Clip depth of the far plane: 1 forward, 0 reversed.
    far_depth: f32,
    /// PERSPECTIVE or ORTHOGRAPHIC.
    projection: u32,
}

/// Vector from `point`, metres in the world, TOWARDS the viewer, of any length: to the eye, or against the parallel
/// rays of an orthographic camera.
fn towards_viewer(camera: Camera, point: vec3<f32>) -> vec3<f32> {
    let parallel = camera.world_from_clip[2].xyz * (camera.near_depth - camera.far_depth);
    return select(camera.eye - point, parallel, camera.projection == ORTHOGRAPHIC);
}

/// Row `index` of a matrix, as a vector.
fn matrix_row(matrix: mat4x4<f32>, index: u32) -> vec4<f32> {
    return vec4<f32>(matrix[0][index], matrix[1][index], matrix[2][index], matrix[3][index]);
}

// ---- airlight::splatting::footprint ----
// summary: What a ray passes of a splat's kernel between two places, a section of its footprint.
// source: Zhang and Crawfis, 2.1 and 4.1; Mueller et al., "Splatting without the blur" (1999).

/// The kernel of all splats. 16 bytes.
struct Kernel {
    /// Standard deviation of the Gaussian, voxels.
    sigma: f32,
    /// Where the kernel ends, voxels; at most 3.5 sigma.
    radius: f32,
    /// Factor on sections, so that the kernel's integral is 1.
    scale: f32,
    /// The Gaussian at the radius.
    edge: f32,
}

/// The error function of -2.5 to 2.5, within 4e-6; beyond that the value there.
fn error_function(x: f32) -> f32 {
    let a = clamp(x, -2.5, 2.5);
    let y = a * a;
    // Minimax over the odd polynomials of degree 17.
    let high = (((1.12805427e-7 * y - 4.04915563e-6) * y + 6.64965259e-5) * y - 6.74895497e-4) * y + 4.83849545e-3;
    let low = ((high * y - 2.63637015e-2) * y + 1.12475873e-1) * y - 3.76006461e-1;
    return a * (low * y + 1.12836745);
}

/// Integral of the kernel over voxels along a ray from `begin` to `end`, both measured from where the ray comes nearest to the
/// splat's middle. `square`: of the distance there, voxels; 0 beyond the radius. 1/voxel^2.
fn footprint_section(kernel: Kernel, square: f32, begin: f32, end: f32) -> f32 {
    let inner = max(kernel.radius * kernel.radius - square, 0.0);
    let reach = sqrt(inner);
    let ends = clamp(vec2<f32>(begin, end), vec2<f32>(-reach), vec2<f32>(reach));
    let spread = 0.70710678 / kernel.sigma;
    let whole = error_function(ends.y * spread) - error_function(ends.x * spread);
    let bell = 0.88622693 / spread * exp(-square * spread * spread) * whole;
    // The tangent: edge (1 + (radius^2 - square - t^2) / (2 sigma^2)), integrated over t.
    let cubes = ends * ends * ends;
    let halved = spread * spread;
    let tangent = (1.0 + inner * halved) * (ends.y - ends.x) - halved / 3.0 * (cubes.y - cubes.x);
    return kernel.scale * max(bell - kernel.edge * tangent, 0.0);
}

// ---- airlight::splatting::sheets ----
// summary: Sheets: slabs of equal thickness one behind the other along the half-way vector between eye and light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 4.1, Fig. 5.

/// All sheets of a picture. 32 bytes.
struct Sheets {
    /// Unit normal in the world, from the side of the light on.
    normal: vec3<f32>,
    /// Where the first sheet begins: dot(normal, point), metres.
    first: f32,
    /// Of every sheet, metres, positive.
    thickness: f32,
    /// How many there are.
    count: u32,
    /// Sheets that one splat reaches at most.
    span: u32,
    /// 1 where the sheet nearest to the light is nearest to the eye as well, 0 where it is the farthest.
    front_to_back: u32,
}

/// A sheet that is drawn. 16 bytes.
struct SheetNumber {
    /// From 0, the sheet nearest to the light.
    index: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

/// Cosine between a ray and the normal below which the ray counts as no more oblique.
const LEAST_COSINE: f32 = 0.05;

/// Where a point lies along the normal, metres from the world's origin.
fn height_of(sheets: Sheets, point: vec3<f32>) -> f32 {
    return dot(sheets.normal, point);
}

/// Heights at which a sheet begins and ends, metres; `index`: from 0, the sheet nearest to the light.
fn sheet_heights(sheets: Sheets, index: u32) -> vec2<f32> {
    let begin = sheets.first + f32(index) * sheets.thickness;
    return vec2<f32>(begin, sheets.first + f32(index + 1u) * sheets.thickness);
}

/// A value as it is added up in an rgba16float target, in three parts: multiples of 2^-9, of 2^-14 in units of 2^-9, and of 2^-19 in
/// units of 2^-14. Half floats hold the sums of these exactly, up to 4 in all, so that neither the order of splats nor how
/// blending rounds makes a difference.
fn in_exact_parts(value: f32) -> vec4<f32> {
    let coarse = floor(value * 512.0 + 0.5) / 512.0;
    let rest = (value - coarse) * 512.0;
    let medium = floor(rest * 32.0 + 0.5) / 32.0;
    let fine = floor((rest - medium) * 1024.0 + 0.5) / 32.0;
    return vec4<f32>(coarse, medium, fine, 0.0);
}

// ---- airlight::splatting::splat ----
// summary: Splats: voxels above a threshold, where they lie, and the quad that covers one in a picture.
// source: Zhang and Crawfis, 2.1 and 4.1, steps 3 and 12 to 14.

/// A voxel that is drawn. 8 bytes.
struct Splat {
    /// Number of the voxel, x fastest, then y.
    voxel: u32,
    /// Its value.
    value: f32,
}

/// A volume of splats. 144 bytes.
struct SplatVolume {
    /// Voxel space to the world, metres; affine.
    world_from_voxel: mat4x4<f32>,
    /// Its inverse.
    voxel_from_world: mat4x4<f32>,
    /// Voxels along x, y and z.
    size: vec3<u32>,
    /// Voxels of no greater value are left out.
    threshold: f32,
}

/// Where voxel `index` lies in voxel space.
fn voxel_place(volume: SplatVolume, index: u32) -> vec3<f32> {
    let width = max(volume.size.x, 1u);
    let height = max(volume.size.y, 1u);
    let row = index / width;
    return vec3<f32>(f32(index - row * width), f32(row % height), f32(row / height));
}

/// The linear part of an affine matrix.
fn linear_part(matrix: mat4x4<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(matrix[0].xyz, matrix[1].xyz, matrix[2].xyz);
}

/// How far a splat of `radius` voxels reaches along a unit vector of the world, metres.
fn reach_along(volume: SplatVolume, direction: vec3<f32>, radius: f32) -> f32 {
    return radius * length(direction * linear_part(volume.world_from_voxel));
}

/// A corner of the quad that covers a splat: a point of the world, metres, in the plane through its `middle` that faces the eye.
struct QuadCorner {
    /// The point.
    point: vec3<f32>,
    /// Whether the quad is to be drawn: not where the eye is in the splat, or before it.
    visible: bool,
}

/// Corner of vertex 0..5 of the two triangles of the quad around a splat of `radius` voxels.
fn quad_around(camera: Camera, volume: SplatVolume, middle: vec3<f32>, radius: f32, vertex: u32) -> QuadCorner {
    let index = select(vertex - 2u, vertex, vertex < 3u);
    let to_viewer = towards_viewer(camera, middle);
    let distance = max(length(to_viewer), 1e-20);
    let axis = to_viewer / distance;
    // Any two directions across the axis; those of the picture keep quads tight.
    let up = matrix_row(camera.clip_from_world, 1u).xyz;
    let across = cross(up, axis);
    let right = across * inverseSqrt(max(dot(across, across), 1e-30));
    let top = cross(axis, right);
    let near = reach_along(volume, axis, radius);
    let parallel = camera.projection == ORTHOGRAPHIC;
    let before = parallel || distance > 1.25 * near;
    // What lies before the plane is seen larger.
    let larger = select(distance / max(distance - near, 0.2 * distance), 1.0, parallel);
    let sides = vec2<f32>(reach_along(volume, right, radius), reach_along(volume, top, radius)) * larger;
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    return QuadCorner(middle + right * (sides.x * corner.x) + top * (sides.y * corner.y), before);
}

// ---- airlight::splatting::surface_shadow ----
// summary: Which part of a sheet lies before a surface, and what arrives of the light at a point where surfaces block it.
// source: Zhang and Crawfis, 4.1, Fig. 6 and 7, Table 1.

/// Height where a ray meets no surface, metres.
const NO_SURFACE: f32 = 1e30;

/// Whether there is a surface at a height.
fn is_surface(height: f32) -> bool {
    return height < 0.5 * NO_SURFACE;
}

/// Heights between which a ray that climbs or descends sees a sheet, metres: up to the surface at `surface`, NO_SURFACE where there is none.
fn heights_before_surface(sheets: Sheets, index: u32, climbs: bool, surface: f32) -> vec2<f32> {
    let heights = sheet_heights(sheets, index);
    let cut = select(max(heights, vec2<f32>(surface)), min(heights, vec2<f32>(surface)), climbs);
    return select(heights, cut, is_surface(surface));
}

// ---- splatting/splat_sheet ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> volume: SplatVolume;
@group(0) @binding(2) var<uniform> sheets: Sheets;
@group(0) @binding(3) var<uniform> kernel: Kernel;
@group(0) @binding(4) var<uniform> number: SheetNumber;
@group(0) @binding(5) var<storage, read> splats: array<Splat>;
@group(0) @binding(6) var<storage, read> order: array<u32>;
@group(0) @binding(7) var<storage, read> ranges: array<vec2<u32>>;
@group(0) @binding(8) var heights: texture_2d<f32>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    /// From the splat's middle, voxels.
    @location(0) offset: vec3<f32>,
    /// Along the ray, voxels, of any length.
    @location(1) along: vec3<f32>,
    /// Heights of the sheet's ends above the splat's middle, metres; its value; height of the middle.
    @location(2) @interpolate(flat) section: vec4<f32>,
}

/// The splat that instance `instance` draws.
fn drawn_splat(instance: u32) -> Splat {
    let range = ranges[min(number.index, arrayLength(&ranges) - 1u)];
    let place = min(range.x + instance, arrayLength(&order) - 1u);
    return splats[min(order[place], arrayLength(&splats) - 1u)];
}

@vertex
fn vertex_splat(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    let splat = drawn_splat(instance);
    let middle = (volume.world_from_voxel * vec4<f32>(voxel_place(volume, splat.voxel), 1.0)).xyz;
    let height = height_of(sheets, middle);
    let ends = sheet_heights(sheets, number.index) - height;
    let reach = reach_along(volume, sheets.normal, kernel.radius);
    let quad = quad_around(camera, volume, middle, kernel.radius, vertex);
    let touches = quad.visible && ends.x < reach && ends.y > -reach;
    let clip = camera.clip_from_world * vec4<f32>(quad.point, 1.0);
    // Anywhere between the planes: depth does not clip, and a quad beside the picture draws nothing.
    let shown = vec4<f32>(clip.xy, 0.5 * clip.w, clip.w);
    let linear = linear_part(volume.voxel_from_world);
    return Corner(
        select(vec4<f32>(2.0, 2.0, 0.5, 1.0), shown, touches),
        linear * (quad.point - middle),
        linear * -towards_viewer(camera, quad.point),
        vec4<f32>(ends, splat.value, height)
    );
}

@fragment
fn fragment_splat(corner: Corner) -> @location(0) vec4<f32> {
    let direction = corner.along * inverseSqrt(max(dot(corner.along, corner.along), 1e-30));
    let nearest = corner.offset - direction * dot(corner.offset, direction);
    let slope = sheets.normal * linear_part(volume.world_from_voxel);
    let climb = dot(slope, direction);
    let least = LEAST_COSINE * length(slope);
    let steep = select(min(climb, -least), max(climb, least), climb >= 0.0);
    var ends = corner.section.xy;
    // What lies behind the eye is not seen.
    let beyond = dot(corner.offset, direction) - length(corner.along);
    let eye = select(beyond, -1e30, camera.projection == ORTHOGRAPHIC);
    let surface = textureLoad(heights, vec2<u32>(corner.clip.xy), 0).x;
    let seen = heights_before_surface(sheets, number.index, climb >= 0.0, surface);
    ends = seen - corner.section.w;
    let places = (ends - dot(slope, nearest)) / steep;
    let section = footprint_section(
        kernel, dot(nearest, nearest), max(min(places.x, places.y), eye), max(max(places.x, places.y), eye)
    );
    return in_exact_parts(min(corner.section.z * section * abs(steep) / sheets.thickness, 4.0));
}
