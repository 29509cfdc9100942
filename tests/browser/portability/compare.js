// SPDX-License-Identifier: MIT OR Apache-2.0
// Differences of two contents of a resource, in units of a tolerance.

/** The number that 16 bits hold. */
export function half(bits) {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 0x1f;
    const fraction = bits & 0x3ff;
    if (exponent === 0) return sign * fraction * 2 ** -24;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

const CHANNELS = { r: 1, rg: 2, rgba: 4, depth: 1 };

/** Channels of a texel and how one of them is read: `f16`, `f32`, `u32` or `unorm`. */
export function channelsOf(format) {
    const [, names, bits, type] = /^(rgba|rg|r|depth)(8|16|32)(unorm|float|uint)$/.exec(format) ?? [];
    if (!names) throw new Error(`texels of ${format} are unknown here`);
    const kind = type === "unorm" ? "unorm" : `${type === "uint" ? "u" : "f"}${bits}`;
    return { channels: CHANNELS[names], kind };
}

const READERS = {
    f16: [2, (view, at) => half(view.getUint16(at, true))],
    f32: [4, (view, at) => view.getFloat32(at, true)],
    i32: [4, (view, at) => view.getInt32(at, true)],
    u32: [4, (view, at) => view.getUint32(at, true)],
    unorm: [1, (view, at) => view.getUint8(at) / 255],
};

/** A list of `[byte, kind]` for each element of a content: a texel, or what a buffer's words are. */
export function* elements(about, length) {
    if (about.kind === "texture") {
        const { channels, kind } = channelsOf(about.format);
        const [size] = READERS[kind];
        for (let at = 0; at < length; at += size * channels) {
            yield Array.from({ length: channels }, (_, channel) => [at + size * channel, kind]);
        }
        return;
    }
    const words = (letters, at) => [...letters].map((letter, k) => [at + 4 * k, `${letter}32`]).filter(([, kind]) => kind !== ".32");
    const { head, repeated } = about.words ?? { head: "", repeated: "u" };
    for (const word of words(head, 0)) yield [word];
    // What the device rounds the size of a buffer up by is no element.
    for (let at = 4 * head.length; repeated && at + 4 * repeated.length <= length; at += 4 * repeated.length) {
        yield words(repeated, at);
    }
}

/**
 * Compares what a device wrote with what another one had written. An element is off where one of its values differs by more than
 * `absolute + relative * |expected|`, the two being `tolerance[kind]`; `worst` is the greatest difference in units of that, 0 where both are the same number or
 * both none. `offWide` counts those that are off by more than `tolerance.times` times that. `tolerance.measure` says where the numbers
 * stand for others: `{kind}` that bits are read as, `{scale}` to multiply by, `{weights}` of channels that are parts of one number.
 */
export function compare(about, actual, expected, tolerance) {
    const [a, b] = [actual, expected].map((bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength));
    const { kind: as, scale = 1, weights } = tolerance.measure ?? {};
    const { times = 1 } = tolerance;
    const result = { compared: 0, off: 0, offWide: 0, worst: 0, at: null, values: null };
    for (const element of elements(about, expected.byteLength)) {
        let greatest = 0;
        const numbers = element.map(([at, kind]) => {
            const read = READERS[as ?? kind][1];
            return { kind: as ?? (scale === 1 ? kind : "f32"), x: scale * read(a, at), y: scale * read(b, at) };
        });
        for (const { kind, x, y } of weights ? [sum(numbers, weights)] : numbers) {
            if (Object.is(x, y) || x === y) continue;
            const [absolute, relative] = tolerance[kind];
            const difference = Math.abs(x - y);
            const excess = difference / (absolute + relative * Math.abs(y));
            const units = Number.isNaN(excess) ? Infinity : excess;
            if (units > greatest) greatest = units;
            if (units > result.worst) Object.assign(result, { worst: units, at: result.compared, values: [String(x), String(y)] });
        }
        result.compared += 1;
        if (greatest > 1) result.off += 1;
        if (greatest > times) result.offWide += 1;
    }
    return result;
}

function sum(numbers, weights) {
    const total = (side) => weights.reduce((all, weight, k) => all + weight * numbers[k][side], 0);
    return { kind: numbers[0].kind, x: total("x"), y: total("y") };
}
