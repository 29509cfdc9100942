// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: painterly/shade, permutation default
// summary: Lights what `iso_raycast` has written with DEFERRED: Phong lighting by colour and normal.
// source: dissertation on painterly volume rendering, 4.1.4, Eq. 4.2: illumination deferred to a later step.
// note: What is not finite counts as 0.
// binding camera: the camera that the rays were cast with.
// binding lighting: how the surface is lit.
// binding color: unlit colour, and 1 where the surface is seen.
// binding surface: unit normal in the world.
// binding picture: out, rgba16float: linear RGB radiance, premultiplied, and 1 where the surface is seen.

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

// ---- airlight::painterly::iso_surface ----
// summary: Iso-surface of classified opacity in a volume: crossing, gradient, Phong lighting, flow and occlusion of a surface point.
// source: dissertation on painterly volume rendering, 4.1.1 to 4.1.6, Eq. 4.1 and 4.2.

/// How a surface is lit. 48 bytes.
struct SurfaceLighting {
    /// Unit vector TOWARDS the directional light.
    direction: vec3<f32>,
    /// Share of diffuse reflection, k_d, from 0 up.
    diffuse: f32,
    /// Irradiance of the light at normal incidence over pi, linear RGB.
    radiance: vec3<f32>,
    /// Share of mirror-like reflection, k_s, from 0 up.
    specular: f32,
    /// Radiance from all around, linear RGB.
    ambient: vec3<f32>,
    /// Exponent of mirror-like reflection, alpha, from 1 up.
    shininess: f32,
}

/// Phong lighting of a surface, Eq. 4.2: linear RGB radiance towards the eye. `albedo`: linear RGB; `normal`: unit;
/// `view`: unit direction of the view ray, away from the eye.
fn phong(lighting: SurfaceLighting, albedo: vec3<f32>, normal: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    let facing = dot(normal, lighting.direction);
    let mirrored = max(dot(reflect(view, normal), lighting.direction), 0.0);
    let lobe = select(0.0, pow(max(mirrored, 1e-6), lighting.shininess), facing > 0.0 && mirrored > 0.0);
    let diffuse = lighting.diffuse * max(facing, 0.0) * lighting.radiance + lighting.ambient;
    return albedo * diffuse + lighting.specular * lobe * lighting.radiance;
}

// ---- painterly/shade ----

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> lighting: SurfaceLighting;
@group(0) @binding(2) var color: texture_2d<f32>;
@group(0) @binding(3) var surface: texture_2d<f32>;
@group(0) @binding(4) var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(16, 8)
fn shade(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(picture)) {
        return;
    }
    let texel = textureLoad(color, id.xy, 0);
    let unlit = vec4<f32>(finite_or_rgb(texel.rgb, 0.0), finite_or(texel.a, 0.0));
    let stored = finite_or_rgb(textureLoad(surface, id.xy, 0).xyz, 0.0);
    // Half floats that were cut short are too short for a high power.
    let normal = stored / max(length(stored), 1e-6);
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(id.xy) + 0.5));
    let lit = min(phong(lighting, unlit.xyz, normal, ray.direction), vec3<f32>(65504.0));
    textureStore(picture, id.xy, select(vec4<f32>(0.0), vec4<f32>(lit, unlit.w), unlit.w > 0.0));
}
