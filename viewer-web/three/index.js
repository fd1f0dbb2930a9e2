// Draws with three.js only what can be seen: a plugin of GLTFLoader for `EXT_spherical_visibility`.

import { Matrix4, Vector2, Vector3 } from 'three';
import { VisibilityScene } from '@svs/runtime';
import { Batches, isBatchable } from './batches.js';
import { ObjectLayers, Route } from './layers.js';
import { Watch } from './watch.js';

/**
 * @typedef {import('three').Object3D} Object3D
 * @typedef {import('three').Mesh} Mesh
 * @typedef {import('three').Camera} Camera
 * @typedef {import('three').PerspectiveCamera} PerspectiveCamera
 * @typedef {import('three').WebGLRenderer} WebGLRenderer
 * @typedef {import('three/addons/loaders/GLTFLoader.js').GLTF} GLTF
 * @typedef {import('three/addons/loaders/GLTFLoader.js').GLTFParser} GLTFParser
 * @typedef {import('@svs/runtime').Budget} Budget
 */

/**
 * Figures of the last frame: what `@svs/runtime` tells, and
 * @typedef {import('@svs/runtime').Statistics & FrameFigures} Statistics
 */

/**
 * @typedef {object} FrameFigures
 * @property {number} batches Batches drawn: one call to the GPU each, where WEBGL_multi_draw is there.
 * @property {number} singles Objects drawn by calls of their own, because they are transparent.
 * @property {number} cullMilliseconds Time the choice took.
 */

/**
 * @param {Mesh} mesh
 * @param {number} instance
 */
function instanceMatrix(mesh, instance) {
    const matrix = new Matrix4();
    /** @type {import('three').InstancedMesh} */ (mesh).getMatrixAt(instance, matrix);
    return matrix;
}

/**
 * The document with a bake that has no proxies and no simplified meshes.
 * @param {any} json
 */
function withoutProxies(json) {
    const { meshLevels, ...extension } = json.extensions.EXT_spherical_visibility;
    extension.trees = extension.trees.map((/** @type {any} */ { proxies, ...tree }) => tree);
    return { ...json, extensions: { ...json.extensions, EXT_spherical_visibility: extension } };
}

const NOTHING = {
    candidates: 0, candidateTriangles: 0, drawn: 0, proxies: 0, levels: 0, triangles: 0, droppedPixels: 0, spheresUsed: 0,
    objectsTested: 0, batches: 0, singles: 0, cullMilliseconds: 0,
};

/**
 * Register it with `loader.register((parser) => new SphericalVisibilityPlugin(parser))`. The loaded file has it as
 * `gltf.userData.sphericalVisibility`. Then either call `update(camera, renderer)` once per frame, or `attach(scene)` once.
 *
 * Files without the extension load as ever, and the plugin does nothing.
 */
export class SphericalVisibilityPlugin {
    /** The loader asks for it. */
    name = 'EXT_spherical_visibility';

    /**
     * The file's baked visibility; `null` if it has none, or none that can be used.
     * @type {VisibilityScene | null}
     */
    visibility = null;

    /** Why baked visibility that the file has is not used. @type {string | null} */
    notice = null;

    /** Figures of the last frame. @type {Statistics} */
    statistics = NOTHING;

    /**
     * Look for objects that were hidden or moved: in each frame at all that is drawn or hidden and everything above it, at the rest
     * in turn. Without it, or where the rest must not wait, call `refresh()` after a change.
     */
    watching = true;

    #parser;
    #enabled = true;
    #route = new Route();
    /** @type {Object3D | null} */
    #root = null;
    /** @type {Batches | null} */
    #batches = null;
    /** @type {Watch | null} */
    #watch = null;
    /** The loaded primitives of each object. @type {Mesh[][]} */
    #meshes = [];
    /** Their places in `#watch`. @type {number[][]} */
    #places = [];
    /** Layers of the camera that was last looked for. */
    #cameraLayers = 0;
    /** Of these, those that no batch draws. @type {ObjectLayers[][]} */
    #singles = [];
    /** What is drawn, and by which frame it was last. */
    #drawn = new Uint32Array(0);
    #drawnCount = 0;
    #stamps = new Uint32Array(0);
    #frame = 0;
    #hidden = new Uint8Array(0);
    /** @type {Uint8Array} */
    #states = new Uint8Array(0);
    #rootMatrix = new Float64Array(16);
    #viewProjection = new Matrix4();
    #eye = new Vector3();
    #size = new Vector2();
    #lastFrame = NaN;
    #needsLook = true;

    /** @param {GLTFParser} parser */
    constructor(parser) {
        this.#parser = parser;
    }

    /**
     * The loader calls it.
     * @param {GLTF} gltf
     */
    async afterRoot(gltf) {
        gltf.userData ??= {};
        gltf.userData.sphericalVisibility = this;
        const parser = this.#parser;
        try {
            const { visibility, notice } = await this.#read();
            const root = visibility === null ? undefined : gltf.scenes[visibility.scene];
            if (visibility === null || root === undefined) return;
            await this.#prepare(visibility, root);
            this.notice = notice;
        } catch (error) {
            this.visibility = null;
            this.#route.active = null;
            this.notice = `EXT_spherical_visibility: ${error instanceof Error ? error.message : error}; drawn as without it`;
        }
        if (this.notice !== null) console.warn(this.notice);
    }

    /** The file's bake, without its proxies if their meshes cannot be loaded: compressed ones need a decoder. */
    async #read() {
        const parser = this.#parser;
        /** @param {any} json */
        const read = (json) => VisibilityScene.fromGltf(json, (index) => parser.getDependency('bufferView', index));
        const visibility = await read(parser.json);
        try {
            for (const { mesh } of visibility?.extras ?? []) await parser.getDependency('mesh', mesh);
        } catch (error) {
            visibility?.dispose();
            const reason = error instanceof Error ? error.message : error;
            return {
                visibility: await read(withoutProxies(parser.json)),
                notice: `EXT_spherical_visibility: the proxies cannot be used (${reason}); drawn without them`,
            };
        }
        return { visibility, notice: visibility?.notice ?? null };
    }

    /**
     * @param {VisibilityScene} visibility
     * @param {Object3D} root
     */
    async #prepare(visibility, root) {
        const { objects, extras } = visibility;
        /** @type {Map<number, Object3D>} */
        const nodes = new Map();
        const associations = this.#parser.associations;
        root.traverse((node) => {
            const index = associations.get(node)?.nodes;
            if (index !== undefined && !nodes.has(index)) nodes.set(index, node);
        });
        root.updateWorldMatrix(true, true);
        const meshes = objects.map(({ node, mesh }) => this.#primitives(nodes.get(node), mesh));
        const lost = meshes.findIndex((primitives) => primitives.length === 0);
        if (lost >= 0) throw new Error(`node ${objects[lost].node} was loaded without its mesh`);

        this.#states = visibility.states;
        /** @type {import('./batches.js').Part[]} */
        const parts = [];
        const singles = objects.map(({ instance }, id) => {
            if (this.#states[id] !== 1) return [];
            return meshes[id].filter((mesh) => {
                if (!isBatchable(mesh)) return true;
                parts.push({ id, mesh, node: mesh, offset: instance >= 0 ? instanceMatrix(mesh, instance) : null });
                return false;
            });
        });
        for (const [at, extra] of extras.entries()) {
            const id = objects.length + at;
            const loaded = await this.#parser.getDependency('mesh', extra.mesh);
            const object = extra.object >= 0 ? objects[extra.object] : null;
            const node = extra.node >= 0 ? nodes.get(extra.node) : root;
            if (node === undefined) throw new Error(`node ${extra.node} was not loaded`);
            const isInstance = object !== null && object.instance >= 0;
            const offset = isInstance ? instanceMatrix(meshes[extra.object][0], object.instance) : new Matrix4();
            offset.multiply(new Matrix4().makeTranslation(...extra.origin));
            for (const mesh of this.#primitivesOf(loaded)) {
                if (!isBatchable(mesh)) throw new Error(`the mesh ${extra.mesh} of a proxy is not opaque`);
                parts.push({ id, mesh, node, offset });
            }
        }

        this.#batches = new Batches(this.#route, parts, objects.length + extras.length, root.matrixWorld.clone().invert());
        const watch = new Watch(root, (node) => associations.get(node)?.nodes);
        this.#watch = watch;
        this.#places = meshes.map((primitives) => primitives.map((mesh) => watch.placeOf(mesh)));
        // After the watch has seen the graph, of which the batches are no part.
        root.add(this.#batches.group);
        for (const mesh of new Set(meshes.flat())) mesh.layers = new ObjectLayers(this.#route, mesh.layers);
        this.#meshes = meshes;
        this.#singles = singles.map((own) => own.map((mesh) => /** @type {ObjectLayers} */ (mesh.layers)));
        this.#drawn = new Uint32Array(objects.length + extras.length);
        this.#stamps = new Uint32Array(objects.length + extras.length);
        this.#hidden = new Uint8Array(objects.length);
        this.#root = root;
        this.visibility = visibility;
        this.#drawAsLoaded();
    }

    /**
     * The loaded primitives of a node's mesh: the node itself, or children of it that are no nodes.
     * @param {Object3D | undefined} node
     * @param {number} mesh glTF index.
     * @returns {Mesh[]}
     */
    #primitives(node, mesh) {
        if (node === undefined) return [];
        const associations = this.#parser.associations;
        const own = associations.get(node)?.nodes;
        const isOf = (/** @type {Object3D} */ object) => {
            const { nodes } = associations.get(object) ?? {};
            return nodes === undefined || nodes === own;
        };
        /** @type {Mesh[]} */
        const found = [];
        const look = (/** @type {Object3D} */ object) => {
            if ('isMesh' in object || 'isLine' in object || 'isPoints' in object) found.push(/** @type {Mesh} */ (object));
            for (const child of object.children) if (isOf(child)) look(child);
        };
        look(node);
        return found.filter((primitive) => (associations.get(primitive)?.meshes ?? mesh) === mesh);
    }

    /**
     * @param {Object3D} loaded
     * @returns {Mesh[]}
     */
    #primitivesOf(loaded) {
        /** @type {Mesh[]} */
        const found = [];
        loaded.updateMatrixWorld();
        loaded.traverse((object) => {
            if ('isMesh' in object) found.push(/** @type {Mesh} */ (object));
        });
        return found;
    }

    /** The file has baked visibility that can be used. */
    get isBaked() {
        return this.visibility !== null;
    }

    /** Switches between visibility and three.js alone, which draws all objects in the frustum. */
    get enabled() {
        return this.#enabled;
    }

    set enabled(enabled) {
        this.#enabled = enabled;
        if (!enabled) this.#route.active = null;
    }

    /** From 0 (draws least) to 1 (misses least). */
    get quality() {
        return this.visibility?.quality ?? 0.5;
    }

    set quality(quality) {
        if (this.visibility !== null) this.visibility.quality = quality;
    }

    /** What may be drawn in one frame; `null` for everything visible. @type {Budget} */
    get budget() {
        return this.visibility?.budget ?? null;
    }

    set budget(budget) {
        if (this.visibility !== null) this.visibility.budget = budget;
        this.#lastFrame = NaN;
    }

    /** Largest visible error of proxies and simplified meshes, in pixels; 0: originals only. */
    get tau() {
        return this.visibility?.tau ?? 1;
    }

    set tau(tau) {
        if (this.visibility !== null) this.visibility.tau = tau;
    }

    /**
     * Updates by itself whenever the scene is rendered, with the camera that it is rendered with.
     * @param {import('three').Scene} scene
     * @returns {() => void} Ends it.
     */
    attach(scene) {
        const before = scene.onBeforeRender;
        /** @type {typeof before} */
        const hook = (renderer, ofScene, camera, ...rest) => {
            before.call(scene, renderer, ofScene, camera, ...rest);
            this.#cull(camera, renderer);
        };
        scene.onBeforeRender = hook;
        return () => {
            if (scene.onBeforeRender === hook) scene.onBeforeRender = before;
            this.#route.active = null;
        };
    }

    /**
     * Chooses what is drawn for a camera, until it is called again. Other cameras see all objects.
     *
     * Cameras that are not perspective ones see all objects, too.
     *
     * @param {Camera} camera
     * @param {WebGLRenderer} [renderer] Tells how large the picture is; without it, that of the window is assumed.
     */
    update(camera, renderer) {
        if (this.#root === null) return;
        camera.updateWorldMatrix(true, false);
        this.#root.updateWorldMatrix(true, false);
        this.#cull(camera, renderer, true);
    }

    /** Looks once, in the next frame, at all objects for what was hidden or moved. */
    refresh() {
        this.#needsLook = true;
    }

    /**
     * Tells how long drawing the last frame took, for a budget of milliseconds. With `attach` it is done by itself, with the
     * time from frame to frame.
     * @param {number} milliseconds
     */
    recordFrame(milliseconds) {
        this.visibility?.recordFrame(milliseconds);
    }

    /**
     * @param {Camera} camera
     * @param {WebGLRenderer | undefined} renderer
     * @param {boolean} [composes] The matrices of nodes may be older than their positions: three.js updates them when it draws.
     */
    #cull(camera, renderer, composes = false) {
        const [visibility, root, batches] = [this.visibility, this.#root, this.#batches];
        const isPerspective = 'isPerspectiveCamera' in camera && !('isArrayCamera' in camera);
        if (visibility === null || root === null || batches === null || !this.#enabled || !isPerspective) {
            this.#route.active = null;
            return;
        }
        const start = performance.now();
        if (visibility.budget !== null && 'milliseconds' in visibility.budget) {
            if (start - this.#lastFrame < 1000) visibility.recordFrame(start - this.#lastFrame);
            this.#lastFrame = start;
        }
        this.#route.active = camera.layers;
        if (this.#needsLook || (this.watching && this.#seesChange(camera, composes))) this.#look(camera, composes);
        this.#follow(root.matrixWorld.elements);
        const { elements } = this.#viewProjection.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
        this.#eye.setFromMatrixPosition(camera.matrixWorld);
        // Of the projection's matrix 1 / tan(half of the vertical field of view): zoom and view offsets are in there.
        const perRadian = (this.#height(renderer) / 2) * camera.projectionMatrix.elements[5];
        const count = visibility.cull(elements, [this.#eye.x, this.#eye.y, this.#eye.z], perRadian);
        this.#apply(visibility.draws, count);
        const singles = this.#countSingles();
        const cullMilliseconds = performance.now() - start;
        this.statistics = { ...visibility.statistics, batches: batches.settle(), singles, cullMilliseconds };
    }

    /** @param {WebGLRenderer | undefined} renderer */
    #height(renderer) {
        if (renderer !== undefined) return renderer.getDrawingBufferSize(this.#size).y;
        return 'innerHeight' in globalThis ? innerHeight * devicePixelRatio : 720;
    }

    /**
     * @param {Uint32Array} draws
     * @param {number} count
     */
    #apply(draws, count) {
        const [batches, stamps] = [/** @type {Batches} */ (this.#batches), this.#stamps];
        const before = this.#frame;
        const frame = ++this.#frame;
        for (let at = 0; at < count; at++) {
            const id = draws[at];
            // What was drawn in the last frame is shown already.
            if (stamps[id] !== before || before === 0) this.#show(batches, id, true);
            stamps[id] = frame;
        }
        for (let at = 0; at < this.#drawnCount; at++) {
            const id = this.#drawn[at];
            if (stamps[id] !== frame) this.#show(batches, id, false);
        }
        for (let at = 0; at < count; at++) this.#drawn[at] = draws[at];
        this.#drawnCount = count;
    }

    /**
     * @param {Batches} batches
     * @param {number} id
     * @param {boolean} visible
     */
    #show(batches, id, visible) {
        batches.show(id, visible);
        const singles = this.#singles[id];
        if (singles !== undefined) for (const layers of singles) layers.drawn = visible;
    }

    #countSingles() {
        let count = 0;
        for (let at = 0; at < this.#drawnCount; at++) count += this.#singles[this.#drawn[at]]?.length ?? 0;
        return count;
    }

    /**
     * The scene's place in the world.
     * @param {ArrayLike<number>} elements
     */
    #follow(elements) {
        let changed = false;
        for (let at = 0; at < 16; at++) changed ||= elements[at] !== this.#rootMatrix[at];
        if (!changed) return;
        this.#rootMatrix.set(elements);
        this.visibility?.setRootMatrix(elements);
    }

    /**
     * Something was hidden or moved. What is drawn comes first, for that must be right in this frame.
     * @param {Camera} camera
     * @param {boolean} composes
     */
    #seesChange(camera, composes) {
        const watch = /** @type {Watch} */ (this.#watch);
        if (camera.layers.mask !== this.#cameraLayers) return true;
        watch.begin();
        for (let at = 0; at < this.#drawnCount; at++) {
            const places = this.#places[this.#drawn[at]];
            if (places === undefined) continue;
            for (const place of places) if (watch.hasChanged(place, composes)) return true;
        }
        return watch.hasChangedElsewhere(composes);
    }

    /**
     * What the application has hidden or moved.
     * @param {Camera} camera
     * @param {boolean} composes
     */
    #look(camera, composes) {
        const [visibility, watch, root] = [this.visibility, this.#watch, this.#root];
        if (visibility === null || watch === null || root === null) return;
        if (composes) root.updateWorldMatrix(false, true);
        let moved = false;
        watch.look((node, matrix) => {
            visibility.setNodeMatrix(node, matrix.elements);
            moved = true;
        });
        this.#needsLook = false;
        this.#cameraLayers = camera.layers.mask;
        if (moved) {
            this.#release(visibility.states);
            this.#batches?.follow(this.#viewProjection.copy(root.matrixWorld).invert());
        }
        this.#meshes.forEach((primitives, object) => {
            const isSeen = (/** @type {Mesh} */ mesh, /** @type {number} */ at) =>
                watch.isVisible(this.#places[object][at]) && /** @type {ObjectLayers} */ (mesh.layers).matches(camera.layers);
            const hidden = primitives.every(isSeen) ? 0 : 1;
            if (hidden !== this.#hidden[object]) {
                this.#hidden[object] = hidden;
                visibility.setHidden(object, hidden !== 0);
            }
        });
    }

    /**
     * Objects that are moved within their tree are three.js's own again.
     * @param {Uint8Array} states
     */
    #release(states) {
        this.#states = states;
        this.#drawAsLoaded();
    }

    /** Objects in no tree are drawn as they were loaded. */
    #drawAsLoaded() {
        this.#meshes.forEach((primitives, object) => {
            if (this.#states[object] === 1) return;
            for (const mesh of primitives) /** @type {ObjectLayers} */ (mesh.layers).drawn = true;
        });
    }

    /** Gives the loaded objects back to three.js and frees the batches. */
    dispose() {
        this.#route.active = null;
        this.#batches?.dispose();
        this.visibility?.dispose();
        this.visibility = null;
        this.#root = null;
    }
}

export { VisibilityScene };
