// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rank structure on the GPU: counts against brute force over the stepped map, weighted means against their proven
//! bound, pictures against the exact ones, and settings that are refused.

mod counts;
mod pictures;
mod weighted;
mod weights;
