// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions out of every range, which the passes must survive.

use super::gpu::Random;
use airlight::stylize::TransferFunction;

/// Another one in each round; it never asks for the mean distance of lit points.
pub fn wild_function(random: &mut Random, round: usize) -> TransferFunction {
    TransferFunction {
        across: random.below(4) as u32,
        down: random.below(4) as u32,
        mode: round as u32 % 3,
        phase: round as u32 % 2,
        depth_limit: [0.0, 3e38, -1.0, 1e-38][round % 4],
        strength: [1.0, 3e38, 0.5][round % 3],
        brightness: [3e38, 1.0, -3e38][round / 3 % 3],
        g: [0.0, 3e38, -3e38, 0.9][round / 2 % 4],
    }
}
