// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shader library as the host composes it.

use airlight_validate::{Composed, Definitions, Error, Library};

/// Modules and passes, composed on demand.
pub struct Shaders {
    library: Library,
}

impl Shaders {
    /// The library that this crate was built with.
    pub fn builtin() -> Self {
        Self { library: Library::builtin() }
    }

    /// A library of the caller's, for instance from a folder.
    pub fn from_library(library: Library) -> Self {
        Self { library }
    }

    /// The library itself: modules, passes, permutations.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// A pass in one of its shipped permutations.
    ///
    /// # Errors
    /// An unknown pass or permutation, or what composition says, with the file and line of the module.
    pub fn compose(&self, pass: &str, permutation: &str) -> Result<Composed, Error> {
        let definitions = self.library.permutation(pass, permutation)?.definitions.clone();
        self.library.compose(pass, &definitions)
    }

    /// A pass with definitions of the caller's.
    ///
    /// # Errors
    /// As [`Shaders::compose`].
    pub fn compose_with(&self, pass: &str, definitions: &Definitions) -> Result<Composed, Error> {
        self.library.compose(pass, definitions)
    }
}
