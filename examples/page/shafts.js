// SPDX-License-Identifier: MIT OR Apache-2.0
// Light shafts in a page, from Airlight's flat shader files by plain WebGPU.
//
// 1. shadow map of the sun                          } an engine's own; here the pass `core/raster`
// 2. picture and depth from the camera              }
// 3. `slices`, `rectify`: the shadow map resampled so that every view ray lies in one row, at one depth
// 4. `rank`: each row sorted once, so that it answers how many of its first texels are lit
// 5. `evaluate`: the light scattered towards the eye: two such questions a pixel, no marching
// 6. `composite`: the picture dimmed by the air, plus that light
// 7. `tonemap`: linear radiance to sRGB, straight into the canvas

import { camera, hall, sun, SKY } from "./scene.js";

const SHADERS = "../../wgsl/flat";
const MESH = "../../host/assets/bunny.obj";
/** Columns and rows of the rectified map: a row is a slice of the picture through the sun, a column a distance. */
const [COLUMNS, ROWS] = [1024, 1024];
const SHADOW_MAP = 2048;
/** Pixels of the canvas a pixel of the page, along each side: smooth edges. */
const SAMPLES = 2;

const canvas = document.querySelector("canvas");
const form = document.querySelector("form");
const show = (text) => (document.querySelector("#message").textContent = text);

const load = async (path) => {
    const response = await fetch(new URL(path, import.meta.url));
    if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
    return response.text();
};

async function start() {
    if (!navigator.gpu) {
        throw new Error("This browser has no WebGPU here. It takes Chrome 113, Safari 26, Firefox 141 or later, and https or localhost.");
    }
    const adapter = await navigator.gpu.requestAdapter();
    if (!adapter) throw new Error("WebGPU finds no graphics adapter on this machine.");
    // Default limits, no feature: that is all the shaders need.
    const device = await adapter.requestDevice();
    device.addEventListener("uncapturederror", ({ error }) => show(error.message));
    device.lost.then(({ message }) => show(`The graphics device was lost. ${message}`));
    const context = canvas.getContext("webgpu");
    const usage = GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.RENDER_ATTACHMENT;
    context.configure({ device, format: "rgba8unorm", usage, alphaMode: "opaque" });

    const [draw, resize] = await shafts(device, context);
    // One frame for whatever changed since the last.
    let asked = false;
    const ask = () => {
        if (asked) return;
        asked = true;
        requestAnimationFrame(async () => {
            asked = false;
            draw(settings());
            await device.queue.onSubmittedWorkDone();
            // How many frames have been drawn, for the test.
            canvas.dataset.frames = 1 + Number(canvas.dataset.frames ?? 0);
        });
    };
    form.addEventListener("input", ask);
    new ResizeObserver(() => {
        const most = device.limits.maxTextureDimension2D;
        const side = (pixels) => Math.max(1, Math.min(most, Math.round(SAMPLES * pixels)));
        [canvas.width, canvas.height] = [side(canvas.clientWidth), side(canvas.clientHeight)];
        resize(canvas.width, canvas.height);
        ask();
    }).observe(canvas);
}

/** The numbers of the sliders by their names; each is written beside its slider, before the unit. */
function settings() {
    const inputs = [...form.elements].filter((element) => element.name);
    for (const input of inputs) {
        const output = input.parentElement.querySelector("output");
        output.dataset.unit ??= output.textContent;
        output.textContent = input.value + output.dataset.unit;
    }
    return Object.fromEntries(inputs.map((input) => [input.name, Number(input.value)]));
}

/** Builds everything; returns what draws a frame, and what makes the textures for a size of the picture. */
async function shafts(device, context) {
    const PASSES = ["scattering/slices", "scattering/rectify", "scattering/rank", "scattering/evaluate.rank",
        "scattering/composite", "core/tonemap"];
    const module = async (pass) => device.createShaderModule({ label: pass, code: await load(`${SHADERS}/${pass}.wgsl`) });
    const compute = async (pass) => device.createComputePipelineAsync({
        label: pass, layout: "auto", compute: { module: await module(pass) },
    });
    const raster = await module("core/raster");
    const attributes = [0, 1, 2].map((i) => ({ shaderLocation: i, offset: 12 * i, format: "float32x3" }));
    const drawing = (vertex, fragment) => device.createRenderPipelineAsync({
        label: vertex,
        layout: "auto",
        vertex: { module: raster, entryPoint: vertex, buffers: [{ arrayStride: 36, attributes }] },
        depthStencil: { format: "depth32float", depthWriteEnabled: true, depthCompare: "less-equal" },
        fragment: fragment && { module: raster, entryPoint: fragment, targets: [{ format: "rgba16float" }] },
    });
    const [shadow, background, surface, ...computed] = await Promise.all([
        drawing("vertex_shadow"),
        drawing("vertex_background", "fragment_background"),
        drawing("vertex_surface", "fragment_surface"),
        ...PASSES.map(compute),
    ]);
    const pipelines = Object.fromEntries(PASSES.map((pass, i) => [pass, computed[i]]));

    const buffer = (bytes, usage) => device.createBuffer({ size: bytes, usage: usage | GPUBufferUsage.COPY_DST });
    const uniform = (bytes) => buffer(bytes, GPUBufferUsage.UNIFORM);
    const numbers = hall(await load(MESH));
    const vertices = buffer(numbers.byteLength, GPUBufferUsage.VERTEX);
    device.queue.writeBuffer(vertices, 0, numbers);
    const [eye, light, medium, sky, tone] = [160, 192, 32, 48, 16].map(uniform);
    device.queue.writeBuffer(sky, 0, SKY);
    // `slices` writes it, the passes after it read it as a uniform.
    const frame = buffer(128, GPUBufferUsage.UNIFORM | GPUBufferUsage.STORAGE);

    const { RENDER_ATTACHMENT, STORAGE_BINDING, TEXTURE_BINDING } = GPUTextureUsage;
    const texture = (size, format, usage) => device.createTexture({ size, format, usage: usage | TEXTURE_BINDING });
    const stored = (size, format) => texture(size, format, STORAGE_BINDING);
    const blocks = COLUMNS / 32;
    const maps = {
        shadow: texture([SHADOW_MAP, SHADOW_MAP], "depth32float", RENDER_ATTACHMENT),
        slices: stored([ROWS, 1], "rgba32float"),
        rectified: stored([COLUMNS, ROWS], "r32float"),
        // For depths of 12 bits, four of them a layer of the planes.
        cells: stored([blocks * blocks, ROWS], "rg32uint"),
        starts: stored([2048, ROWS], "r32uint"),
        planes: stored([blocks, ROWS, 3], "rgba32uint"),
    };
    const compare = device.createSampler({ compare: "less-equal", magFilter: "linear", minFilter: "linear" });

    let pictures = {};
    const resize = (width, height) => {
        Object.values(pictures).forEach((picture) => picture.destroy());
        pictures = {
            depth: texture([width, height], "depth32float", RENDER_ATTACHMENT),
            surface: texture([width, height], "rgba16float", RENDER_ATTACHMENT),
            scattered: stored([width, height], "rgba16float"),
            composed: stored([width, height], "rgba16float"),
        };
        device.queue.writeBuffer(eye, 0, camera(width, height));
    };

    // Bindings by number, as in the shaders. The layout "auto" of a pipeline has those that its entry points use.
    const bind = (pipeline, bindings) => device.createBindGroup({
        layout: pipeline.getBindGroupLayout(0),
        entries: Object.entries(bindings).map(([binding, resource]) => ({
            binding: Number(binding),
            resource: resource instanceof GPUBuffer ? { buffer: resource }
                : resource instanceof GPUTexture ? resource.createView() : resource,
        })),
    });
    const dispatch = (encoder, pass, bindings, groups) => {
        const recorded = encoder.beginComputePass();
        recorded.setPipeline(pipelines[pass]);
        recorded.setBindGroup(0, bind(pipelines[pass], bindings));
        recorded.dispatchWorkgroups(...groups);
        recorded.end();
    };
    const render = (encoder, depth, color, drawings) => {
        const pass = encoder.beginRenderPass({
            colorAttachments: color ? [{ view: color.createView(), loadOp: "clear", storeOp: "store" }] : [],
            depthStencilAttachment: {
                view: depth.createView(), depthClearValue: 1, depthLoadOp: "clear", depthStoreOp: "store",
            },
        });
        pass.setVertexBuffer(0, vertices);
        for (const [pipeline, bindings, count] of drawings) {
            pass.setPipeline(pipeline);
            pass.setBindGroup(0, bind(pipeline, bindings));
            pass.draw(count);
        }
        pass.end();
    };

    const draw = ({ azimuth, elevation, extinction, albedo, g, exposure }) => {
        device.queue.writeBuffer(light, 0, sun(azimuth, elevation));
        // `Medium`: its last numbers are g and the length in metres of rays that meet nothing.
        device.queue.writeBuffer(medium, 0, new Float32Array([albedo, albedo, albedo, extinction, g, 30, 0, 0]));
        // Exposure, and a dither of one step of 8 bits against banding in the smooth light.
        device.queue.writeBuffer(tone, 0, new Float32Array([exposure, 1, 0, 0]));
        const triangles = numbers.length / 9;
        const { depth, surface: lit, scattered, composed } = pictures;
        const groups = [Math.ceil(lit.width / 16), Math.ceil(lit.height / 8)];
        const encoder = device.createCommandEncoder();
        render(encoder, maps.shadow, null, [[shadow, { 1: light }, triangles]]);
        render(encoder, depth, lit, [
            [background, { 0: eye, 2: sky }, 3],
            [surface, { 0: eye, 1: light, 2: sky, 3: maps.shadow, 4: compare }, triangles],
        ]);
        dispatch(encoder, "scattering/slices", { 0: eye, 1: light, 2: medium, 3: frame, 4: maps.slices }, [ROWS / 64]);
        // A thread takes four texels of a row.
        dispatch(encoder, "scattering/rectify", { 0: light, 1: frame, 2: maps.slices, 3: maps.shadow, 4: maps.rectified },
            [COLUMNS / 64, ROWS / 8]);
        dispatch(encoder, "scattering/rank",
            { 0: medium, 1: maps.slices, 2: maps.rectified, 3: maps.cells, 9: maps.starts, 10: maps.planes }, [ROWS]);
        dispatch(encoder, "scattering/evaluate.rank", {
            0: eye, 1: light, 2: medium, 3: frame, 4: maps.slices, 5: depth, 6: maps.shadow, 7: maps.cells,
            8: maps.starts, 9: scattered, 13: maps.planes, 14: maps.rectified,
        }, groups);
        dispatch(encoder, "scattering/composite", { 0: eye, 1: medium, 2: depth, 3: lit, 4: scattered, 5: composed }, groups);
        dispatch(encoder, "core/tonemap", { 0: tone, 1: composed, 2: context.getCurrentTexture() }, groups);
        device.queue.submit([encoder.finish()]);
    };
    return [draw, resize];
}

start().catch((error) => show(error.message));
