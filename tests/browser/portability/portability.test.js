// SPDX-License-Identifier: MIT OR Apache-2.0
// node --test: numbers, tolerances and verdicts, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { compare, elements, half } from "./compare.js";
import { judge, parseExpected, summarise } from "./judge.js";
import { toleranceOf } from "./tolerances.js";

const bytes = (array) => new Uint8Array(array.buffer);

test("half floats", () => {
    const pairs = [[0x0000, 0], [0x3c00, 1], [0xc000, -2], [0x7bff, 65504], [0x0001, 2 ** -24], [0x3555, 0.333251953125]];
    for (const [bits, value] of pairs) assert.equal(half(bits), value);
    assert.equal(half(0xfc00), -Infinity);
    assert.ok(Number.isNaN(half(0x7e00)));
});

test("differences in units of the tolerance", () => {
    const about = { kind: "texture", format: "rg32float" };
    const [actual, expected] = [[1, 2, 3, 4.4], [1, 2, 3, 4]].map((list) => bytes(new Float32Array(list)));
    const result = compare(about, actual, expected, { f32: [0.1, 0.025] });
    assert.equal(result.compared, 2);
    assert.equal(result.off, 1);
    assert.ok(Math.abs(result.worst - 2) < 1e-5);
    assert.equal(result.at, 1);
    assert.equal(compare(about, actual, expected, { f32: [1, 0] }).off, 0);
});

test("what is no number differs from a number alone", () => {
    const about = { kind: "texture", format: "r32float" };
    const [numbers, none] = [[1, Infinity], [NaN, Infinity]].map((list) => bytes(new Float32Array(list)));
    assert.equal(compare(about, none, numbers, { f32: [1, 1] }).off, 1);
    assert.equal(compare(about, none, none, { f32: [0, 0] }).off, 0);
});

test("integers and zero tolerance", () => {
    const about = { kind: "texture", format: "r32uint" };
    const [actual, expected] = [[7, 8], [7, 9]].map((list) => bytes(new Uint32Array(list)));
    assert.equal(compare(about, actual, expected, { u32: [0, 0] }).off, 1);
    assert.equal(compare(about, actual, expected, { u32: [1, 0] }).off, 0);
});

test("numbers that stand for others", () => {
    const [actual, expected] = [[[1, 512]], [[2, 0]]].map(([list]) => bytes(new Float32Array(list)));
    const texel = { kind: "texture", format: "rg32float" };
    const f32 = [1e-6, 0];
    assert.equal(compare(texel, actual, expected, { f32 }).off, 1);
    assert.equal(compare(texel, actual, expected, { f32, measure: { weights: [1, 1 / 512] } }).worst, 0);
    const words = { kind: "buffer", words: { head: "", repeated: "u" } };
    const [near, far] = [[1.0, 2.5], [1.0, 2.0]].map((list) => bytes(new Float32Array(list)));
    const wide = compare(words, near, far, { f32: [0.2, 0], measure: { kind: "f32" }, times: 3 });
    assert.deepEqual([wide.off, wide.offWide], [1, 0]);
    assert.equal(compare(words, near, far, { u32: [0, 0], f32: [1e9, 0], measure: { scale: 0.5 } }).off, 0);
});

test("elements of a buffer", () => {
    const about = { kind: "buffer", words: { head: "u..f", repeated: "fu." } };
    assert.deepEqual([...elements(about, 48)], [
        [[0, "u32"]],
        [[12, "f32"]],
        [[16, "f32"], [20, "u32"]],
        [[28, "f32"], [32, "u32"]],
    ]);
});

const SNAPSHOTS = new Map([["wide", [0.1, 0, 0.5]], ["narrow", [0.01, 0, 0.1]], ["picture", null]]);
const TAKEN = [
    { snapshot: "wide", key: "a/b:default main", output: "out" },
    { snapshot: "narrow", key: "a/b:default main", output: "out" },
    { snapshot: "picture", key: "a/c:default main", output: "out" },
];

test("the strictest snapshot rules", () => {
    const tolerance = toleranceOf("a/b:default main", "out", TAKEN, SNAPSHOTS);
    assert.deepEqual([tolerance.source, tolerance.f32, tolerance.outliers], ["narrow", [0.01, 0], 0.1]);
    assert.equal(toleranceOf("a/c:default main", "out", TAKEN, SNAPSHOTS).source, "default");
});

const allowed = () => ({ outliers: 0.1 });
const output = (off, offWide = 0) => [{ name: "out", compared: 10, off, offWide, worst: 2, changed: true }];
const fine = [{ key: "a/b:default main", outputs: output(1) }, { key: "a/c:default main", outputs: output(0) }];
const judged = (cases, expected = "") => judge(summarise(cases, allowed), parseExpected(expected), TAKEN, SNAPSHOTS);

test("what keeps to the tolerance passes", () => assert.deepEqual(judged(fine), []));

test("each case keeps to the share by itself", () => {
    const findings = judged([...fine, { key: "a/b:default main", outputs: output(2) }]);
    assert.equal(findings.length, 1);
    assert.match(findings[0], /^a\/b:default main, out: 20.00 % of a case is beyond/);
});

test("expected failures fail, or are findings", () => {
    const line = "a/b:default main | out | 3 times | rounds twice";
    assert.deepEqual(judged([...fine, { key: "a/b:default main", outputs: output(9) }], line), []);
    const worse = judged([...fine, { key: "a/b:default main", outputs: output(9, 5) }], line);
    assert.match(worse[0], /more than the expected failure's 3 times$/);
    const share = line.replace("3 times", "90 %");
    assert.deepEqual(judged([...fine, { key: "a/b:default main", outputs: output(9, 5) }], share), []);
    assert.equal(judged([...fine, { key: "a/b:default main", outputs: output(10) }], share).length, 1);
    assert.match(judged(fine, line)[0], /line 1: a\/b:default main, out does not fail/);
    assert.throws(() => parseExpected("a/b out why"), /line 1/);
    assert.throws(() => parseExpected("a/b:c d | out | some | why"), /a limit is/);
});

test("no pass with a snapshot is passed over", () => {
    assert.match(judged(fine.slice(0, 1))[0], /snapshot picture: its pass a\/c:default main has no case/);
    assert.match(judged([{ key: "a/b:default main", error: "lost" }, fine[1]])[0], /a\/b:default main, \*: lost/);
    const idle = [fine[0], { key: "a/c:default main", outputs: [{ ...output(0)[0], changed: false }] }];
    assert.match(judged(idle)[0], /no case of a\/c:default main changes out/);
    const unknown = [...TAKEN.slice(0, 2), { snapshot: "picture", key: null, output: null }];
    const rows = summarise(fine, allowed);
    assert.match(judge(rows, [], unknown, SNAPSHOTS)[0], /snapshot picture: no recorded pass wrote/);
    assert.match(judge(rows, [], TAKEN.slice(0, 2), SNAPSHOTS)[0], /snapshot picture was not taken/);
});
