// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/composite_sheet, permutation back_spread (BACK POLYGONS SCATTERING SPREAD)
// summary: A sheet of the volume as the eye sees it, lit through the shadow buffer, put into the picture; and the whole picture.
// source: Zhang and Crawfis, 4.1, steps 16 to 20.
// note: Dispatch composite_sheet for each sheet over the picture, indirectly: a sheet without splats runs nothing; then show_sheets.
// note: What adds up is radiance and optical depth, in 32 bits, whatever blending rounds; all zero before the first sheet.
// note: A sheet is lit by what light arrives at it: the shadow buffer as the sheets before have left it, and the mean over the
// note: sheet's own depth.
// note: With POLYGONS sheets end at surfaces, which are opaque and lie behind all that is seen of the volume: show_sheets lights them, by
// note: Phong, with what reached them. With SPREAD light gets behind surfaces as well: then sheets have to hold them, and composite_sheet is
// note: dispatched directly, since surfaces may lie in sheets without splats.
// note: With BACK, light from behind counts as going the other way, in units of the fall-off of the light.
// definition POLYGONS: there are surfaces in, before and behind the volume.
// definition SPREAD: light spreads sideways on its way, and `shadow` has none of its own behind surfaces; with POLYGONS.
// definition SCATTERING: the sheet keeps what it scatters on.
// definition BACK: light comes from behind the sheet as well; with SCATTERING.
// binding camera: the eye's camera.
// binding light_camera: the light as a camera.
// binding light: the light.
// binding sheets: the sheets.
// binding lighting: extinction, phase function and reflection.
// binding number: which sheet.
// binding sheet: mean values of the sheet along the view rays, rgba16float.
// binding light_sheet: mean values of the sheet along the light rays, rgba16float.
// binding shadow: what arrives of the light at the sheet, linear RGB, rgba16float.
// binding eye_heights: of the first surface along each view ray, metres, NO_SURFACE where there is none, r32float; with POLYGONS only.
// binding light_heights: of the first surface along each light ray, likewise, as large as `shadow`; with POLYGONS only.
// binding albedo: of the surfaces that the eye sees, linear RGB, rgba16float; with POLYGONS only.
// binding normal: of the surfaces that the eye sees, unit, to the side that is seen, rgba16float; with POLYGONS only.
// binding held: what arrived at the first surface along each light ray, linear RGB, rgba16float; with SPREAD only.
// binding surface_light: radiance of the surface that each pixel shows by light that got behind others, linear RGB, a vector a pixel, row
// binding surface_light: after row; all zero before the first sheet; with SPREAD only.
// binding scattering: cones of scattered light; with SCATTERING only.
// binding shadow_back: what arrives from behind the sheet, linear RGB, rgba16float; with BACK only.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding sum: radiance, linear RGB, and optical depth of the sheets so far, a vector a pixel, row after row.
// binding picture: out of show_sheets, radiance of all sheets, and the transmittance to what lies behind them.

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

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::core::light ----
// summary: A light, its fall-off and texture, and the clip space of its standard shadow map.
// source: thesis 4.2.1; a point source seen through a cone and softened by its radius.

/// A light at infinity: all light rays are parallel.
const DIRECTIONAL: u32 = 0u;
/// A light at a point that shines into a cone.
const SPOT: u32 = 1u;

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

/// Unit vector from `point`, metres in the world, TOWARDS the light; zero where a light at a point is right there.
fn direction_to_light(light: Light, point: vec3<f32>) -> vec3<f32> {
    let between = light.position - point;
    let local = between * inverseSqrt(max(dot(between, between), 1e-30));
    return select(local, light.direction, light.kind == DIRECTIONAL);
}

/// Angular fall-off, 0..1, along the light ray with the unit vector `towards` TOWARDS the light: of a spot 1 inside
/// the inner cone, 0 outside the outer one, smooth between; of every other light 1.
fn angular_falloff(light: Light, towards: vec3<f32>) -> f32 {
    // Not smoothstep: WGSL leaves it open what that is between two equal edges.
    let above = dot(towards, light.direction) - light.spot_cosines.y;
    let unit = clamp(above / max(light.spot_cosines.x - light.spot_cosines.y, 1e-6), 0.0, 1.0);
    return select(1.0, unit * unit * (3.0 - 2.0 * unit), light.kind == SPOT);
}

/// What `radiance` is multiplied by to give the irradiance at normal incidence of `point`, metres in the world, in clear
/// air without blockers: 1 for a directional light, else `angular_falloff` over the square of the distance in 1/m^2,
/// softened by the light's radius.
fn light_falloff(light: Light, point: vec3<f32>) -> f32 {
    let between = light.position - point;
    let square = dot(between, between) + light.radius * light.radius;
    let local = angular_falloff(light, direction_to_light(light, point)) / max(square, 1e-12);
    return select(local, 1.0, light.kind == DIRECTIONAL);
}

/// Position in texels of a map, and depth, of a point in the clip space of that map; a point at or behind the light
/// (w <= 0) is carried outside the map. `size`: of the map in texels.
fn texels_from_clip(clip: vec4<f32>, size: vec2<f32>) -> vec3<f32> {
    let before = clip.w > 0.0;
    let ndc = clip.xyz / select(1.0, clip.w, before);
    return select(vec3<f32>(-size, 0.0), vec3<f32>((ndc.xy * vec2<f32>(0.5, -0.5) + 0.5) * size, ndc.z), before);
}

/// Side of a texel of a map with the matrix `clip_from_world` where it holds `point`, metres across the light. `width`: of the map in
/// texels.
fn metres_of_texel(clip_from_world: mat4x4<f32>, width: f32, point: vec3<f32>) -> f32 {
    let growth = max((clip_from_world * vec4<f32>(point, 1.0)).w, 0.0);
    let across = vec3<f32>(clip_from_world[0].x, clip_from_world[1].x, clip_from_world[2].x);
    return 2.0 * growth / max(width * length(across), 1e-30);
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

/// Mean of exp(-x) from 0 to the optical depth: the share of light that a sheet has on average.
fn mean_transmittance(optical_depth: f32) -> f32 {
    let x = max(optical_depth, 0.0);
    // The series where the quotient would lose its digits.
    let near = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x / 720.0))));
    return select((1.0 - exp(-x)) / max(x, 0.1), near, x < 0.2);
}

/// Radiance, linear RGB, that a medium scatters to the eye, where `opacity` of the way is taken. `light`: irradiance that
/// arrives; `cosine`: between the ways of the light and of the view ray reversed, that is of the light on to the eye.
fn scattered_radiance(
    lighting: SheetLighting, albedo: vec3<f32>, opacity: f32, light: vec3<f32>, cosine: f32
) -> vec3<f32> {
    return albedo * opacity * (lighting.ambient + light * henyey_greenstein(cosine, lighting.g));
}

/// Radiance, linear RGB, of a surface in the medium by Phong, where `opacity` of the way is taken. `normal`: unit, to the outside, or
/// 0 where there is none; `to_light`, `to_eye`: unit vectors TOWARDS both; `light`: irradiance that arrives.
fn phong_radiance(
    lighting: SheetLighting, color: vec3<f32>, opacity: f32, normal: vec3<f32>, to_light: vec3<f32>,
    to_eye: vec3<f32>, light: vec3<f32>
) -> vec3<f32> {
    let facing = dot(normal, to_light);
    let mirrored = 2.0 * facing * normal - to_light;
    // pow(0, x) is fine; of a negative base it is not.
    let gloss = pow(max(dot(mirrored, to_eye), 0.0), max(lighting.shininess, 1.0));
    let lit = select(0.0, 1.0, facing > 0.0) * light * 0.31830989;
    let diffuse = color * (lighting.ambient + lit * (lighting.diffuse * max(facing, 0.0)));
    return opacity * (diffuse + lit * (lighting.specular * gloss));
}

// ---- airlight::splatting::light_scattering ----
// summary: What a sheet scatters on and back within cones about the light, and how far that spreads across the light.
// source: Zhang and Crawfis, "Light propagation for mixed polygonal and volumetric data using splatting", 3.1, Eq. 2 to 5.

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

/// What a sheet does with light. `optical_depth`: along the light, from 0 up; `albedo`: linear RGB, above 1 counts as 1;
/// `shares`: see `cone_shares`.
fn sheet_optics(optical_depth: f32, albedo: vec3<f32>, shares: vec2<f32>) -> SheetOptics {
    let transmitted = exp(-clamp(optical_depth, 0.0, 80.0));
    let scattered = clamp(albedo, vec3<f32>(0.0), vec3<f32>(1.0)) * (1.0 - transmitted);
    return SheetOptics(transmitted, scattered * shares.x, scattered * shares.y);
}

/// Share of arriving light that a sheet has on average over its depth, linear RGB, where it lets through what `optics` say: as if
/// light decayed evenly to that.
fn mean_light(optics: SheetOptics) -> vec3<f32> {
    let through = max(optics.transmitted + optics.forward, vec3<f32>(1e-35));
    return vec3<f32>(
        mean_transmittance(-log(through.x)), mean_transmittance(-log(through.y)), mean_transmittance(-log(through.z))
    );
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

/// Metres that a ray of unit `direction` passes within a sheet.
fn metres_in_sheet(sheets: Sheets, direction: vec3<f32>) -> f32 {
    return sheets.thickness / max(abs(dot(sheets.normal, direction)), LEAST_COSINE);
}

/// The mean value of a texel of a sheet, from 0 up: the sum of values that were added by `in_exact_parts`.
fn sheet_mean(texel: vec4<f32>) -> f32 {
    return max(dot(texel.xyz, vec3<f32>(1.0, 1.0 / 512.0, 1.0 / 16384.0)), 0.0);
}

// ---- airlight::splatting::surface_shadow ----
// summary: Which part of a sheet lies before a surface, and what arrives of the light at a point where surfaces block it.
// source: Zhang and Crawfis, 4.1, Fig. 6 and 7, Table 1.

/// Height where a ray meets no surface, metres.
const NO_SURFACE: f32 = 1e30;
/// Texels by which heights of one surface differ from one to the next at most, where it counts as lit: some 83 degrees from across the light.
const STEEPEST_TEXELS: f32 = 8.0;

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

/// Share of a sheet's thickness between two heights, 0..1.
fn share_of_sheet(sheets: Sheets, heights: vec2<f32>) -> f32 {
    return clamp((heights.y - heights.x) / sheets.thickness, 0.0, 1.0);
}

/// The mean over the part of a sheet before a surface, from that over all of it; `share`: of that part.
fn mean_before_surface(mean: f32, share: f32) -> f32 {
    return mean / max(share, 1e-3);
}

/// A surface's point moved off it by what a texel of the shadow buffer may be mistaken, metres. `texel`: its side there, metres; `normal`: unit,
/// to the side that is seen; `towards`: unit vector TOWARDS the light.
fn off_surface(texel: f32, point: vec3<f32>, normal: vec3<f32>, towards: vec3<f32>) -> vec3<f32> {
    return point + normal * (1.5 * texel) + towards * texel;
}

/// One of the four texels nearest to a place.
struct NearTexel {
    /// Column and row.
    texel: vec2<u32>,
    /// Share of the place, the four add up to 1.
    weight: f32,
}

/// The texel `tap`, 0 to 3, of the four nearest to a place of a map of `size`, 0..1.
fn near_texel(place: vec2<f32>, size: vec2<u32>, tap: u32) -> NearTexel {
    let last = vec2<f32>(size) - 1.0;
    let texel = clamp(place * vec2<f32>(size) - 0.5, vec2<f32>(0.0), last);
    let low = floor(texel);
    let part = texel - low;
    let step = vec2<f32>(f32(tap & 1u), f32(tap >> 1u));
    let weights = select(1.0 - part, part, step > vec2<f32>(0.5));
    return NearTexel(vec2<u32>(min(low + step, last)), weights.x * weights.y);
}

/// What arrives at a point, of the light that `reached` the first surface or what lies before it, linear RGB, and the share of it that no
/// surface blocks: of the four nearest texels those count whose surface does not lie in `range`, which ends at the point's
/// height. `heights`: r32float, of the first surface along light rays; `place`: of the point, 0..1 over both; beyond the edge it is that at the edge.
fn light_before_surfaces(
    reached: texture_2d<f32>, heights: texture_2d<f32>, place: vec2<f32>, range: vec2<f32>
) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var tap = 0u; tap < 4u; tap++) {
        let near = near_texel(place, textureDimensions(heights), tap);
        let surface = textureLoad(heights, near.texel, 0).x;
        let lit = surface < range.x || surface >= range.y;
        sum += select(0.0, near.weight, lit) * vec4<f32>(textureLoad(reached, near.texel, 0).rgb, 1.0);
    }
    return sum;
}

/// What arrives at a surface's point at `height`, of the light that `reached` the first surface along each light ray, linear RGB: over those
/// of the four nearest texels whose surface is no more than `reach` metres higher or lower. Rays that pass beside the surface have
/// gone on into the volume behind it and know nothing of the point; where no texel is near enough, the brightest counts.
fn light_on_surface(
    reached: texture_2d<f32>, heights: texture_2d<f32>, place: vec2<f32>, height: f32, reach: f32
) -> vec3<f32> {
    var sum = vec4<f32>(0.0);
    var brightest = vec3<f32>(0.0);
    for (var tap = 0u; tap < 4u; tap++) {
        let near = near_texel(place, textureDimensions(heights), tap);
        let light = textureLoad(reached, near.texel, 0).rgb;
        let own = abs(textureLoad(heights, near.texel, 0).x - height) <= reach;
        sum += select(0.0, near.weight, own) * vec4<f32>(light, 1.0);
        brightest = max(brightest, light);
    }
    return select(brightest, sum.rgb / max(sum.a, 1e-3), sum.a >= 1e-3);
}

// ---- splatting/composite_sheet ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> light_camera: Camera;
@group(0) @binding(2) var<uniform> light: Light;
@group(0) @binding(3) var<uniform> sheets: Sheets;
@group(0) @binding(4) var<uniform> lighting: SheetLighting;
@group(0) @binding(5) var<uniform> number: SheetNumber;
@group(0) @binding(7) var sheet: texture_2d<f32>;
@group(0) @binding(9) var light_sheet: texture_2d<f32>;
@group(0) @binding(10) var shadow: texture_2d<f32>;
@group(0) @binding(11) var transfer: texture_2d<f32>;
@group(0) @binding(12) var linear_sampler: sampler;
@group(0) @binding(13) var<storage, read_write> sum: array<vec4<f32>>;
@group(0) @binding(14) var picture: texture_storage_2d<rgba16float, write>;
@group(0) @binding(15) var eye_heights: texture_2d<f32>;
@group(0) @binding(16) var light_heights: texture_2d<f32>;
@group(0) @binding(17) var albedo: texture_2d<f32>;
@group(0) @binding(18) var normal: texture_2d<f32>;
@group(0) @binding(20) var<uniform> scattering: Scattering;
@group(0) @binding(21) var shadow_back: texture_2d<f32>;
@group(0) @binding(22) var held: texture_2d<f32>;
@group(0) @binding(23) var<storage, read_write> surface_light: array<vec4<f32>>;

/// Metres along a ray to a height.
fn place_at_height(ray: Ray, height: f32) -> f32 {
    let climb = dot(sheets.normal, ray.direction);
    let steep = select(min(climb, -LEAST_COSINE), max(climb, LEAST_COSINE), climb >= 0.0);
    return (height - dot(sheets.normal, ray.origin)) / steep;
}

/// Light on average over the sheet's depth: irradiance, linear RGB.
struct Arriving {
    /// From the light.
    front: vec3<f32>,
    /// From behind.
    back: vec3<f32>,
}

/// Where light through a point meets the shadow buffer, 0..1.
fn place_in_light(point: vec3<f32>) -> vec2<f32> {
    return texels_from_clip(light_camera.clip_from_world * vec4<f32>(point, 1.0), vec2<f32>(1.0)).xy;
}

/// What is left of the light at a point before this sheet, linear RGB.
fn light_left(point: vec3<f32>, place: vec2<f32>) -> vec3<f32> {
    // Surfaces before this sheet have taken their light out of the buffer.
    let begin = sheet_heights(sheets, number.index).x;
    return light_before_surfaces(shadow, light_heights, place, vec2<f32>(begin, height_of(sheets, point))).rgb;
}

/// What arrives of the light at a point of the world in this sheet.
fn arriving(point: vec3<f32>) -> Arriving {
    let place = place_in_light(point);
    let value = sheet_mean(textureSampleLevel(light_sheet, linear_sampler, place, 0.0));
    let matter = sheet_matter(transfer, linear_sampler, value);
    let optical_depth = lighting.extinction * matter.a * metres_in_sheet(sheets, direction_to_light(light, point));
    let share = mean_light(sheet_optics(optical_depth, matter.rgb, cone_shares(scattering, lighting.g)));
    let fall = light_falloff(light, point);
    let front = light_left(point, place) * share * fall;
    let back = textureSampleLevel(shadow_back, linear_sampler, place, 0.0).rgb * share * fall;
    return Arriving(front, back);
}

/// The surface that a pixel shows.
struct SeenSurface {
    /// Where it is, metres.
    point: vec3<f32>,
    /// Unit, to the side that is seen.
    normal: vec3<f32>,
    /// Unit vector TOWARDS the light.
    to_light: vec3<f32>,
    /// Unit vector TOWARDS the eye.
    to_eye: vec3<f32>,
    /// Linear RGB.
    color: vec3<f32>,
    /// Where it is looked up, moved off it, metres.
    off: vec3<f32>,
    /// Side of a texel of the shadow buffer there, metres.
    texel: f32,
}

/// The surface at `height` that a pixel shows.
fn seen_surface(pixel: vec2<u32>, height: f32) -> SeenSurface {
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5));
    let point = ray.origin + ray.direction * max(place_at_height(ray, height), 0.0);
    let facing = finite_or_rgb(textureLoad(normal, pixel, 0).xyz, 0.0);
    let unit = facing * inverseSqrt(max(dot(facing, facing), 1e-12));
    let to_light = direction_to_light(light, point);
    let color = clamp(finite_or_rgb(textureLoad(albedo, pixel, 0).rgb, 0.0), vec3<f32>(0.0), vec3<f32>(1.0));
    let texel = metres_of_texel(light_camera.clip_from_world, f32(textureDimensions(light_heights).x), point);
    return SeenSurface(point, unit, to_light, -ray.direction, color, off_surface(texel, point, unit, to_light), texel);
}

/// Radiance of a surface by light that arrives from a direction, linear RGB. `lights`: with or without what comes from all around.
fn reflected(lights: SheetLighting, seen: SeenSurface, towards: vec3<f32>, irradiance: vec3<f32>) -> vec3<f32> {
    let arrived = irradiance * light_falloff(light, seen.point);
    return phong_radiance(lights, seen.color, 1.0, seen.normal, towards, seen.to_eye, arrived);
}

/// Light at a surface of what is `reached` by the light, linear RGB, and the share of it that sees the light.
fn light_at_surface(reached: texture_2d<f32>, seen: SeenSurface) -> vec4<f32> {
    let heights = vec2<f32>(-NO_SURFACE, height_of(sheets, seen.off));
    let sees = light_before_surfaces(reached, light_heights, place_in_light(seen.off), heights).a;
    let own = height_of(sheets, seen.point);
    let light = light_on_surface(reached, light_heights, place_in_light(seen.point), own, STEEPEST_TEXELS * seen.texel);
    return vec4<f32>(light * sees, sees);
}

/// Radiance of the surface that a pixel shows, linear RGB.
fn surface_radiance(pixel: vec2<u32>, place: u32, height: f32) -> vec3<f32> {
    let seen = seen_surface(pixel, height);
    let spread = surface_light[min(place, arrayLength(&surface_light) - 1u)].rgb;
    return reflected(lighting, seen, seen.to_light, light_at_surface(held, seen).rgb) + spread;
}

/// Radiance of a surface in this sheet by light that got behind others, or from behind the sheet, linear RGB.
fn spread_radiance(pixel: vec2<u32>, height: f32) -> vec3<f32> {
    let seen = seen_surface(pixel, height);
    var unlit = lighting;
    unlit.ambient = vec3<f32>(0.0);
    let place = place_in_light(seen.off);
    let hidden = 1.0 - light_at_surface(shadow, seen).a;
    let front = hidden * textureSampleLevel(shadow, linear_sampler, place, 0.0).rgb;
    var radiance = reflected(unlit, seen, seen.to_light, front);
    let back = textureSampleLevel(shadow_back, linear_sampler, place, 0.0).rgb;
    radiance += reflected(unlit, seen, -seen.to_light, back);
    return radiance;
}

@compute @workgroup_size(16, 8)
fn composite_sheet(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    let size = textureDimensions(sheet);
    if any(pixel >= size) {
        return;
    }
    let place = min(pixel.y * size.x + pixel.x, arrayLength(&sum) - 1u);
    let before_it = sum[place];
    let mean = sheet_mean(textureLoad(sheet, pixel, 0));
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5));
    let climbs = dot(sheets.normal, ray.direction) >= 0.0;
    let heights = heights_before_surface(sheets, number.index, climbs, textureLoad(eye_heights, pixel, 0).x);
    let share = share_of_sheet(sheets, heights);
    let own = sheet_matter(transfer, linear_sampler, mean_before_surface(mean, share));
    let middle = 0.5 * (heights.x + heights.y);
    let point = ray.origin + ray.direction * max(place_at_height(ray, middle), 0.0);
    let optical_depth = min(lighting.extinction * own.a * share * metres_in_sheet(sheets, ray.direction), 80.0);
    let transmittance = exp(-optical_depth);
    let to_light = direction_to_light(light, point);
    let arrived = arriving(point);
    let cosine = dot(to_light, ray.direction);
    var radiance = scattered_radiance(lighting, own.rgb, 1.0 - transmittance, arrived.front, cosine);
    var unlit = lighting;
    unlit.ambient = vec3<f32>(0.0);
    radiance += scattered_radiance(unlit, own.rgb, 1.0 - transmittance, arrived.back, -cosine);
    let through = select(transmittance, exp(-before_it.w), sheets.front_to_back == 1u);
    let nearer = select(radiance, before_it.rgb, sheets.front_to_back == 1u);
    let farther = select(before_it.rgb, radiance, sheets.front_to_back == 1u);
    sum[place] = vec4<f32>(nearer + through * farther, before_it.w + optical_depth);
    let surface = textureLoad(eye_heights, pixel, 0).x;
    let ends = sheet_heights(sheets, number.index);
    if surface >= ends.x && surface < ends.y {
        let kept = min(place, arrayLength(&surface_light) - 1u);
        surface_light[kept] = vec4<f32>(spread_radiance(pixel, surface), 1.0);
    }
}

@compute @workgroup_size(16, 8)
fn show_sheets(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(picture);
    if any(id.xy >= size) {
        return;
    }
    let place = min(id.y * size.x + id.x, arrayLength(&sum) - 1u);
    let all = sum[place];
    var radiance = all.rgb;
    var transmittance = exp(-all.w);
    let height = textureLoad(eye_heights, id.xy, 0).x;
    if is_surface(height) {
        radiance += transmittance * surface_radiance(id.xy, place, height);
        transmittance = 0.0;
    }
    textureStore(picture, id.xy, vec4<f32>(min(radiance, vec3<f32>(65504.0)), transmittance));
}
