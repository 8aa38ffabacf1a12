#include "scenario/colliders.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <optional>

#include "assets/assets.hpp"
#include "assets/hand_track.hpp"
#include "assets/submesh.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "scenario/load.hpp"
#include "scenario/path.hpp"
#include "scenario/recorded_hand.hpp"
#include "scenario/schemas.hpp"
#include "scenario/table_pose.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double kUnit = 1e-9;  // how far from length 1 a unit vector may be
constexpr double kRadians = std::numbers::pi / 180;

/// A hand on its way; keeps what is needed to sample it.
struct Moving {
  std::optional<assets::Hand> hand;  ///< none where a recording needs none
  assets::HandTrack track;
  std::optional<assets::HandRecording> recording;  ///< instead of the track
  assets::Vector offset = assets::Vector::Zero();  ///< of the whole track
};

class ColliderReader {
 public:
  ColliderReader(json& scenario, Scene& scene, const std::string& source, Assets wanted)
      : scenario_(scenario), scene_(scene), source_(source), wanted_(wanted) {}

  void read() {
    json& list = scenario_["colliders"];
    for (std::size_t k = 0; k < list.size(); ++k) {
      at_ = fmt::format("/colliders/{}", k);
      scene_.colliders.push_back(collider(list[k]));
      hands_.resize(scene_.colliders.size());
    }
    place_cloth();
    for (std::size_t k = 0; k < scenario_["grips"].size(); ++k) {
      at_ = fmt::format("/grips/{}", k);
      grip(scenario_["grips"][k]);
    }
    sample_motion();
    if (assets_) scenario_["assets"] = scene_.assets = assets_->kind();
  }

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const {
    throw Error(source_ + ": " + at_ + key + ": " + expected);
  }

  const assets::AssetSource& assets() {
    if (!assets_) assets_ = assets::locate_assets(wanted_ == Assets::Required);
    return *assets_;
  }

  Collider collider(json& j) {
    const auto type = j["type"].get<std::string>();
    json schema = json::parse(kSceneSchema);
    json sub = schema["definitions"]["collider_" + type];
    sub["definitions"] = schema["definitions"];
    validate_json(j, sub.dump(), source_, at_);
    fill_defaults(j, sub.dump());
    Collider c;
    c.margin_m = j["margin_m"].get<double>();
    c.friction = j["friction"].get<double>();
    c.name = type;
    if (type == "plane") plane(j, c);
    if (type == "sphere") sphere(j, c);
    if (type == "box") box(j, c);
    if (type == "capsule") capsule(j, c);
    if (type == "cylinder") cylinder(j, c);
    if (type == "mesh") mesh(j, c);
    if (type == "room") room(j, c);
    if (type == "hand_capsules" || type == "hand_mesh") hand(j, c, type == "hand_mesh");
    return c;
  }

  void plane(const json& j, Collider& c) const {
    c.shape = Collider::Shape::Plane;
    c.center_m = vec3(j["point_m"]);
    c.normal = vec3(j["normal"]);
    const double squared = c.normal[0] * c.normal[0] + c.normal[1] * c.normal[1] + c.normal[2] * c.normal[2];
    if (!(std::abs(squared - 1) <= kUnit)) refuse("/normal", "expected a vector of length 1");
  }

  void sphere(const json& j, Collider& c) const {
    c.shape = Collider::Shape::Sphere;
    c.center_m = vec3(j["center_m"]);
    c.radius_m = j["radius_m"].get<double>();
  }

  void box(const json& j, Collider& c) const {
    c.shape = Collider::Shape::Box;
    c.center_m = vec3(j["center_m"]);
    const Vec3 size = vec3(j["size_m"]), turn = vec3(j["rotation_deg"]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(size[k] > 0)) refuse("/size_m", "expected three lengths above 0");
      c.half_extent_m[k] = size[k] / 2;
    }
    using Turn = Eigen::AngleAxisd;
    const Eigen::Matrix3d r =
        (Turn(turn[2] * kRadians, Eigen::Vector3d::UnitZ()) * Turn(turn[1] * kRadians, Eigen::Vector3d::UnitY()) *
         Turn(turn[0] * kRadians, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    for (int k = 0; k < 3; ++k) c.axes[static_cast<std::size_t>(k)] = to_vec3(assets::Vector(r.col(k)));
  }

  void capsule(const json& j, Collider& c) {
    c.shape = Collider::Shape::Capsules;
    const Path path = Path::read(j);
    const Vec3 center = vec3(j["center_m"]), axis = vec3(j["axis"]), spin = vec3(j["spin_rad_per_s"]);
    const double length = j["length_m"].get<double>(), radius = j["radius_m"].get<double>();
    if (!(std::abs(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] - 1) <= kUnit))
      refuse("/axis", "expected a vector of length 1");
    const auto at = [=](double t) { return moved_capsule(path, center, axis, length, radius, spin, t); };
    c.capsules = {at(0)};
    note_jumps(path, scene_);
    capsules_[scene_.colliders.size()] = at;
  }

  void cylinder(const json& j, Collider& c) const {
    c.shape = Collider::Shape::Mesh;
    const Vec3 axis = vec3(j["axis"]);
    const double squared = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    if (!(std::abs(squared - 1) <= kUnit)) refuse("/axis", "expected a vector of length 1");
    c.mesh = collider_mesh(assets::prism(assets::Vector(axis[0], axis[1], axis[2]),
                                         assets::Vector::Map(vec3(j["center_m"]).data()), j["radius_m"].get<double>(),
                                         j["length_m"].get<double>(), j["sides"].get<std::uint32_t>()));
  }

  void mesh(const json& j, Collider& c) const {
    c.shape = Collider::Shape::Mesh;
    assets::TriangleMesh m;
    for (const json& p : j["positions_m"]) m.add_vertex({p[0].get<double>(), p[1].get<double>(), p[2].get<double>()});
    for (std::size_t t = 0; t < j["triangles"].size(); ++t) {
      const json& corners = j["triangles"][t];
      for (std::size_t k = 0; k < 3; ++k)
        if (corners[k].get<std::size_t>() >= m.vertex_count())
          refuse(fmt::format("/triangles/{}/{}", t, k),
                 fmt::format("vertex {} of {} (the first is 0)", corners[k].get<std::size_t>(), m.vertex_count()));
      m.triangles.push_back(
          {corners[0].get<std::uint32_t>(), corners[1].get<std::uint32_t>(), corners[2].get<std::uint32_t>()});
    }
    c.mesh = collider_mesh(m);
  }

  void room(const json& j, Collider& c) {
    c.shape = Collider::Shape::Mesh;
    c.name = j["room"].get<std::string>();
    const assets::Room room = room_of(c.name);
    const auto cut = j["cut"].get<std::string>();
    std::optional<assets::Table> table;
    assets::TriangleMesh round_table;
    if (j.contains("table") && j.contains("points_m")) refuse("/points_m", "expected either a table or six points");
    if (j.contains("table") || j.contains("points_m")) {
      assets::Box box;
      if (j.contains("table")) {
        table = assets::find_table(room, j["table"].get<std::string>());
        c.name += "/" + j["table"].get<std::string>();
        box = assets::box_of(assets::six_points(*table, j["below_m"].get<double>(), j["above_m"].get<double>()));
      } else {
        std::array<assets::Vector, 6> points;
        for (std::size_t k = 0; k < 6; ++k) points[k] = assets::Vector::Map(vec3(j["points_m"][k]).data());
        const assets::Box picked = assets::box_of(points);
        table = assets::table_in(picked);
        const assets::Vector grow = assets::Vector::Constant(j.value("grow_m", 0.0));
        box = assets::Box(picked.min() - grow, picked.max() + grow);
      }
      const auto mode = cut == "crossing" ? assets::CutMode::Crossing : assets::CutMode::AnyVertexInside;
      round_table = assets::cut(room.mesh, box, mode).mesh;
      if (round_table.triangles.empty()) refuse("", "no triangle of the room is in the box");
    } else if (cut != "none") {
      refuse("", fmt::format("\"table\" or \"points_m\" is missing; cut \"{}\" goes round one", cut));
    }
    c.mesh = collider_mesh(cut == "none" ? room.mesh : round_table);
    // The cloth is placed by what is round the table, the same with the whole room, whose ceiling is above it too.
    if (table) tables_[scene_.colliders.size()] = {*table, *collider_mesh(round_table)};
  }

  /// A capture of the user's own is no asset that a stand-in could take the place of.
  assets::Room room_of(const std::string& name) {
    if (!name.ends_with(".json")) return assets::open_room(assets(), name);
    return assets::load_room(file_of_scene(name, source_).value_or(name));
  }

  fs::path track_file(const std::string& name) const {
    if (const auto found = file_of_scene(name, source_)) return *found;
    refuse("/track", fmt::format("\"{}\": no such file beside the scene or in {}", name, scenario_root().string()));
  }

  Moving moving(const json& j, bool as_mesh) {
    const fs::path file = track_file(j["track"].get<std::string>());
    if (const std::string text = read_text(file); assets::is_hand_recording(parse_json(text, file.string()))) {
      if (j.contains("speed_m_per_s")) refuse("/speed_m_per_s", "a recording goes at the speed it was made at");
      Moving m{{}, {}, assets::parse_hand_recording(text, file.string())};
      if (as_mesh && !m.recording->mesh) m.hand = assets::open_hand(assets(), m.recording->side);
      return m;
    }
    assets::HandTrack track = assets::read_hand_track(file);
    if (j.contains("speed_m_per_s")) {
      try {
        track = assets::retimed(std::move(track), j["speed_m_per_s"].get<double>());
      } catch (const Error& e) {
        refuse("/speed_m_per_s", e.what());
      }
    }
    return {assets::open_hand(assets(), track.side), track, {}};
  }

  void hand(const json& j, Collider& c, bool as_mesh) {
    Moving m = moving(j, as_mesh);
    if (j.contains("offset_m")) m.offset = assets::Vector::Map(vec3(j["offset_m"]).data());
    c.name = fs::path(j["track"].get<std::string>()).stem().string();
    c.shape = as_mesh ? Collider::Shape::Mesh : Collider::Shape::Capsules;
    if (as_mesh)
      c.mesh = m.recording && m.recording->mesh ? collider_mesh(*m.recording->mesh) : collider_mesh(m.hand->mesh);
    else
      c.capsules = pose_at(m, false, 0).capsules;
    hands_.resize(scene_.colliders.size() + 1);
    hands_.back() = std::move(m);
  }

  static ColliderPose pose_at(const Moving& m, bool as_mesh, double time_s) {
    if (m.recording) {
      const assets::RecordedHand now = m.recording->at(time_s);
      return as_mesh ? mesh_pose(*m.recording, now, m.hand ? &*m.hand : nullptr, m.offset)
                     : capsules_pose(*m.recording, now, m.offset);
    }
    const assets::HandSample now = assets::sample(m.track, *m.hand, time_s);
    ColliderPose pose;
    if (!as_mesh) {
      for (const assets::Capsule& c : assets::capsules(now.pose))
        pose.capsules.push_back(
            {to_vec3(assets::Vector(c.a + m.offset)), to_vec3(assets::Vector(c.b + m.offset)), c.radius_m});
      return pose;
    }
    for (std::size_t k = 0; k < assets::kJointCount; ++k)
      pose.joints.push_back(
          affine(Eigen::Translation3d(m.offset) * (now.pose.joints[k] * m.hand->mesh.inverse_bind[k])));
    return pose;
  }

  void place_cloth() {
    json& pose = scenario_["cloth"]["pose"];
    if (!pose.contains("over_table")) return;
    at_ = "/cloth/pose/over_table";
    const json& over = pose["over_table"];
    const auto index = over["collider"].get<std::size_t>();
    const auto table = tables_.find(index);
    if (table == tables_.end())
      refuse("/collider", fmt::format("/colliders/{} is no collider of type room with a table", index));
    const auto& [box, mesh] = table->second;
    const double drop = over["drop_m"].get<double>();
    const TablePose at = over["at"] == "center"
                             ? flat_over(box, mesh, scene_.cloth, drop)
                             : corner_first_over(box, scene_.cloth, drop, over["tilt_deg"].get<double>() * kRadians);
    scene_.cloth.center_m = at.center_m;
    const bool turned = over.value("turned", false);
    if (turned && (scene_.cloth.width_m != scene_.cloth.height_m)) refuse("/turned", "expected a square cloth");
    scene_.cloth.axis_u = turned ? at.axis_v : at.axis_u;
    scene_.cloth.axis_v = turned ? at.axis_u : at.axis_v;
    pose["center_m"] = at.center_m;
    pose["axis_u"] = scene_.cloth.axis_u;
    pose["axis_v"] = scene_.cloth.axis_v;
  }

  struct Grip {
    std::optional<Moving> by;  ///< a hand; otherwise the bar
    Path bar;
    std::vector<std::uint32_t> vertices;
  };

  void grip(json& j) {
    const bool edge = j.contains("edge");
    const json schema = json::parse(kSceneSchema);
    json sub = schema["definitions"][edge ? "grip_edge" : "grip_hand"];
    sub["definitions"] = schema["definitions"];
    validate_json(j, sub.dump(), source_, at_);
    fill_defaults(j, sub.dump());
    Grip g = edge ? edge_grip(j) : hand_grip(j);
    for (std::uint32_t v : g.vertices) {
      for (std::uint32_t w : scene_.grips.vertices)
        if (v == w) refuse("", fmt::format("vertex {} is held by two hands", v));
      for (std::uint32_t w : scene_.pins.vertices)
        if (v == w) refuse("", fmt::format("vertex {} is pinned as well", v));
      scene_.grips.vertices.push_back(v);
    }
    grips_.push_back(std::move(g));
  }

  Grip edge_grip(const json& j) {
    Grip g;
    g.bar = Path::read(j);
    note_jumps(g.bar, scene_);
    g.vertices = edge_vertices(scene_.cloth, j["edge"].get<std::string>());
    return g;
  }

  Grip hand_grip(const json& j) {
    Grip g;
    g.by = moving(j, false);
    if (g.by->recording) refuse("/track", "a recorded hand holds nothing; expected a hand track");
    const assets::HandSample start = assets::sample(g.by->track, *g.by->hand, 0);
    if (!start.grip) refuse("/track", "this hand does not hold anything at time 0 (\"grip\": true in its first key)");
    const double radius = j["radius_m"].get<double>();
    const assets::Vector pinch = assets::pinch_point(start.pose);
    const std::vector<double> x = initial_positions(scene_);
    for (std::size_t v = 0; v < x.size() / 3; ++v)
      if ((assets::Vector::Map(x.data() + 3 * v) - pinch).norm() <= radius)
        g.vertices.push_back(static_cast<std::uint32_t>(v));
    if (g.vertices.empty())
      refuse("/radius_m", fmt::format("no vertex within {} m of the pinch point ({:.4f}, {:.4f}, {:.4f})", radius,
                                      pinch.x(), pinch.y(), pinch.z()));
    return g;
  }

  /// Held vertices follow the hand rigidly: the frame of its pinch, turned as its palm.
  static assets::Frame pinch_frame(const assets::HandPose& pose) {
    assets::Frame f = assets::palm_frame(pose);
    f.translation() = assets::pinch_point(pose);
    return f;
  }

  void sample_motion() {
    bool any = !grips_.empty();
    for (const Collider& c : scene_.colliders) any = any || c.moves();
    if (!any) return;
    const std::vector<double> x = initial_positions(scene_);
    for (int frame = 0; frame <= scene_.time.frames(); ++frame) {
      const double t = scene_.time.at(frame);
      FrameMotion& m = scene_.motion.emplace_back();
      for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
        const Collider& c = scene_.colliders[k];
        if (const auto capsule = capsules_.find(k); capsule != capsules_.end()) {
          m.colliders.push_back({{capsule->second(t)}, {}});
          continue;
        }
        m.colliders.push_back(c.moves() ? pose_at(*hands_[k], c.shape == Collider::Shape::Mesh, t) : ColliderPose{});
      }
      for (const Grip& g : grips_) g.by ? move_by_hand(g, t, x, m) : move_by_bar(g, t, x, m);
    }
  }

  void move_by_hand(const Grip& g, double t, const std::vector<double>& x, FrameMotion& m) const {
    const assets::HandSample start = assets::sample(g.by->track, *g.by->hand, 0),
                             now = assets::sample(g.by->track, *g.by->hand, t);
    const assets::Frame move = pinch_frame(now.pose) * pinch_frame(start.pose).inverse();
    for (std::uint32_t v : g.vertices) {
      const bool before =
          scene_.motion.size() == 1 || scene_.motion[scene_.motion.size() - 2].grip_held[m.grip_held.size()] != 0;
      m.grip_position_m.push_back(to_vec3(assets::Vector(move * assets::Vector::Map(x.data() + 3 * v))));
      m.grip_held.push_back(before && now.grip ? 1 : 0);
    }
  }

  static void move_by_bar(const Grip& g, double t, const std::vector<double>& x, FrameMotion& m) {
    const Vec3 way = g.bar.way(t);
    for (std::uint32_t v : g.vertices) {
      Vec3& to = m.grip_position_m.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) to[k] = x[3 * v + k] + way[k];
      m.grip_held.push_back(g.bar.held(t) ? 1 : 0);
    }
  }

  json& scenario_;
  Scene& scene_;
  const std::string& source_;
  Assets wanted_;
  std::string at_;
  std::optional<assets::AssetSource> assets_;
  std::map<std::size_t, std::pair<assets::Table, ColliderMesh>> tables_;  ///< by collider; with the mesh round it
  std::vector<std::optional<Moving>> hands_;                              ///< by collider
  std::map<std::size_t, std::function<Capsule(double)>> capsules_;        ///< by collider
  std::vector<Grip> grips_;
};

}  // namespace

void read_colliders(json& scenario, Scene& scene, const std::string& source, Assets assets) {
  ColliderReader(scenario, scene, source, assets).read();
}

}  // namespace clothbench
