// Part of pbd_shared.h, which includes it: what the host and the kernels of contact by planes share.

// Plane contact of `xpbd`: PLANES.md.

/// A convex piece of a collider: the hull of `count` points, grown by `radius`.
struct ContactPiece {
  uint first, count;
  float radius, margin, friction;
  uint moves;
  uint first_source;  // of its points if it moves; else of the next piece that does
  uint unused0;
};

/// A point of a piece at the frame's start and end; w unused.
struct PiecePoint {
  vec4 start, end;
};

/// Of a piece, round its way through the frame, its radius and its margin; or of a group of pieces.
struct PieceBox {
  vec4 low;  // w: greatest displacement of any of their points in the frame
  vec4 high;
};

/// Where a point of a moving piece comes from: vertex `index` of the moving meshes, or end `index` % 2 of capsule
/// `index` / 2 if `capsule` is 1.
struct PointSource {
  uint point, index, capsule, piece;
};

/// What is known of one pair of an element of the cloth (a triangle or a vertex) and a piece.
struct PairState {
  vec4 normal;   // from the piece to the cloth; w: lower bound of the pair's distance [m]
  vec4 weights;  // of the element's vertices at its nearest point; w: dot(normal, piece's nearest point at the end)
  vec4 way;      // of the piece's nearest point in the substep; w: distance to keep. Then the plane, w: offset
  vec4 push;     // proposed correction of the contact over its inverse mass; w: its part that is no velocity. Then
                 // multipliers
};

#define PAIR_LOOKED 1u   // near enough to be asked in this substep
#define PAIR_NEAREST 2u  // has a contact at its nearest points
#define PAIR_PLANE 4u    // has a plane
#define PAIR_LEVELS 4u   // reaches tried: each half (with grips a quarter) of the one before

/// Of the frame, on the device.
struct ContactLedger {
  uint pairs;                        // in the list
  float reach;                       // share of the vertices' reach that the list is made for
  float carried;                     // greatest displacement of a point of any piece in the frame [m]
  uint asked[2];                     // pairs near in this substep, before and after the lines
  uint cloth_low[3], cloth_high[3];  // box that the cloth may be in, in the order of box_bits.glsl
  float self_reach;                  // as reach, of the list of the cloth with itself
  uint self_near;                    // its pairs near in this substep
  uint self_touching;                // those of them that have contacts
  uint touched_vertices;             // vertices with pairs of their own or of their triangles
  uint far;                          // 1: the frame was done without contact (plane_far.glsl, plane_frame.comp)
  uint meets;                        // 1: the cloth meets a piece in this frame, or might if it had no contact
  uint farthest;                     // greatest displacement of a vertex in a frame [m], the bits of a float: this one
                                     // at its end; until its list is made, the last one; 0: there was none
  uint counted[PAIR_LEVELS];         // pairs at each share of the reaches
  float drift[3];                    // velocity [m/s] that the list of the cloth with itself moves along with
  uint unused0[3];
};

#define PLANE_FRAME_LISTED 1u  // LineConstants::first_pass where a dispatch before has made the frame's list; else 0

/// Of a triangle of the cloth, by half of the thickness larger: at rest, and grown by its vertices' reaches.
struct SelfBox {
  vec4 low_0, high_0, low_1, high_1;  // w unused
};

/// A pair of triangles of the cloth, listed with each of the two.
struct SelfPair {
  uint other;
  float bound;  // lower bound of their distance [m]
};

/// A pair of triangles that is near in this substep, as one of the two has it.
struct SelfNear {
  uint own, other;
  uint link;         // its SelfPair; once asked, where its contacts are
  uint marks;        // bit mask of its contacts, and SELF_PLANE if it has a plane
  vec4 plane;        // normal, towards the own triangle; w: offset
  vec4 multipliers;  // of the own triangle's vertices
};

/// Of a near pair: the nearest points of the two triangles, then each vertex of the one and the other triangle, with
/// the triangle of the lower number first.
struct SelfContact {
  vec4 normal;         // towards the first triangle; w: distance to keep [m]
  vec4 first, second;  // weights of the vertices at the nearest points; w unused
};
#define SELF_CONTACTS 7u
#define SELF_PLANE 128u

/// What a near pair proposes for a vertex: sums weighted by length.
struct SelfPush {
  vec4 all;     // w: sum of lengths
  vec4 moving;  // its part that is velocity
};

/// Counts since loading or reset; all are 0 unless contact failed. And what the next frame's substeps depend on.
struct ContactFaults {
  uint without_place;  // vertices that were not before all their planes at a substep's end
  uint inside;         // pairs that touch at a substep's start
  uint dropped;        // pairs that the list had no place for
  uint returned;       // no fault: vertices that went back to a free place, for no nearer one was found
  uint farthest;       // greatest displacement of a vertex in the last frame [m], the bits of a float
  uint unused0[3];
};

/// Push constants of the kernels of plane contact.
struct PlaneContactConstants {
  vec4 gravity_h;  // g h [m/s]
  uint vertices, triangles;
  uint capacity;                 // pairs that the list has place for
  uint pieces, groups;           // groups of PIECES_A_GROUP neighbouring pieces have a box each
  uint turn;                     // of responses: 0 before the lines, with the predicted positions; 1 and on after them
  uint first_substep, substeps;  // this substep; those of the frame
  float substep_part;            // of the frame
  float h, per_h;                // of the substep [s], [1/s]
  float loss;                    // 1 - exp(-c h)
  float frame_s;
  float reach_m;   // of a vertex at rest
  float margin_m;  // greatest margin of any collider
  uint unused0;
};
#define PIECES_A_GROUP 16u

#ifdef __cplusplus
static_assert(sizeof(ContactPiece) == 32);
static_assert(sizeof(PiecePoint) == 32);
static_assert(sizeof(PieceBox) == 32);
static_assert(sizeof(PointSource) == 16);
static_assert(sizeof(PairState) == 64);
static_assert(sizeof(ContactLedger) == 112);
static_assert(sizeof(SelfBox) == 64);
static_assert(sizeof(SelfPair) == 8);
static_assert(sizeof(SelfNear) == 48);
static_assert(sizeof(SelfContact) == 48);
static_assert(sizeof(SelfPush) == 32);
static_assert(sizeof(ContactFaults) == 32);
static_assert(sizeof(PlaneContactConstants) == 80);
#endif
