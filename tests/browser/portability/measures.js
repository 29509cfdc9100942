// SPDX-License-Identifier: MIT OR Apache-2.0
// Outputs whose numbers stand for others, which are what is compared: integers that are fractions or floats, and parts of a number.

const MEASURES = [
    // `in_exact_parts` of splatting/sheets.wgsl: texels hold parts of a mean, and only their sum has one value.
    { pass: "splatting/splat_sheet", output: "colour 0", measure: { weights: [1, 1 / 512, 1 / 16384] } },
    // FIXED_STEPS of the pass to a unit.
    { pass: "transmittance/splat_fixed", output: "sums", measure: { scale: 1 / 262144 } },
    // Bits of positive floats.
    { pass: "transmittance/splat_fixed", output: "bounds", measure: { kind: "f32" } },
];

/** How an output of a pass (`key`) is compared, if not number by number. */
export function measureOf(key, output) {
    const [pass] = key.split(/[:[]/);
    return MEASURES.find((entry) => entry.pass === pass && entry.output === output)?.measure;
}
