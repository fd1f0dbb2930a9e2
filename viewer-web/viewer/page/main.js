// The page: puts canvas, module, controls and files together.

import { imageDecoder } from './images.js';
import { listen } from './input.js';
import { LoadError, load } from './load.js';
import { megabytes } from './format.js';
import { NoGraphics, start } from './module.js';
import { Panel } from './panel.js';

const $ = (id) => document.getElementById(id);
const canvas = $('canvas');
const query = new URLSearchParams(location.search);

/** Milliseconds between two updates of the figures. */
const FIGURES = 120;

/** What tests and other scripts of the page see. */
const svs = {
  /** 'starting', 'ready', 'loading', 'shown', 'failed' */
  state: 'starting',
  backend: null,
  error: null,
  figures: null,
  /** Whether files are loaded by ranges where the server can. */
  stream: query.get('stream') !== 'off',
  /** Times in milliseconds since the page was opened. */
  times: {},
  viewer: null,
  setCamera({ eye, forward, fov = 0, near = 0 }) {
    svs.viewer.set_camera(...eye, ...forward, fov, near);
  },
  select: (object) => panel.select(object),
  hide: () => panel.hide(),
  /** Resolves after a frame that shows everything set so far. */
  async settled() {
    do await new Promise(requestAnimationFrame); while (svs.viewer.pending());
  },
  openUrl: (url) => openUrl(url),
};
window.svs = svs;

let viewer = null;
let panel = null;
let loading = null;

function say(text) {
  $('message-text').textContent = text;
  $('message').hidden = false;
}

function fail(error) {
  svs.state = 'failed';
  svs.error = error?.message ?? String(error);
  say(svs.error);
  // The message says it all for these; others are faults of the page.
  if (!(error instanceof NoGraphics || error instanceof LoadError)) console.error(error);
}

function ratio() {
  return Math.min(devicePixelRatio || 1, 2);
}

function resize() {
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio()));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio()));
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height] = [width, height];
    viewer?.resize(width, height);
  }
}

/** Opens what `fetchInto` gives; a file that comes later takes the place of one still on its way. */
async function open(name, fetchInto) {
  loading?.abort();
  const own = new AbortController();
  loading = own;
  const before = svs.state;
  svs.state = 'loading';
  svs.error = null;
  $('message').hidden = true;
  $('welcome').hidden = true;
  $('loading').hidden = false;
  $('progress').removeAttribute('value');
  $('loading-text').textContent = `Loading ${name}`;
  let shown = false;
  const opened = () => {
    if (shown) return;
    shown = true;
    svs.times.opened = performance.now();
    panel.opened(name);
  };
  const progress = (loaded, total) => {
    if (total > 0) $('progress').value = loaded / total;
    $('loading-text').textContent = `Loading ${name}: ${megabytes(loaded)}${total > 0 ? ` of ${megabytes(total)}` : ''}`;
  };
  try {
    await fetchInto({ signal: own.signal, progress, opened });
    if (own.signal.aborted) return;
    svs.times.loaded = performance.now();
    svs.state = 'shown';
    $('loading').hidden = true;
  } catch (error) {
    if (own.signal.aborted) return;
    $('loading').hidden = true;
    fail(error instanceof LoadError ? error : new LoadError(`${name} cannot be shown: ${error?.message ?? error}`));
    if (before === 'shown') svs.state = 'shown';
    else if (!shown) $('welcome').hidden = false;
  }
}

function openFile(file) {
  return open(file.name, async ({ opened }) => {
    viewer.open(new Uint8Array(await file.arrayBuffer()));
    opened();
  });
}

function openUrl(url) {
  const address = new URL(url, location.href);
  const name = decodeURIComponent(address.pathname.split('/').pop()) || address.host;
  return open(name, (options) => load(viewer, address.href, { ...options, stream: svs.stream }));
}

/** Keys that do something once; says whether this one does. */
function key(code, shift) {
  switch (code) {
    case 'KeyF': viewer.frame_all(true); return true;
    case 'Home': viewer.frame_all(false); return true;
    case 'KeyH': if (shift) panel.showAll(); else panel.hide(); return true;
    case 'KeyM': panel.nextMethod(); return true;
    case 'KeyC': panel.toggleFreeze(); return true;
    case 'Equal': case 'NumpadAdd': case 'BracketRight': viewer.wheel(1); return true;
    case 'Minus': case 'NumpadSubtract': case 'Slash': viewer.wheel(-1); return true;
    case 'Escape': panel.select(null); return true;
    default: return false;
  }
}

function acceptDrops() {
  const hasFiles = (event) => event.dataTransfer?.types.includes('Files');
  addEventListener('dragover', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    $('drop').hidden = false;
  });
  addEventListener('dragleave', (event) => { if (event.relatedTarget === null) $('drop').hidden = true; });
  addEventListener('drop', (event) => {
    event.preventDefault();
    $('drop').hidden = true;
    const [file] = event.dataTransfer.files;
    if (file) openFile(file);
  });
}

function run() {
  const advance = listen(canvas, {
    viewer: () => viewer,
    ratio,
    key,
    click: (x, y) => viewer.pick(Math.floor(x), Math.floor(y)),
  });
  const decodeImages = imageDecoder(viewer);
  let before = performance.now();
  let shown = 0;
  let stale = false;
  const frame = (time) => {
    try {
      advance((time - before) / 1000);
      before = time;
      stale = viewer.frame(time) || stale;
      decodeImages().catch(fail);
      const picked = viewer.picked();
      if (picked !== undefined) panel.select(picked < 0 ? null : picked);
      if (stale) {
        svs.figures = JSON.parse(viewer.figures());
        svs.times.first ??= performance.now();
        if (time - shown > FIGURES) {
          [shown, stale] = [time, false];
          panel.show(svs.figures);
        }
      }
    } catch (error) {
      // The module has stopped for good.
      fail(new Error(`The viewer has stopped: ${error?.message ?? error}. Reload the page.`));
      throw error;
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

$('message-close').addEventListener('click', () => { $('message').hidden = true; });
try {
  resize();
  ({ viewer, backend: svs.backend } = await start(canvas, query.get('backend')));
  svs.viewer = viewer;
  svs.times.module = performance.now();
  $('gpu').textContent = `${svs.backend === 'webgpu' ? 'WebGPU' : 'WebGL2'}: ${viewer.gpu()}`;
  panel = new Panel({ viewer, open: openFile });
  new ResizeObserver(resize).observe(canvas);
  resize();
  acceptDrops();
  run();
  svs.state = 'ready';
  if (query.has('src')) await openUrl(query.get('src'));
  else $('welcome').hidden = false;
} catch (error) {
  fail(error);
}
