// One motion in its own scene: cloth, colliders, colours.
import * as THREE from 'three';

import {make_colliders, penetration} from './colliders.js';
import {strain} from './motion.js';

// Six equally spaced colours of Viridis; readable with all common colour-vision deficiencies.
const kRamp = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'].map(c => new THREE.Color(c));
export const ramp_css = `linear-gradient(to right, ${kRamp.map(c => `#${c.getHexString()}`).join(', ')})`;
export const crossing_css = '#ff1f8f';
const kCrossing = new THREE.Color(crossing_css), kOutside = new THREE.Color(0xc9d1da), kWhite = new THREE.Color(0xffffff);
const kChecks = 10;  // along the longer side

function ramp(share, out) {
  const at = Math.min(Math.max(share, 0), 1) * (kRamp.length - 1), k = Math.min(Math.floor(at), kRamp.length - 2);
  return out.copy(kRamp[k]).lerp(kRamp[k + 1], at - k);
}

function checks() {
  const blue = [47, 109, 181, 255], white = [223, 232, 242, 255];
  const t = new THREE.DataTexture(new Uint8Array([blue, white, white, blue].flat()), 2, 2);
  t.wrapS = t.wrapT = THREE.RepeatWrapping;
  t.repeat.setScalar(kChecks / 2);
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
    this.edges = motion.edges();
    const g = this.geometry = new THREE.BufferGeometry();
    g.setAttribute('position', new THREE.BufferAttribute(this.position, 3).setUsage(THREE.DynamicDrawUsage));
    g.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * motion.vertices), 3).setUsage(THREE.DynamicDrawUsage));
    g.setIndex(motion.triangles);
    g.setAttribute('uv', new THREE.BufferAttribute(new Float32Array(motion.places()), 2));
    // Capsules behind the cloth stay visible. Value colours are not lit, so that they equal the ramp's colours.
    const hides = colliders.some(c => c.arrays.capsules);
    const shared = {vertexColors: true, side: THREE.DoubleSide, transparent: hides, opacity: hides ? 0.8 : 1};
    this.lit = new THREE.MeshStandardMaterial({...shared, map: checks(), roughness: 0.85, metalness: 0});
    this.unlit = new THREE.MeshBasicMaterial(shared);
    this.cloth = new THREE.Mesh(g, this.lit);
    this.cloth.frustumCulled = false;
    const behind = {polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};  // keeps cloth on the surface visible
    this.solid = new THREE.MeshStandardMaterial({color: 0xb9a58c, side: THREE.DoubleSide, roughness: 1, metalness: 0, ...behind});
    this.colliders = make_colliders(colliders);
    for (const c of this.colliders) {
      c.object.traverse(o => {
        if (o.isMesh) o.material = this.solid;
      });
      this.scene.add(c.object);
    }
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a8378, 1.7), sun = new THREE.DirectionalLight(0xffffff, 2.0);
    sun.position.set(0.6, 1, 0.8);
    this.scene.add(this.cloth, sky, sun);
  }

  /// The corner from which the cloth is in front of its colliders: signs of x and z.
  side() {
    const solid = new THREE.Box3(), {box} = this.motion;
    for (const c of this.colliders) solid.union(new THREE.Box3().setFromObject(c.object));
    if (solid.isEmpty()) return [1, 1];
    const away = box.getCenter(new THREE.Vector3()).sub(solid.getCenter(new THREE.Vector3())), slack = 0.02 * box.getSize(new THREE.Vector3()).length();
    return [away.x, away.z].map(x => x < -slack ? -1 : 1);
  }

  /// Moves all objects to `time` and colours the cloth by "checks", "strain" (`most`: strain at the ramp's end) or
  /// "penetration" (`most` in m). Returns the maximum of the coloured value, and the number of vertices at edges that
  /// cross a mesh.
  show(time, colouring, most) {
    const {motion, position, value, geometry} = this, colour = new THREE.Color(), out = geometry.attributes.color.array;
    motion.at(time, position);
    for (const c of this.colliders) c.move?.(time);
    this.cloth.material = colouring === 'checks' ? this.lit : this.unlit;
    if (colouring === 'strain') strain(this.edges, position, value);
    if (colouring === 'penetration') penetration(this.colliders, this.edges, motion.triangles, position, value);
    for (let v = 0; v < motion.vertices; ++v) {
      const x = value[v];
      const shown = colouring === 'checks' ? kWhite : x < 0 ? kCrossing : colouring === 'penetration' && x === 0 ? kOutside : ramp(x / most, colour);
      shown.toArray(out, 3 * v);
    }
    geometry.attributes.color.needsUpdate = geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
    return {greatest: value.reduce((a, b) => Math.max(a, b), 0), crossing: value.filter(x => x < 0).length};
  }

  dispose() {
    this.scene.traverse(o => o.geometry?.dispose());
    this.lit.map?.dispose();
    for (const m of [this.lit, this.unlit, this.solid]) m.dispose();
  }
}
