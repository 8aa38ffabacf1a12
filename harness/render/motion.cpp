#include "render/motion.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "results/store.hpp"

namespace clothbench::render {
namespace {

using nlohmann::json;

Vec3 vec3(const json& j) { return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()}; }

const StoredArray* array_of(const StoredGroup& g, const std::string& name) {
  for (const StoredArray& a : g.arrays)
    if (a.name == name) return &a;
  return nullptr;
}

/// Throws unless its shape is `shape`, 0 standing for any length.
const StoredArray& expect_shape(const StoredGroup& g, const std::string& name,
                                const std::vector<std::uint64_t>& shape) {
  const StoredArray* a = array_of(g, name);
  bool fits = a != nullptr && a->shape.size() == shape.size();
  std::uint64_t count = 1;
  for (std::size_t k = 0; fits && k < shape.size(); ++k) {
    fits = shape[k] == 0 || shape[k] == a->shape[k];
    count *= a->shape[k];
  }
  if (!fits || a->values.size() != count)
    throw Error("/" + g.path + "/" + name + " is missing or of another shape than expected");
  return *a;
}

FrameMotion& frame_of(Scene& scene, std::size_t frame, std::size_t colliders) {
  if (scene.motion.size() <= frame) scene.motion.resize(frame + 1);
  scene.motion[frame].colliders.resize(colliders);
  return scene.motion[frame];
}

void read_capsules(const StoredGroup& g, Scene& scene, std::size_t k, std::size_t colliders) {
  const StoredArray& a = expect_shape(g, "capsules", {0, 0, 7});
  const double* v = a.values.data();
  for (std::size_t f = 0; f < a.shape[0]; ++f) {
    ColliderPose& pose = frame_of(scene, f, colliders).colliders[k];
    for (std::size_t i = 0; i < a.shape[1]; ++i, v += 7)
      pose.capsules.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]});
    if (f == 0) scene.colliders[k].capsules = pose.capsules;
  }
}

void read_joints(const StoredGroup& g, ColliderMesh& mesh, Scene& scene, std::size_t k, std::size_t colliders) {
  const StoredArray& index = expect_shape(g, "joint_index", {mesh.vertex_count(), 4});
  const StoredArray& weight = expect_shape(g, "joint_weight", {mesh.vertex_count(), 4});
  const StoredArray& matrix = expect_shape(g, "joint_matrix", {0, 0, 3, 4});
  mesh.joint_count = matrix.shape[1];
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    auto& joints = mesh.joints.emplace_back();
    auto& weights = mesh.weights.emplace_back();
    for (std::size_t s = 0; s < 4; ++s) {
      if (!(index.values[4 * v + s] >= 0 && index.values[4 * v + s] < static_cast<double>(mesh.joint_count)))
        throw Error("/" + g.path + "/joint_index: expected numbers of joints");
      joints[s] = static_cast<std::uint8_t>(index.values[4 * v + s]);
      weights[s] = static_cast<float>(weight.values[4 * v + s]);
    }
  }
  const double* m = matrix.values.data();
  for (std::size_t f = 0; f < matrix.shape[0]; ++f)
    for (std::size_t j = 0; j < mesh.joint_count; ++j) {
      Affine& to = frame_of(scene, f, colliders).colliders[k].joints.emplace_back();
      for (auto& row : to)
        for (double& x : row) x = *m++;
    }
}

void read_mesh(const StoredGroup& g, Scene& scene, std::size_t k, std::size_t colliders) {
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = expect_shape(g, "position_m", {0, 3}).values;
  for (const StoredArray& t = expect_shape(g, "triangles", {0, 3}); mesh->triangles.size() < t.shape[0];) {
    const double* v = &t.values[3 * mesh->triangles.size()];
    for (std::size_t i = 0; i < 3; ++i)
      if (!(v[i] >= 0 && v[i] < static_cast<double>(mesh->vertex_count())))
        throw Error("/" + g.path + "/triangles: expected numbers of vertices");
    mesh->triangles.push_back(
        {static_cast<std::uint32_t>(v[0]), static_cast<std::uint32_t>(v[1]), static_cast<std::uint32_t>(v[2])});
  }
  mesh->closed = g.attributes.value("closed", 0.0) != 0;
  if (array_of(g, "joint_matrix") != nullptr) read_joints(g, *mesh, scene, k, colliders);
  scene.colliders[k].mesh = std::move(mesh);
}

void read_collider(const StoredGroup& g, Scene& scene, std::size_t k, std::size_t colliders) {
  Collider& c = scene.colliders[k];
  const json& a = g.attributes;
  c.name = a.at("name").get<std::string>();
  const auto shape = a.at("shape").get<std::string>();
  if (shape == "plane") {
    c.shape = Collider::Shape::Plane;
    c.center_m = vec3(a.at("point_m"));
    c.normal = vec3(a.at("normal"));
  } else if (shape == "sphere") {
    c.shape = Collider::Shape::Sphere;
    c.center_m = vec3(a.at("center_m"));
    c.radius_m = a.at("radius_m").get<double>();
  } else if (shape == "box") {
    c.shape = Collider::Shape::Box;
    c.center_m = vec3(a.at("center_m"));
    c.half_extent_m = vec3(a.at("half_extent_m"));
    c.axes = {vec3(a.at("axis_u")), vec3(a.at("axis_v")), vec3(a.at("axis_w"))};
  } else if (shape == "capsules") {
    c.shape = Collider::Shape::Capsules;
    read_capsules(g, scene, k, colliders);
  } else if (shape == "mesh") {
    c.shape = Collider::Shape::Mesh;
    read_mesh(g, scene, k, colliders);
  } else {
    throw Error("/" + g.path + ": shape " + shape + ": expected plane, sphere, box, capsules or mesh");
  }
}

void read_grips(const StoredGroup& g, Scene& scene) {
  for (const double v : expect_shape(g, "held_vertex", {0}).values)
    scene.grips.vertices.push_back(static_cast<std::uint32_t>(v));
  const std::size_t count = scene.grips.vertices.size();
  const StoredArray& target = expect_shape(g, "target_m", {0, count, 3});
  const StoredArray& held = expect_shape(g, "held", {target.shape[0], count});
  for (std::size_t f = 0; f < target.shape[0]; ++f) {
    FrameMotion& m = frame_of(scene, f, scene.colliders.size());
    for (std::size_t i = 0; i < count; ++i) {
      const double* p = &target.values[3 * (f * count + i)];
      m.grip_position_m.push_back({p[0], p[1], p[2]});
      m.grip_held.push_back(held.values[f * count + i] != 0 ? 1 : 0);
    }
  }
}

/// What replay_of in harness/runner stored.
void read_stage(const std::vector<StoredGroup>& groups, Scene& scene) {
  std::map<std::string, const StoredGroup*> by_path;
  for (const StoredGroup& g : groups) by_path[g.path] = &g;
  if (!by_path.contains("colliders")) return;
  const auto count = static_cast<std::size_t>(by_path["colliders"]->attributes.at("count").get<double>());
  scene.colliders.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto found = by_path.find("colliders/" + std::to_string(k));
    if (found == by_path.end()) throw Error("/colliders/" + std::to_string(k) + " is missing");
    read_collider(*found->second, scene, k, count);
  }
  if (by_path.contains("colliders/grips")) read_grips(*by_path["colliders/grips"], scene);
}

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

void tell(Motion& m, const CellHeader& header, const Outcome& outcome) {
  m.name = cell_name(header);
  m.title = header.scene + " · " + header.solver;
  if (header.setting != "default") m.title += " " + header.setting;
  if (outcome.status != "ok") m.ended = outcome.status;
}

}  // namespace

std::vector<double> Motion::at(std::size_t frame) const {
  const std::size_t count = 3 * scene.cloth.vertex_count();
  const auto from = position.begin() + static_cast<std::ptrdiff_t>(frame * count);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

Motion stored_motion(const std::filesystem::path& path) {
  const CellRecord record = read_cell_summary(path);
  Replay replay = read_replay(path, 1);
  Motion m;
  tell(m, record.header, record.outcome);
  if (replay.frames.empty()) return m;
  try {
    const json scenario = json::parse(record.header.scenario_json);
    read_cloth(scenario, m.scene);
    m.scene.time.frame_rate_hz = scenario.at("time").at("frame_rate_hz").get<double>();
    read_stage(replay.groups, m.scene);
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
    throw Error(path.string() + ": its positions do not fit the grid of its scenario");
  return m;
}

Motion motion_of(const Scene& scene, const CellHeader& header, const Outcome& outcome, AccuracyPass pass) {
  Motion m;
  m.scene = scene;
  m.held = !scene.colliders.empty() || !scene.grips.vertices.empty() || !scene.pins.vertices.empty();
  tell(m, header, outcome);
  m.time_s = std::move(pass.time_s);
  m.position = std::move(pass.position);
  return m;
}

}  // namespace clothbench::render
