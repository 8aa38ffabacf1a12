#include <fmt/format.h>

#include <map>
#include <span>

#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/collider_kinds.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

json attributes_of(Collider c) {
  const ColliderKind& kind = kind_of(c);
  json a = {{"name", c.name}, {"shape", kind.name}, {"margin_m", c.margin_m}, {"friction", c.friction}};
  for (const ColliderNumbers& n : kind.numbers) {
    const std::span<const double> values(n.at(c), n.count);
    if (n.count == 1)
      a[n.name] = values[0];
    else
      a[n.name] = values;
  }
  if (c.mesh) a["closed"] = c.mesh->closed ? 1 : 0;
  if (c.recorded) a["recorded"] = 1;
  return a;
}

StoredArray capsules_of(const Scene& scene, std::size_t k) {
  StoredArray out{"capsules", "m", "ends a and b and radius of each capsule", {"frame", "capsule", "value"}, {}};
  out.shape = {scene.motion.size(), scene.colliders[k].capsules.size(), 7};
  for (const FrameMotion& m : scene.motion)
    for (const Capsule& c : m.colliders[k].capsules)
      out.values.insert(out.values.end(), {c.a_m[0], c.a_m[1], c.a_m[2], c.b_m[0], c.b_m[1], c.b_m[2], c.radius_m});
  return out;
}

void add_triangles(std::vector<double> positions, std::span<const std::array<std::uint32_t, 3>> corners,
                   std::vector<StoredArray>& out) {
  const std::uint64_t vertices = positions.size() / 3;
  out.push_back({"position_m", "m", "vertices", {"vertex", "xyz"}, {vertices, 3}, false, std::move(positions)});
  StoredArray triangles{"triangles",         "1", "vertices of each triangle", {"triangle", "corner"},
                        {corners.size(), 3}, true};
  for (const auto& t : corners) triangles.values.insert(triangles.values.end(), t.begin(), t.end());
  out.push_back(std::move(triangles));
}

/// Adds the mesh once; if it is skinned, also its weights, and its joints at every frame.
void add_mesh(const Scene& scene, std::size_t k, std::vector<StoredArray>& out) {
  const ColliderMesh& mesh = *scene.colliders[k].mesh;
  const std::uint64_t vertices = mesh.vertex_count();
  add_triangles(mesh.positions, mesh.triangles, out);
  if (!mesh.skinned()) return;
  out[out.size() - 2].long_name = "vertices before skinning";
  StoredArray joint{"joint_index", "1", "joints that a vertex follows", {"vertex", "slot"}, {vertices, 4}, true};
  StoredArray weight{"joint_weight", "1", "weight of each of them", {"vertex", "slot"}, {vertices, 4}};
  for (std::size_t v = 0; v < vertices; ++v) {
    joint.values.insert(joint.values.end(), mesh.joints[v].begin(), mesh.joints[v].end());
    weight.values.insert(weight.values.end(), mesh.weights[v].begin(), mesh.weights[v].end());
  }
  StoredArray matrix{"joint_matrix",
                     "1 and m",
                     "skinning matrix of each joint: rows of (linear part, translation)",
                     {"frame", "joint", "row", "column"},
                     {scene.motion.size(), mesh.joint_count, 3, 4}};
  for (const FrameMotion& m : scene.motion)
    for (const Affine& a : m.colliders[k].joints)
      for (const auto& row : a) matrix.values.insert(matrix.values.end(), row.begin(), row.end());
  for (StoredArray* a : {&joint, &weight, &matrix}) out.push_back(std::move(*a));
}

StoredGroup grips_of(const Scene& scene) {
  const std::uint64_t grips = scene.grips.vertices.size(), frames = scene.motion.size();
  StoredArray vertex{"held_vertex", "1", "cloth vertex that a hand holds", {"grip"}, {grips}, true};
  vertex.values.assign(scene.grips.vertices.begin(), scene.grips.vertices.end());
  StoredArray target{"target_m", "m", "position while attached", {"frame", "grip", "xyz"}, {frames, grips, 3}};
  StoredArray held{"held", "1", "1 while attached, 0 once released", {"frame", "grip"}, {frames, grips}, true};
  for (const FrameMotion& m : scene.motion) {
    for (const Vec3& p : m.grip_position_m) target.values.insert(target.values.end(), p.begin(), p.end());
    held.values.insert(held.values.end(), m.grip_held.begin(), m.grip_held.end());
  }
  return {"colliders/grips", json::object(), {vertex, target, held}};
}

void add_jumps(const Scene& scene, std::vector<StoredArray>& out) {
  if (scene.jumps.empty()) return;
  StoredArray frame{"jump_frame", "1", "first frame that ends after a jump", {"jump"}, {scene.jumps.size()}, true};
  StoredArray distance{"jump_m", "m", "distance of the jump", {"jump"}, {scene.jumps.size()}};
  for (const Jump& j : scene.jumps) {
    frame.values.push_back(j.frame);
    distance.values.push_back(j.distance_m);
  }
  out.insert(out.end(), {frame, distance});
}

/// Adds the mesh (without triangles, which every file has) and its groups, to which pins, masses and regions refer.
void add_cloth(const ClothMesh& mesh, std::vector<StoredGroup>& out) {
  StoredGroup& cloth = out.emplace_back();
  cloth.path = "cloth";
  cloth.attributes = {{"count", mesh.groups.size()}};
  StoredArray position{
      "position_m", "m", "vertices in the frame of the mesh", {"vertex", "xyz"}, {mesh.vertices.size(), 3}};
  for (const Vec3& x : mesh.vertices) position.values.insert(position.values.end(), x.begin(), x.end());
  cloth.arrays.push_back(std::move(position));
  if (!mesh.pattern_m.empty()) {
    StoredArray pattern{"pattern_m", "m", "corners of each triangle at rest", {"triangle", "corner", "xy"}, {}};
    pattern.shape = {mesh.pattern_m.size(), 3, 2};
    for (const auto& triangle : mesh.pattern_m)
      for (const auto& corner : triangle) pattern.values.insert(pattern.values.end(), corner.begin(), corner.end());
    cloth.arrays.push_back(std::move(pattern));
  }
  for (std::size_t k = 0; const auto& [name, vertices] : mesh.groups) {
    StoredArray members{"vertex", "1", "vertices of the group", {"member"}, {vertices.size()}, true};
    members.values.assign(vertices.begin(), vertices.end());
    out.push_back({"cloth/" + std::to_string(k++), {{"name", name}}, {std::move(members)}});
  }
}

const StoredArray* array_of(const StoredGroup& g, const std::string& name) {
  for (const StoredArray& a : g.arrays)
    if (a.name == name) return &a;
  return nullptr;
}

/// Returns the array; throws unless its shape is `shape`, in which 0 stands for any length.
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
    throw Error("/" + g.path + "/" + name + " is missing or does not have the expected shape");
  return *a;
}

/// A vertex index. Throws unless it is below `vertices`.
std::uint32_t vertex_of(double stored, std::size_t vertices, const std::string& path) {
  if (!(stored >= 0 && stored < static_cast<double>(vertices))) throw Error("/" + path + ": expected vertex indices");
  return static_cast<std::uint32_t>(stored);
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
        throw Error("/" + g.path + "/joint_index: expected joint indices");
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
    auto& corners = mesh->triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = vertex_of(t.values[3 * (mesh->triangles.size() - 1) + i], mesh->vertex_count(), g.path);
  }
  mesh->closed = g.attributes.value("closed", 0.0) != 0;
  if (array_of(g, "joint_matrix") != nullptr) read_joints(g, *mesh, scene, k, colliders);
  scene.colliders[k].mesh = std::move(mesh);
}

const ColliderKind* kind_named(const std::string& name) {
  for (const ColliderKind& kind : collider_kinds())
    if (name == kind.name) return &kind;
  return nullptr;
}

void read_collider(const StoredGroup& g, Scene& scene, std::size_t k, std::size_t colliders) {
  Collider& c = scene.colliders[k];
  const json& a = g.attributes;
  c.name = a.at("name").get<std::string>();
  c.margin_m = a.at("margin_m").get<double>();
  c.friction = a.at("friction").get<double>();
  c.recorded = a.value("recorded", 0.0) != 0;
  const auto shape = a.at("shape").get<std::string>();
  const ColliderKind* const found = kind_named(shape);
  if (found == nullptr) throw Error("/" + g.path + ": no collider has the shape " + shape);
  const ColliderKind& kind = *found;
  c.shape = kind.shape;
  for (const ColliderNumbers& n : kind.numbers)
    for (std::size_t i = 0; i < n.count; ++i)
      n.at(c)[i] = (n.count == 1 ? a.at(n.name) : a.at(n.name).at(i)).get<double>();
  if (kind.holds == ColliderKind::Holds::Capsules) read_capsules(g, scene, k, colliders);
  if (kind.holds == ColliderKind::Holds::Mesh) read_mesh(g, scene, k, colliders);
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

void read_jumps(const StoredGroup& g, Scene& scene) {
  if (array_of(g, "jump_frame") == nullptr) return;
  const StoredArray& frame = expect_shape(g, "jump_frame", {0});
  const StoredArray& distance = expect_shape(g, "jump_m", {frame.shape[0]});
  for (std::size_t k = 0; k < frame.values.size(); ++k)
    scene.jumps.push_back({static_cast<int>(frame.values[k]), distance.values[k]});
}

std::map<std::string, const StoredGroup*> by_path(const std::vector<StoredGroup>& groups) {
  std::map<std::string, const StoredGroup*> out;
  for (const StoredGroup& g : groups) out[g.path] = &g;
  return out;
}

/// Calls `with(group, k)` for the groups `path`/0, `path`/1, ...; the attribute `count` of `path` is their number.
template <class With>
void each_numbered(const std::map<std::string, const StoredGroup*>& groups, const std::string& path, With with) {
  const auto count = static_cast<std::size_t>(groups.at(path)->attributes.at("count").get<double>());
  for (std::size_t k = 0; k < count; ++k) {
    const auto found = groups.find(path + "/" + std::to_string(k));
    if (found == groups.end()) throw Error("/" + path + "/" + std::to_string(k) + " is missing");
    with(*found->second, k, count);
  }
}

/// Sets colliders, grips, their motion, `jumps` and `assets` from the output of `replay_of`; nothing else.
void restore_replay(const std::vector<StoredGroup>& groups, Scene& scene) {
  const auto named = by_path(groups);
  if (!named.contains("colliders")) return;
  const StoredGroup& all = *named.at("colliders");
  scene.assets = all.attributes.value("assets", "");
  read_jumps(all, scene);
  each_numbered(named, "colliders", [&](const StoredGroup& g, std::size_t k, std::size_t count) {
    scene.colliders.resize(count);
    read_collider(g, scene, k, count);
  });
  if (named.contains("colliders/grips")) read_grips(*named.at("colliders/grips"), scene);
}

/// The cloth's mesh. `triangles`: 3 vertex indices per triangle, which files store elsewhere.
std::shared_ptr<const ClothMesh> restore_mesh(const std::vector<StoredGroup>& groups,
                                              const std::vector<std::uint32_t>& triangles) {
  const auto named = by_path(groups);
  if (!named.contains("cloth")) throw Error("/cloth, the cloth's mesh, is missing");
  const StoredGroup& cloth = *named.at("cloth");
  const StoredArray& position = expect_shape(cloth, "position_m", {0, 3});
  assets::MeshFile file;
  for (std::size_t k = 0; k + 2 < position.values.size(); k += 3)
    file.vertices.push_back({position.values[k], position.values[k + 1], position.values[k + 2]});
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
    file.triangles.push_back({triangles[k], triangles[k + 1], triangles[k + 2]});
  std::vector<PatternTriangle> pattern;
  if (array_of(cloth, "pattern_m") != nullptr) {
    const double* v = expect_shape(cloth, "pattern_m", {file.triangles.size(), 3, 2}).values.data();
    for (std::size_t t = 0; t < file.triangles.size(); ++t, v += 6)
      pattern.push_back({{{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}}});
  }
  ClothMesh mesh = cloth_mesh(std::move(file), "/cloth", std::move(pattern));
  each_numbered(named, "cloth", [&](const StoredGroup& g, std::size_t, std::size_t) {
    std::vector<std::uint32_t>& members = mesh.groups[g.attributes.at("name").get<std::string>()];
    for (const double v : expect_shape(g, "vertex", {0}).values)
      members.push_back(vertex_of(v, mesh.vertices.size(), g.path));
  });
  return std::make_shared<const ClothMesh>(std::move(mesh));
}

Scene stored_scene(const RunHeader& header, const std::vector<StoredGroup>& groups) {
  Scene scene = scene_from_parts(json_from(header.scenario_json), "scenario_json",
                                 {[&](json&) { return restore_mesh(groups, header.triangles); },
                                  [&](json&, Scene& s) { restore_replay(groups, s); }});
  // A study renames scenes (header.scene); scenario_json still has the name in the scene's file.
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

std::vector<StoredGroup> replay_of(const Scene& scene) {
  std::vector<StoredGroup> out;
  if (scene.cloth.mesh) add_cloth(*scene.cloth.mesh, out);
  if (scene.colliders.empty() && scene.grips.vertices.empty()) return out;
  out.push_back({"colliders", {{"count", scene.colliders.size()}, {"frame_rate_hz", scene.time.frame_rate_hz}}, {}});
  if (!scene.assets.empty()) out.back().attributes["assets"] = scene.assets;
  add_jumps(scene, out.back().arrays);
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    StoredGroup& g = out.emplace_back();
    g.path = "colliders/" + std::to_string(k);
    g.attributes = attributes_of(c);
    const ColliderKind::Holds holds = kind_of(c).holds;
    if (holds == ColliderKind::Holds::Capsules) g.arrays.push_back(capsules_of(scene, k));
    if (holds == ColliderKind::Holds::Mesh) add_mesh(scene, k, g.arrays);
  }
  if (!scene.grips.vertices.empty()) out.push_back(grips_of(scene));
  return out;
}

void show_shape(StoredGroup& g) {
  const ColliderKind* const kind = kind_named(g.attributes.value("shape", ""));
  if (kind == nullptr || kind->holds != ColliderKind::Holds::Numbers) return;
  Scene scene;
  scene.colliders.resize(1);
  read_collider(g, scene, 0, 1);
  const Collider& c = scene.colliders[0];
  if (kind->capsules != nullptr) {
    scene.motion = {{{{kind->capsules(c, {}), {}}}, {}, {}}};
    scene.colliders[0].capsules = scene.motion[0].colliders[0].capsules;
    g.arrays.push_back(capsules_of(scene, 0));
    return;
  }
  ColliderSurface surface = kind->surface(c, {}, {c.center_m});
  add_triangles(std::move(surface.positions), surface.triangles, g.arrays);
  g.attributes["convex"] = kind->convex ? 1 : 0;
}

StoredMotion read_motion(const std::filesystem::path& path) {
  RunRecord r = read_run(path);
  StoredMotion m;
  if (r.accuracy.position.empty()) return m;
  try {
    m.scene = stored_scene(r.header, r.replay);
    m.contact_margins_m = stored_margins(r.header, m.scene.colliders.size());
    m.time_s = std::move(r.accuracy.time_s);
    m.position = std::move(r.accuracy.position);
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
