#include "metrics/contact/capsules.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clothbench::contact {

double axis_share(const Point<3>& p, const Capsule& c) {
  const Point<3> axis = c.b - c.a;
  const double squared = axis.squaredNorm();
  return squared > 0 ? std::clamp(axis.dot(p - c.a) / squared, 0.0, 1.0) : 0.0;
}

double signed_distance(const Point<3>& p, const Capsule& c) {
  return (p - (c.a + axis_share(p, c) * (c.b - c.a))).norm() - c.radius_m;
}

CapsuleMesh capsule_mesh(const Capsule& c) {
  constexpr int kQuarter = kCapsuleSides / 4;
  const Point<3> along = c.a == c.b ? Point<3>(Point<3>::UnitZ()) : Point<3>((c.b - c.a).normalized());
  const Point<3> u = along.unitOrthogonal(), v = along.cross(u);
  CapsuleMesh mesh;
  const auto add = [&](const Point<3>& p) { mesh.positions.insert(mesh.positions.end(), {p[0], p[1], p[2]}); };
  int rings = 0;
  const auto ring = [&](const Point<3>& centre, int step) {  // `step` quarters from the equator, towards b if positive
    const double latitude = 0.5 * std::numbers::pi * step / kQuarter;
    for (int k = 0; k < kCapsuleSides; ++k) {
      const double t = 2 * std::numbers::pi * k / kCapsuleSides;
      add(centre +
          c.radius_m * (std::sin(latitude) * along + std::cos(latitude) * (std::cos(t) * u + std::sin(t) * v)));
    }
    ++rings;
  };
  add(c.a - c.radius_m * along);
  for (int step = 1 - kQuarter; step <= 0; ++step) ring(c.a, step);
  for (int step = c.a == c.b ? 1 : 0; step < kQuarter; ++step) ring(c.b, step);
  add(c.b + c.radius_m * along);
  const auto last = static_cast<std::uint32_t>(1 + rings * kCapsuleSides);
  const auto at = [&](int r, int k) { return static_cast<std::uint32_t>(1 + r * kCapsuleSides + k % kCapsuleSides); };
  for (int k = 0; k < kCapsuleSides; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({last, at(rings - 1, k), at(rings - 1, k + 1)});
    for (int r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
  }
  return mesh;
}

}  // namespace clothbench::contact
