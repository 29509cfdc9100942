// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense

/**
 * A pass as one stand-alone WGSL text, for `GPUDevice.createShaderModule`. All bindings are in group 0; `manifest()` lists
 * them by name. Only this text is fetched.
 *
 * @param pass `<system>/<pass>`, as `scattering/filter`
 * @param permutation one of `permutations(pass)`; `default` needs no optional feature and no raised limit
 * @throws RangeError for a pass or permutation that there is not; its message lists what there is
 */
export function flat(pass: string, permutation?: string): Promise<string>;

/** Names of all passes, `<system>/<pass>`. */
export function permutations(): string[];
/**
 * Names of the permutations of a pass; `default` is among them.
 *
 * @throws RangeError for a pass that there is not
 */
export function permutations(pass: string): string[];
