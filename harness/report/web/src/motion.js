// Unpacks motions and colliders into numbers; layout: harness/report/web/page.hpp.
import {Box3, Vector3} from 'three';
import {unpacked} from './dom.js';

const words = index => unpacked(`blob-${index}`);

function grid_triangles([columns, rows]) {
  const out = [];
  for (let j = 0; j + 1 < rows; ++j)
    for (let a = j * columns; a + 1 < (j + 1) * columns; ++a) out.push(a, a + 1, a + columns + 1, a, a + columns + 1, a + columns);
  return out;
}

const distance = (x, a, b) => Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);

export class Motion {
  /// `entry`: one of the document's motions.
  static async load(entry) {
    const m = Object.assign(new Motion(), {entry, time_s: entry.time_s});
    m.triangles = entry.grid ? grid_triangles(entry.grid) : Array.from(new Uint32Array(await words(entry.triangles)));
    const q = new Uint16Array(await words(entry.blob)), size = q.length / entry.frames.length, n = size / 3;
    for (let k = 0; k < q.length; ++k)  // modulo 2^16
      q[k] += k >= 2 * size ? 2 * q[k - size] - q[k - 2 * size] : k >= size ? q[k - size] : k > 0 ? q[k - 1] : 0;
    m.vertices = n;
    m.position = new Float32Array(q.length);  // (frame, vertex, xyz)
    for (let k = 0; k < q.length; ++k) {
      const frame = Math.floor(k / size), axis = Math.floor(k % size / n);
      m.position[frame * size + 3 * (k % n) + axis] = entry.low_m[axis] + q[k] * entry.step_m;
    }
    m.box = new Box3().setFromArray(m.position.subarray(0, size));  // of the first frame
    return m;
  }

  /// Index of the last frame at or before `time`, and the fraction of the interval to the next one, in [0, 1).
  place(time) {
    const t = this.time_s, f = Math.max(t.findLastIndex(x => x <= time), 0);
    return [f, f + 1 < t.length && time > t[f] ? (time - t[f]) / (t[f + 1] - t[f]) : 0];
  }

  /// Positions at `time` into `out` (vertex, xyz), interpolated linearly between stored frames.
  at(time, out) {
    const [f, w] = this.place(time), size = 3 * this.vertices, a = f * size, b = w > 0 ? a + size : a;
    for (let k = 0; k < size; ++k) out[k] = this.position[a + k] * (1 - w) + this.position[b + k] * w;
    return out;
  }

  /// [a, b, length in m in the first frame] of each edge; for a grid, of edges along rows and columns.
  edges() {
    const seen = new Set(), out = [], x = this.position, n = this.vertices, columns = this.entry.grid?.[0];
    this.triangles.forEach((a, k) => {
      const b = this.triangles[k % 3 === 2 ? k - 2 : k + 1], key = Math.min(a, b) * n + Math.max(a, b), along = Math.abs(a - b);
      if (seen.has(key) || (columns && along !== 1 && along !== columns)) return;
      seen.add(key);
      out.push([a, b, distance(x, a, b)]);
    });
    return out;
  }

  /// Coordinates of each vertex in the first frame along the box's two longest sides, divided by the longest side.
  places() {
    const sides = this.box.getSize(new Vector3()).toArray(), low = this.box.min.toArray();
    const along = [0, 1, 2].sort((a, b) => sides[b] - sides[a]), longest = sides[along[0]] || 1;
    return Array.from({length: 2 * this.vertices}, (_, k) => (this.position[3 * (k >> 1) + along[k % 2]] - low[along[k % 2]]) / longest);
  }

  /// A sentence on which frames of the motion are missing.
  thinning() {
    const {entry} = this, kept = entry.frames.length;
    return `${kept === entry.frames_stored ? 'every frame' : `${kept} of ${entry.frames_stored} frames`}, positions to ${
        (1e3 * entry.step_m).toPrecision(2)} mm${entry.cut_at >= 0 ? `; ends at frame ${entry.cut_at}, where the cloth flew apart or was not finite` : ''}`;
  }
}

/// Maximum |length / length in the first frame - 1| of the edges at each vertex.
export function strain(edges, position, out) {
  out.fill(0);
  for (const [a, b, rest] of edges) {
    const e = Math.abs(distance(position, a, b) / rest - 1);
    for (const v of [a, b]) out[v] = Math.max(out[v], e);
  }
  return out;
}

/// Unpacks the arrays of a scene's colliders into numbers, once for all of its motions.
export async function load_colliders(groups) {
  for (const {arrays} of groups)
    for (const a of Object.values(arrays)) a.values ??= new (a.integer ? Uint32Array : Float32Array)(await words(a.blob));
  return groups;
}
