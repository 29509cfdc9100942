// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
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

#import airlight::core::sort::{Counters, DIGITS, key_digit, one_counted, counted_together, counted}

struct SortParameters {
    /// Number of keys.
    count: u32,
    /// The digit's lowest bit, 0, 4 .. 28.
    shift: u32,
    reserved_a: u32,
    reserved_b: u32,
}

@group(#{GROUP}) @binding(0) var<uniform> parameters: SortParameters;
@group(#{GROUP}) @binding(1) var<storage, read> keys: array<u32>;
@group(#{GROUP}) @binding(2) var<storage, read> values: array<u32>;
@group(#{GROUP}) @binding(3) var<storage, read_write> counts: array<u32>;
@group(#{GROUP}) @binding(4) var<storage, read_write> sorted_keys: array<u32>;
@group(#{GROUP}) @binding(5) var<storage, read_write> sorted_values: array<u32>;

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
