#pragma once
#include <cmath>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Length of a vector.
inline double norm(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

/// Pinned vertices that fill a rectangle of the grid, first and last included: a corner, an edge, a clamp.
struct PinnedRectangle {
  std::uint32_t first_column, first_row, last_column, last_row;
  bool operator==(const PinnedRectangle&) const = default;
};

/// Tethers of a scene (Kim, Chentanez & Müller 2012): no vertex goes farther from the nearest pinned vertex of each
/// rectangle than `stretch` times the cloth between them.
struct Tethers {
  static constexpr std::size_t kMost = 4;
  std::vector<PinnedRectangle> to;  ///< at most kMost
  double stretch = 1;
  std::string why_not;  ///< if `to` is empty
};
/// They are right where nothing that holds the cloth moves and the truth forbids more: an inextensible cloth, or one
/// whose springs give by far less than the slack of 5 rho g L / Y under its own weight (and 2 v0 / c by its speed).
Tethers tethers_of(const Scene&);

/// 1 and the slack.
double tether_stretch(const Scene&);

/// Of each chain of the four families (rows, columns, both diagonals; max(columns, rows) each): 1 if two held vertices
/// may pull it taut, so that its inextensible links are one more than there are ways to move, else 0.
std::vector<std::uint8_t> taut_chains(const Scene&);

/// Substeps of a frame: setting `substeps`, or if that is 0 the rule of setting `quality` (README, "Substeps").
int xpbd_substeps(const Scene&, const nlohmann::json& settings);

/// What of a device decides how lines are spread over threads.
struct LineDevice {
  std::uint32_t subgroup = 0;  ///< lanes that exchange by shuffles; 0 = none
  std::uint32_t most_threads = 128, shared_B = 16384;
  /// Two vertices a thread and workgroups of up to 1024 threads: faster by 8 to 14 % on an H200 up to 32 x 32, by a
  /// quarter above; elsewhere registers may be few.
  bool wide = false;
};

/// How chains lie on threads: `lanes` threads a chain, `vertices` each, `threads` a workgroup.
struct LineShape {
  std::uint32_t lanes = 0, vertices = 0, threads = 0;
  bool shuffles = false;
  std::uint32_t beside = 1;  ///< neighbouring chains whose threads take turns
  std::uint32_t chains_a_group() const { return threads / lanes; }
};
/// What the user asks of shapes; 0 leaves the choice here.
struct LineRequest {
  std::uint32_t vertices = 0, threads = 0, beside = 0;
};
/// Of the kernel that takes a whole cloth through a frame; threads = 0 if the cloth or the device does not fit it.
LineShape frame_shape(int columns, int rows, const LineRequest&, const LineDevice&);
/// Of the kernel of one family of lines of `length` vertices. On wide devices two vertices a thread are fastest up to
/// some 384 (of an H200), and reading 2 or 4 neighbouring columns at once from 192 on. Throws Error past 8192.
LineShape pass_shape(int length, const LineRequest&, const LineDevice&);

/// Rounds of cyclic reduction after which what is left of the bending matrix is below a ten-millionth: with alpha well
/// above the inverse masses hinges hardly feel one another. At most log2(lanes).
std::uint32_t bend_rounds(double alpha, double most_inverse_mass, const LineShape&);

}  // namespace clothbench::pbd_gpu
