// Draws colliders, and measures the depth of vertices in them.
import * as THREE from 'three';
import {MeshBVH} from 'three-mesh-bvh';

/// A function of time that returns an array's values, interpolated linearly between frames; `rate`: frames per second.
function sampled({shape: [frames], values}, rate) {
  const size = values.length / frames, out = new Float32Array(size);
  return time => {
    const at = Math.min(Math.max(time * rate, 0), frames - 1), f = Math.floor(at), a = f * size, b = Math.min(f + 1, frames - 1) * size;
    for (let k = 0; k < size; ++k) out[k] = values[a + k] * (f + 1 - at) + values[b + k] * (at - f);
    return out;
  };
}

/// Ends and radii of the capsules at a time: 7 values each.
function capsules(array, rate) {
  const at = sampled(array, rate), group = new THREE.Group(), up = new THREE.Vector3(0, 1, 0), nearest = new THREE.Vector3(), axis = new THREE.Vector3();
  const parts = Array.from({length: array.shape[1]}, () => ({line: new THREE.Line3()}));
  const move = time => {
    const x = at(time);
    parts.forEach((p, k) => {
      p.line.start.fromArray(x, 7 * k);
      p.line.end.fromArray(x, 7 * k + 3);
      p.radius = x[7 * k + 6];
      const length = p.line.delta(axis).length();
      if (!p.mesh) {
        p.mesh = new THREE.Mesh(new THREE.CapsuleGeometry(p.radius, length, 6, 14));
        p.whole = length + 2 * p.radius;
        group.add(p.mesh);
      }
      p.line.getCenter(p.mesh.position);
      if (length > 0) p.mesh.quaternion.setFromUnitVectors(up, axis.divideScalar(length));
      p.mesh.scale.y = (length + 2 * p.radius) / p.whole;
    });
  };
  move(0);
  return {
    object: group,
    move,
    depth: x => Math.max(...parts.map(p => {
      // A capsule of length 0 has no axis.
      const on = p.line.start.equals(p.line.end) ? p.line.start : p.line.closestPointToPoint(x, true, nearest);
      return p.radius - on.distanceTo(x);
    }))
  };
}

/// Static triangles, or skinned ones: x(t) = Σ weight · matrix(t) (position, 1).
function triangle_mesh(arrays, rate, convex) {
  const rest = arrays.position_m.values, position = new Float32Array(rest);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(arrays.triangles.values), 1));
  const tree = new MeshBVH(geometry);  // sorts the index
  let move = null;
  if (arrays.joint_matrix) {
    const matrices = sampled(arrays.joint_matrix, rate), index = arrays.joint_index.values, weight = arrays.joint_weight.values;
    move = time => {
      const m = matrices(time);
      for (let v = 0; v < position.length; v += 3)
        for (let r = 0; r < 3; ++r) {
          position[v + r] = 0;
          for (let s = 0; s < 4; ++s) {
            const j = 12 * index[4 * v / 3 + s] + 4 * r;
            position[v + r] += weight[4 * v / 3 + s] * (m[j] * rest[v] + m[j + 1] * rest[v + 1] + m[j + 2] * rest[v + 2] + m[j + 3]);
          }
        }
      geometry.attributes.position.needsUpdate = true;
      geometry.computeVertexNormals();
      geometry.computeBoundingSphere();
      tree.refit();
    };
  }
  if (convex) {  // flat shading; the depth of a point is its distance behind the nearest plane
    const faces = geometry.toNonIndexed(), corners = faces.attributes.position;
    faces.computeVertexNormals();
    const plane = (_, k) => new THREE.Plane().setFromCoplanarPoints(...[0, 1, 2].map(i => new THREE.Vector3().fromBufferAttribute(corners, 3 * k + i)));
    const planes = Array.from({length: corners.count / 3}, plane);
    return {object: new THREE.Mesh(faces), depth: x => Math.min(...planes.map(p => -p.distanceToPoint(x)))};
  }
  geometry.computeVertexNormals();
  const ray = new THREE.Ray();
  /// Whether the segment crosses the surface.
  const crosses = (a, b) => {
    const length = a.distanceTo(b);
    if (!(length > 0)) return false;
    ray.origin.copy(a);
    ray.direction.copy(b).sub(a).divideScalar(length);
    return tree.raycastFirst(ray, THREE.DoubleSide, 0, length) !== null;
  };
  return {object: new THREE.Mesh(geometry), move, crosses};
}

/// Small spheres at the points where hands grip the cloth.
function grips(arrays, rate) {
  const target = sampled(arrays.target_m, rate), held = sampled(arrays.held, rate), group = new THREE.Group();
  for (let k = 0; k < arrays.target_m.shape[1]; ++k) group.add(new THREE.Mesh(new THREE.SphereGeometry(0.012, 16, 12)));
  const move = time => group.children.forEach((ball, k) => {
    ball.position.fromArray(target(time), 3 * k);
    ball.visible = held(time)[k] > 0;
  });
  return {object: group, move};
}

/// Objects that draw a scene's colliders (motion.js, load_colliders). Each has `object` and, if defined for its kind,
/// `move(time)`, `depth(x)` (above 0 inside), `crosses(a, b)`.
export function make_colliders(groups) {
  const rate = groups.find(g => g.path === 'colliders')?.attributes.frame_rate_hz ?? 72, out = [];
  for (const {path, arrays, attributes} of groups) {
    if (path === 'colliders/grips') out.push(grips(arrays, rate));
    else if (arrays.capsules) out.push(capsules(arrays.capsules, rate));
    else if (arrays.position_m) out.push(triangle_mesh(arrays, rate, attributes.convex));
  }
  return out;
}

/// Writes the depth [m] at each vertex into `out`: 0 outside; -1 if an edge at the vertex crosses a mesh; otherwise the
/// maximum over the vertex and the midpoints of its edges and triangles, because a fingertip may pass between vertices.
export function penetration(colliders, edges, triangles, position, out) {
  out.fill(0);
  const x = new THREE.Vector3(), y = new THREE.Vector3();
  const sample = (c, corners) => {
    x.set(0, 0, 0);
    for (const v of corners) x.add(y.fromArray(position, 3 * v));
    const depth = c.depth(x.divideScalar(corners.length));
    for (const v of corners) out[v] = Math.max(out[v], depth);
  };
  for (const c of colliders) {
    if (c.depth) {
      for (let v = 0; v < out.length; ++v) sample(c, [v]);
      for (const [a, b] of edges) sample(c, [a, b]);
      for (let k = 0; k < triangles.length; k += 3) sample(c, [triangles[k], triangles[k + 1], triangles[k + 2]]);
    }
    if (c.crosses)
      for (const [a, b] of edges)
        if (c.crosses(x.fromArray(position, 3 * a), y.fromArray(position, 3 * b))) out[a] = out[b] = -1;
  }
  return out;
}
