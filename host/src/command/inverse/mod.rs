// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes and light found from painted views: what goes in.
#![allow(dead_code, unused_imports)]

mod paint;
mod views;
