// The validation layer (1.3.239) does not see a missing barrier between kernels that update a buffer in place, and
// lavapipe, which runs dispatches one after another, does not show it. So the recorded commands are checked here:
// accesses from the kernels' own code, barriers with the very masks that were recorded.
#include <algorithm>

#include "contact_scenes.hpp"
#include "mesh_scene.hpp"
#include "recorded_access.hpp"

namespace clothbench::pbd_gpu {
namespace {

struct SolverRun {
  std::string solver;
  nlohmann::json settings;
  Scene scene;
};

std::vector<SolverRun> runs() {
  const Scene plain = sheet(7, 5), full = with_pins(with_damping(with_bending(sheet(7, 5))));
  return {{"paper", {{"iterations", 2}}, plain},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, full},
          {"paper", {{"iterations", 2}, {"readback", "blocking"}}, doubled(full)},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, everything(full)},
          {"paper", {{"iterations", 2}, {"substeps", 2}}, moving(doubled(full), {3, 20}, 2)},
          {"xpbd", {{"substeps", 2}}, plain},
          {"xpbd", {{"substeps", 2}}, full},
          {"xpbd", {{"substeps", 2}, {"iterations", 2}}, full},
          {"xpbd", {{"substeps", 2}}, everything(full)},
          {"xpbd", {{"substeps", 2}}, folded(full, 0.1, kContactFriction)},
          {"xpbd", {{"substeps", 2}}, mesh_sheet(7)},
          {"xpbd", {{"substeps", 2}}, with_bending(mesh_sheet(7))},
          {"xpbd", {{"substeps", 2}}, everything(mesh_sheet(7))},
          {"xpbd", {{"substeps", 2}}, everything(with_bending(mesh_sheet(7)))},
          {"xpbd", {{"substeps", 2}}, folded(with_pins(sheet(9, 7)), 0.1, 0.3)},
          {"xpbd", {{"substeps", 2}}, everything(folded(with_pins(sheet(9, 7))))},
          {"xpbd", {{"substeps", 2}}, with_pins(with_damping(uneven(sheet(17, 5), 3, 1e-3)))},
          {"xpbd", {{"substeps", 2}}, moving(with_collider(full, sphere({0, 0, 0}, 0.1)), {3, 20}, 2)}};
}

using Barriers = Gpu;

TEST_F(Barriers, KernelsDoWithBuffersWhatTheirQualifiersAndBindingsSay) {
  for (const SolverRun& run : runs()) {
    const auto solver = make(run.solver, run.settings);
    solver->load(run.scene);
    for (const auto& r : solver->frame_program().recorded()) {
      if (r.kernel == nullptr) continue;
      const std::vector<BufferUse> uses = uses_of(r.kernel->code());
      ASSERT_EQ(uses.size(), r.kernel->bindings().size()) << r.kernel->name();
      for (const BufferUse& u : uses) {
        const vulkan::Access declared = binding_of(*r.kernel, u.binding).access;
        const std::string where = r.kernel->name() + " binding " + std::to_string(u.binding);
        EXPECT_EQ(u.read, declared != vulkan::Access::Write) << where;
        EXPECT_EQ(u.written, declared != vulkan::Access::Read) << where;
      }
    }
  }
}

TEST_F(Barriers, NoneIsMissingAndNoneIsThereInVain) {
  for (const SolverRun& run : runs()) {
    const auto solver = make(run.solver, run.settings);
    solver->load(run.scene);
    const vulkan::Program *up = &solver->upload_program(), *frame = &solver->frame_program(),
                          *down = &solver->download_program();
    const std::vector<Event> events = time_line({up, down, frame, frame, down, frame, up, frame, down});
    EXPECT_EQ(hazard(events), "") << run.solver << run.settings;
    int dropped = 0;
    for (const vulkan::Program* p : {up, frame, down}) {
      const auto& recorded = p->recorded();
      const auto barriers = std::count_if(recorded.begin(), recorded.end(), [](const auto& r) { return r.is_barrier; });
      ASSERT_GT(barriers, 0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(barriers); ++k, ++dropped)
        EXPECT_NE(hazard(events, {p, k}), "")
            << run.solver << run.settings << ": without barrier " << k << " of " << barriers;
    }
    EXPECT_GE(dropped, 4) << "before and after what each program does";
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
