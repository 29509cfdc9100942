// SPDX-License-Identifier: MIT OR Apache-2.0
//! A small volume to paint: a great lump in front, a small one behind and above.
#![allow(dead_code, clippy::unwrap_used)]

use super::npy;
use std::path::Path;

/// Voxels along z, y and x.
pub const SHAPE: [usize; 3] = [28, 20, 24];

/// Values from 0 to about 1, z slowest.
pub fn values() -> Vec<f32> {
    let lump = |[x, y, z]: [f32; 3], center: [f32; 3], radius: f32| {
        let [dx, dy, dz] = [x - center[0], y - center[1], z - center[2]];
        (-(dx * dx + dy * dy + dz * dz) / (radius * radius)).exp()
    };
    let mut values = Vec::new();
    for z in 0..SHAPE[0] {
        for y in 0..SHAPE[1] {
            for x in 0..SHAPE[2] {
                let at = [x, y, z].map(|i| i as f32);
                let ripple = 0.08 * (0.9 * at[0]).sin() * (1.1 * at[1]).cos();
                let great = lump(at, [11.0, 9.0, 18.0], 7.5);
                values.push((great * (1.0 + ripple)).max(0.9 * lump(at, [13.0, 12.0, 5.0], 4.0)));
            }
        }
    }
    values
}

/// A folder with the volume `lumps.npy`.
pub fn folder() -> tempfile::TempDir {
    let at = tempfile::tempdir().unwrap();
    write(&at.path().join("lumps.npy"));
    at
}

/// Writes it.
pub fn write(path: &Path) {
    npy::write_f32(path, &SHAPE, &values());
}
