// A headless browser with WebGL 2 and WebGPU, on machines without a GPU as well, and a server of files for it.

import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize, sep } from 'node:path';
import { chromium } from 'playwright-core';

/** WebGL 2 and WebGPU in software (SwiftShader); WebGPU shows nothing on a canvas unless Vulkan is named everywhere. */
const SOFTWARE = [
    '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan', '--use-vulkan=swiftshader',
];
const QUIET = ['--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-quic'];

/**
 * Starts Chromium: the one that `SVS_CHROMIUM` names, else the system's.
 * @param {{ args?: string[] }} [options] Further arguments.
 */
export function launch({ args = [] } = {}) {
    const executablePath = process.env.SVS_CHROMIUM ?? '/usr/bin/chromium';
    return chromium.launch({ executablePath, headless: true, args: ['--no-sandbox', ...QUIET, ...SOFTWARE, ...args] });
}

/** @type {Record<string, string>} */
const TYPES = {
    '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css',
    '.json': 'application/json', '.wasm': 'application/wasm', '.glb': 'model/gltf-binary', '.png': 'image/png',
};

/**
 * Serves folders on a free local port.
 * @param {Record<string, string>} folders Folder of each path prefix, for instance `{ '/scenes/': '/data/scenes' }`; the
 *     longest prefix wins.
 * @returns {Promise<{ url: string, close: () => Promise<void> }>}
 */
export async function serve(folders) {
    const prefixes = Object.keys(folders).sort((a, b) => b.length - a.length);
    const server = createServer(async (request, response) => {
        const path = decodeURIComponent(new URL(request.url ?? '/', 'http://localhost').pathname);
        const prefix = prefixes.find((prefix) => path.startsWith(prefix));
        const root = prefix === undefined ? undefined : normalize(folders[prefix] + sep);
        const file = root === undefined ? undefined : normalize(join(root, path.slice(prefix?.length)));
        const found = file?.startsWith(root ?? sep) ? await stat(file).catch(() => undefined) : undefined;
        if (file === undefined || !found?.isFile()) {
            response.writeHead(404).end();
            return;
        }
        response.writeHead(200, {
            'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream', 'Content-Length': found.size,
        });
        createReadStream(file).pipe(response);
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(undefined)));
    const address = server.address();
    if (address === null || typeof address === 'string') throw new Error('no address');
    return {
        url: `http://127.0.0.1:${address.port}`,
        close: () => new Promise((resolve, reject) => {
            server.closeAllConnections();
            server.close((error) => (error ? reject(error) : resolve(undefined)));
        }),
    };
}
