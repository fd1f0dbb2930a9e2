// The package @svs/runtime in Node.js: the WebAssembly module draws what the native library draws, and takes no nonsense.

import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { VisibilityScene } from '@svs/runtime';
import { boxOf, random, views } from './cameras.mjs';
import { outputs, plant, plantWithProxies, readGlb, run, shared } from './scenes.mjs';

/** @typedef {import('./cameras.mjs').View & { quality: number, tau: number, budget: number | null, hide: number[] }} Frame */

/**
 * @param {string} file
 */
async function open(file) {
    const { json, bytesOf } = readGlb(file);
    const scene = await VisibilityScene.fromGltf(json, bytesOf);
    assert(scene !== null, 'the file is baked');
    return { json, scene };
}

/**
 * What the module draws.
 * @param {VisibilityScene} scene
 * @param {Parameters<VisibilityScene['cull']>} camera
 */
function drawsOf(scene, ...camera) {
    const count = scene.cull(...camera);
    return [...scene.draws.subarray(0, count)];
}

/**
 * What the native library draws.
 * @param {string} file
 * @param {Frame[]} frames
 * @param {string} name
 * @returns {number[][]}
 */
function native(file, frames, name) {
    mkdirSync(outputs, { recursive: true });
    const cameras = join(outputs, `${name}-cameras.json`);
    writeFileSync(cameras, JSON.stringify(frames));
    const words = ['run', '--quiet', '--release', '--package', 'svs', '--example', 'draws', '--', file, cameras];
    return JSON.parse(run('cargo', words)).map((/** @type {{ ids: number[] }} */ answer) => answer.ids);
}

/**
 * The same frames here and there.
 * @param {string} file
 * @param {string} name
 * @param {(next: () => number, at: number, objects: number) => Omit<Frame, keyof import('./cameras.mjs').View>} settings
 */
async function compare(file, name, settings) {
    const { json, scene } = await open(file);
    const next = random(11);
    const objects = scene.objects.length;
    const frames = views(boxOf(json, scene.scene), 48).map((view, at) => ({ ...view, ...settings(next, at, objects) }));
    const expected = native(file, frames, name);
    let [drawn, extras] = [0, 0];
    frames.forEach((frame, at) => {
        frame.hide.forEach((object) => scene.setHidden(object, true));
        scene.quality = frame.quality;
        scene.tau = frame.tau;
        scene.budget = frame.budget === null ? null : { triangles: frame.budget };
        const ids = drawsOf(scene, frame.view_projection, frame.eye, frame.pixels_per_radian);
        assert.deepEqual(ids, expected[at], `camera ${at} of ${name}`);
        drawn += ids.length;
        extras += ids.filter((id) => id >= objects).length;
        if (frame.budget !== null) assert(scene.statistics.triangles <= frame.budget, 'the budget is kept');
    });
    scene.dispose();
    return { drawn, extras, all: frames.length * objects };
}

test('draws what the native library draws: qualities', async () => {
    const { drawn, all } = await compare(plant(), 'plant', (next) => ({ quality: next(), tau: 0, budget: null, hide: [] }));
    assert(drawn > 0 && drawn < all / 2, `${drawn} of ${all}`);
});

test('draws what the native library draws: hidden objects', async () => {
    await compare(plant(), 'plant-hidden', (next, at, objects) => {
        const hide = at % 4 === 0 ? [Math.floor(next() * objects), Math.floor(next() * objects)] : [];
        return { quality: 0.5, tau: 0, budget: null, hide };
    });
});

test('draws what the native library draws: proxies within budgets', async () => {
    const { extras } = await compare(plantWithProxies(), 'plant-proxies', (next, at) => {
        const budget = at % 3 === 0 ? null : Math.floor(next() * 100_000);
        return { quality: 0.5, tau: 4 * next(), budget, hide: [] };
    });
    assert(extras > 0, 'proxies were drawn');
});

test('draws what the native library draws: a public scene', async (t) => {
    const file = shared('duplex-apartment');
    if (file === null) return t.skip('duplex-apartment is missing');
    await compare(file, 'duplex-apartment', (next) => ({ quality: next(), tau: 1, budget: null, hide: [] }));
});

test('nothing is allocated per frame', async () => {
    const { json, scene } = await open(plant());
    const frames = views(boxOf(json), 16);
    const cull = () => frames.forEach((frame) => scene.cull(frame.view_projection, frame.eye, frame.pixels_per_radian));
    cull();
    const before = scene.draws;
    cull();
    cull();
    assert.equal(scene.draws.buffer, before.buffer, 'the memory did not grow');
    assert.equal(scene.draws, before, 'the same view of it is handed out');
    scene.dispose();
});

test('what the user hides no longer hides anything', async () => {
    const { json, scene } = await open(plant());
    const [view] = views(boxOf(json), 1);
    const draws = () => new Set(drawsOf(scene, view.view_projection, view.eye, view.pixels_per_radian));
    const before = draws();
    for (const object of before) scene.setHidden(object, true);
    const behind = draws();
    assert(behind.size > 0, 'something is behind what was hidden');
    for (const object of behind) assert(!before.has(object), `${object} is hidden`);
    for (const object of before) scene.setHidden(object, false);
    assert.deepEqual(draws(), before);
    scene.dispose();
});

test('a scene that moves as a whole is culled alike, and an object that moves is given back', async () => {
    const { json, scene } = await open(plant());
    const [view] = views(boxOf(json), 1);
    const draws = (/** @type {number[]} */ eye, /** @type {number[]} */ matrix) =>
        drawsOf(scene, matrix, eye, view.pixels_per_radian);
    const before = draws(view.eye, view.view_projection);
    // Everything 100 m to the right, the camera too.
    scene.setRootMatrix([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1]);
    const moved = view.view_projection.slice();
    for (let row = 0; row < 4; row++) moved[12 + row] -= 100 * moved[row];
    assert.deepEqual(draws([view.eye[0] + 100, view.eye[1], view.eye[2]], moved), before);
    scene.setRootMatrix([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    const object = before[0];
    assert.equal(scene.states[object], 1);
    scene.setNodeMatrix(scene.objects[object].node, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1]);
    const isBelowNode = (/** @type {number} */ other) => scene.states[other] === 2;
    // It is either released, or the anchor of a tree, which moves along.
    assert(isBelowNode(object) || scene.states[object] === 1);
    assert(draws(view.eye, view.view_projection).every((other) => !isBelowNode(other)));
    scene.dispose();
});

test('broken files are refused with a reason', async () => {
    const { json, bytesOf } = readGlb(plant());
    const change = async (/** @type {(extension: any, json: any) => void} */ edit) => {
        const copy = structuredClone(json);
        edit(copy.extensions.EXT_spherical_visibility, copy);
        return VisibilityScene.fromGltf(copy, bytesOf);
    };
    const cases = /** @type {[RegExp, (extension: any, json: any) => void][]} */ ([
        [/version/, (extension) => { extension.version = '2.0'; }],
        [/trees/, (extension) => { extension.trees = 'none'; }],
        [/objectCount/, (extension) => { extension.trees[0].objectCount = -3; }],
        [/direction set/, (extension) => { extension.trees[0].directions = 'teapot'; }],
        [/levelBits/, (extension) => { extension.trees[0].levelBits = 3; }],
        [/accessor/, (extension) => { extension.trees[0].tables.LEVEL_ROW = 1e9; }],
        [/scene|anchors/, (extension) => { delete extension.trees[0].scene; extension.trees[0].anchors = []; }],
        [/fingerprint|another state/, (extension) => { extension.trees[0].fingerprint.hash = '0000000000000000'; }],
        [/another state|objects/, (_, copy) => { copy.scenes[copy.scene ?? 0].nodes = []; }],
        [/two parents|exist/, (_, copy) => { copy.scenes[copy.scene ?? 0].nodes.push(1e6); }],
    ]);
    for (const [reason, edit] of cases) await assert.rejects(change(edit), (error) => reason.test(String(error)), String(edit));
    assert.equal(await change((_, copy) => { delete copy.extensions; }), null);
});

test('wrong deviations of simplified meshes are refused, as natively; the scene is drawn without proxies', async () => {
    const { json, bytesOf } = readGlb(plant());
    const noticeOf = async (/** @type {any} */ deviation) => {
        const copy = structuredClone(json);
        const level = { mesh: 1, error: 0.1, ...(deviation === undefined ? {} : { deviation }) };
        copy.extensions.EXT_spherical_visibility.meshLevels = [{ mesh: 0, levels: [level] }];
        return (await VisibilityScene.fromGltf(copy, bytesOf))?.notice;
    };
    for (const right of [undefined, null, [0, 0, 0], [0.01, 0.02, 0.5]]) assert.equal(await noticeOf(right), null, String(right));
    for (const wrong of [[-1, -1, -1], [-1, 0.05, 0.1], [0.05, 0.02, 0.1], [0.01, 0.02, 2], [0.01, 0.02], [0.01, '0.02', 0.1], 'none']) {
        assert.match(String(await noticeOf(wrong)), /a deviation must be in order/, String(wrong));
    }
});
