// Structs that the host and the shaders share. All members are 4-byte scalars, or vectors of four that are aligned as
// in std430, so that std430 and C++ have the same layout.
#ifdef __cplusplus
#pragma once
#include <cstdint>
#include <vector>
namespace clothbench::pbd_gpu {
struct alignas(16) vec4 {
  float x, y, z, w;
};
using uint = std::uint32_t;
struct alignas(16) uvec4 {
  uint x, y, z, w;
};
#endif

// Binding numbers of the storage buffers, the same in every kernel.
const int BIND_POSITIONS = 0, BIND_VELOCITIES = 1, BIND_POSITION_COMPENSATION = 2, BIND_VELOCITY_COMPENSATION = 3,
          BIND_REGULARISATION = 4, BIND_BARRIER = 5, BIND_TIMED_OUT = 6, BIND_CHAIN_ENTRIES = 7, BIND_CHAIN_COLOURS = 8,
          BIND_TETHER_ENDS = 9, BIND_WELDS = 10, BIND_GRIPS = 11, BIND_SKIN = 12, BIND_JOINTS = 13, BIND_PLANES = 14,
          BIND_SPHERES = 15, BIND_BOXES = 16, BIND_CAPSULES = 17, BIND_STATIC_VERTICES = 18, BIND_KINEMATIC_START = 19,
          BIND_KINEMATIC_END = 20, BIND_TRIANGLES = 21, BIND_MESH_VERTICES = 22, BIND_MOTION_BOUNDS = 23,
          BIND_VERTEX_DISPLACEMENTS = 24, BIND_STARTS = 25, BIND_PREDICTED = 26, BIND_DELTAS = 27,
          BIND_CONSTRAINTS = 28, BIND_POINT_SOURCES = 29, BIND_POINTS = 30, BIND_SHAPES = 31, BIND_SHAPE_AABBS = 32,
          BIND_PRIMITIVES = 33, BIND_VERTEX_TRIANGLES = 34, BIND_RANGES = 35, BIND_PAIRS = 36, BIND_PAIR_STATES = 37,
          BIND_FRAME_STATE = 38, BIND_DIAGNOSTICS = 39, BIND_COUNTER = 40, BIND_LAST_POSITIONS = 41,
          BIND_LAST_VELOCITIES = 42, BIND_SELF_ORDER = 43, BIND_SELF_AABBS = 44, BIND_SELF_RANGES = 45,
          BIND_SELF_PAIRS = 46, BIND_TRIANGLE_MAX_DISPLACEMENTS = 47, BIND_SELF_ACTIVE = 48, BIND_SELF_CONTACTS = 49,
          BIND_SELF_CORRECTIONS = 50, BIND_TOUCHED = 51, BIND_ACTIVE_BITS = 52, BIND_BENDING_SLICES = 53,
          BIND_BENDING_ENTRIES = 54, BIND_BENDING_STEPS = 55, BIND_SHIFTS = 56, BIND_LINK_CREEP = 57,
          BIND_MEMBRANE_SLICES = 58, BIND_MEMBRANE_CORNERS = 59, BIND_SLIP = 60, BIND_SELF_BOUNDS = 61,
          BIND_SELF_SUPERGROUPS = 62, BIND_LINKS = 63, BIND_COUNT = 64;

// Specialization constants: C(number, type, name, default); number 0 is local_size_x.

// Line kernels of `xpbd`. LANES: threads per chain, a power of two. K: vertices per thread, an even number if the scene
// has bending. THREADS: per workgroup. FEATURES: bit mask of LINES_... TETHERS: number of rectangles of pinned
// vertices; TETHER_n, TETHER_n_LAST: column | row << 16 of their first and last vertex. SUBGROUP: number of threads
// that can shuffle values. BESIDE: number of neighbouring chains with interleaved threads, for contiguous loads of
// columns. EXACT: no thread is padding. PERSISTENT: all workgroups run at once and synchronise by barriers.
// clang-format off
#define LINE_CONSTANTS(C) \
  C(1, uint, LANES, 8u) C(2, uint, K, 4u) C(3, uint, COLUMNS, 2u) C(4, uint, ROWS, 2u) C(5, uint, THREADS, 64u) \
  C(6, uint, FEATURES, 0u) C(7, uint, TETHERS, 0u) C(8, uint, TETHER_0, 0u) C(9, uint, TETHER_0_LAST, 0u) \
  C(10, uint, TETHER_1, 0u) C(11, uint, TETHER_1_LAST, 0u) C(12, uint, TETHER_2, 0u) C(13, uint, TETHER_2_LAST, 0u) \
  C(14, uint, TETHER_3, 0u) C(15, uint, TETHER_3_LAST, 0u) C(16, uint, SUBGROUP, 1u) C(17, uint, BESIDE, 1u) \
  C(18, bool, EXACT, false) C(19, uint, GRIPS, 0u) C(24, bool, PERSISTENT, false)
// Chain kernel of `xpbd`. TETHERS: `tether_ends` per vertex.
#define CHAIN_CONSTANTS(C) \
  C(1, uint, THREADS, 64u) C(2, uint, FEATURES, 0u) C(3, uint, TETHERS, 0u) C(4, bool, PERSISTENT, false)
// Contact of `xpbd`: its passes and the fused frame. PLANES: number of half-spaces. MAX_POINTS: of a convex shape.
// HAS_KINEMATIC: 1 if any convex shape is kinematic. CAPACITY: of the list of candidate pairs. GROUPS: groups of
// SHAPES_PER_GROUP neighbouring convex shapes, each with a box. MARGIN_BITS: the maximum margin [m], as the bits of a
// float; likewise MIN_SEPARATION_BITS: of planes from shapes and layers, and ROUNDING_BITS: error of positions.
// LANES_PER_VERTEX: lanes that process a vertex together. ROUNDS: of response after the constraint solve.
#define CONTACT_CONSTANTS(C) \
  C(25, uint, PLANES, 0u) C(26, uint, MAX_POINTS, 3u) C(27, uint, HAS_KINEMATIC, 0u) C(28, uint, VERTICES, 4u) \
  C(29, uint, TRIANGLES, 2u) C(30, uint, CAPACITY, 0u) C(31, uint, SHAPES, 0u) C(32, uint, GROUPS, 0u) \
  C(20, uint, MIN_SEPARATION_BITS, 0u) C(21, uint, ROUNDING_BITS, 0u) C(33, uint, MARGIN_BITS, 0u) \
  C(34, uint, LANES_PER_VERTEX, 1u) C(22, uint, ROUNDS, 1u)
// Only if each pass has its own kernel. SELF: 1 with self-contact; then SELF_CAPACITY, ACTIVE_CAPACITY,
// CONTACT_CAPACITY: capacities of its lists of candidate pairs, active pairs and pairs with contacts; THICKNESS_BITS,
// SELF_FRICTION_BITS: bits of floats. GRIPS: attachable vertices; the same constant as in LINE_CONSTANTS.
#define CONTACT_PASS_CONSTANTS(C) \
  C(1, uint, SELF, 0u) C(2, uint, SELF_CAPACITY, 0u) C(3, uint, ACTIVE_CAPACITY, 0u) C(4, uint, CONTACT_CAPACITY, 0u) \
  C(5, uint, THICKNESS_BITS, 0u) C(6, uint, SELF_FRICTION_BITS, 0u) C(7, bool, SECOND_SOLVE, false) \
  C(19, uint, GRIPS, 0u)
// clang-format on
// Collision kernels of `paper`.
// FRICTION: 0: none; 1: reduces the tangential displacement; 2: reduces the tangential velocity.
#define PAPER_CONSTANTS(C) C(1, uint, FRICTION, 0u) C(2, uint, PROJECT_PREVIOUS, 0u) C(3, uint, OPPOSITE_NORMALS, 0u)
#ifdef __cplusplus
#define CLOTHBENCH_MEMBER(number, type, name, standard) uint name = standard;
#define CLOTHBENCH_PUT(number, type, name, standard) all.at(number) = name;
#define CLOTHBENCH_SPECIALIZATION(Name, LIST) \
  struct Name {                               \
    LIST(CLOTHBENCH_MEMBER)                   \
    std::vector<uint> by_number() const {     \
      std::vector<uint> all(35);              \
      LIST(CLOTHBENCH_PUT)                    \
      return all;                             \
    }                                         \
  };
CLOTHBENCH_SPECIALIZATION(LineSpecialization, LINE_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(ChainSpecialization, CHAIN_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(ContactSpecialization, CONTACT_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(ContactPassSpecialization, CONTACT_PASS_CONSTANTS)
CLOTHBENCH_SPECIALIZATION(PaperSpecialization, PAPER_CONSTANTS)
/// The constants of two lists that have no number in common.
template <class First, class Second>
std::vector<uint> joined(const First& first, const Second& second) {
  std::vector<uint> all = first.by_number();
  const std::vector<uint> more = second.by_number();
  for (std::size_t k = 0; k < all.size(); ++k) all[k] |= more[k];
  return all;
}
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
  float h;           // step [s]
  float stiffness;   // k of PBD, 0..1
  float keep;        // fraction of velocity left by damping, max(0, 1 - c h)
  float relaxation;  // factor of the averaged corrections; above 1: over-relaxation
};

/// Push constants of the collision kernels of `paper`.
struct PaperContactConstants {
  uint particles;
  uint first, count;              // range of shapes or triangles that every particle is tested against
  float margin, depth, friction;  // of a mesh
  uint layer;                     // number of particles per layer
};

// Features that the line kernels of `xpbd` need for a scene: bits of the constant FEATURES.
#define LINES_BEND 2u
#define LINES_SHEAR 4u
#define LINES_ELASTIC 8u       // links have a compliance
#define LINES_REGULARISED 32u  // some chains are over-constrained between two held vertices
#define LINES_BDF2 64u         // BDF2; otherwise backward Euler
#define LINES_TENSION 128u     // implicit tension
#define LINES_SPLITTING 256u   // the splitting error is corrected

/// Push constants of the line kernels of `xpbd`.
struct LineConstants {
  vec4 gravity_h;                   // g h force_scale [m/s] (TimeStep); w: tether_spread_m
  float h;                          // implicit step, h' of TimeStep [s]
  float damping_fraction;           // fraction of velocity that damping removes
  float tether_stretch;             // 1 + slack
  float rest_u, rest_v, rest_d;     // rest lengths of links [m]
  float alpha_u, alpha_v, alpha_d;  // compliance / (h^2 force_scale) of inner links [1/kg]
  float bend_u, bend_v;             // bending compliance / (h^2 force_scale) [1/kg]
  float inverse_mass;               // of an inner vertex [1/kg]
  uint bend_rounds_u, bend_rounds_v;
  uint first_substep, substeps;  // of this dispatch
  float substep_part;            // length of a substep as a fraction of the frame
  float frames_per_s;
  uint first_pass, passes;  // of this dispatch; one per colour. In fused_frame, first_pass is BROAD_PHASE_DONE or 0
  uint timeout_polls;       // polls of a barrier over the whole dispatch before it times out
  float per_h;              // 1/h
  float history_weight;     // fraction of the last substep's change that is predicted
  float kick_scale;         // of TimeStep, in the first substep; in fused_frame computed from ContactFrameState::last_h
  float frame_s;            // frame_s and bound_m of ContactConstants, only in fused_frame and its contact-free kernel
  float bound_m;
};

/// A vertex of a chain and its link to the next entry; no link if `rest` is below 0.
struct ChainEntry {
  uint vertex;           // CHAIN_NO_VERTEX: padding
  float rest;            // [m]
  float compliance;      // [m/N]
  float regularisation;  // minimum ratio of compliance / h^2 to inverse mass
};
#define CHAIN_NO_VERTEX 0xffffffffu

/// A vertex `to` that keeps another within `reach` [m]; reach below 0: no tether.
struct TetherEnd {
  uint to;
  float reach;
};

/// Range of a colour's entries. A block contains the entries of one workgroup.
struct ChainRange {
  uint first_entry, blocks, rounds;
};

/// Rows per slice of the bending matrix of a mesh.
#define BENDING_ROWS 32u
/// Off-diagonal entry of the bending matrix.
struct BendingEntry {
  uint column;
  float stiffness;  // [N/m]
};
/// Entry j of the slice's row r has index first + BENDING_ROWS j + r; j < width.
struct BendingSlice {
  uint first, width;
};

/// A triangle seen from one of its corners: edge 0 leads to `a`, edge 1 from `a` to `b`, edge 2 back. Its energy is
/// 1/2 sum K_jk d_j d_k in the elongations d of its edges. Entries are stored in slices, like the bending matrix; in
/// padding, `a` is CHAIN_NO_VERTEX.
struct MembraneCorner {
  uint a, b;
  float rest_0, rest_1, rest_2;        // lengths [m]
  float along_0, along_1, along_2;     // K_00, K_11, K_22 [N/m]
  float cross_01, cross_12, cross_20;  // K_01, K_12, K_20 [N/m]
  float max_trace;                     // maximum of the trace of the deformed triangle's matrix [N/m]
};

/// Push constants of the chain kernel of `xpbd`.
struct ChainConstants {
  vec4 gravity_h;          // g h force_scale [m/s] (TimeStep); w: tether_spread_m
  float h;                 // implicit step, h' of TimeStep [s]
  float damping_fraction;  // fraction of velocity that damping removes
  float per_h;             // 1/h
  uint first_entry;        // of the colour, if a dispatch solves only one
  uint rounds;             // of cyclic reduction: 2^rounds is at least the number of links of the longest chain
  uint timeout_polls;      // polls of a barrier over the whole dispatch before it times out
  uint colours;
  uint first_pass, passes;  // of this dispatch; each substep has one pass per colour
  float history_weight;     // fraction of the last substep's change that is predicted
  float per_force_scale;    // 1 / force_scale
  uint bending_iterations;  // passes per substep between the prediction and the colours; 0: no bending
  uint vertices;
  float bending_step;    // h^2 force_scale [s^2]
  float bending_gain;    // 2 / (2 + m), m: upper bound of the eigenvalues of h^2 force_scale M^-1 K
  float bending_spread;  // (m / (2 + m))^2 / 4
  uint again;            // 1: only solve the colours, from the current positions
};

// Colliders. Lengths in metres, positions relative to the solver's origin.

struct PlaneShape {
  vec4 normal;  // unit normal into free space; w: its dot product with any point of the plane
  float margin, friction;
};

struct SphereShape {
  vec4 center;
  float radius, margin, friction;
};

struct BoxShape {
  vec4 center;
  vec4 axis_x, axis_y, axis_z;  // orthonormal; w: half extent along it
  float margin, friction;
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

/// Rows of the 3 x 4 matrix of an affine map.
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
};

struct GripConstants {
  uint count;
  float fraction;     // of the path through the frame
  float per_frame_s;  // 1 / frame [1/s]
};

#include "xpbd/contact/contact_types.h"

#ifdef __cplusplus
}  // namespace clothbench::pbd_gpu
#endif
