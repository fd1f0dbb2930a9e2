// The example of @svs/three in a browser on WebGL 2: what it shows, and that nothing of the picture is missing.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { launch, serve } from './browser.mjs';
import { compare, picture } from './pictures.mjs';
import { outputs, plant, plantWithCompressedProxies, plantWithProxies, root, shared } from './scenes.mjs';

// Pictures with the plugin against pictures without it, at quality 0.75, which drops nothing for its size: what is missing is what
// no ray of a draft bake has seen.
const LEAST_SSIM = 0.995;
const MOST_DIFFERING = 0.002;

/** @type {import('playwright-core').Browser} */
let browser;
/** @type {Awaited<ReturnType<typeof serve>>} */
let server;

before(async () => {
    server = await serve({ '/': join(root, 'viewer-web'), '/scenes/': outputs, '/samples/': join(root, 'samples') });
    browser = await launch();
});

after(async () => {
    await browser?.close();
    await server?.close();
});

/**
 * Opens the example; errors of the page fail the test.
 * @param {string} source
 */
async function open(source) {
    const page = await browser.newPage({ viewport: { width: 480, height: 320 } });
    /** @type {string[]} */
    const problems = [];
    page.on('pageerror', (error) => problems.push(String(error.stack)));
    page.on('console', (message) => {
        if (message.type() === 'error' || (message.type() === 'warning' && message.text().includes('EXT_'))) problems.push(message.text());
    });
    await page.goto(`${server.url}/three/example/index.html?still&src=${source}`);
    await page.waitForFunction(() => 'exampleReady' in window, undefined, { timeout: 120_000 });
    // The panel is not what is compared.
    await page.addStyleTag({ content: 'form { visibility: hidden }' });
    return { page, problems };
}

/**
 * Draws and returns the figures.
 * @param {import('playwright-core').Page} page
 */
function draw(page) {
    return page.evaluate(() => {
        const { example } = /** @type {any} */ (window);
        example.draw();
        return example.figures();
    });
}

/**
 * @param {import('playwright-core').Page} page
 * @param {string} id
 * @param {string} value
 */
async function set(page, id, value) {
    await page.evaluate(([id, value]) => {
        const control = /** @type {HTMLInputElement} */ (document.getElementById(id));
        control.value = value;
        control.dispatchEvent(new Event('input'));
    }, [id, value]);
}

/**
 * The camera on a circle around the scene (`distance` in radii), or in its middle.
 * @param {import('playwright-core').Page} page
 * @param {number} turn
 * @param {number} distance
 */
async function look(page, turn, distance) {
    await page.evaluate(([turn, distance]) => {
        const { THREE, look, model } = /** @type {any} */ (window).example;
        const { center, radius } = new THREE.Box3().setFromObject(model).getBoundingSphere(new THREE.Sphere());
        const ahead = new THREE.Vector3(Math.cos(turn), 0.35, Math.sin(turn)).normalize();
        const from = center.clone().addScaledVector(ahead, distance * radius);
        look(from, distance === 0 ? center.clone().add(new THREE.Vector3(Math.cos(turn), 0, Math.sin(turn))) : center);
    }, [turn, distance]);
}

/**
 * Pictures with and without the plugin, outside and inside.
 * @param {import('playwright-core').Page} page
 * @param {string} name
 */
async function comparePictures(page, name) {
    await set(page, 'quality', '0.75');
    let worst = 1;
    for (const [turn, distance] of [[0.5, 1.5], [2.5, 1.1], [4.2, 2.5], [1, 0], [4, 0]]) {
        await look(page, turn, distance);
        await set(page, 'method', 'plain');
        const all = await draw(page);
        const without = await picture(page, `${name}-${turn}-plain`);
        await set(page, 'method', 'visibility');
        const visible = await draw(page);
        const withPlugin = await picture(page, `${name}-${turn}-visibility`);
        const { ssim, differing } = compare(without, withPlugin);
        worst = Math.min(worst, ssim);
        const text = `${name}, ${turn}, ${distance}: SSIM ${ssim}, ${differing} of the pixels differ`;
        assert(ssim >= LEAST_SSIM && differing <= MOST_DIFFERING, text);
        assert(visible.triangles < all.triangles, `${visible.triangles} of ${all.triangles} triangles`);
        assert(visible.calls < all.calls, `${visible.calls} of ${all.calls} calls`);
        if (distance > 0) assert(visible.triangles * 4 < all.triangles, `${visible.triangles} of ${all.triangles} triangles outside`);
    }
    console.log(`${name}: the worst SSIM is ${worst.toFixed(5)}`);
}

test('the sample: no picture differs, few triangles are drawn', async () => {
    plant();
    const { page, problems } = await open('/scenes/plant.svs.glb');
    await comparePictures(page, 'plant');
    assert.deepEqual(problems, []);
    await page.close();
});

test('a public scene: no picture differs, few triangles are drawn', async (t) => {
    if (shared('duplex-apartment') === null) return t.skip('duplex-apartment is missing');
    const { page, problems } = await open('/scenes/duplex-apartment.svs.glb');
    await comparePictures(page, 'duplex-apartment');
    assert.deepEqual(problems, []);
    await page.close();
});

test('the slider and the budget', async () => {
    plant();
    const { page, problems } = await open('/scenes/plant.svs.glb');
    await look(page, 0.5, 1.3);
    let last = 0;
    for (const quality of ['0', '0.3', '0.5', '0.75', '1']) {
        await set(page, 'quality', quality);
        const { statistics } = await draw(page);
        assert(statistics.drawn >= last, `quality ${quality} draws no less`);
        last = statistics.drawn;
    }
    for (const budget of ['20000', '5000', '0']) {
        await set(page, 'budget', budget);
        const { triangles, statistics } = await draw(page);
        assert(triangles <= Number(budget), `${triangles} triangles within ${budget}`);
        assert.equal(statistics.triangles, triangles, 'three.js draws what the runtime says');
    }
    await set(page, 'budget', '');
    assert.equal((await draw(page)).statistics.drawn, last);
    assert.deepEqual(problems, []);
    await page.close();
});

test('hiding shows what was behind, rays find what is drawn', async () => {
    plant();
    const { page, problems } = await open('/scenes/plant.svs.glb');
    await set(page, 'quality', '0.75');
    await look(page, 0.5, 1.3);
    const first = await draw(page);
    // Everything that is drawn is hidden; what is behind it appears, and the picture is that of three.js alone.
    const picked = await page.evaluate(() => {
        const { pick } = /** @type {any} */ (window).example;
        const found = new Set();
        for (let x = 20; x < innerWidth; x += 20) {
            for (let y = 20; y < innerHeight; y += 20) {
                const object = pick(x, y);
                if (object !== null) found.add(object);
            }
        }
        for (const object of found) object.visible = false;
        return found.size;
    });
    assert(picked > 3, `${picked} objects were found by rays`);
    const second = await draw(page);
    assert(second.statistics.candidates > first.statistics.candidates, 'more objects are visible');
    const withPlugin = await picture(page, 'plant-hidden-visibility');
    await set(page, 'method', 'plain');
    await draw(page);
    const { ssim, differing } = compare(await picture(page, 'plant-hidden-plain'), withPlugin);
    assert(ssim >= LEAST_SSIM && differing <= MOST_DIFFERING, `SSIM ${ssim}, ${differing} of the pixels differ`);
    await set(page, 'method', 'visibility');
    await page.evaluate(() => document.getElementById('show')?.click());
    assert.equal((await draw(page)).statistics.drawn, first.statistics.drawn, 'as before');
    assert.deepEqual(problems, []);
    await page.close();
});

test('objects and scenes that move', async () => {
    plant();
    const { page, problems } = await open('/scenes/plant.svs.glb');
    await set(page, 'quality', '0.75');
    await look(page, 0.5, 1.3);
    // A roof sheet is lifted, and all is turned and scaled: nothing is missing.
    await page.evaluate(() => {
        const { model, pick } = /** @type {any} */ (window).example;
        for (const [x, y] of [[240, 140], [200, 160], [280, 150]]) {
            const object = pick(x, y);
            if (object !== null) object.position.y += 15;
        }
        model.rotation.y = 0.4;
        model.scale.setScalar(0.9);
    });
    await draw(page);
    const withPlugin = await picture(page, 'plant-moved-visibility');
    await set(page, 'method', 'plain');
    await draw(page);
    const { ssim, differing } = compare(await picture(page, 'plant-moved-plain'), withPlugin);
    assert(ssim >= LEAST_SSIM && differing <= MOST_DIFFERING, `SSIM ${ssim}, ${differing} of the pixels differ`);
    assert.deepEqual(problems, []);
    await page.close();
});

test('attached to a scene it follows its cameras; others see everything', async () => {
    plant();
    const { page, problems } = await open('/scenes/plant.svs.glb');
    await look(page, 0.5, 1.3);
    const { statistics } = await draw(page);
    const attached = await page.evaluate(() => {
        const { THREE, camera, plugin, renderer, scene } = /** @type {any} */ (window).example;
        const detach = plugin.attach(scene);
        const triangles = (/** @type {any} */ by) => {
            renderer.render(scene, by);
            return renderer.info.render.triangles;
        };
        const byCamera = triangles(camera);
        const drawn = plugin.statistics.drawn;
        const flat = new THREE.OrthographicCamera(-90, 90, 90, -90, -500, 500);
        const byOther = triangles(flat);
        const again = triangles(camera);
        detach();
        return { byCamera, byOther, again, drawn, detached: triangles(camera) };
    });
    assert.equal(attached.drawn, statistics.drawn);
    assert.equal(attached.byCamera, statistics.triangles);
    assert.equal(attached.again, statistics.triangles);
    assert(attached.byOther > 10 * attached.byCamera, `${attached.byOther} triangles by an orthographic camera`);
    assert(attached.detached > 10 * attached.byCamera, `${attached.detached} triangles when it is detached`);
    assert.deepEqual(problems, []);
    await page.close();
});

test('proxies are drawn', async () => {
    plantWithProxies();
    const { page, problems } = await open('/scenes/plant-proxies.svs.glb');
    await look(page, 0.5, 4);
    await set(page, 'budget', '8000');
    await page.evaluate(() => {
        /** @type {any} */ (window).example.plugin.tau = 4;
    });
    const { statistics, triangles } = await draw(page);
    assert(statistics.proxies > 0 && triangles <= 8000, JSON.stringify(statistics));
    const withProxies = await picture(page, 'plant-proxies-visibility');
    await set(page, 'method', 'plain');
    await draw(page);
    const { ssim } = compare(await picture(page, 'plant-proxies-plain'), withProxies);
    // Simplified and painted in one colour per object: alike, not equal.
    assert(ssim >= 0.9, `SSIM ${ssim}`);
    assert.deepEqual(problems, []);
    await page.close();
});

test('compressed proxies are drawn; without a decoder the objects are', async () => {
    plantWithCompressedProxies();
    const { page, problems } = await open('/scenes/plant-meshopt.svs.glb');
    await look(page, 0.5, 4);
    await set(page, 'budget', '8000');
    const drawn = await draw(page);
    assert(drawn.statistics.proxies > 0 && drawn.triangles <= 8000, JSON.stringify(drawn.statistics));
    assert.deepEqual(problems, []);

    const message = await page.evaluate(async () => {
        const { example } = /** @type {any} */ (window);
        example.loader.setMeshoptDecoder(null);
        await example.load('/scenes/plant-meshopt.svs.glb');
        return example.message;
    });
    const { statistics, baked } = await draw(page);
    assert.equal(baked, true);
    assert(statistics.drawn > 0 && statistics.proxies === 0, JSON.stringify(statistics));
    assert.match(message, /setMeshoptDecoder/);
    assert.match(problems.join(), /proxies cannot be used .*setMeshoptDecoder.*; drawn without them/);
    await page.close();
});

test('a file without a bake loads as ever', async () => {
    const { page, problems } = await open('/samples/plant.glb');
    const { triangles, baked } = await draw(page);
    assert.equal(baked, false);
    assert(triangles > 1_000_000, `${triangles}`);
    assert.deepEqual(problems, []);
    await page.close();
});

test('a broken bake is a warning, and the file is drawn without it', async () => {
    plant();
    const { page, problems } = await open('/samples/plant.glb');
    const { message, figures } = await page.evaluate(async () => {
        const { example } = /** @type {any} */ (window);
        const bytes = await (await fetch('/scenes/plant.svs.glb')).arrayBuffer();
        // One digit of the fingerprint: the lengths stay.
        const text = new TextDecoder('latin1').decode(bytes);
        const at = text.indexOf('"hash"') + '"hash":"'.length;
        new Uint8Array(bytes)[at] = text[at] === '0' ? 49 : 48;
        await example.load(URL.createObjectURL(new Blob([bytes])));
        example.draw();
        return { message: example.message, figures: example.figures() };
    });
    assert.match(message, /another state of the scene/);
    assert.equal(figures.baked, false);
    assert(figures.triangles > 1_000_000);
    assert.equal(problems.length, 1, 'one warning');
    assert.match(problems[0], /EXT_spherical_visibility: .*drawn as without it/);
    await page.close();
});

test('a dropped file that is none is refused in words, another one is shown; the window changes its size', async () => {
    plant();
    const { page } = await open('/scenes/plant.svs.glb');
    const drop = (/** @type {string} */ source) => page.evaluate(async (source) => {
        const bytes = source === '' ? new TextEncoder().encode('glTF, but not quite') : await (await fetch(source)).arrayBuffer();
        const transfer = new DataTransfer();
        transfer.items.add(new File([bytes], 'dropped.glb'));
        dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
    }, source);
    await drop('');
    await page.waitForFunction(() => /cannot be shown/.test(/** @type {any} */ (window).example.message));
    assert((await draw(page)).baked, 'the file before stays');
    await drop('/scenes/plant.svs.glb');
    await page.waitForFunction(() => /** @type {any} */ (window).example.message === '');
    const small = await draw(page);
    await page.setViewportSize({ width: 960, height: 640 });
    await page.waitForFunction(() => /** @type {any} */ (window).example.renderer.domElement.width === 960);
    const large = await draw(page);
    // Twice as many pixels along each side: more of the small objects are worth drawing.
    assert(large.statistics.drawn > small.statistics.drawn, `${large.statistics.drawn} and ${small.statistics.drawn}`);
    await page.close();
});
