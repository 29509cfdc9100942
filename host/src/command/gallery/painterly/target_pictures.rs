// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers of a surface as colours, sRGB-encoded 0..1.

use glam::{Vec2, Vec3};

/// Where there is no surface.
const NOTHING: Vec3 = Vec3::new(0.082, 0.090, 0.102);

/// Pixels of what is seen, by their number.
pub fn of_seen(distance: &[f32], color: &dyn Fn(usize) -> Vec3) -> Vec<u8> {
    let pixel = |(i, distance): (usize, &f32)| {
        let color = if *distance >= 0.0 { color(i) } else { NOTHING };
        let [red, green, blue] = color.to_array().map(|channel| (channel.clamp(0.0, 1.0) * 255.0) as u8);
        [red, green, blue, 255]
    };
    distance.iter().enumerate().flat_map(pixel).collect()
}

/// A unit normal.
pub fn normal(normal: &[f32]) -> Vec3 {
    0.5 + 0.5 * Vec3::from_slice(normal)
}

/// From dark violet through red to pale yellow as values go from the least to the greatest that is seen.
pub fn ramp_over(values: impl Iterator<Item = f32>, distance: &[f32]) -> impl Fn(f32) -> Vec3 {
    const COLORS: [Vec3; 4] = [
        Vec3::new(0.09, 0.07, 0.22),
        Vec3::new(0.52, 0.15, 0.38),
        Vec3::new(0.93, 0.48, 0.26),
        Vec3::new(0.99, 0.95, 0.72),
    ];
    let seen = values.zip(distance).filter(|(_, distance)| **distance >= 0.0);
    let (least, greatest) = seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(least, greatest), (value, _)| {
        (least.min(value), greatest.max(value))
    });
    move |value| {
        let place = 3.0 * ((value - least) / (greatest - least).max(1e-12)).clamp(0.0, 1.0);
        let from = (place as usize).min(2);
        COLORS[from].lerp(COLORS[from + 1], place - from as f32)
    }
}

/// The greatest speed of flow, pixels.
pub fn fastest(flow: &[f32]) -> f32 {
    flow.chunks_exact(2).map(|of| Vec2::from_slice(of).length()).fold(1e-6, f32::max)
}

/// A motion, pixels: hue for its direction, white where there is none.
pub fn flow(flow: &[f32], fastest: f32) -> Vec3 {
    let flow = Vec2::from_slice(flow);
    let angle = flow.y.atan2(flow.x);
    let hue = [0.0, 1.0, 2.0].map(|third| 0.5 + 0.5 * (angle - third * std::f32::consts::TAU / 3.0).cos());
    Vec3::splat(0.96).lerp(Vec3::from(hue), (flow.length() / fastest).clamp(0.0, 1.0))
}

/// The stronger of two curvatures, 1/m: orange where convex, blue where concave.
pub fn curvature(curvature: &[f32], range: f32) -> Vec3 {
    let stronger = if curvature[0].abs() >= curvature[1].abs() { curvature[0] } else { curvature[1] };
    let end = if stronger > 0.0 { Vec3::new(0.86, 0.36, 0.10) } else { Vec3::new(0.10, 0.30, 0.62) };
    Vec3::splat(0.95).lerp(end, (stronger.abs() / range).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_tell_signs_and_directions_apart() {
        let [convex, concave, flat] = [[9.0, 1.0], [1.0, -9.0], [0.0, 0.0]].map(|of| curvature(&of, 10.0));
        assert!(convex.x > convex.z && concave.z > concave.x && flat == Vec3::splat(0.95));
        let [right, left] = [[4.0, 0.0], [-4.0, 0.0]].map(|of| flow(&of, 4.0));
        assert!(right.x > 0.9 && left.x < 0.1);
        let ramp = ramp_over([1.0, 9.0, 3.0].into_iter(), &[1.0, -1.0, 1.0]);
        assert!(ramp(1.0).x < 0.1 && ramp(3.0).x > 0.9);
        assert_eq!(of_seen(&[-1.0, 1.0], &|_| Vec3::ONE)[4..], [255; 4]);
    }
}
