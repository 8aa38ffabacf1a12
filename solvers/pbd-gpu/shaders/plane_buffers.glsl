// What the kernels of plane contact share: the list of pairs, and what is known of elements and pieces. Elements are the
// cloth's triangles, then its vertices; each has a range of pairs, in the order of pieces.
layout(push_constant) uniform Push { PlaneContactConstants p; };
PLANE_CONTACT_CONSTANTS(SPECIALIZE)

layout(std430, binding = BIND_PIECES) readonly buffer Pieces { ContactPiece pieces[]; };
layout(std430, binding = BIND_POINTS) readonly buffer Points { PiecePoint points[]; };
layout(std430, binding = BIND_PIECE_BOXES) readonly buffer PieceBoxes { ClusterBox boxes[]; };  // groups' after pieces'
layout(std430, binding = BIND_PLANES) readonly buffer Planes { PlaneShape half_spaces[]; };
layout(std430, binding = BIND_ELEMENTS) readonly buffer Elements { uvec4 elements[]; };  // vertices, number of them
layout(std430, binding = BIND_RANGES) readonly buffer Ranges { uvec4 ranges[]; };        // x: first pair, y: pairs

const float kGuard_m = 2e-4;    // distance of planes from pieces
const float kRecovered = 0.1;   // share of the margin by which what is too near is let out a substep
const float kStandingShare = 0.75;  // of the margin: what edges and faces keep from what stands
const float kHold_m = 1e-3;     // a push before the lines of so much doubles a vertex' mass in them
const float kRounding_m = 2e-7;  // of positions
const float kTiny = 1e-6;       // a weight below is none

uint stride() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x; }
