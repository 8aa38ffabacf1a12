#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

TEST(GroupCount, RoundsUpAndKnowsTheLimit) {
  EXPECT_EQ(vulkan::group_count(1, 64), 1u);
  EXPECT_EQ(vulkan::group_count(64, 64), 1u);
  EXPECT_EQ(vulkan::group_count(65, 64), 2u);
  EXPECT_EQ(vulkan::group_count(65535ull * 64, 64), 65535u);
  EXPECT_THROW(vulkan::group_count(65535ull * 64 + 1, 64), Error);
  EXPECT_THROW(vulkan::group_count(~0ull / 2, 64), Error);
}

TEST_F(Gpu, ListIsNotEmptyAndBadIndexIsNoDevice) {
  EXPECT_FALSE(vulkan::Device::list().empty());
  try {
    vulkan::Device::get({1000, false});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::NoDevice);
  }
}

TEST_F(Gpu, BadSettingsAreRefused) {
  for (const auto& given : {nlohmann::json{{"iterations", 0}}, {{"stiffness", 1.5}}, {{"readback", "maybe"}}, {{"atomics", "none"}}})
    EXPECT_THROW(make("paper", given), Error) << given;
  for (int substeps : {0, -3, 5000}) EXPECT_THROW(make("xpbd", {{"substeps", substeps}}), Error);
}

TEST_F(Gpu, GravityOnlyHasNoContactKernelNorBuffer) {
  const Scene s = sheet(8, 8);
  for (const char* name : {"paper", "xpbd"}) {
    const auto solver = make(name);
    solver->load(s);
    const Plan plan = solver->plan();
    for (const StagePlan& stage : plan.stages) EXPECT_TRUE((stage.serves & kColliderFeatures).empty()) << stage.name;
    for (const char* word : {"ollision", "ollider", "ontact", "apsule", "amp", "end"}) {
      for (const StagePlan& stage : plan.stages) EXPECT_EQ(stage.name.find(word), std::string::npos) << stage.name;
      for (const BufferPlan& b : plan.buffers) EXPECT_EQ(b.name.find(word), std::string::npos) << b.name;
    }
    EXPECT_FALSE(plan.left_out.empty()) << "what is left out is said";
  }
}

TEST_F(Gpu, BlockingReadbackIsAStageOfItsOwn) {
  const Scene s = sheet(8, 8);
  const auto with = make("paper", {{"readback", "blocking"}}), without = make("paper");
  with->load(s);
  without->load(s);
  EXPECT_EQ(with->plan().stages.size(), without->plan().stages.size() + 1);
  EXPECT_EQ(with->plan().stages.back().name, "Readback");
  EXPECT_EQ(with->plan().stages.back().read_B, 2 * 16 * 64);
}

TEST_F(Gpu, StageTimesAddUpToTheFrame) {
  if (!device_->has_timestamps()) GTEST_SKIP() << "no timestamps on this queue";
  const Scene s = with_bending(sheet(33, 17));
  for (const char* name : {"paper", "xpbd"}) {
    const auto solver = make(name, {{"stage_times", true}});
    solver->load(s);
    after(*solver, s, 2);
    const FrameCost cost = solver->last_cost();
    double sum = 0;
    for (double t : cost.stage_device_s) sum += t;
    EXPECT_GT(cost.device_s, 0);
    EXPECT_NEAR(sum, cost.device_s, 1e-6 * cost.device_s);
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
