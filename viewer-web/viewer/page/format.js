// Numbers for people.

/** @param {number} value */
export function count(value) {
  return Math.round(value).toLocaleString('en');
}

/** Three significant digits, with k and M. @param {number} value */
export function short(value) {
  if (value >= 1e6) return `${(value / 1e6).toPrecision(3)} M`;
  if (value >= 1e3) return `${(value / 1e3).toPrecision(3)} k`;
  return String(Math.round(value));
}

/** @param {number} bytes */
export function megabytes(bytes) {
  return `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;
}

/** A part of a whole. @param {number} part @param {number} whole */
export function share(part, whole) {
  return whole > 0 ? `${((100 * part) / whole).toFixed(part < whole * 0.1 ? 1 : 0)} %` : '';
}
