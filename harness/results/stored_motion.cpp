#include "results/stored_motion.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"
#include "scenario/scene_parts.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

Scene stored_scene(const RunHeader& header, const std::vector<StoredGroup>& groups, const std::string& source) {
  Scene scene = scene_from_parts(json::parse(header.scenario_json), source,
                                 {[&](json&) { return restore_mesh(groups, header.triangles); },
                                  [&](json&, Scene& s) { restore_replay(groups, s); }});
  // A study renames scenes; the scenario keeps the name of its file.
  scene.name = header.scene;
  scene.json = header.scenario_json;
  scene.sha256 = header.scenario_sha256;
  return scene;
}

std::vector<double> stored_margins(const RunHeader& header, std::size_t colliders) {
  std::vector<double> out;
  if (!header.plan.is_object() || !header.plan.contains("contact_margins")) return out;
  for (const json& m : header.plan["contact_margins"]) out.push_back(m.at("margin_m").get<double>());
  if (!out.empty() && out.size() != colliders)
    throw Error(fmt::format("header_json: /plan/contact_margins: expected one for each of {} colliders; found {}",
                            colliders, out.size()));
  return out;
}

}  // namespace

StoredMotion read_motion(const std::filesystem::path& path) {
  const RunHeader header = read_run_summary(path).header;
  Replay replay = read_replay(path, 1);
  StoredMotion m;
  if (replay.frames.empty()) return m;
  try {
    m.scene = stored_scene(header, replay.groups, "scenario_json");
    m.contact_margins_m = stored_margins(header, m.scene.colliders.size());
    m.time_s = std::move(replay.time_s);
    m.position = std::move(replay.position);
    if (const std::size_t expected = m.time_s.size() * m.scene.cloth.vertex_count() * 3; m.position.size() != expected)
      throw Error(fmt::format("expected {} coordinates of {} frames with {} vertices; found {}", expected,
                              m.time_s.size(), m.scene.cloth.vertex_count(), m.position.size()));
    return m;
  } catch (const json::exception& e) {
    throw Error(path.string() + ": scenario_json, header_json, /cloth or /colliders: " + e.what());
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

}  // namespace clothbench
