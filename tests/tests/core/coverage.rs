// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which test holds which function of the core modules.

/// Every function of the core modules, each with a test here or in one of `core_*.rs`.
const COVERED: [(&str, &[&str]); 21] = [
    // In tests/tests/painterly/iso_raycast.rs, by what rays find and see.
    ("transfer_function", &["classified"]),
    // In tests/tests/core/cosine.rs.
    (
        "cosine_basis",
        &[
            "harmonics_first",
            "harmonics_next",
            "harmonics_sum",
            "cosine_orders",
            "cosine_basis",
            "cosine_integral",
            "sine_over_angle",
            "cosine_spread",
            "fejer_window",
        ],
    ),
    // In tests/tests/scattering/moments/bounds.rs, the bounds as a whole and the roots alone.
    (
        "moment_bounds",
        &[
            "chebyshev",
            "moments_at",
            "mix_moments",
            "moment_factors",
            "orthogonal_polynomials",
            "greatest_weight",
            "cosine_of_third",
            "newton_step",
            "greatest_cubic_root",
            "share_bounds",
        ],
    ),
    (
        "camera",
        &[
            "ndc_from_pixel",
            "view_ray",
            "perspective_ray",
            "towards_viewer",
            "distance_from_depth",
            "perspective_distance",
            "matrix_row",
            "side_normal",
            "forward_direction",
            "far_plane_distance",
        ],
    ),
    ("arc_cosine", &["arc_cosine"]),
    ("tangent_frame", &["tangent_frame"]),
    ("color", &["luminance", "tone_curve", "srgb_from_linear"]),
    ("finite", &["is_finite", "finite_or", "finite_or_rgb"]),
    (
        "fourier_basis",
        &[
            "guarded",
            "sine_cosine",
            "rotate",
            "series_at",
            "series_first",
            "series_next",
            "coefficients",
            "coefficients_lanczos",
            "coefficient_scale",
            "stored_from_basis",
            "basis_from_stored",
            "surface_bias",
        ],
    ),
    (
        "light",
        &[
            "direction_to_light",
            "angular_falloff",
            "light_falloff",
            "texels_from_clip",
            "point_from_texels",
            "shadow_position",
            "shadow_point",
            "metres_of_texel",
            // Takes a texture: tests/tests/stage.rs holds it by what it does to surfaces.
            "light_texture_color",
        ],
    ),
    ("phase", &["isotropic", "henyey_greenstein"]),
    ("prefix_sum", &["row_weights", "row_weights_next", "running_mean", "one_minus_exp", "prefix_weight"]),
    ("shadow_views", &["view_contains", "or_in_view", "clip_in_views", "view_position", "point_at_depth"]),
    ("jitter", &["gradient_noise_offset", "blue_noise_offset"]),
    ("ray_depth", &["ray_depth", "distance_on_ray", "depth_on_ray"]),
    ("resolve_depth", &["averaging_extinction", "distance_of_transmittance"]),
    ("picture", &["picture_corner"]),
    // In tests/tests/core/bricks.rs; runs of samples as wholes in tests/tests/transmittance/bricks.rs.
    ("bricks", &["brick_count", "brick_at", "samples_alike", "run_of_samples"]),
    ("volume", &["segment_in_box", "march_steps", "voxel_at", "metres_across"]),
    // In tests/tests/core/sort.rs.
    ("sort", &["ascending_key", "key_digit", "one_counted", "counted_together", "counted"]),
    // In tests/tests/core/noise.rs.
    (
        "noise",
        &[
            "hash_of_three",
            "unit_from_hash",
            "direction_from_hash",
            "quintic_fade",
            "corner_slope",
            "gradient_noise_in_cell",
            "gradient_noise",
        ],
    ),
];

#[test]
fn every_function_of_the_core_has_a_test_here() {
    let mut functions = Vec::new();
    for module in airlight_wgsl::MODULES.iter().filter(|module| module.file.starts_with("core/")) {
        let name = module.path.rsplit("::").next().unwrap();
        for line in module.source.lines() {
            if let Some(rest) = line.strip_prefix("fn ") {
                functions.push((name, rest.split('(').next().unwrap()));
            }
        }
    }
    let covered: Vec<_> =
        COVERED.iter().flat_map(|(module, names)| names.iter().map(move |name| (*module, *name))).collect();
    let missing: Vec<_> = functions.iter().filter(|function| !covered.contains(function)).collect();
    let gone: Vec<_> = covered.iter().filter(|function| !functions.contains(function)).collect();
    assert!(missing.is_empty() && gone.is_empty(), "without a test: {missing:?}; no longer there: {gone:?}");
}
