#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "metrics/registry.hpp"
#include "refusal.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

Scene expecting(const std::string& scene, const std::string& expect) {
  return load_scene(scene, {"cloth.grid=[5,5]", "time.duration_s=0.1", "expect=" + expect});
}

const Expectation* bound_of(const Scene& s, const std::string& name) {
  const auto at = std::find_if(s.expect.begin(), s.expect.end(), [&](const Expectation& e) { return e.name == name; });
  return at == s.expect.end() ? nullptr : &*at;
}

std::vector<Scene> scenes_of(const char* folder) {
  std::vector<Scene> out;
  for (const auto& file : std::filesystem::directory_iterator(scenario_root() / folder))
    out.push_back(load_scene(file.path().string()));
  return out;
}

/// The strict set itself states for which scenes a bound is defined, because scenes are read before metrics exist. This
/// must agree with the registry: a bound without a value fails, and a missing bound proves nothing.
TEST(StrictContact, ABoundIsDefinedAndStatedWhereItsMetricsAre) {
  std::size_t seen = 0;
  for (const char* folder : {"paper", "contact"})
    for (const Scene& scene : scenes_of(folder))
      for (const StrictBound& b : strict_contact()) {
        const Scalar* scalar = find_scalar(b.scalar);
        ASSERT_NE(scalar, nullptr) << b.scalar;
        EXPECT_EQ(scalar->expect, Expect::Yes) << b.scalar;
        bool applies = true;
        for (const Metric& m : metrics())
          if (std::find(scalar->from.series.begin(), scalar->from.series.end(), m.name) != scalar->from.series.end())
            applies = applies && m.applies(scene);
        if (std::string(b.scalar) == "pop_max_m" || std::string(b.scalar) == "stretch_max_end")
          applies = scene.grips.vertices.empty();  // released cloth springs back and vibrates
        if (std::string(b.scalar) == "crossings_max") applies = !scene.colliders.empty();
        EXPECT_EQ(b.defined(scene), applies) << scene.name << b.scalar;
        const bool touches = !scene.colliders.empty() || !scene.grips.vertices.empty();
        EXPECT_TRUE(!touches || !applies || bound_of(scene, b.scalar)) << scene.name << " lacks " << b.scalar;
        ++seen;
      }
  EXPECT_GE(seen, 120u);
}

TEST(StrictContact, TheSetIsAddedToWhatASceneStates) {
  const Scene s = expecting("contact/sphere", R"({"contact":"strict","stretch_max":{"at_most":0.4}})");
  EXPECT_EQ(bound_of(s, "stretch_max")->at_most, 0.4);
  EXPECT_EQ(bound_of(s, "contact_length_settled_m")->at_most, 0);
  EXPECT_EQ(bound_of(s, "depth_max_m")->at_most, 0.001);
  EXPECT_EQ(bound_of(s, "crossings_max")->at_most, 0);
  EXPECT_EQ(bound_of(s, "self_contact_length_max_m"), nullptr) << "the scene has no self-contact";
  EXPECT_EQ(s.json.find("\"strict\""), std::string::npos) << "stored results state the bounds themselves";
}

TEST(StrictContact, ALooserBoundStatesItsReason) {
  const std::string looser = R"({"contact":"strict","stretch_max":{"at_most":0.7)";
  EXPECT_NO_THROW(expecting("contact/sphere", looser + R"(,"why":"a hard impact"}})"));
  EXPECT_PRED2(mentions, refusal([&] { expecting("contact/sphere", looser + "}}"); }), "/expect/stretch_max");
  EXPECT_THROW(expecting("contact/sphere", R"({"contact":"strict","stretch_max":{"at_least":0}})"), Error);
  EXPECT_THROW(expecting("paper/gravity", R"({"contact":"strict"})"), Error) << "nothing to touch";
  EXPECT_THROW(expecting("contact/sphere", R"({"contact":"lax"})"), Error);
}

}  // namespace
}  // namespace clothbench
