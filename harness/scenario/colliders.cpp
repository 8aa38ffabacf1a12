#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/collider_kinds.hpp"
#include "scenario/collider_reader.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kRadians = std::numbers::pi / 180;

const ColliderType& type_of(const std::string& name) {
  for (const ColliderKind& kind : collider_kinds())
    for (const ColliderType& type : kind.types)
      if (name == type.name) return type;
  throw Error("collider type " + name + ": it is in the schema but has no implementation");
}

using assets::Vector;

/// Clips a polygon to f >= 0, f linear.
template <class F>
std::vector<Vector> clip(const std::vector<Vector>& polygon, F f) {
  std::vector<Vector> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double fa = f(a), fb = f(b);
    if (fa >= 0) out.push_back(a);
    if ((fa < 0) != (fb < 0)) out.push_back(a + (b - a) * (fa / (fa - fb)));
  }
  return out;
}

struct Edges {
  Vector middle_of_long, along, across;  ///< a point [m]; two horizontal unit vectors, `across` away from the table
  Vector center;
};

Edges edges_of(const assets::Table& table) {
  const auto c = table.top_corners();
  std::size_t longest = 0;
  const auto side = [&](std::size_t k) { return Vector(c[(k + 1) % 4] - c[k]); };
  if (side(1).norm() > side(0).norm()) longest = 1;
  Edges e;
  e.center = (c[0] + c[1] + c[2] + c[3]) / 4;
  e.middle_of_long = (c[longest] + c[(longest + 1) % 4]) / 2;
  e.along = side(longest);
  e.along.y() = 0;
  e.along.normalize();
  e.across = e.along.cross(Vector::UnitY());
  if (e.across.dot(e.middle_of_long - e.center) < 0) e.across = -e.across;
  return e;
}

/// Initial pose of a sheet above a table.
struct TablePose {
  Vec3 center_m{}, axis_u{}, axis_v{};
};

/// Horizontal, aligned with the table's sides, `inset_m` from its middle, `drop_m` above the highest point of `mesh`
/// below the cloth. Throws Error if no part of the mesh is below the cloth.
TablePose flat_over(const assets::Table& table, const ColliderMesh& mesh, const Cloth& cloth, double drop_m,
                    double inset_m) {
  const Edges e = edges_of(table);
  const Vector center = e.center - inset_m * e.across;
  const double highest =
      highest_below(mesh, {to_vec3(center), {to_vec3(e.along), to_vec3(e.across)}, {cloth.width_m, cloth.height_m}});
  if (!std::isfinite(highest))
    throw Error("/cloth/pose/over_table: expected a part of the table's mesh below the cloth");
  // axis_u x axis_v points down, as for the sheets of other scenes with (u, v) = (x, z).
  Vector v = e.along.cross(Vector::UnitY());
  return {{center.x(), highest + drop_m, center.z()}, to_vec3(e.along), to_vec3(v)};
}

/// Corner first: the lowest corner is `drop_m` above the table and `inset_m` inside the middle of a long edge. One
/// diagonal rises at `tilt` [rad] along that edge. The other diagonal is horizontal and perpendicular to the edge, so
/// that half of the cloth is beyond the edge if `inset_m` is 0.
TablePose corner_first_over(const assets::Table& table, const Cloth& cloth, double drop_m, double tilt,
                            double inset_m) {
  const Edges e = edges_of(table);
  const Vector rising = std::cos(tilt) * e.along + std::sin(tilt) * Vector::UnitY();
  // The lowest corner is u0v0. The diagonal from it rises; u and v are at 45 degrees to it.
  const Vector u = (rising + e.across) / std::sqrt(2.0), v = (rising - e.across) / std::sqrt(2.0);
  const Vector lowest = e.middle_of_long - inset_m * e.across + drop_m * Vector::UnitY();
  return {to_vec3(Vector(lowest + cloth.width_m / 2 * u + cloth.height_m / 2 * v)), to_vec3(u), to_vec3(v)};
}

class StageReader {
 public:
  StageReader(json& scenario, Scene& scene, const std::string& source, Assets wanted)
      : scenario_(scenario), scene_(scene), reader_(scene, source, wanted) {}

  void read() {
    json& list = scenario_["colliders"];
    for (std::size_t k = 0; k < list.size(); ++k) {
      reader_.enter(fmt::format("/colliders/{}", k));
      scene_.colliders.push_back(collider(list[k]));
      poses_.push_back(std::move(reader_.pose));
      if (reader_.table) tables_[k] = *reader_.table;
    }
    place_cloth();
    for (std::size_t k = 0; k < scenario_["grips"].size(); ++k) {
      reader_.enter(fmt::format("/grips/{}", k));
      grip(scenario_["grips"][k]);
    }
    sample_motion();
    if (!scene_.assets.empty()) scenario_["assets"] = scene_.assets;
  }

 private:
  Collider collider(json& j) {
    const auto type = j["type"].get<std::string>();
    reader_.complete(j, "collider_" + type);
    Collider c;
    c.margin_m = j["margin_m"].get<double>();
    c.friction = j["friction"].get<double>();
    c.name = type;
    type_of(type).read(j, reader_, c);
    return c;
  }

  void place_cloth() {
    json& pose = scenario_["cloth"]["pose"];
    if (!pose.contains("over_table")) return;
    reader_.enter("/cloth/pose/over_table");
    const json& over = pose["over_table"];
    const auto index = over["collider"].get<std::size_t>();
    const auto table = tables_.find(index);
    if (table == tables_.end())
      reader_.refuse("/collider", fmt::format("/colliders/{}: expected a collider of type room with a table", index));
    const auto& [box, mesh] = table->second;
    const double drop = over["drop_m"].get<double>(), inset = over["inset_m"].get<double>();
    const TablePose at = over["at"] == "center" ? flat_over(box, mesh, scene_.cloth, drop, inset)
                                                : corner_first_over(box, scene_.cloth, drop,
                                                                    over["tilt_deg"].get<double>() * kRadians, inset);
    scene_.cloth.center_m = at.center_m;
    scene_.cloth.axis_u = at.axis_u;
    scene_.cloth.axis_v = at.axis_v;
    pose["center_m"] = at.center_m;
    pose["axis_u"] = scene_.cloth.axis_u;
    pose["axis_v"] = scene_.cloth.axis_v;
  }

  struct Grip {
    std::optional<MovingHand> by;  ///< a hand; empty: the bar
    Path bar;
    std::vector<std::uint32_t> vertices;
  };

  void grip(json& j) {
    const bool edge = j.contains("edge") || j.contains("group");
    reader_.complete(j, edge ? "grip_edge" : "grip_hand");
    Grip g = edge ? edge_grip(j) : hand_grip(j);
    for (std::uint32_t v : g.vertices) {
      if (contains(scene_.grips.vertices, v)) reader_.refuse("", fmt::format("vertex {} is held by two hands", v));
      if (contains(scene_.pins.vertices, v)) reader_.refuse("", fmt::format("vertex {} is pinned as well", v));
      scene_.grips.vertices.push_back(v);
    }
    grips_.push_back(std::move(g));
  }

  Grip edge_grip(const json& j) {
    Grip g;
    g.bar = reader_.path(j);
    if (j.contains("edge") == j.contains("group")) reader_.refuse("", "expected either \"edge\" or \"group\"");
    g.vertices = selected_vertices(scene_.cloth, j, reader_.source(), reader_.pointer());
    return g;
  }

  Grip hand_grip(const json& j) {
    Grip g;
    g.by = moving_hand(j, reader_, false);
    if (g.by->recording) reader_.refuse("/track", "a recorded hand cannot hold cloth; expected a hand track");
    const assets::HandSample start = assets::sample(g.by->track, *g.by->hand, 0);
    if (!start.grip)
      reader_.refuse("/track", "expected \"grip\": true in the first key; this hand holds nothing at time 0");
    const double radius = j["radius_m"].get<double>();
    const assets::Vector pinch = assets::pinch_point(start.pose);
    const std::vector<double> x = initial_positions(scene_);
    for (std::size_t v = 0; v < x.size() / 3; ++v)
      if ((assets::Vector::Map(x.data() + 3 * v) - pinch).norm() <= radius)
        g.vertices.push_back(static_cast<std::uint32_t>(v));
    if (g.vertices.empty())
      reader_.refuse("/radius_m",
                     fmt::format("expected a vertex within {} m of the pinch point ({:.4f}, {:.4f}, {:.4f})", radius,
                                 pinch.x(), pinch.y(), pinch.z()));
    return g;
  }

  /// Attached vertices move rigidly with this frame: origin at the pinch point, rotation of the palm.
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
      for (std::size_t k = 0; k < scene_.colliders.size(); ++k)
        m.colliders.push_back(scene_.colliders[k].moves() ? poses_[k](t) : ColliderPose{});
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
    const Vec3 moved = g.bar.displacement(t);
    for (std::uint32_t v : g.vertices) {
      m.grip_position_m.push_back(plus(vertex_at(x, v), moved));
      m.grip_held.push_back(g.bar.held(t) ? 1 : 0);
    }
  }

  json& scenario_;
  Scene& scene_;
  ColliderReader reader_;
  std::map<std::size_t, ColliderReader::RoundTable> tables_;  ///< by collider index
  std::vector<std::function<ColliderPose(double)>> poses_;    ///< by collider index
  std::vector<Grip> grips_;
};

}  // namespace

void read_colliders(json& scenario, Scene& scene, const std::string& source, Assets assets) {
  StageReader(scenario, scene, source, assets).read();
}

double highest_below(const ColliderMesh& mesh, const Footprint& f) {
  const Vector center = Vector::Map(f.center_m.data());
  double highest = -INFINITY;
  for (const auto& t : mesh.triangles) {
    std::vector<Vector> part;
    for (std::uint32_t v : t) part.push_back(Vector::Map(mesh.positions.data() + 3 * v));
    for (const double sign : {1.0, -1.0})
      for (std::size_t k = 0; k < 2; ++k)
        part = clip(part, [&](const Vector& p) {
          return f.size_m[k] / 2 - sign * (p - center).dot(Vector::Map(f.axes[k].data()));
        });
    for (const Vector& p : part) highest = std::max(highest, p.y());
  }
  return highest;
}

}  // namespace clothbench
