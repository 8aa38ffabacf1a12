// Structs that the host and the shaders share: vec4 and 4-byte scalars only, so that std430 and C++ agree.
#ifdef __cplusplus
#pragma once
#include <cstdint>
namespace clothbench::pbd_gpu {
struct vec4 {
  float x, y, z, w;
};
using uint = std::uint32_t;
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

/// Push constants of every `xpbd` kernel. A family of constraints joins grid vertex (i, j) with (i + di, j + dj) (and,
/// for bending, (i + 2 di, j + 2 dj)); a colour takes every `stride`-th line, so that no two share a vertex.
struct XpbdConstants {
  vec4 gravity_h;  // g h [m/s]
  uint columns, rows;
  int di, dj;
  uint colour, stride;
  uint along, count;      // constraints along the unstrided direction; in all
  float h;                // substep [s]
  float rest_m;           // rest length of a distance constraint
  float alpha;            // compliance over h^2 [1/kg], interior
  float alpha_border;     // the same on the border lines, which carry half the width
  float loss;             // 1 - exp(-c h)
  uint i_first;           // first i of the family: 1 for the diagonal that runs down-left
  uint multiplier_first;  // of this family, where multipliers are kept
  uint iteration;         // 0 takes them as 0
};

#ifdef __cplusplus
static_assert(sizeof(DistanceConstraint) == 16);
static_assert(sizeof(PaperConstants) == 48);
static_assert(sizeof(XpbdConstants) == 80);
}  // namespace clothbench::pbd_gpu
#endif
