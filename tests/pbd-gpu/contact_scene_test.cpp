// The real scenes, whole, through the solver, judged at every frame by the metrics' own probe.
#include <fmt/format.h>

#include <cstdlib>

#include "contact_run.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// On the fetched rooms and hands where they are, and on their procedural stand-ins.
class ContactScenes : public Gpu, public ::testing::WithParamInterface<const char*> {
 protected:
  static ContactRun run(const std::string& scene_name, const nlohmann::json& settings = nlohmann::json::object()) {
    const char* variable = std::getenv("CLOTHBENCH_ASSETS");
    const std::string before = variable != nullptr ? variable : "";
    if (*GetParam() != 0) setenv("CLOTHBENCH_ASSETS", GetParam(), 1);
    const Scene scene = load_scene(scene_name);
    variable != nullptr ? setenv("CLOTHBENCH_ASSETS", before.c_str(), 1) : unsetenv("CLOTHBENCH_ASSETS");
    const auto solver = make_xpbd(complete_settings(xpbd_info(), settings), {});
    solver->load(scene);
    const ContactRun r = run_contact(*solver, scene);
    fmt::print(
        "{} ({}): {} crossings, contour {:.3g} m, settled {:.3g} m, depth {:.3g} m, stretch {:.3g}, at the end {:.3g}, "
        "kinetic energy {:.3g} J, drift {:.3g} m/s, {:.1f} ms a frame\n",
        scene_name, scene.assets, r.crossings, r.contour_m, r.settled_contour_m, r.depth_m, r.stretch, r.stretch_end,
        r.kinetic_end_J, r.drift_end_m_per_s, 1e3 * r.step_s);
    EXPECT_TRUE(r.finite);
    for (const SolverCount& c : solver->counts()) EXPECT_EQ(c.count, 0) << scene_name << ": " << c.long_name;
    return r;
  }

  /// Nothing crosses a collider in any frame.
  static void expect_no_contour(const std::string& scene, double most_stretch) {
    const ContactRun r = run(scene);
    EXPECT_EQ(r.contour_m, 0);
    EXPECT_EQ(r.crossings, 0);
    EXPECT_EQ(r.depth_m, 0);
    EXPECT_TRUE(r.stretch <= most_stretch) << r.stretch;
  }
};

TEST_P(ContactScenes, DeskFlatLow) { expect_no_contour("paper/desk-flat-low", 0.5); }
TEST_P(ContactScenes, DeskFlatHigh) { expect_no_contour("paper/desk-flat-high", 1); }
TEST_P(ContactScenes, DeskCornerLow) { expect_no_contour("paper/desk-corner-low", 1); }
TEST_P(ContactScenes, DeskCornerHigh) { expect_no_contour("paper/desk-corner-high", 1); }
TEST_P(ContactScenes, CapsuleSweep) { expect_no_contour("paper/capsule-sweep", 0.1); }
TEST_P(ContactScenes, HandPush) { expect_no_contour("paper/hand-push", 0.2); }
TEST_P(ContactScenes, StretchBy15cmTearsNothing) {
  for (const char* scene : {"paper/two-hand-stretch-0p5mps", "paper/two-hand-stretch-2mps"}) {
    const ContactRun r = run(scene);
    EXPECT_LT(r.stretch, 1.2) << scene << ": edges at the grips; the hands pull by 0.3 of the cloth's width";
    EXPECT_LT(r.stretch_end, 0.5) << scene;
  }
}
TEST_P(ContactScenes, StretchAt10mpsStaysFinite) { run("paper/two-hand-stretch-10mps"); }
INSTANTIATE_TEST_SUITE_P(Assets, ContactScenes, ::testing::Values("", "procedural"),
                         [](const auto& p) { return *p.param != 0 ? std::string(p.param) : "Default"; });

class PlainContactScenes : public ContactScenes {};
TEST_P(PlainContactScenes, OpenSheet) { expect_no_contour("contact/open-sheet", 0.6); }
TEST_P(PlainContactScenes, Plane) { EXPECT_EQ(run("contact/plane").depth_m, 0); }
TEST_P(PlainContactScenes, Sphere) { expect_no_contour("contact/sphere", 0.1); }
TEST_P(PlainContactScenes, Box) { EXPECT_EQ(run("contact/box").depth_m, 0); }
INSTANTIATE_TEST_SUITE_P(NoAssets, PlainContactScenes, ::testing::Values(""), [](const auto&) { return "Default"; });

}  // namespace
}  // namespace clothbench::pbd_gpu
