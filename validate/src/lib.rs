// SPDX-License-Identifier: MIT OR Apache-2.0
//! Composes, reflects and validates Airlight's WGSL.
//!
//! [`Library`] holds modules, passes and permutations, either those that ship with Airlight
//! ([`Library::builtin`]) or a folder laid out like `wgsl/` ([`Library::from_directory`]).
//! [`Library::compose`] makes one `naga::Module` of a pass and everything it imports, with readable
//! names; [`Composed::reflect`] says what a host has to bind. Nothing here needs a device.
//!
//! ```
//! use airlight_validate::{Definitions, Library};
//!
//! let library = Library::builtin();
//! let definitions = Definitions::new().set("BASES", 32).flag("RGBA16FLOAT");
//! assert_eq!(definitions.to_string(), "BASES=32 RGBA16FLOAT");
//! assert!(library.passes().iter().any(|pass| pass.name == "scattering/filter"));
//! ```
//!
//! The feature `command` (default) adds the checks against every back end, the manifest, and the
//! command-line program; without it the crate is naga and a composer.

mod compose;
mod definitions;
mod error;
#[cfg(feature = "command")]
mod files;
mod imports;
mod library;
mod locate;
mod names;
mod permutations;
mod reflect;
mod scan;
#[cfg(feature = "command")]
mod threads;
pub mod wesl;

#[cfg(feature = "command")]
pub mod abi;
#[cfg(feature = "command")]
pub mod check;
#[cfg(feature = "command")]
pub mod docs;
#[cfg(feature = "command")]
pub mod flat;
#[cfg(feature = "command")]
pub mod list;
#[cfg(feature = "command")]
pub mod manifest;
#[cfg(feature = "command")]
pub mod tree;
#[cfg(feature = "command")]
pub mod vendor;

pub use compose::{Composed, core_capabilities};
pub use definitions::{Definition, Definitions};
pub use error::{Error, Location};
#[cfg(feature = "command")]
pub use files::files_below;
pub use library::{Library, ModuleSource, PassSource};
pub use permutations::Permutation;
pub use reflect::{
    Access, Binding, BindingKind, EntryPoint, Interface, Member, Reflection, Sample, Stage, StructLayout,
    TextureDimension, format_name,
};

/// The naga that the composed modules belong to.
pub use naga;
