// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// summary: Moves strokes with their surface, and lets them take part of what the ray caster sees there, or fade out.
// source: Ramalhao (2010), 4.2.3.
// note: First of a frame; then `stroke_density`, `stroke_population`, `core/scan`, `stroke_compact`, `stroke_order` with a
// note: `core/scan` in it, `draw_strokes`. Nothing is read back: counts stay in `counts` and drive the draws.
// note: A stroke looks at the four pixels around its place and takes the nearest that shows its surface, and its layer if any
// note: does: at a silhouette the nearest of all may show the background, and beside another layer that one.
// definition CURVATURE: strokes may follow the direction of greatest curvature.
// binding color: premultiplied linear RGB, alpha 1 where there is a surface; rgba16float.
// binding surface: unit normal in the world, 0 where there is no surface, and gradient magnitude; rgba16float.
// binding distances: metres along the view ray, negative where there is no surface; r32float.
// binding curvature: principal curvatures, and (cos 2a, sin 2a) of the picture's direction of the greater; with CURVATURE only.
// binding camera: the camera of this frame; its viewport is not used.
// binding frame: the frame.
// binding style: the style.
// binding strokes: the strokes, in place.
// binding counts: how many there are.

#import airlight::core::camera::{Camera, view_ray}
#import airlight::core::finite::is_finite
#import airlight::painterly::stroke::{
    Stroke, StrokeFrame, StrokeStyle, StrokeCounts, STROKE_STAYS, STROKE_LEAVES, STROKE_HIDDEN
}
#import airlight::painterly::stroke_placement::stays_in_layer
#import airlight::painterly::stroke_targets::{surface_texel, source_size}
#import airlight::painterly::stroke_update::{seen_point, is_seen, surface_orientation, updated_stroke}

@group(#{GROUP}) @binding(4) var<uniform> camera: Camera;
@group(#{GROUP}) @binding(5) var<uniform> frame: StrokeFrame;
@group(#{GROUP}) @binding(6) var<uniform> style: StrokeStyle;
@group(#{GROUP}) @binding(7) var<storage, read_write> strokes: array<Stroke>;
@group(#{GROUP}) @binding(8) var<storage, read> counts: StrokeCounts;

@compute @workgroup_size(64)
fn update_strokes(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= min(min(counts.instances, frame.capacity), arrayLength(&strokes)) {
        return;
    }
    var stroke = strokes[index];
    let world = (frame.world_from_unit * vec4<f32>(stroke.point, 1.0)).xyz;
    let seen = seen_point(camera, world);
    let known = is_finite(seen.position.x) && is_finite(seen.position.y);
    let inside = seen.inside && known;
    let ndc = select(vec2<f32>(0.0), seen.ndc, inside);
    let ray = view_ray(camera, ndc);
    let predicted = dot(world - ray.origin, ray.direction);
    let size = vec2<f32>(source_size());
    let beside = view_ray(camera, ndc + vec2<f32>(2.0 / size.x, 0.0));
    let footprint = length(beside.origin - ray.origin + predicted * (beside.direction - ray.direction));

    let place = select(vec2<f32>(0.5), seen.position, inside) * size;
    let corner = vec2<i32>(floor(place - 0.5));
    let last = vec2<i32>(source_size()) - 1;
    var best = vec2<u32>(0u);
    var least = 1e9;
    var visible = false;
    var stays = false;
    for (var tap = 0; tap < 4; tap++) {
        let pixel = vec2<u32>(clamp(corner + vec2<i32>(tap & 1, tap >> 1u), vec2<i32>(0), last));
        let candidate = surface_texel(pixel);
        let seen_here = inside && is_seen(predicted, candidate, ray, footprint, style.occlusion_tolerance);
        let stays_here = stays_in_layer(
            candidate.magnitude * style.gradient_scale, stroke.layer, style.thresholds, style.hysteresis
        );
        let away = vec2<f32>(pixel) + 0.5 - place;
        let score = dot(away, away) + select(100.0, 0.0, seen_here) + select(10.0, 0.0, stays_here);
        let better = score < least;
        best = select(best, pixel, better);
        visible = select(visible, seen_here, better);
        stays = select(stays, stays_here, better);
        least = min(least, score);
    }
    let surface = surface_texel(best);

    let leaves = select(STROKE_LEAVES, stroke.state, stays || stroke.state != STROKE_STAYS);
    let state = select(STROKE_HIDDEN, leaves, visible);
    stroke.position = select(stroke.position, seen.position, inside);
    let orientation = surface_orientation(
        camera, world, ray, surface, style, frame.picture_size, stroke.orientation
    );
    strokes[index] = updated_stroke(stroke, surface, orientation, state, style, frame.seconds);
}
