// The viewer's page for measurements: `svs serve` and a browser.

import { spawn } from 'node:child_process';
import { join } from 'node:path';
import { launch } from '../tests/browser.mjs';
import { root, target } from '../tests/scenes.mjs';

/**
 * Opens the page on WebGL 2, without a file.
 * @param {string} file What `svs serve` is given.
 */
export async function openPage(file) {
    const site = join(root, 'viewer-web/dist');
    const server = spawn(join(target, 'release/svs'), ['serve', file, '--site', site], { stdio: ['ignore', 'pipe', 'inherit'] });
    /** @type {string} */
    const address = await new Promise((resolve, reject) => {
        server.once('exit', (code) => reject(new Error(`svs serve ended with ${code}`)));
        server.stdout.once('data', (text) => resolve(String(text).split('\n')[0]));
    });
    const browser = await launch();
    const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
    const url = new URL(address);
    const source = url.searchParams.get('src') ?? '';
    url.search = '?backend=webgl';
    await page.goto(url.href);
    await page.waitForFunction(() => /** @type {any} */ (window).svs?.state === 'ready', undefined, { timeout: 120_000 });
    const close = async () => {
        await browser.close();
        server.kill();
    };
    return { page, source, close };
}

/** Waits until the file is there. @param {import('playwright-core').Page} page */
export function shown(page) {
    return page.waitForFunction(() => {
        const { state, error } = /** @type {any} */ (window).svs;
        if (state === 'failed') throw new Error(error);
        return state === 'shown';
    }, undefined, { timeout: 300_000 });
}

/** The middle value. @param {number[]} values */
export function median(values) {
    const sorted = [...values].sort((a, b) => a - b);
    const at = sorted.length / 2;
    return sorted.length % 2 ? sorted[Math.floor(at)] : (sorted[at - 1] + sorted[at]) / 2;
}
