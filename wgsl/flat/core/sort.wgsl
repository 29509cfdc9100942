// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/sort, permutation default
// summary: A digit of a stable radix sort of unsigned keys, each with a value.
// source: D. Merrill and A. Grimshaw, "High performance and scalable radix sorting" (2011).
// note: For each digit from the lowest: dispatch count_digits over ceil(count / 1024) groups, scan `counts` (16 numbers a
// note: group) with the pass `scan`, dispatch scatter over the same groups; what it writes is the next digit's input.
// note: Equal keys keep their order, so that the result is the same bits on every run and adapter.
// binding parameters: number of keys and the digit.
// binding keys: the keys; bits below the digit are sorted.
// binding values: a value for each key, such as an index.
// binding counts: of each digit in each block of 1024 keys, digit by digit; for scatter their exclusive prefix sums.
// binding sorted_keys: out of scatter, the keys sorted by the digit.
// binding sorted_values: out of scatter, their values.

// ---- airlight::core::sort ----
// summary: Keys of a radix sort, and sixteen counters of 16 bits in eight words.
// source: D. Merrill and A. Grimshaw, "High performance and scalable radix sorting" (2011); M. Herf, "Radix tricks" (2001).

/// Values of a digit.
const DIGITS: u32 = 16u;

/// Sixteen counters up to 65535: digit d in the low half of word d / 2 for even d, else in the high half.
struct Counters {
    /// Those of the digits 0 to 7.
    low: vec4<u32>,
    /// Those of the digits 8 to 15.
    high: vec4<u32>,
}

/// The digit of a key that begins at bit `shift`, 0..28.
fn key_digit(key: u32, shift: u32) -> u32 {
    return (key >> min(shift, 28u)) & (DIGITS - 1u);
}

/// A counter that is one for `digit`, 0..15, and zero for all others.
fn one_counted(digit: u32) -> Counters {
    let one = 1u << (16u * (digit & 1u));
    let word = digit >> 1u;
    let words = vec4<u32>(0u, 1u, 2u, 3u);
    return Counters(
        select(vec4<u32>(0u), vec4<u32>(one), words == vec4<u32>(word)),
        select(vec4<u32>(0u), vec4<u32>(one), words + 4u == vec4<u32>(word))
    );
}

/// Sums of counters, which stay below 65536.
fn counted_together(a: Counters, b: Counters) -> Counters {
    return Counters(a.low + b.low, a.high + b.high);
}

/// The counter of `digit`, 0..15.
fn counted(counters: Counters, digit: u32) -> u32 {
    let words = vec4<u32>(0u, 1u, 2u, 3u);
    let word = vec4<u32>(digit >> 1u);
    let low = select(vec4<u32>(0u), counters.low, words == word);
    let high = select(vec4<u32>(0u), counters.high, words + 4u == word);
    let both = low + high;
    let pair = both.x + both.y + both.z + both.w;
    return (pair >> (16u * (digit & 1u))) & 0xffffu;
}

// ---- core/sort ----

struct SortParameters {
    /// Number of keys.
    count: u32,
    /// The digit's lowest bit, 0, 4 .. 28.
    shift: u32,
    reserved_a: u32,
    reserved_b: u32,
}

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
@group(0) @binding(4) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_values: array<u32>;

const THREADS: u32 = 256u;
const PER_THREAD: u32 = 4u;
const BLOCK: u32 = 1024u;

/// Of each thread, how many keys of each digit the threads up to it have.
var<workgroup> ranks_low: array<vec4<u32>, 256>;
/// The same of the upper eight digits.
var<workgroup> ranks_high: array<vec4<u32>, 256>;

/// Number of keys that there are.
fn key_count() -> u32 {
    return min(parameters.count, min(arrayLength(&keys), arrayLength(&values)));
}

/// How many keys of each digit a thread has whose keys begin at `first`.
fn own_digits(first: u32, count: u32) -> Counters {
    var own = Counters(vec4<u32>(0u), vec4<u32>(0u));
    for (var item = first; item < min(first + PER_THREAD, count); item++) {
        own = counted_together(own, one_counted(key_digit(keys[item], parameters.shift)));
    }
    return own;
}

/// How many keys of each digit the threads up to this one have, this one included.
fn digits_up_to(thread: u32, own: Counters) -> Counters {
    var sum = own;
    ranks_low[thread] = sum.low;
    ranks_high[thread] = sum.high;
    workgroupBarrier();
    for (var offset = 1u; offset < THREADS; offset = offset * 2u) {
        let before = max(thread, offset) - offset;
        let earlier = Counters(ranks_low[before], ranks_high[before]);
        workgroupBarrier();
        if thread >= offset {
            sum = counted_together(sum, earlier);
            ranks_low[thread] = sum.low;
            ranks_high[thread] = sum.high;
        }
        workgroupBarrier();
    }
    return sum;
}

@compute @workgroup_size(256)
fn count_digits(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32
) {
    let own = own_digits(group.x * BLOCK + thread * PER_THREAD, key_count());
    ranks_low[thread] = own.low;
    ranks_high[thread] = own.high;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half = half / 2u) {
        if thread < half {
            ranks_low[thread] += ranks_low[thread + half];
            ranks_high[thread] += ranks_high[thread + half];
        }
        workgroupBarrier();
    }
    let place = thread * groups.x + group.x;
    if thread < DIGITS && place < arrayLength(&counts) {
        counts[place] = counted(Counters(ranks_low[0], ranks_high[0]), thread);
    }
}

@compute @workgroup_size(256)
fn scatter(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32
) {
    let count = key_count();
    let first = group.x * BLOCK + thread * PER_THREAD;
    let own = own_digits(first, count);
    let sum = digits_up_to(thread, own);
    var before = Counters(sum.low - own.low, sum.high - own.high);
    for (var item = first; item < min(first + PER_THREAD, count); item++) {
        let key = keys[item];
        let digit = key_digit(key, parameters.shift);
        let start = counts[min(digit * groups.x + group.x, arrayLength(&counts) - 1u)];
        let place = start + counted(before, digit);
        before = counted_together(before, one_counted(digit));
        if place < min(arrayLength(&sorted_keys), arrayLength(&sorted_values)) {
            sorted_keys[place] = key;
            sorted_values[place] = values[item];
        }
    }
}
