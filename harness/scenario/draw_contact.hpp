#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "assets/assets.hpp"
#include "base/dice.hpp"
#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// A scene with contact and ranges for its random values: one entry of a study with protocol contact.
struct ContactKind {
  std::string name;     ///< in tables, such as "sweep-mesh"
  std::string how;      ///< selects the generator: "draw/how" of the study's schema
  nlohmann::json base;  ///< the scene with the study's changes
  nlohmann::json ranges;
  std::string at;           ///< file and JSON pointer of the "draw" block, for messages
  nlohmann::json box = {};  ///< the study's "box": ranges that all kinds share, for "how": "box"
  std::uint64_t kinds = 1;  ///< number of kinds; each group of `kinds` successive seeds shares a point of the box
};

/// The kind that an entry of a study's "scenes" describes. `base`: file of its scene; `at`: file and JSON pointer of
/// the entry; `quick`: the study's quick form, whose "ranges" and "set" apply; `box`: the study's box. Throws Error if
/// the entry has no "draw".
ContactKind contact_kind(const nlohmann::json& entry, const std::filesystem::path& base, const std::string& at,
                         const nlohmann::json& quick = nlohmann::json::object(),
                         const nlohmann::json& box = nlohmann::json::object());

/// Generates random contact scenes. Study, kind, seed and assets determine the scene on any machine (see `Dice`);
/// numbers are rounded to 1e-6, so that the last bit of a math library does not matter either.
class ContactDrawer {
 public:
  /// Throws Error with Assets::Required if rooms or hands have not been fetched.
  explicit ContactDrawer(Assets assets);

  /// A scene, not yet resolved, named `<study>-<seed>-<kind>`, with "seed" and "drawn". Random values, by `how`:
  ///   desk     any table of any room; position on it, height, yaw, tilt, initial velocity (not upwards)
  ///   shape    as desk, and the size of the cloth; over a sphere, or over a box in any orientation
  ///   sweep    a hand's pose, orientation, direction (any, from either side), depth and speed
  ///   push     a hand's pose, orientation, direction, depth and the durations of push and hold
  ///   stretch  speed and displacement of two hands, and the vertices that they grip
  ///   fold     radius, height, thickness and noise of a folded cloth
  ///   keys     any numbers of the scene, each range named by its dotted key; `cells` along the cloth; `damping_ratio`
  ///            of cloth that comes to rest; `size_m` of the scaled scene, `time_factor` of its times
  ///   incline  as keys, and angle and initial speed of a sheet on a box
  ///   capstan  as keys, and the lengths of a strip on a cylinder and of its ends
  ///   held     as keys, and the tilt of a sheet and what holds it: 1 to 4 vertices or bars
  ///   box      as keys, and settings of solvers, from points that fill the box of all ranges evenly
  ///   crumple  height, initial velocity, thickness and noise of a cloth that stands on edge
  /// Hands approach, leave and stay away for 1 s. Dropped cloth has a floor 1 m below. Hands and grips faster than 5
  /// m/s get shorter frames: a hand moves at most 70 mm per frame. Throws Error naming a range that is missing, unknown
  /// or empty.
  nlohmann::json draw(const ContactKind&, const std::string& study, std::uint64_t seed);

 private:
  struct Tables;
  assets::AssetSource source_;
  std::shared_ptr<Tables> tables_;
};

/// Samples values from named ranges and records them under their names.
class DrawnValues {
 public:
  /// `at`: file and JSON pointer of the ranges.
  DrawnValues(Dice dice, const nlohmann::json& ranges, std::string at);

  double between(const std::string& range) { return between(range, range); }
  /// A random value of a range, recorded under another name.
  double between(const std::string& range, const std::string& name);
  double log_between(const std::string& range);
  /// log_between() if the range is wide, otherwise between().
  double natural(const std::string& range);
  int whole(const std::string& range);

  /// Lower and upper bound of a range. Throws Error if it is missing or empty.
  std::array<double, 2> bounds(const std::string& name);
  const nlohmann::json& ranges() const { return ranges_; }
  const std::string& at() const { return at_; }

  void note(const std::string& name, nlohmann::json value) { values_[name] = std::move(value); }
  Dice& dice() { return dice_; }
  const nlohmann::json& values() const { return values_; }
  /// Throws Error if a range has not been used.
  void check_all_used() const;

 private:
  Dice dice_;
  const nlohmann::json& ranges_;
  const std::string at_;
  nlohmann::json values_ = nlohmann::json::object();
  std::set<std::string> used_;
};

inline constexpr double kGravity_m_per_s2 = 9.81;

/// True if a range of positive numbers spans at least a decade. It is sampled logarithmically, because stiffness,
/// density and size have no natural scale.
bool is_wide(double low, double high);

/// Rounds to 1e-6.
double rounded(double);
Vec3 rounded(const Vec3&);

/// Angles [deg] about the world's x, then y, then z axis that give this rotation matrix (its rows).
Vec3 euler_deg(const std::array<Vec3, 3>&);

/// Adds the hand of a sweep or a push as colliders[0]. Returns its speed [m/s].
double draw_sweep(nlohmann::json& scene, DrawnValues&);
double draw_push(nlohmann::json& scene, DrawnValues&);
/// draw_physics.cpp: "how": "keys", "incline", "capstan" and "held". Each returns the initial speed [m/s] or 0.
double draw_keys(nlohmann::json& scene, DrawnValues&);
double draw_incline(nlohmann::json& scene, DrawnValues&);
double draw_capstan(nlohmann::json& scene, DrawnValues&);
double draw_held(nlohmann::json& scene, DrawnValues&);
/// Adds the two hands of a stretch to grips. Returns their speed [m/s].
double draw_stretch(nlohmann::json& scene, DrawnValues&);

}  // namespace clothbench
