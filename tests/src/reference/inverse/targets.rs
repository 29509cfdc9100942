// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of a medium of one radiance as optical depths, whose sum is linear in the extinction (equation 7.13, negated).

/// What became of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// It has an optical depth.
    Kept,
    /// It is brighter or darker than any optical depth from 0 to the greatest makes it, and has the nearest.
    Clamped,
    /// Nothing shows in it, since the medium looks like what is behind; its weight is 0.
    Dropped,
}

/// Targets and weights of the least squares of extinction, one a pixel.
#[derive(Clone, Debug)]
pub struct ExtinctionTargets {
    /// Optical depths; 0 where dropped.
    pub optical_depths: Vec<f64>,
    /// What an error of an optical depth is in the picture, squared, times the weight of the user.
    pub weights: Vec<f64>,
    /// What became of each.
    pub rows: Vec<Row>,
}

impl ExtinctionTargets {
    /// Radiance of the medium and what is behind that counts as different.
    pub const LEAST_CONTRAST: f64 = 1e-4;

    /// Of a picture, what is behind the medium in each pixel and what it is by itself, radiance each; the greatest optical
    /// depth; and the weights of the user.
    #[must_use]
    pub fn new(picture: &[f64], behind: &[f64], medium: f64, greatest: f64, user: &[f64]) -> Self {
        let mut targets = Self { optical_depths: Vec::new(), weights: Vec::new(), rows: Vec::new() };
        for ((wanted, behind), user) in picture.iter().zip(behind).zip(user) {
            let contrast = behind - medium;
            if contrast.abs() < Self::LEAST_CONTRAST {
                targets.push(0.0, 0.0, Row::Dropped);
                continue;
            }
            let ratio = (wanted - medium) / contrast;
            let transmittance = ratio.clamp((-greatest).exp(), 1.0);
            let row = if ratio == transmittance { Row::Kept } else { Row::Clamped };
            targets.push(-transmittance.ln(), (transmittance * contrast).powi(2) * user, row);
        }
        targets
    }

    fn push(&mut self, optical_depth: f64, weight: f64, row: Row) {
        self.optical_depths.push(optical_depth);
        self.weights.push(weight);
        self.rows.push(row);
    }

    /// How many pixels came out so.
    #[must_use]
    pub fn count(&self, row: Row) -> usize {
        self.rows.iter().filter(|&&other| other == row).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_give_back_their_optical_depths() {
        let depths = [0.0, 0.3, 1.0, 3.0, 4.5, 0.7];
        let behind = [1.0, 0.1, 3.0, 0.0, 1.0, 0.5];
        let medium = 0.5;
        let mut picture: Vec<f64> = depths
            .iter()
            .zip(behind)
            .map(|(depth, behind): (&f64, f64)| medium + (behind - medium) * (-depth).exp())
            .collect();
        // Brighter than what is behind.
        picture[0] = 1.2;
        let user = [1.0, 1.0, 0.5, 1.0, 2.0, 1.0];
        let targets = ExtinctionTargets::new(&picture, &behind, medium, 4.0, &user);
        let found = [Row::Clamped, Row::Kept, Row::Kept, Row::Kept, Row::Clamped, Row::Dropped];
        assert_eq!(targets.rows, found);
        assert_eq!([Row::Kept, Row::Clamped, Row::Dropped].map(|row| targets.count(row)), [3, 2, 1]);
        let expected = [0.0, 0.3, 1.0, 3.0, 4.0, 0.0];
        for (depth, expected) in targets.optical_depths.iter().zip(expected) {
            assert!((depth - expected).abs() < 1e-13, "{depth}");
        }
        // The weight is the square of the slope of the picture by the optical depth.
        for (k, user) in user.iter().enumerate().take(5) {
            let at = |depth: f64| medium + (behind[k] - medium) * (-depth).exp();
            let slope = (at(expected[k] + 1e-6) - at(expected[k] - 1e-6)) / 2e-6;
            assert!((targets.weights[k] - user * slope * slope).abs() < 1e-8);
        }
        assert_eq!(targets.weights[5], 0.0);
    }
}
