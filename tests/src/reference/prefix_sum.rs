// SPDX-License-Identifier: MIT OR Apache-2.0
//! Prefix sums: of counts, modulo 2^32, and as the weighted running mean of the thesis' Listings
//! 4.1 and 4.2.

/// `out[i]` = sum of `values[0..i]` modulo 2^32; the first is 0.
#[must_use]
pub fn exclusive(values: &[u32]) -> Vec<u32> {
    let mut sum = 0_u32;
    values
        .iter()
        .map(|&value| {
            let before = sum;
            sum = sum.wrapping_add(value);
            before
        })
        .collect()
}

/// `out[i]` = sum of `values[0..=i]` modulo 2^32.
#[must_use]
pub fn inclusive(values: &[u32]) -> Vec<u32> {
    let mut sum = 0_u32;
    values
        .iter()
        .map(|&value| {
            sum = sum.wrapping_add(value);
            sum
        })
        .collect()
}

/// `out[i]` = `sum over j <= i of w_j values[j]` / `sum over j <= i of w_j`, summed directly. Where
/// the weights up to `i` sum to 0 the mean is the value `i` itself.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn running_mean(values: &[f64], weights: &[f64]) -> Vec<f64> {
    assert_eq!(values.len(), weights.len());
    let (mut sum, mut weight_sum) = (0.0, 0.0);
    values
        .iter()
        .zip(weights)
        .map(|(&value, &weight)| {
            sum += weight * value;
            weight_sum += weight;
            if weight_sum == 0.0 { value } else { sum / weight_sum }
        })
        .collect()
}

/// The weights of `count` texels of optical thickness `optical` each (extinction times the length
/// that a texel covers): `w_i = e^(−i optical) − e^(−(i + 1) optical)`, i from 0 (thesis Eq. 4.8).
/// For `optical` = 0 their limit up to a common factor, 1.
#[must_use]
pub fn transmittance_weights(count: usize, optical: f64) -> Vec<f64> {
    (0..count)
        .map(|i| if optical == 0.0 { 1.0 } else { (-(i as f64) * optical).exp() * -(-optical).exp_m1() })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scans_wrap() {
        let values = [1, u32::MAX, 5, 0];
        assert_eq!(exclusive(&values), [0, 1, 0, 5]);
        assert_eq!(inclusive(&values), [1, 0, 5, 5]);
        assert!(exclusive(&[]).is_empty());
    }

    #[test]
    fn running_mean_of_ones_is_one_and_of_a_ramp_its_middle() {
        let weights = [1.0; 5];
        assert_eq!(running_mean(&[1.0; 5], &weights), [1.0; 5]);
        let ramp = [0.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(running_mean(&ramp, &weights), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(running_mean(&[3.0, 4.0], &[0.0, 1.0]), [3.0, 4.0]);
    }

    #[test]
    fn weights_sum_to_what_the_medium_takes() {
        for optical in [1e-9, 1e-3, 0.1, 3.0] {
            let sum: f64 = transmittance_weights(100, optical).iter().sum();
            assert!((sum / -(-100.0 * optical).exp_m1() - 1.0).abs() < 1e-12);
        }
    }
}
