// SPDX-License-Identifier: MIT OR Apache-2.0
//! How far pictures are from what is wanted, and `report.json`.

use super::descent::sum;
use super::discs::LitDiscs;
use super::parts::Property;
use crate::data::srgb_from_linear;
use crate::inverse::LogCounts;
use glam::Vec3;
use serde_json::{Value, json};

/// Least mean square of what is wrong in a .png, in 0..1: that of 120 dB.
const LEAST: f64 = 1e-12;

/// How far a picture is from what is wanted, over pixels as far as they count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Root of the mean square, linear radiance.
    pub rmse: f64,
    /// Peak signal to noise ratio of what a .png shows (sRGB, white is the peak), dB; 120 at most.
    pub psnr: f64,
}

impl Distance {
    /// Of a picture.
    pub fn new(found: &[Vec3], wanted: &[Vec3], weights: &[f32]) -> Self {
        let shown = |value: f32| f64::from(srgb_from_linear(value.clamp(0.0, 1.0)));
        let (mut linear, mut encoded, mut all) = (0.0, 0.0, 0.0);
        for ((found, wanted), weight) in found.iter().zip(wanted).zip(weights) {
            let weight = f64::from(*weight);
            for (found, wanted) in found.to_array().into_iter().zip(wanted.to_array()) {
                linear += weight * (f64::from(found) - f64::from(wanted)).powi(2);
                encoded += weight * (shown(found) - shown(wanted)).powi(2);
            }
            all += 3.0 * weight;
        }
        let mean = |sum: f64| sum / f64::max(all, f64::MIN_POSITIVE);
        Self { rmse: mean(linear).sqrt(), psnr: -10.0 * mean(encoded).max(LEAST).log10() }
    }
}

/// What a stage did to a view.
pub struct ViewReport {
    /// Its name.
    pub name: String,
    /// When the stage began.
    pub before: Distance,
    /// When it ended.
    pub after: Distance,
    /// Pixels as optical depths, of all channels; of extinction.
    pub counts: Option<LogCounts>,
}

/// What a stage did.
pub struct StageReport {
    /// What was solved for, as it is written.
    pub wanted: &'static str,
    /// Iterations that were done.
    pub iterations: u32,
    /// What was wrong when each iteration began and when the last one ended: weighed sums of squares by channel.
    pub residuals: Vec<[f32; 3]>,
    /// Volumes, their voxels, and how many of them were solved for.
    pub volumes: Vec<(Property, [u32; 3], usize)>,
    /// Light that was solved for.
    pub light: Option<LitDiscs>,
    /// Views.
    pub views: Vec<ViewReport>,
    /// How long it took.
    pub seconds: f64,
}

impl StageReport {
    /// Residuals of all channels.
    pub fn totals(&self) -> Vec<f64> {
        self.residuals.iter().map(sum).collect()
    }

    /// For the file.
    pub fn json(&self) -> Value {
        let volume = |(property, size, solved): &(Property, [u32; 3], usize)| {
            (property.name().to_owned(), json!({ "voxels": size, "solved": solved }))
        };
        let volumes: serde_json::Map<String, Value> = self.volumes.iter().map(volume).collect();
        let mut report = json!({
            "for": self.wanted,
            "iterations": self.iterations,
            "residuals": self.totals(),
            "residuals_by_channel": self.residuals,
            "volumes": volumes,
            "views": self.views.iter().map(ViewReport::json).collect::<Vec<_>>(),
            "seconds": self.seconds,
        });
        if let Some(light) = &self.light {
            report["light"] = light.json();
        }
        report
    }

    /// For the person at the keyboard, a line each.
    pub fn lines(&self) -> Vec<String> {
        let totals = self.totals();
        let share = match totals[..] {
            [first, .., last] if first > 0.0 => {
                format!("{:.3} % of the residual is left", 100.0 * last / first)
            }
            _ => "nothing was wrong".to_owned(),
        };
        let mut lines = vec![format!("{}: {share} after {} iterations", self.wanted, self.iterations)];
        for view in &self.views {
            let (before, after) = (view.before, view.after);
            lines.push(format!(
                "  {}: {:.1} dB, RMSE {:.4} (before: {:.1} dB, {:.4})",
                view.name, after.psnr, after.rmse, before.psnr, before.rmse
            ));
            if let Some(counts) = view.counts {
                let LogCounts { kept, beyond_background, beyond_medium, dropped } = counts;
                lines.push(format!(
                    "    optical depths: {kept} kept; clamped: {beyond_background} beyond the background, \
                     {beyond_medium} beyond the medium; {dropped} dropped"
                ));
            }
        }
        lines
    }
}

impl ViewReport {
    fn json(&self) -> Value {
        let mut report = json!({
            "name": self.name,
            "rmse_before": self.before.rmse,
            "rmse_after": self.after.rmse,
            "psnr_before": self.before.psnr,
            "psnr_after": self.after.psnr,
        });
        if let Some(counts) = self.counts {
            report["optical_depths"] = json!({
                "kept": counts.kept,
                "clamped_beyond_background": counts.beyond_background,
                "clamped_beyond_medium": counts.beyond_medium,
                "dropped": counts.dropped,
            });
        }
        report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_of_what_counts() {
        let wanted = [Vec3::ZERO, Vec3::splat(0.5), Vec3::ONE];
        let found = [Vec3::ZERO, Vec3::splat(0.7), Vec3::splat(7.0)];
        let of = |weights: &[f32]| Distance::new(&found, &wanted, weights);
        assert_eq!(of(&[1.0, 0.0, 0.0]), Distance { rmse: 0.0, psnr: 120.0 });
        assert!((of(&[0.0, 3.0, 0.0]).rmse - 0.2).abs() < 1e-6);
        // Brighter than white is white.
        let bright = of(&[0.0, 0.0, 1.0]);
        assert!((bright.rmse - 6.0).abs() < 1e-6 && bright.psnr == 120.0);
        // sRGB 0.7354 and 0.8543.
        let both = of(&[1.0, 1.0, 0.0]);
        assert!((both.psnr - (-10.0 * (0.1190_f64.powi(2) / 2.0).log10())).abs() < 0.02, "{both:?}");
        assert!(of(&[0.0; 3]).rmse == 0.0);
    }
}
