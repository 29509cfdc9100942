// SPDX-License-Identifier: MIT OR Apache-2.0
// A page of headless Chromium with WebGPU on SwiftShader, and a server of a folder for it. Nothing leaves this machine.

import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, resolve, sep } from "node:path";
import { chromium } from "playwright-core";

const TYPES = {
    ".css": "text/css",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".mjs": "text/javascript; charset=utf-8",
    ".png": "image/png",
    ".wasm": "application/wasm",
    ".wgsl": "text/plain; charset=utf-8",
};

const ARGUMENTS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--disable-dawn-features=allow_unsafe_apis",
    // To present a canvas, so that a screenshot shows it.
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
];

/** The Chromium to run: `$CHROMIUM`, or else Debian's. */
export function chromiumPath() {
    const path = process.env.CHROMIUM || "/usr/bin/chromium";
    if (!existsSync(path)) {
        throw new Error(`there is no Chromium at ${path}; install it, or set CHROMIUM to its path`);
    }
    return path;
}

/** Serves the folder `root` on a free port of localhost. An empty `index.html` is there if the folder has none. */
async function serve(root) {
    const folder = resolve(root);
    const server = createServer(async (request, response) => {
        const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
        const file = resolve(join(folder, path.endsWith("/") ? `${path}index.html` : path));
        try {
            if (!file.startsWith(folder + sep)) throw new Error("outside of the folder");
            const body = await readFile(file);
            response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
            response.end(body);
        } catch {
            const blank = path === "/" || path === "/favicon.ico";
            response.writeHead(blank ? 200 : 404, { "content-type": "text/html; charset=utf-8" });
            response.end(blank ? "<!doctype html><title>Airlight</title>" : "not found");
        }
    });
    await new Promise((done, failed) => server.once("error", failed).listen(0, "localhost", done));
    return { server, url: `http://localhost:${server.address().port}/` };
}

/**
 * Calls `run(page, url)` with a blank page (playwright's `Page`) and the address under which `root` is served, ending in
 * `/`; returns what `run` returns. An error that the page throws and nobody catches fails the call.
 */
export async function withPage(root, run) {
    const executablePath = chromiumPath();
    const { server, url } = await serve(root);
    let browser;
    try {
        browser = await chromium.launch({ executablePath, headless: true, args: ["--headless=new", ...ARGUMENTS] });
        const page = await browser.newPage();
        const thrown = [];
        page.on("pageerror", (error) => thrown.push(error));
        const result = await run(page, url);
        if (thrown.length > 0) throw thrown[0];
        return result;
    } finally {
        await browser?.close();
        server.closeAllConnections();
        await new Promise((done) => server.close(done));
    }
}
