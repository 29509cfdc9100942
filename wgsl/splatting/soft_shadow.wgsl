// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::splatting::soft_shadow
// summary: Soft shadows of area lights: layers of the shadow buffer by depth, and how deep solids behind a surface are.
// source: Zhang and Crawfis, 5.1; Soler and Sillion, "Fast calculation of soft shadow textures using convolution" (1998).
// note: The light lies in a plane parallel to the sheets. Let n be their normal, o + d n the plane at distance d from the light's
// note: middle, and s what a ray from that middle has in every plane: the offset over d. A ray from a point e of the light meets
// note: s_o in the plane d_o of an occluder and s_o - e (1/d_o - 1/d) in the plane d of a receiver. So with q = -1/d a light of side w
// note: casts a penumbra of width w (q - q_o), linear in q. Of a directional light s is the point's own offset along parallel
// note: rays, q the height, and w the width of the light's directions, metres per metre of height.
// note: A square light makes a linear ramp of that width, whose 10-90 % width is 0.8 of it. A Gaussian of standard deviation c has
// note: 2.563 c between 10 and 90 %: c = 0.312 w (q - q_o) has the same. So the blur of an occluder has the variance
// note: (0.312 w)^2 (q - q_o)^2 at q: of each sheet's step from q to q' it needs (0.312 w)^2 ((q' - q_o)^2 - (q - q_o)^2), which depends on the
// note: occluder. One running buffer, in which all occluders get the same, cannot give that. So occluders are held in
// note: layers by depth, each with a reference q_m of its own in place of q_o, and light is the product of all layers.
// note: The host says for each sheet which layer takes it up, which two are merged before, and how much each is blurred after.
// note: Surfaces are held in two ways, since layers of one solid are not independent. Kept: what each sheet newly takes of
// note: the light's middle rays, which adds up over layers: right for what a slanted surface is cut into, and too bright where
// note: something behind lies in the shadow of an edge. Filled: the solids behind surfaces, of which the darkest
// note: layer counts: right there, and too bright between the cuts of a slanted surface. Both are too bright where they are
// note: wrong, so the darker is taken.
// equation: variance at q of an occluder at q_o: (0.312 w)² (q − q_o)²,  q = −1 / distance of the light, or height
// equation: light = Π layers × min(1 − Σ taken, darkest)
// error: penumbras within 10 % of their width; test splatting/soft/half_planes::penumbras_of_half_planes_have_their_width_at_any_tilt.
// error: a point of light casts hard shadows; test splatting/soft/limits::a_point_of_light_casts_hard_shadows.
// parameter height: metres along the normal; NO_SURFACE for none.
// parameter side: metres of a texel along both axes.
// parameter slope: metres per metre, from 0 up.
// parameter index: number of the sheet, from 0.
// parameter least, end: metres along the normal.

#import airlight::splatting::surface_shadow::is_surface

/// Layers of the shadow buffer.
const SOFT_LAYERS: u32 = 16u;

/// What a sheet does with layers. 8 bytes.
struct LayerMerge {
    /// The layer that takes up the sheet, 0..15.
    open: u32,
    /// The layer that takes in what was in that one before; 16 where it was empty.
    into: u32,
}

/// How a layer is blurred from one sheet to the next. 16 bytes.
struct LayerBlur {
    /// Variance along columns and rows of the buffer, in squares of the taps' distance.
    variance: vec2<f32>,
    /// Distance of taps, texels.
    distance: vec2<u32>,
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
