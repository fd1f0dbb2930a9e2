// A glTF document in numbers, for the WebAssembly module: nodes, objects and meshes of one scene in document order, and the
// extension's trees. Nothing is culled here.

/** @typedef {Record<string, any>} Json A part of a glTF document. */

const NAME = 'EXT_spherical_visibility';
const INSTANCING = 'EXT_mesh_gpu_instancing';

/** Absent in `TreeNumbers` of the module. */
const ABSENT = -1;

const TABLES = [
    'NODE_SPHERE', 'NODE_SUBTREE', 'NODE_FIRST_OBJECT', 'NODE_OBJECT_COUNT',
    'OBJECT_ORDER', 'LEVEL_ROW', 'LEVEL_ROW_INDEX', 'IMPORTANCE',
];
const PROXY_TABLES = [
    'PROXY_SPHERE', 'PROXY_SUBTREE', 'PROXY_FIRST_OBJECT', 'PROXY_OBJECT_COUNT',
    'PROXY_OBJECT', 'PROXY_ERROR', 'PROXY_MESH', 'PROXY_ORIGIN',
    'PROXY_DEVIATION',
];

/** @type {Record<string, number>} Components per element. */
const COMPONENTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };
/** @type {Record<number, number>} Bytes per component. */
const BYTES = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 };
/** @type {Record<number, number>} What 1 is stored as where integers are normalized. */
const ONE = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535, 5125: 4294967295 };

/**
 * The extension's object, if the document has it.
 * @param {Json} json
 * @returns {Json | undefined}
 */
export function extensionOf(json) {
    const found = json.extensions?.[NAME];
    return found !== null && typeof found === 'object' ? found : undefined;
}

/**
 * @param {any} value
 * @returns {Json[]}
 */
function list(value) {
    return Array.isArray(value) ? value : [];
}

/** @param {any} value */
function number(value) {
    return value === undefined ? ABSENT : typeof value === 'number' && value >= 0 ? value : NaN;
}

/**
 * The scene that the bake is for: that of the first tree with a scene, else the default one.
 * @param {Json} json
 * @returns {number}
 */
export function sceneOf(json) {
    const trees = list(extensionOf(json)?.trees);
    const named = trees.find((tree) => typeof tree?.scene === 'number')?.scene;
    return named ?? (typeof json.scene === 'number' ? json.scene : 0);
}

/**
 * Accessors that must be read: the trees' tables, and the transforms of instances.
 * @param {Json} json
 * @returns {number[]} Ascending.
 */
export function accessorsOf(json) {
    const wanted = new Set();
    for (const tree of list(extensionOf(json)?.trees)) {
        for (const table of TABLES) wanted.add(tree?.tables?.[table]);
        for (const table of PROXY_TABLES) wanted.add(tree?.proxies?.tables?.[table]);
    }
    for (const node of list(json.nodes)) {
        const attributes = node?.extensions?.[INSTANCING]?.attributes ?? {};
        for (const name of ['TRANSLATION', 'ROTATION', 'SCALE']) wanted.add(attributes[name]);
    }
    return [...wanted].filter((index) => Number.isInteger(index) && json.accessors?.[index]).sort((a, b) => a - b);
}

/**
 * The elements of an accessor, tightly packed; `null` if they cannot be read. Tables must not be sparse, so sparse accessors are not.
 * @param {Json} json
 * @param {number} index
 * @param {Map<number, Uint8Array>} views Bytes of buffer views.
 * @returns {{ componentType: number, components: number, count: number, bytes: Uint8Array } | null}
 */
export function readAccessor(json, index, views) {
    const { bufferView, byteOffset = 0, componentType, type, count, sparse } = json.accessors[index];
    const view = views.get(bufferView);
    const components = COMPONENTS[type];
    const size = components * BYTES[componentType];
    if (view === undefined || sparse !== undefined || !(size > 0) || !Number.isInteger(count) || count < 0) return null;
    const stride = json.bufferViews?.[bufferView]?.byteStride ?? size;
    const length = count === 0 ? 0 : stride * (count - 1) + size;
    if (!(stride >= size) || !(byteOffset >= 0) || byteOffset + length > view.length) return null;
    if (stride === size) {
        return { componentType, components, count, bytes: view.subarray(byteOffset, byteOffset + length) };
    }
    const bytes = new Uint8Array(size * count);
    for (let element = 0; element < count; element++) {
        const from = byteOffset + stride * element;
        bytes.set(view.subarray(from, from + size), size * element);
    }
    return { componentType, components, count, bytes };
}

/**
 * An accessor's numbers, normalized ones as fractions.
 * @param {Json} json
 * @param {number | undefined} index
 * @param {Map<number, Uint8Array>} views
 * @returns {Float64Array | null}
 */
function readNumbers(json, index, views) {
    if (index === undefined || !json.accessors?.[index]) return null;
    const elements = readAccessor(json, index, views);
    if (elements === null) return null;
    const { componentType, components, count, bytes } = elements;
    const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    const one = json.accessors[index].normalized ? ONE[componentType] : 1;
    const numbers = new Float64Array(components * count);
    const size = BYTES[componentType];
    for (let at = 0; at < numbers.length; at++) {
        const offset = at * size;
        let value;
        switch (componentType) {
            case 5120: value = data.getInt8(offset); break;
            case 5121: value = data.getUint8(offset); break;
            case 5122: value = data.getInt16(offset, true); break;
            case 5123: value = data.getUint16(offset, true); break;
            case 5125: value = data.getUint32(offset, true); break;
            default: value = data.getFloat32(offset, true);
        }
        numbers[at] = Math.max(value / one, one === 1 ? -Infinity : -1);
    }
    return numbers;
}

/**
 * Writes translation * rotation * scale as a matrix by columns, in the order of operations of the tools that bake.
 * @param {Float64Array} out
 * @param {number} at
 * @param {ArrayLike<number>} t
 * @param {ArrayLike<number>} r
 * @param {ArrayLike<number>} s
 */
function compose(out, at, t, r, s) {
    const [x, y, z, w] = [r[0], r[1], r[2], r[3]];
    const [x2, y2, z2] = [x + x, y + y, z + z];
    const [xx, xy, xz, yy, yz, zz] = [x * x2, x * y2, x * z2, y * y2, y * z2, z * z2];
    const [wx, wy, wz] = [w * x2, w * y2, w * z2];
    out.set([
        (1 - (yy + zz)) * s[0], (xy + wz) * s[0], (xz - wy) * s[0], 0,
        (xy - wz) * s[1], (1 - (xx + zz)) * s[1], (yz + wx) * s[1], 0,
        (xz + wy) * s[2], (yz - wx) * s[2], (1 - (xx + yy)) * s[2], 0,
        t[0], t[1], t[2], 1,
    ], at);
}

/**
 * @param {any} value
 * @param {number[]} otherwise
 * @returns {number[]}
 */
function vector(value, otherwise) {
    return Array.isArray(value) && value.length === otherwise.length ? value.map(Number) : otherwise;
}

/**
 * Nodes and objects of one scene in document order.
 *
 * @typedef {object} Walk
 * @property {number} scene glTF index of the scene.
 * @property {number[]} nodes glTF index of each node.
 * @property {number[]} parents Place of each node's parent, or -1.
 * @property {Float64Array} matrices
 * @property {number[]} objectNodes Place of each object's node.
 * @property {number[]} objectMeshes glTF mesh of each object.
 * @property {number[]} objectInstances Number of the instance within its node, or -1.
 * @property {number[]} instancePlaces Place of its matrix in `instances`, or -1.
 * @property {Float64Array} instances
 */

/**
 * @param {Json} json
 * @param {Map<number, Uint8Array>} views
 * @param {number} scene
 * @returns {Walk}
 */
export function walk(json, views, scene) {
    const all = list(json.nodes);
    const seen = new Uint8Array(all.length);
    /** @type {Pick<Walk, 'nodes' | 'parents' | 'objectNodes' | 'objectMeshes' | 'objectInstances' | 'instancePlaces'>} */
    const out = { nodes: [], parents: [], objectNodes: [], objectMeshes: [], objectInstances: [], instancePlaces: [] };
    /** @type {Float64Array[]} */
    const instances = [];
    let instanceCount = 0;
    // Pairs of a node and the place of its parent, the next one last.
    const pending = roots(json, scene).reverse().map((node) => [node, -1]);
    for (let next = pending.pop(); next !== undefined; next = pending.pop()) {
        const [index, parent] = next;
        const node = all[index];
        if (node === undefined || node === null || seen[index]) throw new Error(`/nodes/${index} does not exist or has two parents`);
        seen[index] = 1;
        const place = out.nodes.push(index) - 1;
        out.parents.push(parent);
        if (Number.isInteger(node.mesh)) {
            const own = instanceMatrices(json, node, views);
            for (let instance = 0; instance < (own === null ? 1 : own.length / 16); instance++) {
                out.objectNodes.push(place);
                out.objectMeshes.push(node.mesh);
                out.objectInstances.push(own === null ? -1 : instance);
                out.instancePlaces.push(own === null ? -1 : instanceCount++);
            }
            if (own !== null) instances.push(own);
        }
        const children = /** @type {any[]} */ (list(node.children));
        for (let child = children.length - 1; child >= 0; child--) pending.push([children[child], place]);
    }
    const matrices = new Float64Array(16 * out.nodes.length);
    out.nodes.forEach((index, place) => {
        const node = all[index];
        if (Array.isArray(node.matrix) && node.matrix.length === 16) {
            matrices.set(node.matrix, 16 * place);
        } else {
            const [t, r, s] = [node.translation, node.rotation, node.scale];
            compose(matrices, 16 * place, vector(t, [0, 0, 0]), vector(r, [0, 0, 0, 1]), vector(s, [1, 1, 1]));
        }
    });
    const packed = new Float64Array(16 * instanceCount);
    let offset = 0;
    for (const own of instances) {
        packed.set(own, offset);
        offset += own.length;
    }
    return { scene, ...out, matrices, instances: packed };
}

/**
 * @param {Json} json
 * @param {number} scene
 * @returns {number[]}
 */
function roots(json, scene) {
    const scenes = list(json.scenes);
    if (scenes.length > 0) return [.../** @type {any[]} */ (list(scenes[scene]?.nodes))];
    const children = new Set(list(json.nodes).flatMap((node) => /** @type {any[]} */ (list(node?.children))));
    return list(json.nodes).map((_, index) => index).filter((index) => !children.has(index));
}

/**
 * @param {Json} json
 * @param {Json} node
 * @param {Map<number, Uint8Array>} views
 * @returns {Float64Array | null} `null` if the node has no instances.
 */
function instanceMatrices(json, node, views) {
    const attributes = node.extensions?.[INSTANCING]?.attributes;
    if (attributes === undefined) return null;
    const counts = Object.values(attributes).map((index) => json.accessors?.[index]?.count ?? 0);
    const count = Math.max(0, ...counts);
    const [t, r, s] = ['TRANSLATION', 'ROTATION', 'SCALE'].map((name) => readNumbers(json, attributes[name], views));
    const matrices = new Float64Array(16 * count);
    for (let at = 0; at < count; at++) {
        const part = (/** @type {Float64Array | null} */ numbers, /** @type {number[]} */ otherwise) =>
            numbers === null ? otherwise : numbers.subarray(at * otherwise.length, (at + 1) * otherwise.length);
        compose(matrices, 16 * at, part(t, [0, 0, 0]), part(r, [0, 0, 0, 1]), part(s, [1, 1, 1]));
    }
    return matrices;
}

/**
 * Triangles of each mesh, and its box as its accessors state it.
 * @param {Json} json
 * @returns {{ triangles: Uint32Array, boxes: Float64Array }}
 */
export function measureMeshes(json) {
    const meshes = list(json.meshes);
    const triangles = new Uint32Array(meshes.length);
    const boxes = new Float64Array(6 * meshes.length).fill(NaN);
    meshes.forEach((mesh, at) => {
        let count = 0;
        const min = [Infinity, Infinity, Infinity];
        const max = [-Infinity, -Infinity, -Infinity];
        for (const primitive of list(mesh?.primitives)) {
            const positions = json.accessors?.[primitive?.attributes?.POSITION];
            if (positions === undefined) continue;
            const drawn = json.accessors?.[primitive.indices]?.count ?? positions.count ?? 0;
            const mode = primitive.mode ?? 4;
            count += mode === 4 ? Math.floor(drawn / 3) : mode === 5 || mode === 6 ? Math.max(drawn - 2, 0) : 0;
            const one = positions.normalized ? ONE[positions.componentType] : 1;
            for (let axis = 0; axis < 3; axis++) {
                const floor = one === 1 ? -Infinity : -1;
                min[axis] = Math.min(min[axis], Math.max((positions.min?.[axis] ?? NaN) / one, floor));
                max[axis] = Math.max(max[axis], Math.max((positions.max?.[axis] ?? NaN) / one, floor));
            }
        }
        triangles[at] = Math.min(count, 4294967295);
        boxes.set([...min, ...max], 6 * at);
    });
    return { triangles, boxes };
}

/**
 * One tree as the module takes it.
 * @param {Json} tree
 * @returns {{ directions: string, hash: string, numbers: Float64Array, anchors: Uint32Array, nested: Uint32Array }}
 */
export function treeNumbers(tree) {
    const numbers = [
        number(tree.scene), number(tree.objectCount), number(tree.levelBits), number(tree.importanceArea),
        number(tree.recommended?.quality), number(tree.fingerprint?.triangles),
        ...TABLES.map((table) => number(tree.tables?.[table])),
    ];
    if (tree.proxies !== undefined) {
        const tables = PROXY_TABLES.map((table) => number(tree.proxies.tables?.[table]));
        numbers.push(typeof tree.proxies.visible === 'boolean' ? Number(tree.proxies.visible) : NaN, ...tables);
    }
    const nested = list(tree.nested).flatMap((entry) => [entry?.object, entry?.tree, entry?.anchor]);
    return {
        directions: String(tree.directions),
        hash: tree.fingerprint === undefined ? '' : String(tree.fingerprint?.hash ?? 'missing'),
        numbers: Float64Array.from(numbers),
        anchors: indices(list(tree.anchors), 'anchors'),
        nested: indices(nested, 'nested'),
    };
}

/**
 * @param {any[]} values
 * @param {string} name
 * @returns {Uint32Array}
 */
export function indices(values, name) {
    const isIndex = (/** @type {any} */ value) => Number.isInteger(value) && value >= 0 && value < 4294967295;
    if (!values.every(isIndex)) throw new Error(`${name}: not an index`);
    return Uint32Array.from(values);
}

/**
 * The `deviation` of one of `meshLevels`: NaN where there is none, -1 where it is not what it must be, which the module refuses.
 * @param {Json} level
 * @returns {number[]}
 */
export function deviationOf(level) {
    const { deviation } = level;
    if (deviation === undefined || deviation === null) return [NaN, NaN, NaN];
    const isRight = Array.isArray(deviation) && deviation.length === 3;
    return [0, 1, 2].map((at) => (isRight && typeof deviation[at] === 'number' ? deviation[at] : -1));
}
