// Baked scenes for the tests, kept in the folder of build outputs.

import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

/** The repository's root. */
export const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');

/** Build outputs. */
export const target = process.env.CARGO_TARGET_DIR ?? join(root, 'target');

/** Where the tests leave files. */
export const outputs = join(target, 'web');

/** Large scenes that are not in the repository: `SVS_SCENES`, else beside it. */
export const sharedScenes = process.env.SVS_SCENES ?? resolve(root, '../shared/scenes');

/**
 * Runs a program that must succeed, and returns what it prints.
 * @param {string} program
 * @param {string[]} words
 */
export function run(program, words) {
    const { status, stdout, stderr, error } = spawnSync(program, words, { cwd: root, encoding: 'utf8', maxBuffer: 1 << 30 });
    if (status !== 0) throw new Error(`${program} ${words.join(' ')} failed: ${error ?? ''}\n${stderr}`);
    return stdout;
}

/**
 * Runs `svs`.
 * @param {string[]} words
 */
export function svs(words) {
    return run('cargo', ['run', '--quiet', '--release', '--package', 'svs', '--bin', 'svs', '--', ...words]);
}

/**
 * Bakes a file, unless that was done since it changed.
 * @param {string} input
 * @param {string} name File name of the result.
 * @param {string[]} [options] Further arguments.
 * @returns {string} The baked file.
 */
export function baked(input, name, options = []) {
    mkdirSync(outputs, { recursive: true });
    const output = join(outputs, name);
    if (!existsSync(output) || statSync(output).mtimeMs < statSync(input).mtimeMs) {
        svs(['build', input, '-o', output, '--quality', 'draft', ...options]);
    }
    return output;
}

/** The sample in the repository. */
export function plant() {
    return baked(join(root, 'samples/plant.glb'), 'plant.svs.glb');
}

/** The sample with compressed proxies. */
export function plantWithCompressedProxies() {
    const options = ['--proxies', 'auto', '--proxy-format', 'meshopt'];
    return baked(join(root, 'samples/plant.glb'), 'plant-meshopt.svs.glb', options);
}

/** The sample with proxies. */
export function plantWithProxies() {
    return baked(join(root, 'samples/plant.glb'), 'plant-proxies.svs.glb', ['--proxies', 'auto']);
}

/**
 * One of the large scenes; `null` where they are not, which is said aloud.
 * @param {string} name
 */
export function shared(name) {
    const folder = join(sharedScenes, name);
    const file = existsSync(folder) ? readdirSync(folder).find((file) => /\.(glb|gltf)$/.test(file)) : undefined;
    if (file === undefined) {
        console.error(`NOT TESTED: ${folder} is missing; SVS_SCENES names the folder of the public scenes`);
        return null;
    }
    return baked(join(folder, file), `${name}.svs.glb`);
}

/**
 * The JSON and the binary chunk of a GLB.
 * @param {string} file
 * @returns {{ json: Record<string, any>, bytesOf: (bufferView: number) => Uint8Array }}
 */
export function readGlb(file) {
    const bytes = readFileSync(file);
    const length = bytes.readUInt32LE(12);
    const json = JSON.parse(bytes.toString('utf8', 20, 20 + length));
    const binary = bytes.subarray(20 + length + 8);
    const bytesOf = (/** @type {number} */ index) => {
        const { byteOffset = 0, byteLength } = json.bufferViews[index];
        return binary.subarray(byteOffset, byteOffset + byteLength);
    };
    return { json, bytesOf };
}
