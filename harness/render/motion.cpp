#include "render/motion.hpp"

#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"

namespace clothbench::render {
namespace {

using nlohmann::json;

/// Of the completed scenario: what rest lengths need.
void read_cloth(const json& scenario, Scene& scene) {
  const json& c = scenario.at("cloth");
  if (!c.contains("grid")) throw Error("/cloth: only grids are drawn; ParaView opens the .xdmf beside it");
  scene.cloth.columns = c.at("grid").at(0).get<int>();
  scene.cloth.rows = c.at("grid").at(1).get<int>();
  scene.cloth.width_m = c.at("size_m").at(0).get<double>();
  scene.cloth.height_m = c.at("size_m").at(1).get<double>();
  if (!c.contains("column_factors")) return;
  scene.cloth.column_factors.assign(static_cast<std::size_t>(scene.cloth.columns - 1), 1);
  for (const json& f : c.at("column_factors"))
    scene.cloth.column_factors.at(f.at("column").get<std::size_t>()) = f.at("factor").get<double>();
}

void tell(Motion& m, const RunHeader& header, const Outcome& outcome) {
  m.name = run_name(header);
  m.title = header.scene + " · " + header.solver;
  if (header.setting != "default") m.title += " " + header.setting;
  if (outcome.status != "ok") m.outcome = outcome.status;
}

}  // namespace

std::vector<double> Motion::at(std::size_t frame) const {
  const std::size_t count = 3 * scene.cloth.vertex_count();
  const auto from = position.begin() + static_cast<std::ptrdiff_t>(frame * count);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

Motion stored_motion(const std::filesystem::path& path) {
  const RunRecord record = read_run_summary(path);
  Replay replay = read_replay(path, 1);
  Motion m;
  tell(m, record.header, record.outcome);
  if (replay.frames.empty()) return m;
  try {
    const json scenario = json::parse(record.header.scenario_json);
    read_cloth(scenario, m.scene);
    m.scene.time.frame_rate_hz = scenario.at("time").at("frame_rate_hz").get<double>();
    restore_replay(replay.groups, m.scene);
    m.held =
        !m.scene.colliders.empty() || !m.scene.grips.vertices.empty() || !scenario.value("pins", json::array()).empty();
  } catch (const json::exception& e) {
    throw Error(path.string() + ": scenario_json or /colliders: " + e.what());
  } catch (const std::out_of_range&) {
    throw Error(path.string() + ": scenario_json: cloth.column_factors: a column that the grid does not have");
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
  m.time_s = std::move(replay.time_s);
  m.position = std::move(replay.position);
  if (m.scene.cloth.columns < 2 || m.scene.cloth.rows < 2 ||
      m.position.size() != m.frames() * 3 * m.scene.cloth.vertex_count())
    throw Error(path.string() + ": its positions have another number of vertices than the grid of its scenario");
  return m;
}

Motion motion_of(const Scene& scene, const RunHeader& header, const Outcome& outcome, AccuracyPass pass) {
  Motion m;
  m.scene = scene;
  m.held = !scene.colliders.empty() || !scene.grips.vertices.empty() || !scene.pins.vertices.empty();
  tell(m, header, outcome);
  m.time_s = std::move(pass.time_s);
  m.position = std::move(pass.position);
  return m;
}

}  // namespace clothbench::render
