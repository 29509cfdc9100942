// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every struct that host and shaders share lies in memory as naga says: each field is written alone
//! through encase, and its bytes are looked for at the offset that reflection reports.
#![allow(clippy::unwrap_used)]

mod comparison;
mod sentinels;
mod twins;
