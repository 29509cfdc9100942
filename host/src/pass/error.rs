// SPDX-License-Identifier: MIT OR Apache-2.0
//! Why a pass could not be built or bound.

use crate::gpu::GpuError;

/// Why a pass could not be built or bound.
#[derive(Debug, thiserror::Error)]
pub enum PassError {
    /// The shader does not compose, or there is no such pass or permutation.
    #[error(transparent)]
    Shader(#[from] airlight_validate::Error),
    /// The device refused.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A resource was named that the pass does not have.
    #[error("{pass} has no binding `{name}`; it expects {expected}")]
    UnknownBinding {
        /// The pass.
        pass: String,
        /// The unknown name.
        name: String,
        /// All that it expects.
        expected: String,
    },
    /// A resource was not given.
    #[error("{pass} needs the binding `{name}`; it expects {expected}")]
    MissingBinding {
        /// The pass.
        pass: String,
        /// The missing name.
        name: String,
        /// All that it expects.
        expected: String,
    },
    /// A resource of the wrong type.
    #[error("{pass}: binding `{name}` is {wanted}, not {given}")]
    WrongResource {
        /// The pass.
        pass: String,
        /// The binding.
        name: String,
        /// What the shader declares.
        wanted: String,
        /// What was given.
        given: String,
    },
    /// An entry point that the pass does not have.
    #[error("{pass} has no entry point `{name}`; it has {expected}")]
    UnknownEntryPoint {
        /// The pass.
        pass: String,
        /// The unknown name.
        name: String,
        /// Those it has.
        expected: String,
    },
}
