#include "scenario/draw_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "scenario/collider_reader.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using std::numbers::pi;

constexpr double kFloorBelow_m = 1, kFloorSide_m = 100, kFloorDepth_m = 1;

double scaled_unit(double x) { return std::round(x * 1e12) / 1e12; }

/// Axes of a level cloth after a random yaw and a random tilt about a horizontal axis.
std::array<Vec3, 2> draw_axes(DrawnValues& draw) {
  const double yaw = draw.between("yaw_deg") * pi / 180, tilt = draw.between("tilt_deg") * pi / 180,
               about = draw.between("yaw_deg", "tilt_about_deg") * pi / 180;
  const Eigen::AngleAxisd turn(tilt, assets::Vector(std::cos(about), 0, std::sin(about)));
  std::array<Vec3, 2> out = {to_vec3(turn * assets::Vector(std::cos(yaw), 0, std::sin(yaw))),
                             to_vec3(turn * assets::Vector(-std::sin(yaw), 0, std::cos(yaw)))};
  for (Vec3& axis : out)
    for (double& x : axis) x = scaled_unit(x);
  return out;
}

/// Places the cloth over (x, z) with its lowest point at height `lowest_m`.
void place(json& scene, const std::array<Vec3, 2>& axes, double x, double z, double lowest_m) {
  json& cloth = scene["cloth"];
  const double reach = (cloth["size_m"][0].get<double>() * std::abs(axes[0][1]) +
                        cloth["size_m"][1].get<double>() * std::abs(axes[1][1])) /
                       2;
  cloth["pose"] = {{"center_m", rounded(Vec3{x, lowest_m + reach, z})}, {"axis_u", axes[0]}, {"axis_v", axes[1]}};
}

/// A random initial velocity that does not point upwards. Returns the speed.
double draw_throw(json& scene, DrawnValues& draw) {
  const double speed = draw.between("throw_m_per_s"), round = draw.dice().between(0, 2 * pi),
               down = std::asin(draw.dice().unit());
  const Vec3 v = rounded(Vec3{speed * std::cos(down) * std::cos(round), -speed * std::sin(down),
                              speed * std::cos(down) * std::sin(round)});
  scene["cloth"]["initial_velocity_m_per_s"] = v;
  for (std::size_t k = 0; k < 3; ++k) draw.note(std::string("throw_") + "xyz"[k] + "_m_per_s", v[k]);
  return speed;
}

double after_fall(double speed, double height_m) {
  return std::hypot(speed, std::sqrt(2 * kGravity_m_per_s2 * height_m));
}

/// Adds a box, because some solvers do not support planes.
void add_floor(json& scene, double x, double top_m, double z) {
  json floor = {{"type", "box"},
                {"center_m", rounded(Vec3{x, top_m - kFloorDepth_m / 2, z})},
                {"size_m", {kFloorSide_m, kFloorDepth_m, kFloorSide_m}}};
  for (const char* key : {"margin_m", "friction"})
    if (scene["colliders"][0].contains(key)) floor[key] = scene["colliders"][0][key];
  scene["colliders"].push_back(std::move(floor));
}

/// Height of a rotated box above its centre.
double reach_up(const std::array<Vec3, 3>& turn, const Vec3& size_m) {
  return (std::abs(turn[1][0]) * size_m[0] + std::abs(turn[1][1]) * size_m[1] + std::abs(turn[1][2]) * size_m[2]) / 2;
}

double draw_shape(json& scene, DrawnValues& draw) {
  json& c = scene["colliders"][0];
  double top = 0;
  if (c["type"] == "sphere") {
    c["radius_m"] = top = draw.between("radius_m");
  } else {
    const Vec3 size = {draw.between("size_m", "size_x_m"), draw.between("size_m", "size_y_m"),
                       draw.between("size_m", "size_z_m")};
    const auto turn = draw.dice().rotation();
    c["size_m"] = size;
    c["rotation_deg"] = rounded(euler_deg(turn));
    for (std::size_t k = 0; k < 3; ++k) draw.note(std::string("box_about_") + "xyz"[k] + "_deg", c["rotation_deg"][k]);
    top = reach_up(turn, size);
  }
  const auto axes = draw_axes(draw);
  const double x = draw.between("off_m", "off_x_m"), z = draw.between("off_m", "off_z_m"),
               height = draw.between("height_m");
  place(scene, axes, x, z, top + height);
  const double speed = draw_throw(scene, draw);
  add_floor(scene, 0, -kFloorBelow_m, 0);
  return after_fall(speed, height);
}

void draw_start(json& scene, DrawnValues& draw) {
  // A fraction of an edge. More noise would strain some edges at the start beyond the limit of `expect`.
  constexpr double kMostNoise = 0.05;
  const json& cloth = scene["cloth"];
  const double link = cloth["size_m"][0].get<double>() / (cloth["grid"][0].get<int>() - 1);
  const int seed = draw.dice().whole(0, 1000000000);
  const double noise = rounded(std::min(draw.between("noise_m"), kMostNoise * link));
  scene["cloth"]["start"] = {{"shape", "rest"}, {"noise_m", noise}, {"seed", seed}};
  scene["cloth"]["self_collision"]["thickness_m"] = draw.between("thickness_m");
  draw.note("start_seed", seed);
}

double draw_fold(json& scene, DrawnValues& draw) {
  const double radius = draw.between("radius_m"), height = draw.between("height_m");
  json& pose = scene["cloth"]["pose"];
  pose["drape"]["radius_m"] = radius;
  pose["center_m"] = {0, rounded(radius + height), 0};
  draw_start(scene, draw);
  return after_fall(0, height);
}

/// Point `index` of a sequence that fills the unit cube evenly in kBoxSides coordinates; further ones are random. A
/// tenth of the points moves to the nearest corner. Source: M. Roberts, The unreasonable effectiveness of quasirandom
/// sequences.
class BoxPoint {
 public:
  explicit BoxPoint(std::uint64_t index) : index_(index), dice_(index, "corner"), corner_(dice_.unit() < kCorners) {
    for (int k = 0; k < 64; ++k) root_ = std::pow(1 + root_, 1.0 / (kBoxSides + 1));
  }
  /// The next coordinate, in [0, 1].
  double next() {
    power_ /= root_;
    const double u = ++used_ > kBoxSides ? dice_.unit() : std::fmod(0.5 + static_cast<double>(index_) * power_, 1.0);
    return !corner_ ? u : u < 0.5 ? 0 : 1;
  }

 private:
  static constexpr int kBoxSides = 16;
  static constexpr double kCorners = 0.1;
  const std::uint64_t index_;
  Dice dice_;
  const bool corner_;
  double root_ = 1, power_ = 1;
  int used_ = 0;
};

/// The value at the fraction `u` of a range or a list of words; whole if `may_be_whole` and both bounds are integers.
json at_point(const json& range, double u, bool may_be_whole, const std::string& at) {
  const auto words = static_cast<std::size_t>(
      std::count_if(range.begin(), range.end(), [](const json& value) { return value.is_string(); }));
  if (words != range.size() && (words != 0 || range.size() != 2))
    throw Error(at + ": expected a list of words, or two numbers");
  if (words != 0)
    return range[std::min(range.size() - 1, static_cast<std::size_t>(u * static_cast<double>(range.size())))];
  const double low = range[0].get<double>(), high = range[1].get<double>();
  if (!(low <= high)) throw Error(at + ": expected the lower bound first");
  const double x = is_wide(low, high) ? low * std::pow(high / low, u) : low + u * (high - low);
  return may_be_whole && range[0].is_number_integer() && range[1].is_number_integer() ? json(std::lround(x))
                                                                                      : json(rounded(x));
}

/// Samples the ranges that all kinds share first, so that kinds with the same point of the box share these values.
void draw_box(json& scene, DrawnValues& draw, const ContactKind& kind, std::uint64_t seed) {
  if (!kind.box.contains("settings") || kind.box["settings"].empty())
    throw Error(kind.at +
                "/how: \"box\" samples the ranges of the study's key \"box\", which is missing or has no settings; add "
                "/box/settings/SOLVER");
  BoxPoint point(seed > 0 ? (seed - 1) / kind.kinds : 0);
  for (const auto& [solver, settings] : kind.box["settings"].items())
    for (const auto& [name, range] : settings.items()) {
      const json value = at_point(range, point.next(), true, "/box/settings/" + solver + "/" + name);
      draw.note(solver + "." + name, value);
      scene["drawn"]["settings"][solver][name] = value;
    }
  scene["drawn"]["claims"] = kind.kinds;
  for (const json& ranges : {kind.box.value("ranges", json::object()), kind.ranges})
    for (const auto& [key, range] : ranges.items()) {
      const json value = at_point(range, point.next(), false, draw.at() + "/" + key);
      draw.note(key, value);
      // The value is the side of a square.
      apply_override(scene, key + "=" + dump(key == "cloth.size_m" ? json{value, value} : value), draw.at());
    }
}

double draw_crumple(json& scene, DrawnValues& draw) {
  const double height = draw.between("height_m"), thrown = draw.between("throw_m_per_s"),
               yaw = draw.between("yaw_deg") * pi / 180;
  json& pose = scene["cloth"]["pose"];
  pose["center_m"] = {0, rounded(scene["cloth"]["size_m"][1].get<double>() / 2 + height), 0};
  pose["axis_u"] = {scaled_unit(std::cos(yaw)), 0, scaled_unit(std::sin(yaw))};
  scene["cloth"]["initial_velocity_m_per_s"] = {0, -thrown, 0};
  draw_start(scene, draw);
  return after_fall(thrown, height);
}

/// Replaces ranges by the ranges of the same name in the quick form.
void narrow(json& ranges, const json& quick) {
  for (auto& [name, range] : ranges.items())
    if (quick.contains(name)) range = quick[name];
}

}  // namespace

/// All tables of all rooms, with the meshes that a scene cuts out around them. Cached, because reading is slow.
struct ContactDrawer::Tables {
  struct Place {
    std::string room;
    assets::Table table;
    std::shared_ptr<ColliderMesh> mesh;
  };
  std::vector<Place> places;

  Tables(const assets::AssetSource& source, double below_m, double above_m) {
    // With procedural assets, all names give the same room.
    for (const std::string_view name : assets::kRoomNames) {
      const assets::Room room = assets::open_room(source, std::string(name));
      for (const assets::Table& t : room.tables) {
        const assets::TriangleMesh part = assets::cut(room.mesh, assets::box_around(t, below_m, above_m));
        if (!part.triangles.empty()) places.push_back({std::string(name), t, collider_mesh(part)});
      }
      if (!source.npm) break;
    }
    if (places.empty()) throw Error("the rooms have no table to drop a cloth on");
  }

  double draw(json& scene, DrawnValues& draw) const {
    const Place& at = places[static_cast<std::size_t>(draw.dice().whole(0, static_cast<int>(places.size()) - 1))];
    scene["colliders"][0]["room"] = at.room;
    scene["colliders"][0]["table"] = at.table.uuid;
    draw.note("room", at.room);
    draw.note("table", at.table.uuid);
    const auto corners = at.table.top_corners();
    const double a = draw.between("along_table"), b = draw.between("across_table");
    const assets::Vector point = corners[0] + a * (corners[1] - corners[0]) + b * (corners[3] - corners[0]);
    const auto axes = draw_axes(draw);
    const double height = draw.between("height_m"), reach = std::hypot(scene["cloth"]["size_m"][0].get<double>(),
                                                                       scene["cloth"]["size_m"][1].get<double>());
    const double below = highest_below(*at.mesh, {to_vec3(point), {{{1, 0, 0}, {0, 0, 1}}}, {reach, reach}});
    const double top = std::max(below, at.table.top_height());
    place(scene, axes, point.x(), point.z(), top + height);
    const double speed = draw_throw(scene, draw);
    add_floor(scene, point.x(), at.table.top_height() - kFloorBelow_m, point.z());
    return after_fall(speed, height);
  }
};

ContactKind contact_kind(const json& entry, const std::filesystem::path& base, const std::string& at, const json& quick,
                         const json& box) {
  if (!entry.contains("draw")) throw Error(at + ": \"draw\" is missing; protocol contact needs it");
  const json& draw = entry["draw"];
  ContactKind kind{draw["kind"],   draw["how"],  parse_json(read_text(base), base.string()),
                   draw["ranges"], at + "/draw", box};
  for (const json& set : {draw["set"], quick.value("/set"_json_pointer / kind.name, json::object())})
    for (const auto& [key, value] : set.items()) apply_override(kind.base, key + "=" + dump(value), base.string());
  const json ranges = quick.value("ranges", json::object());
  narrow(kind.ranges, ranges);
  for (auto& [part, of_box] : kind.box.items())
    if (part == "ranges")
      narrow(of_box, ranges);
    else
      for (auto& [solver, settings] : of_box.items()) narrow(settings, ranges);
  return kind;
}

ContactDrawer::ContactDrawer(Assets assets) : source_(assets::locate_assets(assets == Assets::Required)) {}

json ContactDrawer::draw(const ContactKind& kind, const std::string& study, std::uint64_t seed) {
  DrawnValues draw(Dice(seed, kind.name), kind.ranges, kind.at + "/ranges");
  json scene = kind.base;
  scene.erase("drawn");
  if (kind.ranges.contains("grid")) {
    const int grid = draw.whole("grid");
    scene["cloth"]["grid"] = {grid, grid};
  }
  double speed = 0;
  if (kind.how == "desk") {
    if (!tables_) {
      const json& room = scene["colliders"][0];
      tables_ = std::make_shared<Tables>(source_, room.value("below_m", 0.1), room.value("above_m", 0.05));
    }
    speed = tables_->draw(scene, draw);
  } else if (kind.how == "box") {
    draw_box(scene, draw, kind, seed);
  } else {
    static constexpr std::pair<const char*, double (*)(json&, DrawnValues&)> kHow[] = {
        {"shape", draw_shape},     {"sweep", draw_sweep},     {"push", draw_push}, {"stretch", draw_stretch},
        {"fold", draw_fold},       {"crumple", draw_crumple}, {"keys", draw_keys}, {"incline", draw_incline},
        {"capstan", draw_capstan}, {"held", draw_held}};
    const auto how = std::find_if(std::begin(kHow), std::end(kHow), [&](const auto& h) { return kind.how == h.first; });
    if (how == std::end(kHow)) throw Error(kind.at + "/how: \"" + kind.how + "\": no generator has this name");
    speed = how->second(scene, draw);
  }
  if (kind.how != "box") draw.check_all_used();
  scene["name"] = fmt::format("{}-{}-{}", study, seed, kind.name);
  scene["seed"] = seed;
  scene["drawn"].update({{"study", study},
                         {"kind", kind.name},
                         {"assets", source_.kind()},
                         {"speed_m_per_s", rounded(speed)},
                         {"values", draw.values()}});
  // These keys describe the paper's scene, not the generated one.
  for (const char* key : {"paper", "assumed"}) scene.erase(key);
  return scene;
}

bool is_wide(double low, double high) { return low > 0 && high >= 10 * low; }

double rounded(double x) { return std::round(x * 1e6) / 1e6; }

Vec3 rounded(const Vec3& v) { return {rounded(v[0]), rounded(v[1]), rounded(v[2])}; }

Vec3 euler_deg(const std::array<Vec3, 3>& m) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  return {kDegrees * std::atan2(m[2][1], m[2][2]), kDegrees * std::asin(std::clamp(-m[2][0], -1.0, 1.0)),
          kDegrees * std::atan2(m[1][0], m[0][0])};
}

DrawnValues::DrawnValues(Dice dice, const json& ranges, std::string at)
    : dice_(std::move(dice)), ranges_(ranges), at_(std::move(at)) {}

std::array<double, 2> DrawnValues::bounds(const std::string& name) {
  if (!ranges_.contains(name)) throw Error(fmt::format("{}: \"{}\" is missing", at_, name));
  used_.insert(name);
  const std::array<double, 2> r = {ranges_[name][0].get<double>(), ranges_[name][1].get<double>()};
  if (!(r[0] <= r[1])) throw Error(fmt::format("{}/{}: expected the lower bound first", at_, name));
  return r;
}

double DrawnValues::between(const std::string& name, const std::string& as) {
  const auto [low, high] = bounds(name);
  const double x = rounded(dice_.between(low, high));
  note(as, x);
  return x;
}

double DrawnValues::log_between(const std::string& name) {
  const auto [low, high] = bounds(name);
  if (!(low > 0)) throw Error(fmt::format("{}/{}: expected a range above 0", at_, name));
  const double x = rounded(dice_.log_between(low, high));
  note(name, x);
  return x;
}

double DrawnValues::natural(const std::string& name) {
  const auto [low, high] = bounds(name);
  return is_wide(low, high) ? log_between(name) : between(name);
}

int DrawnValues::whole(const std::string& name) {
  const auto [low, high] = bounds(name);
  if (low != std::floor(low) || high != std::floor(high))
    throw Error(fmt::format("{}/{}: expected whole numbers", at_, name));
  const int x = dice_.whole(static_cast<int>(low), static_cast<int>(high));
  note(name, x);
  return x;
}

void DrawnValues::check_all_used() const {
  for (const auto& [name, unused] : ranges_.items())
    if (!used_.contains(name))
      throw Error(
          fmt::format("{}/{}: this range is not used{}", at_, name, nearest_known(name, {used_.begin(), used_.end()})));
}

}  // namespace clothbench
