// A scene of five textured squares, made here: quarters of four colours, a disc cut out, glass, light, and a repeated texture.

import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { PNG } from 'pngjs';
import { outputs } from './scenes.mjs';

const [FLOAT, SHORT] = [5126, 5123];
const [NEAREST, CLAMP, MIRROR, REPEAT] = [9728, 33071, 33648, 10497];

/**
 * @param {number} width
 * @param {number} height
 * @param {(u: number, v: number) => number[]} texel Red, green, blue and alpha at 0 to 1 from the left and the top.
 */
function png(width, height, texel) {
    const image = new PNG({ width, height });
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) image.data.set(texel(x / width, y / height), 4 * (y * width + x));
    }
    return PNG.sync.write(image);
}

/** Red, green; blue, white. Its sides are no powers of two. */
const quarters = png(100, 60, (u, v) => {
    const [left, top] = [u < 0.5, v < 0.5];
    return top ? (left ? [255, 0, 0, 255] : [0, 255, 0, 255]) : left ? [0, 0, 255, 255] : [255, 255, 255, 255];
});
/** Yellow, also where it is transparent. */
const disc = png(64, 64, (u, v) => [255, 220, 40, Math.hypot(u - 0.5, v - 0.5) < 0.3 ? 255 : 0]);
const glass = png(8, 8, () => [40, 200, 255, 128]);

/** Centres of the squares, which are 2 wide, at z = 0; a grey wall is behind them. */
export const SQUARES = { quarters: [-2.2, 1.1], disc: [0, 1.1], glass: [2.2, 1.1], light: [-2.2, -1.1], repeated: [0, -1.1] };

/** Writes the file and says where. */
export function textured() {
    /** @type {Buffer[]} */
    const parts = [];
    /** @type {{ buffer: number, byteOffset: number, byteLength: number }[]} */
    const bufferViews = [];
    let length = 0;
    const view = (/** @type {Uint8Array | Float32Array | Uint16Array} */ data) => {
        const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
        const padded = Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3)]);
        bufferViews.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
        length += padded.length;
        return parts.push(padded) - 1;
    };
    const accessor = (/** @type {Float32Array | Uint16Array} */ data, /** @type {string} */ type, /** @type {object} */ more = {}) => {
        const components = { SCALAR: 1, VEC2: 2, VEC3: 3 }[type] ?? 1;
        const componentType = data instanceof Float32Array ? FLOAT : SHORT;
        return { bufferView: view(data), componentType, count: data.length / components, type, ...more };
    };
    const accessors = [
        accessor(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 'VEC3', { min: [-1, -1, 0], max: [1, 1, 0] }),
        accessor(new Float32Array([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]), 'VEC3'),
        accessor(new Float32Array([0, 1, 1, 1, 1, 0, 0, 0]), 'VEC2'),
        accessor(new Float32Array([0, 2, 2, 2, 2, 0, 0, 0]), 'VEC2'),
        accessor(new Uint16Array([0, 1, 2, 0, 2, 3]), 'SCALAR'),
    ];
    const images = [quarters, disc, glass].map((bytes) => ({ bufferView: view(bytes), mimeType: 'image/png' }));
    const rough = { metallicFactor: 0, roughnessFactor: 1 };
    const base = (/** @type {number} */ index) => ({ pbrMetallicRoughness: { baseColorTexture: { index }, ...rough } });
    const plain = (/** @type {number} */ grey) => ({ pbrMetallicRoughness: { baseColorFactor: [grey, grey, grey, 1], ...rough } });
    const materials = [
        base(0), { ...base(1), alphaMode: 'MASK' }, { ...base(2), alphaMode: 'BLEND' },
        { ...plain(0), emissiveTexture: { index: 0 }, emissiveFactor: [1, 1, 1] }, base(3), plain(0.5),
    ];
    const meshes = materials.map((_, material) => ({
        primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: material === 4 ? 3 : 2 }, indices: 4, material }],
    }));
    /** @type {object[]} */
    const nodes = Object.values(SQUARES).map((centre, mesh) => ({ mesh, translation: [...centre, 0] }));
    nodes.push({ mesh: 5, translation: [0, 0, -0.5], scale: [4, 3, 1] });
    const json = {
        asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: nodes.map((_, node) => node) }], nodes, meshes, materials, accessors,
        bufferViews, buffers: [{ byteLength: length }], images,
        textures: [{ source: 0, sampler: 0 }, { source: 1 }, { source: 2 }, { source: 0, sampler: 1 }],
        samplers: [
            { magFilter: NEAREST, minFilter: NEAREST, wrapS: CLAMP, wrapT: CLAMP },
            { magFilter: NEAREST, minFilter: NEAREST, wrapS: MIRROR, wrapT: REPEAT },
        ],
    };
    const text = Buffer.from(JSON.stringify(json));
    const chunks = [Buffer.concat([text, Buffer.alloc(-text.length & 3, 0x20)]), Buffer.concat(parts)];
    const word = (/** @type {number[]} */ ...words) => Buffer.from(Uint32Array.from(words).buffer);
    const total = 28 + chunks[0].length + chunks[1].length;
    mkdirSync(outputs, { recursive: true });
    const file = join(outputs, 'textured.glb');
    writeFileSync(file, Buffer.concat([
        word(0x46546c67, 2, total), word(chunks[0].length, 0x4e4f534a), chunks[0], word(chunks[1].length, 0x004e4942), chunks[1],
    ]));
    return file;
}
