// Structs that the host and the shaders share. Members are vec4 and 4-byte
// scalars only, so that std430 and C++ have the same layout.
#ifdef __cplusplus
#pragma once
#include <cstdint>
#include <vector>
namespace clothbench::pbd_gpu {
struct vec4 {
  float x, y, z, w;
};
using uint = std::uint32_t;
struct uvec4 {
  uint x, y, z, w;
};
#endif

// Binding numbers of the storage buffers, the same in every kernel.
const int BIND_POSITIONS = 0, BIND_VELOCITIES = 1, BIND_POSITION_COMPENSATION = 2, BIND_VELOCITY_COMPENSATION = 3,
          BIND_REGULARISATION = 4, BIND_LINK_MULTIPLIERS = 5, BIND_HINGE_MULTIPLIERS = 6, BIND_BARRIER = 7,
          BIND_TIMED_OUT = 8, BIND_CHAIN_ENTRIES = 9, BIND_CHAIN_FAMILIES = 10, BIND_TETHER_ENDS = 11, BIND_WELDS = 12,
          BIND_GRIPS = 13, BIND_SKIN = 14, BIND_JOINTS = 15, BIND_PLANES = 16, BIND_SPHERES = 17, BIND_BOXES = 18,
          BIND_CAPSULES = 19, BIND_STANDING = 20, BIND_MOVING_START = 21, BIND_MOVING_END = 22, BIND_TRIANGLES = 23,
          BIND_MESH_VERTICES = 24, BIND_REACHES = 25, BIND_WAYS = 26, BIND_STARTS = 27, BIND_PREDICTED = 28,
          BIND_DELTAS = 29, BIND_CONSTRAINTS = 30, BIND_POINT_SOURCES = 31, BIND_POINTS = 32, BIND_PIECES = 33,
          BIND_PIECE_BOXES = 34, BIND_ELEMENTS = 35, BIND_FANS = 36, BIND_RANGES = 37, BIND_PAIRS = 38,
          BIND_PAIR_STATES = 39, BIND_LEDGER = 40, BIND_FAULTS = 41, BIND_COUNTER = 42, BIND_LAST_POSITIONS = 43,
          BIND_LAST_VELOCITIES = 44, BIND_SELF_ORDER = 45, BIND_SELF_BOXES = 46, BIND_SELF_RANGES = 47,
          BIND_SELF_PAIRS = 48, BIND_SELF_WAYS = 49, BIND_SELF_NEAR = 50, BIND_SELF_CONTACTS = 51,
          BIND_SELF_PUSHES = 52, BIND_TOUCHED = 53, BIND_NEAR_BITS = 54, BIND_BENDING_SLICES = 55,
          BIND_BENDING_ENTRIES = 56, BIND_BENDING_STEPS = 57, BIND_SHIFTS = 58, BIND_LINK_CREEP = 59,
          BIND_MEMBRANE_SLICES = 60, BIND_MEMBRANE_CORNERS = 61, BIND_COUNT = 62;

// Specialization constants: C(number, type, name, default); number 0 is local_size_x.

// Line kernels of `xpbd`. LANES: threads a chain, a power of two. K: vertices a thread, an even number if the scene
// has bending. THREADS: of a workgroup. FEATURES: LINES_... TETHERS: number of rectangles of pinned vertices; TETHER_n
// and TETHER_n_LAST: column and row << 16 of the first and last vertex. SUBGROUP: threads that exchange by shuffles.
// BESIDE: neighbouring chains whose threads alternate, so that columns too are read by whole sectors. EXACT: all
// vertices of all threads are on chains. REGULAR: bit mask of the chains of each family that need regularisation.
// PERSISTENT: all workgroups run at once and synchronise by barriers.
// clang-format off
#define LINE_CONSTANTS(C) \
  C(1, uint, LANES, 8u) C(2, uint, K, 4u) C(3, uint, COLUMNS, 2u) C(4, uint, ROWS, 2u) C(5, uint, THREADS, 64u) \
  C(6, uint, FEATURES, 0u) C(7, uint, TETHERS, 0u) C(8, uint, TETHER_0, 0u) C(9, uint, TETHER_0_LAST, 0u) \
  C(10, uint, TETHER_1, 0u) C(11, uint, TETHER_1_LAST, 0u) C(12, uint, TETHER_2, 0u) C(13, uint, TETHER_2_LAST, 0u) \
  C(14, uint, TETHER_3, 0u) C(15, uint, TETHER_3_LAST, 0u) C(16, uint, SUBGROUP, 1u) C(17, uint, BESIDE, 1u) \
  C(18, bool, EXACT, false) C(19, uint, GRIPS, 0u) C(20, uint, REGULAR_0, 0u) C(21, uint, REGULAR_1, 0u) \
  C(22, uint, REGULAR_2, 0u) C(23, uint, REGULAR_3, 0u) C(24, bool, PERSISTENT, false)
// Chain kernel of `xpbd`. TETHERS: entries a vertex.
#define CHAIN_CONSTANTS(C) \
  C(1, uint, THREADS, 64u) C(2, uint, FEATURES, 0u) C(3, uint, TETHERS, 0u) C(4, bool, PERSISTENT, false)
// Plane contact of `xpbd`. PLANES: half-spaces. GRIPS: vertices that hands may hold. MOST_POINTS: of a piece. MOVING: 1
// if any piece moves. SELF: 1 if the cloth touches itself, and then SELF_CAPACITY, NEAR_CAPACITY, TOUCHING_CAPACITY:
// pairs, near pairs and those with contacts that its lists have place for; THICKNESS_BITS, SELF_FRICTION_BITS: floats.
// TEAM: lanes that share a vertex.
#define PLANE_CONTACT_CONSTANTS(C) \
  C(1, uint, PLANES, 0u) C(2, uint, GRIPS, 0u) C(3, uint, MOST_POINTS, 3u) C(4, uint, MOVING, 0u) C(5, uint, SELF, 0u) \
  C(6, uint, SELF_CAPACITY, 0u) C(7, uint, NEAR_CAPACITY, 0u) C(8, uint, TOUCHING_CAPACITY, 0u) \
  C(9, uint, THICKNESS_BITS, 0u) C(10, uint, SELF_FRICTION_BITS, 0u) C(11, uint, TEAM, 1u) C(12, bool, AGAIN, false)
// The same, for the kernel of a whole frame, beside LINE_CONSTANTS. MARGIN_BITS: of the greatest margin, a float.
#define PLANE_FRAME_CONSTANTS(C) \
  C(25, uint, PLANES, 0u) C(26, uint, MOST_POINTS, 3u) C(27, uint, MOVING, 0u) C(28, uint, VERTICES, 4u) \
  C(29, uint, TRIANGLES, 2u) C(30, uint, CAPACITY, 0u) C(31, uint, PIECES, 0u) C(32, uint, GROUPS, 0u) \
  C(33, uint, MARGIN_BITS, 0u) C(34, uint, SELF, 0u) C(35, uint, SELF_CAPACITY, 0u) C(36, uint, NEAR_CAPACITY, 0u) \
  C(37, uint, TOUCHING_CAPACITY, 0u) C(38, uint, THICKNESS_BITS, 0u) C(39, uint, SELF_FRICTION_BITS, 0u) C(40, uint, TEAM, 1u)
// clang-format on
// Kernels of `paper`. NATIVE: float atomics; the count is then a float too.
#define PAPER_CONSTANTS(C) C(1, uint, FRICTION, 0u) C(2, uint, NATIVE, 0u)
#ifdef __cplusplus
#define CLOTHBENCH_MEMBER(number, type, name, standard) uint name = standard;
#define CLOTHBENCH_PUT(number, type, name, standard) all.at(number) = name;
#define CLOTHBENCH_SPECIALIZATION(Name, LIST) \
  struct Name {                               \
    LIST(CLOTHBENCH_MEMBER)                   \
    std::vector<uint> by_number() const {     \
      std::vector<uint> all(41);              \
      LIST(CLOTHBENCH_PUT)                    \
      return all;                             \
    }                                         \
  };
CLOTHBENCH_SPECIALIZATION(LineSpecialization, LINE_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(ChainSpecialization, CHAIN_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(PlaneContactSpecialization, PLANE_CONTACT_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(PlaneFrameSpecialization, PLANE_FRAME_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(PaperSpecialization, PAPER_CONSTANTS)
#undef CLOTHBENCH_SPECIALIZATION
#undef CLOTHBENCH_PUT
#undef CLOTHBENCH_MEMBER
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
  float keep;       // share of velocity left by damping, max(0, 1 - c h)
  uint unused0, unused1, unused2;
};

/// Push constants of the collision kernels of `paper`.
struct PaperContactConstants {
  uint particles;
  uint first, count;              // of the shapes or triangles that every particle is tested against
  float margin, depth, friction;  // of a mesh
};

// Features that a scene needs of the line kernels of `xpbd`: bits of their
// constant FEATURES.
#define LINES_DAMPING 1u
#define LINES_BEND 2u
#define LINES_SHEAR 4u
#define LINES_ELASTIC 8u  // links have a compliance
#define LINES_LIMIT_SPEED 16u
#define LINES_FIRM 32u      // chains pulled taut between two held vertices
#define LINES_PREDICT 64u   // BDF2; else backward Euler
#define LINES_TENSION 128u  // implicit tension

/// Push constants of the line kernels of `xpbd`.
struct LineConstants {
  vec4 gravity_h;                // g h keep [m/s]; w: tether_spread_m
  float h;                       // implicit step, h' of TimeStep [s]
  float loss;                    // of velocity by damping
  float speed_limit;             // [m/s]
  float tether_stretch;          // 1 + slack
  float rest_u, rest_v, rest_d;  // rest lengths of links [m]
  float alpha_u, alpha_v,
      alpha_d;           // compliance over h^2 keep [1/kg] of inner links
  float bend_u, bend_v;  // the same for bending
  float inverse_mass;    // of an inner vertex [1/kg]
  float regularisation;  // least ratio of alpha to inverse mass, for chains that need it
  uint bend_rounds_u, bend_rounds_v;
  uint first_substep, substeps;  // of this dispatch
  float substep_part;            // of a frame
  float frames_per_s;
  uint iterations;
  uint first_pass, passes;  // of this dispatch; each substep has a pass an
                            // iteration and family. Of plane_frame: PLANE_FRAME_LISTED, or 0
  uint timeout_polls;       // polls of a barrier over the whole dispatch before it times out
  float per_h;              // 1/h
  float carry;              // share of the last substep's change that is predicted
  float frame_s;            // with contact by planes, as is reach_m
  float reach_m;            // of a vertex at rest
};

/// A vertex of a chain and its link to the next entry; no link if `rest` is
/// below 0.
struct ChainEntry {
  uint vertex;           // CHAIN_NO_VERTEX: padding
  float rest;            // [m]
  float compliance;      // [m/N]
  float regularisation;  // least ratio of compliance over h^2 to inverse mass
};
#define CHAIN_NO_VERTEX 0xffffffffu

/// A vertex `to` that keeps another within `reach` [m]; reach below 0: no tether.
struct TetherEnd {
  uint to;
  float reach;
};

/// Range of a family's entries, in blocks of a workgroup each.
struct ChainRange {
  uint first_entry, blocks, rounds;
  uint unused0;
};

/// Rows of a slice of the bending matrix of a mesh: those of a subgroup or a part of one.
#define BENDING_ROWS 32u
/// Entry of that matrix, beside the diagonal.
struct BendingEntry {
  uint column;
  float stiffness;  // [N/m]
};
/// Entry j of the slice's row r is number first + BENDING_ROWS j + r, j below width.
struct BendingSlice {
  uint first, width;
};

/// A triangle at one of its corners, from which edge 0 goes to `a`, 1 on to `b` and 2 back. Its energy is
/// 1/2 sum K_jk d_j d_k in the elongations d of its edges. Entries lie as those of bending do; `a` is CHAIN_NO_VERTEX
/// in padding.
struct MembraneCorner {
  uint a, b;
  float rest_0, rest_1, rest_2;        // lengths [m]
  float along_0, along_1, along_2;     // K_00, K_11, K_22 [N/m]
  float cross_01, cross_12, cross_20;  // K_01, K_12, K_20 [N/m]
  float most;                          // of the trace of the triangle's matrix [N/m]
};

/// Push constants of the chain kernel of `xpbd`.
struct ChainConstants {
  vec4 gravity_h;      // g h keep [m/s]; w: tether_spread_m
  float h;             // implicit step, h' of TimeStep [s]
  float loss;          // of velocity by damping
  float speed_limit;   // [m/s]
  float per_h;         // 1/h
  uint first_entry;    // of the family, if a dispatch solves only one
  uint rounds;         // of cyclic reduction: 2^rounds is at least the number of links of
                       // its longest chain
  uint timeout_polls;  // polls of a barrier over the whole dispatch before it times out
  uint families;
  uint first_pass, passes;  // of this dispatch; each substep has a pass a family
  float carry;              // share of the last substep's change that is predicted
  float per_keep;           // 1 / keep
  uint bending_iterations;  // passes a substep, after one that integrates and before those of families; 0: no bending
  uint vertices;
  float bending_step;    // h^2 keep [s^2]
  float bending_gain;    // of the first iteration, 2 / (2 + m), m the greatest eigenvalue of h^2 keep M^-1 K
  float bending_spread;  // (m / (2 + m))^2 / 4
  uint again;            // 1: families once more, from where they are
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

/// Segment from a to b at the frame's start (0) and end (1).
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
  float fraction;     // of the path through the frame
  float per_frame_s;  // 1 / frame [1/s]
  uint unused0;
};

#include "plane_shared.h"

#ifdef __cplusplus
static_assert(sizeof(PlaneShape) == 32);
static_assert(sizeof(SphereShape) == 32);
static_assert(sizeof(BoxShape) == 80);
static_assert(sizeof(CapsuleShape) == 64);
static_assert(sizeof(SkinVertex) == 48);
static_assert(sizeof(JointMatrix) == 48);
static_assert(sizeof(GripVertex) == 48);
static_assert(sizeof(DistanceConstraint) == 16);
static_assert(sizeof(PaperConstants) == 48);
static_assert(sizeof(LineConstants) == 128);
static_assert(sizeof(ChainEntry) == 16);
static_assert(sizeof(TetherEnd) == 8);
static_assert(sizeof(ChainRange) == 16);
static_assert(sizeof(MembraneCorner) == 48);
static_assert(sizeof(ChainConstants) == 88);
}  // namespace clothbench::pbd_gpu
#endif
