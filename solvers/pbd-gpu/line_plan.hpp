#pragma once
#include <cmath>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Whether a scene gets a part of the method, and else why not.
struct Choice {
  bool on = false;
  std::string why_not;
};

/// Length of a vector.
inline double norm(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

/// Pinned vertices that fill a rectangle of the grid, first and last included: a corner, an edge, a clamp.
struct PinnedRectangle {
  std::uint32_t first_column, first_row, last_column, last_row;
  bool operator==(const PinnedRectangle&) const = default;
};

/// Tethers of a scene (Kim, Chentanez & Müller 2012): the distance of a vertex from the nearest pinned vertex of each
/// rectangle is at most `stretch` times their distance through the cloth at rest.
struct Tethers {
  static constexpr std::size_t kMost = 4;
  std::vector<PinnedRectangle> to;  ///< at most kMost
  double stretch = 1;
  std::string why_not;  ///< reason if `to` is empty
};
/// Tethers are valid where everything that holds the cloth is static and the exact solution stretches less: an
/// inextensible cloth, or one whose springs stretch far less than the slack, 5 rho g L / Y for its own weight and
/// 2 v0 / c for its speed.
Tethers tethers_of(const Scene&);

/// 1 + slack.
double tether_stretch(const Scene&);

/// One flag for each chain of the four families (rows, columns, both diagonals; max(columns, rows) each): 1 if two held
/// vertices may pull it taut, so that its inextensible links are one more than its degrees of freedom, else 0.
std::vector<std::uint8_t> taut_chains(const Scene&);

/// True if tethers keep every vertex within reach of pinned ones.
bool is_tethered(const Scene&, const nlohmann::json& settings);

/// Whether links and masses are all alike in an elastic sheet that is held and touches nothing, so that its families
/// may be coupled (INTEGRATION.md); else why not.
Choice may_couple(const Scene&, const nlohmann::json& settings);
/// Implicit substeps of BDF2 in a frame that a stretch wave takes across as many cells as coupled families bear.
double substeps_to_couple(const Scene&);

/// Properties of a device that decide how lines are spread over threads.
struct LineDevice {
  std::uint32_t subgroup = 0;  ///< lanes that exchange by shuffles; 0 = none
  std::uint32_t most_threads = 128, shared_B = 16384;
  /// Use two vertices a thread and workgroups of up to 1024 threads. On an H200 this is faster by 8 to 14 % up to
  /// 32 x 32 and by a quarter above; other devices may have too few registers.
  bool wide = false;
};

/// How chains are spread over threads: `lanes` threads a chain, `vertices` a thread, `threads` a workgroup.
struct LineShape {
  std::uint32_t lanes = 0, vertices = 0, threads = 0;
  bool shuffles = false;
  std::uint32_t beside = 1;  ///< neighbouring chains whose threads take turns
  std::uint32_t chains_a_group() const { return threads / lanes; }
};
/// The user's request for a shape; 0: chosen here.
struct LineRequest {
  std::uint32_t vertices = 0, threads = 0, beside = 0;
  bool couples = false;  ///< a vertex has a shift too (INTEGRATION.md)
};
/// Shape of the kernel that computes a frame of a whole cloth; threads = 0 if the cloth or the device does not fit it.
LineShape frame_shape(int columns, int rows, const LineRequest&, const LineDevice&);
/// Shape of the kernel of one family of lines of `length` vertices. On wide devices (an H200) two vertices a thread are
/// fastest up to some 384, and reading 2 or 4 neighbouring columns at once above 192. Throws Error past 8192.
LineShape pass_shape(int length, const LineRequest&, const LineDevice&);

/// Rounds of cyclic reduction after which the rest of the bending matrix is below 1e-7. Few are needed where alpha is
/// well above the inverse masses: hinges are then weakly coupled. At most log2(lanes).
std::uint32_t bend_rounds(double alpha, double most_inverse_mass, const LineShape&);

}  // namespace clothbench::pbd_gpu
