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
