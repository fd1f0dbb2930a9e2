// `EXT_spherical_visibility` without a renderer: which objects of a glTF scene to draw for a camera.

import init, { SceneBuilder } from './wasm/svs_runtime_wasm.js';
import {
    accessorsOf, deviationOf, extensionOf, indices, measureMeshes, readAccessor, sceneOf, treeNumbers, walk,
} from './describe.js';

/**
 * @typedef {import('./describe.js').Json} Json
 * @typedef {import('./wasm/svs_runtime_wasm.js').SceneHandle} SceneHandle
 */

/**
 * An object: a node with a mesh, or one instance of it.
 * @typedef {object} SceneObject
 * @property {number} node glTF index of its node.
 * @property {number} mesh glTF index of its mesh.
 * @property {number} instance Number of the instance (`EXT_mesh_gpu_instancing`), or -1.
 */

/**
 * What is drawn in place of objects: a proxy for a group, or a simplified version of one object.
 * @typedef {object} Extra
 * @property {number} mesh glTF index of its mesh.
 * @property {number} object The object it is a level of; -1 for a proxy.
 * @property {number} node glTF index of the node in whose space it is; -1 for that of the scene.
 * @property {[number, number, number]} origin Added to its positions.
 */

/**
 * What may be drawn in one frame: at most so many triangles, or what takes so many milliseconds.
 * @typedef {{ triangles: number } | { milliseconds: number } | null} Budget
 */

/**
 * What the last `cull` did.
 * @typedef {object} Statistics
 * @property {number} candidates Visible objects.
 * @property {number} candidateTriangles Their triangles.
 * @property {number} drawn Things to draw.
 * @property {number} proxies Of these, proxies.
 * @property {number} levels Of these, simplified versions of objects.
 * @property {number} triangles Triangles to draw.
 * @property {number} droppedPixels Estimated pixels of what was left out for its size or for the budget.
 * @property {number} spheresUsed Spheres that answered for all objects in them.
 * @property {number} objectsTested Objects looked at one by one.
 */

/** @type {Promise<WebAssembly.Memory> | undefined} */
let loading;

/**
 * Loads the WebAssembly module; once, however often it is called.
 * @param {BufferSource | Response | Promise<Response> | URL | string} [source] The module or where it is. By default the file
 *     beside this one.
 * @returns {Promise<WebAssembly.Memory>}
 */
export function load(source) {
    loading ??= start(source).catch((error) => {
        loading = undefined;
        throw error;
    });
    return loading;
}

/** @param {any} source */
async function start(source) {
    const url = new URL('./wasm/svs_runtime_wasm_bg.wasm', import.meta.url);
    if (source === undefined && url.protocol === 'file:') {
        // Node.js does not fetch files.
        const { readFile } = await import('node:fs/promises');
        source = await readFile(url);
    }
    const { memory } = await init({ module_or_path: source ?? url });
    return memory;
}

/** A glTF scene with its baked visibility. */
export class VisibilityScene {
    /** @type {SceneHandle} */
    #handle;
    /** @type {WebAssembly.Memory} */
    #memory;
    /** @type {Float64Array} */
    #camera = new Float64Array(0);
    /** @type {Float64Array} */
    #figures = new Float64Array(0);
    /** @type {Uint32Array} */
    #ids = new Uint32Array(0);
    /** @type {Budget} */
    #budget = null;
    #quality = 0.5;
    #tau = 1;
    #byVisibility = true;

    /**
     * The objects of the scene in document order. Their places are the numbers that `cull` answers.
     * @type {readonly SceneObject[]}
     */
    objects;

    /**
     * What is drawn in place of objects; numbered after them.
     * @type {readonly Extra[]}
     */
    extras;

    /** glTF index of the scene. */
    scene;

    /** Why proxies that the file has are not used. @type {string | null} */
    notice;

    /** glTF index of each node of the scene in document order. @type {readonly number[]} */
    nodes;

    /** @type {Map<number, number>} Places of nodes. */
    #places;

    /**
     * Reads a document's bake.
     *
     * @param {Json} json The document.
     * @param {(bufferView: number) => Uint8Array | ArrayBuffer | Promise<Uint8Array | ArrayBuffer>} bytesOf The bytes of a buffer
     *     view, decompressed. Only those of the bake's tables and of instances are asked for.
     * @returns {Promise<VisibilityScene | null>} `null` if the document has no bake. The promise is rejected if the bake is
     *     broken or of another state of the scene: draw the document as if it had none then.
     */
    static async fromGltf(json, bytesOf) {
        const extension = extensionOf(json);
        if (extension === undefined) return null;
        const memory = await load();
        const accessors = accessorsOf(json);
        const wanted = new Set(accessors.map((index) => json.accessors[index].bufferView));
        wanted.delete(undefined);
        /** @type {Map<number, Uint8Array>} */
        const views = new Map();
        for (const index of wanted) {
            const bytes = await bytesOf(index);
            views.set(index, bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes));
        }
        const builder = new SceneBuilder(String(extension.version));
        for (const index of accessors) {
            const elements = readAccessor(json, index, views);
            if (elements === null) continue;
            builder.accessor(index, elements.componentType, elements.components, elements.count, elements.bytes);
        }
        if (!Array.isArray(extension.trees)) throw new Error('EXT_spherical_visibility: trees must be a list');
        for (const tree of extension.trees) {
            const { directions, hash, numbers, anchors, nested } = treeNumbers(tree ?? {});
            builder.tree(directions, hash, numbers, anchors, nested);
        }
        for (const entry of extension.meshLevels ?? []) {
            const meshes = indices(entry.levels.map((/** @type {Json} */ level) => level.mesh), 'meshLevels');
            const errors = entry.levels.flatMap((/** @type {Json} */ level) => {
                return [Number(level.error), ...deviationOf(level)];
            });
            builder.meshLevels(entry.mesh, meshes, Float64Array.from(errors));
        }
        const walked = walk(json, views, sceneOf(json));
        const { triangles, boxes } = measureMeshes(json);
        builder.nodes(walked.scene, Uint32Array.from(walked.nodes), Int32Array.from(walked.parents), walked.matrices);
        const [nodes, meshes] = [walked.objectNodes, walked.objectMeshes].map((numbers) => Uint32Array.from(numbers));
        builder.objects(nodes, meshes, Int32Array.from(walked.instancePlaces), walked.instances);
        builder.meshes(triangles, boxes);
        try {
            return new VisibilityScene(builder.build(), memory, walked);
        } catch (error) {
            // The module throws texts.
            throw error instanceof Error ? error : new Error(String(error));
        }
    }

    /**
     * @private
     * @param {SceneHandle} handle
     * @param {WebAssembly.Memory} memory
     * @param {import('./describe.js').Walk} walked
     */
    constructor(handle, memory, walked) {
        this.#handle = handle;
        this.#memory = memory;
        this.scene = walked.scene;
        this.nodes = walked.nodes;
        this.#places = new Map(walked.nodes.map((node, place) => [node, place]));
        this.objects = walked.objectNodes.map((place, object) => ({
            node: walked.nodes[place],
            mesh: walked.objectMeshes[object],
            instance: walked.objectInstances[object],
        }));
        const [numbers, origins] = [handle.extras(), handle.extraOrigins()];
        const signed = (/** @type {number} */ index) => (index === 0xffffffff ? -1 : index);
        this.extras = Array.from({ length: numbers.length / 3 }, (_, at) => {
            const [mesh, object, place] = numbers.subarray(3 * at, 3 * at + 3);
            const node = place === 0xffffffff ? -1 : walked.nodes[place];
            return { mesh, object: signed(object), node, origin: [origins[3 * at], origins[3 * at + 1], origins[3 * at + 2]] };
        });
        this.notice = handle.notice() ?? null;
        const recommended = handle.recommendedQuality();
        if (recommended >= 0) this.#quality = recommended;
    }

    /**
     * Per object 1 if the bake decides whether it is drawn, 0 if it does not (skinned, morphed, animated: draw it as before),
     * 2 if it has been moved within its tree by `setNodeMatrix` (draw it as before, too).
     * @returns {Uint8Array}
     */
    get states() {
        return this.#handle.states();
    }

    /** From 0 (draws least) to 1 (misses least); at first what the file recommends, else 0.5. */
    get quality() {
        return this.#quality;
    }

    set quality(quality) {
        this.#quality = Math.min(Math.max(Number(quality) || 0, 0), 1);
        this.#handle.setQuality(this.#quality);
    }

    /**
     * Draws everything in the frustum, as without a bake: for comparison. Ends when `quality` is set.
     */
    useFrustumOnly() {
        this.#handle.setQuality(-1);
    }

    /** @type {Budget} What may be drawn in one frame; `null` for everything visible. */
    get budget() {
        return this.#budget;
    }

    set budget(budget) {
        this.#budget = budget;
        const triangles = budget !== null && 'triangles' in budget ? Number(budget.triangles) : NaN;
        const milliseconds = budget !== null && 'milliseconds' in budget ? Number(budget.milliseconds) : NaN;
        this.#handle.setBudget(Math.max(triangles, 0), milliseconds);
    }

    /** Largest visible error of proxies and simplified meshes, in pixels; 0: originals only. At first 1. */
    get tau() {
        return this.#tau;
    }

    set tau(tau) {
        this.#tau = Number(tau);
        this.#handle.setDetail(this.#tau, this.#byVisibility);
    }

    /** Only the visible share of an error counts ('visible', at first), or all of it ('plain'). @type {'visible' | 'plain'} */
    get metric() {
        return this.#byVisibility ? 'visible' : 'plain';
    }

    set metric(metric) {
        this.#byVisibility = metric !== 'plain';
        this.#handle.setDetail(this.#tau, this.#byVisibility);
    }

    /**
     * What to draw for a camera: numbers of objects, and from `objects.length` on of extras. Nothing is allocated in
     * steady state: the array is a view of the module's memory, of which the first `count` numbers count and which the next
     * call overwrites.
     *
     * @param {ArrayLike<number>} viewProjection Sixteen numbers by columns; any depth convention.
     * @param {ArrayLike<number>} eye Where the camera is.
     * @param {number} pixelsPerRadian `height / (2 * tan(verticalFieldOfView / 2))`, in pixels.
     * @returns {number} How many of `draws` count.
     */
    cull(viewProjection, eye, pixelsPerRadian) {
        const handle = this.#handle;
        if (this.#camera.buffer !== this.#memory.buffer) {
            this.#camera = new Float64Array(this.#memory.buffer, handle.cameraPointer(), 20);
            this.#figures = new Float64Array(this.#memory.buffer, handle.figuresPointer(), 9);
        }
        const camera = this.#camera;
        for (let at = 0; at < 16; at++) camera[at] = viewProjection[at];
        for (let at = 0; at < 3; at++) camera[16 + at] = eye[at];
        camera[19] = pixelsPerRadian;
        const count = handle.cull();
        const pointer = handle.idsPointer();
        if (this.#ids.buffer !== this.#memory.buffer || this.#ids.byteOffset !== pointer || this.#ids.length < count) {
            this.#ids = new Uint32Array(this.#memory.buffer, pointer, count);
        }
        return count;
    }

    /** Numbers of what to draw: the first that the last `cull` returned. */
    get draws() {
        return this.#ids;
    }

    /** @returns {Statistics} */
    get statistics() {
        if (this.#figures.buffer !== this.#memory.buffer) {
            this.#figures = new Float64Array(this.#memory.buffer, this.#handle.figuresPointer(), 9);
        }
        const [
            candidates, candidateTriangles, drawn, proxies, levels, triangles, droppedPixels, spheresUsed, objectsTested,
        ] = this.#figures;
        return {
            candidates, candidateTriangles, drawn, proxies, levels, triangles, droppedPixels, spheresUsed, objectsTested,
        };
    }

    /**
     * Tells how long drawing took, for a budget of milliseconds.
     * @param {number} milliseconds
     */
    recordFrame(milliseconds) {
        this.#handle.record(milliseconds);
    }

    /**
     * Hides an object, or shows it again. What it used to hide appears.
     * @param {number} object
     * @param {boolean} hidden
     */
    setHidden(object, hidden) {
        this.#handle.setHidden(object, hidden);
    }

    /**
     * Where the scene is in the world.
     * @param {ArrayLike<number>} matrix Sixteen numbers by columns.
     */
    setRootMatrix(matrix) {
        this.#handle.setRoot(Float64Array.from(matrix));
    }

    /**
     * Moves a node. Trees anchored at or below it move along; for other objects below it see `states`.
     * @param {number} node glTF index.
     * @param {ArrayLike<number>} matrix Sixteen numbers by columns, relative to its parent.
     */
    setNodeMatrix(node, matrix) {
        const place = this.#places.get(node);
        if (place !== undefined) this.#handle.setNode(place, Float64Array.from(matrix));
    }

    /** Frees the module's memory; the scene cannot be used any more. */
    dispose() {
        this.#handle.free();
    }
}
