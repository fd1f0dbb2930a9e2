// Mouse, touch and keys on the canvas.

/** Pixels that a pointer may move between down and up and still be a click. */
const CLICK = 5;
/** Pixels of a drag per second while an arrow key is held. */
const ARROW = 260;

const MOVES = {
  KeyW: [0, 0, 1], KeyS: [0, 0, -1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyE: [0, 1, 0], KeyQ: [0, -1, 0],
};
const TURNS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * @param {HTMLCanvasElement} canvas
 * @param {{viewer: () => any, ratio: () => number, click: (x: number, y: number) => void, key: (code: string, shift: boolean) => boolean}} host
 * @returns {(seconds: number) => void} to be called each frame
 */
export function listen(canvas, host) {
  const pointers = new Map();
  let moved = 0;

  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, distance: Math.hypot(a.x - b.x, a.y - b.y) };
  };

  canvas.addEventListener('pointerdown', (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 0) moved = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
    // Two fingers are never a click.
    if (pointers.size > 1) moved = Infinity;
  });

  canvas.addEventListener('pointermove', (event) => {
    const pointer = pointers.get(event.pointerId);
    const viewer = host.viewer();
    if (!pointer || !viewer) return;
    const ratio = host.ratio();
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (pointers.size === 2) {
      const before = spread();
      [pointer.x, pointer.y] = [event.clientX, event.clientY];
      const after = spread();
      viewer.pan((after.x - before.x) * ratio, (after.y - before.y) * ratio);
      if (before.distance > 0 && after.distance > 0) {
        viewer.wheel(Math.log(after.distance / before.distance) / Math.log(1.15));
      }
      return;
    }
    moved += Math.hypot(dx, dy);
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
    if (moved <= CLICK || pointers.size > 2) return;
    if (pointer.button === 0 && !event.shiftKey) viewer.drag(dx * ratio, dy * ratio);
    else viewer.pan(dx * ratio, dy * ratio);
  });

  const release = (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointers.delete(event.pointerId) || event.type !== 'pointerup') return;
    if (moved <= CLICK && pointer.button === 0) {
      const box = canvas.getBoundingClientRect();
      host.click((event.clientX - box.left) * host.ratio(), (event.clientY - box.top) * host.ratio());
    }
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());

  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    // Lines and pages of a wheel as pixels: a notch is about 100 of them.
    const pixels = event.deltaY * [1, 33, 300][event.deltaMode];
    host.viewer()?.wheel(-pixels / 100);
  }, { passive: false });

  const held = new Set();
  let faster = false;
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    faster = event.shiftKey;
    if (event.code in MOVES || event.code in TURNS) {
      held.add(event.code);
      event.preventDefault();
    } else if (!event.repeat && host.key(event.code, event.shiftKey)) {
      event.preventDefault();
    }
  });
  // Anywhere: a key may be released after the focus has gone.
  addEventListener('keyup', (event) => {
    held.delete(event.code);
    faster = event.shiftKey;
  });
  const release_all = () => held.clear();
  addEventListener('blur', release_all);
  canvas.addEventListener('blur', release_all);

  return (seconds) => {
    const viewer = host.viewer();
    if (!viewer) return;
    const sum = [0, 0, 0];
    const turn = [0, 0];
    for (const code of held) {
      MOVES[code]?.forEach((part, axis) => { sum[axis] += part; });
      TURNS[code]?.forEach((part, axis) => { turn[axis] += part; });
    }
    viewer.move_by(sum[0], sum[1], sum[2], faster);
    if (turn[0] || turn[1]) {
      const pixels = ARROW * host.ratio() * Math.min(seconds, 0.1) * (faster ? 3 : 1);
      viewer.drag(turn[0] * pixels, turn[1] * pixels);
    }
  };
}
