// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: splatting/soft_light, permutation default
// summary: What arrives of an area light at a sheet, and what the sheet does to the layers of the shadow buffer.
// source: Zhang and Crawfis, 5.1; see splatting/soft_shadow.
// note: Dispatch over the shadow buffer for each sheet before its picture, with `splatting/soften_sheet` between sheets, and once
// note: more behind the last. Layers need no zeros before the first: none is read before something was written.
// note: A surface is lit by what arrives at the sheet in which it lies, which `held` keeps.
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

/// Metres that a ray of unit `direction` passes within a sheet.
fn metres_in_sheet(sheets: Sheets, direction: vec3<f32>) -> f32 {
    return sheets.thickness / max(abs(dot(sheets.normal, direction)), LEAST_COSINE);
}

/// The mean value of a texel of a sheet, from 0 up: the sum of values that were added by `in_exact_parts`.
fn sheet_mean(texel: vec4<f32>) -> f32 {
    return max(dot(texel.xyz, vec3<f32>(1.0, 1.0 / 512.0, 1.0 / 16384.0)), 0.0);
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

/// Where a texel of a layer lies in the buffers.
fn layer_place(layer: u32, pixel: vec2<u32>) -> u32 {
    let place = (layer * soft.size.y + pixel.y) * soft.size.x + pixel.x;
    return min(place, arrayLength(&layers) - 1u);
}

/// What arrives of the light at a texel, of its radiance.
fn arriving_share(pixel: vec2<u32>) -> f32 {
    var share = 1.0;
    for (var layer = 0u; layer < layers_in_use(number.index); layer++) {
        share *= clamp(layers[layer_place(layer, pixel)], 0.0, 1.0);
    }
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
}
