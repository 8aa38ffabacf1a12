// Counted bytes have a closed form if every vertex takes the same path, and counting leaves results bit-identical.
#include <map>

#include "contact_scenes.hpp"
#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Bytes = Gpu;

struct Stage {
  double read_B, written_B;
};

/// Bytes of each stage in the second frame.
std::map<std::string, Stage> counted(GpuSolver& solver, const Scene& scene) {
  after(solver, scene, 2);
  std::map<std::string, Stage> all;
  const auto [cost, plan] = std::pair(solver.last_cost(), solver.plan());
  for (std::size_t k = 0; k < plan.stages.size(); ++k)
    all[plan.stages[k].name] = {cost.stage_read_B[k], cost.stage_write_B[k]};
  return all;
}

TEST_F(Bytes, AreClosedFormsOfSimpleKernels) {
  const Scene s = with_damping(sheet(7, 5));
  const double n = 35, vertex = 16;
  const auto paper = make("paper", {{"iterations", 2}, {"count_bytes", true}}),
             xpbd = make("xpbd", {{"substeps", 3}, {"count_bytes", true}});
  paper->load(s);
  xpbd->load(s);
  const auto of_paper = counted(*paper, s), of_xpbd = counted(*xpbd, s);
  const auto expect = [](const Stage& found, double read_B, double written_B) {
    EXPECT_EQ(found.read_B, read_B);
    EXPECT_EQ(found.written_B, written_B);
  };
  expect(of_paper.at("ApplyExternalForces"), vertex * n, vertex * n);
  expect(of_paper.at("DampVelocities"), vertex * n, vertex * n);
  expect(of_paper.at("ApplyExplicitEuler"), 2 * vertex * n, vertex * n);
  expect(of_paper.at("AverageConstraintDeltas"), 2 * 2 * vertex * n, 2 * 2 * vertex * n);
  expect(of_paper.at("UpdatePositions"), 2 * vertex * n, 2 * vertex * n);
  // Positions and velocities, their rounding errors, and their values before the last substep.
  expect(of_xpbd.at("Lines"), 6 * vertex * n, 6 * vertex * n);
}

TEST_F(Bytes, AreTheSameEveryTimeAndCountingChangesNoBit) {
  struct Row {
    const char* solver;
    Scene scene;
    nlohmann::json settings;
  };
  const Scene bent = with_pins(with_damping(with_bending(sheet(33, 17))));
  for (const Row& row : {Row{"xpbd", bent, {}},
                         {"xpbd", with_damping(with_bending(mesh_sheet(12))), {}},
                         {"xpbd", everything(with_pins(sheet(9, 7))), {}},
                         {"xpbd", folded(with_pins(sheet(9, 7))), {}},
                         {"paper", everything(sheet(9, 7)), {{"readback", "blocking"}}}}) {
    nlohmann::json counting = row.settings;
    counting["count_bytes"] = true;
    const auto plain = make(row.solver, row.settings), first = make(row.solver, counting),
               second = make(row.solver, counting);
    for (const auto* solver : {&plain, &first, &second}) (*solver)->load(row.scene);
    const auto once = counted(*first, row.scene), again = counted(*second, row.scene);
    after(*plain, row.scene, 2);
    const bool sums_by_atomics = std::string(row.solver) == "paper";  // in no fixed order
    for (const auto& [name, stage] : once) {
      SCOPED_TRACE(std::string(row.solver) + " " + name);
      EXPECT_GT(stage.read_B, 0);
      EXPECT_GT(stage.written_B, 0);
      if (sums_by_atomics) continue;
      // Threads list pairs of contacts in the order in which they find them, and some searches in a list end early.
      const double tolerance = name == "ContactSubstep" ? 1e-3 : 0;
      EXPECT_NEAR(stage.read_B, again.at(name).read_B, tolerance * stage.read_B);
      EXPECT_NEAR(stage.written_B, again.at(name).written_B, tolerance * stage.written_B);
    }
    EXPECT_TRUE(std::isnan(plain->last_cost().stage_read_B.front()));
    if (sums_by_atomics) continue;
    EXPECT_EQ(after(*plain, row.scene, 1).position, after(*first, row.scene, 1).position);
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
