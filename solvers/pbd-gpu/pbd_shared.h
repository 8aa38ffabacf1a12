// Structs that the host and the shaders share: vec4 and 4-byte scalars only, so that std430 and C++ agree.
#ifdef __cplusplus
#pragma once
#include <cstdint>
namespace clothbench::pbd_gpu {
struct vec4 {
  float x, y, z, w;
};
using uint = std::uint32_t;
struct uvec4 {
  uint x, y, z, w;
};
#endif

/// One distance constraint of `paper`.
struct DistanceConstraint {
  uint a, b;
  float rest_m;
  uint kind;
};

/// Push constants of every `paper` kernel.
struct PaperConstants {
  vec4 gravity;  // m/s^2
  uint particles;
  uint constraints;
  float h;          // step [s]
  float stiffness;  // k of PBD, 0..1
  float keep;       // velocity share that damping leaves, max(0, 1 - c h)
  uint unused0, unused1, unused2;
};

/// Push constants of the collision kernels of `paper`.
struct PaperContactConstants {
  uint particles;
  uint first, count;              // of the things every particle is tested against
  float margin, depth, friction;  // of a mesh
};

// What a scene asks of the line kernels of `xpbd`: bits of their constant FEATURES.
#define LINES_DAMPING 1u
#define LINES_BEND 2u
#define LINES_SHEAR 4u
#define LINES_ELASTIC 8u  // links have a compliance
#define LINES_LIMIT_SPEED 16u
#define LINES_FIRM 32u  // chains pulled taut between two held vertices
// LineConstants::turn
#define LINES_FIRST 1u
#define LINES_LAST 2u

/// Push constants of the line kernels of `xpbd`.
struct LineConstants {
  vec4 gravity_h;                   // g h [m/s]
  float h;                          // substep [s]
  float loss;                       // 1 - exp(-c h)
  float speed_limit;                // [m/s]
  float tether_stretch;             // 1 + slack
  float rest_u, rest_v, rest_d;     // rest lengths of links [m]
  float alpha_u, alpha_v, alpha_d;  // compliance over h^2 [1/kg] of links, inside
  float bend_u, bend_v;             // the same of bending
  float inverse_mass;               // of a vertex inside [1/kg]
  float firmness;                   // of chains that need it: least alpha over inverse mass
  uint bend_rounds_u, bend_rounds_v;
  uint first_substep, substeps;  // of this dispatch
  float substep_part;            // of a frame
  float frames_per_s;
  uint iterations;
  uint family, turn, iteration;  // of one pass
  uint patience;                 // looks at who has come to a barrier of the whole dispatch
  float per_h;                   // 1/h
};

/// A vertex of a chain and the link to the next entry; `rest` below 0: there is none.
struct ChainEntry {
  uint vertex;       // CHAIN_NOBODY: filling
  float rest;        // [m]
  float compliance;  // [m/N]
  float firmness;    // least compliance over h^2, as a share of the inverse mass
};
#define CHAIN_NOBODY 0xffffffffu

/// A vertex that holds another within `reach` [m]; none: reach below 0.
struct TetherEnd {
  uint to;
  float reach;
};

/// Where a family's entries are, in blocks of a workgroup each.
struct ChainRange {
  uint first_entry, blocks, rounds;
  uint unused0;
};

/// Push constants of the chain kernel of `xpbd`.
struct ChainConstants {
  vec4 gravity_h;     // g h [m/s]
  float h;            // substep [s]
  float loss;         // 1 - exp(-c h)
  float speed_limit;  // [m/s]
  float per_h;        // 1/h
  uint first_entry;   // of the family
  uint turn;          // LINES_FIRST
  uint rounds;        // of cyclic reduction: 2^rounds links or more are in its longest chain
  uint patience;      // looks at who has come to a barrier of the whole dispatch
  uint families;      // of a dispatch that takes all of them, `substeps` times
  uint substeps;
  uint unused0, unused1;
};

// Colliders. Lengths in metres, positions relative to the method's origin.

struct PlaneShape {
  vec4 normal;  // into free space; w: its dot product with any point of the plane
  float margin, friction;
  uint unused0, unused1;
};

struct SphereShape {
  vec4 center;
  float radius, margin, friction;
  uint unused0;
};

struct BoxShape {
  vec4 center;
  vec4 axis_x, axis_y, axis_z;  // orthonormal; w: half extent along it
  float margin, friction;
  uint unused0, unused1;
};

/// Segment at the frame's start (0) and end (1).
struct CapsuleShape {
  vec4 a0;  // w: radius
  vec4 b0;  // w: margin
  vec4 a1;  // w: radius + margin
  vec4 b1;  // w: friction
};

struct SkinVertex {
  vec4 rest, weights;
  uvec4 joints;
};

/// Affine map, rows of 3 x 4.
struct JointMatrix {
  vec4 row0, row1, row2;
};

struct SkinConstants {
  uint vertices;
};

struct GripVertex {
  vec4 from, to;  // at the frame's start and end
  uint vertex, held;
  float free_inverse_mass;
  uint unused0;
};

struct GripConstants {
  uint count;
  float fraction;     // of the frame's way
  float per_frame_s;  // 1 / frame [1/s]
  uint unused0;
};

/// Contact of `xpbd`: at most 16 neighbouring triangles of one mesh, and the box round their way through the frame.
struct MeshCluster {
  uint first, count;
  float margin, friction;
};

struct ClusterBox {
  vec4 low;  // w: how far any of their corners goes in the frame
  vec4 high;
};

struct BoxConstants {
  uint first, count;
};

/// Push constants of the contact kernels of `xpbd`.
struct ContactConstants {
  uint columns, rows;
  uint words;         // 32-bit words of clusters a vertex may touch
  float begin, part;  // where the substep begins and how long it is, as fractions of the frame
  float frames_per_s;
  float least_margin_m;   // margins below it count as this
  float border_margin_m;  // and those round an open border below this as this
  float reach_m;          // added to the way a vertex may go in the frame
  float sample_reach_m;   // farthest a sample lies from its first vertex
};

/// Push constants of the self-contact kernels of `xpbd`.
struct SelfConstants {
  uint columns, rows;
  uint side;  // of a block, in vertices
  uint block_columns, blocks;
  uint words;  // 32-bit words of blocks that a block may touch
  float thickness_m, friction;
  float h;        // substep [s]
  float reach_m;  // farther apart than this, and what they close in on each other, no two pieces concern each other
  float most_m;   // that a vertex is moved by one round of wishes
  uint unused0;
};

#ifdef __cplusplus
static_assert(sizeof(SelfConstants) == 48);
static_assert(sizeof(MeshCluster) == 16);
static_assert(sizeof(ClusterBox) == 32);
static_assert(sizeof(BoxConstants) == 8);
static_assert(sizeof(ContactConstants) == 40);
static_assert(sizeof(PlaneShape) == 32);
static_assert(sizeof(SphereShape) == 32);
static_assert(sizeof(BoxShape) == 80);
static_assert(sizeof(CapsuleShape) == 64);
static_assert(sizeof(SkinVertex) == 48);
static_assert(sizeof(JointMatrix) == 48);
static_assert(sizeof(GripVertex) == 48);
static_assert(sizeof(DistanceConstraint) == 16);
static_assert(sizeof(PaperConstants) == 48);
static_assert(sizeof(LineConstants) == 120);
static_assert(sizeof(ChainEntry) == 16);
static_assert(sizeof(TetherEnd) == 8);
static_assert(sizeof(ChainRange) == 16);
static_assert(sizeof(ChainConstants) == 64);
}  // namespace clothbench::pbd_gpu
#endif
