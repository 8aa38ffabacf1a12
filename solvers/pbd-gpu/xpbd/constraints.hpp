#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "common/gpu_types.h"

namespace clothbench::pbd_gpu {

// Constraints of a scene that lines and chains share. Springs: clothbench/scene.hpp.

/// Length of a vector.
inline double norm(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

/// Minimum ratio of alpha to inverse mass in over-constrained chains: with 0 their system is singular in single
/// precision. Ten times as much visibly lengthens cloth; with a tenth some links diverge.
constexpr double kRegularisation = 1e-3;

/// Upper bound of the eigenvalues of M^-1 A, where A has no negative entries and M is the diagonal of masses: the
/// maximum of (A v)_i / (m_i v_i) for a positive v (Collatz 1942; Wielandt 1950), here from a power iteration.
/// `times(v, to)` stores A v in `to`.
double eigenvalue_bound(const std::vector<double>& mass,
                        const std::function<void(const std::vector<double>& v, std::vector<double>& to)>& times);

/// Rows of a sparse matrix in slices of BENDING_ROWS, each row padded to the longest of its slice. A slice contains the
/// first entries of all its rows, then the second entries, and so on.
template <class Entry>
struct SlicedRows {
  std::vector<BendingSlice> slices;
  std::vector<Entry> entries;
};
/// `length(i)`: entries of row i < rows. `entry(i, j)` must also return padding, for j >= length(i) and for i >= rows.
template <class Entry, class Length, class At>
SlicedRows<Entry> sliced(std::uint32_t rows, const Length& length, const At& entry) {
  SlicedRows<Entry> out;
  for (std::uint32_t begin = 0; begin < rows; begin += BENDING_ROWS) {
    std::uint32_t width = 0;
    for (std::uint32_t i = begin; i < std::min(rows, begin + BENDING_ROWS); ++i)
      width = std::max(width, static_cast<std::uint32_t>(length(i)));
    out.slices.push_back({static_cast<std::uint32_t>(out.entries.size()), width});
    for (std::uint32_t j = 0; j < width; ++j)
      for (std::uint32_t i = begin; i < begin + BENDING_ROWS; ++i) out.entries.push_back(entry(i, j));
  }
  return out;
}

/// Pinned vertices that fill a rectangle of the grid, first and last included: a corner, an edge, a clamp.
struct PinnedRectangle {
  std::uint32_t first_column, first_row, last_column, last_row;
  bool operator==(const PinnedRectangle&) const = default;
};

/// Tethers of a scene (Kim, Chentanez & Müller 2012): the distance of a vertex from the nearest pinned vertex of each
/// rectangle is at most `stretch` times their distance through the cloth at rest.
struct Tethers {
  static constexpr std::size_t kMax = 4;
  std::vector<PinnedRectangle> to;  ///< has at most kMax entries
  double stretch = 1;
  std::string reason;  ///< reason if `to` is empty
};
/// Tethers are used if only pins hold the cloth and it starts within their length (xpbd/README.md). Their slack is
/// 5 rho g L / Y for the cloth's weight plus 2 v0 / c for its initial speed v0, c the speed of stretch waves. `wanted`:
/// whether the settings allow tethers.
Tethers tethers_of(const Scene&, bool wanted = true);

/// Tethers listed per vertex, for chains. Each leads to the nearest vertex of a connected group of pinned vertices.
struct TetherTable {
  std::uint32_t a_vertex = 0;  ///< entries per vertex, 0 to Tethers::kMax
  std::vector<TetherEnd> ends;
  std::string reason;  ///< reason if there are no tethers
};
/// In a grid or a flat mesh with a convex border, reach is the distance at rest. Otherwise it is the path length
/// along edges. Such a path is longer than one through triangles, so these tethers are a little looser.
TetherTable tether_table(const Scene&, bool wanted = true);

/// 5 M g / Y [m]: five times the elongation scale of a sheet that hangs from a few vertices; 0 if inextensible.
double tether_spread_m(const Scene&);

/// True if the scene has tethers with these settings.
bool is_tethered(const Scene&, const nlohmann::json& settings);

/// True if the cloth starts with a structural link shorter than 0.5 or longer than 1.5 times its rest length: crumpled,
/// squashed, coincident, pulled out of shape. No physical cloth starts like this; the solver need only recover.
bool starts_crumpled(const Scene&);

/// Moves every free vertex of a crumpled start by less than a thousandth of a cell per axis, the same in every run.
/// Coincident vertices have no direction in which to separate, and a cloth squashed into a plane cannot leave it.
/// `x`: positions [m].
void break_symmetry(const Scene&, const std::vector<float>& inverse_mass, std::vector<double>& x);

}  // namespace clothbench::pbd_gpu
