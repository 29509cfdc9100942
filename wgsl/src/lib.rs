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

mod list;

pub use list::{MODULES, PASSES, SYSTEMS};

/// The examples of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
