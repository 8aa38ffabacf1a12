// What the cloth touches, and what of it is near one point. Included after the push constants `p`. Kinds the scene lacks have a count of 0, a constant, so that their code is dropped; the
// variant without MESHES has no buffer for meshes either.
CONTACT_CONSTANTS(SPECIALIZE)

layout(std430, binding = BIND_PLANES) readonly buffer Planes { PlaneShape planes[]; };
layout(std430, binding = BIND_SPHERES) readonly buffer Spheres { SphereShape spheres[]; };
layout(std430, binding = BIND_BOXES) readonly buffer Boxes { BoxShape boxes[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
#ifdef MESHES
layout(std430, binding = BIND_CLUSTERS) readonly buffer Clusters { MeshCluster clusters[]; };
layout(std430, binding = BIND_CLUSTER_BOXES) readonly buffer ClusterBoxes { ClusterBox cluster_boxes[]; };
layout(std430, binding = BIND_TRIANGLES) readonly buffer Triangles { uvec4 triangles[]; };
layout(std430, binding = BIND_STANDING) readonly buffer Standing { vec4 standing[]; };
layout(std430, binding = BIND_MOVING_START) readonly buffer MovingStart { vec4 moving_start[]; };
layout(std430, binding = BIND_MOVING_END) readonly buffer MovingEnd { vec4 moving_end[]; };
layout(std430, binding = BIND_CANDIDATES) readonly buffer Candidates { uint candidates[]; };
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };
#endif

// Shares of a margin. A move may end nothing closer than kKeep of it: far above the rounding of float32 positions,
// below which the side would be lost; rarely felt, since contact holds the cloth at the whole margin.
const float kKeep = 0.02;
// Contact begins this much outside the margin, or a resting vertex would fall back to it only every other substep and
// creep in the one between.
const float kSlack = 0.05;
const float kTolerance = 1e-4;  // a push by less is none
const float kFlatShare = 0.6;  // what samples keep of the margin of what stands and is flat or round
const float kTaken = 0.9;       // of the free part of the path; the rest is left for rounding
const float kOther = 0.8;       // cosine above which two normals are one contact's: neighbours in a nearly flat mesh
const float kFar = 1e30;

#include "lanes.glsl"

/// One convex piece of a collider as one point of the cloth sees it.
struct Touch {
  float gap;             // distance beyond the margin
  float need;            // depth inside the margin of this piece, taken as a plane, at the end of the displacement that is left
  float margin, friction;
  vec3 n, delta;         // from the piece to the point; displacement of its nearest point in the whole frame
};

// The point of the query: where it is, the displacement left to it in this substep, time as fraction of the frame, time left, and
// the normal of the contact that was active last.
vec3 at, left, active_normal;
float now, part;
// The answer: the nearest piece, the nearest of those to respond to, and the free share of the displacement that is left.
Touch nearest, other;
float free_part;
float bound;   // contact with anything is at least this far away
bool multiple_contacts;  // two pieces are in contact that are not neighbours in a nearly flat mesh

/// A convex piece at distance d lies wholly behind the plane through its nearest point across n. So the path is free
/// of it as long as the point stays before that plane, whatever the piece's shape: nothing to solve, no root to miss.
void consider(float d, vec3 n, vec3 delta, float margin, float friction) {
  float m = max(margin, p.least_margin_m);
  float closing = -dot(left - part * delta, n);
  float spare = d - kKeep * m;
  if (closing > spare && closing > 0.0) free_part = min(free_part, kTaken * max(spare, 0.0) / closing);
  Touch t = Touch(d - m, closing - d + m, m, friction, n, delta);
  if (max(t.gap, nearest.gap) < kSlack * m && dot(n, nearest.n) < kOther) multiple_contacts = true;
  if (t.gap < nearest.gap) nearest = t;
  if (t.gap < kSlack * m && t.need > kTolerance * m && t.gap < other.gap && dot(n, active_normal) < kOther) other = t;
}

vec3 direction(vec3 d, float l, vec3 otherwise) { return l > 0.0 ? d / l : otherwise; }

/// The same of a piece whose margin is one all round.
void consider_even(float d, vec3 n, vec3 delta, float margin, float friction) {
  bound = min(bound, d - (1.0 + kSlack) * max(margin, p.least_margin_m));
  consider(d, n, delta, margin, friction);
}

void consider_shapes() {
  for (uint k = lane(); k < PLANES; k += LANES) {
    PlaneShape s = LOAD(32u, planes, k);
    consider_even(dot(at, s.normal.xyz) - s.normal.w, s.normal.xyz, vec3(0.0), s.margin, s.friction);
  }
  for (uint k = lane(); k < SPHERES; k += LANES) {
    SphereShape s = LOAD(32u, spheres, k);
    vec3 d = at - s.center.xyz;
    float l = length(d);
    consider_even(l - s.radius, direction(d, l, vec3(0.0, 1.0, 0.0)), vec3(0.0), s.margin, s.friction);
  }
  for (uint k = lane(); k < BOXES; k += LANES) {
    BoxShape s = LOAD(80u, boxes, k);
    mat3 axes = mat3(s.axis_x.xyz, s.axis_y.xyz, s.axis_z.xyz);
    vec3 local = (at - s.center.xyz) * axes, half_extent = vec3(s.axis_x.w, s.axis_y.w, s.axis_z.w);
    vec3 beyond = abs(local) - half_extent, outward = sign(local);
    float l = length(max(beyond, 0.0)), deepest = max(beyond.x, max(beyond.y, beyond.z));
    // Inside, the nearest face; a corner of the box is as far as its nearest point, outside.
    vec3 face = beyond.x == deepest ? vec3(1, 0, 0) : beyond.y == deepest ? vec3(0, 1, 0) : vec3(0, 0, 1);
    vec3 n = l > 0.0 ? max(beyond, 0.0) * outward / l : face * mix(vec3(-1.0), vec3(1.0), greaterThanEqual(local, vec3(0.0)));
    consider_even(l > 0.0 ? l : deepest, axes * n, vec3(0.0), s.margin, s.friction);
  }
  for (uint k = lane(); k < CAPSULES; k += LANES) {
    CapsuleShape s = LOAD(64u, capsules, k);
    vec3 a = mix(s.a0.xyz, s.a1.xyz, now), ab = mix(s.b0.xyz, s.b1.xyz, now) - a;
    float squared = dot(ab, ab), t = squared > 0.0 ? clamp(dot(at - a, ab) / squared, 0.0, 1.0) : 0.0;
    vec3 d = at - a - t * ab;
    float l = length(d);
    vec3 delta = mix(s.a1.xyz - s.a0.xyz, s.b1.xyz - s.b0.xyz, t);
    consider_even(l - s.a0.w, direction(d, l, vec3(0.0, 1.0, 0.0)), delta, s.b0.w, s.b1.w);
  }
}

#ifdef MESHES
#include "triangle.glsl"

/// Contact with something of this margin begins no farther from it.
float held_at(float margin) { return (1.0 + kSlack) * max(margin, max(p.least_margin_m, p.border_margin_m)); }

void consider_triangle(uvec4 corners, bool moving, float reach, float margin, float friction) {
  vec3 a, b, c, da = vec3(0.0), db = vec3(0.0), dc = vec3(0.0);
  if (moving) {
    a = LOAD16(moving_start, corners.x).xyz;
    b = LOAD16(moving_start, corners.y).xyz;
    c = LOAD16(moving_start, corners.z).xyz;
    da = LOAD16(moving_end, corners.x).xyz - a;
    db = LOAD16(moving_end, corners.y).xyz - b;
    dc = LOAD16(moving_end, corners.z).xyz - c;
    a += now * da;
    b += now * db;
    c += now * dc;
  } else {
    a = LOAD16(standing, corners.x).xyz;
    b = LOAD16(standing, corners.y).xyz;
    c = LOAD16(standing, corners.z).xyz;
  }
  // Contact with any place on the triangle begins no farther from it.
  float most = held_at(margin);
  if ((corners.w & 7u) == 0u) {
    float share = 1.0;
#ifdef SAMPLE
    if (!moving && corners.w == 0u) share = kFlatShare;
#endif
    most = (1.0 + kSlack) * max(share * margin, p.least_margin_m);
  }
  vec3 apart = max(max(min(a, min(b, c)) - at, at - max(a, max(b, c))), 0.0);
  if (dot(apart, apart) > reach * reach) {
    bound = min(bound, length(apart) - most);
    return;
  }
  vec3 w = on_triangle(at, a, b, c);
  // An open border is a knife: what passes it between two points of the cloth must be nearer to one of them than half
  // their distance.
  uint sides = (w.x == 0.0 ? 1u : 0u) | (w.y == 0.0 ? 2u : 0u) | (w.z == 0.0 ? 4u : 0u);
  bool border = (corners.w & sides) != 0u;
#ifdef SAMPLE
  // Where what stands is flat or round a sample keeps less than a vertex: cloth whose vertices lie on it would be lifted off by the
  // middles of its edges, and the two would hold it in turn.
  if (!moving && !border && (corners.w >> 3u & sides) == 0u) margin *= kFlatShare;
#endif
  if (border) margin = max(margin, p.border_margin_m);
  vec3 d = at - (w.x * a + w.y * b + w.z * c), flat_normal = cross(b - a, c - a);
  float l = length(d);
  bound = min(bound, l - most);
  consider(l, direction(d, l, direction(flat_normal, length(flat_normal), vec3(0.0, 1.0, 0.0))),
           w.x * da + w.y * db + w.z * dc, margin, friction);
}

/// How far from the point a triangle of a cluster may be that can concern it.
float reach_of(float margin, float cluster_displacement, float displacement) {
  return displacement + held_at(margin) + part * cluster_displacement;
}

/// `owner`: the vertex whose list of clusters holds all that the point can meet in this frame.
void consider_meshes(uint owner, bool wanted) {
  float displacement = length(left);
  uint n = p.columns * p.rows, blocks = (p.words + 31u) / 32u;
  for (uint block = 0u; block < blocks; ++block) {
    uint words = wanted ? LOAD4(candidates, block * n + owner) : 0u;
    while (ANY(words != 0u)) {
      uint first = 0u, bits = 0u, near = 0u;
      if (words != 0u) {
        uint word = 32u * block + uint(findLSB(words));
        words &= words - 1u;
        first = 32u * word;
        bits = LOAD4(candidates, (blocks + word) * n + owner) & own_bits();
      }
      for (; bits != 0u; bits &= bits - 1u) {
        uint k = first + uint(findLSB(bits));
        ClusterBox box = LOAD(32u, cluster_boxes, k);
        vec3 apart = max(max(box.low.xyz - at, at - box.high.xyz), 0.0);
        float margin = LOAD16(clusters, k).margin, reach = reach_of(margin, box.low.w, displacement);
        if (!(dot(apart, apart) > reach * reach)) near |= bits & (~bits + 1u);
        else bound = min(bound, length(apart) - held_at(margin));
      }
      for (near = or_of_lanes(near); near != 0u; near &= near - 1u) {
        uint k = first + uint(findLSB(near));
        MeshCluster cluster = LOAD16(clusters, k);
        float reach = reach_of(cluster.margin, LOAD16_OF(cluster_boxes[k].low).w, displacement);
        for (uint t = lane(); t < cluster.count; t += LANES)
          consider_triangle(LOAD16(triangles, cluster.first + t), k >= STANDING_CLUSTERS, reach, cluster.margin,
                            cluster.friction);
      }
    }
  }
}
#endif

/// How far any collider goes in the frame.
float carried() {
  float most = 0.0;
  if (CAPSULES > 0u) most = LOAD16_OF(capsules[CAPSULES].a0).x;
#ifdef MESHES
  if (MOVING == 1u) most = max(most, LOAD16(reaches, p.columns * p.rows).x);
#endif
  return most;
}

#ifdef SHUFFLES
Touch touch_of(uint from, Touch t) {
  return Touch(subgroupShuffle(t.gap, from), subgroupShuffle(t.need, from), subgroupShuffle(t.margin, from),
               subgroupShuffle(t.friction, from), subgroupShuffle(t.n, from), subgroupShuffle(t.delta, from));
}

/// What every lane has found becomes what the point has found.
void agree() {
  if (LANES == 1u) return;
  free_part = least_of_lanes(free_part);
  bound = least_of_lanes(bound);
  Touch own = nearest;
  nearest = touch_of(lane_with(least_of_lanes(own.gap), own.gap), own);
  multiple_contacts = multiple_contacts || (own.gap < kSlack * own.margin && dot(own.n, nearest.n) < kOther);
  multiple_contacts = or_of_lanes(multiple_contacts ? 1u : 0u) != 0u;
  if (ANY(other.gap < kFar)) other = touch_of(lane_with(least_of_lanes(other.gap), other.gap), other);
}
#endif

void query_proximity(uint owner, bool wanted) {
  nearest = Touch(kFar, 0.0, 0.0, 0.0, vec3(0.0), vec3(0.0));
  other = nearest;
  free_part = 1.0;
  bound = kFar;
  multiple_contacts = false;
  if (wanted) consider_shapes();
#ifdef MESHES
  consider_meshes(owner, wanted);
#endif
#ifdef SHUFFLES
  agree();
#endif
}
