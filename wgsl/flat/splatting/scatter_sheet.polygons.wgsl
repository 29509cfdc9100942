// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/scatter_sheet, permutation polygons (POLYGONS)
// summary: The light before the first sheet, and what each sheet leaves of it and scatters on; with BACK also what comes back.
// source: Zhang and Crawfis, 3.1, Eq. 3 to 5, and 4.1 steps 6 and 21; sheets added up as by Stokes.
// note: Dispatch make_kernels over the sheets and begin_light over the light buffer; then for each sheet, after its picture,
// note: scatter_rows and scatter_columns, indirectly: a sheet without splats runs nothing. The light adds up in 32 bits; the
// note: texture is for filtered reads. What leaves the buffer at its edges is lost.
// note: With BACK, D goes on and U comes back: D[k + 1] = t D[k] + r U[k + 1], U[k] = t U[k + 1] + r D[k], where t and r
// note: convolve what they scatter. First clear the stored sheets, and dispatch keep_sheet for each sheet that has splats. Then, in
// note: each sweep, begin_down, down_rows and down_columns for each sheet from the first on, begin_up with the last sheet bound, up_rows
// note: and up_columns for each from the last back, all directly. After one sweep U has turned once, as in the paper; after four it is
// note: within one percent of the exact sum. Then begin_light and so on, with light_behind for each sheet before its picture, so
// note: that D meets U once more.
// note: A stored sheet has one light, D after the way down and U after the way up: either pass reads the other's before it writes its own.
// note: Light of a spot is kept without its fall-off; so texels count the same wherever they lie, and spread like it.
// note: With POLYGONS a texel has no light of its own behind the first surface on its ray; what is scattered into it stays. Surfaces
// note: send nothing back. Dispatch directly: surfaces may lie in sheets without splats.
// definition POLYGONS: light ends at the first surface along its ray.
// binding light_camera: the light as a camera.
// binding light: the light.
// binding sheets: the sheets.
// binding lighting: extinction and phase function.
// binding scattering: cones and free path.
// binding number: which sheet.
// binding light_sheet: mean values of the sheet along the light rays, rgba16float.
// binding transfer: finite colour, which is the albedo, and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding left: the light on its way, linear RGB, a vector a texel of the light buffer, row after row.
// binding rows: what is scattered, convolved along rows: on, and the share that goes through; with BACK, behind these, back.
// binding kernels: out of make_kernels, four of each sheet: along x and y of light scattered on, and of light scattered back.
// binding shadow: out, the light on its way, rgba16float.
// binding light_heights: with POLYGONS only, of the first surface along each light ray, along the normal of the sheets, metres; r32float.
// binding held: out with POLYGONS only, light that arrives at that surface, rgba16float.

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

/// A view ray: world-space origin in metres, unit direction.
struct Ray {
    /// Where it starts in the world, metres.
    origin: vec3<f32>,
    /// Unit vector, away from the eye.
    direction: vec3<f32>,
}

/// Normalised device coordinates of a position in pixels: (0, 0) is the top left corner of the picture.
fn ndc_from_pixel(camera: Camera, pixel: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(2.0, -2.0) * pixel / camera.viewport + vec2<f32>(-1.0, 1.0);
}

/// The view ray through `ndc`, of any camera.
fn view_ray(camera: Camera, ndc: vec2<f32>) -> Ray {
    // Values, not branches: some drivers compile a shader anew for every value of a uniform that a branch depends on.
    let parallel = camera.projection == ORTHOGRAPHIC;
    let far = camera.world_from_clip * vec4<f32>(ndc, camera.far_depth, 1.0);
    let near = camera.world_from_clip * vec4<f32>(ndc, camera.near_depth, 1.0);
    let origin = select(camera.eye, near.xyz / select(1.0, near.w, parallel), parallel);
    // With w = 0 (infinite far plane) far.xyz is the direction itself.
    return Ray(origin, normalize(far.xyz - select(camera.eye * far.w, near.xyz, parallel)));
}

/// Row `index` of a matrix, as a vector.
fn matrix_row(matrix: mat4x4<f32>, index: u32) -> vec4<f32> {
    return vec4<f32>(matrix[0][index], matrix[1][index], matrix[2][index], matrix[3][index]);
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

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

// ---- airlight::core::phase ----
// summary: Phase functions, normalised to one over the sphere.
// source: thesis 2.4, Eq. 2.11 (Henyey and Greenstein 1941).

/// 1 / (4 pi), the value of the isotropic phase function, 1/sr.
const ISOTROPIC: f32 = 0.07957747154594767;

/// The Henyey-Greenstein phase function, 1/sr. `cosine`: of the scattering angle, -1..1;
/// `g`: mean cosine, clamped to -0.999..0.999, zero is isotropic.
fn henyey_greenstein(cosine: f32, g: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    // (1 - g)^2 + 2 g (1 - cos) is 1 + g^2 - 2 g cos without the cancellation near the peak.
    let near = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let turn = 1.0 - clamp(select(-cosine, cosine, mean >= 0.0), -1.0, 1.0);
    let inverse = inverseSqrt(near + 2.0 * abs(mean) * turn);
    return ISOTROPIC * (1.0 - mean * mean) * (inverse * inverse * inverse);
}

// ---- airlight::core::transfer_function ----
// summary: What colour and opacity a value of a volume has, by a table.
// source: none; the usual 1D transfer function, dissertation on painterly volume rendering, 4.1.1.

/// Colour, linear RGB, and opacity 0..1 of a value 0..1; beyond that the end of the table. `transfer`: one row, linear RGB and
/// opacity, rgba16float or rgba8unorm; `linear_sampler`: linear, clamped to the edge.
fn classified(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    let width = f32(textureDimensions(transfer).x);
    return textureSampleLevel(transfer, linear_sampler, vec2<f32>((value * (width - 1.0) + 0.5) / width, 0.5), 0.0);
}

// ---- airlight::splatting::blur ----
// summary: Kernels of separable blurs whose weights add up to 1 and whose variance is exactly what was asked for.
// source: Variances of blurs one after the other add up; so a blur that runs for many sheets needs each to be exact.

/// Greatest variance of one blur, in squares of the distance between its taps.
const MOST_VARIANCE: f32 = 16.0;
/// Weights of a kernel: of offsets 0 to 12.
const BLUR_WEIGHTS: u32 = 13u;

/// Offset of the last tap to each side, 0..12. `variance`: in squares of the distance between taps.
fn blur_radius(variance: f32) -> u32 {
    let reach = u32(clamp(ceil(3.0 * sqrt(max(variance, 0.0))), 1.0, f32(BLUR_WEIGHTS - 1u)));
    return select(select(reach, 1u, variance <= 0.5), 0u, variance <= 0.0);
}

/// The Gaussian at an offset, 1 in the middle; a variance below 0.5 counts as that.
fn blur_bell(variance: f32, offset: u32) -> f32 {
    return exp(-0.5 * f32(offset * offset) / max(variance, 0.5));
}

/// What `blur_weight` needs to know of a variance: the sum of the taps of `blur_bell`, their own variance, and how much the parabola bends.
fn blur_sums(variance: f32) -> vec3<f32> {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    var moments = vec3<f32>(1.0, 0.0, 0.0);
    for (var offset = 1u; offset <= blur_radius(asked); offset++) {
        let square = f32(offset * offset);
        moments += 2.0 * blur_bell(asked, offset) * vec3<f32>(1.0, square, square * square);
    }
    let own = moments.y / moments.x;
    return vec3<f32>(moments.x, own, (asked - own) / max(moments.z / moments.x - own * own, 1e-6));
}

/// Weight of the tap at an offset of 0 to 12 to either side, of a kernel with `sums` by `blur_sums`; 0 beyond its radius.
fn blur_weight(variance: f32, sums: vec3<f32>, offset: u32) -> f32 {
    let asked = clamp(variance, 0.0, MOST_VARIANCE);
    let three = select(select(0.0, 0.5 * asked, offset == 1u), 1.0 - asked, offset == 0u);
    let mended = blur_bell(asked, offset) / sums.x * (1.0 + sums.z * (f32(offset * offset) - sums.y));
    return select(select(0.0, mended, offset <= blur_radius(asked)), three, asked <= 0.5);
}

// ---- airlight::splatting::sheet_shading ----
// summary: What a sheet's mean values become: extinction and colour, gradient, light that comes from the sheet to the eye.
// source: Zhang and Crawfis, 3.1 Eq. 1 and 5, 4.1 steps 16 to 20; Mueller et al., "Splatting without the blur" (1999).

/// How sheets are lit. 64 bytes.
struct SheetLighting {
    /// Radiance from all around, linear RGB.
    ambient: vec3<f32>,
    /// Extinction where the transfer function's opacity is 1, 1/m.
    extinction: f32,
    /// Mean cosine of the phase function, -0.99..0.99.
    g: f32,
    /// Share of diffuse reflection, from 0 up; with PHONG.
    diffuse: f32,
    /// Share of mirror-like reflection, from 0 up; with PHONG.
    specular: f32,
    /// Exponent of mirror-like reflection, from 1 up; with PHONG.
    shininess: f32,
}

/// Linear RGB and opacity of a sheet's mean value by a transfer function, as `classified` takes it; none of them negative.
fn sheet_matter(transfer: texture_2d<f32>, linear_sampler: sampler, value: f32) -> vec4<f32> {
    return clamp(classified(transfer, linear_sampler, value), vec4<f32>(0.0), vec4<f32>(65504.0));
}

// ---- airlight::splatting::light_scattering ----
// summary: What a sheet scatters on and back within cones about the light, and how far that spreads across the light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 3.1, Eq. 2 to 5.

/// Angle from which light counts as going aside no farther, radians: 75 degrees. The tangent has no bound at a right angle.
const STEEPEST: f32 = 1.3089969;

/// Which light counts as going along the light. 16 bytes.
struct Scattering {
    /// Half the angle of the cone of light that is scattered on, gamma_A, 0..pi radians.
    forward_cone: f32,
    /// Half the angle of the cone of light that is scattered back, gamma_B, 0..pi/2 radians.
    back_cone: f32,
    /// For how far scattered light keeps its direction, metres; 0 for the depth of the sheet.
    free_path: f32,
    reserved_a: f32,
}

/// A symmetric convolution along one axis of the light buffer. 64 bytes.
struct AxisKernel {
    /// Weights at the distances of 0 to 12 texels, four a vector; then two zeros and the greatest distance that has a weight.
    weights: array<vec4<f32>, 4>,
}

/// What a sheet does with light that arrives at it: shares, linear RGB where they are three.
struct SheetOptics {
    /// That goes through without being scattered.
    transmitted: f32,
    /// That is scattered on within the forward cone.
    forward: vec3<f32>,
    /// That is scattered back within the backward cone.
    back: vec3<f32>,
}

/// Share of the light that the Henyey-Greenstein phase function scatters within a cone about the light's direction. `g`: mean
/// cosine; `cone`: half its angle, radians. Free of the quotient of small numbers that the usual form has near g = 0.
fn cone_share(g: f32, cone: f32) -> f32 {
    let mean = clamp(g, -0.999, 0.999);
    let half_sine = sin(0.5 * clamp(cone, 0.0, 3.14159265));
    let opening = 2.0 * half_sine * half_sine;
    // sqrt(1 + g^2 - 2 g cos), without the cancellation at the peak on either side.
    let least = (1.0 - abs(mean)) * (1.0 - abs(mean));
    let root = sqrt(least + 2.0 * abs(mean) * select(2.0 - opening, opening, mean >= 0.0));
    return clamp((1.0 + mean) * opening / ((root + 1.0 - mean) * root), 0.0, 1.0);
}

/// Shares of scattered light that go on, f, and back, b, within the cones; both together at most 1. `g`: mean cosine.
fn cone_shares(scattering: Scattering, g: f32) -> vec2<f32> {
    let forward = cone_share(g, scattering.forward_cone);
    return vec2<f32>(forward, min(cone_share(-g, scattering.back_cone), 1.0 - forward));
}

/// Mean of the squared tangent of the scattering angle over the light within a cone; beyond STEEPEST that of STEEPEST. `g`: mean
/// cosine, of light that goes back the negative of it; `cone`: half its angle, radians.
fn mean_square_slope(g: f32, cone: f32) -> f32 {
    const STEPS: f32 = 96.0;
    let end = clamp(cone, 0.0, 3.14159265);
    var sum = 0.0;
    for (var i = 0.5; i < STEPS; i += 1.0) {
        // Midpoints that lie closer at both ends, where phase functions peak.
        let unit = i / STEPS;
        let angle = end * unit * unit * (3.0 - 2.0 * unit);
        let slope = tan(min(angle, STEEPEST));
        sum += henyey_greenstein(cos(angle), g) * sin(angle) * slope * slope * unit * (1.0 - unit);
    }
    return sum * (12.0 * 3.14159265 / STEPS) * end / max(cone_share(g, cone), 1e-12);
}

/// Variance along either axis across the light of where scattered light goes on, metres^2. `metres`: of the light's way through the
/// sheet; `square_slope`: see `mean_square_slope`.
fn spread_variance(scattering: Scattering, metres: f32, square_slope: f32) -> f32 {
    let reach = max(scattering.free_path, metres);
    return reach * reach * square_slope / 6.0;
}

/// Texels of the light buffer along x and y that a metre across the light ray through a point of the world covers there. Light buffers
/// may lie askew to their rays.
fn texels_per_metre(light_camera: Camera, point: vec3<f32>) -> vec2<f32> {
    let clip = light_camera.clip_from_world * vec4<f32>(point, 1.0);
    let w = max(abs(clip.w), 1e-6);
    let ndc = clip.xy / w;
    let last = matrix_row(light_camera.clip_from_world, 3u).xyz;
    // Gradients of the texel over the world: along a ray the texel stays, so they lie across it.
    let x = matrix_row(light_camera.clip_from_world, 0u).xyz - ndc.x * last;
    let y = matrix_row(light_camera.clip_from_world, 1u).xyz - ndc.y * last;
    return 0.5 * light_camera.viewport * vec2<f32>(length(x), length(y)) / w;
}

/// A kernel of a variance in texels^2 as of `splatting/blur`, which has a greatest one: of a greater variance that is what remains.
fn axis_kernel(variance: f32) -> AxisKernel {
    let radius = blur_radius(variance);
    let sums = blur_sums(variance);
    var weights = array<vec4<f32>, 4>(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    for (var offset = 0u; offset <= radius; offset++) {
        weights[offset >> 2u][offset & 3u] = blur_weight(variance, sums, offset);
    }
    weights[3].w = f32(radius);
    return AxisKernel(weights);
}

/// What a sheet does with light. `optical_depth`: along the light, from 0 up; `albedo`: linear RGB, above 1 counts as 1;
/// `shares`: see `cone_shares`.
fn sheet_optics(optical_depth: f32, albedo: vec3<f32>, shares: vec2<f32>) -> SheetOptics {
    let transmitted = exp(-clamp(optical_depth, 0.0, 80.0));
    let scattered = clamp(albedo, vec3<f32>(0.0), vec3<f32>(1.0)) * (1.0 - transmitted);
    return SheetOptics(transmitted, scattered * shares.x, scattered * shares.y);
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

/// Heights at which a sheet begins and ends, metres; `index`: from 0, the sheet nearest to the light.
fn sheet_heights(sheets: Sheets, index: u32) -> vec2<f32> {
    let begin = sheets.first + f32(index) * sheets.thickness;
    return vec2<f32>(begin, sheets.first + f32(index + 1u) * sheets.thickness);
}

/// Metres that a ray of unit `direction` passes within a sheet.
fn metres_in_sheet(sheets: Sheets, direction: vec3<f32>) -> f32 {
    return sheets.thickness / max(abs(dot(sheets.normal, direction)), LEAST_COSINE);
}

/// The mean value of a texel of a sheet, from 0 up: the sum of values that were added by `in_exact_parts`.
fn sheet_mean(texel: vec4<f32>) -> f32 {
    return max(dot(texel.xyz, vec3<f32>(1.0, 1.0 / 512.0, 1.0 / 16384.0)), 0.0);
}

// ---- splatting/scatter_sheet ----

@group(0) @binding(0) var<uniform> light_camera: Camera;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sheets: Sheets;
@group(0) @binding(3) var<uniform> lighting: SheetLighting;
@group(0) @binding(4) var<uniform> scattering: Scattering;
@group(0) @binding(5) var<uniform> number: SheetNumber;
@group(0) @binding(6) var light_sheet: texture_2d<f32>;
@group(0) @binding(7) var transfer: texture_2d<f32>;
@group(0) @binding(8) var linear_sampler: sampler;
@group(0) @binding(9) var<storage, read_write> left: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read_write> rows: array<vec4<f32>>;
@group(0) @binding(11) var<storage, read_write> kernels: array<AxisKernel>;
@group(0) @binding(12) var shadow: texture_storage_2d<rgba16float, write>;
@group(0) @binding(16) var light_heights: texture_2d<f32>;
@group(0) @binding(17) var held: texture_storage_2d<rgba16float, write>;

/// Threads of a workgroup along x and y.
const TILE: vec2<u32> = vec2<u32>(16u, 8u);
/// Room for a row of a tile and what its kernel reaches on both sides.
const REACH: u32 = 40u;

/// The picture is on its way, sheet by sheet.
const PICTURE: u32 = 0u;
/// A sweep goes down, away from the light.
const DOWN: u32 = 1u;
/// A sweep goes up.
const UP: u32 = 2u;

/// Light scattered on the way that it goes, and the share that goes through, of the texels of a tile and around it.
var<workgroup> ahead: array<vec4<f32>, 320>;

/// Place of a texel in the buffers.
fn place_of(texel: vec2<u32>) -> u32 {
    return min(texel.y * textureDimensions(shadow).x + texel.x, arrayLength(&left) - 1u);
}

/// What may be stored in half floats.
fn storable(color: vec3<f32>) -> vec3<f32> {
    return clamp(color, vec3<f32>(0.0), vec3<f32>(65504.0));
}

@compute @workgroup_size(64)
fn make_kernels(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= min(sheets.count, arrayLength(&kernels) / 4u) {
        return;
    }
    let heights = sheet_heights(sheets, id.x);
    let ray = view_ray(light_camera, vec2<f32>(0.0));
    let climb = max(dot(sheets.normal, ray.direction), LEAST_COSINE);
    let along = (0.5 * (heights.x + heights.y) - dot(sheets.normal, ray.origin)) / climb;
    let texels = texels_per_metre(light_camera, ray.origin + ray.direction * along);
    let metres = metres_in_sheet(sheets, ray.direction);
    let on = texels * texels * spread_variance(scattering, metres, mean_square_slope(lighting.g, scattering.forward_cone));
    kernels[min(4u * id.x, arrayLength(&kernels) - 1u)] = axis_kernel(on.x);
    kernels[min(4u * id.x + 1u, arrayLength(&kernels) - 1u)] = axis_kernel(on.y);
    let back = texels * texels * spread_variance(scattering, metres, mean_square_slope(-lighting.g, scattering.back_cone));
    kernels[min(4u * id.x + 2u, arrayLength(&kernels) - 1u)] = axis_kernel(back.x);
    kernels[min(4u * id.x + 3u, arrayLength(&kernels) - 1u)] = axis_kernel(back.y);
}

/// The light at a texel before the first sheet; linear RGB.
fn light_before(texel: vec2<u32>) -> vec3<f32> {
    let all = max(light.radiance, vec3<f32>(0.0));
    let surface = textureLoad(light_heights, texel, 0).x;
    return select(all, vec3<f32>(0.0), surface < sheets.first);
}

@compute @workgroup_size(16, 8)
fn begin_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let color = light_before(id.xy);
    left[place_of(id.xy)] = vec4<f32>(color, 1.0);
    textureStore(shadow, id.xy, vec4<f32>(storable(color), 1.0));
    textureStore(held, id.xy, vec4<f32>(storable(light.radiance), 1.0));
}

/// What the sheet does at a texel, of its mean value. `shares`: of the cones.
fn optics_of(texel: vec2<u32>, mean: f32, shares: vec2<f32>) -> SheetOptics {
    let ray = view_ray(light_camera, ndc_from_pixel(light_camera, vec2<f32>(texel) + 0.5));
    let matter = sheet_matter(transfer, linear_sampler, mean);
    let optical_depth = lighting.extinction * matter.a * metres_in_sheet(sheets, ray.direction);
    return sheet_optics(optical_depth, matter.rgb, shares);
}

/// Convolves what a tile of the sheet scatters along rows. `corner`: the tile's first texel; `local`: of the thread.
fn convolve_rows(corner: vec2<u32>, local: vec2<u32>, stage: u32) {
    let size = textureDimensions(shadow);
    let kernel = min(4u * number.index, arrayLength(&kernels) - 4u);
    var asked = u32(kernels[min(kernel, arrayLength(&kernels) - 1u)].weights[3].w);
    let radius = min(asked, BLUR_WEIGHTS - 1u);
    let width = TILE.x + 2u * radius;
    let shares = cone_shares(scattering, lighting.g);
    for (var i = local.y * TILE.x + local.x; i < width * TILE.y; i += TILE.x * TILE.y) {
        let column = i % width;
        let texel = vec2<u32>(corner.x + column - radius, corner.y + i / width);
        // To the left of the buffer the number wraps and is too great as well.
        let inside = all(texel < size);
        var sent = SheetOptics(0.0, vec3<f32>(0.0), vec3<f32>(0.0));
        if inside {
            let place = place_of(texel);
            let color = left[place].rgb;
            let mean = sheet_mean(textureLoad(light_sheet, texel, 0));
            sent = optics_of(texel, mean, shares);
            let forward = sent.forward * color;
            let surface = textureLoad(light_heights, texel, 0).x;
            let heights = sheet_heights(sheets, number.index);
            let ahead_of_it = surface >= heights.x;
            let own_texel = column >= radius && column < radius + TILE.x;
            if stage == PICTURE && ahead_of_it && own_texel {
                textureStore(held, texel, vec4<f32>(storable(sent.transmitted * color + forward), 1.0));
            }
            let ends = ahead_of_it && surface < heights.y;
            sent.transmitted = select(sent.transmitted, 0.0, ends);
            sent.forward = select(forward, vec3<f32>(0.0), ends);
        }
        let slot = (i / width) * REACH + column;
        ahead[slot] = vec4<f32>(sent.forward, sent.transmitted);
    }
    workgroupBarrier();
    let texel = corner + local;
    if any(texel >= size) {
        return;
    }
    let middle = local.y * REACH + local.x + radius;
    var sum = kernels[min(kernel, arrayLength(&kernels) - 1u)].weights[0].x * ahead[middle].rgb;
    for (var i = 1u; i <= radius; i++) {
        sum += kernels[min(kernel, arrayLength(&kernels) - 1u)].weights[i >> 2u][i & 3u] * (ahead[middle - i].rgb + ahead[middle + i].rgb);
    }
    let place = place_of(texel);
    rows[min(place, arrayLength(&rows) - 1u)] = vec4<f32>(sum, ahead[middle].a);
}

/// The light behind the sheet at a texel, on the way that it goes: what goes through, and what is scattered, convolved along columns.
fn convolved_columns(texel: vec2<u32>) -> vec3<f32> {
    let size = textureDimensions(shadow);
    let kernel = min(4u * number.index, arrayLength(&kernels) - 4u);
    let place = place_of(texel);
    let middle = rows[min(place, arrayLength(&rows) - 1u)];
    var sum = middle.w * left[place].rgb + kernels[min(kernel + 1u, arrayLength(&kernels) - 1u)].weights[0].x * middle.rgb;
    let radius = min(u32(kernels[min(kernel + 1u, arrayLength(&kernels) - 1u)].weights[3].w), BLUR_WEIGHTS - 1u);
    for (var i = 1u; i <= radius; i++) {
        let weight = kernels[min(kernel + 1u, arrayLength(&kernels) - 1u)].weights[i >> 2u][i & 3u];
        if texel.y >= i {
            sum += weight * rows[min(place - i * size.x, arrayLength(&rows) - 1u)].rgb;
        }
        if texel.y + i < size.y {
            sum += weight * rows[min(place + i * size.x, arrayLength(&rows) - 1u)].rgb;
        }
    }
    return sum;
}

@compute @workgroup_size(16, 8)
fn scatter_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    convolve_rows(group.xy * TILE, local.xy, PICTURE);
}

@compute @workgroup_size(16, 8)
fn scatter_columns(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let color = convolved_columns(id.xy);
    left[place_of(id.xy)] = vec4<f32>(color, 1.0);
    textureStore(shadow, id.xy, vec4<f32>(storable(color), 1.0));
}
