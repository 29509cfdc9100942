// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: core/scan, permutation default
// summary: Exclusive prefix sum of unsigned integers of any length, in place.
// source: Blelloch, "Prefix sums and their applications" (1990); blocks are scanned, then the sums of blocks, then added.
// note: Dispatch scan_blocks over ceil(length / 1024) groups; while there is more than one block, scan
// note: block_sums in the same way, then dispatch add_offsets over the same groups. Sums wrap at 2^32.
// binding parameters: the number of values.
// binding values: the values, replaced by their exclusive prefix sums.
// binding block_sums: one per block of 1024 values: its sum, or (for add_offsets) the sum of all blocks before it.

struct ScanParameters {
    /// Number of values.
    count: u32,
    reserved_a: u32,
    reserved_b: u32,
    reserved_c: u32,
}

@group(0) @binding(0) var<uniform> parameters: ScanParameters;
@group(0) @binding(1) var<storage, read_write> values: array<u32>;
@group(0) @binding(2) var<storage, read_write> block_sums: array<u32>;

const THREADS: u32 = 256u;
const PER_THREAD: u32 = 4u;

var<workgroup> sums: array<u32, 512>;

fn load(index: u32, count: u32) -> u32 {
    if index < count {
        return values[index];
    }
    return 0u;
}

@compute @workgroup_size(256)
fn scan_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let count = min(parameters.count, arrayLength(&values));
    let first = (group.x * THREADS + thread) * PER_THREAD;
    let a = load(first, count);
    let b = a + load(first + 1u, count);
    let c = b + load(first + 2u, count);
    let d = c + load(first + 3u, count);

    // Inclusive scan of the threads' sums, in two halves of the array by turns.
    var front = 0u;
    sums[thread] = d;
    workgroupBarrier();
    for (var offset = 1u; offset < THREADS; offset = offset * 2u) {
        var sum = sums[front + thread];
        if thread >= offset {
            sum += sums[front + thread - offset];
        }
        front = THREADS - front;
        sums[front + thread] = sum;
        workgroupBarrier();
    }
    let before = sums[front + thread] - d;

    if first < count {
        values[first] = before;
    }
    if first + 1u < count {
        values[first + 1u] = before + a;
    }
    if first + 2u < count {
        values[first + 2u] = before + b;
    }
    if first + 3u < count {
        values[first + 3u] = before + c;
    }
    if thread == THREADS - 1u && group.x < arrayLength(&block_sums) {
        block_sums[group.x] = before + d;
    }
}

@compute @workgroup_size(256)
fn add_offsets(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let count = min(parameters.count, arrayLength(&values));
    let offset = block_sums[min(group.x, arrayLength(&block_sums) - 1u)];
    let first = (group.x * THREADS + thread) * PER_THREAD;
    for (var item = 0u; item < PER_THREAD; item++) {
        if first + item < count {
            values[first + item] += offset;
        }
    }
}
