// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
#define_import_path airlight::core::cosine_basis
// summary: Cosines of whole multiples of a depth, their integrals and means, four orders at a time.
// source: Gautron et al., "Extinction transmittance maps" (SIGGRAPH Asia 2011 sketches), Eq. 1 and 3.
// note: Depths are x = position / d, 0..1. b_0 = 1 and b_j = sqrt(2) cos(j pi x): the mean of b_i b_j over 0..1 is 1
// note: for i = j and else 0. The integrals from 0 are B_0 = x and B_j = sqrt(2) sin(j pi x) / (j pi).
// note: Group g holds the orders 4 g .. 4 g + 3. Functions that start a series reduce their argument exactly, and
// note: those that go on rotate, which adds about 1e-7 a step.
// equation: b₀(x) = 1, b_j(x) = √2 cos(j π x);  ∫₀¹ b_i b_j dx = 1 for i = j, else 0
// equation: B₀(x) = x, B_j(x) = √2 sin(j π x) / (j π)
// equation: mean of b_j over [m − h, m + h] = b_j(m) sin(j π h) / (j π h)
// equation: Fejér: w_j = 1 − j / count
// error: bases within 1e-6 + 3e-7 j, integrals 1e-6, means 2e-6 + 6e-7 j;
// error: test core/cosine::bases_integrals_and_means_are_those_of_the_cosines.
// error: harmonics_sum within 2e-6 + 1.5e-6 j; test core/cosine::harmonics_of_a_sum_of_depths_go_on_by_rotation.
// error: sine_over_angle within 5e-7; test core/cosine::the_window_and_the_quotient_of_sine_and_angle.
// parameter group: number of four orders, from 0 up.
// parameter depth: 0..1 over the range.
// parameter half: half the length of a stretch, 0..0.5 over the range.

#import airlight::core::fourier_basis::{rotate, sine_cosine, PI}

const ROOT_OF_TWO: f32 = 1.4142135623730951;

/// Cosines and sines of four angles, and the rotation that leads to the next four.
struct Harmonics {
    /// Cosines.
    cosine: vec4<f32>,
    /// Sines.
    sine: vec4<f32>,
    /// Sine and cosine of the angle from one group to the next.
    turn: vec2<f32>,
}

/// Orders 0 to 3 of pi times `depth`.
fn harmonics_first(depth: f32) -> Harmonics {
    let one = sine_cosine(depth);
    let two = rotate(one, one);
    let three = rotate(two, one);
    return Harmonics(
        vec4<f32>(1.0, one.y, two.y, three.y), vec4<f32>(0.0, one.x, two.x, three.x), rotate(two, two)
    );
}

/// The next group.
fn harmonics_next(at: Harmonics) -> Harmonics {
    return Harmonics(
        at.cosine * at.turn.y - at.sine * at.turn.x, at.sine * at.turn.y + at.cosine * at.turn.x, at.turn
    );
}

/// The harmonics of the sum of two depths, both of the same group of orders; also of those of other functions that start a
/// series. Adding one depth again and again adds about 1e-7 each time.
fn harmonics_sum(at: Harmonics, by: Harmonics) -> Harmonics {
    return Harmonics(
        at.cosine * by.cosine - at.sine * by.sine, at.sine * by.cosine + at.cosine * by.sine, rotate(at.turn, by.turn)
    );
}

/// Orders 4 g .. 4 g + 3 of a group.
fn cosine_orders(group: u32) -> vec4<f32> {
    return f32(4u * group) + vec4<f32>(0.0, 1.0, 2.0, 3.0);
}

/// b_j of a group at the depth of `at`.
fn cosine_basis(at: Harmonics, group: u32) -> vec4<f32> {
    return select(ROOT_OF_TWO * at.cosine, vec4<f32>(1.0), cosine_orders(group) < vec4<f32>(0.5));
}

/// B_j of a group, the integrals of b_j from 0 to `depth`. `at`: of the same depth.
fn cosine_integral(at: Harmonics, depth: f32, group: u32) -> vec4<f32> {
    let orders = cosine_orders(group);
    let scale = ROOT_OF_TWO / (PI * max(orders, vec4<f32>(1.0)));
    return select(scale * at.sine, vec4<f32>(depth), orders < vec4<f32>(0.5));
}

/// sin(angle) / angle, 0..1 for angles up to pi. `sine`: of `angle`.
fn sine_over_angle(sine: vec4<f32>, angle: vec4<f32>) -> vec4<f32> {
    const third: f32 = 1.0 / 6.0;
    let square = angle * angle;
    // Where the angle is small the quotient loses what a sine loses.
    let near = 1.0 - third * square * (1.0 - 0.05 * square * (1.0 - square / 42.0));
    let safe = select(vec4<f32>(1.0), angle, abs(angle) > vec4<f32>(0.5));
    return select(near, sine / safe, abs(angle) > vec4<f32>(0.5));
}

/// What the cosines of a group at the middle of a stretch are multiplied by to give their means over it: the stretch
/// reaches `half` to both sides. `at_half`: the harmonics of `half`.
fn cosine_spread(at_half: Harmonics, half: f32, group: u32) -> vec4<f32> {
    return sine_over_angle(at_half.sine, PI * half * cosine_orders(group));
}

/// The Fejer window of a series of `count` coefficients: 1 - j / count. What was not negative stays so.
fn fejer_window(group: u32, count: u32) -> vec4<f32> {
    return max(1.0 - cosine_orders(group) / f32(count), vec4<f32>(0.0));
}
