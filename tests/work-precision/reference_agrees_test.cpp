// The reference solver against every truth, within its own stated uncertainty.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "runner/reference.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

class ReferenceAgrees : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Every, ReferenceAgrees,
                         ::testing::Values("free-fall", "pendulum", "swing-strip", "heavy-strip", "cantilever-1",
                                           "cantilever-10", "cantilever-100", "two-hand-pull"),
                         [](const auto& i) {
                           std::string name = i.param;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST_P(ReferenceAgrees, AgreeWithTheTruth) {
  const Scene s = load_scene("validation/" + std::string(GetParam()));
  const ReferenceResult r = compute_reference(s);
  EXPECT_LE(r.truth_distance, std::max(r.uncertainty, 5e-7)) << r.value << " against " << r.truth;
  EXPECT_LT(r.uncertainty, 1e-4);
  for (const double order : {r.order_bdf2, r.order_conservative})
    if (!std::isnan(order)) {
      EXPECT_NEAR(order, 2, 0.25);
    }
  RecordProperty("distance", std::to_string(r.truth_distance));
  std::printf("%s: distance %.2e, U_ref %.2e, orders %.2f %.2f, space %.2e\n", GetParam(), r.truth_distance,
              r.uncertainty, r.order_bdf2, r.order_conservative, r.space_error);
}

/// The closed form of a sheet that hangs, whose rows do not move alike, against the springs of all its rows.
TEST(SheetReferences, AgreeWithTheClosedForm) {
  const Scene s = load_scene("validation/heavy-strip", {"material.shear=true", "time.duration_s=1.5"});
  const ReferenceResult r = compute_reference(s, {.settling_substeps = 2});
  EXPECT_LE(r.truth_distance, std::max(r.uncertainty, 1e-5)) << r.value << " against " << r.truth;
  EXPECT_LT(r.uncertainty, 1e-3);
}

/// The error of the mesh itself falls with its cells, is larger than its uncertainty, and is not below the continuum.
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
      std::printf("%s: distance %.2e, U_ref %.2e, orders %.2f %.2f, space %.2e\n", names[k], r.truth_distance,
                  r.uncertainty, r.order_bdf2, r.order_conservative, r.space_error);
    }
    EXPECT_LT(space[1], 0.6 * space[0]) << names[k];
  }
}

TEST(References, AreComputedOnceAndCached) {
  const auto cache = std::filesystem::temp_directory_path() / ("clothbench-references-" + std::to_string(getpid()));
  const Scene s = load_scene("validation/pendulum");
  int reported = 0;
  const auto note = [&](const std::string&) { ++reported; };
  const auto first = references({&s, &s}, cache, note), again = references({&s}, cache, note);
  EXPECT_EQ(reported, 1);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first.begin()->second.value, again.begin()->second.value);
  EXPECT_EQ(first.begin()->second.uncertainty, again.begin()->second.uncertainty);
  const Scene other = load_scene("validation/pendulum", {"gravity_m_per_s2=[0,-5,0]"});
  EXPECT_NE(references({&other}, cache, note).begin()->second.value, first.begin()->second.value);
  EXPECT_EQ(reported, 2) << "another scene is not in the cache";
  std::filesystem::remove_all(cache);
}

}  // namespace
}  // namespace clothbench
