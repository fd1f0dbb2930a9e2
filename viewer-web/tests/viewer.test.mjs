// The web viewer as `svs serve` shows it, on WebGL 2 and on WebGPU: its controls, its figures and its pictures.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from './browser.mjs';
import { compare, picture } from './pictures.mjs';
import { baked, plant, plantWithCompressedProxies, plantWithProxies, root, run, shared, target } from './scenes.mjs';
import { SQUARES, textured } from './textured.mjs';

// What the visibility of a draft bake leaves out of a picture, at a quality that drops nothing for its size.
const LEAST_SSIM = 0.99;
const MOST_DIFFERING = 0.005;
// The two interfaces round colours and edges otherwise.
const LEAST_SSIM_OF_BACKENDS = 0.99;
const MOST_DIFFERING_OF_BACKENDS = 0.01;

const BACKENDS = /** @type {const} */ (['webgl', 'webgpu']);

/** @type {import('playwright-core').Browser} */
let browser;
/** @type {Set<import('node:child_process').ChildProcess>} */
const servers = new Set();

before(async () => {
    run('cargo', ['build', '--quiet', '--release', '--package', 'svs', '--bin', 'svs']);
    browser = await launch();
});

after(async () => {
    await browser?.close();
    for (const server of servers) server.kill();
});

/**
 * `svs serve` with a file; its address.
 * @param {string} file
 * @returns {Promise<string>}
 */
function serve(file) {
    const site = join(root, 'viewer-web/dist');
    const server = spawn(join(target, 'release/svs'), ['serve', file, '--site', site], { stdio: ['ignore', 'pipe', 'inherit'] });
    servers.add(server);
    return new Promise((resolve, reject) => {
        server.once('error', reject);
        server.once('exit', (code) => reject(new Error(`svs serve ended with ${code}`)));
        server.stdout.once('data', (text) => resolve(String(text).split('\n')[0]));
    });
}

/**
 * The page, opened; errors of the page are collected.
 * @param {string} address @param {string} backend @param {{ width: number, height: number }} [viewport]
 */
async function open(address, backend, viewport = { width: 800, height: 480 }) {
    const page = await browser.newPage({ viewport });
    /** @type {string[]} */
    const problems = [];
    page.on('pageerror', (error) => problems.push(String(error.stack)));
    page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
    const url = new URL(address);
    url.searchParams.set('backend', backend);
    await page.goto(url.href);
    await page.waitForFunction(() => ['shown', 'failed'].includes(/** @type {any} */ (window).svs?.state), undefined, { timeout: 120_000 });
    return { page, problems };
}

/** Figures of a frame that shows everything set so far. @param {import('playwright-core').Page} page */
function settled(page) {
    return page.evaluate(async () => {
        const { svs } = /** @type {any} */ (window);
        await svs.settled();
        await new Promise(requestAnimationFrame);
        return svs.figures;
    });
}

/** Sets a slider as a hand would. @param {import('playwright-core').Page} page @param {string} name @param {string} value */
async function slide(page, name, value) {
    await page.getByRole('slider', { name, exact: true }).fill(value);
}

/** @param {import('playwright-core').Page} page @param {string} name */
async function choose(page, name) {
    // The radio button itself is not seen: its label is what is clicked.
    await page.locator('.choice span', { hasText: new RegExp(`^${name}$`) }).first().click();
}

/** The canvas alone, without what lies on it. @param {import('playwright-core').Page} page @param {string} name */
async function canvas(page, name) {
    await settled(page);
    return picture(page, name);
}

for (const backend of BACKENDS) {
    test(`the controls do what they say (${backend})`, async () => {
        const { page, problems } = await open(await serve(plant()), backend);
        const first = await settled(page);
        assert.equal(await page.evaluate(() => /** @type {any} */ (window).svs.backend), backend);
        assert(first.baked && first.objects > 4000 && first.draws > 0 && first.notice === null);
        assert(first.triangles > 0 && first.triangles < first.sceneTriangles);
        assert(first.cullUs > 0);

        await choose(page, 'Frustum');
        const frustum = await settled(page);
        assert(frustum.drawnObjects > first.drawnObjects && frustum.triangles > first.triangles);
        await choose(page, 'Nothing');
        const nothing = await settled(page);
        assert.equal(nothing.drawnObjects, nothing.objects);

        await choose(page, 'Visibility');
        await slide(page, 'Quality', '0');
        const low = await settled(page);
        await slide(page, 'Quality', '1');
        const high = await settled(page);
        assert(low.triangles < high.triangles, `${low.triangles} < ${high.triangles}`);

        await page.locator('#budget-kind span', { hasText: 'Triangles' }).click();
        await slide(page, 'Triangles', '4');
        const tight = await settled(page);
        assert(tight.triangles <= 10_000 && tight.triangles > 0);
        await page.locator('#budget-kind span', { hasText: 'None' }).click();

        // Keys and mouse move the camera.
        const still = await settled(page);
        await page.locator('#canvas').focus();
        await page.keyboard.down('KeyW');
        await page.waitForTimeout(300);
        await page.keyboard.up('KeyW');
        const moved = await settled(page);
        assert.notDeepEqual(moved.camera.eye, still.camera.eye);
        await page.mouse.move(200, 200);
        await page.mouse.down();
        await page.mouse.move(320, 240, { steps: 4 });
        await page.mouse.up();
        assert.notDeepEqual((await settled(page)).camera.forward, moved.camera.forward);
        await page.keyboard.press('Home');

        // While culling is frozen the camera moves and what is drawn stays.
        const before = await settled(page);
        await page.getByLabel('Freeze culling').check();
        await page.mouse.move(200, 200);
        await page.mouse.down();
        await page.mouse.move(400, 200, { steps: 4 });
        await page.mouse.up();
        const frozen = await settled(page);
        assert.notDeepEqual(frozen.camera.forward, before.camera.forward);
        assert.equal(frozen.drawnObjects, before.drawnObjects);
        await page.getByLabel('Freeze culling').uncheck();

        // Another size of the window.
        await page.setViewportSize({ width: 760, height: 400 });
        await page.waitForFunction(() => document.querySelector('canvas')?.width === 460);
        const resized = await settled(page);
        assert.deepEqual([resized.width, resized.height], [460, 400]);
        assert.deepEqual(problems, []);
        await page.close();
    });

    test(`an object is selected by a click, hidden and shown again (${backend})`, async () => {
        const { page, problems } = await open(await serve(plant()), backend);
        const before = await settled(page);
        const full = await canvas(page, `viewer-${backend}-all`);
        await page.mouse.click(250, 250);
        await page.waitForFunction(() => !(/** @type {HTMLButtonElement} */ (document.querySelector('#hide')).disabled));
        const text = await page.locator('#object').textContent();
        assert.match(text ?? '', /triangles/);
        await page.getByRole('button', { name: 'Hide', exact: true }).click();
        const without = await settled(page);
        assert.equal(without.hidden, 1);
        // What it hid is seen now: spheres above it are trusted no more.
        assert(without.drawnObjects > before.drawnObjects, `${without.drawnObjects} > ${before.drawnObjects}`);
        assert(compare(full, await canvas(page, `viewer-${backend}-without`)).differing > 0.001);
        await page.getByRole('button', { name: 'Show hidden' }).click();
        const again = await settled(page);
        assert.deepEqual([again.hidden, again.drawnObjects, again.triangles], [0, before.drawnObjects, before.triangles]);
        assert.deepEqual(problems, []);
        await page.close();
    });

    test(`a broken file is refused and the open one stays; a good one is opened (${backend})`, async () => {
        const { page } = await open(await serve(plant()), backend);
        const before = await settled(page);
        const drop = (/** @type {number[]} */ bytes, /** @type {string} */ name) => page.evaluate(([bytes, name]) => {
            const data = new DataTransfer();
            data.items.add(new File([new Uint8Array(/** @type {any} */ (bytes))], /** @type {string} */ (name)));
            window.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
        }, /** @type {const} */ ([bytes, name]));
        for (const bytes of [[103, 108, 84, 70, 2, 0, 0, 0, 255, 0, 0, 0], [1, 2, 3], []]) {
            await drop(bytes, 'broken.glb');
            await page.getByRole('alert').waitFor({ state: 'visible' });
            assert.match((await page.locator('#message-text').textContent()) ?? '', /broken\.glb cannot be shown: .{10}/);
            assert.equal((await settled(page)).objects, before.objects);
            await page.getByRole('button', { name: 'Close the message' }).click();
        }
        const json = JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [] }] });
        await drop([...new TextEncoder().encode(json)], 'empty.gltf');
        await page.waitForFunction(() => document.querySelector('#file')?.textContent === 'empty.gltf');
        assert.equal((await settled(page)).objects, 0);
        await page.close();
    });

    test(`proxies are drawn where the file has them (${backend})`, async () => {
        const { page, problems } = await open(await serve(plantWithProxies()), backend);
        await slide(page, 'Error', '32');
        const coarse = await settled(page);
        assert(coarse.hasProxies && coarse.proxies + coarse.simplified > 0);
        await page.getByLabel('Draw groups simplified').uncheck();
        const fine = await settled(page);
        assert.equal(fine.proxies + fine.simplified, 0);
        assert(coarse.triangles < fine.triangles);
        assert.deepEqual(problems, []);
        await page.close();
    });
}

/** Pictures of a file with the frustum and with visibility, at a high quality. @param {string} file @param {string} backend @param {string} name */
async function pictures(file, backend, name) {
    const { page, problems } = await open(await serve(file), backend);
    await slide(page, 'Quality', '0.75');
    await settled(page);
    // The figures differ by intent.
    await page.addStyleTag({ content: 'body { display: block } #panel { display: none }' });
    await page.waitForFunction(() => document.querySelector('canvas')?.width === innerWidth);
    const seen = await canvas(page, `viewer-${name}-${backend}-visibility`);
    const few = (await settled(page)).drawnObjects;
    await page.evaluate(() => /** @type {any} */ (window).svs.viewer.set_method('frustum'));
    const all = await canvas(page, `viewer-${name}-${backend}-frustum`);
    const many = (await settled(page)).drawnObjects;
    assert(few < many, `${few} < ${many}`);
    assert.deepEqual(problems, []);
    await page.close();
    return { seen, all };
}

for (const backend of BACKENDS) {
    test(`textures lie the right way round, repeat, are cut out and let light through (${backend})`, async () => {
        const { page, problems } = await open(await serve(textured()), backend);
        const [distance, fov] = [7, 1];
        await page.evaluate(([distance, fov]) => {
            const { svs } = /** @type {any} */ (window);
            svs.viewer.set_camera(0, 0, distance, 0, 0, -1, fov, 0);
        }, [distance, fov]);
        const { width, height } = await settled(page);
        const { data, width: row } = await picture(page, `textured-${backend}`);
        const perUnit = height / 2 / Math.tan(fov / 2) / distance;
        const at = (/** @type {number} */ x, /** @type {number} */ y) => {
            const [column, line] = [Math.round(width / 2 + perUnit * x), Math.round(height / 2 - perUnit * y)];
            return [...data.subarray(4 * (line * row + column), 4 * (line * row + column) + 3)];
        };
        /** @type {(color: number[]) => string} */
        const name = ([r, g, b]) => {
            const [low, high] = [Math.min(r, g, b), Math.max(r, g, b)];
            if (high - low < 30) return 'grey';
            const has = (/** @type {number} */ value) => value > (low + high) / 2;
            return [has(r) ? 'red' : '', has(g) ? 'green' : '', has(b) ? 'blue' : ''].join('');
        };
        const names = (/** @type {number[]} */ [x, y], /** @type {number[][]} */ places) => places.map(([dx, dy]) => name(at(x + dx, y + dy)));
        const corners = [[-0.5, 0.5], [0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]];
        assert.deepEqual(names(SQUARES.quarters, corners), ['red', 'green', 'blue', 'grey']);
        assert.deepEqual(names(SQUARES.light, corners), ['red', 'green', 'blue', 'grey']);
        const [lit, own] = [SQUARES.quarters, SQUARES.light].map(([x, y]) => at(x + 0.5, y - 0.5));
        assert(own[0] > 250 && lit[0] < 240, `light is not shaded: ${own}, ${lit}`);
        // Mirrored to the right, repeated downwards.
        const line = [[-0.75, 0.75], [-0.25, 0.75], [0.25, 0.75], [0.75, 0.75]];
        assert.deepEqual(names(SQUARES.repeated, line), ['red', 'green', 'green', 'red']);
        assert.deepEqual(names(SQUARES.repeated, line.map(([x, y]) => [x, y - 1])), ['red', 'green', 'green', 'red']);
        assert.deepEqual(names(SQUARES.repeated, line.map(([x, y]) => [x, y - 0.5])), ['blue', 'grey', 'grey', 'blue']);
        // Cut out, without a dark seam: nothing across the disc is darker than the wall or the disc.
        assert.deepEqual(names(SQUARES.disc, [[0, 0], ...corners.map(([x, y]) => [1.6 * x, 1.6 * y])]), ['redgreen', 'grey', 'grey', 'grey', 'grey']);
        const [wall, inside] = [at(SQUARES.disc[0] - 0.9, SQUARES.disc[1]), at(SQUARES.disc[0], SQUARES.disc[1])];
        let darkest = 255;
        for (let x = -0.9; x <= 0.9; x += 1 / perUnit) {
            for (let y = -0.9; y <= 0.9; y += 1 / perUnit) darkest = Math.min(darkest, at(SQUARES.disc[0] + x, SQUARES.disc[1] + y)[1]);
        }
        console.log(`across the disc at least ${darkest} green, wall ${wall[1]}, disc ${inside[1]}`);
        assert(darkest >= Math.min(wall[1], inside[1]) - 6, 'a dark seam');
        assert.deepEqual(names(SQUARES.glass, [[0, 0]]), ['greenblue'], 'glass');
        assert(at(SQUARES.glass[0], SQUARES.glass[1])[0] > 60, 'the wall is seen through the glass');
        assert.deepEqual(problems, []);
        await page.close();
    });
}

test('visibility changes no picture, and both interfaces draw the same', async () => {
    const scenes = [{ file: plant(), name: 'plant' }];
    const duplex = shared('duplex-apartment');
    if (duplex !== null) scenes.push({ file: duplex, name: 'duplex' });
    for (const { file, name } of scenes) {
        const [webgl, webgpu] = [await pictures(file, 'webgl', name), await pictures(file, 'webgpu', name)];
        for (const { seen, all } of [webgl, webgpu]) {
            const { ssim, differing } = compare(seen, all);
            assert(ssim >= LEAST_SSIM && differing <= MOST_DIFFERING, `${name}: ssim ${ssim}, ${differing} of the pixels differ`);
        }
        const { ssim, differing } = compare(webgl.all, webgpu.all);
        assert(
            ssim >= LEAST_SSIM_OF_BACKENDS && differing <= MOST_DIFFERING_OF_BACKENDS,
            `${name}, WebGL 2 against WebGPU: ssim ${ssim}, ${differing} of the pixels differ`,
        );
    }
});

test('a file arranged for streaming comes in parts and ends as the whole one', async () => {
    const file = baked(join(root, 'samples/plant.glb'), 'plant.stream.svs.glb', ['--layout', 'stream']);
    const address = await serve(file);
    const { page, problems } = await open(address, 'webgl');
    const requests = await page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('.glb')).length);
    assert(requests > 2, `${requests} requests`);
    await page.addStyleTag({ content: 'body { display: block } #panel { display: none }' });
    const streamed = await canvas(page, 'viewer-streamed');
    const whole = await open(`${address}&stream=off`, 'webgl');
    await whole.page.addStyleTag({ content: 'body { display: block } #panel { display: none }' });
    assert.deepEqual(compare(streamed, await canvas(whole.page, 'viewer-whole')).differing, 0);
    assert.deepEqual([...problems, ...whole.problems], []);
    await page.close();
    await whole.page.close();
});

test('compressed proxies are left out, and the page says so', async () => {
    const { page, problems } = await open(await serve(plantWithCompressedProxies()), 'webgl');
    const figures = await settled(page);
    assert(figures.baked && figures.draws > 0 && !figures.hasProxies, JSON.stringify(figures));
    assert.match(figures.notice, /the proxies cannot be used .*EXT_meshopt_compression.*; shown without them/);
    assert.deepEqual(problems, []);
    await page.close();
});

test('on a phone the controls fold, and every one has a name', async () => {
    const { page, problems } = await open(await serve(plant()), 'webgl', { width: 390, height: 844 });
    await settled(page);
    const fold = page.getByRole('button', { name: 'Controls' });
    assert.equal(await fold.getAttribute('aria-expanded'), 'false');
    assert.equal(await page.getByRole('slider', { name: 'Quality' }).isVisible(), false);
    await picture(page, 'viewer-phone');
    await fold.click();
    assert.equal(await fold.getAttribute('aria-expanded'), 'true');
    await page.getByRole('slider', { name: 'Quality' }).waitFor({ state: 'visible' });
    await picture(page, 'viewer-phone-open');
    const nameless = await page.evaluate(() => {
        const controls = [...document.querySelectorAll('button, input, summary, canvas')];
        const named = (/** @type {any} */ control) => (control.labels?.[0] ?? control).textContent?.trim() || control.getAttribute('aria-label');
        return controls.filter((control) => !named(control)).map((control) => control.outerHTML);
    });
    assert.deepEqual(nameless, []);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing sticks out');
    assert.deepEqual(problems, []);
    await page.close();
});

test('a browser without WebGL 2 gets a reason', async () => {
    const page = await browser.newPage();
    await page.addInitScript(() => {
        Object.defineProperty(navigator, 'gpu', { value: undefined });
        HTMLCanvasElement.prototype.getContext = () => null;
    });
    await page.goto(await serve(plant()));
    await page.getByRole('alert').waitFor({ state: 'visible' });
    assert.match((await page.locator('#message-text').textContent()) ?? '', /neither WebGPU nor WebGL2/);
    await page.close();
});

test('an address without a file gets a reason', async () => {
    const address = new URL(await serve(plant()));
    address.searchParams.set('src', 'scene/none.glb');
    const page = await browser.newPage();
    await page.goto(address.href);
    await page.getByRole('alert').waitFor({ state: 'visible' });
    assert.match((await page.locator('#message-text').textContent()) ?? '', /404/);
    await page.close();
});
