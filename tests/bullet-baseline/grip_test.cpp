#include "sheets.hpp"

namespace clothbench {
namespace {

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
