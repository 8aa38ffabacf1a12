#include <algorithm>

#include "refusal.hpp"
#include "sheets.hpp"

namespace clothbench {
namespace {

Collider floor_below(double height_m) {
  Collider c;
  c.shape = Collider::Shape::Plane;
  c.name = "floor";
  c.center_m = {0, height_m, 0};
  c.normal = {0, 1, 0};
  return c;
}

TEST_P(Bullet, SaysWhatItCannotDo) {
  const SolverInfo& info = find_solver(GetParam()).info;
  for (Feature f : {Feature::DuplicatedLayer, Feature::SelfCollision})
    EXPECT_EQ(unsupported(info, {Feature::Stretch, f}), FeatureSet{f});
  EXPECT_TRUE(
      unsupported(info, kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::MovingPins})
          .empty());
}

TEST_P(Bullet, SaysWhatMarginItKeepsInsteadOfTheScenes) {
  const Scene s = with_collider(sheet(5, 4), floor_below(-0.5));
  const auto margin_lines = [&](const nlohmann::json& settings) {
    const auto solver = make_solver(GetParam(), settings);
    solver->load(s);
    std::vector<LeftOut> found;
    for (const LeftOut& l : solver->plan().left_out)
      if (l.what.find("margin of 0.004 m") != std::string::npos) found.push_back(l);
    return found;
  };
  const auto by_default = margin_lines(nlohmann::json::object());
  ASSERT_EQ(by_default.size(), 1U);
  EXPECT_NE(by_default[0].what.find("floor"), std::string::npos);
  EXPECT_NE(by_default[0].why.find("collision_margin_m = 0.02 m"), std::string::npos);
  EXPECT_TRUE(margin_lines({{"collision_margin_m", 0.0}}).empty()) << "0 takes the scene's";
}

TEST_P(Bullet, TellsTheMarginThatMetricsGoBy) {
  Scene s = with_collider(sheet(5, 4), floor_below(-0.5));
  s.colliders.push_back(s.colliders[0]);
  s.colliders[1].margin_m = 0.01;
  const auto margins = [&](const nlohmann::json& settings) {
    const auto solver = make_solver(GetParam(), settings);
    solver->load(s);
    return solver->plan().contact_margins_m;
  };
  EXPECT_EQ(margins(nlohmann::json::object()), (std::vector<double>{0.02, 0.02}));
  EXPECT_EQ(margins({{"collision_margin_m", 0.003}}), (std::vector<double>{0.003, 0.003}));
  EXPECT_EQ(margins({{"collision_margin_m", 0.0}}), (std::vector<double>{0.01, 0.01})) << "one for all: the widest";
}

TEST_P(Bullet, RefusesSettingsByName) {
  const auto message = [&](const char* key, const nlohmann::json& value) {
    return refusal([&] { make_solver(GetParam(), {{key, value}}); });
  };
  for (const auto& [key, value] :
       std::map<const char*, nlohmann::json>{{"substeps", -1}, {"collision_margin_m", -0.1}, {"sdf_voxel_m", 0.0}}) {
    EXPECT_NE(message(key, value).find(GetParam() + ": setting " + key), std::string::npos)
        << key << ": " << message(key, value);
    EXPECT_NE(message(key, value).find(value.dump()), std::string::npos) << key;
  }
}

TEST_P(Bullet, RefusesACapsuleThatGrows) {
  Collider c;
  c.shape = Collider::Shape::Capsules;
  c.name = "finger";
  c.capsules = {{{0, -1, 0}, {0.1, -1, 0}, 0.01}};
  Scene s = with_collider(sheet(5, 4), c);
  for (double tip : {0.1, 0.11}) {
    FrameMotion m;
    m.colliders.resize(1);
    m.colliders[0].capsules = {{{0, -1, 0}, {tip, -1, 0}, 0.01}};
    s.motion.push_back(m);
  }
  const auto solver = make_solver(GetParam());
  EXPECT_PRED2(mentions, refusal([&] { solver->load(s); }), "collider finger: capsule 0");
}

constexpr std::array<std::pair<int, int>, 3> kSizes = {{{2, 2}, {7, 5}, {33, 17}}};

TEST_P(Bullet, FreeFallIsThatOfItsIntegrator) {
  for (const auto& [columns, rows] : kSizes) {
    const Scene s = with_damping(with_bending(sheet(columns, rows)));
    const SolverEntry& entry = find_solver(GetParam());
    const auto solver = make_solver(GetParam());
    const ClothState state = after(*solver, s, 36);
    const double fall = entry.free_fall_m(s, complete_settings(entry.info, nlohmann::json::object()), 36);
    const std::vector<double> start = initial_positions(s);
    double worst = 0;
    for (std::size_t k = 0; k < start.size(); ++k)
      worst = std::max(worst, std::abs(state.position[k] - start[k] - (k % 3 == 1 ? fall : 0)) / (0.5 * 9.81 * 0.25));
    printf("  %dx%d: free-fall error at 0.5 s %.2g\n", columns, rows, worst);
    EXPECT_LE(worst, 5e-5) << columns;  // float32 positions; the deformable body takes up to 70 substeps per frame here
    // Damped by 0.5/s, so less than g T^2/2 and more than the fall at the maximum drag.
    EXPECT_NEAR(fall, -0.5 * 9.81 * 0.25, 0.1 * 0.5 * 9.81 * 0.25);
  }
}

/// A sheet that starts stretched and in motion, without gravity: it contracts, and its centre of mass knows nothing of
/// it.
TEST_P(Bullet, KeepsMomentumAndKnowsItsRestLengths) {
  for (const auto& [columns, rows] : kSizes) {
    Scene s = with_bending(sheet(columns, rows));
    s.cloth.axis_u = {1.05, 0, 0};
    s.cloth.initial_velocity_m_per_s = {0.3, -0.2, 0.1};
    s.gravity_m_per_s2 = {};
    const auto solver = make_solver(GetParam());
    solver->load(s);
    ClothState state;
    double narrowest = 1.05;
    for (int f = 0; f < 36; ++f) {
      state = run(*solver, s, f, f + 1);
      narrowest = std::min(
          narrowest, vertex(state.position, static_cast<std::size_t>(columns) - 1)[0] - vertex(state.position, 0)[0]);
    }
    EXPECT_LT(narrowest, 1.02) << "links have the scene's rest lengths, not the lengths of the start";
    const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
    double total = 0;
    Vec3 p{}, moved{};
    for (std::size_t i = 0; i < mass.size(); ++i) {
      total += mass[i];
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] += mass[i] * state.velocity[3 * i + k];
        moved[k] += mass[i] * (state.position[3 * i + k] - start[3 * i + k]);
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(p[k] / total, s.cloth.initial_velocity_m_per_s[k], 5e-4 * norm(s.cloth.initial_velocity_m_per_s))
          << columns;
      EXPECT_NEAR(moved[k] / total, 0.5 * s.cloth.initial_velocity_m_per_s[k], 1e-4 * s.cloth.width_m) << columns;
    }
  }
}

TEST_P(Bullet, HangsWithBoundedStretchAndFixedPins) {
  for (const auto& [columns, rows] : kSizes) {
    Scene s = with_damping(with_bending(sheet(columns, rows)));
    s.pins.vertices = {0, static_cast<std::uint32_t>(columns - 1)};
    s.needs.add(Feature::Pins);
    const auto solver = make_solver(GetParam());
    const ClothState state = after(*solver, s, 144);
    const std::vector<double> start = initial_positions(s);
    for (std::uint32_t v : s.pins.vertices) EXPECT_EQ(vertex(state.position, v), vertex(start, v));
    double most = 0, lowest = 0;
    for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
      const Vec3 a = vertex(state.position, e.a), b = vertex(state.position, e.b);
      const double strain = norm({a[0] - b[0], a[1] - b[1], a[2] - b[2]}) / e.rest_m - 1;
      ASSERT_TRUE(std::isfinite(strain));
      most = std::max(most, strain);
      lowest = std::min({lowest, a[1], b[1]});
    }
    EXPECT_LT(most, 0.3) << columns;
    EXPECT_LT(lowest, -0.2) << "it does hang";
  }
}

TEST(BulletDeformable, UniaxialStiffnessIsYOnSquareAndOblongCells) {
  // A strip that hangs by one edge: its lower end sinks by rho g L^2/(2 Y).
  for (double cell_ratio : {1.0, 1.4}) {
    Scene s = with_damping(sheet(9, 33, 8 * cell_ratio / 32, 1), 5);
    s.cloth.axis_v = {0, -1, 0};
    s.material.membrane_stiffness_N_per_m = 100;
    for (std::uint32_t i = 0; i < 9; ++i) s.pins.vertices.push_back(i);
    s.needs.add(Feature::Pins);
    const auto solver = make_solver("bullet-deformable");
    const ClothState state = after(*solver, s, 216);
    const double expected = 0.2 * 9.81 / (2 * 100.0);
    // The clamped edge cannot contract sideways, which stiffens the first few cells; hence 5 %.
    EXPECT_NEAR(-(vertex(state.position, 32 * 9 + 4)[1] + 0.5), expected, 0.05 * expected) << cell_ratio;
  }
}

TEST(BulletDeformable, ImplicitStepsHangLikeExplicitOnes) {
  Scene s = with_damping(with_bending(sheet(9, 9)), 3);
  s.pins.vertices = {0, 8};
  s.needs.add(Feature::Pins);
  const auto a = make_solver("bullet-deformable"), b = make_solver("bullet-deformable", {{"implicit", true}});
  const ClothState x = after(*a, s, 288), y = after(*b, s, 288);
  EXPECT_NEAR(vertex(x.position, 76)[1], vertex(y.position, 76)[1], 0.02);
  EXPECT_LT(vertex(x.position, 76)[1], -0.5);
}

INSTANTIATE_TEST_SUITE_P(Both, Bullet, ::testing::Values("bullet-soft", "bullet-deformable"),
                         [](const auto& i) { return i.param == "bullet-soft" ? "soft" : "deformable"; });

}  // namespace
}  // namespace clothbench
