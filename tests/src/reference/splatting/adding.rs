// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light up and down through a stack of layers, after Stokes: each lets a share through and sends a share back, alike from both
//! sides (EQUATIONS.md, 9).

/// A layer of a stack.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// Share of light that goes on.
    pub through: f64,
    /// Share that is sent back.
    pub back: f64,
}

impl Layer {
    /// Of an optical depth and an albedo, where shares of what is scattered go on and back.
    #[must_use]
    pub fn new(optical_depth: f64, albedo: f64, [forward, back]: [f64; 2]) -> Self {
        let taken = -(-optical_depth).exp_m1();
        Self { through: 1.0 - taken + albedo * taken * forward, back: albedo * taken * back }
    }
}

/// What a stack lets through, and what it sends back to the light.
#[derive(Clone, Copy, Debug)]
pub struct Stack {
    /// Share of light that leaves behind the last layer.
    pub through: f64,
    /// Share that comes back out of the first.
    pub back: f64,
}

/// All that ever bounces, layer added to layer.
#[must_use]
pub fn exact(layers: &[Layer]) -> Stack {
    let (mut through, mut back, mut from_behind) = (1.0, 0.0, 0.0);
    for layer in layers {
        let bounces = 1.0 / (1.0 - from_behind * layer.back);
        back += through * through * layer.back * bounces;
        from_behind = layer.back + layer.through * layer.through * from_behind * bounces;
        through *= layer.through * bounces;
    }
    Stack { through, back }
}

/// Light down and up again and again: as many ways down as `sweeps`, each followed by a way up.
#[must_use]
pub fn swept(layers: &[Layer], sweeps: usize) -> Stack {
    let mut down = vec![1.0; layers.len() + 1];
    let mut up = vec![0.0; layers.len() + 1];
    for _ in 0..sweeps {
        for (k, layer) in layers.iter().enumerate() {
            down[k + 1] = layer.through * down[k] + layer.back * up[k + 1];
        }
        for (k, layer) in layers.iter().enumerate().rev() {
            up[k] = layer.through * up[k + 1] + layer.back * down[k];
        }
    }
    Stack { through: down[layers.len()], back: up[0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_come_to_what_adding_says() {
        let layers = [Layer::new(0.3, 0.99, [0.8, 0.15]); 20];
        let all = exact(&layers);
        let close = |stack: Stack, through: f64, back: f64| {
            assert!((stack.through - through).abs() < 5.1e-5, "{stack:?}");
            assert!((stack.back - back).abs() < 5.1e-5, "{stack:?}");
        };
        close(all, 0.3910, 0.3510);
        close(swept(&layers, 1), 0.3301, 0.3269);
        // EQUATIONS.md rounds 0.34848 to 0.349.
        close(swept(&layers, 2), 0.3837, 0.3485);
        let many = swept(&layers, 200);
        assert!((many.through - all.through).abs() < 1e-12 && (many.back - all.back).abs() < 1e-12);
        let four = swept(&layers, 4);
        assert!((four.through / all.through - 1.0).abs() < 0.01 && (four.back / all.back - 1.0).abs() < 0.01);
    }

    #[test]
    fn nothing_is_lost_where_all_is_scattered_on_or_back() {
        let layers: Vec<Layer> =
            (1..30).map(|i| Layer::new(0.05 * f64::from(i % 7), 1.0, [0.7, 0.3])).collect();
        let all = exact(&layers);
        assert!((all.through + all.back - 1.0).abs() < 1e-12, "{all:?}");
    }
}
