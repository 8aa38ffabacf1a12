#include <gtest/gtest.h>

#include <cmath>

#include "metrics/collider_contact.hpp"
#include "render/vertex_values.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

TEST(VertexValues, StrainIsOfTheEdgeFurthestFromRest) {
  const Cloth cloth = upright(4, 3, 0.3, 0.2);
  std::vector<double> x = positions_of(cloth);
  for (std::size_t k = 0; k < x.size(); k += 3) {
    x[k] *= 1.1;
    x[k + 1] *= 0.8;
  }
  for (const float s : vertex_strain(cloth, x)) EXPECT_NEAR(static_cast<double>(s), -0.2, 1e-6);
  x[0] = NAN;
  const std::vector<float> s = vertex_strain(cloth, x);
  EXPECT_TRUE(std::isnan(s[0]));
  EXPECT_TRUE(std::isnan(s[1]));
  EXPECT_FALSE(std::isnan(s[2]));
}

/// A sheet that is driven through a scene's colliders.
class Through : public ::testing::TestWithParam<const char*> {};

TEST_P(Through, DepthIsNoMoreThanTheMetrics) {
  if (!kWithContactMetrics) GTEST_SKIP() << "built without contact metrics";
  Scene scene = load_scene(GetParam());
  const std::vector<double> start = initial_positions(scene);
  VertexDepth depth(scene);
  ColliderContact metric(scene);
  double deepest = 0;
  for (int frame = 0; frame < 30; ++frame) {
    std::vector<double> x = start;
    // Down for what lies below, and forth for hands that move beside it.
    for (std::size_t k = 0; k < x.size(); k += 3) {
      x[k + 1] -= 0.02 * frame;
      x[k + 2] += 0.005 * frame;
    }
    const std::vector<float> d = depth.at(frame, x, true);
    const SceneContact m = metric.probe(frame, x);
    const double most = static_cast<double>(*std::max_element(d.begin(), d.end()));
    EXPECT_GE(*std::min_element(d.begin(), d.end()), 0);
    // The metric has the points between the vertices too. An open sheet has no depth.
    if (std::isfinite(m.depth_m)) {
      EXPECT_LE(most, m.depth_m + 1e-6) << "frame " << frame;
    }
    deepest = std::max(deepest, most);
  }
  EXPECT_GT(deepest, 0.01) << "it went through something";
}

INSTANTIATE_TEST_SUITE_P(VertexValues, Through,
                         ::testing::Values("contact/sphere", "contact/box", "contact/plane", "contact/open-sheet"));

TEST(VertexValues, DepthOfWhatIsNotFiniteIsUnknown) {
  if (!kWithContactMetrics) GTEST_SKIP() << "built without contact metrics";
  const Scene scene = load_scene("contact/open-sheet");
  std::vector<double> x = initial_positions(scene);
  VertexDepth depth(scene);
  for (const float d : depth.at(0, x, true)) EXPECT_EQ(d, 0);
  x[4] = NAN;
  for (const float d : depth.at(1, x, true)) EXPECT_TRUE(std::isnan(d)) << "history is lost";
  EXPECT_TRUE(depth.at(2, x, false).empty());
}

}  // namespace
}  // namespace clothbench::render
