// The computed bytes of every stage are what an instrumented build of the same kernels counts, access by access; of
// stages that say so, no more than that.
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {
namespace {

class Bytes : public Gpu {
 protected:
  void expect_equal(const std::string& solver_name, const Scene& scene, const nlohmann::json& settings,
                    int frames = 1) {
    const auto solver = make(solver_name, settings, true);
    solver->load(scene);
    const Plan plan = solver->plan();
    std::vector<Traffic> costs(plan.stages.size());
    for (int f = 0; f < frames; ++f) {
      after_frame(*solver, scene, f);
      const FrameCost cost = solver->last_cost();
      for (std::size_t k = 0; k < costs.size(); ++k) {
        costs[k].read_B += cost.stage_read_B[k];
        costs[k].write_B += cost.stage_write_B[k];
      }
    }
    const std::vector<Traffic> counted = solver->counted();
    ASSERT_EQ(counted.size(), plan.stages.size());
    for (std::size_t k = 0; k < counted.size(); ++k) {
      const StagePlan& s = plan.stages[k];
      if (s.dispatches == 0) continue;  // a copy, not a kernel
      // How many pairs are near is the cloth's affair: what is declared there is what every frame reads and writes.
      EXPECT_EQ(s.at_least, solver_name == "xpbd" && (s.name == "PlanePairs" || s.name == "PlaneContact")) << s.name;
      if (s.at_least) {
        EXPECT_GE(counted[k].read_B, costs[k].read_B);
        EXPECT_GE(counted[k].write_B, costs[k].write_B);
        EXPECT_GT(costs[k].read_B, 0);
      } else {
        EXPECT_EQ(counted[k].read_B, costs[k].read_B)
            << solver_name << " " << s.name << " " << scene.cloth.columns << "x" << scene.cloth.rows;
        EXPECT_EQ(counted[k].write_B, costs[k].write_B)
            << solver_name << " " << s.name << " " << scene.cloth.columns << "x" << scene.cloth.rows;
      }
      EXPECT_GT(s.read_B, 0) << s.name;
    }
  }
};

TEST_F(Bytes, OfEveryStageAtManySizes) {
  std::size_t number = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 9}, {7, 5}, {8, 8}, {33, 17}, {64, 64}}) {
    const Scene plain = sheet(columns, rows), full = with_pins(with_damping(with_bending(sheet(columns, rows))));
    for (const Scene& s : {plain, full}) {
      if (!in_turn(number++)) continue;
      // One lap each of contended compare-and-swap would not be counted: one constraint iteration has contention, yet
      // the first attempt of every sum is counted exactly once.
      expect_equal("paper", s, {{"iterations", 2}});
      expect_equal("xpbd", s, {{"substeps", 2}});
      expect_equal("xpbd", s, {{"substeps", 2}, {"iterations", 3}});
    }
    expect_equal("paper", doubled(full), {{"iterations", 1}, {"readback", "blocking"}});
  }
}

TEST_F(Bytes, OfCoupledFamilies) {
  expect_equal("xpbd", with_pins(sheet(7, 5)), {{"substeps", 2}, {"tuning", {{"coupling", "always"}}}});
  expect_equal("xpbd", with_pins(sheet(6, 9)),
               {{"substeps", 2}, {"one_dispatch", false}, {"tuning", {{"coupling", "always"}}}});
}

TEST_F(Bytes, OfChains) {
  const nlohmann::json springs = {{"membrane", "never"}};
  expect_equal("xpbd", mesh_sheet(20), {{"substeps", 2}, {"tuning", springs}});
  expect_equal("xpbd", with_damping(mesh_tube(12, 9)), {{"substeps", 3}});
  expect_equal("xpbd", mesh_sheet(12), {{"substeps", 3}, {"tuning", {{"device_barrier", "always"}}}});
  const Scene bends = with_damping(with_bending(mesh_sheet(12)));
  expect_equal("xpbd", bends, {{"substeps", 2}});
  expect_equal("xpbd", bends, {{"substeps", 2}, {"tuning", springs}});
  expect_equal("xpbd", bends, {{"substeps", 2}, {"tuning", {{"device_barrier", "always"}}}});
  Scene stiff = bends;
  stiff.material.bending_rigidity_N_m = 0.1;
  expect_equal("xpbd", stiff, {{"substeps", 2}});
  expect_equal("xpbd", with_pins(uneven(sheet(17, 9), 3, 0.2)), {{"substeps", 2}});
  expect_equal("xpbd", with_pins(uneven(sheet(17, 9), 3, 1e-3)), {{"substeps", 2}});
}

TEST_F(Bytes, OfChainsThatAreSolvedAgain) {
  for (const char* barrier : {"never", "always"}) {
    const Scene touching = with_collider(mesh_sheet(9), sphere({0, -0.1, 0}, 0.08, kContactFriction));
    expect_equal("xpbd", touching, {{"substeps", 2}, {"tuning", {{"device_barrier", barrier}}}}, 2);
  }
}

TEST_F(Bytes, OfContactWithAndWithoutFriction) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {9, 7}, {33, 17}})
    for (double friction : {0.0, kContactFriction})
      expect_equal("paper", everything(with_pins(sheet(columns, rows)), friction), {{"substeps", 2}}, 2);
}

TEST_F(Bytes, OfContactInXpbdAreCertainOrMore) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {9, 7}, {33, 17}})
    for (const Scene& s : {everything(with_pins(sheet(columns, rows))),
                           moving(with_collider(with_pins(sheet(columns, rows)), sphere({0, 0.3, 0}, 0.1)), {2}, 1)})
      expect_equal("xpbd", s, {{"substeps", 2}}, 2);
}

TEST_F(Bytes, OfSelfContactAreCertainOrMore) {
  for (const auto& [columns, rows] : {std::pair{3, 2}, {9, 7}, {12, 17}})
    expect_equal("xpbd", folded(with_pins(sheet(columns, rows))), {{"substeps", 1}}, 2);
}

TEST_F(Bytes, OfHeldVerticesBeforeAndAfterTheyAreLetGo) {
  const Scene s = moving(doubled(with_pins(sheet(7, 5))), {1, 2, 20}, 2);
  for (int frames : {1, 2, 3, 4}) expect_equal("paper", s, {{"iterations", 1}, {"substeps", 2}}, frames);
}

TEST_F(Bytes, WithNativeAtomicsWhereTheDeviceHasThem) {
  const Scene s = sheet(7, 5);
  if (!device_->has_float_atomics()) {
    EXPECT_THROW(make("paper", {{"atomics", "native"}})->load(s), Error) << "what a device cannot do is said";
    return;
  }
  expect_equal("paper", s, {{"atomics", "native"}});
}

}  // namespace
}  // namespace clothbench::pbd_gpu
