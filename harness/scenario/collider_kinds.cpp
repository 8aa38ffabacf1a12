#include "scenario/collider_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "clothbench/vector.hpp"
#include "scenario/collider_reader.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

// Plane: the half-space behind a point.

void read_plane(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Plane;
  c.center_m = vec3(j["point_m"]);
  c.normal = reader.unit(j, "normal");
}

SurfacePlace nearest_on_plane(const Collider& c, const Vec3& p) {
  const auto map = [](const Vec3& v) { return assets::Vector::Map(v.data()); };
  return {map(c.normal).dot(map(p) - map(c.center_m)), c.normal};
}

ColliderSurface square_of_plane(const Collider& c, const ColliderPose&, const Extent& seen) {
  static constexpr std::array<std::array<std::uint32_t, 3>, 2> kTriangles = {{{0, 1, 2}, {0, 2, 3}}};
  const Vec3& n = c.normal;
  Vec3 x = cross(n, std::abs(n[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const double across = length(x), away = dot(minus(seen.middle, c.center_m), n);
  for (double& v : x) v /= across;
  const Vec3 y = cross(n, x);
  ColliderSurface out{{}, kTriangles};
  for (int i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out.positions.push_back(seen.middle[k] - away * n[k] + (i == 1 || i == 2 ? 1 : -1) * seen.reach_m * x[k] +
                              (i >= 2 ? 1 : -1) * seen.reach_m * y[k]);
  return out;
}

ColliderKind plane_kind() {
  ColliderKind k{Collider::Shape::Plane, "plane", Feature::Plane, Feature::Plane};
  k.types = {{"plane", read_plane}};
  k.numbers = {{"point_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"normal", 3, [](Collider& c) { return c.normal.data(); }}};
  k.surface = square_of_plane;
  k.nearest = nearest_on_plane;
  k.half_space = k.convex = true;
  return k;
}

// A static sphere: a capsule of zero length.

void read_sphere(const json& j, ColliderReader&, Collider& c) {
  c.shape = Collider::Shape::Sphere;
  c.center_m = vec3(j["center_m"]);
  c.radius_m = j["radius_m"].get<double>();
}

ColliderKind sphere_kind() {
  ColliderKind k{Collider::Shape::Sphere, "sphere", Feature::Sphere, Feature::Sphere};
  k.types = {{"sphere", read_sphere}};
  k.numbers = {{"center_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"radius_m", 1, [](Collider& c) { return &c.radius_m; }}};
  k.capsules = [](const Collider& c, const ColliderPose&) {
    return std::vector<Capsule>{{c.center_m, c.center_m, c.radius_m}};
  };
  return k;
}

// A static box.

void read_box(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Box;
  c.center_m = vec3(j["center_m"]);
  const Vec3 size = vec3(j["size_m"]), turn = vec3(j["rotation_deg"]);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(size[k] > 0)) reader.refuse("/size_m", "expected three lengths above 0");
    c.half_extent_m[k] = size[k] / 2;
  }
  const Eigen::Matrix3d r = assets::from_degrees(assets::Vector::Map(turn.data())).toRotationMatrix();
  for (int k = 0; k < 3; ++k) c.axes[static_cast<std::size_t>(k)] = to_vec3(assets::Vector(r.col(k)));
}

SurfacePlace nearest_on_box(const Collider& box, const Vec3& p) {
  using V = assets::Vector;
  const V from = V::Map(p.data()) - V::Map(box.center_m.data());
  V at = V::Zero(), out = V::Zero();
  double inside = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const V axis = V::Map(box.axes[k].data());
    const double x = axis.dot(from), h = box.half_extent_m[k];
    at += std::clamp(x, -h, h) * axis;
    if (h - std::abs(x) < inside) {
      inside = h - std::abs(x);
      out = (x < 0 ? -1 : 1) * axis;
    }
  }
  if (inside >= 0) return {-inside, to_vec3(out)};
  const double distance = (from - at).norm();
  return {distance, to_vec3(V((from - at) / distance))};
}

ColliderSurface faces_of_box(const Collider& box, const ColliderPose&, const Extent&) {
  // The three bits of a corner's index are x, y, z. A face consists of two triangles that share its diagonal.
  static const std::vector<std::array<std::uint32_t, 3>> kTriangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                                                       {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                                       {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  ColliderSurface out{{}, kTriangles};
  for (unsigned corner = 0; corner < 8; ++corner)
    for (std::size_t k = 0; k < 3; ++k) {
      double x = box.center_m[k];
      for (unsigned a = 0; a < 3; ++a) x += ((corner >> a & 1u) != 0 ? 1 : -1) * box.half_extent_m[a] * box.axes[a][k];
      out.positions.push_back(x);
    }
  return out;
}

ColliderKind box_kind() {
  ColliderKind k{Collider::Shape::Box, "box", Feature::Box, Feature::Box};
  k.types = {{"box", read_box}};
  k.numbers = {{"center_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"half_extent_m", 3, [](Collider& c) { return c.half_extent_m.data(); }},
               {"axis_u", 3, [](Collider& c) { return c.axes[0].data(); }},
               {"axis_v", 3, [](Collider& c) { return c.axes[1].data(); }},
               {"axis_w", 3, [](Collider& c) { return c.axes[2].data(); }}};
  k.surface = faces_of_box;
  k.nearest = nearest_on_box;
  k.convex = true;
  return k;
}

// Kinematic capsules: one capsule that follows a path, or the capsules of a hand.

/// A capsule of length `length_m` about `center` at a time, its unit `axis` rotated by `spin` [rad/s] x time.
Capsule moved_capsule(const Path& path, const Vec3& center, const Vec3& axis, double length_m, double radius_m,
                      const Vec3& spin, double time_s) {
  // Rodrigues' formula.
  const double rate = length(spin);
  Vec3 turned = axis;
  if (rate > 0) {
    const Vec3 w = {spin[0] / rate, spin[1] / rate, spin[2] / rate};
    const double c = std::cos(rate * time_s), s = std::sin(rate * time_s);
    turned = plus(plus(scaled(c, axis), scaled(s, cross(w, axis))), scaled(1 - c, scaled(dot(w, axis), w)));
  }
  const Vec3 middle = plus(center, path.displacement(time_s)), half = scaled(length_m / 2, turned);
  return {minus(middle, half), plus(middle, half), radius_m};
}

void read_capsule(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Capsules;
  const Vec3 center = vec3(j["center_m"]), axis = reader.unit(j, "axis"), spin = vec3(j["spin_rad_per_s"]);
  const double length = j["length_m"].get<double>(), radius = j["radius_m"].get<double>();
  reader.pose = [=, path = reader.path(j)](double t) {
    return ColliderPose{{moved_capsule(path, center, axis, length, radius, spin, t)}, {}};
  };
  c.capsules = reader.pose(0).capsules;
}

ColliderKind capsules_kind() {
  ColliderKind k{Collider::Shape::Capsules, "capsules", Feature::Capsules, Feature::Capsules};
  k.types = {{"capsule", read_capsule}, {"hand_capsules", [](const json& j, ColliderReader& reader, Collider& c) {
                                           read_hand(j, reader, c, false);
                                         }}};
  k.holds = ColliderKind::Holds::Capsules;
  k.capsules = [](const Collider& c, const ColliderPose& pose) {
    return pose.capsules.empty() ? c.capsules : pose.capsules;
  };
  return k;
}

// Meshes: static triangles (in the scene, a prism or a room) and the skin of a hand.

void read_cylinder(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  const Vec3 axis = reader.unit(j, "axis");
  c.mesh = collider_mesh(assets::prism(assets::Vector(axis[0], axis[1], axis[2]),
                                       assets::Vector::Map(vec3(j["center_m"]).data()), j["radius_m"].get<double>(),
                                       j["length_m"].get<double>(), j["sides"].get<std::uint32_t>()));
}

void read_mesh(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  assets::TriangleMesh m;
  for (const json& p : j["positions_m"]) m.add_vertex({p[0].get<double>(), p[1].get<double>(), p[2].get<double>()});
  for (std::size_t t = 0; t < j["triangles"].size(); ++t) {
    const json& corners = j["triangles"][t];
    for (std::size_t k = 0; k < 3; ++k)
      if (corners[k].get<std::size_t>() >= m.vertex_count())
        reader.refuse(fmt::format("/triangles/{}/{}", t, k),
                      fmt::format("vertex {} of {} (the first is 0)", corners[k].get<std::size_t>(), m.vertex_count()));
    m.triangles.push_back(corners.get<std::array<std::uint32_t, 3>>());
  }
  c.mesh = collider_mesh(m);
}

/// A user's capture is read from its file. It is no asset, so no procedural stand-in may replace it.
assets::Room room_of(const std::string& name, ColliderReader& reader) {
  if (!name.ends_with(".json")) return assets::open_room(reader.assets(), name);
  return assets::load_room(file_of_scene(name, reader.source()).value_or(name));
}

void read_room(const json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Mesh;
  c.name = j["room"].get<std::string>();
  const assets::Room room = room_of(c.name, reader);
  const auto cut = j["cut"].get<std::string>();
  std::optional<assets::Table> table;
  assets::TriangleMesh round_table;
  if (j.contains("table")) {
    table = assets::find_table(room, j["table"].get<std::string>());
    c.name += "/" + j["table"].get<std::string>();
    const assets::Box box = assets::box_around(*table, j["below_m"].get<double>(), j["above_m"].get<double>());
    round_table = assets::cut(room.mesh, box);
    if (round_table.triangles.empty()) reader.refuse("", "expected at least one triangle of the room in the box");
  } else if (cut != "none") {
    reader.refuse("", fmt::format("\"table\" is missing; cut \"{}\" needs one", cut));
  }
  c.mesh = collider_mesh(cut == "none" ? room.mesh : round_table);
  // Even if the collider is the whole room, the cloth is placed over the cut-out mesh, because the room has a ceiling.
  if (table) reader.table = {*table, *collider_mesh(round_table)};
}

ColliderKind mesh_kind() {
  ColliderKind k{Collider::Shape::Mesh, "mesh", Feature::StaticMesh, Feature::MovingMesh};
  k.types = {{"cylinder", read_cylinder},
             {"mesh", read_mesh},
             {"room", read_room},
             {"hand_mesh", [](const json& j, ColliderReader& reader, Collider& c) { read_hand(j, reader, c, true); }}};
  k.holds = ColliderKind::Holds::Mesh;
  k.surface = [](const Collider& c, const ColliderPose& pose, const Extent&) {
    return ColliderSurface{posed_positions(*c.mesh, pose), c.mesh->triangles};
  };
  return k;
}

}  // namespace

const std::vector<ColliderKind>& collider_kinds() {
  static const std::vector<ColliderKind> all = {plane_kind(), sphere_kind(), box_kind(), capsules_kind(), mesh_kind()};
  return all;
}

const ColliderKind& kind_of(const Collider& c) {
  for (const ColliderKind& kind : collider_kinds())
    if (kind.shape == c.shape) return kind;
  throw Error("collider " + c.name + ": no such shape");
}

Feature Collider::feature() const { return moves() ? kind_of(*this).moving : kind_of(*this).standing; }

std::vector<double> posed_positions(const ColliderMesh& mesh, const ColliderPose& pose) {
  if (!mesh.skinned()) return mesh.positions;
  if (pose.joints.size() != mesh.joint_count)
    throw Error("posed_positions: expected " + std::to_string(mesh.joint_count) + " joints; found " +
                std::to_string(pose.joints.size()));
  std::vector<double> out(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (std::size_t k = 0; k < 4; ++k) {
      const double weight = static_cast<double>(mesh.weights[v][k]);
      if (weight == 0) continue;
      const Affine& m = pose.joints[mesh.joints[v][k]];
      for (std::size_t row = 0; row < 3; ++row) {
        double at = m[row][3];
        for (std::size_t c = 0; c < 3; ++c) at += m[row][c] * mesh.positions[3 * v + c];
        out[3 * v + row] += weight * at;
      }
    }
  return out;
}

const FrameMotion* Scene::motion_after(int index) const {
  if (motion.empty()) return nullptr;
  const auto last = static_cast<int>(motion.size()) - 1;
  return &motion[static_cast<std::size_t>(std::clamp(index + 1, 0, last))];
}

FeatureSet unsupported(const SolverInfo& info, FeatureSet needs) {
  FeatureSet missing = needs - (info.supports | info.ignores);
  for (const auto& [feature, beside] : info.only_with)
    if (needs.has(feature) && !needs.has(beside)) missing.add(feature);
  return missing;
}

std::string missing_features(const SolverInfo& info, FeatureSet needs) {
  std::string text;
  unsupported(info, needs).for_each([&](Feature f) {
    text += (text.empty() ? info.name + " has no " : ", ") + std::string(name_of(f));
  });
  return text;
}

}  // namespace clothbench
