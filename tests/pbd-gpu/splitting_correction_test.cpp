// Splitting-error correction: where it is off, why, and that it costs nothing there.
#include <cmath>

#include "contact_scenes.hpp"
#include "gpu_fixture.hpp"
#include "mesh_scene.hpp"
#include "xpbd/time/integrator.hpp"
#include "xpbd/time/substep_count.hpp"

namespace clothbench::pbd_gpu {
namespace {

class SplittingCorrection : public Gpu {
 protected:
  /// Why the plan has none ("" where it has), and that its buffers are there if and only if it is on.
  static std::string reason(const Scene& s, const nlohmann::json& given = nlohmann::json::object()) {
    const auto solver = make("xpbd", given);
    solver->load(s);
    std::string why;
    for (const LeftOut& l : solver->plan().left_out)
      if (l.what == "splitting correction") {
        why = l.why;
        const bool sheet = s.material.membrane_stiffness_N_per_m && s.needs.has(Feature::Shear);
        EXPECT_EQ(l.no_parameter, sheet ? "sheet_Y" : "") << "the modulus of an elastic sheet is below Y without it";
      }
    int buffers = 0;
    for (const auto& b : solver->plan().buffers)
      buffers += b.name == "creep of links" || b.name == "shifts by columns and rows";
    EXPECT_EQ(buffers, why.empty() ? 2 : 0) << why;
    return why;
  }
};

Scene square(int columns = 9, int rows = 9) {
  Scene s = with_pins(sheet(columns, rows, (columns - 1) / 16.0, (rows - 1) / 16.0));
  s.material.membrane_stiffness_N_per_m = 300;
  return s;
}

TEST_F(SplittingCorrection, IsOnlyWhereASheetNeedsItAndThePlanSaysWhy) {
  EXPECT_EQ(reason(square()), "");
  Scene s = square();
  s.material.membrane_stiffness_N_per_m.reset();
  EXPECT_EQ(reason(s), "the cloth is inextensible");
  s = square();
  s.needs = s.needs - FeatureSet{Feature::Shear};
  EXPECT_EQ(reason(s), "the scene has no shear stiffness");
  s = square();
  s.pins.vertices.clear();
  EXPECT_EQ(reason(s), "nothing holds the cloth: no tension lasts");
  EXPECT_EQ(reason(square(5, 4)), "fewer than four links across the cloth");
  EXPECT_EQ(reason(with_pins(sheet(9, 9, 1, 0.5))), "cells are not square");
  EXPECT_EQ(reason(with_collider(square(), sphere({0, 0, 0}, 0.1))), "the cloth touches");
  EXPECT_EQ(reason(with_pins(uneven(square(), 3, 0.2))), "links or masses are not all alike");
  EXPECT_EQ(reason(square(), {{"time_order", 1}}), "setting time_order=1");
  s = square(33, 33);
  s.material.membrane_stiffness_N_per_m = 1000;
  EXPECT_EQ(reason(s, {{"substeps", 1}}),
            "a wave crosses too many cells in a substep: the modulus of the sheet is below Y");
  EXPECT_EQ(reason(square(), {{"tuning", {{"splitting_correction", "never"}}}}),
            "setting tuning.splitting_correction=never");
}

}  // namespace
}  // namespace clothbench::pbd_gpu
