// SPDX-License-Identifier: MIT OR Apache-2.0
// What an engine has anyway: a mesh, a camera, a sun. Matrices are column by column, as WGSL has them.

const add = (a, b, factor = 1) => a.map((value, i) => value + factor * b[i]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((value) => value / Math.hypot(...a));

const multiply = (a, b) =>
    Array.from({ length: 16 }, (_, at) => {
        const [column, row] = [at >> 2, at & 3];
        return [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + row] * b[4 * column + k], 0);
    });

/** View from `eye` to `target`, and its inverse. */
function lookAt(eye, target) {
    const back = unit(add(eye, target, -1));
    const right = unit(cross([0, 1, 0], back));
    const up = cross(back, right);
    const rows = [0, 1, 2].flatMap((i) => [right[i], up[i], back[i], 0]);
    const moved = [-dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    return [[...rows, ...moved], [...right, 0, ...up, 0, ...back, 0, ...eye, 1]];
}

/** `Camera` of core/camera: 40 numbers, depth 0 near to 1 far. */
export function camera(width, height) {
    const [eye, target, near, far] = [[3.2, 1.5, 5.2], [-1.0, 1.7, -0.8], 0.1, 60];
    const y = 1 / Math.tan((0.5 * 50 * Math.PI) / 180);
    const x = (y * height) / width;
    const [a, b] = [far / (near - far), (near * far) / (near - far)];
    const clipFromView = [x, 0, 0, 0, 0, y, 0, 0, 0, 0, a, -1, 0, 0, b, 0];
    const viewFromClip = [1 / x, 0, 0, 0, 0, 1 / y, 0, 0, 0, 0, 0, 1 / b, 0, 0, -1, a / b];
    const [viewFromWorld, worldFromView] = lookAt(eye, target);
    const matrices = [...multiply(clipFromView, viewFromWorld), ...multiply(worldFromView, viewFromClip)];
    // The projection, last, is an integer: 0 is perspective, whose bits are those of the number 0.
    return new Float32Array([...matrices, ...eye, 0, width, height, 1, 0]);
}

/** `Light` of core/light: 48 numbers. Degrees, azimuth from +z towards +x, elevation above the horizon. */
export function sun(azimuth, elevation) {
    const [turn, rise] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
    const towards = [Math.cos(rise) * Math.sin(turn), Math.sin(rise), Math.cos(rise) * Math.cos(turn)];
    // The shadow map holds a ball around everything that casts a shadow.
    const [middle, radius] = [[0, 2.6, 1], 9.6];
    const scale = 1 / radius;
    const clipFromView = [scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, -0.5 * scale, 0, 0, 0, 0, 1];
    const viewFromClip = [radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, -2 * radius, 0, 0, 0, 0, 1];
    const [viewFromWorld, worldFromView] = lookAt(add(middle, towards, radius), middle);
    const matrices = [...multiply(clipFromView, viewFromWorld), ...multiply(worldFromView, viewFromClip)];
    const radiance = [15, 10.6, 6.4];
    return new Float32Array([...matrices, ...towards, 1, ...radiance, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
}

/** `Sky` of core/raster: radiance straight up, at the horizon, from below, each with padding. */
export const SKY = new Float32Array([0.05, 0.09, 0.17, 0, 0.09, 0.11, 0.15, 0, 0.06, 0.045, 0.03, 0]);

/** The hall with the mesh of an .obj file in it: position, normal and albedo of each corner of each triangle. */
export function hall(text) {
    const numbers = [];
    const stone = [0.42, 0.38, 0.34];
    const block = (low, high, albedo = stone) => {
        const [middle, half] = [add(low, high).map((v) => 0.5 * v), add(high, low, -1).map((v) => 0.5 * v)];
        for (let side = 0; side < 6; side++) {
            const [axis, sign] = [side >> 1, 1 - 2 * (side & 1)];
            for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) {
                const corner = [0, 0, 0];
                [corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]] = [sign, u, v];
                const normal = [0, 1, 2].map((i) => (i === axis ? sign : 0));
                numbers.push(...middle.map((m, i) => m + half[i] * corner[i]), ...normal, ...albedo);
            }
        }
    };
    block([-5.4, -0.3, -6], [5, 0, 8], [0.3, 0.26, 0.22]); // floor
    block([-5.4, 5.2, -6], [5, 5.5, 8]); // ceiling
    block([-5.4, 0, -6.3], [5, 5.2, -6]); // behind the mesh
    block([-5.4, 0, 8], [5, 5.2, 8.3]); // behind the camera
    block([5, 0, -6], [5.3, 5.2, 8]); // right
    block([-5.4, 0, -6], [-5, 0.9, 8]); // below the windows
    block([-5.4, 4.3, -6], [-5, 5.2, 8]); // above them
    block([-5.4, 0.9, -6], [-5, 4.3, -5]); // before the first
    for (let begin = -5; begin < 8; begin += 2.4) {
        block([-5.4, 0.9, begin], [-5, 4.3, begin + 1.2]); // the pillar beside a window
        block([-5.24, 0.9, begin + 1.77], [-5.16, 4.3, begin + 1.83]); // its bars
        block([-5.24, 2, begin + 1.2], [-5.16, 2.06, begin + 2.4]);
        block([-5.24, 3.15, begin + 1.2], [-5.16, 3.21, begin + 2.4]);
    }
    block([-1.5, 0, -1.5], [0.3, 0.6, -0.1]); // what the mesh stands on
    block([-1.6, 0.6, -1.6], [0.4, 0.7, 0]);

    // The mesh: 1.7 m high, turned a little, on that.
    const lines = text.split("\n").map((line) => line.trim().split(/\s+/));
    const points = (kind) => lines.filter(([word]) => word === kind).map((words) => words.slice(1, 4).map(Number));
    const [positions, normals] = [points("v"), points("vn")];
    const bound = (pick) => [0, 1, 2].map((i) => positions.reduce((most, p) => pick(most, p[i]), positions[0][i]));
    const [low, high] = [bound(Math.min), bound(Math.max)];
    const foot = [0.5 * (low[0] + high[0]), low[1], 0.5 * (low[2] + high[2])];
    const [sine, cosine] = [Math.sin(-0.35), Math.cos(-0.35)];
    const turned = ([x, y, z]) => [cosine * x + sine * z, y, cosine * z - sine * x];
    for (const [, ...corners] of lines.filter(([word]) => word === "f")) {
        for (const [position, , normal] of corners.map((corner) => corner.split("/"))) {
            const local = add(positions[position - 1], foot, -1).map((v) => (v * 1.7) / (high[1] - low[1]));
            numbers.push(...add(turned(local), [-0.6, 0.69, -0.8]), ...turned(normals[normal - 1]), 0.8, 0.7, 0.6);
        }
    }
    return new Float32Array(numbers);
}
