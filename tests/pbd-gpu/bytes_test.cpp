// The computed bytes of every stage are what an instrumented build of the same kernels counts, access by access; of
// stages that say so, no more than that. Pinned and held vertices count as written.
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {
namespace {

using Bytes = Gpu;

struct Row {
  const char* solver;
  Scene scene;
  nlohmann::json settings;
  bool all_free = true;  ///< then the numbers are equal
};

std::vector<Row> rows() {
  const Scene plain = sheet(7, 5), bent = with_damping(with_bending(sheet(33, 17)));
  const nlohmann::json springs = {{"substeps", 2}, {"tuning", {{"membrane", "never"}}}};
  Scene mesh = mesh_sheet(12), bending_mesh = with_damping(with_bending(mesh_sheet(12)));
  for (Scene* s : {&mesh, &bending_mesh}) {
    s->pins.vertices.clear();
    s->needs = s->needs - FeatureSet{Feature::Pins};
  }
  return {{"paper", plain, {{"iterations", 2}}},
          {"paper", bent, {{"iterations", 2}}},
          {"paper", doubled(bent), {{"iterations", 1}, {"readback", "blocking"}}},
          {"paper", everything(sheet(9, 7)), {{"substeps", 2}}},
          {"paper", everything(sheet(33, 17), 0), {{"substeps", 2}}},
          {"xpbd", plain, {{"substeps", 2}}},
          {"xpbd", bent, {{"substeps", 2}}},
          {"xpbd", sheet(33, 9), {{"substeps", 2}, {"tuning", {{"splitting_correction", "always"}}}}},
          {"xpbd", with_pins(bent), {{"substeps", 2}}, false},
          {"xpbd", mesh, springs},
          {"xpbd", bending_mesh, springs, false},
          {"xpbd", bending_mesh, {{"substeps", 2}}, false},
          {"xpbd", with_pins(uneven(sheet(17, 9), 3, 1e-3)), {{"substeps", 2}}, false},
          {"xpbd", everything(with_pins(sheet(9, 7))), {{"substeps", 2}}, false},
          {"xpbd", folded(with_pins(sheet(9, 7))), {{"substeps", 1}}, false},
          {"xpbd", with_collider(mesh_sheet(9), sphere({0, -0.1, 0}, 0.08)), {{"substeps", 2}}, false}};
}

TEST_F(Bytes, AreWhatInstrumentedKernelsCount) {
  for (const Row& row : rows()) {
    const auto solver = make(row.solver, row.settings, true);
    solver->load(row.scene);
    after(*solver, row.scene, 1);
    const Plan plan = solver->plan();
    const FrameCost cost = solver->last_cost();
    const std::vector<Traffic> counted = solver->counted();
    ASSERT_EQ(counted.size(), plan.stages.size());
    for (std::size_t k = 0; k < counted.size(); ++k) {
      const StagePlan& s = plan.stages[k];
      if (s.dispatches == 0) continue;  // a copy, not a kernel
      SCOPED_TRACE(std::string(row.solver) + " " + s.name + " " + row.settings.dump());
      const double read = cost.stage_read_B[k], written = cost.stage_write_B[k];
      EXPECT_GT(read, 0);
      if (s.at_least || row.all_free) {
        EXPECT_GE(counted[k].read_B, read);
        EXPECT_GE(counted[k].write_B, written);
      }
      if (s.at_least) continue;
      EXPECT_LE(counted[k].read_B, read);
      EXPECT_LE(counted[k].write_B, written);
      EXPECT_GE(counted[k].read_B + counted[k].write_B, 0.8 * (read + written));
    }
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
