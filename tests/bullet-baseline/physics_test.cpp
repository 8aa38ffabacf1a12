#include <algorithm>

#include "bullet.hpp"
#include "refusal.hpp"

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

TEST_P(Bullet, TellsTheMarginThatItKeepsInsteadOfTheScenes) {
  Scene s = with_collider(sheet(5, 4), floor_below(-0.5));
  s.colliders.push_back(s.colliders[0]);
  s.colliders[1].margin_m = 0.01;
  const auto plan = [&](const nlohmann::json& settings) {
    const auto solver = make_solver(GetParam(), settings);
    solver->load(s);
    Plan p = solver->plan();
    std::erase_if(p.left_out, [](const LeftOut& l) { return l.what.find("margin of 0.01 m") == std::string::npos; });
    return p;
  };
  const Plan by_default = plan(nlohmann::json::object()), of_scene = plan({{"collision_margin_m", 0.0}});
  EXPECT_EQ(by_default.contact_margins_m, (std::vector<double>{0.02, 0.02}));
  EXPECT_EQ(plan({{"collision_margin_m", 0.003}}).contact_margins_m, (std::vector<double>{0.003, 0.003}));
  EXPECT_EQ(of_scene.contact_margins_m, (std::vector<double>{0.01, 0.01})) << "one for all: the widest";
  ASSERT_EQ(by_default.left_out.size(), 1U);
  EXPECT_PRED2(mentions, by_default.left_out[0].what, "floor");
  EXPECT_PRED2(mentions, by_default.left_out[0].why, "collision_margin_m = 0.02 m");
  EXPECT_TRUE(of_scene.left_out.empty());
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
    const ClothState state = from_start(*solver, s, 36);
    const double fall = entry.free_fall_m(s, complete_settings(entry.info, nlohmann::json::object()), 36);
    // Positions are float32, and the deformable body takes up to 70 substeps per frame here.
    EXPECT_LE(free_fall_error(s, state, 36, fall), 5e-5) << columns;
  }
}

/// A sheet that starts stretched and moving, without gravity: it contracts, and its centre of mass moves on uniformly.
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
      state = run_frames(*solver, s, f, f + 1);
      narrowest = std::min(narrowest, vertex_at(state.position, static_cast<std::size_t>(columns) - 1)[0] -
                                          vertex_at(state.position, 0)[0]);
    }
    EXPECT_LT(narrowest, 1.02) << "links have the scene's rest lengths, not the lengths of the start";
    expect_momentum_kept(s, state, 0.5, 5e-4 * length(s.cloth.initial_velocity_m_per_s), 1e-4 * s.cloth.width_m);
  }
}

TEST_P(Bullet, HangsWithBoundedStretchAndFixedPins) {
  for (const auto& [columns, rows] : kSizes) {
    const Scene s = with_pins(with_damping(with_bending(sheet(columns, rows))));
    const auto solver = make_solver(GetParam());
    const ClothState state = from_start(*solver, s, 144);
    const std::vector<double> start = initial_positions(s);
    for (std::uint32_t v : s.pins.vertices) EXPECT_EQ(vertex_at(state.position, v), vertex_at(start, v));
    double most = 0, lowest = 0;
    for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
      const Vec3 a = vertex_at(state.position, e.a), b = vertex_at(state.position, e.b);
      const double strain = length(minus(a, b)) / e.rest_m - 1;
      ASSERT_TRUE(std::isfinite(strain));
      most = std::max(most, strain);
      lowest = std::min({lowest, a[1], b[1]});
    }
    EXPECT_LT(most, 0.3) << columns;
    EXPECT_LT(lowest, -0.2) << "it does hang";
  }
}

TEST(BulletDeformable, UniaxialStiffnessIsYOnSquareAndOblongCells) {
  expect_uniaxial_stiffness([] { return make_solver("bullet-deformable"); });
}

TEST(BulletDeformable, ImplicitStepsHangLikeExplicitOnes) {
  const Scene s = with_pins(with_damping(with_bending(sheet(9, 9)), 3));
  const auto a = make_solver("bullet-deformable"), b = make_solver("bullet-deformable", {{"implicit", true}});
  const ClothState x = from_start(*a, s, 288), y = from_start(*b, s, 288);
  EXPECT_NEAR(vertex_at(x.position, 76)[1], vertex_at(y.position, 76)[1], 0.02);
  EXPECT_LT(vertex_at(x.position, 76)[1], -0.5);
}

INSTANTIATE_TEST_SUITE_P(Both, Bullet, ::testing::Values("bullet-soft", "bullet-deformable"),
                         [](const auto& i) { return i.param == "bullet-soft" ? "soft" : "deformable"; });

}  // namespace
}  // namespace clothbench
