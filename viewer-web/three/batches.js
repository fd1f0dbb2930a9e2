// Objects of one material in one `BatchedMesh`: one call to the GPU for all of them, and no scene graph to walk.

import { BatchedMesh, Group, Matrix4 } from 'three';
import { BatchLayers } from './layers.js';

/**
 * @typedef {import('three').Mesh} Mesh
 * @typedef {import('three').BufferGeometry} BufferGeometry
 * @typedef {import('three').Material} Material
 */

/**
 * One part of something drawn: a primitive at a place.
 * @typedef {object} Part
 * @property {number} id What it belongs to.
 * @property {Mesh} mesh The loaded primitive.
 * @property {import('three').Object3D} node In whose space it is.
 * @property {Matrix4 | null} offset From its space to that of the node, if not the same.
 */

/**
 * A part where it is.
 * @typedef {Part & { matrix: Matrix4 }} PlacedPart
 */

/** Turns inside out. A batch has one winding, so mirrored objects get batches of their own, mirrored once more. */
const MIRROR = new Matrix4().makeScale(-1, 1, 1);

/**
 * A batch can draw it and nobody sees a difference: opaque triangles that do not deform. What is transparent stays as it is, for
 * three.js sorts it by depth.
 * @param {Mesh} mesh
 */
export function isBatchable(mesh) {
    const { geometry, material } = mesh;
    if (Array.isArray(material) || material.transparent || material.alphaHash) return false;
    const transmission = /** @type {{ transmission?: number }} */ (material).transmission ?? 0;
    const isOwn = /** @type {{ isShaderMaterial?: boolean }} */ (material).isShaderMaterial === true;
    const deforms = Object.keys(geometry.morphAttributes).length > 0 || 'isSkinnedMesh' in mesh;
    const isWhole = geometry.drawRange.start === 0 && geometry.drawRange.count === Infinity;
    return mesh.isMesh === true && transmission === 0 && !isOwn && !deforms && isWhole;
}

/**
 * Geometries with the same text fit one batch.
 * @param {BufferGeometry} geometry
 */
function layoutOf(geometry) {
    const attributes = Object.entries(geometry.attributes).map(([name, attribute]) =>
        [name, attribute.itemSize, attribute.normalized, attribute.array.constructor.name].join(':'));
    return [geometry.index !== null, ...attributes.sort()].join('|');
}

/**
 * From a part's space to the root's.
 * @param {Part} part
 * @param {Matrix4} fromWorld
 * @param {Matrix4} out
 */
function matrixOf({ node, offset }, fromWorld, out) {
    out.multiplyMatrices(fromWorld, node.matrixWorld);
    return offset === null ? out : out.multiply(offset);
}

/** All batches of a file. */
export class Batches {
    /** Parent of the batches, in the space of the root. */
    group = new Group();
    /** Batches, and how many of each one's instances are shown. @type {{ mesh: BatchedMesh, sample: Mesh, shown: number }[]} */
    list = [];
    /** @type {PlacedPart[]} */
    #parts;
    /** Where the instances of an id begin in `places`, and one more. */
    #starts = new Uint32Array(0);
    /** Pairs of batch and instance, by id. */
    #places = new Uint32Array(0);

    /**
     * @param {import('./layers.js').Route} route
     * @param {Part[]} loose By ascending id.
     * @param {number} ids How many ids there are.
     * @param {Matrix4} fromWorld From world space to the root's.
     */
    constructor(route, loose, ids, fromWorld) {
        this.group.name = 'EXT_spherical_visibility';
        const parts = loose.map((part) => ({ ...part, matrix: matrixOf(part, fromWorld, new Matrix4()) }));
        this.#parts = parts;
        /** @type {Map<string, PlacedPart[]>} */
        const sorted = new Map();
        const layouts = new Map();
        const keys = parts.map((part) => {
            const { geometry, material } = part.mesh;
            if (!layouts.has(geometry)) layouts.set(geometry, layoutOf(geometry));
            const mirrored = part.matrix.determinant() < 0;
            const key = `${/** @type {Material} */ (material).uuid} ${mirrored} ${layouts.get(geometry)}`;
            const same = sorted.get(key);
            if (same === undefined) sorted.set(key, [part]);
            else same.push(part);
            return key;
        });
        const batches = new Map();
        for (const [key, own] of sorted) {
            batches.set(key, this.list.length);
            this.list.push(this.#build(route, own));
        }
        // Within each batch, instances were added in the order of the parts.
        this.#starts = new Uint32Array(ids + 1);
        this.#places = new Uint32Array(2 * parts.length);
        const next = new Uint32Array(this.list.length);
        parts.forEach((part, at) => {
            const batch = batches.get(keys[at]);
            this.#places.set([batch, next[batch]++], 2 * at);
            this.#starts[part.id + 1] = at + 1;
        });
        for (let id = 0; id < ids; id++) this.#starts[id + 1] = Math.max(this.#starts[id + 1], this.#starts[id]);
    }

    /**
     * @param {import('./layers.js').Route} route
     * @param {PlacedPart[]} parts
     */
    #build(route, parts) {
        const geometries = new Set(parts.map((part) => part.mesh.geometry));
        let [vertices, indices] = [0, 0];
        for (const geometry of geometries) {
            vertices += geometry.attributes.position.count;
            indices += geometry.index?.count ?? 0;
        }
        const sample = parts[0].mesh;
        const mesh = new BatchedMesh(parts.length, vertices, indices, /** @type {Material} */ (sample.material));
        const isMirrored = parts[0].matrix.determinant() < 0;
        if (isMirrored) mesh.applyMatrix4(MIRROR);
        const known = new Map([...geometries].map((geometry) => [geometry, mesh.addGeometry(geometry)]));
        const matrix = new Matrix4();
        for (const part of parts) {
            const instance = mesh.addInstance(known.get(part.mesh.geometry) ?? 0);
            mesh.setMatrixAt(instance, isMirrored ? matrix.multiplyMatrices(MIRROR, part.matrix) : part.matrix);
            mesh.setVisibleAt(instance, false);
        }
        // The runtime has decided already.
        mesh.perObjectFrustumCulled = false;
        // From front to back, as three.js draws objects: what is behind is not shaded.
        mesh.sortObjects = true;
        mesh.frustumCulled = false;
        mesh.visible = false;
        mesh.layers = new BatchLayers(route);
        this.group.add(mesh);
        return { mesh, sample, shown: 0 };
    }

    /**
     * @param {number} id
     * @param {boolean} visible
     */
    show(id, visible) {
        for (let at = this.#starts[id]; at < this.#starts[id + 1]; at++) {
            const batch = this.list[this.#places[2 * at]];
            batch.mesh.setVisibleAt(this.#places[2 * at + 1], visible);
            batch.shown += visible ? 1 : -1;
        }
    }

    /**
     * Moves what has moved with its tree.
     * @param {Matrix4} fromWorld From world space to the root's.
     */
    follow(fromWorld) {
        const matrix = new Matrix4();
        this.#parts.forEach((part, at) => {
            if (matrixOf(part, fromWorld, matrix).equals(part.matrix)) return;
            part.matrix.copy(matrix);
            const { mesh } = this.list[this.#places[2 * at]];
            mesh.setMatrixAt(this.#places[2 * at + 1], mesh.matrix.determinant() < 0 ? matrix.premultiply(MIRROR) : matrix);
        });
    }

    /** To be called when all has been shown and hidden: what is empty costs nothing. Returns how many batches are drawn. */
    settle() {
        let drawn = 0;
        for (const { mesh, sample, shown } of this.list) {
            mesh.visible = shown > 0;
            mesh.castShadow = sample.castShadow;
            mesh.receiveShadow = sample.receiveShadow;
            drawn += Number(shown > 0);
        }
        return drawn;
    }

    dispose() {
        for (const { mesh } of this.list) mesh.dispose();
        this.group.removeFromParent();
    }
}
