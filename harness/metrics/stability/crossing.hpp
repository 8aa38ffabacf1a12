#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::stability {

/// Counts how often the middle of a moving capsule has passed through the cloth, with sign: forth and back cancel. A
/// sheet held round the capsule can only let it through by tunnelling; a sheet that the capsule goes round is not
/// crossed.
class CapsuleCrossing {
 public:
  /// The scene's capsule colliders, those with one capsule.
  explicit CapsuleCrossing(const Scene&);
  /// Positions at the end of frame `frame`, in order. Returns the greatest |count| of all capsules so far.
  int add(int frame, const std::vector<double>& x);

 private:
  const Scene& scene_;
  const std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::size_t> colliders_;
  std::vector<int> count_;
  std::vector<double> before_;
};

/// Signed crossings of a point that moves straight from p0 to p1 through a triangle whose corners move straight from t0
/// to t1: +1 along its normal. The frame is split into 16 parts, in each of which the point's signed side changes
/// linearly.
int passes(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& t0, const std::array<Vec3, 3>& t1);

}  // namespace clothbench::stability
