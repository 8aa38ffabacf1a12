#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>

#include "bullet.hpp"

namespace clothbench {
namespace {

constexpr double kMargin_m = 0.02;  // the solvers' default collision_margin_m

Collider plane(Vec3 normal = {0, 1, 0}) { return {.shape = Collider::Shape::Plane, .normal = normal}; }
Collider sphere(double radius_m) { return {.shape = Collider::Shape::Sphere, .radius_m = radius_m}; }

Collider box(double half_m) {
  const double r = std::sqrt(0.5);
  return {.shape = Collider::Shape::Box,
          .half_extent_m = {half_m, half_m, half_m},
          .axes = {{{r, 0, -r}, {0, 1, 0}, {r, 0, r}}}};
}

/// An open square in y = 0, made of two triangles.
Collider square(double half_m, bool moves) {
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = {-half_m, 0, -half_m, half_m, 0, -half_m, half_m, 0, half_m, -half_m, 0, half_m};
  mesh->triangles = {{0, 3, 2}, {0, 2, 1}};
  if (moves) {
    mesh->joints.assign(4, {0, 0, 0, 0});
    mesh->weights.assign(4, {1, 0, 0, 0});
    mesh->joint_count = 1;
  }
  Collider c;
  c.shape = Collider::Shape::Mesh;
  c.mesh = mesh;
  return c;
}

/// A cloth that falls from rest at height y.
Scene falling(double y, int n = 17) {
  Scene s = with_damping(with_bending(sheet(n, n, 0.5, 0.5)), 2);
  s.cloth.center_m = {0, y, 0};
  return s;
}

double lowest(const ClothState& state, const std::function<double(const Vec3&)>& distance) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; 3 * v < state.position.size(); ++v) {
    const double d = distance(vertex_at(state.position, v));
    least = d >= least ? least : d;
  }
  return least;
}

double mean_speed(const ClothState& state) {
  double sum = 0;
  for (std::size_t v = 0; 3 * v < state.velocity.size(); ++v) sum += length(vertex_at(state.velocity, v));
  return sum * 3 / static_cast<double>(state.velocity.size());
}

TEST_P(Bullet, LiesOnAPlaneAtTheMargin) {
  const Scene s = with_collider(falling(0.1), plane());
  const ClothState state = from_start(*make_solver(GetParam()), s, 108);
  for (std::size_t v = 0; v < 17 * 17; ++v) EXPECT_NEAR(vertex_at(state.position, v)[1], kMargin_m, 0.002) << v;
  EXPECT_LT(mean_speed(state), 0.1);
}

TEST_P(Bullet, TakesTheMarginAskedFor) {
  // An offset of 4 mm needs smaller displacements per substep: 0.7 m/s at 72 Hz with 16 substeps gives 0.6 mm.
  const Scene s = with_collider(falling(0.03, 9), plane());
  const auto solver = make_solver(GetParam(), {{"collision_margin_m", 0.0}, {"substeps", 16}});
  const ClothState state = from_start(*solver, s, 72);
  for (std::size_t v = 0; v < 81; ++v) EXPECT_NEAR(vertex_at(state.position, v)[1], 0.004, 0.002) << v;
}

TEST_P(Bullet, DrapesOverASphereAndOverATurnedBox) {
  const double r = std::sqrt(0.5);
  for (const bool round : {true, false}) {
    const Scene s = with_collider(falling(0.3), round ? sphere(0.15) : box(0.1));
    const ClothState state = from_start(*make_solver(GetParam()), s, 144);
    const double least = lowest(state, [&](const Vec3& p) {
      const double square = std::max({std::abs(r * (p[0] - p[2])), std::abs(p[1]), std::abs(r * (p[0] + p[2]))});
      return round ? length(p) - 0.15 : square - 0.1;
    });
    EXPECT_GT(least, (round ? 0.5 : 0.3) * kMargin_m);
    EXPECT_LT(least, 1.5 * kMargin_m);
    EXPECT_LT(lowest(state, [](const Vec3& p) { return p[1]; }), 0.05) << "it hangs down";
    if (round) {
      EXPECT_GT(vertex_at(state.position, 8 * 17 + 8)[1], 0.1) << "its middle is still on top";
    }
  }
}

TEST_P(Bullet, StaysOnAnOpenMesh) {
  const Scene s = with_collider(falling(0.3), square(0.15, false));
  const ClothState state = from_start(*make_solver(GetParam()), s, 144);
  int above = 0;
  for (std::size_t v = 0; v < 17 * 17; ++v) {
    const Vec3 p = vertex_at(state.position, v);
    if (!(std::max(std::abs(p[0]), std::abs(p[2])) < 0.14)) continue;
    EXPECT_GT(p[1], 0.25 * kMargin_m) << v;
    ++above;
  }
  EXPECT_GT(above, 60);
  EXPECT_LT(lowest(state, [](const Vec3& p) { return p[1]; }), -0.02) << "the overhang hangs";
}

/// A square or three capsules that hit a hanging cloth from behind and stop 0.15 m past it: a hanging cloth yields. (A
/// cloth stretched between two edges does not yield, and bullet-soft lets the square through.)
TEST_P(Bullet, IsPushedByAMovingMeshAndByCapsules) {
  for (bool capsules : {false, true}) {
    Collider c = square(0.1, true);
    if (capsules) {
      c = Collider{};
      c.shape = Collider::Shape::Capsules;
      for (double y : {-0.4, -0.35, -0.3}) c.capsules.push_back({{-0.1, y, -0.1}, {0.1, y, -0.1}, 0.02});
    }
    Scene s = with_collider(falling(-0.25), c);
    s.cloth.axis_v = {0, -1, 0};
    for (std::uint32_t i = 0; i < 17; ++i) s.pins.vertices.push_back(i);
    s.needs.add(Feature::Pins);
    const auto way = [](int f) { return -0.1 + 0.25 * std::min(f, 36) / 36.0; };
    for (int f = 0; f <= s.time.frames(); ++f) {
      FrameMotion m;
      m.colliders.resize(1);
      if (!capsules) m.colliders[0].joints = {Affine{{{1, 0, 0, 0}, {0, 0, 1, -0.35}, {0, -1, 0, way(f)}}}};
      m.colliders[0].capsules = c.capsules;
      for (Capsule& k : m.colliders[0].capsules) k.a_m[2] = k.b_m[2] = way(f);
      s.motion.push_back(m);
    }
    const ClothState state = from_start(*make_solver(GetParam()), s, 60);
    int before = 0;
    for (std::size_t v = 0; v < 17 * 17; ++v) {
      const Vec3 p = vertex_at(state.position, v);
      if (!(std::abs(p[0]) < 0.08 && std::abs(p[1] + 0.35) < 0.05)) continue;
      EXPECT_GT(p[2], way(60)) << v << " must be in front of the " << (capsules ? "capsules" : "square");
      ++before;
    }
    EXPECT_GT(before, 10);
  }
}

/// Mean displacement along a slope of 30 degrees in 0.4 s.
double slide_m(const std::string& solver, double friction) {
  const double c = std::cos(std::numbers::pi / 6), d = std::sin(std::numbers::pi / 6);
  Scene s = with_collider(sheet(9, 9, 0.3, 0.3), plane({d, c, 0}), friction);
  s.cloth.axis_u = {c, -d, 0};
  s.cloth.center_m = {kMargin_m * d, kMargin_m * c, 0};
  const ClothState state = from_start(*make_solver(solver), s, 29);
  double sum = 0;
  for (std::size_t v = 0; v < 81; ++v) sum += c * vertex_at(state.position, v)[0] - d * vertex_at(state.position, v)[1];
  return sum / 81;
}

TEST_P(Bullet, SlidesWithoutFrictionAndSticksWithMuch) {
  const double t = 29 / 72.0, frictionless = 0.5 * 9.81 * 0.5 * t * t;
  const double free = slide_m(GetParam(), 0), some = slide_m(GetParam(), 0.3), stuck = slide_m(GetParam(), 1);
  printf("  slope of 30 degrees: slides %.4f, %.4f, %.4f m at friction 0, 0.3, 1; Coulomb %.4f, %.4f, 0\n", free, some,
         stuck, frictionless, frictionless - 0.5 * 9.81 * 0.3 * std::cos(std::numbers::pi / 6) * t * t);
  EXPECT_NEAR(free, frictionless, 0.05 * frictionless);
  EXPECT_LE(some, free);
  EXPECT_NEAR(stuck, 0, 0.05 * frictionless);
}

TEST_P(Bullet, AVertexLetGoFallsFreely) {
  // A sheet whose vertices are all attached, then all released, with no force on it.
  Scene s = sheet(3, 3, 0.2, 0.2);
  for (std::uint32_t v = 0; v < 9; ++v) s.grips.vertices.push_back(v);
  s.needs.add(Feature::MovingPins);
  const std::vector<double> start = initial_positions(s);
  for (int f = 0; f <= s.time.frames(); ++f) {
    FrameMotion m;
    for (std::uint32_t v = 0; v < 9; ++v) {
      m.grip_position_m.push_back(vertex_at(start, v));
      m.grip_held.push_back(f < 4 ? 1 : 0);
    }
    s.motion.push_back(m);
  }
  const SolverEntry& entry = find_solver(GetParam());
  const auto solver = make_solver(GetParam());
  const ClothState held = from_start(*solver, s, 4);
  EXPECT_EQ(held.position, from_start(*make_solver(GetParam()), s, 0).position);
  const ClothState state = run_frames(*solver, s, 4, 22);
  const double fall = entry.free_fall_m(s, complete_settings(entry.info, nlohmann::json::object()), 18);
  for (std::size_t k = 0; k < start.size(); ++k)
    EXPECT_NEAR(state.position[k] - held.position[k], k % 3 == 1 ? fall : 0, 1e-4 * std::abs(fall));
}

}  // namespace
}  // namespace clothbench
