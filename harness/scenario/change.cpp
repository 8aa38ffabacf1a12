#include "scenario/change.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using Matrix = Eigen::Matrix3d;

constexpr double kDegrees = 180 / std::numbers::pi;

void scale(json& object, const char* key, double by) {
  if (object.contains(key)) object[key] = by * object[key].get<double>();
}

void scale_list(json& list, double by) {
  for (json& x : list) x = by * x.get<double>();
}

bool is_identity(const SceneChange& c) { return c.turn == SceneChange{}.turn; }

Matrix matrix_of(const SceneChange& c) {
  Matrix m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m(i, k) = c.turn[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  return m;
}

/// Sets a rotated box's angles about the world's x, then y, then z axis.
void turn_box(json& box, const SceneChange& c) {
  if (is_identity(c)) return;
  const Vec3 old = vec3(box["rotation_deg"]);
  using Turn = Eigen::AngleAxisd;
  const Matrix r = matrix_of(c) * (Turn(old[2] / kDegrees, Eigen::Vector3d::UnitZ()) *
                                   Turn(old[1] / kDegrees, Eigen::Vector3d::UnitY()) *
                                   Turn(old[0] / kDegrees, Eigen::Vector3d::UnitX()))
                                      .toRotationMatrix();
  box["rotation_deg"] = {kDegrees * std::atan2(r(2, 1), r(2, 2)), -kDegrees * std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
                         kDegrees * std::atan2(r(1, 0), r(0, 0))};
}

class Changer {
 public:
  Changer(const SceneChange& c, const std::string& source) : c_(c), source_(source) {}

  json changed(json s) {
    cloth(s["cloth"]);
    material(s["material"]);
    s["gravity_m_per_s2"] = c_.turned(scaled(c_.length / (c_.time * c_.time), vec3(s["gravity_m_per_s2"])));
    for (json& collider : s["colliders"]) change(collider);
    for (json& grip : s["grips"]) {
      if (!grip.contains("edge")) refuse("a hand");
      grip["velocity_m_per_s"] = velocity(grip["velocity_m_per_s"]);
      scale(grip, "ramp_s", c_.time);
    }
    s["time"]["frame_rate_hz"] = s["time"]["frame_rate_hz"].get<double>() / c_.time;
    scale(s["time"], "duration_s", c_.time);
    return s;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(source_ + ": " + what + " cannot be moved or scaled with its scene");
  }

  Vec3 place(const json& j) const { return plus(c_.turned(scaled(c_.length, vec3(j))), c_.offset_m); }
  Vec3 velocity(const json& j) const { return c_.turned(scaled(c_.length / c_.time, vec3(j))); }

  void cloth(json& j) const {
    json& pose = j["pose"];
    if (pose.contains("over_table")) refuse("a sheet over a table");
    if (j.contains("mesh") && !j["mesh"].contains("drawn")) refuse("a mesh of a file");
    scale_list(j.contains("mesh") ? j["mesh"]["drawn"]["size_m"] : j["size_m"], c_.length);
    scale(j, "areal_density_kg_per_m2", 1 / (c_.length * c_.length));
    pose["center_m"] = place(pose["center_m"]);
    for (const char* axis : {"axis_u", "axis_v"}) pose[axis] = c_.turned(vec3(pose[axis]));
    if (j.contains("self_collision")) scale(j["self_collision"], "thickness_m", c_.length);
    scale(pose, "span_m", c_.length);
    if (pose.contains("drape"))
      for (const char* key : {"radius_m", "offset_m"}) scale(pose["drape"], key, c_.length);
    j["initial_velocity_m_per_s"] = velocity(j["initial_velocity_m_per_s"]);
  }

  void material(json& j) const {
    const double energy = c_.length * c_.length / (c_.time * c_.time);
    if (j["membrane_stiffness_N_per_m"].is_number()) scale(j, "membrane_stiffness_N_per_m", 1 / (c_.time * c_.time));
    scale(j, "bending_rigidity_N_m", energy);
    scale(j, "damping_per_s", 1 / c_.time);
  }

  void change(json& j) const {
    const auto type = j["type"].get<std::string>();
    if (type == "room" || type.starts_with("hand")) refuse("a collider of type " + type);
    for (const auto& [key, value] : j.items())
      if (value.is_number() && key.ends_with("_m")) value = c_.length * value.get<double>();
    for (const char* key : {"center_m", "point_m"})
      if (j.contains(key)) j[key] = place(j[key]);
    for (const char* key : {"normal", "axis"})
      if (j.contains(key)) j[key] = c_.turned(vec3(j[key]));
    if (j.contains("size_m")) scale_list(j["size_m"], c_.length);
    if (type == "box") turn_box(j, c_);
    if (type == "mesh")
      for (json& p : j["positions_m"]) p = place(p);
  }

  const SceneChange& c_;
  const std::string& source_;
};

/// Irregular scenes are valid for one position and one size only.
void refuse_irregular(const json& s, const std::string& source) {
  const auto check = [&](const json& object, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (object.contains(key)) throw Error(source + ": a scene with \"" + key + "\" cannot be moved or scaled");
  };
  check(s["cloth"], {"spin_rad_per_s", "column_factors", "mass_factors", "start"});
  check(s["material"], {"regions"});
  check(s["time"], {"hitch", "jitter"});
  for (const json& grip : s["grips"]) check(grip, {"stop_s", "release_s", "jumps"});
  for (const json& collider : s["colliders"])
    if (collider["type"] == "capsule")
      throw Error(source + ": a scene with a collider of type capsule cannot be moved or scaled");
}

}  // namespace

Vec3 SceneChange::turned(const Vec3& v) const {
  Vec3 out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = turn[i][0] * v[0] + turn[i][1] * v[1] + turn[i][2] * v[2];
  return out;
}

json change_scene(json scenario, const SceneChange& c, const std::string& source) {
  refuse_irregular(scenario, source);
  return Changer(c, source).changed(std::move(scenario));
}

}  // namespace clothbench
