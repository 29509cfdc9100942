// SPDX-License-Identifier: MIT OR Apache-2.0
//! Diffusion of constraints against the converged solution in f64.

use super::baking::{at, baked, color, diffusion, greatest, premultiplied, random_color, transfer};
use crate::gpu::Random;
use crate::probing::{f, hold};
use airlight::stylize::Place;
use airlight_tests::reference::stylize::transfer as reference;

#[test]
fn diffusion_is_within_a_step_of_the_converged_solution() {
    let mut random = Random(11);
    let mut overall = 0.0_f64;
    let cases = [
        (256, &[2, 3, 8, 64][..]),
        (255, &[2, 5, 33]),
        (129, &[1, 2, 6, 64]),
        (101, &[3, 17]),
        (37, &[1, 2, 9, 64]),
        (33, &[2, 4]),
        (17, &[2, 5, 20]),
        (16, &[2, 7]),
        (5, &[1, 3]),
        (2, &[2]),
        (1, &[1, 3]),
    ];
    for (size, counts) in cases {
        for count in counts {
            let constraints: Vec<_> = (0..*count)
                .map(|_| at(random.unit() as f32, random.unit() as f32, random_color(&mut random)))
                .collect();
            let given: Vec<_> = constraints
                .iter()
                .map(|constraint| match &constraint.place {
                    Place::At(at) => ([f(at.x), f(at.y)], premultiplied(&constraint.color)),
                    _ => unreachable!(),
                })
                .collect();
            let expected = reference::diffused(&given, size as usize);
            let error = greatest(&baked(&transfer(size, vec![diffusion(constraints)])), &expected);
            println!("{count} constraints on {size}: {error:.1e}");
            overall = overall.max(error);
        }
    }
    // Nearly all of it is rounding to rgba16float, twice: the layer, and the function.
    hold("diffusion", overall, 1.0 / 255.0);
    hold("diffusion, as the book has it", overall, 1.0 / 3.0 / 255.0);
}

#[test]
fn one_constraint_is_flat_and_two_are_a_gradient() {
    let one = baked(&transfer(256, vec![diffusion(vec![at(0.3, 0.7, color([0.25, 0.5, 0.75], 0.5))])]));
    assert!(one.iter().all(|texel| *texel == [0.125, 0.25, 0.375, 0.5]), "one constraint is one colour");
    // From left to right at the height of both, nothing turns back.
    let ends = vec![at(0.1, 0.5, color([0.0, 0.0, 0.0], 1.0)), at(0.9, 0.5, color([1.0, 0.5, 0.0], 1.0))];
    let two = baked(&transfer(255, vec![diffusion(ends)]));
    let row: Vec<f64> = (0..255).map(|x| two[127 * 255 + x][0]).collect();
    // Beyond them it turns back a little: the border reflects.
    assert!(row[25..230].windows(2).all(|pair| pair[1] >= pair[0]), "{row:?}");
    assert!(row[33..222].windows(20).all(|far| far[19] > far[0] + 0.01), "it ascends: {row:?}");
    assert!(two.iter().flatten().all(|value| (0.0..=1.0).contains(value)), "nothing exceeds the constraints");
    assert!((row[127] - 0.5).abs() < 1e-3 && row[25] == 0.0 && row[229] == 1.0);
}

#[test]
fn transparency_takes_its_colour_along() {
    let ends = vec![at(0.25, 0.5, color([1.0, 0.0, 0.0], 1.0)), at(0.75, 0.5, color([0.0, 0.0, 1.0], 0.0))];
    let found = baked(&transfer(129, vec![diffusion(ends)]))[64 * 129 + 64];
    let expected = [0.5, 0.0, 0.0, 0.5];
    hold("halfway from red to nothing: half-transparent red", greatest(&[found], &[expected]), 1e-3);
}
