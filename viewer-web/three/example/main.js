// The plugin in use: loads a file, draws what can be seen of it, shows figures.
//
// `?src=URL` names the file; files can be dropped, too. With `?still` pictures are drawn only when a script asks for them.

import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { SphericalVisibilityPlugin } from '@svs/three';

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setPixelRatio(devicePixelRatio);
document.body.prepend(renderer.domElement);

const scene = new THREE.Scene();
scene.background = new THREE.Color(0xbfc8d2);
const camera = new THREE.PerspectiveCamera(60, 1, 0.1, 1000);
const headlight = new THREE.DirectionalLight(0xffffff, 2.5);
headlight.position.set(0.3, 0.4, 1);
camera.add(headlight);
scene.add(camera, new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.2));
const controls = new OrbitControls(camera, renderer.domElement);

/** @type {(id: string) => any} */
const element = (id) => document.getElementById(id);
const [method, quality, budget] = [element('method'), element('quality'), element('budget')];

/** @type {SphericalVisibilityPlugin | null} */
let plugin = null;
/** @type {THREE.Group | null} */
let model = null;
/** @type {THREE.Object3D | null} */
let selected = null;

const loader = new GLTFLoader();
loader.setMeshoptDecoder(MeshoptDecoder);
loader.register((parser) => new SphericalVisibilityPlugin(parser));

/**
 * Shows a file in place of the one before.
 * @param {Promise<import('three/addons/loaders/GLTFLoader.js').GLTF>} loading
 */
async function show(loading) {
    element('message').textContent = '';
    try {
        const gltf = await loading;
        plugin?.dispose();
        if (model !== null) scene.remove(model);
        plugin = gltf.userData.sphericalVisibility;
        model = gltf.scene;
        select(null);
        scene.add(model);
        frame(model);
        if (plugin !== null) quality.value = String(plugin.quality);
        apply();
        element('message').textContent = plugin?.notice ?? '';
    } catch (error) {
        element('message').textContent = `The file cannot be shown: ${error instanceof Error ? error.message : error}`;
    }
}

/**
 * All of an object from a corner.
 * @param {THREE.Object3D} object
 */
function frame(object) {
    const { center, radius } = new THREE.Box3().setFromObject(object).getBoundingSphere(new THREE.Sphere());
    camera.near = radius / 500;
    camera.far = radius * 50;
    controls.target.copy(center);
    look(new THREE.Vector3(1, 0.5, 1).normalize().multiplyScalar(1.8 * radius).add(center), center);
}

/**
 * @param {THREE.Vector3} from
 * @param {THREE.Vector3} to
 */
function look(from, to) {
    camera.position.copy(from);
    controls.target.copy(to);
    camera.updateProjectionMatrix();
    controls.update();
}

function apply() {
    if (plugin === null) return;
    plugin.enabled = method.value === 'visibility';
    plugin.quality = Number(quality.value);
    plugin.budget = budget.value === '' ? null : { triangles: Number(budget.value) };
}

/** @param {THREE.Object3D | null} object */
function select(object) {
    selected = object;
    element('hide').disabled = object === null;
    element('hide').textContent = object === null ? 'Hide' : `Hide ${object.name || 'object'}`;
}

for (const control of [method, quality, budget]) control.addEventListener('input', apply);
element('hide').addEventListener('click', () => {
    if (selected !== null) selected.visible = false;
    select(null);
});
element('show').addEventListener('click', () => model?.traverse((object) => {
    object.visible = true;
}));

// A click that does not turn the camera selects what is below it: rays see all objects that are not hidden.
const pressed = new THREE.Vector2();
renderer.domElement.addEventListener('pointerdown', (event) => pressed.set(event.clientX, event.clientY));
renderer.domElement.addEventListener('pointerup', (event) => {
    if (pressed.distanceTo(new THREE.Vector2(event.clientX, event.clientY)) < 4) select(pick(event.clientX, event.clientY));
});

/**
 * The first visible object below a point of the window.
 * @param {number} x
 * @param {number} y
 * @returns {THREE.Object3D | null}
 */
function pick(x, y) {
    if (model === null) return null;
    const rays = new THREE.Raycaster();
    rays.setFromCamera(new THREE.Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight), camera);
    const isShown = (/** @type {THREE.Object3D | null} */ object) => {
        for (; object !== null; object = object.parent) if (!object.visible) return false;
        return true;
    };
    return rays.intersectObject(model).find((hit) => isShown(hit.object))?.object ?? null;
}

addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', async (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file !== undefined) await show(file.arrayBuffer().then((bytes) => loader.parseAsync(bytes, '')));
});

function resize() {
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
    renderer.setSize(innerWidth, innerHeight);
}
addEventListener('resize', resize);
resize();

/** Draws one picture. */
function draw() {
    plugin?.update(camera, renderer);
    renderer.render(scene, camera);
}

let frames = 0;
const isStill = new URLSearchParams(location.search).has('still');
renderer.setAnimationLoop(isStill ? null : () => {
    draw();
    if (frames++ % 10 === 0) {
        const { triangles, calls } = renderer.info.render;
        const { drawn, candidates, cullMilliseconds } = plugin?.statistics ?? { drawn: 0, candidates: 0, cullMilliseconds: 0 };
        const chosen = plugin?.isBaked && plugin.enabled
            ? `\n${drawn} of ${candidates} visible objects\nchosen in ${cullMilliseconds.toFixed(2)} ms` : '\nall in the frustum';
        element('figures').textContent = `${triangles} triangles, ${calls} calls${chosen}`;
    }
});

// For tests and for the console.
const example = {
    THREE, loader, renderer, scene, camera, controls, look, draw, pick, select,
    get plugin() { return plugin; },
    get model() { return model; },
    get message() { return element('message').textContent; },
    figures: () => {
        const { calls, triangles } = renderer.info.render;
        return { calls, triangles, enabled: plugin?.enabled, baked: plugin?.isBaked, statistics: plugin?.statistics };
    },
    /** @param {string} url */
    load: (url) => show(loader.loadAsync(url)),
};
Object.assign(window, { example });

const source = new URLSearchParams(location.search).get('src');
if (source !== null) await example.load(source);
Object.assign(window, { exampleReady: true });
