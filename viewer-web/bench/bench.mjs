// Frame times of the example with and without the plugin, and times of culling in WebAssembly: `node bench.mjs FILE FRAMES`.
//
// The same path is flown once, outside and inside; at each place both ways of drawing are timed one after the other, until the
// picture is there. Prints JSON.

import { writeFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { performance } from 'node:perf_hooks';
import { VisibilityScene } from '@svs/runtime';
import { launch, serve } from '../tests/browser.mjs';
import { boxOf, views } from '../tests/cameras.mjs';
import { outputs, readGlb, root, run } from '../tests/scenes.mjs';

const [file, frameCount] = [process.argv[2], Number(process.argv[3] ?? 12)];
const SIZE = { width: 1280, height: 720 };
/** Times each frame is drawn in each way; the fastest counts, for other programs can only slow it down. */
const PASSES = 2;
const CULL_REPEATS = 30;

/** @param {number[]} values */
const median = (values) => {
    const sorted = [...values].sort((a, b) => a - b);
    return (sorted[(sorted.length - 1) >> 1] + sorted[sorted.length >> 1]) / 2;
};

/** In the page: flies along a path and times each frame in both ways. */
async function fly(/** @type {[boolean, number, number]} */ [inside, frames, passes]) {
    const { THREE, camera, draw, figures, look, model, plugin, renderer } = /** @type {any} */ (window).example;
    const box = new THREE.Box3().setFromObject(model);
    const { center, radius } = box.getBoundingSphere(new THREE.Sphere());
    const size = box.getSize(new THREE.Vector3());
    const gl = renderer.getContext();
    const pixel = new Uint8Array(4);
    const time = () => {
        const start = performance.now();
        draw();
        // Waits for the picture.
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return performance.now() - start;
    };
    const results = [];
    for (let frame = -1; frame < frames; frame++) {
        const turn = (2 * Math.PI * (Math.max(frame, 0) + 0.5)) / frames;
        const ahead = new THREE.Vector3(Math.cos(turn), 0, Math.sin(turn));
        if (inside) {
            const from = ahead.clone().multiply(size).multiplyScalar(0.25).add(center);
            look(from, from.clone().add(new THREE.Vector3(-Math.sin(turn), 0, Math.cos(turn))));
        } else {
            look(ahead.setY(0.35).normalize().multiplyScalar(1.6 * radius).add(center), center);
        }
        camera.updateMatrixWorld();
        /** @type {Record<string, any>} */
        const result = {};
        for (const name of ['plain', 'visibility']) {
            plugin.enabled = name === 'visibility';
            let best = Infinity;
            for (let pass = 0; pass < passes; pass++) best = Math.min(best, time());
            const { triangles, calls, statistics } = figures();
            result[name] = { milliseconds: best, triangles, calls, cull: statistics.cullMilliseconds };
        }
        // The first place only warms up.
        if (frame >= 0) results.push(result);
    }
    return results;
}

/** @param {any[]} frames */
function summary(frames) {
    const of = (/** @type {string} */ method, /** @type {string} */ figure) => median(frames.map((frame) => frame[method][figure]));
    const part = (/** @type {string} */ method) => ({
        milliseconds: of(method, 'milliseconds'), triangles: of(method, 'triangles'), calls: of(method, 'calls'),
    });
    const ratio = median(frames.map((frame) => frame.plain.milliseconds / frame.visibility.milliseconds));
    return { plain: part('plain'), visibility: part('visibility'), cull: of('visibility', 'cull'), ratio };
}

async function inBrowser() {
    const server = await serve({ '/': join(root, 'viewer-web'), '/scenes/': dirname(file) });
    const browser = await launch();
    try {
        const page = await browser.newPage({ viewport: SIZE });
        page.on('pageerror', (error) => console.error(error));
        await page.goto(`${server.url}/three/example/index.html?still&src=/scenes/${basename(file)}`);
        await page.waitForFunction(() => 'exampleReady' in window, undefined, { timeout: 300_000 });
        const baked = await page.evaluate(() => /** @type {any} */ (window).example.figures().baked);
        if (!baked) throw new Error('the bake cannot be used');
        /** @type {Record<string, any>} */
        const results = {};
        for (const [name, inside] of /** @type {[string, boolean][]} */ ([['outside', false], ['inside', true]])) {
            const frames = await page.evaluate(fly, /** @type {[boolean, number, number]} */ ([inside, frameCount, PASSES]));
            results[name] = summary(frames);
        }
        return results;
    } finally {
        await browser.close();
        await server.close();
    }
}

async function culling() {
    const { json, bytesOf } = readGlb(file);
    const scene = await VisibilityScene.fromGltf(json, bytesOf);
    if (scene === null) throw new Error('the file is not baked');
    const frames = views(boxOf(json, scene.scene), 24).map((view) => ({ ...view, quality: 0.5, tau: 1, budget: null }));
    scene.quality = 0.5;
    const wasm = frames.map((frame) => {
        const times = [];
        for (let repeat = 0; repeat < CULL_REPEATS; repeat++) {
            // What was asked last is answered from memory.
            scene.quality = 1;
            scene.cull(frame.view_projection, frame.eye, frame.pixels_per_radian);
            scene.quality = 0.5;
            const start = performance.now();
            scene.cull(frame.view_projection, frame.eye, frame.pixels_per_radian);
            times.push(performance.now() - start);
        }
        return median(times);
    });
    const cameras = join(outputs, 'bench-cameras.json');
    writeFileSync(cameras, JSON.stringify(frames));
    const words = ['run', '--quiet', '--release', '--package', 'svs', '--example', 'draws', '--', file, cameras, `${CULL_REPEATS}`];
    const native = JSON.parse(run('cargo', words)).map((/** @type {any} */ answer) => answer.milliseconds);
    const ratios = native.map((/** @type {number} */ milliseconds, /** @type {number} */ at) => wasm[at] / milliseconds);
    return { objects: scene.objects.length, wasm: median(wasm), native: median(native), ratio: median(ratios) };
}

console.log(JSON.stringify({ ...(await inBrowser()), culling: await culling() }));
