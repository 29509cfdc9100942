// SPDX-License-Identifier: MIT OR Apache-2.0
// Measures of pictures, taken in a browser's page, which can decode them. A picture here is a PNG in a Buffer.

const address = (png) => `data:image/png;base64,${png.toString("base64")}`;

/**
 * Structural similarity of the luminance (Wang et al. 2004, means over windows of 8x8, every fourth pixel), at most 1, and
 * the mean difference of all values in steps of 1/255. Another size is as different as can be.
 */
export function similarity(page, first, second) {
    return page.evaluate(async (addresses) => {
        const [a, b] = await Promise.all(addresses.map(async (address) => {
            const bitmap = await createImageBitmap(await (await fetch(address)).blob());
            const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
            context.drawImage(bitmap, 0, 0);
            return context.getImageData(0, 0, bitmap.width, bitmap.height);
        }));
        if (a.width !== b.width || a.height !== b.height) return { structure: 0, mean: 255 };
        const mean = a.data.reduce((sum, value, i) => sum + Math.abs(value - b.data[i]), 0) / (0.75 * a.data.length);
        const grey = ({ data }) => Float64Array.from({ length: data.length / 4 },
            (_, i) => 0.2126 * data[4 * i] + 0.7152 * data[4 * i + 1] + 0.0722 * data[4 * i + 2]);
        const [x, y] = [grey(a), grey(b)];
        let [sum, windows] = [0, 0];
        for (let top = 0; top + 8 <= a.height; top += 4) {
            for (let left = 0; left + 8 <= a.width; left += 4) {
                let [sx, sy, sxx, syy, sxy] = [0, 0, 0, 0, 0];
                for (let i = 0; i < 64; i++) {
                    const at = (top + (i >> 3)) * a.width + left + (i & 7);
                    sx += x[at];
                    sy += y[at];
                    sxx += x[at] * x[at];
                    syy += y[at] * y[at];
                    sxy += x[at] * y[at];
                }
                const [mx, my] = [sx / 64, sy / 64];
                const [vx, vy, covariance] = [sxx / 64 - mx * mx, syy / 64 - my * my, sxy / 64 - mx * my];
                const [c, d] = [(0.01 * 255) ** 2, (0.03 * 255) ** 2];
                sum += ((2 * mx * my + c) * (2 * covariance + d)) / ((mx * mx + my * my + c) * (vx + vy + d));
                windows++;
            }
        }
        return { structure: sum / windows, mean };
    }, [address(first), address(second)]);
}

/** Mean of the encoded values, 0..255, in a part of a picture: left, top, right, bottom as shares of its size. */
export function brightness(page, png, part) {
    return page.evaluate(async ([address, [left, top, right, bottom]]) => {
        const bitmap = await createImageBitmap(await (await fetch(address)).blob());
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        context.drawImage(bitmap, 0, 0);
        const place = [left * bitmap.width, top * bitmap.height].map(Math.round);
        const size = [(right - left) * bitmap.width, (bottom - top) * bitmap.height].map(Math.round);
        const { data } = context.getImageData(...place, ...size);
        return data.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / (0.75 * data.length);
    }, [address(png), part]);
}
