// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::painterly::stroke_update
// summary: A stroke follows its point of the surface and takes part of the new colour, orientation, size and opacity.
// source: Ramalhao (2010), 4.1.6, 4.2.1, 4.2.3.
// note: The text moves a stroke by the flow at its old pixel. The flow of a frame belongs to its NEW pixels: read at the old
// note: one it errs by .3 pixels in the mean at 8 pixels a frame, and errors add up. Here the point itself is projected.
// note: The text compares post-projection z of old and new pixel and says they match whatever moves, which is false. Here the
// note: distance of the point is compared with the distance buffer at its new place, within the slope of a few pixels.
// note: The text takes 5 % of the new orientation, a third of the colour and 90 % of the opacity in a frame. The last fades in
// note: a frame, against "seamless"; 10 % may be meant. All are rates a sixtieth of a second here, at any frame rate.
// equation: share in a step of s seconds: 1 − (1 − rate)^(60 s);  x ← x + share (goal − x), angles by the shorter way modulo π
// equation: across the gradient (gx, gy) of the picture: φ = atan2(gx, −gy)
// error: rates within 1e-6, over many frames 1e-5; test painterly/stroke_functions::rates_are_the_same_at_any_frame_rate.
// error: orientations within 5e-6; test painterly/stroke_functions::orientations_turn_the_shorter_way_modulo_half_a_turn.
// error: directions in the picture within 2e-4;
// error: test painterly/stroke_functions::strokes_lie_at_right_angles_to_the_gradient_in_the_picture.
// parameter old, goal: radians.
// parameter rate: share of the way, 0..1.
// parameter world: metres in the world.
// parameter picture_size: pixels.
// parameter seconds: from 0 up.
// parameter otherwise: radians.
// parameter orientation: radians, -pi/2..pi/2.

#import airlight::core::camera::{Camera, Ray}
#import airlight::painterly::iso_surface::{direction_in_picture, distance_tolerance}
#import airlight::painterly::stroke::{
    Stroke, StrokeStyle, STROKE_GONE, STROKE_STAYS, STROKE_HIDDEN, ALONG_CURVATURE, FIXED_ANGLE, of_layer, target_opacity
}
#import airlight::painterly::stroke_expand::varied_size

/// Strokes fainter than this are not seen: a new one begins with it, and one that fades out ends below it.
const LEAST_OPACITY: f32 = 0.00392156862745098;
/// Where the normal is within this sine of the view ray, its direction in the picture means nothing.
const LEAST_SINE: f32 = 0.02;
const PI: f32 = 3.141592653589793;

/// What the ray caster says of a pixel.
struct SurfaceTexel {
    /// Scene-linear RGB.
    color: vec3<f32>,
    /// Metres along the view ray; negative where there is no surface.
    distance: f32,
    /// Unit normal in the world.
    normal: vec3<f32>,
    /// Gradient magnitude; negative where there is no surface.
    magnitude: f32,
    /// (cos 2a, sin 2a) of the picture's direction of greatest curvature, x right, y down; 0 where there is none.
    curvature: vec2<f32>,
}

/// A point before the camera.
struct SeenPoint {
    /// In the picture: (0, 0) top left, (1, 1) bottom right.
    position: vec2<f32>,
    /// Normalised device coordinates.
    ndc: vec2<f32>,
    /// Within the picture and its depth.
    inside: bool,
}

/// Share of the way that is gone in a step of `seconds` where `rate`, 0..1, is that of a sixtieth of a second.
fn rate_of_step(rate: f32, seconds: f32) -> f32 {
    let left = clamp(1.0 - rate, 0.0, 1.0);
    // The logarithm of 0 times 0 would be NaN.
    let kept = exp2(60.0 * max(seconds, 0.0) * log2(max(left, 1e-30)));
    return select(1.0 - kept, select(1.0, 0.0, seconds <= 0.0), left == 0.0);
}

/// `angle`, radians, modulo pi in -pi/2 .. pi/2, the upper end excluded.
fn wrapped_orientation(angle: f32) -> f32 {
    return angle - PI * floor(angle / PI + 0.5);
}

/// An orientation on its way to another by the shorter turn.
fn approached_orientation(old: f32, goal: f32, rate: f32) -> f32 {
    return wrapped_orientation(old + rate * wrapped_orientation(goal - old));
}

/// Where a point of the world, metres, is seen.
fn seen_point(camera: Camera, world: vec3<f32>) -> SeenPoint {
    let clip = camera.clip_from_world * vec4<f32>(world, 1.0);
    let before = clip.w > 1e-12;
    let inside = before && all(abs(clip.xy) < vec2<f32>(clip.w)) && clip.z >= 0.0 && clip.z <= clip.w;
    let ndc = clamp(clip.xy / select(1.0, clip.w, before), vec2<f32>(-4.0), vec2<f32>(4.0));
    return SeenPoint(ndc * vec2<f32>(0.5, -0.5) + 0.5, ndc, inside);
}

/// Whether a point at the distance `predicted`, metres along `ray`, is the surface that a pixel shows. `footprint`: metres
/// across a pixel there. `tolerance`: pixels.
fn is_seen(predicted: f32, surface: SurfaceTexel, ray: Ray, footprint: f32, tolerance: f32) -> bool {
    let cosine = max(abs(dot(surface.normal, ray.direction)), 0.1);
    let bends = 0.5 * tolerance * footprint + 1e-5 * predicted;
    let allowed = distance_tolerance(footprint, cosine, tolerance, bends);
    return surface.distance >= 0.0 && abs(surface.distance - predicted) <= allowed;
}

/// Orientation that a stroke on a surface has by its style, radians, -pi/2 .. pi/2; `otherwise` where the surface has none.
/// `ray`: view ray to the point.
fn surface_orientation(
    camera: Camera, world: vec3<f32>, ray: Ray, surface: SurfaceTexel, style: StrokeStyle, picture_size: vec2<f32>,
    otherwise: f32
) -> f32 {
    let gradient = direction_in_picture(camera, world, surface.normal, picture_size);
    let cosine = dot(surface.normal, ray.direction);
    let oblique = 1.0 - cosine * cosine > LEAST_SINE * LEAST_SINE && any(gradient != vec2<f32>(0.0));
    let across = atan2(gradient.x, select(1.0, -gradient.y, oblique));
    let along = select(otherwise - style.angle, across, oblique);
    let curved = any(surface.curvature != vec2<f32>(0.0)) && style.orientation == ALONG_CURVATURE;
    let twice = select(vec2<f32>(1.0, 0.0), surface.curvature, curved);
    let chosen = select(along, 0.5 * atan2(twice.y, twice.x), curved);
    return wrapped_orientation(select(chosen, 0.0, style.orientation == FIXED_ANGLE) + style.angle);
}

/// A stroke after a step of `seconds`. `surface`: what it follows. `orientation`: that the surface gives it. `state`: its new one.
fn updated_stroke(
    stroke: Stroke, surface: SurfaceTexel, orientation: f32, state: u32, style: StrokeStyle, seconds: f32
) -> Stroke {
    var next = stroke;
    let goal = target_opacity(style, stroke.layer, state);
    let hides = state == STROKE_HIDDEN;
    let fading = select(style.fade_out_rate, max(style.fade_out_rate, style.hidden_rate), hides);
    let rate = rate_of_step(select(fading, style.opacity_rate, state == STROKE_STAYS), seconds);
    next.opacity = clamp(mix(stroke.opacity, goal, rate), 0.0, 1.0);
    next.state = select(state, STROKE_GONE, state != STROKE_STAYS && next.opacity < LEAST_OPACITY);
    // What is hidden has nothing to follow.
    let follows = select(1.0, 0.0, hides);
    next.color = mix(stroke.color, surface.color, follows * rate_of_step(style.color_rate, seconds));
    next.orientation = approached_orientation(
        stroke.orientation, orientation, follows * rate_of_step(style.orientation_rate, seconds)
    );
    let size = varied_size(of_layer(style.size, stroke.layer), stroke.hash, style.size_variation);
    next.size = mix(stroke.size, size, rate_of_step(style.size_rate, seconds));
    next.aspect = of_layer(style.aspect, stroke.layer);
    return next;
}
