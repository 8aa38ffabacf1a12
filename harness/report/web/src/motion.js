// Packed motions and colliders back into numbers; layout: harness/report/web/page.hpp.

async function inflated(index) {
  const packed = Uint8Array.from(atob(document.getElementById(`blob-${index}`).textContent), c => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate')));
}

/// zlib in base64, of all first bytes, then all second, ... of words -> bytes of the words in turn.
async function words(index, size) {
  const planes = new Uint8Array(await (await inflated(index)).arrayBuffer()), count = planes.length / size;
  const out = new Uint8Array(planes.length);
  for (let b = 0; b < size; ++b)
    for (let k = 0; k < count; ++k) out[k * size + b] = planes[b * count + k];
  return out.buffer;
}

/// Unpacks the metrics over time of a document, once.
export async function load_series(doc) {
  if (typeof doc.series === 'number') doc.series = (await inflated(doc.series)).json();
  doc.series = await doc.series;
}

export class Motion {
  /// `run`: an entry of the document's motions.
  static async load(run) {
    const m = new Motion();
    m.run = run;
    m.corners = 'triangles' in run ? new Uint32Array(await words(run.triangles, 4)) : null;  // of a mesh
    m.columns = run.columns?.length;
    m.rows = run.rows?.length;
    m.vertices = m.corners ? run.vertices : m.columns * m.rows;
    m.time_s = run.time_s;
    const residual = new Uint16Array(await words(run.blob, 2)), n = m.vertices;
    m.position = new Float32Array(residual.length);  // (frame, vertex, xyz)
    let now = new Int32Array(3 * n), before = new Int32Array(3 * n), earlier = new Int32Array(3 * n);
    for (let f = 0; f < run.frames.length; ++f) {
      for (let a = 0, k = 0; a < 3; ++a) {
        const origin = run.origin[3 * f + a];
        for (let v = 0; v < n; ++v, ++k) {
          const predicted = f > 1 ? 2 * before[k] - earlier[k] : f === 1 ? before[k] : v === 0 ? origin : now[k - 1];
          now[k] = origin + ((predicted - origin + residual[3 * n * f + k]) & 0xffff);
          m.position[3 * (f * n + v) + a] = now[k] * run.step_m;
        }
      }
      [earlier, before, now] = [before, now, earlier];
    }
    return m;
  }

  /// Index of the last frame at or before `time`, and how far it is to the next, in [0, 1).
  place(time) {
    const t = this.time_s;
    if (!(time > t[0])) return [0, 0];
    if (time >= t[t.length - 1]) return [t.length - 1, 0];
    let low = 0, high = t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (t[middle] <= time)
        low = middle;
      else
        high = middle;
    }
    return [low, (time - t[low]) / (t[high] - t[low])];
  }

  /// Positions at `time` into `out` (vertex, xyz), interpolated linearly between stored frames.
  at(time, out) {
    const [f, w] = this.place(time), size = 3 * this.vertices, a = f * size, b = w > 0 ? a + size : a;
    for (let k = 0; k < size; ++k) out[k] = this.position[a + k] * (1 - w) + this.position[b + k] * w;
    return out;
  }

  /// Vertex indices of the triangles of the grid or mesh.
  triangles() {
    if (this.corners) return Array.from(this.corners);
    const out = [], c = this.columns;
    for (let j = 0; j + 1 < this.rows; ++j)
      for (let i = 0; i + 1 < c; ++i) {
        const a = j * c + i;
        out.push(a, a + 1, a + c + 1, a, a + c + 1, a + c);
      }
    return out;
  }

  /// [a, b, rest length in m] of the edges along rows and columns; of a mesh all edges with their lengths in the first
  /// frame.
  structural() {
    if (this.corners) return this.edges_of_mesh();
    const {run} = this, out = [], c = this.columns;
    const du = run.size_m[0] / (run.grid[0] - 1), dv = run.size_m[1] / (run.grid[1] - 1);
    for (let j = 0; j < this.rows; ++j)
      for (let i = 0; i < c; ++i) {
        if (i + 1 < c) out.push([j * c + i, j * c + i + 1, du * (run.columns[i + 1] - run.columns[i])]);
        if (j + 1 < this.rows) out.push([j * c + i, (j + 1) * c + i, dv * (run.rows[j + 1] - run.rows[j])]);
      }
    return out;
  }

  edges_of_mesh() {
    const seen = new Set(), out = [], x = this.position, n = this.vertices;
    this.corners.forEach((a, k) => {
      const b = this.corners[k % 3 === 2 ? k - 2 : k + 1], key = Math.min(a, b) * n + Math.max(a, b);
      if (seen.has(key)) return;
      seen.add(key);
      out.push([a, b, Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2])]);
    });
    return out;
  }

  /// Place of each vertex on the checker, 0 to 1 across the cloth: of a mesh by the two longest sides of its first frame.
  places() {
    if (!this.corners)
      return Array.from(
          {length: this.vertices}, (_, v) => [(v % this.columns) / (this.columns - 1), Math.floor(v / this.columns) / (this.rows - 1)]);
    const {low, sides} = this.sides(), axes = this.longest(sides);
    return Array.from({length: this.vertices}, (_, v) => axes.map(a => (this.position[3 * v + a] - low[a]) / (sides[a] || 1)));
  }

  /// Width and height [m] of the cloth.
  size_m() {
    if (!this.corners) return this.run.size_m;
    const {sides} = this.sides();
    return this.longest(sides).map(a => Math.max(sides[a], 1e-9));
  }

  sides() {
    const {low, high} = this.box(0);
    return {low, sides: high.map((h, a) => h - low[a])};
  }

  longest(sides) { return [0, 1, 2].sort((a, b) => sides[b] - sides[a]).slice(0, 2); }

  /// Least and greatest corner of one frame.
  box(frame) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], size = 3 * this.vertices;
    for (let k = 0; k < size; ++k) {
      const x = this.position[frame * size + k], a = k % 3;
      if (x < low[a]) low[a] = x;
      if (x > high[a]) high[a] = x;
    }
    return {low, high};
  }

  /// A sentence on what was left out of the motion.
  thinning() {
    const {run} = this, kept = run.frames.length, grid = this.corners ? this.vertices : run.grid[0] * run.grid[1];
    const step = run.step_m >= 1e-3 ? `${(1e3 * run.step_m).toPrecision(2)} mm` : `${(1e6 * run.step_m).toPrecision(2)} µm`;
    return `${kept === run.frames_stored ? 'every frame' : `${kept} of ${run.frames_stored} frames`}, ` +
        `${this.vertices === grid ? 'every vertex' : `${this.vertices} of ${grid} vertices`}, positions to ${step}` +
        (this.corners ? ', stretch against the first frame' : '') +
        (run.cut_at >= 0 ? `; ends at frame ${run.cut_at}, where the cloth flew apart or was not finite` : '');
  }
}

/// Greatest |length / rest - 1| of the edges at each vertex.
export function strain(edges, position, out) {
  out.fill(0);
  for (const [a, b, rest] of edges) {
    const e = Math.abs(
        Math.hypot(
            position[3 * a] - position[3 * b], position[3 * a + 1] - position[3 * b + 1], position[3 * a + 2] - position[3 * b + 2]) /
            rest -
        1);
    if (e > out[a]) out[a] = e;
    if (e > out[b]) out[b] = e;
  }
  return out;
}

/// Groups of a scene's colliders with their arrays as numbers.
export async function load_colliders(groups) {
  return Promise.all(groups.map(async g => {
    const arrays = {};
    for (const [name, a] of Object.entries(g.arrays)) {
      const bytes = await words(a.blob, 4);
      arrays[name] = {shape: a.shape, values: a.integer ? new Uint32Array(bytes) : new Float32Array(bytes)};
    }
    return {path: g.path, attributes: g.attributes, arrays};
  }));
}
