// Textures: the browser decodes them, which saves the module its own decoders.

/** Largest side of a texture: every GPU of WebGL 2 has it, and 64 MB are enough for one. */
const LARGEST = 4096;

/** @type {WebGL2RenderingContext | null | undefined} */
let gl;

/**
 * The texels of a bitmap as they are stored, rows from the top. A 2D canvas multiplies colours by alpha, and those of what is
 * transparent are lost, which shows as dark seams where alpha is filtered; so it is asked only where there is no WebGL 2.
 * @param {ImageBitmap} bitmap
 */
function texelsOf(bitmap) {
  const { width, height } = bitmap;
  gl ??= new OffscreenCanvas(1, 1).getContext('webgl2');
  if (!gl || gl.isContextLost()) {
    const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    return new Uint8Array(context.getImageData(0, 0, width, height).data.buffer);
  }
  const [texture, framebuffer] = [gl.createTexture(), gl.createFramebuffer()];
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  const rgba = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  gl.deleteFramebuffer(framebuffer);
  gl.deleteTexture(texture);
  if (gl.getError() !== gl.NO_ERROR) throw new Error('the image cannot be read');
  return rgba;
}

/** @param {Uint8Array} bytes */
async function decode(bytes) {
  // As stored: glTF's colours are not to be touched, and alpha is no light.
  const options = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' };
  let bitmap = await createImageBitmap(new Blob([bytes]), options);
  const scale = LARGEST / Math.max(bitmap.width, bitmap.height);
  if (scale < 1) {
    const [resizeWidth, resizeHeight] = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * scale)));
    const large = bitmap;
    bitmap = await createImageBitmap(large, { ...options, resizeWidth, resizeHeight, resizeQuality: 'high' });
    large.close();
  }
  const { width, height } = bitmap;
  const rgba = texelsOf(bitmap);
  bitmap.close();
  return { width, height, rgba };
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
