// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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
// definition BACK: light is scattered back as well.
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
// binding own: with BACK only, the sheet stored: light in three halves, then its mean value, a texel; D or U on its side of the light.
// binding next: with BACK only, the stored sheet behind it.
// binding shadow_back: out of light_behind with BACK only, U behind the sheet, rgba16float.
// binding light_heights: with POLYGONS only, of the first surface along each light ray, along the normal of the sheets, metres; r32float.
// binding held: out with POLYGONS only, light that arrives at that surface, rgba16float.

#import airlight::core::camera::{Camera, view_ray, ndc_from_pixel}
#import airlight::core::light::Light
#import airlight::splatting::blur::BLUR_WEIGHTS
#import airlight::splatting::sheets::{Sheets, SheetNumber, sheet_heights, metres_in_sheet, sheet_mean, LEAST_COSINE}
#import airlight::splatting::sheet_shading::{SheetLighting, sheet_matter}
#import airlight::splatting::light_scattering::{Scattering, AxisKernel, SheetOptics, cone_shares, mean_square_slope}
#import airlight::splatting::light_scattering::{spread_variance, texels_per_metre, axis_kernel, sheet_optics}

@group(#{GROUP}) @binding(0) var<uniform> light_camera: Camera;
@group(#{GROUP}) @binding(1) var<uniform> light: Light;
@group(#{GROUP}) @binding(2) var<uniform> sheets: Sheets;
@group(#{GROUP}) @binding(3) var<uniform> lighting: SheetLighting;
@group(#{GROUP}) @binding(4) var<uniform> scattering: Scattering;
@group(#{GROUP}) @binding(5) var<uniform> number: SheetNumber;
@group(#{GROUP}) @binding(6) var light_sheet: texture_2d<f32>;
@group(#{GROUP}) @binding(7) var transfer: texture_2d<f32>;
@group(#{GROUP}) @binding(8) var linear_sampler: sampler;
@group(#{GROUP}) @binding(9) var<storage, read_write> left: array<vec4<f32>>;
@group(#{GROUP}) @binding(10) var<storage, read_write> rows: array<vec4<f32>>;
@group(#{GROUP}) @binding(11) var<storage, read_write> kernels: array<AxisKernel>;
@group(#{GROUP}) @binding(12) var shadow: texture_storage_2d<rgba16float, write>;
#ifdef BACK
@group(#{GROUP}) @binding(13) var<storage, read_write> own: array<vec2<u32>>;
@group(#{GROUP}) @binding(14) var<storage, read_write> next: array<vec2<u32>>;
@group(#{GROUP}) @binding(15) var shadow_back: texture_storage_2d<rgba16float, write>;
#endif
#ifdef POLYGONS
@group(#{GROUP}) @binding(16) var light_heights: texture_2d<f32>;
@group(#{GROUP}) @binding(17) var held: texture_storage_2d<rgba16float, write>;
#endif

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
#ifdef BACK
/// Light that turns into that way.
var<workgroup> turned: array<vec3<f32>, 320>;
#endif

/// Place of a texel in the buffers.
fn place_of(texel: vec2<u32>) -> u32 {
    return min(texel.y * textureDimensions(shadow).x + texel.x, arrayLength(&left) - 1u);
}

/// What may be stored in half floats.
fn storable(color: vec3<f32>) -> vec3<f32> {
    return clamp(color, vec3<f32>(0.0), vec3<f32>(65504.0));
}

#ifdef BACK
/// Light of a texel of a stored sheet.
fn stored_light(texel: vec2<u32>) -> vec3<f32> {
    return vec3<f32>(unpack2x16float(texel.x), unpack2x16float(texel.y).x);
}

/// A texel of a stored sheet, of light and mean value.
fn stored(color: vec3<f32>, mean: f32) -> vec2<u32> {
    let all = storable(color);
    return vec2<u32>(pack2x16float(all.xy), pack2x16float(vec2<f32>(all.z, min(mean, 65504.0))));
}
#endif

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
#ifdef POLYGONS
    let surface = textureLoad(light_heights, texel, 0).x;
    return select(all, vec3<f32>(0.0), surface < sheets.first);
#else
    return all;
#endif
}

@compute @workgroup_size(16, 8)
fn begin_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let color = light_before(id.xy);
    left[place_of(id.xy)] = vec4<f32>(color, 1.0);
    textureStore(shadow, id.xy, vec4<f32>(storable(color), 1.0));
#ifdef POLYGONS
    textureStore(held, id.xy, vec4<f32>(storable(light.radiance), 1.0));
#endif
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
#ifdef BACK
    asked = max(asked, u32(kernels[min(kernel + 2u, arrayLength(&kernels) - 1u)].weights[3].w));
#endif
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
#ifdef BACK
            let kept = own[min(place, arrayLength(&own) - 1u)];
            let beyond = stored_light(next[min(place, arrayLength(&next) - 1u)]);
            let opposite = select(beyond, stored_light(kept), stage == UP);
            let drawn = sheet_mean(textureLoad(light_sheet, texel, 0));
            let mean = select(unpack2x16float(kept.y).y, drawn, stage == PICTURE);
#else
            let mean = sheet_mean(textureLoad(light_sheet, texel, 0));
#endif
            sent = optics_of(texel, mean, shares);
            let forward = sent.forward * color;
#ifdef POLYGONS
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
#else
            sent.forward = forward;
#endif
#ifdef BACK
            sent.back *= opposite;
#ifdef POLYGONS
            // Light from behind ends at the surface from its other side; what comes from the light is turned before it.
            sent.back = select(sent.back, vec3<f32>(0.0), ends && stage != UP);
#endif
#endif
        }
        let slot = (i / width) * REACH + column;
        ahead[slot] = vec4<f32>(sent.forward, sent.transmitted);
#ifdef BACK
        turned[slot] = sent.back;
#endif
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
#ifdef BACK
    var back = kernels[min(kernel + 2u, arrayLength(&kernels) - 1u)].weights[0].x * turned[middle];
    for (var i = 1u; i <= radius; i++) {
        back += kernels[min(kernel + 2u, arrayLength(&kernels) - 1u)].weights[i >> 2u][i & 3u] * (turned[middle - i] + turned[middle + i]);
    }
    rows[min(arrayLength(&left) + place, arrayLength(&rows) - 1u)] = vec4<f32>(back, 0.0);
#endif
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
#ifdef BACK
    let all = arrayLength(&left);
    let last = arrayLength(&rows) - 1u;
    sum += kernels[min(kernel + 3u, arrayLength(&kernels) - 1u)].weights[0].x * rows[min(all + place, last)].rgb;
    let reach = min(u32(kernels[min(kernel + 3u, arrayLength(&kernels) - 1u)].weights[3].w), BLUR_WEIGHTS - 1u);
    for (var i = 1u; i <= reach; i++) {
        let weight = kernels[min(kernel + 3u, arrayLength(&kernels) - 1u)].weights[i >> 2u][i & 3u];
        if texel.y >= i {
            sum += weight * rows[min(all + place - i * size.x, last)].rgb;
        }
        if texel.y + i < size.y {
            sum += weight * rows[min(all + place + i * size.x, last)].rgb;
        }
    }
#endif
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

#ifdef BACK
@compute @workgroup_size(16, 8)
fn keep_sheet(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(shadow)) {
        let mean = sheet_mean(textureLoad(light_sheet, id.xy, 0));
        own[min(place_of(id.xy), arrayLength(&own) - 1u)] = stored(vec3<f32>(0.0), mean);
    }
}

@compute @workgroup_size(16, 8)
fn begin_down(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let place = place_of(id.xy);
    let color = light_before(id.xy);
    left[place] = vec4<f32>(color, 1.0);
    // Bound is the first sheet.
    let kept = min(place, arrayLength(&own) - 1u);
    own[kept] = stored(color, unpack2x16float(own[kept].y).y);
}

@compute @workgroup_size(16, 8)
fn begin_up(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(shadow)) {
        let place = place_of(id.xy);
        left[place] = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        // Bound is the last sheet; from behind it nothing comes.
        next[min(place, arrayLength(&next) - 1u)] = vec2<u32>(0u);
    }
}

@compute @workgroup_size(16, 8)
fn down_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    convolve_rows(group.xy * TILE, local.xy, DOWN);
}

@compute @workgroup_size(16, 8)
fn down_columns(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let place = place_of(id.xy);
    let color = convolved_columns(id.xy);
    left[place] = vec4<f32>(color, 1.0);
    let kept = min(place, arrayLength(&next) - 1u);
    next[kept] = stored(color, unpack2x16float(next[kept].y).y);
}

@compute @workgroup_size(16, 8)
fn up_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    convolve_rows(group.xy * TILE, local.xy, UP);
}

@compute @workgroup_size(16, 8)
fn up_columns(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(shadow)) {
        return;
    }
    let place = place_of(id.xy);
    let color = convolved_columns(id.xy);
    left[place] = vec4<f32>(color, 1.0);
    let kept = min(place, arrayLength(&own) - 1u);
    own[kept] = stored(color, unpack2x16float(own[kept].y).y);
}

@compute @workgroup_size(16, 8)
fn light_behind(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < textureDimensions(shadow)) {
        let color = stored_light(next[min(place_of(id.xy), arrayLength(&next) - 1u)]);
        textureStore(shadow_back, id.xy, vec4<f32>(color, 1.0));
    }
}
#endif
