#include "render/motion.hpp"

#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/recorded_hand.hpp"

namespace clothbench::render {
namespace {

using nlohmann::json;

/// The scene's mesh: drawn again, or from its file if that is still there, else from the triangles of the result and
/// its first frame, where that is the shape at rest.
std::shared_ptr<const ClothMesh> mesh_of(const json& scenario, const RunHeader& header, const Replay& replay) {
  const json& c = scenario.at("cloth");
  json named = c.at("mesh");
  if (named.contains("drawn") || file_of_scene(named.at("file").get<std::string>(), ""))
    return read_cloth_mesh(named, "/scenario_json");
  if (c.contains("start") || named.value("rest", "vertices") != "vertices")
    throw Error("/cloth/mesh/file: " + named.at("file").dump() +
                ": no such file; expected it in the scenario folder, for the cloth starts in another shape than it has "
                "at rest");
  std::vector<Vec3> x;
  for (std::size_t v = 0; v < header.vertices; ++v) {
    const auto at = [&](std::size_t k) { return static_cast<double>(replay.position.at(3 * v + k)); };
    x.push_back({at(0), at(1), at(2)});
  }
  std::vector<std::array<std::uint32_t, 3>> t;
  for (std::size_t k = 0; k + 2 < header.triangles.size(); k += 3)
    t.push_back({header.triangles[k], header.triangles[k + 1], header.triangles[k + 2]});
  return std::make_shared<const ClothMesh>(cloth_mesh(std::move(x), std::move(t), "/triangles"));
}

/// Of the completed scenario: what rest lengths need.
void read_cloth(const json& scenario, const RunHeader& header, const Replay& replay, Scene& scene) {
  const json& c = scenario.at("cloth");
  if (c.contains("mesh")) {
    scene.cloth.mesh = mesh_of(scenario, header, replay);
    scene.cloth.columns = static_cast<int>(scene.cloth.mesh->vertices.size());
    scene.cloth.rows = 1;
    std::tie(scene.cloth.width_m, scene.cloth.height_m) = longest_sides(*scene.cloth.mesh);
    return;
  }
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
    read_cloth(scenario, record.header, replay, m.scene);
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
  if ((!m.scene.cloth.mesh && (m.scene.cloth.columns < 2 || m.scene.cloth.rows < 2)) ||
      m.position.size() != m.frames() * 3 * m.scene.cloth.vertex_count())
    throw Error(path.string() + ": its positions have another number of vertices than the cloth of its scenario");
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
