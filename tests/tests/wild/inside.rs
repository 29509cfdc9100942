// SPDX-License-Identifier: MIT OR Apache-2.0
//! Textures that the library's own passes make: finite, as the tests of those passes hold, so that who reads them need not look
//! again. All other textures are from outside.

/// A pass, and which of its textures are made by which passes.
const INSIDE: &[(&str, &str)] = &[
    // ambient/occlude, blur_bent, upsample_bent, halve_geometry, convolve_cones, reduce_environment.
    ("ambient/blur_bent", "bent"),
    ("ambient/convolve_cones", "radiance"),
    ("ambient/shade_bent", "bent lights"),
    ("ambient/upsample_bent", "halved_depth halved_normals bent"),
    // core/brick_ranges.
    ("core/brick_occupied", "ranges"),
    // inverse/ray_spans, pack_volume, render_slices, weigh_slices, light_depths, scatter_light, picture_sums.
    ("inverse/cg_backproject", "spans weighed picture"),
    ("inverse/combine_light", "volume"),
    ("inverse/keep_column", "rendered"),
    ("inverse/light_columns", "residual"),
    ("inverse/light_depths", "extinction"),
    ("inverse/light_products", "volume"),
    ("inverse/picture_sums", "rendered"),
    ("inverse/render_slices", "spans extinction emission albedo scattered"),
    ("inverse/scatter_light", "depths"),
    ("inverse/scatter_steps", "spans extinction scattered"),
    ("inverse/weigh_slices", "spans extinction scattered picture"),
    // painterly/stroke_density.
    ("painterly/stroke_population", "density"),
    // core/brick_ranges, and a table that is said to be finite.
    ("painterly/solid_bricks", "ranges transfer"),
    ("painterly/iso_raycast", "transfer"),
    // scattering/slices, filter.
    ("scattering/", "slices bases"),
    ("stylize/evaluate", "slices bases"),
    // splatting/splat_sheet, surfaces, light_sheet, scatter_sheet, and a table that is said to be finite.
    (
        "splatting/",
        "sheet light_sheet shadow transfer before behind eye_heights light_heights held shadow_back",
    ),
    ("splatting/", "heights light_exit_heights"),
    // stylize/disc, sliding_extremum.
    ("stylize/disc", "accumulated"),
    ("stylize/epipolar_return", "lines"),
];

/// Whether a texture of a pass is made by another pass.
pub fn is_made_inside(pass: &str, binding: &str) -> bool {
    INSIDE.iter().any(|(of, names)| pass.starts_with(of) && names.split(' ').any(|name| name == binding))
}
