#include "scenario/weld.hpp"

#include <cmath>
#include <map>

#include "clothbench/vector.hpp"

namespace clothbench {
namespace {

/// Kept vertices by place: by cells a little wider than the distance, or by position where that is 0.
class Places {
 public:
  explicit Places(double distance_m) : distance_m_(distance_m) {}

  /// The number of a kept vertex near `at`, the earliest; `otherwise` if there is none, which is then kept.
  std::uint32_t find_or_add(const Vec3& at, std::uint32_t otherwise, const std::vector<Vec3>& kept) {
    std::uint32_t best = otherwise;
    Vec3 own{};
    for (std::size_t k = 0; k < 3; ++k) own[k] = cell(at[k]);
    const int reach = distance_m_ > 0 ? 1 : 0;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          const auto [first, last] = cells_.equal_range({own[0] + i, own[1] + j, own[2] + k});
          for (auto v = first; v != last; ++v)
            if (v->second < best && length(minus(kept[v->second], at)) <= distance_m_) best = v->second;
        }
    if (best == otherwise) cells_.emplace(own, otherwise);
    return best;
  }

 private:
  double cell(double x) const { return distance_m_ > 0 ? std::floor(x / distance_m_) : x; }

  const double distance_m_;
  std::multimap<Vec3, std::uint32_t> cells_;
};

}  // namespace

std::size_t weld(assets::MeshFile& file, double distance_m) {
  Places places(distance_m);
  std::vector<Vec3> kept;
  std::vector<std::uint32_t> to, lines;
  for (std::size_t v = 0; v < file.vertices.size(); ++v) {
    const Vec3& x = file.vertices[v];
    const auto next = static_cast<std::uint32_t>(kept.size());
    // A vertex that is not finite is in no place; the checks of the cloth name it.
    const bool finite = std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
    to.push_back(finite ? places.find_or_add(x, next, kept) : next);
    if (to.back() != next) continue;
    kept.push_back(x);
    if (!file.vertex_lines.empty()) lines.push_back(file.vertex_lines[v]);
  }
  const std::size_t removed = file.vertices.size() - kept.size();
  if (removed == 0) return 0;
  for (auto& t : file.triangles)
    for (std::uint32_t& v : t)
      if (v < to.size()) v = to[v];
  file.vertices = std::move(kept);
  file.vertex_lines = std::move(lines);
  return removed;
}

}  // namespace clothbench
