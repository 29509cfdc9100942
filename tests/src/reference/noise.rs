// SPDX-License-Identifier: MIT OR Apache-2.0
//! Gradient noise in f64, from its definition: each corner of the cell has a unit gradient, whose product with the way from
//! the corner counts with the product of two fades.

use std::f64::consts::TAU;

const WORD: u64 = 1 << 32;

/// PCG3D (Jarzynski and Olano 2020) modulo 2^32.
#[must_use]
pub fn hash(key: [u64; 3]) -> [u64; 3] {
    let mut v = key.map(|k| (k % WORD * 1_664_525 + 1_013_904_223) % WORD);
    for round in 0..2 {
        for i in 0..3 {
            let product = v[(i + 1) % 3] * v[(i + 2) % 3] % WORD;
            v[i] = (v[i] + product) % WORD;
        }
        if round == 0 {
            v = v.map(|x| x ^ (x / 65_536));
        }
    }
    v
}

/// The unit gradient of a lattice point: its angle is the first hash over 2^32 of a turn, less an eighth.
#[must_use]
pub fn gradient(x: i64, y: i64, seed: u32) -> [f64; 2] {
    let word = |k: i64| k.rem_euclid(WORD as i64) as u64;
    let turns = hash([word(x), word(y), u64::from(seed)])[0] as f64 / WORD as f64 - 0.125;
    [(TAU * turns).cos(), (TAU * turns).sin()]
}

/// The noise at a position in cells.
#[must_use]
pub fn noise(x: f64, y: f64, seed: u32) -> f64 {
    let mut sum = 0.0;
    for corner_y in [y.floor(), y.floor() + 1.0] {
        for corner_x in [x.floor(), x.floor() + 1.0] {
            let [to_x, to_y] = [x - corner_x, y - corner_y];
            let [g_x, g_y] = gradient(corner_x as i64, corner_y as i64, seed);
            sum += fade(1.0 - to_x.abs()) * fade(1.0 - to_y.abs()) * (g_x * to_x + g_y * to_y);
        }
    }
    sum
}

/// 6 t^5 − 15 t^4 + 10 t^3.
#[must_use]
pub fn fade(t: f64) -> f64 {
    6.0 * t.powi(5) - 15.0 * t.powi(4) + 10.0 * t.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero_on_the_lattice_with_the_gradient_as_slope() {
        for (x, y) in [(0, 0), (3, -2), (-70_000, 12)] {
            let (fx, fy) = (f64::from(x), f64::from(y));
            let step = 1e-6;
            assert!(noise(fx, fy, 9).abs() < 1e-15);
            let slope = [noise(fx + step, fy, 9), noise(fx, fy + step, 9)].map(|v| v / step);
            let gradient = gradient(i64::from(x), i64::from(y), 9);
            assert!((slope[0] - gradient[0]).abs() < 1e-4 && (slope[1] - gradient[1]).abs() < 1e-4);
        }
    }
}
