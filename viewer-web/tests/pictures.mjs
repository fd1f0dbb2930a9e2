// Compares pictures.

import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { PNG } from 'pngjs';
import { ssim } from 'ssim.js';
import { outputs } from './scenes.mjs';

/**
 * A screenshot, kept for people to look at.
 * @param {import('playwright-core').Page} page
 * @param {string} name
 */
export async function picture(page, name) {
    const bytes = await page.screenshot();
    mkdirSync(outputs, { recursive: true });
    writeFileSync(join(outputs, `${name}.png`), bytes);
    return PNG.sync.read(bytes);
}

/**
 * How alike two pictures are: the mean structural similarity, 1 for equal ones, and the share of pixels that differ by more than 16
 * of 255 in a channel.
 * @param {PNG} a
 * @param {PNG} b
 */
export function compare(a, b) {
    const image = (/** @type {PNG} */ png) => ({ data: new Uint8ClampedArray(png.data), width: png.width, height: png.height });
    let differing = 0;
    for (let at = 0; at < a.data.length; at += 4) {
        const far = [0, 1, 2].some((channel) => Math.abs(a.data[at + channel] - b.data[at + channel]) > 16);
        differing += Number(far);
    }
    return { ssim: ssim(image(a), image(b)).mssim, differing: differing / (a.data.length / 4) };
}
