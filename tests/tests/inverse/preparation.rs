// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is prepared for a solve: voxels that matter and optical depths, against references in f64 that try everything.

use airlight::inverse::{Basis, InverseError, LogCounts, log_targets, radiance_targets, touched};
use airlight_tests::reference::inverse::{
    Basis as ReferenceBasis, ExtinctionTargets, Grid, Part, Property, Row, touched as reference_touched,
};

/// Numbers from 0 to 1 that are the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }
}

#[test]
fn voxels_that_matter_are_those_that_meet_extinction() {
    let mut numbers = Numbers(5);
    let sizes = [[6, 5, 4], [3, 4, 5], [12, 9, 8], [1, 2, 7], [13, 7, 3]];
    let mut both = 0;
    for dense_size in sizes {
        for chance in [0.0, 0.004, 0.03, 0.3] {
            let count = dense_size.iter().product::<u32>() as usize;
            let dense: Vec<bool> = (0..count).map(|_| numbers.next() < chance).collect();
            let grid = Grid {
                size: dense_size.map(|side| side as usize),
                values: dense.iter().map(|dense| if *dense { 0.7 } else { 0.0 }).collect(),
            };
            for size in sizes {
                for (basis, reference) in
                    [(Basis::Triangle, ReferenceBasis::Trilinear), (Basis::Box, ReferenceBasis::Box)]
                {
                    let part = Part {
                        property: Property::Emission,
                        size: size.map(|side| side as usize),
                        basis: reference,
                    };
                    let found = touched(size, basis, dense_size, &dense).unwrap();
                    assert!(
                        found == reference_touched(&part, &grid),
                        "{dense_size:?} at {chance}, {size:?} {basis:?}"
                    );
                    both += u32::from(found.contains(&true) && found.contains(&false));
                }
            }
        }
    }
    assert!(both > 40, "{both}");
    assert!(matches!(touched([2; 3], Basis::Box, [2; 3], &[true; 7]), Err(InverseError::Count { .. })));
}

#[test]
fn optical_depths_are_those_of_the_reference() {
    let mut numbers = Numbers(9);
    let mut random = |count: usize, low: f64, high: f64| -> Vec<f32> {
        (0..count).map(|_| (low + (high - low) * numbers.next()) as f32).collect()
    };
    let mut all = LogCounts::default();
    for medium in [0.0_f32, 0.5] {
        let count = 4000;
        let picture = random(count, -0.2, 1.6);
        let mut background = random(count, 0.0, 1.5);
        background[..40].fill(medium);
        background[40..80].fill(medium + 0.5e-4);
        let weights = random(count, 0.1, 2.0);
        let found = log_targets(&picture, &background, &weights, medium, 3.0).unwrap();
        let wide = |values: &[f32]| -> Vec<f64> { values.iter().map(|value| f64::from(*value)).collect() };
        let expected = ExtinctionTargets::new(
            &wide(&picture),
            &wide(&background),
            f64::from(medium),
            3.0,
            &wide(&weights),
        );
        for pixel in 0..count {
            let off = (f64::from(found.depths[pixel]) - expected.optical_depths[pixel]).abs();
            assert!(off < 1e-6, "{pixel}: {off}");
            let off = (f64::from(found.weights[pixel]) - expected.weights[pixel]).abs();
            assert!(off < 1e-6 * expected.weights[pixel].max(1e-3), "{pixel}: {off}");
        }
        let LogCounts { kept, beyond_background, beyond_medium, dropped } = found.counts;
        assert_eq!([kept, dropped], [Row::Kept, Row::Dropped].map(|row| expected.count(row)));
        assert_eq!(beyond_background + beyond_medium, expected.count(Row::Clamped));
        all = all.and(found.counts);
        // Of what does not count nothing is said.
        let none = log_targets(&picture, &background, &vec![0.0; count], medium, 3.0).unwrap();
        assert_eq!(none.counts, LogCounts::default());
        assert!(none.weights.iter().all(|weight| *weight == 0.0));
    }
    assert!(all.kept > 1000 && all.beyond_background > 100 && all.beyond_medium > 100, "{all:?}");
    assert_eq!(all.dropped, 160);
    let one = log_targets(&[1.2, 0.0, 0.5, 0.75], &[1.0, 1.0, 1.0, 0.5], &[1.0; 4], 0.5, 4.0).unwrap();
    assert_eq!(one.counts, LogCounts { kept: 0, beyond_background: 1, beyond_medium: 2, dropped: 1 });
    assert_eq!(one.depths, [0.0, 4.0, 4.0, 0.0]);
}

#[test]
fn what_cannot_be_is_refused() {
    for most in [0.0, -1.0, f32::NAN, 81.0] {
        assert!(matches!(log_targets(&[], &[], &[], 0.0, most), Err(InverseError::Setting(_))), "{most}");
    }
    assert!(matches!(log_targets(&[0.5], &[], &[1.0], 0.0, 1.0), Err(InverseError::Count { .. })));
    assert!(matches!(log_targets(&[0.5], &[1.0], &[], 0.0, 1.0), Err(InverseError::Count { .. })));
    assert_eq!(radiance_targets(&[1.0, 0.5], &[0.5, 2.0], &[0.5, 0.0], &[0.25, 1.0]).unwrap(), [0.5, -0.5]);
    for [background, through, known] in [[1, 2, 2], [2, 1, 2], [2, 2, 3]] {
        let zeros = [0.0; 3];
        let refused = radiance_targets(&zeros[..2], &zeros[..background], &zeros[..through], &zeros[..known]);
        assert!(matches!(refused, Err(InverseError::Count { .. })));
    }
}
