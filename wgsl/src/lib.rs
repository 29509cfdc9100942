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
//! ```ignore
//! for module in airlight_wgsl::MODULES {
//!     composer.add_composable_module(ComposableModuleDescriptor {
//!         source: module.source, file_path: module.file, ..Default::default()
//!     })?;
//! }
//! ```

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

mod list;

pub use list::{MODULES, PASSES, SYSTEMS};
