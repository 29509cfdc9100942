// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
//! Airlight's WGSL as text, without dependencies.
//!
//! A shader is three things here. An *algorithm module* ([`MODULES`]) holds pure functions, structs
//! and constants: no bindings, no entry points. A *callback* (`lit`, `prefiltered`,
//! `column_weights`, `rank_sort`, `evaluated` with its two variants, `map_form`, `map_texels`, `transmittance_map` and
//! `stroke_targets`, among the modules)
//! holds bindings that several passes share behind functions, for an engine to replace. A
//! *pass* ([`PASSES`]) holds bindings, entry points and loops over texels. All are written for `naga_oil`; any version of its `Composer` is filled
//! in five lines, because the modules are listed so that each follows what it imports:
//!
//! ```
//! # #[derive(Default)]
//! # struct ComposableModuleDescriptor<'a> { source: &'a str, file_path: &'a str, as_name: Option<String> }
//! # #[derive(Default)]
//! # struct Composer { paths: std::collections::BTreeSet<String> }
//! # impl Composer {
//! #     fn add_composable_module(&mut self, module: ComposableModuleDescriptor) -> Result<(), String> {
//! #         let path = |line: &str| line.split_whitespace().nth(1).map(str::to_owned);
//! #         let own = module.source.lines().find(|line| line.starts_with("#define_import_path")).and_then(path);
//! #         let listed = airlight_wgsl::MODULES.iter().find(|other| other.file == module.file_path);
//! #         if let Some(late) = listed.into_iter().flat_map(|m| m.imports).find(|import| !self.paths.contains(**import)) {
//! #             return Err(format!("{} comes before {late}", module.file_path));
//! #         }
//! #         self.paths.insert(own.ok_or("no path")?);
//! #         Ok(())
//! #     }
//! # }
//! # let mut composer = Composer::default();
//! for module in airlight_wgsl::MODULES {
//!     composer.add_composable_module(ComposableModuleDescriptor {
//!         source: module.source, file_path: module.file, ..Default::default()
//!     })?;
//! }
//! # assert_eq!(composer.paths.len(), airlight_wgsl::MODULES.len());
//! # Ok::<(), String>(())
//! ```
//!
//! An engine that wants one function adds its module and what that needs, in the same order:
//!
//! ```
//! use airlight_wgsl::MODULES;
//! use std::collections::BTreeSet;
//!
//! let mut wanted = BTreeSet::from(["airlight::core::jitter"]);
//! // Backwards, so that whoever imports a module was seen before it.
//! for module in MODULES.iter().rev() {
//!     if wanted.contains(module.path) {
//!         wanted.extend(module.imports);
//!     }
//! }
//! let files: Vec<&str> = MODULES.iter().filter(|m| wanted.contains(m.path)).map(|m| m.file).collect();
//! assert_eq!(files, ["core/finite.wgsl", "core/jitter.wgsl"]);
//! ```
//!
//! A pass is composed with one of its sets of definitions, from its system's `permutations`:
//!
//! ```
//! use airlight_wgsl::{PASSES, SYSTEMS};
//!
//! let pass = PASSES.iter().find(|pass| pass.name == "scattering/filter").expect("a pass of this version");
//! let system = SYSTEMS.iter().find(|system| system.name == "scattering").expect("a system of this version");
//! // A pass begins a paragraph; `+ name: DEFINITION DEFINITION=VALUE` are its sets.
//! let own = system.permutations.split("\n\n").find_map(|text| {
//!     let mut lines = text.lines().filter(|line| !line.starts_with('#'));
//!     (lines.next() == Some("filter")).then(|| lines.collect::<Vec<_>>())
//! });
//! let own = own.expect("every pass is listed");
//! assert_eq!(own[0], "+ default: BASES=32 BASES_PER_THREAD=8");
//! assert!(pass.source.contains("#{BASES}"));
//! ```
//!
//! With the feature `flat`, `FLAT` holds every permutation of every pass as one file without directives, for
//! programs without a composer.

/// An algorithm module or callback: functions, structs and constants that an engine imports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Module {
    /// Import path, `airlight::<system>::<module>`.
    pub path: &'static str,
    /// File relative to the root of this crate, `<system>/<module>.wgsl`.
    pub file: &'static str,
    /// The WGSL text, with `naga_oil` directives.
    pub source: &'static str,
    /// Import paths of the modules it uses, all of them earlier in [`MODULES`].
    pub imports: &'static [&'static str],
}

/// A pass: bindings in `@group(#{GROUP})`, entry points, and the loops over texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Name, `<system>/<pass>`.
    pub name: &'static str,
    /// File relative to the root of this crate, `<system>/passes/<pass>.wgsl`.
    pub file: &'static str,
    /// The WGSL text, with `naga_oil` directives.
    pub source: &'static str,
}

/// A system: one folder of modules and passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct System {
    /// Its name, the same in WGSL, Rust, the command and the documentation.
    pub name: &'static str,
    /// The text of `<system>/permutations`: each pass with its named sets of definitions.
    pub permutations: &'static str,
}

/// File names and texts of the licences; a copy of a shader may go by any of them.
pub const LICENCES: [(&str, &str); 3] = [
    ("LICENSE-MIT", include_str!("../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../LICENSE-APACHE")),
    ("UNLICENSE", include_str!("../UNLICENSE")),
];

macro_rules! modules {
    ($($system:ident :: $module:ident [$($import:literal),*]),* $(,)?) => {
        /// Every algorithm module, each after the modules that it imports.
        pub const MODULES: &[Module] = &[$(Module {
            path: concat!("airlight::", stringify!($system), "::", stringify!($module)),
            file: concat!(stringify!($system), "/", stringify!($module), ".wgsl"),
            source: include_str!(concat!("../", stringify!($system), "/", stringify!($module), ".wgsl")),
            imports: &[$(concat!("airlight::", $import)),*],
        }),*];
    };
}

macro_rules! passes {
    ($($system:ident / $pass:ident),* $(,)?) => {
        /// Every pass, in the order of the systems.
        pub const PASSES: &[Pass] = &[$(Pass {
            name: concat!(stringify!($system), "/", stringify!($pass)),
            file: concat!(stringify!($system), "/passes/", stringify!($pass), ".wgsl"),
            source: include_str!(concat!("../", stringify!($system), "/passes/", stringify!($pass), ".wgsl")),
        }),*];
    };
}

macro_rules! systems {
    ($($system:ident),* $(,)?) => {
        /// Every system.
        pub const SYSTEMS: &[System] = &[$(System {
            name: stringify!($system),
            permutations: include_str!(concat!("../", stringify!($system), "/permutations")),
        }),*];
    };
}

/// A permutation of a pass as stand-alone WGSL, without directives.
#[cfg(feature = "flat")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flat {
    /// Name of the pass, `<system>/<pass>`.
    pub pass: &'static str,
    /// Name of the permutation.
    pub permutation: &'static str,
    /// File relative to the root of this crate, `flat/<system>/<pass>.wgsl` for the permutation `default`, else
    /// `flat/<system>/<pass>.<permutation>.wgsl`.
    pub file: &'static str,
    /// The WGSL text; bindings in `@group(0)`.
    pub source: &'static str,
}

#[cfg(feature = "flat")]
macro_rules! flat {
    ($($pass:literal [$($permutation:literal),*]),* $(,)?) => {
        /// Every permutation of every pass as stand-alone WGSL, by the name of the pass; `default` first.
        pub const FLAT: &[crate::Flat] = &[$(
            crate::Flat {
                pass: $pass,
                permutation: "default",
                file: concat!("flat/", $pass, ".wgsl"),
                source: include_str!(concat!("../flat/", $pass, ".wgsl")),
            },
            $(crate::Flat {
                pass: $pass,
                permutation: $permutation,
                file: concat!("flat/", $pass, ".", $permutation, ".wgsl"),
                source: include_str!(concat!("../flat/", $pass, ".", $permutation, ".wgsl")),
            },)*
        )*];
    };
}
#[cfg(feature = "flat")]
pub(crate) use flat;

#[cfg(feature = "flat")]
#[path = "flat.rs"]
mod flat_list;
#[cfg(feature = "flat")]
pub use flat_list::FLAT;

modules! {
    core::finite [],
    core::camera [],
    core::light ["core::finite"],
    core::shadow_views ["core::light"],
    core::color [],
    core::fourier_basis [],
    core::cosine_basis ["core::fourier_basis"],
    core::moment_bounds [],
    core::phase [],
    core::picture [],
    core::prefix_sum [],
    core::sort [],
    core::jitter ["core::finite"],
    core::noise ["core::finite"],
    core::ray_depth ["core::camera"],
    core::resolve_depth [],
    core::transfer_function [],
    core::volume [],
    core::bricks [],
    core::tangent_frame [],
    core::arc_cosine [],
    transmittance::light_space ["core::light"],
    transmittance::map_texels ["core::finite"],
    transmittance::extinction_map ["core::cosine_basis", "transmittance::map_texels"],
    transmittance::bounded_map ["transmittance::extinction_map", "transmittance::map_texels"],
    transmittance::opacity_map ["core::cosine_basis", "core::fourier_basis", "transmittance::map_texels"],
    transmittance::function_map [
        "core::cosine_basis", "core::prefix_sum", "transmittance::map_texels", "transmittance::opacity_map"
    ],
    transmittance::transmittance_moments ["core::arc_cosine", "core::fourier_basis", "core::moment_bounds"],
    transmittance::particles ["core::finite", "core::light", "transmittance::light_space"],
    transmittance::medium ["core::finite", "core::phase", "core::prefix_sum", "core::volume"],
    transmittance::seen_particles ["core::camera", "transmittance::particles"],
    transmittance::map_form [
        "core::cosine_basis", "transmittance::extinction_map", "transmittance::opacity_map",
        "transmittance::transmittance_moments"
    ],
    transmittance::transmittance_map [
        "transmittance::bounded_map", "transmittance::extinction_map", "transmittance::function_map",
        "transmittance::map_texels", "transmittance::opacity_map", "transmittance::transmittance_moments"
    ],
    ambient::bent_cone [],
    ambient::sample_pattern [],
    ambient::occluders [],
    ambient::bent_blur [],
    ambient::seen_surface ["core::camera", "core::finite"],
    painterly::iso_surface ["core::camera", "core::finite"],
    painterly::spline ["painterly::iso_surface"],
    painterly::curvature [
        "core::camera", "core::finite", "core::tangent_frame", "painterly::iso_surface", "painterly::spline"
    ],
    painterly::advection ["core::finite", "core::noise", "painterly::curvature"],
    painterly::stroke [],
    painterly::stroke_placement ["core::noise", "painterly::stroke"],
    painterly::stroke_density [],
    painterly::stroke_expand ["painterly::stroke", "painterly::stroke_placement"],
    painterly::stroke_update [
        "core::camera", "painterly::iso_surface", "painterly::stroke", "painterly::stroke_expand"
    ],
    painterly::stroke_targets ["core::finite", "painterly::stroke_update"],
    inverse::slice_steps [],
    inverse::basis [],
    inverse::bent_rays ["core::finite", "inverse::slice_steps", "inverse::basis"],
    inverse::channels ["core::prefix_sum"],
    inverse::cg_backproject ["inverse::basis", "inverse::slice_steps"],
    inverse::fixed_point [],
    inverse::solver_steps [],
    inverse::group_sum [],
    inverse::light_layers ["inverse::slice_steps"],
    inverse::light_numbers [],
    splatting::sheets [],
    splatting::footprint [],
    splatting::splat ["core::camera"],
    splatting::surface_shadow ["splatting::sheets"],
    splatting::sheet_shading ["core::phase", "core::transfer_function"],
    splatting::blur [],
    splatting::light_scattering ["core::camera", "core::phase", "splatting::blur", "splatting::sheet_shading"],
    splatting::soft_shadow ["splatting::surface_shadow"],
    scattering::rectify ["core::camera", "core::fourier_basis"],
    scattering::rows [],
    scattering::projective ["core::fourier_basis", "core::prefix_sum"],
    scattering::single_scatter ["core::phase", "core::prefix_sum"],
    scattering::local_light [
        "core::camera", "core::phase", "scattering::rectify", "scattering::single_scatter"
    ],
    scattering::shadow_lookup ["core::finite", "core::light", "core::shadow_views"],
    scattering::visibility_fourier ["core::fourier_basis"],
    scattering::visibility_rank ["core::prefix_sum"],
    scattering::visibility_rank_weights ["scattering::visibility_rank"],
    scattering::visibility_wavelet ["scattering::visibility_rank"],
    scattering::rank_sort ["core::finite", "scattering::visibility_rank"],
    scattering::column_weights [
        "core::light", "scattering::local_light", "scattering::projective", "scattering::rectify",
        "scattering::single_scatter"
    ],
    scattering::visibility_moments ["core::fourier_basis", "core::moment_bounds"],
    scattering::march ["core::finite", "core::light", "core::prefix_sum"],
    scattering::upsample [],
    scattering::lit [
        "core::light", "core::phase", "core::shadow_views", "scattering::local_light", "scattering::march",
        "scattering::shadow_lookup"
    ],
    scattering::prefiltered [
        "scattering::rows", "scattering::visibility_fourier", "scattering::visibility_moments",
        "scattering::visibility_rank", "scattering::visibility_rank_weights", "scattering::visibility_wavelet"
    ],
    scattering::scattered_ray [],
    scattering::evaluated [
        "core::camera", "core::finite", "core::light", "core::prefix_sum", "scattering::lit",
        "scattering::prefiltered", "scattering::rectify", "scattering::rows", "scattering::scattered_ray",
        "scattering::single_scatter"
    ],
    scattering::evaluated_local [
        "core::camera", "core::finite", "core::light", "scattering::lit", "scattering::local_light",
        "scattering::prefiltered", "scattering::rectify", "scattering::rows", "scattering::scattered_ray",
        "scattering::single_scatter"
    ],
    scattering::evaluated_projective [
        "core::camera", "core::finite", "core::light", "scattering::prefiltered", "scattering::projective",
        "scattering::rows", "scattering::scattered_ray", "scattering::single_scatter"
    ],
    stylize::morphology [],
    stylize::epipolar_dilate ["core::finite"],
    stylize::perlin_holes ["core::noise"],
    stylize::tf_diffuse [],
    stylize::tf_layers [],
    stylize::tf_lookup ["core::arc_cosine", "core::camera", "core::finite", "core::light", "core::phase"],
    ambient::octahedral ["core::finite"],
    ambient::environment [],
    ambient::cone_light ["ambient::octahedral", "core::finite"],
}

passes! {
    core/raster,
    core/brick_distances, core/brick_occupied, core/brick_ranges, core/scan, core/sort,
    core/tonemap,
    core/resolve_depth,
    core/geometry,
    transmittance/voxels,
    transmittance/check_particles,
    transmittance/splat,
    transmittance/splat_fixed,
    transmittance/query,
    transmittance/march_volume,
    transmittance/light_particles,
    transmittance/render_particles,
    transmittance/composite,
    ambient/occlude,
    ambient/blur_bent,
    ambient/halve_geometry,
    ambient/upsample_bent,
    ambient/reduce_environment,
    ambient/convolve_cones,
    ambient/shade_bent,
    painterly/iso_raycast,
    painterly/shade,
    painterly/solid_bricks,
    painterly/advect,
    painterly/ridges,
    painterly/stroke_update,
    painterly/stroke_density,
    painterly/stroke_population,
    painterly/stroke_compact,
    painterly/stroke_order,
    painterly/underpaint,
    painterly/draw_strokes,
    inverse/ray_spans,
    inverse/render_slices,
    inverse/weigh_slices,
    inverse/cg_backproject,
    inverse/greatest_values,
    inverse/scatter_steps,
    inverse/scattered_sums,
    inverse/pack_volume,
    inverse/picture_sums,
    inverse/solver_volume,
    inverse/solver_scalars,
    inverse/light_depths,
    inverse/scatter_light,
    inverse/combine_light,
    inverse/light_products,
    inverse/keep_column,
    inverse/light_columns,
    splatting/find_splats,
    splatting/surfaces,
    splatting/order_splats,
    splatting/splat_sheet,
    splatting/light_sheet,
    splatting/scatter_sheet,
    splatting/composite_sheet,
    splatting/soft_light,
    splatting/soften_sheet,
    scattering/slices,
    scattering/rectify,
    scattering/rectify_projective,
    scattering/project,
    scattering/filter,
    scattering/filter_moments,
    scattering/rank,
    scattering/wavelet,
    scattering/rank_weights,
    scattering/evaluate,
    scattering/evaluate_projective,
    scattering/evaluate_local,
    scattering/march,
    scattering/march_light,
    scattering/reduce_depth,
    scattering/upsample,
    scattering/composite,
    stylize/sliding_extremum,
    stylize/disc,
    stylize/epipolar_direct,
    stylize/epipolar_return,
    stylize/hole_mask,
    stylize/punch_holes,
    stylize/diffuse,
    stylize/transfer_layer,
    stylize/transfer,
    stylize/evaluate,
}

systems![core, transmittance, ambient, painterly, inverse, splatting, scattering, stylize];

/// The examples of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
