// Cameras around and in a scene, the same on every machine.

import { Box3, Matrix4, PerspectiveCamera, Vector3 } from 'three';

/** @typedef {{ view_projection: number[], eye: number[], pixels_per_radian: number }} View */

const HEIGHT = 720;

/** @param {number} seed Mulberry32. */
export function random(seed) {
    let state = seed;
    return () => {
        state = (state + 0x6d2b79f5) | 0;
        let t = Math.imul(state ^ (state >>> 15), 1 | state);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}

/**
 * The box of a document's scene, as its accessors state it.
 * @param {Record<string, any>} json
 * @param {number} [scene]
 */
export function boxOf(json, scene = json.scene ?? 0) {
    const box = new Box3();
    const visit = (/** @type {number} */ index, /** @type {Matrix4} */ above) => {
        const node = json.nodes[index];
        const own = new Matrix4();
        if (node.matrix) own.fromArray(node.matrix);
        else {
            const [t, r, s] = [node.translation ?? [0, 0, 0], node.rotation ?? [0, 0, 0, 1], node.scale ?? [1, 1, 1]];
            own.compose(new Vector3(...t), /** @type {any} */ ({ _x: r[0], _y: r[1], _z: r[2], _w: r[3] }), new Vector3(...s));
        }
        const matrix = above.clone().multiply(own);
        for (const { attributes } of json.meshes[node.mesh]?.primitives ?? []) {
            const { min, max } = json.accessors[attributes.POSITION];
            box.union(new Box3(new Vector3(...min), new Vector3(...max)).applyMatrix4(matrix));
        }
        for (const child of node.children ?? []) visit(child, matrix);
    };
    for (const node of json.scenes[scene].nodes) visit(node, new Matrix4());
    return box;
}

/**
 * @param {PerspectiveCamera} camera
 * @returns {View}
 */
export function viewOf(camera) {
    camera.updateMatrixWorld();
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    return {
        view_projection: matrix.elements.slice(),
        eye: camera.position.toArray(),
        pixels_per_radian: (HEIGHT / 2) * camera.projectionMatrix.elements[5],
    };
}

/**
 * Half of them outside, half inside.
 * @param {Box3} box
 * @param {number} count
 * @returns {View[]}
 */
export function views(box, count) {
    const next = random(7);
    const [center, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
    const radius = size.length() / 2;
    return Array.from({ length: count }, (_, at) => {
        const camera = new PerspectiveCamera(60, 16 / 9, radius / 1000, radius * 10);
        const direction = new Vector3(next() - 0.5, (next() - 0.3) * 0.7, next() - 0.5).normalize();
        const inside = new Vector3(next() - 0.5, next() - 0.5, next() - 0.5).multiply(size).multiplyScalar(0.8).add(center);
        camera.position.copy(at % 2 === 0 ? direction.multiplyScalar(radius * (1.2 + 2 * next())).add(center) : inside);
        camera.lookAt(new Vector3(next() - 0.5, next() - 0.5, next() - 0.5).multiply(size).multiplyScalar(0.5).add(center));
        return viewOf(camera);
    });
}
