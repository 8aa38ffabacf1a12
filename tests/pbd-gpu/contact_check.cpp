#include "contact_check.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <limits>

#include "runner/solver_run.hpp"

namespace clothbench::pbd_gpu {
namespace {

using V = Eigen::Vector3d;
using Points = std::vector<V>;

struct Swept {
  Points start, end;  ///< one, two or three points
  double radius = 0;
};

/// Feet of p on a triangle's plane and on a segment (Ericson 2005, 5.1).
void keep_shorter(V& best, const V& d) {
  if (d.squaredNorm() < best.squaredNorm()) best = d;
}

void between_segments(const V& a, const V& b, const V& c, const V& d, V& best) {
  const V e = b - a, f = d - c, g = a - c;
  const double ee = e.dot(e), ff = f.dot(f), ef = e.dot(f), eg = e.dot(g), fg = f.dot(g), all = ee * ff - ef * ef;
  const auto part = [](double above, double below) { return below > 0 ? std::clamp(above / below, 0.0, 1.0) : 0.0; };
  double s = part(ef * fg - ff * eg, all);
  const double t = part(ef * s + fg, ff);
  s = part(ef * t - eg, ee);
  keep_shorter(best, a + s * e - c - t * f);
}

void between_point_and_triangle(const V& p, const Points& t, double sign, V& best) {
  const V ab = t[1] - t[0], ac = t[2] - t[0], n = ab.cross(ac), ap = p - t[0];
  const double all = n.dot(n), wb = ap.cross(ac).dot(n), wc = ab.cross(ap).dot(n);
  if (all > 0 && wb >= 0 && wc >= 0 && wb + wc <= all) keep_shorter(best, sign * ap.dot(n) / all * n);
}

/// From b to a; zero if they cross and no feature is nearer.
V shortest(const Points& a, const Points& b) {
  V best = V::Constant(1e9);
  const std::size_t sides = b.size() == 3 ? 3 : 1;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < sides; ++j) between_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % b.size()], best);
  for (const V& p : b) between_point_and_triangle(p, a, -1, best);
  if (b.size() == 3)
    for (const V& p : a) between_point_and_triangle(p, b, 1, best);
  return best;
}

double gap(const V& n, const Points& a, const Points& b) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const V& p : a) low = std::min(low, n.dot(p));
  for (const V& p : b) high = std::max(high, n.dot(p));
  return low - high;
}

bool separated(const Points& x0, const Points& x1, const Swept& shape) {
  const V start = shortest(x0, shape.start), end = shortest(x1, shape.end);
  if (!(start.norm() > 0) || !(end.norm() > 0)) return false;
  constexpr int kBlends = 16;
  for (int k = 0; k <= kBlends; ++k) {
    const double share = static_cast<double>(k) / kBlends;
    const V n = (1 - share) * start.normalized() + share * end.normalized();
    if (!(n.norm() > 1e-6)) continue;
    const V unit = n.normalized();
    if (gap(unit, x0, shape.start) > shape.radius && gap(unit, x1, shape.end) > shape.radius) return true;
  }
  return false;
}

V point(const std::vector<double>& x, std::size_t i) { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }
V point(const Vec3& x) { return {x[0], x[1], x[2]}; }

void add_box(const Collider& c, std::vector<Swept>& all) {
  const auto corner = [&](int k) {
    V at = point(c.center_m);
    for (int axis = 0; axis < 3; ++axis)
      at += ((k >> axis & 1) != 0 ? 1 : -1) * c.half_extent_m[static_cast<std::size_t>(axis)] *
            point(c.axes[static_cast<std::size_t>(axis)]);
    return at;
  };
  for (const std::array<int, 4>& f : std::vector<std::array<int, 4>>{
           {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
    for (const int k : {1, 2}) {
      const Points t = {corner(f[0]), corner(f[static_cast<std::size_t>(k)]),
                        corner(f[static_cast<std::size_t>(k + 1)])};
      all.push_back({t, t, 0});
    }
}

std::vector<Swept> shapes(const Scene& scene, int frame) {
  std::vector<Swept> all;
  const auto pose = [&](std::size_t collider, int instant) {
    return scene.motion.empty() ? ColliderPose{}
                                : scene.motion.at(static_cast<std::size_t>(instant)).colliders.at(collider);
  };
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    if (c.shape == Collider::Shape::Sphere) all.push_back({{point(c.center_m)}, {point(c.center_m)}, c.radius_m});
    if (c.shape == Collider::Shape::Box) add_box(c, all);
    if (c.shape == Collider::Shape::Capsules) {
      const ColliderPose a = pose(k, frame), b = pose(k, frame + 1);
      for (std::size_t i = 0; i < c.capsules.size(); ++i)
        all.push_back({{point(a.capsules[i].a_m), point(a.capsules[i].b_m)},
                       {point(b.capsules[i].a_m), point(b.capsules[i].b_m)},
                       c.capsules[i].radius_m});
    }
    if (c.shape != Collider::Shape::Mesh) continue;
    const std::vector<double> a = c.moves() ? posed_positions(*c.mesh, pose(k, frame)) : c.mesh->positions,
                              b = c.moves() ? posed_positions(*c.mesh, pose(k, frame + 1)) : a;
    for (const auto& t : c.mesh->triangles)
      all.push_back(
          {{point(a, t[0]), point(a, t[1]), point(a, t[2])}, {point(b, t[0]), point(b, t[1]), point(b, t[2])}, 0});
  }
  return all;
}

Eigen::AlignedBox3d box_of(const Points& start, const Points& end, double radius) {
  Eigen::AlignedBox3d box;
  for (const Points* points : {&start, &end})
    for (const V& p : *points) box.extend(p);
  return {box.min() - V::Constant(radius), box.max() + V::Constant(radius)};
}

}  // namespace

PairCheck check_pairs(const Scene& scene, const std::vector<double>& before, const std::vector<double>& after,
                      int frame) {
  PairCheck check;
  const std::vector<Swept> all = shapes(scene, frame);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Swept& s : all) boxes.push_back(box_of(s.start, s.end, s.radius));
  for (const auto& t : triangles(scene.cloth)) {
    const Points x0 = {point(before, t[0]), point(before, t[1]), point(before, t[2])},
                 x1 = {point(after, t[0]), point(after, t[1]), point(after, t[2])};
    const Eigen::AlignedBox3d box = box_of(x0, x1, 0);
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!box.intersects(boxes[k])) continue;
      ++check.pairs;
      check.separated += separated(x0, x1, all[k]) ? 1 : 0;
    }
  }
  return check;
}

PairCheck check_self_pairs(const Scene& scene, const std::vector<double>& before, const std::vector<double>& after) {
  PairCheck check;
  const auto all = triangles(scene.cloth);
  std::vector<Swept> swept;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& t : all) {
    swept.push_back({{point(before, t[0]), point(before, t[1]), point(before, t[2])},
                     {point(after, t[0]), point(after, t[1]), point(after, t[2])},
                     0});
    boxes.push_back(box_of(swept.back().start, swept.back().end, 0));
  }
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (!boxes[a].intersects(boxes[b])) continue;
      const bool joined = std::any_of(all[a].begin(), all[a].end(), [&](std::uint32_t v) {
        return std::find(all[b].begin(), all[b].end(), v) != all[b].end();
      });
      if (joined) continue;
      ++check.pairs;
      check.separated += separated(swept[a].start, swept[a].end, swept[b]) ? 1 : 0;
    }
  return check;
}

std::string fault_of(GpuSolver& solver, const Scene& s, long& pairs, long& own_pairs) {
  solver.load(s);
  std::vector<double> before = initial_positions(s);
  for (int f = 0; f < s.time.frames(); ++f) {
    const ClothState state = after_frame(solver, s, f);
    const PairCheck check = check_pairs(s, before, state.position, f);
    if (!(check.separated == check.pairs))
      return fmt::format("{} of {} pairs in step {}", check.pairs - check.separated, check.pairs, f);
    pairs += check.pairs;
    if (s.needs.has(Feature::SelfCollision)) {
      const PairCheck own = check_self_pairs(s, before, state.position);
      if (!(own.separated == own.pairs))
        return fmt::format("{} of {} pairs of the cloth with itself in step {}", own.pairs - own.separated, own.pairs,
                           f);
      own_pairs += own.pairs;
    }
    before = state.position;
  }
  for (const SolverCount& c : solver.counts())
    if (!(c.count <= 0)) return fmt::format("{} {}", c.count, c.name);
  return {};
}

void expect_all_separated(GpuSolver& solver, const Scene& s, long least) {
  long pairs = 0, own_pairs = 0;
  EXPECT_EQ(fault_of(solver, s, pairs, own_pairs), "");
  EXPECT_EQ(check_stages(s, solver.info(), solver.plan()), "");
  EXPECT_GT(s.needs.has(Feature::SelfCollision) ? own_pairs : pairs, least) << "or this says nothing";
}

}  // namespace clothbench::pbd_gpu
