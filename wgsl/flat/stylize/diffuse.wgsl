// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight 0.1.0: stylize/diffuse, permutation default
// summary: Multigrid over a square of texels: the colours of constraints, diffused.
// source: as stylize/tf_diffuse.
// note: Recorded in this order: `begin`; `coarsen` for each level but the last; then V-cycles of `smooth_cells` (both parities) and
// note: `restrict_residual` downwards, `solve_coarsest` on the last level, which has at most 16 cells a side, `prolong` and
// note: `smooth_cells` upwards; and `finish`. Twelve cycles with two smoothings each way reach a thousandth.
// note: Non-finite positions of constraints count as 0, such colours as transparent.
// binding level: the level, and which of its cells are smoothed.
// binding constraints: colours at positions.
// binding couplings: of each cell of all levels: to the right, downwards, to fixed cells, and 1 where it is free.
// binding values: of each cell: on the finest level premultiplied RGBA, on the others its correction.
// binding sources: of each cell, the right side of its equation.
// binding diffused: out, premultiplied linear RGBA, rgba16float, as large as the finest level.

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

/// Like `finite_or`, each component by itself.
fn finite_or_rgb(x: vec3<f32>, fallback: f32) -> vec3<f32> {
    return vec3<f32>(finite_or(x.x, fallback), finite_or(x.y, fallback), finite_or(x.z, fallback));
}

// ---- airlight::stylize::tf_diffuse ----
// summary: Colours of a few constraints spread over a square: Laplace's equation by multigrid, in parts.
// source: thesis 6.2.2; orthogonal aggregation: Trottenberg, Oosterlee and Schueller, "Multigrid" (2001), 2.8 and A.4.

/// A colour at a place. 32 bytes.
struct Constraint {
    /// Premultiplied linear RGBA.
    color: vec4<f32>,
    /// Its position, 0..1 in x to the right and y downwards.
    position: vec2<f32>,
    /// The pixel of the picture whose ray gives the position, or negative where that is given.
    pixel: vec2<f32>,
}

/// A level of the multigrid. 32 bytes.
struct DiffusionLevel {
    /// Cells a side, at least 1.
    size: u32,
    /// Index of its first cell.
    first: u32,
    /// Cells a side of the next, coarser one: half of `size`, rounded up.
    coarse_size: u32,
    /// Index of the next one's first cell.
    coarse_first: u32,
    /// Which cells are smoothed: those whose x + y is even (0) or odd (1).
    parity: u32,
    /// Number of constraints, at least 1.
    count: u32,
    /// Radius of a constraint's disc, in units of the square's side.
    radius: f32,
    reserved: f32,
}

/// Position 0..1 of the centre of a texel of a square of `size` texels a side.
fn texel_centre(texel: vec2<u32>, size: u32) -> vec2<f32> {
    return (vec2<f32>(texel) + 0.5) / f32(size);
}

/// The texel of a square of `size` texels a side that holds `position`.
fn texel_at(position: vec2<f32>, size: u32) -> vec2<u32> {
    return vec2<u32>(clamp(position * f32(size), vec2<f32>(0.0), vec2<f32>(f32(size - 1u))));
}

/// A cell's value that solves its own equation, taken further by the factor `relaxation`, 1..2 (1: Gauss-Seidel). `pull`: values
/// of the neighbours times couplings; `stiffness`: the sum of all couplings.
fn relaxed(value: vec4<f32>, pull: vec4<f32>, stiffness: f32, source: vec4<f32>, relaxation: f32) -> vec4<f32> {
    let solved = (pull + source) / max(stiffness, 1e-20);
    return select(value, mix(value, solved, relaxation), stiffness > 0.0);
}

/// What is left of a cell's equation.
fn residual(value: vec4<f32>, pull: vec4<f32>, stiffness: f32, source: vec4<f32>) -> vec4<f32> {
    return source + pull - stiffness * value;
}

/// The correction of a cell by bilinear interpolation of four cells of the next level: its own, the nearest beside it in x and
/// in y, and the one diagonally.
fn prolonged(own: vec4<f32>, beside: vec4<f32>, below: vec4<f32>, diagonal: vec4<f32>) -> vec4<f32> {
    return (9.0 * own + 3.0 * beside + 3.0 * below + diagonal) / 16.0;
}

// ---- stylize/diffuse ----

@group(0) @binding(0) var<uniform> level: DiffusionLevel;
@group(0) @binding(1) var<storage, read> constraints: array<Constraint>;
@group(0) @binding(2) var<storage, read_write> couplings: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> values: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> sources: array<vec4<f32>>;
@group(0) @binding(5) var diffused: texture_storage_2d<rgba16float, write>;

/// Over-relaxation on the coarsest level: near the optimum for one disc of one cell in a square of 16.
const COARSEST_RELAXATION: f32 = 1.85;
/// Sweeps over the coarsest level.
const COARSEST_SWEEPS: u32 = 64u;

var<workgroup> coarsest: array<vec4<f32>, 256>;

/// Index of a cell of this level.
fn cell_index(cell: vec2<u32>) -> u32 {
    return level.first + cell.y * level.size + cell.x;
}

/// Couplings of a cell to its neighbours: left, right, above, below; 0 beyond the border.
fn neighbour_couplings(cell: vec2<u32>) -> vec4<f32> {
    let index = cell_index(cell);
    let own = couplings[min(index, arrayLength(&couplings) - 1u)];
    let last = level.size - 1u;
    var all = vec4<f32>(0.0);
    if cell.x > 0u {
        all.x = couplings[min(index - 1u, arrayLength(&couplings) - 1u)].x;
    }
    if cell.x < last {
        all.y = own.x;
    }
    if cell.y > 0u {
        all.z = couplings[min(index - level.size, arrayLength(&couplings) - 1u)].y;
    }
    if cell.y < last {
        all.w = own.y;
    }
    return all;
}

/// Indices of a cell's neighbours: left, right, above, below; its own beyond the border.
fn neighbour_indices(cell: vec2<u32>) -> vec4<u32> {
    let last = level.size - 1u;
    let before = max(cell, vec2<u32>(1u)) - 1u;
    let behind = min(cell + 1u, vec2<u32>(last));
    return vec4<u32>(
        cell_index(vec2<u32>(before.x, cell.y)), cell_index(vec2<u32>(behind.x, cell.y)),
        cell_index(vec2<u32>(cell.x, before.y)), cell_index(vec2<u32>(cell.x, behind.y))
    );
}

/// Values of the neighbours times their couplings.
fn neighbour_pull(cell: vec2<u32>, coupling: vec4<f32>) -> vec4<f32> {
    let at = neighbour_indices(cell);
    return coupling.x * values[min(at.x, arrayLength(&values) - 1u)] + coupling.y * values[min(at.y, arrayLength(&values) - 1u)] + coupling.z * values[min(at.z, arrayLength(&values) - 1u)] + coupling.w * values[min(at.w, arrayLength(&values) - 1u)];
}

/// What is left of a free cell's equation; 0 of a fixed one.
fn cell_residual(cell: vec2<u32>) -> vec4<f32> {
    let index = cell_index(cell);
    let own = couplings[min(index, arrayLength(&couplings) - 1u)];
    let coupling = neighbour_couplings(cell);
    let stiffness = dot(coupling, vec4<f32>(1.0)) + own.z;
    let left = residual(values[min(index, arrayLength(&values) - 1u)], neighbour_pull(cell, coupling), stiffness, sources[min(index, arrayLength(&sources) - 1u)]);
    return select(vec4<f32>(0.0), left, own.w > 0.5);
}

/// A cell's correction on the next level; beyond the border that at the border.
fn coarse_value(cell: vec2<i32>) -> vec4<f32> {
    let inside = vec2<u32>(clamp(cell, vec2<i32>(0), vec2<i32>(i32(level.coarse_size) - 1)));
    return values[min(level.coarse_first + inside.y * level.coarse_size + inside.x, arrayLength(&values) - 1u)];
}

@compute @workgroup_size(16, 8)
fn begin(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.size)) {
        return;
    }
    let centre = texel_centre(id.xy, level.size);
    var nearest = 1e30;
    var color = vec4<f32>(0.0);
    var holds = false;
    for (var i = 0u; i < min(level.count, arrayLength(&constraints)); i++) {
        let constraint = constraints[i];
        let x = finite_or(constraint.position.x, 0.0);
        let y = finite_or(constraint.position.y, 0.0);
        let position = clamp(vec2<f32>(x, y), vec2<f32>(0.0), vec2<f32>(1.0));
        let away = distance(position, centre);
        if away < nearest {
            nearest = away;
            let rgb = finite_or_rgb(constraint.color.rgb, 0.0);
            color = clamp(vec4<f32>(rgb, finite_or(constraint.color.a, 0.0)), vec4<f32>(0.0), vec4<f32>(1.0));
        }
        holds = holds || all(texel_at(position, level.size) == id.xy);
    }
    let free = select(1.0, 0.0, holds || nearest <= level.radius);
    let index = cell_index(id.xy);
    couplings[min(index, arrayLength(&couplings) - 1u)] = vec4<f32>(1.0, 1.0, 0.0, free);
    values[min(index, arrayLength(&values) - 1u)] = color;
    sources[min(index, arrayLength(&sources) - 1u)] = vec4<f32>(0.0);
}

@compute @workgroup_size(16, 8)
fn coarsen(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.coarse_size)) {
        return;
    }
    var made = vec4<f32>(0.0);
    for (var child = 0u; child < 4u; child++) {
        let cell = 2u * id.xy + vec2<u32>(child & 1u, child >> 1u);
        if any(cell >= vec2<u32>(level.size)) {
            continue;
        }
        let own = couplings[min(cell_index(cell), arrayLength(&couplings) - 1u)];
        if own.w < 0.5 {
            continue;
        }
        let coupling = neighbour_couplings(cell);
        let at = neighbour_indices(cell);
        let free = vec4<f32>(couplings[min(at.x, arrayLength(&couplings) - 1u)].w, couplings[min(at.y, arrayLength(&couplings) - 1u)].w, couplings[min(at.z, arrayLength(&couplings) - 1u)].w, couplings[min(at.w, arrayLength(&couplings) - 1u)].w);
        if (cell.x & 1u) == 1u {
            made.x += 0.5 * coupling.y * free.y;
        }
        if (cell.y & 1u) == 1u {
            made.y += 0.5 * coupling.w * free.w;
        }
        made.z += own.z + dot(coupling, 1.0 - free);
        made.w = 1.0;
    }
    couplings[min(level.coarse_first + id.y * level.coarse_size + id.x, arrayLength(&couplings) - 1u)] = made;
}

@compute @workgroup_size(16, 8)
fn smooth_cells(@builtin(global_invocation_id) id: vec3<u32>) {
    // Cells of the other parity only are read: in place, and the same from run to run.
    let cell = vec2<u32>(2u * id.x + ((id.y + level.parity) & 1u), id.y);
    if any(cell >= vec2<u32>(level.size)) {
        return;
    }
    let index = cell_index(cell);
    let own = couplings[min(index, arrayLength(&couplings) - 1u)];
    if own.w > 0.5 {
        let coupling = neighbour_couplings(cell);
        let stiffness = dot(coupling, vec4<f32>(1.0)) + own.z;
        values[min(index, arrayLength(&values) - 1u)] = relaxed(values[min(index, arrayLength(&values) - 1u)], neighbour_pull(cell, coupling), stiffness, sources[min(index, arrayLength(&sources) - 1u)], 1.0);
    }
}

@compute @workgroup_size(16, 8)
fn restrict_residual(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.coarse_size)) {
        return;
    }
    var sum = vec4<f32>(0.0);
    for (var child = 0u; child < 4u; child++) {
        let cell = 2u * id.xy + vec2<u32>(child & 1u, child >> 1u);
        if all(cell < vec2<u32>(level.size)) {
            sum += cell_residual(cell);
        }
    }
    let index = level.coarse_first + id.y * level.coarse_size + id.x;
    sources[min(index, arrayLength(&sources) - 1u)] = sum;
    values[min(index, arrayLength(&values) - 1u)] = vec4<f32>(0.0);
}

@compute @workgroup_size(16, 16)
fn solve_coarsest(@builtin(local_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let size = min(level.size, 16u);
    let cell = min(id.xy, vec2<u32>(size - 1u));
    let index = cell_index(cell);
    let own = couplings[min(index, arrayLength(&couplings) - 1u)];
    let coupling = neighbour_couplings(cell);
    let stiffness = dot(coupling, vec4<f32>(1.0)) + own.z;
    let source = sources[min(index, arrayLength(&sources) - 1u)];
    let works = all(id.xy < vec2<u32>(size)) && own.w > 0.5;
    coarsest[local] = values[min(index, arrayLength(&values) - 1u)];
    workgroupBarrier();
    // Where a coupling is 0 the neighbour may be any.
    let left = max(local, 1u) - 1u;
    let right = min(local + 1u, 255u);
    let above = max(local, 16u) - 16u;
    let below = min(local + 16u, 255u);
    for (var half_sweep = 0u; half_sweep < 2u * COARSEST_SWEEPS; half_sweep++) {
        if works && ((cell.x + cell.y + half_sweep) & 1u) == 0u {
            let pull = coupling.x * coarsest[left] + coupling.y * coarsest[right]
                + coupling.z * coarsest[above] + coupling.w * coarsest[below];
            coarsest[local] = relaxed(coarsest[local], pull, stiffness, source, COARSEST_RELAXATION);
        }
        workgroupBarrier();
    }
    if works {
        values[min(index, arrayLength(&values) - 1u)] = coarsest[local];
    }
}

@compute @workgroup_size(16, 8)
fn prolong(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.size)) {
        return;
    }
    let index = cell_index(id.xy);
    if couplings[min(index, arrayLength(&couplings) - 1u)].w > 0.5 {
        let own = vec2<i32>(id.xy / 2u);
        // Towards the neighbour that lies nearer.
        let side = own + vec2<i32>(id.xy & vec2<u32>(1u)) * 2 - 1;
        values[min(index, arrayLength(&values) - 1u)] += prolonged(
            coarse_value(own), coarse_value(vec2<i32>(side.x, own.y)), coarse_value(vec2<i32>(own.x, side.y)),
            coarse_value(side)
        );
    }
}

@compute @workgroup_size(16, 8)
fn finish(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < vec2<u32>(level.size)) {
        let color = clamp(values[min(cell_index(id.xy), arrayLength(&values) - 1u)], vec4<f32>(0.0), vec4<f32>(1.0));
        textureStore(diffused, id.xy, color);
    }
}
