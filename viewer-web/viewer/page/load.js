// Fetches files: by ranges, what matters most first, or as a whole where the server has no ranges.

/** Bytes of the first request: header, and of small files everything. */
const FIRST = 64 * 1024;
/** Requests at a time. Browsers allow six to one host. */
const PARALLEL = 4;

/** Why a file cannot be had. */
export class LoadError extends Error {}

async function request(url, options) {
  let response;
  try {
    response = await fetch(url, options);
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    throw new LoadError(`${url} cannot be reached: is the address right, and does its server allow other sites (CORS)?`);
  }
  if (!response.ok) throw new LoadError(`${url}: the server answers ${response.status} ${response.statusText}`);
  return response;
}

/** Reads a body and says how far it is. */
async function whole(response, progress) {
  const total = Number(response.headers.get('Content-Length')) || 0;
  const parts = [];
  let loaded = 0;
  const reader = response.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    loaded += value.length;
    progress(loaded, total);
  }
  const bytes = new Uint8Array(loaded);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

/** Total length of the file of a partial answer; null if the server keeps it to itself. */
function totalLength(response) {
  const match = /^bytes \d+-\d+\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '');
  return match ? Number(match[1]) : null;
}

/**
 * Loads a URL into the viewer.
 * @param {any} viewer @param {string} url
 * @param {{signal: AbortSignal, progress: (loaded: number, total: number) => void, opened: () => void, stream: boolean}} options
 */
export async function load(viewer, url, { signal, progress, opened, stream }) {
  const headers = stream ? { Range: `bytes=0-${FIRST - 1}` } : {};
  const response = await request(url, { signal, headers });
  const total = response.status === 206 ? totalLength(response) : null;
  if (total === null) {
    const body = response.status === 206 ? await request(url, { signal }) : response;
    viewer.open(await whole(body, progress));
    opened();
    return;
  }
  const first = new Uint8Array(await response.arrayBuffer());
  if (!viewer.stream(total, first)) {
    // No GLB, or one that holds nothing to be fetched in parts.
    viewer.open(total > first.length ? await whole(await request(url, { signal }), progress) : first);
    opened();
    return;
  }
  let loaded = first.length;
  const fetchRange = async (start, end) => {
    const part = await request(url, { signal, headers: { Range: `bytes=${start}-${end - 1}` } });
    const bytes = new Uint8Array(await part.arrayBuffer());
    if (part.status !== 206 || bytes.length !== end - start) {
      throw new LoadError(`${url}: the server sends another range than it was asked for; has the file changed?`);
    }
    signal.throwIfAborted();
    loaded += bytes.length;
    progress(loaded, total);
    if (viewer.receive(start, bytes)) opened();
  };
  // A worker asks for more as soon as its last range is there, so the line is never idle; each pass asks anew what matters
  // most, for the camera may have moved.
  const running = new Set();
  for (;;) {
    while (running.size < PARALLEL) {
      const ranges = viewer.wanted();
      if (ranges.length === 0) break;
      for (let i = 0; i < ranges.length; i += 2) {
        const task = fetchRange(ranges[i], ranges[i + 1]).finally(() => running.delete(task));
        running.add(task);
      }
    }
    if (running.size === 0) break;
    await Promise.race(running);
  }
}
