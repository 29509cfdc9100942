// SPDX-License-Identifier: MIT OR Apache-2.0
//! Six moments of a rectified map on the GPU: bounds and reads against the f64 reference, the filter against prefix
//! means, and the error that six moments leave on scenes.

mod bounds;
mod filter;
mod pictures;
mod weights;
