// The real scenes, whole, through the solver, judged at every frame by the metrics' own probe.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "contact_run.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

class ContactScenes : public Gpu {
 protected:
  /// Prints what a table would say.
  static ContactRun run(const std::string& scene_name, const std::vector<std::string>& changes = {}) {
    const Scene scene = load_scene(scene_name, changes);
    const auto solver = make_xpbd(complete_settings(xpbd_info(), std::getenv("DEV") ? nlohmann::json::parse(std::getenv("DEV")) : nlohmann::json::object()), {});
    solver->load(scene);
    const ContactRun r = run_contact(*solver, scene);
    fmt::print("{} ({}): tunnelled {} depth {:.3g} m, contour {:.3g} m settled {:.3g} m, vertex depth {:.3g} m, stretch {:.3g} "
               "end {:.3g}, kinetic {:.3g} J, drift {:.3g} m/s, {:.1f} ms a frame{}\n",
               scene_name, scene.assets, r.tunnelled_fraction, r.tunnelled_depth_m, r.contour_m, r.settled_contour_m,
               r.vertex_depth_m, r.stretch, r.stretch_end, r.kinetic_end_J, r.drift_end_m_per_s, 1e3 * r.step_s,
               r.finite ? "" : ", NOT FINITE");
    EXPECT_TRUE(r.finite);
    return r;
  }

  static void expect_on_its_side(const std::string& scene) {
    const ContactRun r = run(scene);
    EXPECT_EQ(r.tunnelled_fraction, 0);
    EXPECT_EQ(r.tunnelled_depth_m, 0);
    EXPECT_EQ(r.settled_contour_m, 0);
  }
};

TEST_F(ContactScenes, DeskFlatLow) { expect_on_its_side("paper/desk-flat-low"); }
TEST_F(ContactScenes, DeskFlatHigh) { expect_on_its_side("paper/desk-flat-high"); }
TEST_F(ContactScenes, DeskCornerLow) { expect_on_its_side("paper/desk-corner-low"); }
TEST_F(ContactScenes, DeskCornerHigh) { expect_on_its_side("paper/desk-corner-high"); }
TEST_F(ContactScenes, OpenSheet) { expect_on_its_side("contact/open-sheet"); }

TEST_F(ContactScenes, Plane) { EXPECT_EQ(run("contact/plane").vertex_depth_m, 0); }
TEST_F(ContactScenes, Sphere) { EXPECT_EQ(run("contact/sphere").vertex_depth_m, 0); }
TEST_F(ContactScenes, Box) { EXPECT_EQ(run("contact/box").vertex_depth_m, 0); }

TEST_F(ContactScenes, CapsuleSweep) { EXPECT_LE(run("paper/capsule-sweep").vertex_depth_m, 1e-3); }
TEST_F(ContactScenes, HandPush) { EXPECT_EQ(run("paper/hand-push").tunnelled_fraction, 0); }

TEST_F(ContactScenes, StretchBy15cmTearsNothing) {
  for (const char* scene : {"paper/two-hand-stretch-0p5mps", "paper/two-hand-stretch-2mps"}) {
    const ContactRun r = run(scene);
    EXPECT_LT(r.stretch, 1) << scene;
    EXPECT_LT(r.stretch_end, 0.1) << scene;
  }
}
TEST_F(ContactScenes, StretchAt10mpsStaysFinite) { run("paper/two-hand-stretch-10mps"); }

}  // namespace
}  // namespace clothbench::pbd_gpu
