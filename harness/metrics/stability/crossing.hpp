#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::stability {

/// Counts how often the middle of a moving capsule has passed through the cloth, with sign: there and back is none. A
/// sheet that is held round it can only let it through by tunnelling; one that it goes round is not crossed.
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

/// Signed passes of a point that moves straight from p0 to p1 through a triangle whose corners move straight from t0 to
/// t1: +1 along its normal. Within each of 16 parts of the frame the point's side is taken to change linearly.
int passes(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& t0, const std::array<Vec3, 3>& t1);

}  // namespace clothbench::stability
