// What the kernels of plane contact share: what is known of elements and pieces, and of the substep. Elements are the cloth's
// triangles, then its vertices; each has a range of pairs, in the order of pieces. A kernel of a phase has its counts as
// push constants, the kernel of a whole frame as specialization constants of the same names.
#ifndef PLANE_FRAME
layout(push_constant) uniform Push { PlaneContactConstants p; };
PLANE_CONTACT_CONSTANTS(SPECIALIZE)
#define VERTICES p.vertices
#define TRIANGLES p.triangles
#define CAPACITY p.capacity
#define PIECES p.pieces
#define GROUPS p.groups
#define MARGIN_M p.margin_m
#endif

layout(std430, binding = BIND_PIECES) readonly buffer Pieces { ContactPiece pieces[]; };
layout(std430, binding = BIND_POINTS) readonly buffer Points { PiecePoint points[]; };
layout(std430, binding = BIND_PIECE_BOXES) readonly buffer PieceBoxes { PieceBox boxes[]; };  // groups' after pieces'
layout(std430, binding = BIND_PLANES) readonly buffer Planes { PlaneShape half_spaces[]; };
#define THICKNESS_M uintBitsToFloat(THICKNESS_BITS)
#define SELF_FRICTION uintBitsToFloat(SELF_FRICTION_BITS)
layout(std430, binding = BIND_ELEMENTS) readonly buffer Elements { uvec4 elements[]; };  // vertices, number of them

// A kernel has those that it accesses; others are removed as it is compiled.
#ifdef PLANE_FRAME
#define STATE coherent
#else
#define STATE
#endif
layout(std430, binding = BIND_POSITIONS) STATE buffer Positions { vec4 x[]; };  // w: inverse mass in the lines
layout(std430, binding = BIND_VELOCITIES) STATE buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_REACHES) STATE buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_WAYS) STATE buffer Ways { float ways[]; };
layout(std430, binding = BIND_STARTS) STATE buffer Starts { vec4 starts[]; };  // at the substep's start; w: farthest it may go
layout(std430, binding = BIND_PREDICTED) STATE buffer Proposed { vec4 y[]; };  // w: inverse mass
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };  // first entry a vertex; 4 triangle + corner
layout(std430, binding = BIND_RANGES) STATE buffer Ranges { uvec4 ranges[]; };  // x: first pair, y: pairs
layout(std430, binding = BIND_PAIRS) STATE buffer Pairs { uvec4 pairs[]; };  // of the first of them, w: pairs that are asked
layout(std430, binding = BIND_PAIR_STATES) STATE buffer States { PairState states[]; };
layout(std430, binding = BIND_LEDGER) STATE buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) STATE buffer Faults { ContactFaults faults; };
layout(std430, binding = BIND_SELF_ORDER) readonly buffer SelfOrder { uint self_order[]; };
layout(std430, binding = BIND_SELF_BOXES) STATE buffer SelfBoxes { SelfBox self_boxes[]; };
layout(std430, binding = BIND_SELF_RANGES) STATE buffer SelfRanges { uvec4 self_ranges[]; };  // z: first near pair, w: near pairs
layout(std430, binding = BIND_SELF_PAIRS) STATE buffer SelfPairs { SelfPair self_pairs[]; };
layout(std430, binding = BIND_SELF_WAYS) STATE buffer SelfWays { vec4 self_ways[]; };
layout(std430, binding = BIND_SELF_NEAR) STATE buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_SELF_CONTACTS) STATE buffer SelfContacts { SelfContact self_contacts[]; };
layout(std430, binding = BIND_SELF_PUSHES) STATE buffer SelfPushes { SelfPush self_pushes[]; };
layout(std430, binding = BIND_TOUCHED) STATE buffer Touched { uint touched[]; };
layout(std430, binding = BIND_NEAR_BITS) STATE buffer NearBits { uint near_bits[]; };

#define CUT_BITS (GRIPS > 0u ? 2u : 1u)  // a cut divides the reach by two to the power of it: a greater reach, larger steps
const float kGuard_m = 2e-4;    // distance of planes from pieces
const float kRecovered = 0.1;   // share of the margin by which what is too near is let out a substep
const float kStandingShare = 0.75;  // of the margin: what edges and faces keep from what stands
const float kHold = 0.25;        // a push before the lines of so many margins doubles a vertex' mass in them
const float kRounding_m = 2e-7;  // of positions
const float kTiny = 1e-6;       // a weight below is none

// A bit a pair: whether it is near in this substep, and whether its contact proposes a correction in this turn.
#define NEAR_BITS 0u
#define PUSH_BITS (CAPACITY / 32u + 1u)
/// Of a range of pairs those that have a bit, `k`, in the list's order.
#define EACH_PAIR_OF(BITS, RANGE, BODY)                                                                                      \
  uvec2 of = (RANGE).xy;                                                                                                     \
  for (uint word = of.x / 32u, last = of.x + of.y; 32u * word < last; ++word) {                                              \
    uint bits = LOAD4(near_bits, (BITS) + word);                                                                             \
    if (32u * word < of.x) bits &= ~0u << of.x % 32u;                                                                        \
    if (last - 32u * word < 32u) bits &= (1u << last % 32u) - 1u;                                                            \
    for (; bits != 0u; bits &= bits - 1u) {                                                                                  \
      uint k = 32u * word + uint(findLSB(bits));                                                                             \
      BODY                                                                                                                   \
    }                                                                                                                        \
  }

// In `touched`, after the list of vertices that pairs may move: marks of a vertex.
#define OF_PAIRS(i) (VERTICES + (i))             // number of its pairs and its triangles' in this frame
#define PUSHED(i) (2u * VERTICES + (i))          // a contact proposes a correction in this turn
#define BEFORE_A_PLANE(i) (3u * VERTICES + (i))  // or so near that rounding cannot tell: it may be behind a plane

uint turn = 0u;  // 0: before the lines, with the predicted positions; 1 and on: rounds of responses after them
// Only what moves is responded to before the lines. What stands would take its friction from a way without the lines' pull: a strip
// that hangs over a cylinder slips at 5 % less overhang than friction holds (capstan-hold), and at 0.7 % less with one response.
#define FIRST_TURN (MOVING != 0u ? 0u : 1u)
uint substep_now = 0u;
float t_begin = 0.0, t_end = 1.0;  // of the substep, as fractions of the frame

/// Exact at the frame's end: there the next frame begins.
float time_of(uint substep) { return substep >= p.substeps ? 1.0 : float(substep) * p.substep_part; }
void begin_substep(uint substep) {
  substep_now = substep;
  t_begin = time_of(substep);
  t_end = time_of(substep + 1u);
}

/// How far the list of the cloth with itself moves in the frame [m].
#define drift_m() (SELF != 0u ? p.frame_s * length(vec3(ledger.drift[0], ledger.drift[1], ledger.drift[2])) : 0.0)

uint stride() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x; }
