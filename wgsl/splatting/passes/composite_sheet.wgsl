// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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
// definition PHONG: the medium reflects like surfaces across its gradient, instead of scattering like droplets.
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
// binding before: mean values of the sheet nearer to the light, rgba16float; with PHONG only.
// binding sheet: mean values of the sheet along the view rays, rgba16float.
// binding behind: mean values of the sheet farther from the light, rgba16float; with PHONG only.
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

#import airlight::core::camera::{Camera, Ray, view_ray, ndc_from_pixel}
#import airlight::core::light::{Light, direction_to_light, light_falloff, texels_from_clip, metres_of_texel}
#import airlight::splatting::sheets::{Sheets, SheetNumber, height_of, sheet_heights, metres_in_sheet, sheet_mean, LEAST_COSINE}
#import airlight::splatting::sheet_shading::{SheetLighting, sheet_matter}
#import airlight::splatting::sheet_shading::{gradient_of_changes, phong_radiance, scattered_radiance}
#ifdef SCATTERING
#import airlight::splatting::light_scattering::{Scattering, cone_shares, sheet_optics, mean_light}
#else
#import airlight::splatting::sheet_shading::mean_transmittance
#endif
#ifdef POLYGONS
#import airlight::core::finite::finite_or_rgb
#import airlight::splatting::surface_shadow::{NO_SURFACE, heights_before_surface, share_of_sheet, mean_before_surface, is_surface}
#import airlight::splatting::surface_shadow::{off_surface, light_before_surfaces, light_on_surface, STEEPEST_TEXELS}
#endif

@group(#{GROUP}) @binding(0) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light_camera: Camera;
@group(#{GROUP}) @binding(2) var<uniform> light: Light;
@group(#{GROUP}) @binding(3) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(4) var<uniform> lighting: SheetLighting;
@group(#{GROUP}) @binding(5) var<uniform> number: SheetNumber;
@group(#{GROUP}) @binding(7) var sheet: texture_2d<f32>;
#ifdef PHONG
@group(#{GROUP}) @binding(6) var before: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var behind: texture_2d<f32>;
#endif
@group(#{GROUP}) @binding(9) var light_sheet: texture_2d<f32>;
@group(#{GROUP}) @binding(10) var shadow: texture_2d<f32>;
@group(#{GROUP}) @binding(11) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(12) var linear_sampler: sampler;
@group(#{GROUP}) @binding(13) var<storage, read_write> sum: array<vec4<f32>>;
@group(#{GROUP}) @binding(14) var picture: texture_storage_2d<rgba16float, write>;
#ifdef POLYGONS
@group(#{GROUP}) @binding(15) var eye_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(16) var light_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(17) var albedo: texture_2d<f32>;
@group(#{GROUP}) @binding(18) var normal: texture_2d<f32>;
#endif
#ifdef SCATTERING
@group(#{GROUP}) @binding(20) var<uniform> scattering: Scattering;
#endif
#ifdef BACK
@group(#{GROUP}) @binding(21) var shadow_back: texture_2d<f32>;
#endif
#ifdef SPREAD
@group(#{GROUP}) @binding(22) var held: texture_2d<f32>;
@group(#{GROUP}) @binding(23) var<storage, read_write> surface_light: array<vec4<f32>>;
#endif

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
#ifdef POLYGONS
#ifdef SPREAD
    // Surfaces before this sheet have taken their light out of the buffer.
    let begin = sheet_heights(sheets, number.index).x;
#else
    let begin = -NO_SURFACE;
#endif
    return light_before_surfaces(shadow, light_heights, place, vec2<f32>(begin, height_of(sheets, point))).rgb;
#else
    return textureSampleLevel(shadow, linear_sampler, place, 0.0).rgb;
#endif
}

/// What arrives of the light at a point of the world in this sheet.
fn arriving(point: vec3<f32>) -> Arriving {
    let place = place_in_light(point);
    let value = sheet_mean(textureSampleLevel(light_sheet, linear_sampler, place, 0.0));
    let matter = sheet_matter(transfer, linear_sampler, value);
    let optical_depth = lighting.extinction * matter.a * metres_in_sheet(sheets, direction_to_light(light, point));
#ifdef SCATTERING
    let share = mean_light(sheet_optics(optical_depth, matter.rgb, cone_shares(scattering, lighting.g)));
#else
    let share = vec3<f32>(mean_transmittance(optical_depth));
#endif
    let fall = light_falloff(light, point);
    let front = light_left(point, place) * share * fall;
#ifdef BACK
    let back = textureSampleLevel(shadow_back, linear_sampler, place, 0.0).rgb * share * fall;
#else
    let back = vec3<f32>(0.0);
#endif
    return Arriving(front, back);
}

#ifdef PHONG
/// The point at which the ray through a pixel's middle meets a height.
fn point_of_pixel(pixel: vec2<u32>, height: f32) -> vec3<f32> {
    let ray = view_ray(camera, ndc_from_pixel(camera, vec2<f32>(pixel) + 0.5));
    return ray.origin + ray.direction * place_at_height(ray, height);
}

/// Gradient of the means around a pixel of this sheet, by central differences over pixels and sheets.
fn sheet_gradient(pixel: vec2<u32>, middle: f32) -> vec3<f32> {
    let last = textureDimensions(sheet) - vec2<u32>(1u);
    let low = max(pixel, vec2<u32>(1u)) - vec2<u32>(1u);
    let high = min(pixel + vec2<u32>(1u), last);
    let changes = vec3<f32>(
        sheet_mean(textureLoad(sheet, vec2<u32>(high.x, pixel.y), 0)) - sheet_mean(textureLoad(sheet, vec2<u32>(low.x, pixel.y), 0)),
        sheet_mean(textureLoad(sheet, vec2<u32>(pixel.x, high.y), 0)) - sheet_mean(textureLoad(sheet, vec2<u32>(pixel.x, low.y), 0)),
        sheet_mean(textureLoad(behind, pixel, 0)) - sheet_mean(textureLoad(before, pixel, 0))
    );
    let across = point_of_pixel(vec2<u32>(high.x, pixel.y), middle) - point_of_pixel(vec2<u32>(low.x, pixel.y), middle);
    let down = point_of_pixel(vec2<u32>(pixel.x, high.y), middle) - point_of_pixel(vec2<u32>(pixel.x, low.y), middle);
    let through = point_of_pixel(pixel, middle + sheets.thickness) - point_of_pixel(pixel, middle - sheets.thickness);
    return gradient_of_changes(across, down, through, changes);
}
#endif

#ifdef POLYGONS
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
#ifdef SPREAD
    let spread = surface_light[min(place, arrayLength(&surface_light) - 1u)].rgb;
    return reflected(lighting, seen, seen.to_light, light_at_surface(held, seen).rgb) + spread;
#else
    return reflected(lighting, seen, seen.to_light, light_at_surface(shadow, seen).rgb);
#endif
}
#endif

#ifdef SPREAD
/// Radiance of a surface in this sheet by light that got behind others, or from behind the sheet, linear RGB.
fn spread_radiance(pixel: vec2<u32>, height: f32) -> vec3<f32> {
    let seen = seen_surface(pixel, height);
    var unlit = lighting;
    unlit.ambient = vec3<f32>(0.0);
    let place = place_in_light(seen.off);
    let hidden = 1.0 - light_at_surface(shadow, seen).a;
    let front = hidden * textureSampleLevel(shadow, linear_sampler, place, 0.0).rgb;
    var radiance = reflected(unlit, seen, seen.to_light, front);
#ifdef BACK
    let back = textureSampleLevel(shadow_back, linear_sampler, place, 0.0).rgb;
    radiance += reflected(unlit, seen, -seen.to_light, back);
#endif
    return radiance;
}
#endif

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
#ifdef POLYGONS
    let climbs = dot(sheets.normal, ray.direction) >= 0.0;
    let heights = heights_before_surface(sheets, number.index, climbs, textureLoad(eye_heights, pixel, 0).x);
    let share = share_of_sheet(sheets, heights);
    let own = sheet_matter(transfer, linear_sampler, mean_before_surface(mean, share));
#else
    let heights = sheet_heights(sheets, number.index);
    let share = 1.0;
    let own = sheet_matter(transfer, linear_sampler, mean);
#endif
    let middle = 0.5 * (heights.x + heights.y);
    let point = ray.origin + ray.direction * max(place_at_height(ray, middle), 0.0);
    let optical_depth = min(lighting.extinction * own.a * share * metres_in_sheet(sheets, ray.direction), 80.0);
    let transmittance = exp(-optical_depth);
    let to_light = direction_to_light(light, point);
    let arrived = arriving(point);
#ifdef PHONG
    let gradient = sheet_gradient(pixel, middle);
    let steepness = length(gradient);
    let normal = select(vec3<f32>(0.0), -gradient / max(steepness, 1e-20), steepness > 1e-6);
    var radiance = phong_radiance(
        lighting, own.rgb, 1.0 - transmittance, normal, to_light, -ray.direction, arrived.front
    );
#ifdef BACK
    var unlit = lighting;
    unlit.ambient = vec3<f32>(0.0);
    radiance += phong_radiance(unlit, own.rgb, 1.0 - transmittance, normal, -to_light, -ray.direction, arrived.back);
#endif
#else
    let cosine = dot(to_light, ray.direction);
    var radiance = scattered_radiance(lighting, own.rgb, 1.0 - transmittance, arrived.front, cosine);
#ifdef BACK
    var unlit = lighting;
    unlit.ambient = vec3<f32>(0.0);
    radiance += scattered_radiance(unlit, own.rgb, 1.0 - transmittance, arrived.back, -cosine);
#endif
#endif
    let through = select(transmittance, exp(-before_it.w), sheets.front_to_back == 1u);
    let nearer = select(radiance, before_it.rgb, sheets.front_to_back == 1u);
    let farther = select(before_it.rgb, radiance, sheets.front_to_back == 1u);
    sum[place] = vec4<f32>(nearer + through * farther, before_it.w + optical_depth);
#ifdef SPREAD
    let surface = textureLoad(eye_heights, pixel, 0).x;
    let ends = sheet_heights(sheets, number.index);
    if surface >= ends.x && surface < ends.y {
        let kept = min(place, arrayLength(&surface_light) - 1u);
        surface_light[kept] = vec4<f32>(spread_radiance(pixel, surface), 1.0);
    }
#endif
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
#ifdef POLYGONS
    let height = textureLoad(eye_heights, id.xy, 0).x;
    if is_surface(height) {
        radiance += transmittance * surface_radiance(id.xy, place, height);
        transmittance = 0.0;
    }
#endif
    textureStore(picture, id.xy, vec4<f32>(min(radiance, vec3<f32>(65504.0)), transmittance));
}
