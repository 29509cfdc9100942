// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/soft_light, permutation polygons (POLYGONS)
// summary: What arrives of an area light at a sheet, and what the sheet does to the layers of the shadow buffer.
// source: Zhang and Crawfis, 5.1; see splatting/soft_shadow.
// note: Dispatch over the shadow buffer for each sheet before its picture, with `splatting/soften_sheet` between sheets, and once
// note: more behind the last. Layers need no zeros before the first: none is read before something was written.
// note: A surface is lit by what arrives at the sheet in which it lies, which `held` keeps.
// definition POLYGONS: there are surfaces besides the volume.
// binding number: which sheet; as many as there are behind the last.
// binding soft: the buffer, and solids.
// binding light_camera: the light as a camera of the buffer.
// binding light: the light.
// binding sheets: the sheets.
// binding lighting: extinction.
// binding light_sheet: mean values of the sheet along the light rays, rgba16float.
// binding transfer: finite colour and opacity of values 0..1, one row, rgba16float or rgba8unorm.
// binding linear_sampler: linear, clamped to the edge.
// binding merges: what each sheet does with layers.
// binding layers: transmittances of the volume, layer after layer, row after row; in and out.
// binding shadow: out, what arrives of the light at the sheet, linear RGB.
// binding kept: of surfaces, 1 less what each layer newly takes of the light; like layers, with POLYGONS only.
// binding filled: transmittances of solids; like layers, with POLYGONS only.
// binding light_heights: of the first surface along each light ray, along the normal of the sheets, metres, 1e30 where there is none; with
// binding light_heights: POLYGONS only, r32float.
// binding light_exit_heights: the same of the first surface that turns its back to the light; with POLYGONS only, r32float.
// binding held: out, what arrives at the first surface along each light ray, linear RGB; with POLYGONS only.

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

// ---- airlight::splatting::surface_shadow ----
// summary: Which part of a sheet lies before a surface, and what arrives of the light at a point where surfaces block it.
// source: Zhang and Crawfis, 4.1, Fig. 6 and 7, Table 1.

/// Height where a ray meets no surface, metres.
const NO_SURFACE: f32 = 1e30;

/// Whether there is a surface at a height.
fn is_surface(height: f32) -> bool {
    return height < 0.5 * NO_SURFACE;
}

// ---- airlight::splatting::soft_shadow ----
// summary: Soft shadows of area lights: layers of the shadow buffer by depth, and how deep solids behind a surface are.
// source: Zhang and Crawfis, 5.1; Soler and Sillion, "Fast calculation of soft shadow textures using convolution" (1998).

/// Layers of the shadow buffer.
const SOFT_LAYERS: u32 = 16u;

/// What a sheet does with layers. 8 bytes.
struct LayerMerge {
    /// The layer that takes up the sheet, 0..15.
    open: u32,
    /// The layer that takes in what was in that one before; 16 where it was empty.
    into: u32,
}

/// The shadow buffer's geometry, and solids. 32 bytes.
struct SoftLight {
    /// Texels of the shadow buffer.
    size: vec2<u32>,
    /// Side of a texel: metres of a directional light, metres per metre of distance of a light at a point.
    texel: vec2<f32>,
    /// Height of a light at a point along the sheets' normal, metres.
    height: f32,
    /// 1 of a light at a point, 0 of a directional one.
    local: u32,
    /// Depth of solids where their surface rises by a metre a metre, metres.
    filling: f32,
    /// Greatest depth of solids, metres.
    deepest: f32,
}

/// How many layers hold something when a sheet is reached; `index`: from 0, of the sheet.
fn layers_in_use(index: u32) -> u32 {
    return min(index, SOFT_LAYERS);
}

/// Side of a texel at a height, metres.
fn texel_metres(soft: SoftLight, height: f32) -> vec2<f32> {
    return soft.texel * select(1.0, max(height - soft.height, 0.0), soft.local == 1u);
}

/// Metres per metre that a surface rises: from a height to those of its four neighbours at `side` metres, the smaller change of each
/// axis. `before`, `behind`: neighbours along both axes.
fn surface_slope(height: f32, before: vec2<f32>, behind: vec2<f32>, side: vec2<f32>) -> f32 {
    let changes = min(abs(before - height), abs(behind - height)) / max(side, vec2<f32>(1e-12));
    return length(min(changes, vec2<f32>(1e6)));
}

/// How deep the solid behind a surface at `height` is, metres along the normal: the reciprocal of its slope, at least `least`, and at most
/// to the height `end` at which the light ray leaves it; what it never leaves is no solid and 0 deep.
fn solid_depth(soft: SoftLight, height: f32, slope: f32, least: f32, end: f32) -> f32 {
    let guess = max(soft.filling / max(slope, 1e-6), least);
    let known = select(0.0, max(end - height, 0.0), is_surface(end));
    return min(guess, min(known, soft.deepest));
}

/// Whether a surface at `height` lies in a sheet; the first sheet has all before it as well. `heights`: of the sheet's ends.
fn surface_in_sheet(height: f32, heights: vec2<f32>, index: u32) -> bool {
    return is_surface(height) && height < heights.y && (height >= heights.x || index == 0u);
}

/// What is left of the middle ray's light by surfaces. `taken`: sum over layers of what each newly takes; `darkest`: the least
/// transmittance of filled layers. 0..1.
fn surfaces_left(taken: f32, darkest: f32) -> f32 {
    return clamp(min(1.0 - taken, darkest), 0.0, 1.0);
}

// ---- splatting/soft_light ----

@group(0) @binding(0) var<uniform> number: SheetNumber;
@group(0) @binding(1) var<uniform> soft: SoftLight;
@group(0) @binding(2) var<uniform> light_camera: Camera;
@group(0) @binding(3) var<uniform> light: Light;
@group(0) @binding(4) var<uniform> sheets: Sheets;
@group(0) @binding(5) var<uniform> lighting: SheetLighting;
@group(0) @binding(6) var light_sheet: texture_2d<f32>;
@group(0) @binding(7) var transfer: texture_2d<f32>;
@group(0) @binding(8) var linear_sampler: sampler;
@group(0) @binding(9) var<storage, read> merges: array<LayerMerge>;
@group(0) @binding(10) var<storage, read_write> layers: array<f32>;
@group(0) @binding(11) var shadow: texture_storage_2d<rgba16float, write>;
@group(0) @binding(12) var<storage, read_write> kept: array<f32>;
@group(0) @binding(13) var<storage, read_write> filled: array<f32>;
@group(0) @binding(14) var light_heights: texture_2d<f32>;
@group(0) @binding(15) var light_exit_heights: texture_2d<f32>;
@group(0) @binding(16) var held: texture_storage_2d<rgba16float, write>;

/// Where a texel of a layer lies in the buffers.
fn layer_place(layer: u32, pixel: vec2<u32>) -> u32 {
    let place = (layer * soft.size.y + pixel.y) * soft.size.x + pixel.x;
    return min(place, arrayLength(&layers) - 1u);
}

/// Height of the first surface along a texel's light ray, metres.
fn first_height(pixel: vec2<u32>) -> f32 {
    return finite_or(textureLoad(light_heights, min(pixel, textureDimensions(light_heights) - 1u), 0).x, NO_SURFACE);
}

/// How deep the solid behind a texel's surface is, metres.
fn depth_behind(pixel: vec2<u32>, height: f32) -> f32 {
    let low = max(pixel, vec2<u32>(1u)) - 1u;
    let before = vec2<f32>(first_height(vec2<u32>(low.x, pixel.y)), first_height(vec2<u32>(pixel.x, low.y)));
    let behind = vec2<f32>(first_height(pixel + vec2<u32>(1u, 0u)), first_height(pixel + vec2<u32>(0u, 1u)));
    let slope = surface_slope(height, before, behind, texel_metres(soft, height));
    let end = finite_or(textureLoad(light_exit_heights, min(pixel, textureDimensions(light_exit_heights) - 1u), 0).x, NO_SURFACE);
    return solid_depth(soft, height, slope, sheets.thickness, end);
}

/// What arrives of the light at a texel, of its radiance.
fn arriving_share(pixel: vec2<u32>) -> f32 {
    var share = 1.0;
    for (var layer = 0u; layer < layers_in_use(number.index); layer++) {
        share *= clamp(layers[layer_place(layer, pixel)], 0.0, 1.0);
    }
    var taken = 0.0;
    var darkest = 1.0;
    for (var layer = 0u; layer < layers_in_use(number.index); layer++) {
        let place = layer_place(layer, pixel);
        taken += 1.0 - kept[min(place, arrayLength(&kept) - 1u)];
        darkest = min(darkest, filled[min(place, arrayLength(&filled) - 1u)]);
    }
    share *= surfaces_left(taken, darkest);
    return share;
}

@compute @workgroup_size(16, 8)
fn soft_light(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    if any(pixel >= soft.size) {
        return;
    }
    let arrived = clamp(light.radiance, vec3<f32>(0.0), vec3<f32>(65504.0)) * arriving_share(pixel);
    textureStore(shadow, pixel, vec4<f32>(arrived, 1.0));
    if number.index >= min(sheets.count, arrayLength(&merges)) {
        return;
    }
    let merge = merges[number.index];
    let open = layer_place(min(merge.open, SOFT_LAYERS - 1u), pixel);
    let into = layer_place(min(merge.into, SOFT_LAYERS - 1u), pixel);
    let merging = merge.into < SOFT_LAYERS;
    let value = sheet_mean(textureLoad(light_sheet, pixel, 0));
    let ray = view_ray(light_camera, ndc_from_pixel(light_camera, vec2<f32>(pixel) + 0.5));
    let extinction = lighting.extinction * sheet_matter(transfer, linear_sampler, value).a;
    let through = exp(-min(extinction * metres_in_sheet(sheets, ray.direction), 80.0));
    if merging {
        layers[into] = layers[into] * layers[open];
    }
    layers[open] = through;
    let heights = sheet_heights(sheets, number.index);
    let height = first_height(pixel);
    if height >= heights.x || number.index == 0u {
        textureStore(held, pixel, vec4<f32>(arrived, 1.0));
    }
    let here = surface_in_sheet(height, heights, number.index);
    let solid = here || (height < heights.y && height + depth_behind(pixel, height) > heights.x);
    let ends = vec2<u32>(arrayLength(&kept), arrayLength(&filled)) - 1u;
    if merging {
        kept[min(into, ends.x)] = kept[min(into, ends.x)] + kept[min(open, ends.x)] - 1.0;
        filled[min(into, ends.y)] = min(filled[min(into, ends.y)], filled[min(open, ends.y)]);
    }
    kept[min(open, ends.x)] = select(1.0, 0.0, here);
    filled[min(open, ends.y)] = select(1.0, 0.0, solid);
}
