#include <gtest/gtest.h>

#include "runner/solver_run.hpp"

namespace clothbench {
namespace {

TEST(StageCheck, FindsTheExtraAndTheMissing) {
  Scene scene;
  scene.needs = {Feature::Stretch, Feature::Bend};
  SolverInfo info;
  Plan plan;
  plan.stages = {{"integrate", {}, 1, 0, 0}, {"project", {Feature::Stretch, Feature::Bend}, 1, 0, 0}};
  EXPECT_EQ(check_stages(scene, info, plan), "");

  plan.stages.push_back({"collide", {Feature::Sphere}, 1, 0, 0});
  EXPECT_NE(check_stages(scene, info, plan).find("collide serves sphere"), std::string::npos) << "a stage too many";

  plan.stages = {{"integrate", {}, 1, 0, 0}, {"project", {Feature::Stretch}, 1, 0, 0}};
  EXPECT_NE(check_stages(scene, info, plan).find("no stage serves bend"), std::string::npos) << "a stage missing";

  info.ignores = {Feature::Bend};
  EXPECT_EQ(check_stages(scene, info, plan), "") << "what a backend declares to ignore is not missed";
  plan.stages.clear();
  EXPECT_NE(check_stages(scene, info, plan), "");
}

}  // namespace
}  // namespace clothbench
