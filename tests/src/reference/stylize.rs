// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stylization.

pub mod holes;
