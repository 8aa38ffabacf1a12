// Splitting-error correction: when it is off, why, and that it costs nothing then.

#include "contact_scenes.hpp"
#include "gpu_fixture.hpp"
#include "mesh_scene.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

class SplittingCorrection : public Gpu {
 protected:
  /// The plan's reason for not using the correction, or ""; also checks that its buffers exist only if it is on.
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
  Scene inextensible = square(), strips = square(), free = square(), fine = square(33, 33);
  inextensible.material.membrane_stiffness_N_per_m.reset();
  strips.needs = strips.needs - FeatureSet{Feature::Shear};
  free.pins.vertices.clear();
  fine.material.membrane_stiffness_N_per_m = 1000;
  struct Row {
    const char* why;
    Scene scene;
    nlohmann::json settings = nlohmann::json::object();
  };
  for (const Row& row :
       {Row{"", square()},
        {"the cloth is inextensible", inextensible},
        {"the scene has no shear stiffness", strips},
        {"nothing holds the cloth: no tension lasts", free},
        {"fewer than four links across the cloth", square(5, 4)},
        {"cells are not square", with_pins(sheet(9, 9, 1, 0.5))},
        {"the scene has contact", with_collider(square(), sphere({0, 0, 0}, 0.1))},
        {"links or masses are not all alike", with_pins(uneven(square(), 3, 0.2))},
        {"setting time_order=1", square(), {{"time_order", 1}}},
        {"a wave crosses too many cells in a substep: the modulus of the sheet is below Y", fine, {{"substeps", 1}}},
        {"setting tuning.splitting_correction=never", square(), {{"tuning", {{"splitting_correction", "never"}}}}}})
    EXPECT_EQ(reason(row.scene, row.settings), row.why);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
