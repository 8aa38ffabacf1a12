// The reference solver against every exact solution, within its own stated uncertainty.
#include <gtest/gtest.h>

#include <cmath>

#include "refusal.hpp"
#include "runner/reference.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

class ReferenceAgrees : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Every, ReferenceAgrees,
                         ::testing::Values("free-fall", "pendulum", "swing-strip", "heavy-strip", "cantilever-1",
                                           "cantilever-10", "cantilever-100", "two-hand-pull"),
                         [](const auto& i) { return test_name(i.param); });

TEST_P(ReferenceAgrees, AgreeWithTheTruth) {
  const Scene s = load_scene("validation/" + std::string(GetParam()));
  const ReferenceResult r = compute_reference(s);
  EXPECT_LE(r.truth_distance, std::max(r.uncertainty, 5e-7)) << r.value << " against " << r.truth;
  EXPECT_LT(r.uncertainty, 1e-4);
  for (const double order : {r.order_bdf2, r.order_conservative})
    if (!std::isnan(order)) {
      EXPECT_NEAR(order, 2, 0.25);
    }
}

/// The closed form of a hanging sheet, whose rows do not move alike, against springs in all of its rows.
TEST(SheetReferences, AgreeWithTheClosedForm) {
  const Scene s = load_scene("validation/heavy-strip", {"material.shear=true", "time.duration_s=1.5"});
  const ReferenceResult r = compute_reference(s, {.settling_substeps = 2});
  EXPECT_LE(r.truth_distance, std::max(r.uncertainty, 1e-5)) << r.value << " against " << r.truth;
  EXPECT_LT(r.uncertainty, 1e-3);
}

/// The mesh's own error decreases with cell size, is well above the uncertainty of the reference, and is small.
TEST(MeshReferences, StateTheErrorOfTheMesh) {
  const std::vector<std::string> short_ones[] = {{}, {"time.duration_s=1", "material.damping_per_s=30"}, {}};
  const char* const names[] = {"swing-strip-mesh", "heavy-strip-mesh", "cantilever-10-mesh"};
  for (std::size_t k = 0; k < 3; ++k) {
    double space[2] = {};
    for (int fine = 0; fine < 2; ++fine) {
      std::vector<std::string> set = short_ones[k];
      set.push_back(fine ? "cloth.mesh.drawn.cells=20" : "cloth.mesh.drawn.cells=8");
      const ReferenceResult r =
          compute_reference(load_scene("validation/" + std::string(names[k]), set), {.settling_substeps = 2});
      space[fine] = r.space_error;
      EXPECT_LT(3 * r.uncertainty, r.space_error) << names[k];
      EXPECT_LT(r.space_error, 0.02) << names[k];
    }
    EXPECT_LT(space[1], 0.6 * space[0]) << names[k];
  }
}

}  // namespace
}  // namespace clothbench
