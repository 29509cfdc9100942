// SPDX-License-Identifier: MIT OR Apache-2.0 OR Unlicense
// Stand-alone shaders, each fetched when it is asked for. Of the sources nothing is fetched.

import { FLAT } from "./npm/flat.js";

const list = (names) => [...names].join(", ");

function passNamed(pass) {
    const found = FLAT.get(pass);
    if (!found) throw new RangeError(`no pass "${pass}"; there are ${list(FLAT.keys())}`);
    return found;
}

export function permutations(pass) {
    return pass === undefined ? [...FLAT.keys()] : [...passNamed(pass).keys()];
}

export async function flat(pass, permutation = "default") {
    const known = passNamed(pass);
    const load = known.get(permutation);
    if (!load) throw new RangeError(`pass "${pass}" has no permutation "${permutation}"; it has ${list(known.keys())}`);
    return (await load()).default;
}
