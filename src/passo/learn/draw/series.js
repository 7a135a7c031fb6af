/** A quantity over time or another axis: exact corners, or columns with lowest, highest and mean value. */

const EMPTY = -32768; // mark of a column without values

/**
 * Corners: `t` ascends; a value that is not a number is a gap.
 * @typedef {{ t: ArrayLike<number>, v: ArrayLike<number> }} Corners
 * @typedef {{ width: number, scale: number, low: Int16Array, high: Int16Array, mean: Int16Array }} Columns
 * @typedef {Corners | Columns} Series
 */

export const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

/** The series of a written page (`Series.encoded` in Python), or corners as they are. */
export function decode(e) {
  if (e.w) {
    const [low, high, mean] = [e.low, e.high, e.mean].map((text) => new Int16Array(bytes(text)));
    return { width: e.w, scale: e.scale, low, high, mean };
  }
  if (e.t) return e;
  let sum = 0;
  return { t: Float64Array.from(new Float32Array(bytes(e.s)), (step) => (sum += step)), v: new Float32Array(bytes(e.v)) };
}

function firstAfter(times, t) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The value at t, from corner i - 1 to corner i. */
function between({ t: times, v: values }, i, t) {
  const span = times[i] - times[i - 1];
  return span > 0 ? values[i - 1] + ((values[i] - values[i - 1]) * (t - times[i - 1])) / span : values[i];
}

/**
 * The lowest and the highest value at a time; null where nothing is known.
 * @type {(series: Series, t: number) => [number, number] | null}
 */
export function valueAt(s, t) {
  if (s.width) {
    const k = Math.floor(t / s.width);
    if (!(k < s.low.length) || s.low[k] === EMPTY) return null;
    return [s.low[k] * s.scale, s.high[k] * s.scale];
  }
  const i = firstAfter(s.t, t);
  if (i === 0 || (i === s.t.length && t > s.t[i - 1])) return null;
  const value = i === s.t.length ? s.v[i - 1] : between(s, i, t);
  return Number.isNaN(value) ? null : [value, value];
}

/**
 * What is to be drawn of t0 to t1 in `most` columns: points of a line, and a band where there is more
 * in a column than a line can show.
 * @type {(series: Series, t0: number, t1: number, most: number) => { points: number[][], band: number[][] }}
 */
export function part(s, t0, t1, most) {
  if (!s.width) {
    const [first, last] = [firstAfter(s.t, t0), firstAfter(s.t, t1)];
    if (last - first <= 2 * most) {
      const points = [];
      if (first > 0 && first < s.t.length) points.push([t0, between(s, first, t0)]);
      for (let i = first; i < last; i++) points.push([s.t[i], s.v[i]]);
      if (last > 0 && last < s.t.length) points.push([t1, between(s, last, t1)]);
      return { points, band: [] };
    }
  }
  const own = s.width && (t1 - t0) / s.width <= most;
  const width = own ? s.width : (t1 - t0) / most;
  const from = own ? Math.floor(t0 / width) * width : t0;
  return drawn(columnsOf(s, t0, t1, from, width), t0, t1, from, width, own);
}

function columnsOf(s, t0, t1, from, width) {
  const size = Math.ceil((t1 - from) / width);
  const low = new Float64Array(size).fill(Infinity);
  const high = new Float64Array(size).fill(-Infinity);
  const [area, span] = [new Float64Array(size), new Float64Array(size)];
  const put = (k, a, b, sum, time) => {
    if (k < 0 || k >= size) return;
    low[k] = Math.min(low[k], a);
    high[k] = Math.max(high[k], b);
    area[k] += sum;
    span[k] += time;
  };
  if (s.width) {
    const stop = Math.min(s.low.length, Math.ceil(t1 / s.width));
    for (let i = Math.max(0, Math.floor(t0 / s.width)); i < stop; i++) {
      if (s.low[i] === EMPTY) continue;
      const k = Math.floor(((i + 0.5) * s.width - from) / width);
      put(k, s.low[i] * s.scale, s.high[i] * s.scale, s.mean[i] * s.scale * s.width, s.width);
    }
  } else {
    for (let i = Math.max(1, firstAfter(s.t, t0)); i < s.t.length && s.t[i - 1] < t1; i++) {
      if (Number.isNaN(s.v[i - 1] + s.v[i])) continue;
      let a = Math.max(t0, s.t[i - 1]);
      const end = Math.min(t1, s.t[i]);
      for (let k = Math.floor((a - from) / width); a < end && k < size; k++) {
        const b = Math.min(end, from + (k + 1) * width);
        const [u, v] = [between(s, i, a), between(s, i, b)];
        if (b > a) put(k, Math.min(u, v), Math.max(u, v), ((u + v) / 2) * (b - a), b - a);
        a = Math.max(a, b);
      }
    }
  }
  return { low, high, area, span };
}

function drawn({ low, high, area, span }, t0, t1, from, width, own) {
  const [points, band] = [[], []];
  for (let k = 0; k < span.length; k++) {
    if (!span[k]) continue;
    const [a, b] = [Math.max(t0, from + k * width), Math.min(t1, from + (k + 1) * width)];
    for (const t of own ? [a, b] : [(a + b) / 2]) {
      points.push([t, area[k] / span[k]]);
      band.push([t, low[k], high[k]]);
    }
  }
  return { points, band };
}
