// Notices what the application does with the loaded objects: hides them, moves them.

/**
 * @typedef {import('three').Object3D} Object3D
 */

/** Nodes that are looked at in each frame, in turn, besides those that are drawn or hidden. */
const IN_TURN = 1024;

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
    /** The layers they were last seen in. */
    #layers = new Int32Array(0);
    /** Visible itself and in the graph: by place. */
    #own = new Uint8Array(0);
    /** The same, and so is everything above. */
    #visible = new Uint8Array(0);
    /** Places of those that are not visible themselves. @type {number[]} */
    #hidden = [];
    /** The glance that has looked at a place last. */
    #stamps = new Uint32Array(0);
    #glance = 0;
    #turn = 0;
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
        const count = this.#nodes.length;
        this.#parents = Int32Array.from(this.#nodes, (node) => this.#places.get(/** @type {Object3D} */ (node.parent)) ?? -1);
        this.#gltf = Int32Array.from(this.#nodes, (node) => gltfOf(node) ?? -1);
        this.#matrices = new Float64Array(16 * count);
        this.#layers = new Int32Array(count);
        this.#own = new Uint8Array(count);
        this.#visible = new Uint8Array(count);
        this.#stamps = new Uint32Array(count);
        this.#nodes.forEach((node, place) => {
            node.updateMatrix();
            this.#matrices.set(node.matrix.elements, 16 * place);
        });
    }

    /**
     * Where a node is among all.
     * @param {Object3D} node
     * @returns {number} -1 for a node that is not watched.
     */
    placeOf(node) {
        return this.#places.get(node) ?? -1;
    }

    /**
     * The node at a place and all above it, up to the root, are visible; as of the last `look`.
     * @param {number} place
     */
    isVisible(place) {
        return this.#visible[place] !== 0;
    }

    /** A new glance begins: nothing has been looked at. */
    begin() {
        this.#glance++;
    }

    /**
     * Whether the node at a place, or one above it, has been shown, hidden or moved since the last `look`. What this glance has
     * looked at already is left out.
     * @param {number} place
     * @param {boolean} composes The matrices of nodes may be older than their positions.
     */
    hasChanged(place, composes) {
        const [stamps, parents] = [this.#stamps, this.#parents];
        for (let at = place; at >= 0 && stamps[at] !== this.#glance; at = parents[at]) {
            stamps[at] = this.#glance;
            if (this.#differs(at, composes)) return true;
        }
        return false;
    }

    /**
     * The same of what is hidden, and of some others, so that after some frames all have had their turn.
     * @param {boolean} composes
     */
    hasChangedElsewhere(composes) {
        for (const place of this.#hidden) if (this.hasChanged(place, composes)) return true;
        const count = this.#nodes.length;
        for (let turn = Math.min(IN_TURN, count); turn > 0; turn--) {
            this.#turn = this.#turn + 1 < count ? this.#turn + 1 : 0;
            if (this.hasChanged(this.#turn, composes)) return true;
        }
        return false;
    }

    /** @param {number} place Taken out of the graph is hidden, too. */
    #isShown(place) {
        const [node, parent] = [this.#nodes[place], this.#parents[place]];
        return node.visible && node.parent === (parent < 0 ? this.#root : this.#nodes[parent]) ? 1 : 0;
    }

    /** @param {number} place */
    #hasMoved(place) {
        const [elements, matrices, first] = [this.#nodes[place].matrix.elements, this.#matrices, 16 * place];
        // Of a translation, rotation and scale no other element changes alone.
        return elements[12] !== matrices[first + 12] || elements[13] !== matrices[first + 13] || elements[14] !== matrices[first + 14]
            || elements[0] !== matrices[first] || elements[5] !== matrices[first + 5] || elements[10] !== matrices[first + 10]
            || elements[1] !== matrices[first + 1] || elements[2] !== matrices[first + 2] || elements[6] !== matrices[first + 6];
    }

    /**
     * @param {number} place
     * @param {boolean} composes
     */
    #differs(place, composes) {
        const node = this.#nodes[place];
        if (composes && node.matrixAutoUpdate) node.updateMatrix();
        return this.#isShown(place) !== this.#own[place] || node.layers.mask !== this.#layers[place] || this.#hasMoved(place);
    }

    /**
     * Looks at all nodes; their matrices must be those of their positions.
     * @param {(gltf: number, matrix: import('three').Matrix4) => void} moved Gets each glTF node that has another matrix.
     */
    look(moved) {
        this.#hidden.length = 0;
        for (let place = 0; place < this.#nodes.length; place++) {
            const [node, parent] = [this.#nodes[place], this.#parents[place]];
            const own = this.#isShown(place);
            this.#own[place] = own;
            this.#visible[place] = parent < 0 ? own : own & this.#visible[parent];
            this.#layers[place] = node.layers.mask;
            if (own === 0) this.#hidden.push(place);
            if (this.#hasMoved(place)) {
                this.#matrices.set(node.matrix.elements, 16 * place);
                if (this.#gltf[place] >= 0) moved(this.#gltf[place], node.matrix);
            }
        }
    }
}
