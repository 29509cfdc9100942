// SPDX-License-Identifier: MIT OR Apache-2.0
//! The airlight integral: what a light at a point scatters into a view ray without any shadow,
//! `∫ p(cos) e^(−σ (t + d)) / (d² + radius²) dt` with `d` the distance from the light to the point at
//! the distance `t` of the eye. By adaptive quadrature for any phase function, and in closed form for
//! the isotropic one and a light without extent (Pegoraro and Parker 2009).

use super::quadrature::integrate;

/// A view ray about a light at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Airlight {
    /// Distance from the eye to the light, metres.
    pub distance: f64,
    /// Angle at the eye between the light and the view ray, radians, [0, π].
    pub theta: f64,
    /// Radius of the light, metres.
    pub radius: f64,
    /// Extinction of the medium, 1/m.
    pub extinction: f64,
}

impl Airlight {
    /// Distance along the ray, metres, of its point nearest to the light; negative behind the eye.
    #[must_use]
    pub fn nearest(&self) -> f64 {
        self.distance * self.theta.cos()
    }

    /// Distance of the ray's line from the light, metres.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.distance * self.theta.sin().abs()
    }

    /// The cosine between the view ray and the direction towards the light at a distance along the
    /// ray, and the distance of that point from the light, metres.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        let along = self.nearest() - t;
        let d = along.hypot(self.height());
        (if d > 0.0 { along / d } else { 0.0 }, d)
    }

    /// The integrand at a distance along the ray, for a phase function of the cosine, 1/m² sr.
    #[must_use]
    pub fn integrand(&self, phase: impl Fn(f64) -> f64, t: f64) -> f64 {
        let (cosine, d) = self.at(t);
        phase(cosine) * (-self.extinction * (t + d)).exp() / (d * d + self.radius * self.radius)
    }

    /// The integral between two distances along the ray (metres; the second may be infinite where the
    /// extinction is positive) for a phase function of the cosine, 1/m sr, by quadrature.
    #[must_use]
    pub fn quadrature(&self, phase: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        // Beyond 40 mean free paths nothing is left in f64.
        let end = if to.is_finite() { to } else { from.max(self.nearest()) + 40.0 / self.extinction };
        self.pieces(from, end)
            .windows(2)
            .map(|piece| integrate(|t| [self.integrand(&phase, t)], piece[0], piece[1], 1e-13)[0])
            .sum()
    }

    /// An interval cut where the light is nearest and at distances from there that double, so that
    /// the integrand is smooth over each piece.
    #[must_use]
    pub(super) fn pieces(&self, from: f64, to: f64) -> Vec<f64> {
        let mut places = vec![self.nearest()];
        let width = self.height().hypot(self.radius).max(1e-6 * self.distance);
        let reach = (to - self.nearest()).abs().max((from - self.nearest()).abs());
        let mut step = width;
        while step < reach {
            places.extend([self.nearest() - step, self.nearest() + step]);
            step *= 2.0;
        }
        super::views::pieces(places, from, to)
    }

    /// The same in closed form for the isotropic phase function, whatever the radius is: for a light
    /// without extent, and a ray that does not pass through it.
    ///
    /// With `h` the height of the line over the light and `v = (t − nearest + d) / h` it is
    /// `2 / (4π h) e^(−σ nearest) Im(e^(−iσh) (E1(σh (v_from − i)) − E1(σh (v_to − i))))`.
    ///
    /// # Panics
    /// For a height or an extinction of 0.
    #[must_use]
    pub fn isotropic(&self, from: f64, to: f64) -> f64 {
        let h = self.height();
        assert!(h > 0.0 && self.extinction > 0.0, "no closed form");
        let optical = self.extinction * h;
        // (x + d) / h = h / (d − x), whichever does not cancel.
        let v = |t: f64| {
            let x = t - self.nearest();
            let d = x.hypot(h);
            if x > 0.0 { (x + d) / h } else { h / (d - x) }
        };
        let term = |t: f64| {
            if t.is_infinite() {
                return Complex { re: 0.0, im: 0.0 };
            }
            exponential_integral(Complex { re: optical * v(t), im: -optical })
        };
        let difference = term(from).minus(term(to));
        let turned = difference.times(Complex { re: optical.cos(), im: -optical.sin() });
        super::super::phase::isotropic() * 2.0 / h * (-self.extinction * self.nearest()).exp() * turned.im
    }
}

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    fn minus(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }

    fn times(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }

    fn inverse(self) -> Self {
        let squared = self.re * self.re + self.im * self.im;
        Self { re: self.re / squared, im: -self.im / squared }
    }

    fn magnitude(self) -> f64 {
        self.re.hypot(self.im)
    }
}

/// The exponential integral `E1(z) = ∫ from z to ∞ of e^(−w) / w dw` of a complex number with a
/// non-negative real part that is not 0: its power series near 0, its continued fraction elsewhere.
#[must_use]
pub fn exponential_integral(z: Complex) -> Complex {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let real = |re: f64| Complex { re, im: 0.0 };
    if z.magnitude() < 2.5 {
        // −γ − ln z − Σ (−z)^k / (k k!)
        let mut sum = Complex { re: -EULER - z.magnitude().ln(), im: -z.im.atan2(z.re) };
        let mut power = real(1.0);
        for k in 1..80 {
            power = power.times(z).times(real(-f64::from(k).recip()));
            sum = sum.minus(power.times(real(f64::from(k).recip())));
        }
        return sum;
    }
    // e^(−z) / (z + 1 − 1 / (z + 3 − 4 / (z + 5 − …))), from the innermost term outwards.
    let mut fraction = Complex { re: 0.0, im: 0.0 };
    for k in (1..400).rev() {
        let k = f64::from(k);
        let term = z.plus(real(2.0 * k + 1.0)).minus(fraction);
        fraction = term.inverse().times(real(k * k));
    }
    let value = z.plus(real(1.0)).minus(fraction).inverse();
    let scale = (-z.re).exp();
    value.times(Complex { re: scale * z.im.cos(), im: -scale * z.im.sin() })
}

#[cfg(test)]
mod tests {
    use super::super::test_scenes::Random;
    use super::*;
    use crate::reference::phase::{henyey_greenstein, isotropic};
    use std::f64::consts::PI;

    #[test]
    fn exponential_integral_has_the_tables_values() {
        // Abramowitz and Stegun, tables 5.1 and 5.6.
        for (x, value) in [
            (0.5, 0.559_773_594_8),
            (1.0, 0.219_383_934_4),
            (2.0, 0.048_900_510_7),
            (10.0, 4.156_968_929_7e-6),
        ] {
            let found = exponential_integral(Complex { re: x, im: 0.0 });
            assert!((found.re / value - 1.0).abs() < 1e-9 && found.im == 0.0, "{x}");
        }
        // On the imaginary axis −Ci(y) + i (Si(y) − π/2): y = 1 and y = 5.
        for (y, ci, si) in [(1.0, 0.337_403_922_9, 0.946_083_070_4), (5.0, -0.190_029_749_7, 1.549_931_244_9)]
        {
            let found = exponential_integral(Complex { re: 0.0, im: y });
            assert!((found.re + ci).abs() < 1e-9 && (found.im - si + 0.5 * PI).abs() < 1e-9, "{y}");
        }
        // Both ways to it agree where they meet, along all directions.
        for i in 0..=20 {
            let angle = -0.5 * PI + PI * f64::from(i) / 20.0;
            let at = |magnitude: f64| {
                let z = Complex { re: (magnitude * angle.cos()).max(0.0), im: magnitude * angle.sin() };
                (z, exponential_integral(z))
            };
            let ((a, below), (b, above)) = (at(2.5 - 1e-9), at(2.5));
            // The derivative is −e^(−z) / z.
            let turn = Complex { re: -(-a.re).exp() * a.im.cos(), im: (-a.re).exp() * a.im.sin() };
            let step = turn.times(a.inverse()).times(b.minus(a));
            assert!(above.minus(below).minus(step).magnitude() < 1e-12, "{angle}");
        }
    }

    #[test]
    fn closed_form_and_quadrature_agree() {
        let mut random = Random(31);
        let mut worst = 0.0_f64;
        for _ in 0..400 {
            let air = Airlight {
                distance: 10.0_f64.powf(random.between(-1.0, 2.0)),
                theta: random.between(0.002, PI - 0.002),
                radius: 0.0,
                extinction: 10.0_f64.powf(random.between(-3.0, 0.3)),
            };
            let from = random.unit() * air.distance;
            let to = from + 10.0_f64.powf(random.between(-1.0, 2.0));
            let to = if random.unit() < 0.2 { f64::INFINITY } else { to };
            let (closed, found) = (air.isotropic(from, to), air.quadrature(|_| isotropic(), from, to));
            if found > 1e-200 {
                // Relative to the integral from the eye on, of which the closed form is a difference.
                let scale = air.quadrature(|_| isotropic(), 0.0, to);
                worst = worst.max((closed - found).abs() / scale);
            }
        }
        assert!(worst < 1e-10, "{worst}");
    }

    #[test]
    fn clear_air_has_the_arc_tangent() {
        // ∫ dt / (d² + radius²) = Δ atan((t − nearest) / h) / h.
        for (distance, theta, radius) in
            [(3.0, 0.7, 0.0), (8.0, 2.1, 0.5), (5.0, 0.0, 0.01), (1e-3, 1.0, 0.1)]
        {
            let air = Airlight { distance, theta, radius, extinction: 0.0 };
            let h = air.height().hypot(radius);
            let u = |t: f64| ((t - air.nearest()) / h).atan();
            for (from, to) in [(0.0, 40.0), (1.0, 6.0), (0.0, 0.1)] {
                let expected = (u(to) - u(from)) / h;
                let found = air.quadrature(|_| 1.0, from, to);
                assert!((found / expected - 1.0).abs() < 1e-10, "{distance} {theta} {radius}: {found}");
            }
        }
    }

    #[test]
    fn phase_function_turns_with_the_ray() {
        // Half of the light scatters on either side of the nearest point in clear air; strong forward
        // scattering takes the part that looks at the light.
        let air = Airlight { distance: 2.0, theta: 0.3, radius: 0.0, extinction: 0.0 };
        let forward = |cosine: f64| henyey_greenstein(cosine, 0.8);
        let (before, after) = (
            air.quadrature(forward, 0.0, air.nearest()),
            air.quadrature(forward, air.nearest(), 2.0 * air.nearest()),
        );
        assert!(before > 10.0 * after, "{before} {after}");
        let isotropic = |cosine: f64| henyey_greenstein(cosine, 0.0);
        let whole = air.quadrature(isotropic, 0.0, 2.0 * air.nearest());
        assert!((whole / (2.0 * air.quadrature(isotropic, 0.0, air.nearest())) - 1.0).abs() < 1e-12);
    }
}
