// Triangles of constant strain (xpbd/mesh/README.md): tensions in edges are linear in the elongations of all three.
layout(std430, binding = BIND_MEMBRANE_SLICES) readonly buffer MembraneSlices { BendingSlice membrane_slices[]; };
layout(std430, binding = BIND_MEMBRANE_CORNERS) readonly buffer MembraneCorners { MembraneCorner corners[]; };

const float kMaxTurn = 0.3;  // maximum transverse stiffness by tension, as a fraction of the edge's (membrane.cpp)

struct Sides {
  vec3 g0, g1, g2;  // unit vectors along the edges
  vec3 per_l;       // 1 / lengths
};

Sides sides_of(vec3 e0, vec3 e1, vec3 e2) {
  const float kMin = 1e-30;  // an edge without length has no direction and no tension
  vec3 per_l = inversesqrt(max(vec3(dot(e0, e0), dot(e1, e1), dot(e2, e2)), vec3(kMin)));
  return Sides(e0 * per_l.x, e1 * per_l.y, e2 * per_l.z, per_l);
}

vec3 tensions(MembraneCorner c, vec3 d) {
  return vec3(c.along_0 * d.x + c.cross_01 * d.y + c.cross_20 * d.z,
              c.cross_01 * d.x + c.along_1 * d.y + c.cross_12 * d.z,
              c.cross_20 * d.x + c.cross_12 * d.y + c.along_2 * d.z);
}

vec3 elongations(MembraneCorner c, Sides s, vec3 e0, vec3 e1, vec3 e2) {
  return vec3(dot(s.g0, e0) - c.rest_0, dot(s.g1, e1) - c.rest_1, dot(s.g2, e2) - c.rest_2);
}

/// The force of a triangle on the corner at x.
vec3 membrane_force(MembraneCorner c, vec3 x, vec3 a, vec3 b) {
  vec3 e0 = a - x, e1 = b - a, e2 = x - b;
  Sides s = sides_of(e0, e1, e2);
  vec3 t = tensions(c, elongations(c, s, e0, e1, e2));
  return t.x * s.g0 - t.z * s.g2;
}

/// Change of that force by small steps `of_...` of the corners. Its matrix is positive semidefinite: it omits the
/// destabilising part of compression, and is scaled down if a deformed triangle exceeds the bound of the iteration.
vec3 membrane_change(MembraneCorner c, vec3 x, vec3 a, vec3 b, vec3 of_x, vec3 of_a, vec3 of_b) {
  vec3 e0 = a - x, e1 = b - a, e2 = x - b;
  Sides s = sides_of(e0, e1, e2);
  vec3 pulls = tensions(c, elongations(c, s, e0, e1, e2));
  float trace = 2.0 * (c.along_0 + c.along_1 + c.along_2 - c.cross_01 * dot(s.g0, s.g1) - c.cross_12 * dot(s.g1, s.g2) -
                       c.cross_20 * dot(s.g2, s.g0));
  vec3 d0 = of_a - of_x, d2 = of_x - of_b, longer = vec3(dot(s.g0, d0), dot(s.g1, of_b - of_a), dot(s.g2, d2));
  vec3 t = tensions(c, longer) * min(1.0, c.max_trace / trace);
  vec2 turn =
      clamp(vec2(pulls.x, pulls.z) * vec2(s.per_l.x, s.per_l.z), vec2(0.0), kMaxTurn * vec2(c.along_0, c.along_2));
  return t.x * s.g0 - t.z * s.g2 + turn.x * (d0 - longer.x * s.g0) - turn.y * (d2 - longer.z * s.g2);
}
