// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Airlight's WGSL as text. What `npm/` holds is generated from the shaders when the package is packed; see `prepack.js`.

export { modules, passes, systems } from "./npm/sources.js";
export { flat, permutations } from "./flat.js";

export async function manifest() {
    return (await import("./npm/manifest.js")).default;
}
