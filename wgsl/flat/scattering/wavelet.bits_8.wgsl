// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: scattering/wavelet, permutation bits_8 (RANK=8)
// summary: The wavelet matrix of every row of a rectified map, for exact visibility in the least memory.
// source: none; see scattering/visibility_wavelet and docs/src/wavelet.md.
// note: One workgroup sorts a row by one digit of two bits after the other, in workgroup memory; a thread has a block of 32
// note: places. Rows of more than 2048 columns are not taken: there are no more threads.
// definition RANK: bits of a depth: 8, 10 or 12.
// binding rectified: the rectified map, r32float or a depth format; non-finite values count as 1, lit.
// binding wavelet: out, rgba32uint: RANK / 2 levels of a texel for 32 places, one behind the other, a row each.

// ---- airlight::core::finite ----
// summary: Replaces NaN and infinities in data that comes from outside.
// source: IEEE 754 binary32: all exponent bits set means NaN or infinity.

/// True if `x` is neither NaN nor infinite.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// `x` where it is finite, `fallback` elsewhere.
fn finite_or(x: f32, fallback: f32) -> f32 {
    return select(fallback, x, is_finite(x));
}

// ---- airlight::scattering::visibility_rank ----
// summary: Exact mean visibility of a view ray: how many of the first texels of a row lie behind it, by one rank query.
// source: none; a rank structure over a permutation, cut into words: docs/src/rank.md explains it with a drawing.

/// A depth, clamped to 0..1, as a whole number of `bits` bits.
fn rank_value(depth: f32, bits: u32) -> u32 {
    return u32(clamp(depth, 0.0, 1.0) * f32((1u << bits) - 1u) + 0.5);
}

// ---- airlight::scattering::visibility_wavelet ----
// summary: Exact mean visibility of a view ray in the least memory: a count by a wavelet matrix of four digits a level.
// source: none; a wavelet matrix (Information Systems 47, 2015) with digits of two bits: docs/src/wavelet.md explains it.

/// The sums of a block in two words. `places`: in the next level, of the first of each digit from this block on.
fn wavelet_sums(places: vec4<u32>) -> vec2<u32> {
    let one = places.x + places.y;
    let two = one + places.z;
    return vec2<u32>(places.x | (one << 16u), two | ((two + places.w) << 16u));
}

// ---- scattering/wavelet ----

@group(0) @binding(0) var rectified: texture_2d<f32>;
@group(0) @binding(1) var wavelet: texture_storage_2d<rgba32uint, write>;

const BITS: u32 = u32(8);
const LEVELS: u32 = BITS / 2u;
const THREADS: u32 = 64u;
/// Columns of the widest row.
const COLUMNS: u32 = 32u * THREADS;

/// Values of the texels in the order of the level, a word free behind each block so that threads use different banks.
var<workgroup> values: array<u32, COLUMNS + THREADS>;
/// How many of each digit a block has, two of 16 bits a word.
var<workgroup> counts: array<vec2<u32>, THREADS>;

/// Where in memory a place is.
fn slot(place: u32) -> u32 {
    return place + place / 32u;
}

/// Four numbers of 16 bits.
fn unpacked(packed: vec2<u32>) -> vec4<u32> {
    return vec4<u32>(packed.x & 0xffffu, packed.x >> 16u, packed.y & 0xffffu, packed.y >> 16u);
}

@compute @workgroup_size(THREADS)
fn wavelet_row(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(rectified);
    let row = group.x;
    let columns = min(size.x, COLUMNS);
    let blocks = (columns + 31u) / 32u;
    if row >= size.y {
        return;
    }
    for (var column = thread; column < columns; column += THREADS) {
        let depth = finite_or(textureLoad(rectified, vec2<u32>(column, row), 0).x, 1.0);
        values[slot(column)] = rank_value(depth, BITS);
    }
    let begin = 32u * thread;
    let length = min(max(columns, begin) - begin, 32u);
    for (var level = 0u; level < LEVELS; level++) {
        workgroupBarrier();
        let shift = BITS - 2u - 2u * level;
        // The values of the block, two of 16 bits a word, and the two bits of their digits.
        var kept = array<u32, 16>();
        var lower = 0u;
        var upper = 0u;
        for (var i = 0u; i < length; i++) {
            let value = values[slot(begin + i)];
            kept[i / 2u] |= value << (16u * (i & 1u));
            lower |= ((value >> shift) & 1u) << i;
            upper |= ((value >> (shift + 1u)) & 1u) << i;
        }
        let ones = countOneBits(lower & ~upper);
        let twos = countOneBits(upper & ~lower);
        let threes = countOneBits(lower & upper);
        counts[thread] = vec2<u32>((length - ones - twos - threes) | (ones << 16u), twos | (threes << 16u));
        workgroupBarrier();

        if thread < blocks {
            var before = vec2<u32>(0u);
            var all = vec2<u32>(0u);
            for (var other = 0u; other < blocks; other++) {
                let count = counts[other];
                all += count;
                before += select(vec2<u32>(0u), count, other < thread);
            }
            let total = unpacked(all);
            // In the next level all 0 come first, then all 1, and so on.
            let starts = vec4<u32>(0u, total.x, total.x + total.y, total.x + total.y + total.z);
            var places = starts + unpacked(before);
            let texel = vec4<u32>(lower, upper, wavelet_sums(places));
            textureStore(wavelet, vec2<u32>(level * blocks + thread, row), texel);
            for (var i = 0u; i < length; i++) {
                let value = (kept[i / 2u] >> (16u * (i & 1u))) & 0xffffu;
                let digit = (value >> shift) & 3u;
                values[slot(min(places[digit], COLUMNS - 1u))] = value;
                places += select(vec4<u32>(0u), vec4<u32>(1u), vec4<u32>(digit) == vec4<u32>(0u, 1u, 2u, 3u));
            }
        }
    }
}
