// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which layer of a soft shadow buffer takes up which sheet, and how much each is blurred.

use encase::ShaderType;
use glam::{UVec2, Vec2};

/// Layers of the shadow buffer: `SOFT_LAYERS` of `splatting/soft_shadow`.
pub const SOFT_LAYERS: usize = 16;
/// Standard deviation of the Gaussian that has the 10-90 % width of a linear ramp, of the ramp's width: 0.8 / 2.563.
pub const SOFT_SPREAD: f64 = 0.312_15;
/// Greatest variance of one blur, in squares of the distance between its taps: `MOST_VARIANCE` of `splatting/blur`.
const MOST_VARIANCE: f64 = 16.0;

/// What a sheet does with layers: `LayerMerge` of `splatting/soft_shadow`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ShaderType)]
pub struct LayerMerge {
    /// The layer that takes up the sheet.
    pub open: u32,
    /// The layer that takes in what was in that one before; 16 where it was empty.
    pub into: u32,
}

/// How a layer is blurred from one sheet to the next: `LayerBlur` of `splatting/soft_shadow`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct LayerBlur {
    /// Variance along columns and rows of the buffer, in squares of the taps' distance.
    pub variance: Vec2,
    /// Distance of taps, texels.
    pub distance: UVec2,
}

/// What all sheets do with layers.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftSchedule {
    /// Of each sheet, before it is taken up.
    pub merges: Vec<LayerMerge>,
    /// Of each sheet 16, after it was taken up.
    pub blurs: Vec<LayerBlur>,
}

#[derive(Clone, Copy, Default)]
struct Layer {
    /// Of its first and its last sheet.
    ends: [f64; 2],
    /// From which its blurs are reckoned.
    reference: f64,
    /// Variance that its last sheet has got, and what all are still owed, squares of texels.
    given: [f64; 2],
    owed: [f64; 2],
}

/// The share of the way back to a layer's middle that its sheets take up.
fn relative_width(older: &Layer, younger: &Layer, now: f64) -> f64 {
    let [begin, end] = [older.ends[0], younger.ends[1]];
    (end - begin) / (now - 0.5 * (begin + end)).max(f64::MIN_POSITIVE)
}

impl SoftSchedule {
    /// `places`: of the middles of all sheets, and of one more behind the last, rising; `spread`: standard deviation of a
    /// penumbra a place behind its occluder, texels along columns and rows.
    ///
    /// A sheet opens the next layer until all hold something. From then on two neighbours are merged for each sheet: those that are
    /// narrowest as seen from it, by the quotient of width and distance. The reference r of the merged layer lies between its first and
    /// last sheet, a and b, so that both penumbras are wrong by the same share, one too wide and one too narrow:
    /// (r - a) / (b - r) = (q - a) / (q - b) at place q. A layer that was opened by itself has the reference of its sheet.
    ///
    /// From place q to q' a layer needs the variance spread^2 ((q' - r)^2 - (q - r)^2). Taps are half of a standard deviation of the
    /// least blurred sheet of the layer apart, rounded down, and at least a texel; up to a whole one where 16 squares of that distance
    /// are too few. What is more than 16 squares even so is left to the next sheet.
    pub fn new(places: &[f64], spread: [f64; 2]) -> Self {
        let mut layers = [Layer::default(); SOFT_LAYERS];
        // Slots by age, oldest first.
        let mut order: Vec<usize> = Vec::new();
        let mut schedule = Self { merges: Vec::new(), blurs: Vec::new() };
        for pair in places.windows(2) {
            let (now, next) = (pair[0], pair[1]);
            let (open, into) = match order.len() {
                used if used < SOFT_LAYERS => (used, SOFT_LAYERS),
                _ => merge(&mut layers, &mut order, now),
            };
            order.push(open);
            layers[open] = Layer { ends: [now; 2], reference: now, given: [0.0; 2], owed: [0.0; 2] };
            schedule.merges.push(LayerMerge { open: open as u32, into: into as u32 });
            for (slot, layer) in layers.iter_mut().enumerate() {
                let blur =
                    if order.contains(&slot) { layer.blur(now, next, spread) } else { LayerBlur::NONE };
                schedule.blurs.push(blur);
            }
        }
        schedule
    }
}

/// Merges the two narrowest neighbours; which layer that sets free, and which has both.
fn merge(layers: &mut [Layer; SOFT_LAYERS], order: &mut Vec<usize>, now: f64) -> (usize, usize) {
    let width = |at: usize| relative_width(&layers[order[at]], &layers[order[at + 1]], now);
    let first = (1..SOFT_LAYERS - 1).fold(0, |least, at| if width(at) < width(least) { at } else { least });
    let younger = order.remove(first + 1);
    let older = order[first];
    let [a, b] = [layers[older].ends[0], layers[younger].ends[1]];
    let [far, near] = [now - a, now - b].map(|distance| distance.max(f64::MIN_POSITIVE));
    layers[older] = Layer { ends: [a, b], reference: a + (b - a) * far / (far + near), ..layers[younger] };
    (younger, older)
}

impl Layer {
    fn blur(&mut self, now: f64, next: f64, spread: [f64; 2]) -> LayerBlur {
        let mut blur = LayerBlur::NONE;
        for (axis, spread) in spread.into_iter().enumerate() {
            let grown = (next - self.reference).powi(2) - (now - self.reference).powi(2);
            self.owed[axis] += spread.powi(2) * grown;
            let smooth = self.given[axis].sqrt();
            let needed = (self.owed[axis].max(0.0) / MOST_VARIANCE).sqrt().ceil().min(smooth.floor());
            let distance = (0.5 * smooth).floor().max(needed).clamp(1.0, 65536.0);
            let variance = self.owed[axis].clamp(0.0, MOST_VARIANCE * distance * distance);
            self.owed[axis] -= variance;
            self.given[axis] += variance;
            blur.variance[axis] = (variance / (distance * distance)) as f32;
            blur.distance[axis] = distance as u32;
        }
        blur
    }
}

impl LayerBlur {
    /// Leaves a layer as it is.
    const NONE: Self = Self { variance: Vec2::ZERO, distance: UVec2::ONE };
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest relative error of penumbras' widths over all occluders and receivers: by the variance that each sheet gets on its way
    /// through the layers.
    fn worst(places: &[f64], spread: f64) -> f64 {
        let schedule = SoftSchedule::new(places, [spread, 0.5 * spread]);
        let mut held: Vec<Vec<usize>> = vec![Vec::new(); SOFT_LAYERS];
        let mut variance = vec![[0.0_f64; 2]; places.len()];
        let mut worst = 0.0_f64;
        for (sheet, merge) in schedule.merges.iter().enumerate() {
            let taken = std::mem::take(&mut held[merge.open as usize]);
            assert_eq!(taken.is_empty(), merge.into == 16);
            if let Some(into) = held.get_mut(merge.into as usize) {
                into.extend(taken);
            }
            held[merge.open as usize].push(sheet);
            for (sheets, blur) in held.iter().zip(&schedule.blurs[SOFT_LAYERS * sheet..]) {
                for occluder in sheets {
                    for (axis, own) in variance[*occluder].iter_mut().enumerate() {
                        let step = f64::from(blur.distance[axis]);
                        assert!(blur.variance[axis] >= 0.0 && blur.variance[axis] <= 16.0);
                        // Content is smoother than the taps are apart.
                        assert!(step <= 1.0 || step <= 1.0001 * own.sqrt());
                        *own += f64::from(blur.variance[axis]) * step * step;
                    }
                }
            }
            for (occluder, variance) in variance[..=sheet].iter().enumerate() {
                let wanted = spread * (places[sheet + 1] - places[occluder]);
                worst = worst.max((variance[0].sqrt() / wanted - 1.0).abs());
                worst = worst.max((variance[1].sqrt() / (0.5 * wanted) - 1.0).abs());
            }
        }
        assert_eq!(held.iter().map(Vec::len).sum::<usize>(), places.len() - 1);
        worst
    }

    #[test]
    fn penumbras_of_all_sheets_on_all_sheets_have_their_width() {
        for (count, most) in [(16, 1e-6), (32, 0.02), (64, 0.042), (128, 0.062), (256, 0.085), (1024, 0.14)] {
            let heights: Vec<f64> = (0..=count).map(|sheet| f64::from(sheet) + 0.5).collect();
            let error = worst(&heights, 0.8);
            println!("{count} sheets in parallel light: {error:.4}");
            assert!(error < most, "{count}: {error}");
        }
        for (count, near, most) in [(128, 1.0, 0.08), (128, 0.3, 0.09), (256, 0.3, 0.13), (64, 5.0, 0.05)] {
            let step = 1.0 / f64::from(count);
            let place = |sheet: i32| -1.0 / (near + (f64::from(sheet) + 0.5) * step);
            let places: Vec<f64> = (0..=count).map(place).collect();
            // At most three texels a sheet.
            let error = worst(&places, 3.0 / (places[1] - places[0]));
            println!("{count} sheets as deep as {} of their distance: {error:.4}", 1.0 / near);
            assert!(error < most, "{count} {near}: {error}");
        }
    }
}
