// Notices what the application does with the loaded objects: hides them, moves them.

/**
 * @typedef {import('three').Object3D} Object3D
 */

/** Nodes of the scene graph in an order in which parents come first. */
export class Watch {
    /** @type {Object3D[]} */
    #nodes = [];
    #root;
    /** Place of each node's parent, or -1 for the root. */
    #parents = new Int32Array(0);
    /** glTF index of each node, or -1. */
    #gltf = new Int32Array(0);
    /** The matrices they were last seen with. */
    #matrices = new Float64Array(0);
    /** Visible, and so is everything above: by place. */
    #visible = new Uint8Array(0);
    /** Places of nodes. @type {Map<Object3D, number>} */
    #places = new Map();

    /**
     * @param {Object3D} root
     * @param {(node: Object3D) => number | undefined} gltfOf glTF index of a node.
     */
    constructor(root, gltfOf) {
        this.#root = root;
        root.traverse((node) => {
            if (node !== root) this.#places.set(node, this.#nodes.push(node) - 1);
        });
        this.#parents = Int32Array.from(this.#nodes, (node) => this.#places.get(/** @type {Object3D} */ (node.parent)) ?? -1);
        this.#gltf = Int32Array.from(this.#nodes, (node) => gltfOf(node) ?? -1);
        this.#matrices = new Float64Array(16 * this.#nodes.length);
        this.#visible = new Uint8Array(this.#nodes.length);
        this.#nodes.forEach((node, place) => {
            node.updateMatrix();
            this.#matrices.set(node.matrix.elements, 16 * place);
        });
    }

    /**
     * The node and all above it, up to the root, are visible; as of the last `look`.
     * @param {Object3D} node
     */
    isVisible(node) {
        return this.#visible[this.#places.get(node) ?? 0] !== 0;
    }

    /**
     * Looks at all nodes.
     * @param {(gltf: number, matrix: import('three').Matrix4) => void} moved Gets each glTF node that has another matrix.
     * @returns {boolean} Something was shown, hidden or moved.
     */
    look(moved) {
        const [nodes, parents, visible, matrices] = [this.#nodes, this.#parents, this.#visible, this.#matrices];
        let changed = false;
        for (let place = 0; place < nodes.length; place++) {
            const node = nodes[place];
            const parent = parents[place];
            // Taken out of the graph is hidden, too.
            const above = parent < 0 ? node.parent === this.#root : node.parent === nodes[parent] && visible[parent] !== 0;
            const is = node.visible && above ? 1 : 0;
            if (is !== visible[place]) {
                visible[place] = is;
                changed = true;
            }
            const elements = node.matrix.elements;
            const first = 16 * place;
            // Of a translation, rotation and scale no other element changes alone.
            if (elements[12] !== matrices[first + 12] || elements[13] !== matrices[first + 13] || elements[14] !== matrices[first + 14]
                || elements[0] !== matrices[first] || elements[5] !== matrices[first + 5] || elements[10] !== matrices[first + 10]
                || elements[1] !== matrices[first + 1] || elements[2] !== matrices[first + 2] || elements[6] !== matrices[first + 6]) {
                matrices.set(elements, first);
                changed = true;
                if (this.#gltf[place] >= 0) moved(this.#gltf[place], node.matrix);
            }
        }
        return changed;
    }
}
