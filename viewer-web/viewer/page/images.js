// Textures: the browser decodes them, which saves the module its own decoders.

/** Largest side of a texture: every GPU of WebGL 2 has it, and 64 MB are enough for one. */
const LARGEST = 4096;

/** @param {Uint8Array} bytes */
async function decode(bytes) {
  // As stored: glTF's colours are not to be touched, and alpha is no light.
  const options = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' };
  let bitmap = await createImageBitmap(new Blob([bytes]), options);
  const scale = Math.min(1, LARGEST / Math.max(bitmap.width, bitmap.height));
  const [width, height] = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * scale)));
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return { width, height, rgba: new Uint8Array(context.getImageData(0, 0, width, height).data.buffer) };
}

/** Decodes what the viewer wants decoded; one image at a time, so that little memory is needed. @param {any} viewer */
export function imageDecoder(viewer) {
  let busy = false;
  return async () => {
    if (busy) return;
    busy = true;
    try {
      for (let image = viewer.next_image(); image; image = viewer.next_image()) {
        const { place, bytes } = image;
        image.free();
        const file = viewer.file();
        // What cannot be decoded stays white.
        const texels = await decode(bytes).catch(() => null);
        if (viewer.file() === file) viewer.set_image(place, texels?.width ?? 0, texels?.height ?? 0, texels?.rgba);
      }
    } finally {
      busy = false;
    }
  };
}
