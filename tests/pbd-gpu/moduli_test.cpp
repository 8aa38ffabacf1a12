// The modulus of elastic sheets is the scene's, at every resolution: a sheet that shears hangs to rest by its weight.
#include "gpu_fixture.hpp"
#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

class Moduli : public Gpu, public ::testing::WithParamInterface<const char*> {
 protected:
  /// Error of the stretch of the lower half, over the exact one; there E is the only modulus that counts.
  static double error(const nlohmann::json& settings) {
    const Scene s =
        load_scene("validation/heavy-strip", {"material.shear=true", std::string("cloth.grid=") + GetParam()});
    const auto solver = make("xpbd", settings);
    solver->load(s);
    return TruthJudge(s).judge(s.time.frames(), after(*solver, s, s.time.frames())).quantity_error;
  }
};

TEST_P(Moduli, AreTheScenesAtDefaultAndFast) {
  EXPECT_LE(error(nlohmann::json::object()), 0.02);
  EXPECT_LE(error({{"quality", "fast"}}), 0.06);
}

TEST_P(Moduli, WithoutCouplingAreFarOff) {
  EXPECT_GE(error({{"tuning", {{"splitting_correction", "never"}}}}), 0.1) << "the coupling does nothing";
}

INSTANTIATE_TEST_SUITE_P(Grids, Moduli, ::testing::Values("[33,5]", "[65,9]"));

}  // namespace
}  // namespace clothbench::pbd_gpu
