// The counted bytes of every stage are what an instrumented build of the same kernels counts, access by access.
#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

class Bytes : public Gpu {
 protected:
  void expect_equal(const std::string& solver_name, const Scene& scene, const nlohmann::json& settings) {
    const auto solver = make(solver_name, settings, true);
    solver->load(scene);
    after(*solver, scene, 1);
    const std::vector<Traffic> counted = solver->counted();
    const Plan plan = solver->plan();
    ASSERT_EQ(counted.size(), plan.stages.size());
    for (std::size_t k = 0; k < counted.size(); ++k) {
      const StagePlan& s = plan.stages[k];
      if (s.dispatches == 0) continue;  // a copy, not a kernel
      EXPECT_EQ(counted[k].read_B, s.read_B)
          << solver_name << " " << s.name << " " << scene.cloth.columns << "x" << scene.cloth.rows;
      EXPECT_EQ(counted[k].write_B, s.write_B)
          << solver_name << " " << s.name << " " << scene.cloth.columns << "x" << scene.cloth.rows;
      EXPECT_GT(s.read_B, 0) << s.name;
    }
  }
};

TEST_F(Bytes, OfEveryStageAtManySizes) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 9}, {7, 5}, {8, 8}, {33, 17}, {64, 64}}) {
    const Scene plain = sheet(columns, rows), full = with_pins(with_damping(with_bending(sheet(columns, rows))));
    for (const Scene& s : {plain, full}) {
      // One lap each of contended compare-and-swap would not be counted: one constraint iteration has contention, yet
      // the first attempt of every sum is counted exactly once.
      expect_equal("paper", s, {{"iterations", 2}});
      expect_equal("xpbd", s, {{"substeps", 2}});
      expect_equal("xpbd", s, {{"substeps", 2}, {"iterations", 3}});
    }
    Scene doubled = full;
    doubled.cloth.sides = Sides::DoubleDuplicated;
    doubled.needs.add(Feature::DuplicatedLayer);
    expect_equal("paper", doubled, {{"iterations", 1}, {"readback", "blocking"}});
  }
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
