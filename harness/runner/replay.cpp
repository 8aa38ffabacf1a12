#include "runner/replay.hpp"

namespace clothbench {
namespace {

const char* name_of(Collider::Shape shape) {
  switch (shape) {
    case Collider::Shape::Plane:
      return "plane";
    case Collider::Shape::Sphere:
      return "sphere";
    case Collider::Shape::Box:
      return "box";
    case Collider::Shape::Capsules:
      return "capsules";
    case Collider::Shape::Mesh:
      return "mesh";
  }
  return "";
}

nlohmann::json attributes_of(const Collider& c) {
  nlohmann::json a = {
      {"name", c.name}, {"shape", name_of(c.shape)}, {"margin_m", c.margin_m}, {"friction", c.friction}};
  switch (c.shape) {
    case Collider::Shape::Plane:
      a["point_m"] = c.center_m;
      a["normal"] = c.normal;
      break;
    case Collider::Shape::Sphere:
      a["center_m"] = c.center_m;
      a["radius_m"] = c.radius_m;
      break;
    case Collider::Shape::Box:
      a["center_m"] = c.center_m;
      a["half_extent_m"] = c.half_extent_m;
      for (std::size_t k = 0; k < 3; ++k) a[std::string("axis_") + "uvw"[k]] = c.axes[k];
      break;
    case Collider::Shape::Capsules:
      break;
    case Collider::Shape::Mesh:
      a["closed"] = c.mesh->closed ? 1 : 0;
      break;
  }
  return a;
}

StoredArray capsules_of(const Scene& scene, std::size_t k) {
  StoredArray out{"capsules", "m", "ends a and b and radius of each capsule", {"frame", "capsule", "value"}, {},
                  false,      {}};
  out.shape = {scene.motion.size(), scene.colliders[k].capsules.size(), 7};
  for (const FrameMotion& m : scene.motion)
    for (const Capsule& c : m.colliders[k].capsules)
      out.values.insert(out.values.end(), {c.a_m[0], c.a_m[1], c.a_m[2], c.b_m[0], c.b_m[1], c.b_m[2], c.radius_m});
  return out;
}

/// The mesh once; where it is skinned also its weights, and the joints at every frame.
void add_mesh(const Scene& scene, std::size_t k, std::vector<StoredArray>& out) {
  const ColliderMesh& mesh = *scene.colliders[k].mesh;
  const std::uint64_t vertices = mesh.vertex_count();
  out.push_back({"position_m",
                 "m",
                 mesh.skinned() ? "vertices before skinning" : "vertices",
                 {"vertex", "xyz"},
                 {vertices, 3},
                 false,
                 mesh.positions});
  StoredArray triangles{
      "triangles", "1", "vertices of each triangle", {"triangle", "corner"}, {mesh.triangles.size(), 3}, true, {}};
  for (const auto& t : mesh.triangles) triangles.values.insert(triangles.values.end(), t.begin(), t.end());
  out.push_back(std::move(triangles));
  if (!mesh.skinned()) return;
  StoredArray joint{"joint_index", "1", "joints that a vertex follows", {"vertex", "slot"}, {vertices, 4}, true, {}};
  StoredArray weight{"joint_weight", "1", "share of each of them", {"vertex", "slot"}, {vertices, 4}, false, {}};
  for (std::size_t v = 0; v < vertices; ++v) {
    joint.values.insert(joint.values.end(), mesh.joints[v].begin(), mesh.joints[v].end());
    weight.values.insert(weight.values.end(), mesh.weights[v].begin(), mesh.weights[v].end());
  }
  StoredArray matrix{"joint_matrix",
                     "1 and m",
                     "skinning matrix of each joint: rows of (linear part, translation)",
                     {"frame", "joint", "row", "column"},
                     {scene.motion.size(), mesh.joint_count, 3, 4},
                     false,
                     {}};
  for (const FrameMotion& m : scene.motion)
    for (const Affine& a : m.colliders[k].joints)
      for (const auto& row : a) matrix.values.insert(matrix.values.end(), row.begin(), row.end());
  for (StoredArray* a : {&joint, &weight, &matrix}) out.push_back(std::move(*a));
}

StoredGroup grips_of(const Scene& scene) {
  const std::uint64_t grips = scene.grips.vertices.size(), frames = scene.motion.size();
  StoredArray vertex{"held_vertex", "1", "cloth vertex that a hand holds", {"grip"}, {grips}, true, {}};
  vertex.values.assign(scene.grips.vertices.begin(), scene.grips.vertices.end());
  StoredArray target{"target_m", "m", "where it is while held", {"frame", "grip", "xyz"}, {frames, grips, 3},
                     false,      {}};
  StoredArray held{"held", "1", "1 while held, 0 once let go", {"frame", "grip"}, {frames, grips}, true, {}};
  for (const FrameMotion& m : scene.motion) {
    for (const Vec3& p : m.grip_position_m) target.values.insert(target.values.end(), p.begin(), p.end());
    held.values.insert(held.values.end(), m.grip_held.begin(), m.grip_held.end());
  }
  return {"colliders/grips", nlohmann::json::object(), {vertex, target, held}};
}

}  // namespace

std::vector<StoredGroup> replay_of(const Scene& scene) {
  if (scene.colliders.empty() && scene.grips.vertices.empty()) return {};
  std::vector<StoredGroup> out;
  out.push_back({"colliders", {{"count", scene.colliders.size()}, {"frame_rate_hz", scene.time.frame_rate_hz}}, {}});
  if (!scene.assets.empty()) out.back().attributes["assets"] = scene.assets;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    StoredGroup& g = out.emplace_back();
    g.path = "colliders/" + std::to_string(k);
    g.attributes = attributes_of(c);
    if (c.shape == Collider::Shape::Capsules) g.arrays.push_back(capsules_of(scene, k));
    if (c.shape == Collider::Shape::Mesh) add_mesh(scene, k, g.arrays);
  }
  if (!scene.grips.vertices.empty()) out.push_back(grips_of(scene));
  return out;
}

}  // namespace clothbench
