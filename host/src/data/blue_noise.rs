// SPDX-License-Identifier: MIT OR Apache-2.0
//! A tile of blue noise by void and cluster (Ulichney, "The void-and-cluster method for dither array
//! generation", 1993).

use super::Random;
use std::sync::OnceLock;

/// Texels in a row and in a column of [`blue_noise`].
pub const BLUE_NOISE_SIDE: usize = 64;
/// Standard deviation of the neighbourhood in texels, as Ulichney recommends.
const SIGMA: f64 = 1.5;
/// Weights are whole numbers of this many bits: their sums are the same in any order.
const WEIGHT_BITS: i32 = 40;

/// The tile, row-major: each of the values (k + 1/2) / 4096 once, and it repeats without a seam. Computed on
/// the first call, in well under a second, and the same on every machine.
pub fn blue_noise() -> &'static [f32] {
    static TILE: OnceLock<Vec<f32>> = OnceLock::new();
    TILE.get_or_init(|| {
        let ranks = void_and_cluster(BLUE_NOISE_SIDE);
        let count = ranks.len() as f32;
        ranks.into_iter().map(|rank| (rank as f32 + 0.5) / count).collect()
    })
}

/// Points on a torus and how crowded each place is by them.
struct Pattern {
    side: usize,
    /// Weight of a point at each distance, wrapped.
    weights: Vec<i64>,
    points: Vec<bool>,
    crowding: Vec<i64>,
}

impl Pattern {
    fn new(side: usize) -> Self {
        let wrapped = |i: usize| i.min(side - i) as f64;
        let weight = |i: usize| {
            let (x, y) = (wrapped(i % side), wrapped(i / side));
            ((-(x * x + y * y) / (2.0 * SIGMA * SIGMA)).exp() * 2.0_f64.powi(WEIGHT_BITS)).round() as i64
        };
        let count = side * side;
        let weights = (0..count).map(weight).collect();
        Self { side, weights, points: vec![false; count], crowding: vec![0; count] }
    }

    fn set(&mut self, place: usize, point: bool) {
        self.points[place] = point;
        let (x, y) = (place % self.side, place / self.side);
        for row in 0..self.side {
            let weights = &self.weights[(row + self.side - y) % self.side * self.side..][..self.side];
            let crowding = &mut self.crowding[row * self.side..][..self.side];
            for (column, sum) in crowding.iter_mut().enumerate() {
                let weight = weights[(column + self.side - x) % self.side];
                *sum += if point { weight } else { -weight };
            }
        }
    }

    /// The most crowded point.
    fn cluster(&self) -> Option<usize> {
        (0..self.points.len()).filter(|i| self.points[*i]).max_by_key(|i| self.crowding[*i])
    }

    /// The least crowded place without a point.
    fn void(&self) -> Option<usize> {
        (0..self.points.len()).filter(|i| !self.points[*i]).min_by_key(|i| self.crowding[*i])
    }
}

/// The rank of each texel of a tile of `side` x `side`: each of 0 .. side^2 - 1 once.
fn void_and_cluster(side: usize) -> Vec<usize> {
    let count = side * side;
    let mut pattern = Pattern::new(side);
    let mut random = Random::new(1993);
    let initial = count.div_ceil(10);
    let mut placed = 0;
    while placed < initial {
        let place = random.below(count);
        if !pattern.points[place] {
            pattern.set(place, true);
            placed += 1;
        }
    }
    // Moves the most crowded point into the largest void until it would go back to where it was. Each move
    // lowers the total crowding, so that there is an end; the bound only makes it obvious.
    for _ in 0..10 * count {
        let Some(cluster) = pattern.cluster() else { break };
        pattern.set(cluster, false);
        let Some(void) = pattern.void() else { break };
        pattern.set(void, true);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; count];
    let start = pattern.points.clone();
    for rank in (0..initial).rev() {
        let Some(cluster) = pattern.cluster() else { break };
        pattern.set(cluster, false);
        ranks[cluster] = rank;
    }
    for place in (0..count).filter(|place| start[*place]) {
        pattern.set(place, true);
    }
    // All places together are crowded alike, so that beyond one half the largest void is Ulichney's tightest
    // cluster of places without points.
    for rank in initial..count {
        let Some(void) = pattern.void() else { break };
        pattern.set(void, true);
        ranks[void] = rank;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rank_is_there_once() {
        for side in [1, 2, 5, 16] {
            let mut ranks = void_and_cluster(side);
            ranks.sort_unstable();
            assert!(ranks.into_iter().eq(0..side * side));
        }
    }

    #[test]
    fn crowding_is_that_of_the_points() {
        let mut pattern = Pattern::new(8);
        for place in [3, 17, 60, 3, 17] {
            let point = !pattern.points[place];
            pattern.set(place, point);
        }
        let mut other = Pattern::new(8);
        other.set(60, true);
        assert_eq!(pattern.crowding, other.crowding);
        assert_eq!(other.cluster(), Some(60));
    }
}
