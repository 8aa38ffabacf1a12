// The modulus of elastic sheets is the scene's, at every resolution: patches that hang and slide, to rest.
#include <cmath>

#include "gpu_fixture.hpp"
#include "metrics/material_patch.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// The patch with `factor` times the cells.
Scene finer_patch(Patch patch, double factor) {
  nlohmann::json scene = nlohmann::json::parse(patch_scene(patch).json);
  for (nlohmann::json& n : scene["cloth"]["grid"]) n = std::lround((n.get<int>() - 1) * factor) + 1;
  return scene_from_json(scene, "a finer patch");
}

class Moduli : public Gpu, public ::testing::WithParamInterface<double> {
 protected:
  static std::map<std::string, double> measured(const nlohmann::json& settings) {
    std::map<std::string, double> all;
    for (const Patch patch : {Patch::HangU, Patch::HangV, Patch::Shear}) {
      const Scene s = finer_patch(patch, GetParam());
      const auto solver = make("xpbd", settings);
      solver->load(s);
      all.merge(patch_moduli(patch, s, after(*solver, s, s.time.frames()).position));
    }
    all["E_45"] = modulus_at_45(all);
    return all;
  }
};

TEST_P(Moduli, AreTheScenesAtDefaultAndFast) {
  const std::map<std::string, double> standard = measured(nlohmann::json::object()),
                                      fast = measured({{"quality", "fast"}});
  for (const char* name : {"E_0", "E_45", "E_90"}) {
    EXPECT_NEAR(standard.at(name), 1, 0.02) << name;
    EXPECT_NEAR(fast.at(name), 1, 0.06) << name;
  }
  EXPECT_NEAR(standard.at("nu"), 1.0 / 3, 0.02);
  EXPECT_NEAR(fast.at("nu"), 1.0 / 3, 0.1);
  EXPECT_NEAR(standard.at("G"), 0.375, 0.005);
}

TEST_P(Moduli, WithoutCouplingAreFarOff) {
  const std::map<std::string, double> m = measured({{"tuning", {{"splitting_correction", "never"}}}});
  EXPECT_LE(m.at("E_0"), 0.9) << "the coupling does nothing";
}

INSTANTIATE_TEST_SUITE_P(Cells, Moduli, ::testing::Values(0.5, 1.0, 2.0));

}  // namespace
}  // namespace clothbench::pbd_gpu
