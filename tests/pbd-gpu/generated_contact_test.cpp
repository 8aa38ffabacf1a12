// Contact by planes in random scenes: nothing may pass through.
#include "contact_check.hpp"
#include "liars/motions.hpp"

namespace clothbench::pbd_gpu {
namespace {

using GeneratedContacts = Gpu;

TEST_F(GeneratedContacts, NothingCrosses) {
  const std::vector<std::string>& kinds = liars::scene_kinds();
  int touched = 0, run = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Scene s = liars::draw_scene(kinds[seed % kinds.size()], seed);
    if (s.colliders.empty() || !unsupported(xpbd_info(), s.needs).empty()) continue;
    SCOPED_TRACE(s.name + ", seed " + std::to_string(seed));
    const ContactRun found = contact_run(s, {{"substeps", 4}});
    EXPECT_EQ(found.fault, "");
    touched += found.touching > 0;
    ++run;
  }
  EXPECT_GE(run, 15);
  EXPECT_GE(touched, run / 2) << "otherwise too few runs touch, and this tests nothing";
}

}  // namespace
}  // namespace clothbench::pbd_gpu
