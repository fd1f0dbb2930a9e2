// What of the application's changes @svs/three notices in which frame, without a browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Group, Mesh } from 'three';
import { Watch } from '../three/watch.js';

/** More nodes than are looked at in one frame. */
const GROUPS = 300;
const IN_EACH = 20;

function scene() {
    const root = new Group();
    const groups = Array.from({ length: GROUPS }, () => new Group().add(...Array.from({ length: IN_EACH }, () => new Mesh())));
    root.add(...groups);
    /** @type {Map<import('three').Object3D, number>} */
    const gltf = new Map();
    root.traverse((node) => gltf.set(node, gltf.size));
    const watch = new Watch(root, (node) => gltf.get(node));
    const look = () => {
        /** @type {number[]} */
        const moved = [];
        root.updateMatrixWorld();
        watch.look((node) => moved.push(node));
        return moved;
    };
    assert.deepEqual(look(), [], 'nothing has moved yet');
    return { root, groups, gltf, watch, look };
}

/**
 * Frames until something is noticed, with these nodes drawn.
 * @param {Watch} watch
 * @param {import('three').Object3D[]} drawn
 */
function frames(watch, drawn) {
    for (let frame = 1; frame <= 20; frame++) {
        watch.begin();
        if (drawn.some((node) => watch.hasChanged(watch.placeOf(node), true)) || watch.hasChangedElsewhere(true)) return frame;
    }
    return Infinity;
}

test('what happens to something drawn, or to what is above it, is noticed in the same frame', () => {
    const { groups, gltf, watch, look } = scene();
    const [group, drawn] = [groups[250], groups[250].children[7]];
    assert.equal(frames(watch, [drawn]), Infinity, 'nothing has changed');
    const changes = [
        () => (drawn.visible = false), () => (drawn.visible = true), () => (group.visible = false), () => (group.visible = true),
        () => drawn.removeFromParent(), () => group.add(drawn), () => drawn.layers.set(3), () => drawn.layers.set(0),
    ];
    for (const change of changes) {
        change();
        assert.equal(frames(watch, [drawn]), 1, String(change));
        assert.deepEqual(look(), []);
    }
    for (const node of [drawn, group]) {
        node.rotation.y += 0.1;
        assert.equal(frames(watch, [drawn]), 1);
        assert.deepEqual(look(), [gltf.get(node)]);
    }
});

test('what is shown again is noticed in the same frame, whatever is drawn', () => {
    const { groups, watch, look } = scene();
    for (const node of [groups[299], groups[150].children[3]]) {
        node.visible = false;
        look();
        assert.equal(watch.isVisible(watch.placeOf(node)), false);
        node.visible = true;
        assert.equal(frames(watch, []), 1);
        look();
        assert.equal(watch.isVisible(watch.placeOf(node)), true);
    }
});

test('what is not drawn has its turn', () => {
    const { groups, gltf, watch, look } = scene();
    const most = Math.ceil((GROUPS * (IN_EACH + 1)) / 1024);
    for (const node of [groups[0].children[0], groups[120], groups[299].children[19]]) {
        node.position.x += 1;
        const after = frames(watch, [groups[5].children[5]]);
        assert(after <= most, `${after} of ${most} frames`);
        assert.deepEqual(look(), [gltf.get(node)]);
    }
});
