#include "metrics/stability/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "clothbench/vector.hpp"

namespace clothbench::stability {
namespace {

Vec3 mix(const Vec3& a, const Vec3& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}
double volume(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)); }

struct Instant {
  Vec3 p, a, b, c;
};

Instant at(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& t0, const std::array<Vec3, 3>& t1, double t) {
  return {mix(p0, p1, t), mix(t0[0], t1[0], t), mix(t0[1], t1[1], t), mix(t0[2], t1[2], t)};
}

/// Positive on the side of the normal.
double side(const Instant& i) { return volume(minus(i.b, i.a), minus(i.c, i.a), minus(i.p, i.a)); }

/// Whether a point in the triangle's plane lies in it.
bool inside(const Instant& i) {
  const Vec3 a = minus(i.a, i.p), b = minus(i.b, i.p), c = minus(i.c, i.p);
  const Vec3 n = cross(minus(i.b, i.a), minus(i.c, i.a));
  return volume(n, a, b) >= 0 && volume(n, b, c) >= 0 && volume(n, c, a) >= 0;
}

/// Whether a corner moves by more than the radius in one frame, both in the world and relative to the capsule's middle.
/// It may then have gone round the capsule between the two frames, and its straight path is meaningless. Cloth that is
/// passed by a fast capsule does not itself move so far.
bool whips(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& t0, const std::array<Vec3, 3>& t1,
           double radius) {
  const Vec3 way = minus(p1, p0);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 own = minus(t1[k], t0[k]);
    if (length(own) > radius && length(minus(own, way)) > radius) return true;
  }
  return false;
}

}  // namespace

int passes(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& t0, const std::array<Vec3, 3>& t1) {
  constexpr int kParts = 16;
  int count = 0;
  double before = side(at(p0, p1, t0, t1, 0));
  for (int k = 1; k <= kParts; ++k) {
    const double now = side(at(p0, p1, t0, t1, static_cast<double>(k) / kParts));
    // Half-open interval: a point in the plane at the end of a part is on the far side in the next part.
    if ((before < 0) != (now < 0)) {
      const double t = (k - 1 + before / (before - now)) / kParts;
      if (inside(at(p0, p1, t0, t1, t))) count += now < 0 ? -1 : 1;
    }
    before = now;
  }
  return count;
}

CapsuleCrossing::CapsuleCrossing(const Scene& s) : scene_(s), triangles_(triangles(s.cloth)) {
  for (std::size_t k = 0; k < s.colliders.size(); ++k)
    if (s.colliders[k].capsules.size() == 1) colliders_.push_back(k);
  count_.assign(colliders_.size(), 0);
}

int CapsuleCrossing::add(int frame, const std::vector<double>& x) {
  // A teleport is not a path: the scene itself placed the capsule behind the cloth.
  const auto jumps =
      std::any_of(scene_.jumps.begin(), scene_.jumps.end(), [&](const Jump& j) { return j.frame == frame; });
  if (frame > 0 && !jumps)
    for (std::size_t n = 0; n < colliders_.size(); ++n) {
      const auto middle = [&](int f) {
        const Capsule& c = scene_.motion[static_cast<std::size_t>(f)].colliders[colliders_[n]].capsules[0];
        return mix(c.a_m, c.b_m, 0.5);
      };
      const Vec3 p0 = middle(frame - 1), p1 = middle(frame);
      const double radius =
          scene_.motion[static_cast<std::size_t>(frame)].colliders[colliders_[n]].capsules[0].radius_m;
      for (const auto& t : triangles_) {
        const auto corners = [&](const std::vector<double>& at) {
          return std::array{vertex_at(at, t[0]), vertex_at(at, t[1]), vertex_at(at, t[2])};
        };
        const std::array<Vec3, 3> from = corners(before_), to = corners(x);
        if (!whips(p0, p1, from, to, radius)) count_[n] += passes(p0, p1, from, to);
      }
    }
  before_ = x;
  int most = 0;
  for (int c : count_) most = std::max(most, std::abs(c));
  return most;
}

}  // namespace clothbench::stability
