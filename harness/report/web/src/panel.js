// One motion in its own scene: cloth, colliders, colours.
import * as THREE from 'three';

import {make_colliders, penetration} from './colliders.js';
import {load_colliders, Motion, strain} from './motion.js';

// Viridis at fifths, from its published values; readable with every common colour blindness.
const kRamp = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'].map(c => new THREE.Color(c));
export const ramp_css = `linear-gradient(to right, ${kRamp.map(c => `#${c.getHexString()}`).join(', ')})`;
const kCrossing = new THREE.Color('#ff1f8f');
export const crossing_css = '#ff1f8f';
const kChecks = 10;

function ramp(share, out) {
  const at = Math.min(Math.max(share, 0), 1) * (kRamp.length - 1), k = Math.min(Math.floor(at), kRamp.length - 2);
  return out.copy(kRamp[k]).lerp(kRamp[k + 1], at - k);
}

/// Squares, kChecks along the longer side.
function checks(size_m) {
  const blue = [47, 109, 181, 255], white = [223, 232, 242, 255], longer = Math.max(...size_m);
  const t = new THREE.DataTexture(new Uint8Array([blue, white, white, blue].flat()), 2, 2);
  t.wrapS = t.wrapT = THREE.RepeatWrapping;
  t.repeat.set(...size_m.map(s => Math.max(0.5, kChecks / 2 * s / longer)));
  t.colorSpace = THREE.SRGBColorSpace;
  t.needsUpdate = true;
  return t;
}

export class Panel {
  constructor(motion, colliders) {
    this.motion = motion;
    this.scene = new THREE.Scene();
    this.position = new Float32Array(3 * motion.vertices);
    this.value = new Float32Array(motion.vertices);
    this.edges = motion.structural();
    const g = this.geometry = new THREE.BufferGeometry();
    g.setAttribute('position', new THREE.BufferAttribute(this.position, 3).setUsage(THREE.DynamicDrawUsage));
    g.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * motion.vertices), 3).setUsage(THREE.DynamicDrawUsage));
    g.setIndex(motion.triangles());
    g.setAttribute('uv', new THREE.BufferAttribute(new Float32Array(motion.places().flat()), 2));
    this.checks = checks(motion.size_m());
    // The colliders behind the cloth stay visible. Colours of values are not lit: they equal those of the ramp.
    const shared =
        {vertexColors: true, side: THREE.DoubleSide, transparent: this.hides(colliders), opacity: this.hides(colliders) ? 0.8 : 1};
    this.lit = new THREE.MeshStandardMaterial({...shared, map: this.checks, roughness: 0.85, metalness: 0});
    this.unlit = new THREE.MeshBasicMaterial(shared);
    this.cloth = new THREE.Mesh(g, this.lit);
    this.wires = new THREE.LineSegments(
        new THREE.BufferGeometry().setAttribute('position', g.attributes.position).setIndex(this.edges.flatMap(e => [e[0], e[1]])),
        new THREE.LineBasicMaterial({color: 0x000000, transparent: true, opacity: 0.35}));
    this.solid = new THREE.MeshStandardMaterial({
      color: 0xb9a58c,
      side: THREE.DoubleSide,
      roughness: 1,
      metalness: 0,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1
    });  // so that a cloth on the surface is visible
    this.colliders = make_colliders(colliders);
    this.group = new THREE.Group();
    for (const c of this.colliders) {
      c.object.traverse(o => {
        if (o.isMesh) o.material = this.solid;
      });
      this.group.add(c.object);
    }
    for (const o of [this.cloth, this.wires]) o.frustumCulled = false;
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a8378, 1.7), sun = new THREE.DirectionalLight(0xffffff, 2.0);
    sun.position.set(0.6, 1, 0.8);
    this.scene.add(this.cloth, this.wires, this.group, sky, sun);
  }

  /// Whether moving capsules are behind the cloth in most views.
  hides(colliders) { return colliders.some(c => c.arrays.capsules); }

  static async load(motions, run) {
    const groups = run.colliders === undefined ? [] : motions.colliders[run.colliders];
    const [motion, colliders] = await Promise.all([Motion.load(run), load_colliders(groups)]);
    return new Panel(motion, colliders);
  }

  /// The box to view: the cloth at the start, and the parts of its path and of the colliders that are near. A cloth
  /// that slides off a desk falls for metres; a box around its whole path would reduce it to a dot.
  view_box() {
    const box = frame => {
      const {low, high} = this.motion.box(frame);
      return new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
    };
    const start = box(0), extent = start.getSize(new THREE.Vector3()), near = start.clone().expandByScalar(0.6 * Math.max(...extent)),
          out = start.clone();
    const add = other => {
      other.intersect(near);
      if (!other.isEmpty()) out.union(other);
    };
    for (let f = 1; f < this.motion.time_s.length; ++f) add(box(f));
    for (const c of this.colliders) {
      c.move?.(0);
      add(new THREE.Box3().setFromObject(c.object));
    }
    return out;
  }

  /// The corner from which the cloth is in front of its colliders: signs of x and z.
  side() {
    const solid = new THREE.Box3(), {low, high} = this.motion.box(0);
    for (const c of this.colliders) solid.union(new THREE.Box3().setFromObject(c.object));
    if (solid.isEmpty()) return [1, 1];
    const from = solid.getCenter(new THREE.Vector3()), slack = 0.02 * Math.hypot(...low.map((x, a) => high[a] - x));
    return [0, 2].map(a => (low[a] + high[a]) / 2 - from.getComponent(a) < -slack ? -1 : 1);
  }

  middle(out) { return new THREE.Box3().setFromArray(this.position).getCenter(out); }

  /// Moves everything to `time` and colours the cloth: by "checks", "strain" (`most`: strain at the ramp's end) or
  /// "penetration" (`most` in m). Returns what the vertices' colours show at most, or null.
  show(time, colouring, most) {
    const {motion, position, geometry} = this;
    motion.at(time, position);
    for (const c of this.colliders) c.move?.(time);
    let greatest = null, crossing = 0;
    if (colouring === 'strain') strain(this.edges, position, this.value);
    if (colouring === 'penetration') penetration(this.colliders, this.edges, this.geometry.index.array, position, this.value);
    const colour = new THREE.Color(), out = geometry.attributes.color.array;
    this.cloth.material = colouring === 'checks' ? this.lit : this.unlit;
    for (let v = 0; v < motion.vertices; ++v) {
      if (colouring === 'checks')
        colour.set(0xffffff);
      else {
        const x = this.value[v];
        if (x < 0)
          ++crossing;
        else
          greatest = Math.max(greatest ?? 0, x);
        x < 0 ? colour.copy(kCrossing) : colouring === 'penetration' && x === 0 ? colour.set(0xc9d1da) : ramp(x / most, colour);
      }
      colour.toArray(out, 3 * v);
    }
    geometry.attributes.color.needsUpdate = geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
    return colouring === 'checks' ? null : {greatest, crossing};
  }

  dispose() {
    this.scene.traverse(o => {
      o.geometry?.dispose();
    });
    this.checks.dispose();
    for (const m of [this.lit, this.unlit, this.wires.material, this.solid]) m.dispose();
  }
}
