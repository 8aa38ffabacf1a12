// Buffers and functions that all contact kernels share. Primitives are the cloth's triangles, then its vertices. Each
// primitive has a range of candidate pairs, in the order of convex shapes.
#ifndef FUSED_FRAME
#include "common/common.glsl"
layout(push_constant) uniform Push { ContactConstants p; };
CONTACT_PASS_CONSTANTS(SPECIALIZE)
#endif
CONTACT_CONSTANTS(SPECIALIZE)
#define MARGIN_M uintBitsToFloat(MARGIN_BITS)
#define MIN_SEPARATION_M uintBitsToFloat(MIN_SEPARATION_BITS)
#define ROUNDING_M uintBitsToFloat(ROUNDING_BITS)

layout(std430, binding = BIND_SHAPES) readonly buffer ConvexShapeBuffer { ConvexShape shapes[]; };
layout(std430, binding = BIND_POINTS) readonly buffer Points { ShapePoint points[]; };
layout(std430, binding = BIND_SHAPE_AABBS) readonly buffer ShapeAabbs { ShapeAabb boxes[]; };  // shapes, then groups
layout(std430, binding = BIND_PLANES) readonly buffer Planes { PlaneShape half_spaces[]; };
#define THICKNESS_M uintBitsToFloat(THICKNESS_BITS)
#define SELF_FRICTION uintBitsToFloat(SELF_FRICTION_BITS)
layout(std430, binding = BIND_PRIMITIVES) readonly buffer Primitives { uvec4 primitives[]; };  // vertices, w: how many

// The compiler removes buffers that a kernel does not access.
#ifdef FUSED_FRAME
#define STATE coherent
#else
#define STATE
#endif
// Threads of a workgroup pass pairs to one another.
#if defined(FUSED_FRAME) || defined(FIND_PAIRS)
#define PAIR_STATE coherent
#else
#define PAIR_STATE
#endif
layout(std430, binding = BIND_POSITIONS) STATE buffer Positions { vec4 x[]; };  // w: inverse mass in the solve
layout(std430, binding = BIND_VELOCITIES) STATE buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_MOTION_BOUNDS) STATE buffer MotionBounds { vec4 motion_bounds[]; };
layout(std430, binding = BIND_VERTEX_DISPLACEMENTS) STATE buffer VertexDisplacements { float vertex_displacement[]; };
layout(std430, binding = BIND_STARTS) STATE buffer Starts { vec4 starts[]; };  // of the substep; w: max displacement
layout(std430, binding = BIND_PREDICTED) STATE buffer Proposed { vec4 y[]; };  // w: inverse mass
layout(std430, binding = BIND_LINKS) readonly buffer StructuralLinks { StructuralLink links[]; };
// Vertex-triangle adjacency: per vertex the index of its first entry, then entries 4 * triangle + corner.
layout(std430, binding = BIND_VERTEX_TRIANGLES) readonly buffer VertexTriangles { uint vertex_triangles[]; };
layout(std430, binding = BIND_RANGES) STATE buffer Ranges { uvec4 ranges[]; };  // x: first pair, y: count
layout(std430, binding = BIND_PAIRS) PAIR_STATE buffer Pairs { uvec4 pairs[]; };  // pairs[n].w: n-th active pair
layout(std430, binding = BIND_PAIR_STATES) PAIR_STATE buffer States { PairState states[]; };
layout(std430, binding = BIND_FRAME_STATE) STATE buffer FrameState { ContactFrameState frame_state; };
layout(std430, binding = BIND_DIAGNOSTICS) STATE buffer Diagnostics { ContactDiagnostics diagnostics; };
layout(std430, binding = BIND_SELF_ORDER) readonly buffer SelfOrder { uint self_order[]; };
layout(std430, binding = BIND_SELF_AABBS) STATE buffer SelfAabbs { SelfAabb self_aabbs[]; };
layout(std430, binding = BIND_SELF_BOUNDS) STATE buffer SelfBoundsOfVertices { SelfBounds self_bounds[]; };
layout(std430, binding = BIND_SELF_SUPERGROUPS) STATE buffer SelfSupergroups { SelfSupergroup self_supergroups[]; };
layout(std430, binding = BIND_SELF_RANGES) STATE buffer SelfRanges { uvec4 self_ranges[]; };  // zw: of active pairs
layout(std430, binding = BIND_SELF_PAIRS) STATE buffer SelfPairs { SelfPair self_pairs[]; };
layout(std430, binding = BIND_TRIANGLE_MAX_DISPLACEMENTS) STATE buffer TriangleMaxDisplacements {
  vec4 triangle_max_displacement[];
};
layout(std430, binding = BIND_SELF_ACTIVE) STATE buffer SelfActivePairs { SelfActivePair self_active[]; };
layout(std430, binding = BIND_SELF_CONTACTS) STATE buffer SelfContacts { SelfContact self_contacts[]; };
layout(std430, binding = BIND_SELF_CORRECTIONS) STATE buffer SelfCorrections { SelfCorrection self_corrections[]; };
layout(std430, binding = BIND_TOUCHED) STATE buffer Touched { uint touched[]; };
layout(std430, binding = BIND_ACTIVE_BITS) STATE buffer ActiveBits { uint active_bits[]; };

// Fractions of the motion bounds, tried in turn until all pairs fit into the list. Powers of two multiply exactly. A
// vertex that keeps its speed stays within the second fraction of its bound.
const float kFractions[PAIR_LEVELS] = {1.0, 0.25, 0.125, 0.03125};
const float kRecovered = 0.1;   // maximum depenetration per substep, as a fraction of the margin
const float kStaticMarginFactor = 0.5;   // fraction of the margin that edges and faces keep from static shapes
const float kImpactMassFactor = 0.25;  // [margins] a correction of this length in round 0 halves the inverse mass
const float kTiny = 1e-6;       // smaller weights count as 0
const float kSameNormal = 1.0 - 1e-6;  // cosine: two normals within 1.4 mrad are one

// Two bits per pair: it is active in this substep; its contact proposes a correction in this round.
#define ACTIVE_BITS 0u
#define CORRECTION_BITS (CAPACITY / 32u + 1u)
/// Runs BODY for each pair `k` of RANGE whose bit is set, in the list's order.
#define FOR_EACH_PAIR_OF(BITS, RANGE, BODY) \
  uvec2 of = (RANGE).xy; \
  for (uint word = of.x / 32u, last = of.x + of.y; 32u * word < last; ++word) { \
    uint bits = active_bits[(BITS) + word]; \
    if (32u * word < of.x) bits &= ~0u << of.x % 32u; \
    if (last - 32u * word < 32u) bits &= (1u << last % 32u) - 1u; \
    for (; bits != 0u; bits &= bits - 1u) { \
      uint k = 32u * word + uint(findLSB(bits)); \
      BODY \
    } \
  }

// `touched` starts with the list of vertices that contact may move. Then three values per vertex:
#define PAIR_COUNT(i) (VERTICES + (i))             // candidate pairs of the vertex and its triangles in this frame
#define CORRECTED(i) (2u * VERTICES + (i))          // a contact proposes a correction in this round
#define NEEDS_PROJECTION(i) (3u * VERTICES + (i))  // the vertex is behind a plane, or so near that it may be

uint response_round = 0u;  // 0: before the solve, at the predicted positions; from 1 on: after it
#define ACTIVE_COUNT frame_state.active_pair_count[min(response_round, 1u)]
#define SELF_ACTIVE_COUNT min(frame_state.self_active, ACTIVE_CAPACITY)
// Only kinematic shapes get a response before the constraint solve (round 0). Friction of static shapes would act on a
// displacement without the pull of the constraints: with round 0, a strip over a cylinder (capstan-hold) slips at 5 %
// less overhang than Coulomb's law predicts, and without round 0 at 0.7 % less.
#define FIRST_ROUND (HAS_KINEMATIC != 0u ? 0u : 1u)
uint substep_now = 0u;
float t_begin = 0.0, t_end = 1.0;  // of the substep, as fractions of the frame

/// Time of a substep's start as a fraction of the frame; exactly 1 at the frame's end, where the next frame begins.
float time_of(uint substep) { return substep >= p.substeps ? 1.0 : float(substep) * p.substep_part; }
void begin_substep(uint substep) {
  substep_now = substep;
  t_begin = time_of(substep);
  t_end = time_of(substep + 1u);
}

/// Room for contact corrections of layers in a substep [m]: contact may stop or turn a displacement, and push a vertex
/// out of the contact offset by a quarter of it.
#define ROOM_BESIDE_LAYERS max(0.5 * THICKNESS_M, 0.25 * MARGIN_M)

uint stride() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x; }
