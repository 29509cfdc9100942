// SPDX-License-Identifier: MIT OR Apache-2.0
// Runs in a page: repeats a recorded dispatch or render pass on the page's WebGPU device.

const { STORAGE, UNIFORM, VERTEX, INDEX, INDIRECT, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;

/** Bytes of a texel. */
export const TEXEL_BYTES = {
    depth32float: 4, r16float: 2, r32float: 4, r32uint: 4, r8unorm: 1, rg16float: 4, rg32float: 8, rg32uint: 8, rg8unorm: 2,
    rgba16float: 8, rgba32float: 16, rgba32uint: 16, rgba8unorm: 4,
};

/** An adapter's device on WebGPU's default limits and no optional feature, and what it says of itself. */
export async function open() {
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) throw new Error("this browser gives no WebGPU adapter");
    const { vendor, architecture, device: name, description } = adapter.info;
    const device = await adapter.requestDevice();
    return { device, info: { vendor, architecture, device: name, description } };
}

/**
 * Repeats a case. `blob(name)` gives the bytes of a blob, `text(shader)` the WGSL of the case's shader of that number. Returns the
 * bytes of every resource that the case writes, by its place in `resources`.
 */
export async function repeat(device, recorded, blob, text) {
    for (const filter of ["validation", "internal", "out-of-memory"]) device.pushErrorScope(filter);
    let failure;
    const results = new Map();
    try {
        const resources = await Promise.all(recorded.resources.map((_, place) => create(device, recorded, place, blob)));
        const samplers = recorded.samplers.map((sampler) => device.createSampler(sampler));
        const given = { device, resources, samplers, text };
        const encoder = device.createCommandEncoder();
        await (recorded.run.kind === "compute" ? compute : render)(given, recorded.run, encoder);
        const places = recorded.outputs.map((output) => output.resource);
        const copies = places.map((place) => copyOut(device, encoder, recorded.resources[place], resources[place]));
        device.queue.submit([encoder.finish()]);
        for (const [k, place] of places.entries()) results.set(place, await copies[k]());
        resources.forEach((resource) => resource.destroy());
    } catch (error) {
        failure = error;
    }
    for (let scope = 0; scope < 3; scope++) {
        const error = await device.popErrorScope();
        if (error) failure = new Error(error.message);
    }
    if (failure) throw failure;
    return results;
}

async function create(device, recorded, place, blob) {
    const about = recorded.resources[place];
    if (about.before === null) throw new Error("a resource could not be recorded: it has several samples a pixel, or is no source of copies");
    const bytes = await blob(about.before);
    if (about.kind === "buffer") {
        const usage = STORAGE | UNIFORM | VERTEX | INDEX | INDIRECT | COPY_SRC | COPY_DST;
        const buffer = device.createBuffer({ size: about.size, usage });
        device.queue.writeBuffer(buffer, 0, bytes);
        return buffer;
    }
    const { size, dimension, format, levels } = about;
    const texture = device.createTexture({ size, dimension, format, mipLevelCount: levels, usage: usages(recorded, place) });
    for (const level of levelsOf(about)) {
        const data = bytes.subarray(level.start, level.end);
        if (format === "depth32float") {
            drawDepths(device, texture, level, data);
        } else {
            const layout = { bytesPerRow: level.row, rowsPerImage: level.size[1] };
            device.queue.writeTexture({ texture, mipLevel: level.number }, data, layout, level.size);
        }
    }
    return texture;
}

function usages(recorded, place) {
    const { run } = recorded;
    const bindings = run.bindings ?? run.draws.flatMap((draw) => draw.bindings);
    const targets = run.kind === "render" ? [...run.colors, ...run.colors.map((color) => color.resolve), run.depth] : [];
    let usage = GPUTextureUsage.COPY_SRC | GPUTextureUsage.COPY_DST;
    for (const { bound, storageTexture } of bindings) {
        if (bound.resource !== place) continue;
        usage |= storageTexture ? GPUTextureUsage.STORAGE_BINDING : GPUTextureUsage.TEXTURE_BINDING;
    }
    const drawn = targets.some((target) => target?.resource === place);
    if (drawn || recorded.resources[place].format === "depth32float") usage |= GPUTextureUsage.RENDER_ATTACHMENT;
    return usage;
}

/** Size and place in a blob of each level of a texture. */
function levelsOf({ size, dimension, format, levels }) {
    const texel = TEXEL_BYTES[format];
    if (!texel) throw new Error(`texels of ${format} are unknown here`);
    const list = [];
    for (let number = 0, start = 0; number < levels; number++) {
        const half = (side) => Math.max(1, side >> number);
        const of = [half(size[0]), half(size[1]), dimension === "3d" ? half(size[2]) : size[2]];
        const end = start + of[0] * of[1] * of[2] * texel;
        list.push({ number, size: of, row: of[0] * texel, start, end });
        start = end;
    }
    return list;
}

const DEPTHS = `
@group(0) @binding(0) var depths: texture_2d<f32>;
@vertex fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(4.0 * f32(index & 1u) - 1.0, 2.0 * f32(index & 2u) - 1.0, 0.0, 1.0);
}
@fragment fn depth(@builtin(position) position: vec4<f32>) -> @builtin(frag_depth) f32 {
    return textureLoad(depths, vec2<u32>(position.xy), 0).x;
}`;
const depthPipelines = new WeakMap();

/** WebGPU cannot copy into a depth texture, so depths are drawn, bit for bit. */
function drawDepths(device, texture, level, data) {
    if (!depthPipelines.has(device)) {
        const module = device.createShaderModule({ code: DEPTHS });
        depthPipelines.set(device, device.createRenderPipeline({
            layout: "auto",
            vertex: { module },
            fragment: { module, targets: [] },
            depthStencil: { format: "depth32float", depthWriteEnabled: true, depthCompare: "always" },
        }));
    }
    const pipeline = depthPipelines.get(device);
    const [width, height, layers] = level.size;
    const encoder = device.createCommandEncoder();
    for (let layer = 0; layer < layers; layer++) {
        const usage = GPUTextureUsage.COPY_DST | GPUTextureUsage.TEXTURE_BINDING;
        const depths = device.createTexture({ size: [width, height], format: "r32float", usage });
        const bytes = level.row * height;
        const part = data.subarray(layer * bytes, (layer + 1) * bytes);
        device.queue.writeTexture({ texture: depths }, part, { bytesPerRow: level.row }, [width, height]);
        const view = { dimension: "2d", baseArrayLayer: layer, arrayLayerCount: 1, baseMipLevel: level.number, mipLevelCount: 1 };
        const depth = { view: texture.createView(view), depthLoadOp: "clear", depthClearValue: 0, depthStoreOp: "store" };
        const pass = encoder.beginRenderPass({ colorAttachments: [], depthStencilAttachment: depth });
        pass.setPipeline(pipeline);
        const entries = [{ binding: 0, resource: depths.createView() }];
        pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
        pass.draw(3);
        pass.end();
    }
    device.queue.submit([encoder.finish()]);
}

/** The modules of each device by their text: compiling takes longer than running. */
const modules = new WeakMap();

async function moduleOf({ device, text }, shader) {
    const code = await text(shader);
    if (!modules.has(device)) modules.set(device, new Map());
    const known = modules.get(device);
    if (!known.has(code)) {
        const module = device.createShaderModule({ code });
        const { messages } = await module.getCompilationInfo();
        const error = messages.find((message) => message.type === "error");
        if (error) throw new Error(`line ${error.lineNum}: ${error.message}`);
        known.set(code, module);
    }
    return known.get(code);
}

/** Layout and bind group of a call. */
function bind({ device, resources, samplers }, bindings) {
    const layout = device.createBindGroupLayout({ entries: bindings.map(({ name, bound, ...entry }) => entry) });
    const entries = bindings.map(({ binding, bound, buffer, sampler }) => {
        if (sampler) return { binding, resource: samplers[bound.sampler] };
        const resource = resources[bound.resource];
        return { binding, resource: buffer ? { buffer: resource } : resource.createView(bound.view) };
    });
    const group = device.createBindGroup({ layout, entries });
    return { group, layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }) };
}

async function compute(given, run, encoder) {
    const { group, layout } = bind(given, run.bindings);
    const module = await moduleOf(given, run.shader);
    const stage = { module, entryPoint: run.entryPoint };
    const pipeline = await given.device.createComputePipelineAsync({ layout, compute: stage });
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group);
    if (Array.isArray(run.groups)) pass.dispatchWorkgroups(...run.groups);
    else pass.dispatchWorkgroupsIndirect(given.resources[run.groups.buffer], run.groups.offset);
    pass.end();
}

async function render(given, run, encoder) {
    const { device, resources } = given;
    const draws = [];
    for (const draw of run.draws) {
        const { group, layout } = bind(given, draw.bindings);
        const module = await moduleOf(given, draw.shader);
        const { vertex, fragment, vertices, targets, depth, samples } = draw.pipeline;
        const pipeline = await device.createRenderPipelineAsync({
            layout,
            vertex: { module, entryPoint: vertex, buffers: vertices ? [vertices] : [] },
            fragment: fragment ? { module, entryPoint: fragment, targets } : undefined,
            depthStencil: depth ?? undefined,
            multisample: { count: samples },
        });
        draws.push({ ...draw, group, pipeline });
    }
    const view = (target) => resources[target.resource].createView(target.view);
    const pass = encoder.beginRenderPass({
        colorAttachments: run.colors.map((color) => ({
            view: view(color),
            resolveTarget: color.resolve ? view(color.resolve) : undefined,
            loadOp: color.load ? "clear" : "load",
            clearValue: color.load ?? undefined,
            storeOp: color.resolve ? "discard" : "store",
        })),
        depthStencilAttachment: run.depth
            ? { view: view(run.depth), depthLoadOp: "clear", depthClearValue: run.depth.clear, depthStoreOp: "store" }
            : undefined,
    });
    for (const { pipeline, group, viewport, scissor, vertices, indices, extent } of draws) {
        pass.setPipeline(pipeline);
        pass.setBindGroup(0, group);
        if (viewport) pass.setViewport(...viewport, 0, 1);
        if (scissor) pass.setScissorRect(...scissor);
        if (vertices !== null) pass.setVertexBuffer(0, resources[vertices]);
        if (indices !== null) pass.setIndexBuffer(resources[indices], "uint32");
        const count = ([first, end]) => end - first;
        if (extent.vertices) {
            pass.draw(count(extent.vertices), count(extent.instances), extent.vertices[0], extent.instances[0]);
        } else if (extent.indices) {
            pass.drawIndexed(count(extent.indices), count(extent.instances), extent.indices[0], 0, extent.instances[0]);
        } else {
            pass.drawIndirect(resources[extent.buffer], extent.offset);
        }
    }
    pass.end();
}

/** Records a copy; the function that is returned gives its bytes once it was submitted. */
function copyOut(device, encoder, about, resource) {
    if (about.kind === "buffer") {
        const copy = device.createBuffer({ size: about.size, usage: MAP_READ | COPY_DST });
        encoder.copyBufferToBuffer(resource, 0, copy, 0, about.size);
        return () => mapped(copy);
    }
    const levels = levelsOf(about).map((level) => {
        const bytesPerRow = Math.ceil(level.row / 256) * 256;
        const rows = level.size[1] * level.size[2];
        const copy = device.createBuffer({ size: bytesPerRow * rows, usage: MAP_READ | COPY_DST });
        const from = { texture: resource, mipLevel: level.number };
        encoder.copyTextureToBuffer(from, { buffer: copy, bytesPerRow, rowsPerImage: level.size[1] }, level.size);
        return { level, bytesPerRow, rows, copy };
    });
    return async () => {
        const result = new Uint8Array(levels.at(-1).level.end);
        for (const { level, bytesPerRow, rows, copy } of levels) {
            const bytes = await mapped(copy);
            for (let row = 0; row < rows; row++) {
                result.set(bytes.subarray(row * bytesPerRow, row * bytesPerRow + level.row), level.start + row * level.row);
            }
        }
        return result;
    };
}

async function mapped(buffer) {
    await buffer.mapAsync(GPUMapMode.READ);
    const bytes = new Uint8Array(buffer.getMappedRange().slice(0));
    buffer.destroy();
    return bytes;
}
