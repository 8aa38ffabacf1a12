// Relations of two runs: a solver that obeys them passes, and each planted fault violates its relation.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "runner/conformance.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// Falls like `ballistic`, with one selectable fault.
class Cheat : public StillSolver {
 public:
  enum class Fault { None, LiesAlongX, Numbering, Counts, SeesColliders, Remembers, NowhereByColliders, Fails };
  explicit Cheat(Fault fault) : StillSolver({}), fault_(fault) {
    info_.name = "cheat";
    info_.supports = kColliderFeatures | FeatureSet{Feature::Stretch, Feature::Shear, Feature::Bend,
                                                    Feature::Damping, Feature::Pins,  Feature::Friction};
  }
  static SolverEntry entry(Fault fault) {
    SolverEntry e;
    e.info = Cheat(fault).info_;
    e.make = [=](const json&, const DeviceOptions&) { return std::make_unique<Cheat>(fault); };
    return e;
  }
  void reset() override {
    StillSolver::reset();
    age_s_ = 0;
  }
  StepStatus step(const FrameInput& in) override {
    static int steps = 0;
    ++steps;
    if (fault_ == Fault::Fails) return StepStatus::Diverged;
    age_s_ += in.dt_s;
    for (std::size_t i = 0; i < state_.position.size(); ++i) {
      double& v = state_.velocity[i];
      v += scene_->gravity_m_per_s2[i % 3] * in.dt_s;
      if (fault_ == Fault::LiesAlongX && i % 3 == 0) v += 0.01 * scene_->gravity_m_per_s2[1] * in.dt_s;
      if (fault_ == Fault::Numbering && i >= 3 && i < 6) v *= 0.9;
      if (fault_ == Fault::Counts) v *= 1 + 1e-15 * steps;
      if (fault_ == Fault::SeesColliders) v *= 1 - 1e-4 * static_cast<double>(scene_->colliders.size());
      if (fault_ == Fault::Remembers) v += 20 * age_s_ * in.dt_s;
      state_.position[i] += v * in.dt_s;
    }
    if (fault_ == Fault::NowhereByColliders && !scene_->colliders.empty()) state_.position[0] = std::nan("");
    return StepStatus::Ok;
  }
  bool restart(const ClothState& state) override {
    age_s_ = 0;
    state_ = state;
    return fault_ != Fault::Counts;
  }

 private:
  Fault fault_;
  double age_s_ = 0;
};

using Fault = Cheat::Fault;

/// "pass", "unsupported" or the fault.
std::string found(Fault fault, const std::string& relation) {
  const SolverEntry entry = Cheat::entry(fault);
  ConformanceCase c;
  c.scene = "conformance/sheet";
  c.relation = relation;
  const ConformanceResult r = run_conformance(entry, json::object(), {}, conformance_scene(c, "cheat"), c);
  return !r.unsupported.empty() ? "unsupported" : r.faults.empty() ? "pass" : r.faults.front();
}

TEST(Relations, FreeFallKeepsAll) {
  for (const char* relation : {"repeat", "restart", "mirror", "renumber", "no-op", "small", "large"})
    EXPECT_EQ(found(Fault::None, relation), "pass") << relation;
}

TEST(Relations, EachFaultBreaksItsRelation) {
  const std::pair<Fault, const char*> kFaults[] = {{Fault::LiesAlongX, "mirror"}, {Fault::Numbering, "renumber"},
                                                   {Fault::Counts, "repeat"},     {Fault::SeesColliders, "no-op"},
                                                   {Fault::Remembers, "restart"}, {Fault::Remembers, "small"}};
  for (const auto& [fault, relation] : kFaults)
    EXPECT_NE(found(fault, relation).find("a vertex is"), std::string::npos) << relation;
  EXPECT_EQ(found(Fault::Numbering, "mirror"), "pass");
  EXPECT_EQ(found(Fault::Counts, "restart"), "unsupported") << "the solver reports that it cannot restart";
}

TEST(Relations, ANanAtOneVertexIsNotLostAmongTheOthers) {
  EXPECT_NE(found(Fault::NowhereByColliders, "no-op").find("a vertex is nan"), std::string::npos);
}

TEST(Relations, AFrameThatFailsEndsTheCase) { EXPECT_THROW(found(Fault::Fails, "repeat"), SolverError); }

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
