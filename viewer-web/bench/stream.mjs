// Time until the picture looks complete, at 20 Mbit/s: streaming against loading the whole file.
// usage: node stream.mjs FILE...

import { mkdirSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { PNG } from 'pngjs';
import { outputs } from '../tests/scenes.mjs';
import { compare } from '../tests/pictures.mjs';
import { openPage, shown } from './page.mjs';

/** 20 Mbit/s, as bytes per second, and a way of 20 ms. */
const NETWORK = { offline: false, latency: 20, downloadThroughput: 20e6 / 8, uploadThroughput: 20e6 / 8 };
/** Complete-looking. */
const ALIKE = 0.95;

/** @param {string} file @param {boolean} stream */
async function measure(file, stream) {
    const { page, source, close } = await openPage(file);
    const network = await page.context().newCDPSession(page);
    await network.send('Network.enable');
    await network.send('Network.emulateNetworkConditions', NETWORK);
    // The page itself is there already: what counts is the file, from the first request on.
    const pictures = await page.evaluate(async ([source, stream]) => {
        const { svs } = /** @type {any} */ (window);
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('canvas'));
        /** @type {{ at: number, bitmap: Promise<ImageBitmap> }[]} */
        const frames = [];
        const draw = svs.viewer.frame.bind(svs.viewer);
        const begin = performance.now();
        svs.viewer.frame = (/** @type {number} */ time) => {
            const drawn = draw(time);
            // In the same task: afterwards the canvas is the browser's.
            if (drawn) frames.push({ at: performance.now() - begin, bitmap: createImageBitmap(canvas) });
            return drawn;
        };
        svs.stream = stream;
        await svs.openUrl(source);
        await svs.settled();
        const loaded = svs.times.loaded - begin;
        const pictures = [];
        for (const { at, bitmap } of frames) {
            const image = await bitmap;
            const copy = new OffscreenCanvas(image.width, image.height);
            copy.getContext('2d')?.drawImage(image, 0, 0);
            const bytes = new Uint8Array(await (await copy.convertToBlob()).arrayBuffer());
            let text = '';
            for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
            pictures.push({ at, png: btoa(text) });
        }
        return { pictures, loaded };
    }, /** @type {const} */ ([source, stream]));
    await shown(page);
    await close();
    const frames = pictures.pictures.map(({ at, png }) => ({ at, png: PNG.sync.read(Buffer.from(png, 'base64')) }));
    const last = frames[frames.length - 1].png;
    const steps = frames.map(({ at, png }) => ({ at, ssim: compare(png, last).ssim }));
    const first = steps.find(({ ssim }) => ssim >= ALIKE) ?? steps[steps.length - 1];
    mkdirSync(outputs, { recursive: true });
    const picture = frames[steps.indexOf(first)].png;
    writeFileSync(join(outputs, `${basename(file, '.glb')}-${stream ? 'stream' : 'whole'}.png`), PNG.sync.write(picture));
    return { completeMs: first.at, ssim: first.ssim, loadedMs: pictures.loaded, steps };
}

for (const file of process.argv.slice(2)) {
    const [streamed, whole] = [await measure(file, true), await measure(file, false)];
    console.log(JSON.stringify({ scene: basename(file), streamed, whole }));
}
