// Chooses the module: WebGPU (small), or WebGL2 where there is none.

/** Why the page cannot draw. */
export class NoGraphics extends Error {}

async function webgpu() {
  if (!navigator.gpu) return false;
  try {
    return (await navigator.gpu.requestAdapter()) !== null;
  } catch {
    return false;
  }
}

function webgl2() {
  try {
    const context = document.createElement('canvas').getContext('webgl2');
    context?.getExtension('WEBGL_lose_context')?.loseContext();
    return context !== null;
  } catch {
    return false;
  }
}

/**
 * A viewer on a canvas. `wanted` is "webgpu", "webgl" or null for the best there is.
 * @param {HTMLCanvasElement} canvas @param {string | null} wanted
 * @returns {Promise<{viewer: any, backend: 'webgpu' | 'webgl'}>}
 */
export async function start(canvas, wanted) {
  if (typeof WebAssembly !== 'object') throw new NoGraphics('This browser has no WebAssembly; any browser since 2018 has it.');
  const backends = [];
  if (wanted !== 'webgl' && await webgpu()) backends.push('webgpu');
  if (wanted !== 'webgpu' && webgl2()) backends.push('webgl');
  if (backends.length === 0) {
    throw new NoGraphics(wanted === 'webgpu'
      ? 'This browser has no WebGPU. Open the page without “backend=webgpu” to draw with WebGL2.'
      : 'This browser offers neither WebGPU nor WebGL2. Switch hardware acceleration on in its settings, update the graphics driver, or use another browser.');
  }
  let reason;
  for (const backend of backends) {
    try {
      const module = await import(`./${backend}/svs_viewer_web.js`);
      await module.default({ module_or_path: new URL(`./${backend}/svs_viewer_web_bg.wasm`, import.meta.url) });
      return { viewer: await module.Viewer.create(canvas), backend };
    } catch (error) {
      // What a canvas has once been used for it stays; nothing was drawn yet if the GPU was refused.
      reason = error;
      console.warn(`${backend}:`, error);
    }
  }
  throw new NoGraphics(`The GPU cannot be used: ${reason?.message ?? reason}`);
}
