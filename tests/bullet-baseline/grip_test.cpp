#include "sheets.hpp"

namespace clothbench {
namespace {

constexpr int kHeld = 36;

/// Two corners of a sheet on straight ways: held for kHeld frames, then let go.
Scene gripped() {
  Scene s = with_damping(with_bending(sheet(9, 7)));
  s.grips.vertices = {0, 8};
  s.needs.add(Feature::MovingPins);
  const std::vector<double> start = initial_positions(s);
  for (int f = 0; f <= s.time.frames(); ++f) {
    FrameMotion m;
    for (std::size_t k = 0; k < 2; ++k) {
      Vec3 at = vertex(start, s.grips.vertices[k]);
      const double way = std::min(f, kHeld) * 0.001;
      at[0] += k == 0 ? -way : way;
      at[1] += 0.5 * way;
      m.grip_position_m.push_back(at);
      m.grip_held.push_back(f < kHeld ? 1 : 0);
    }
    s.motion.push_back(m);
  }
  return s;
}

TEST_P(Bullet, HeldVerticesAreWhereTheHandIsAndFallOnceLetGo) {
  const Scene s = gripped();
  const auto solver = make_solver(GetParam());
  solver->load(s);
  ClothState state;
  for (int f = 0; f < kHeld; ++f) {
    state = run(*solver, s, f, f + 1);
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3 at = vertex(state.position, s.grips.vertices[k]), hand = s.motion_after(f)->grip_position_m[k];
      EXPECT_LE(norm({at[0] - hand[0], at[1] - hand[1], at[2] - hand[2]}), 2e-6) << "frame " << f;
    }
  }
  const double height = vertex(state.position, 0)[1];
  state = run(*solver, s, kHeld, kHeld + 18);
  EXPECT_LT(vertex(state.position, 0)[1], height - 0.05);
  for (double x : state.position) ASSERT_TRUE(std::isfinite(x));

  solver->reset();
  const ClothState again = run(*solver, s, 0, kHeld + 18);
  EXPECT_EQ(again.position, state.position) << "what was let go is held again";
}

TEST_P(Bullet, AVertexLetGoFallsFreely) {
  // Nothing pulls at a sheet all of whose vertices are held, and then none.
  Scene s = sheet(3, 3, 0.2, 0.2);
  for (std::uint32_t v = 0; v < 9; ++v) s.grips.vertices.push_back(v);
  s.needs.add(Feature::MovingPins);
  const std::vector<double> start = initial_positions(s);
  for (int f = 0; f <= s.time.frames(); ++f) {
    FrameMotion m;
    for (std::uint32_t v = 0; v < 9; ++v) {
      m.grip_position_m.push_back(vertex(start, v));
      m.grip_held.push_back(f < 4 ? 1 : 0);
    }
    s.motion.push_back(m);
  }
  const SolverEntry& entry = entry_of(GetParam());
  const auto solver = make_solver(GetParam());
  const ClothState held = after(*solver, s, 4);
  EXPECT_EQ(held.position, after(*make_solver(GetParam()), s, 0).position);
  const ClothState state = run(*solver, s, 4, 22);
  const double fall = entry.free_fall_m(s, complete_settings(entry.info, nlohmann::json::object()), 18);
  for (std::size_t k = 0; k < start.size(); ++k)
    EXPECT_NEAR(state.position[k] - held.position[k], k % 3 == 1 ? fall : 0, 1e-4 * std::abs(fall));
}

}  // namespace
}  // namespace clothbench
