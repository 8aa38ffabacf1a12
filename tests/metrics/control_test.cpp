// Control: the motion of the cloth without the colliders, hands or layers of its scene. Every bound on contact must
// fail for it in some scene; otherwise the bound proves nothing.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "runner/frame_loop.hpp"
#include "scenario/load.hpp"
#include "unmet_bounds.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// The scene without colliders and grips; or only without self-contact, if it has any.
Scene unaware(const Scene& scene) {
  json j = json::parse(scene.json);
  j.erase("expect");
  if (scene.needs.has(Feature::SelfCollision)) {
    j["cloth"].erase("self_collision");
  } else {
    j["colliders"] = j["grips"] = json::array();
    j["cloth"]["pose"].erase("over_table");
  }
  return scene_from_json(std::move(j), scene.name);
}

/// Positions of all frames by a solver that needs no GPU.
std::vector<std::vector<double>> motion_of(const Scene& scene) {
  const SolverEntry& entry = find_solver("bullet-soft");
  const auto solver = load_solver(entry, complete_settings(entry.info, json::object()), {}, scene);
  std::vector<std::vector<double>> out = {initial_positions(scene)};
  FrameLoop loop(*solver, scene, {.frames = scene.time.frames()});
  ClothState state;
  while (loop.next()) {
    solver->read_state(state);
    out.push_back(state.position);
  }
  EXPECT_EQ(out.size(), static_cast<std::size_t>(scene.time.frames()) + 1) << scene.name;
  return out;
}

/// The scene's bounds that its control violates.
std::set<std::string> broken_by_control(const Scene& scene) {
  const auto motion = motion_of(unaware(scene));
  const SolverEntry control = prescribed([&](int frame, std::vector<double>& x) { x = motion.at(frame); });
  return unmet_bounds(scene, control);
}

TEST(Control, EveryBoundOnContactFailsForClothThatFeelsNothing) {
  const std::vector<std::pair<const char*, std::vector<std::string>>> scenes = {
      {"contact/sphere", {}},
      {"contact/box", {}},
      {"contact/plane", {}},
      {"contact/open-sheet", {}},
      {"contact/self-fold", {"cloth.grid=[24,24]"}},
      {"paper/capsule-sweep", {}},
      {"contact/sphere", {"cloth.pose.center_m=[0,0.05,0]", R"(pins=[{"edge":"u0"},{"edge":"u1"}])"}},
      {"paper/hand-push", {}},
      {"paper/desk-flat-low", {}},
      {"paper/desk-corner-low", {}},
      {"paper/two-hand-stretch-2mps", {"cloth.grid=[32,32]"}}};
  std::set<std::string> all;
  for (const auto& [name, more] : scenes) {
    std::vector<std::string> set = {"cloth.grid=[16,16]"};
    set.insert(set.end(), more.begin(), more.end());
    const std::set<std::string> broken = broken_by_control(load_scene(name, set));
    EXPECT_FALSE(broken.empty()) << name;
    all.insert(broken.begin(), broken.end());
  }
  for (const char* bound :
       {"crossings_max", "contact_length_settled_m", "contact_length_max_m", "depth_max_m", "self_contact_length_max_m",
        "self_contact_pairs_max", "touching_fraction_end", "lowest_height_min_m", "grip_error_max_m"})
    EXPECT_TRUE(all.contains(bound)) << bound;
}

}  // namespace
}  // namespace clothbench
