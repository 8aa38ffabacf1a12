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

/// A scene with contact and the ranges of its randomly chosen values: one entry of a study of protocol contact.
struct ContactKind {
  std::string name;     ///< in tables, such as "sweep-mesh"
  std::string how;      ///< which code generates it: "draw/how" of the study's schema
  nlohmann::json base;  ///< the scene, with the changes of the study
  nlohmann::json ranges;
  std::string at;           ///< file and JSON pointer of the block, for messages
  nlohmann::json box = {};  ///< the study's "box": ranges that the kinds share, for "how": "box"
  std::uint64_t kinds = 1;  ///< of the study; each round of as many seeds, from seed 1 on, shares a point of the box
};

/// The kind that an entry of a study's "scenes" describes. `base`: the file of its scene; `at`: file and JSON pointer
/// of the entry; `quick`: the study's quick form, whose "ranges" and "set" apply; `box`: the study's. Throws Error if
/// the entry has no "draw".
ContactKind contact_kind(const nlohmann::json& entry, const std::filesystem::path& base, const std::string& at,
                         const nlohmann::json& quick = nlohmann::json::object(),
                         const nlohmann::json& box = nlohmann::json::object());

/// Generates random contact scenes. The same study, kind, seed and assets give the same scene on any machine: see
/// `Dice`; numbers are rounded to 1e-6, so that they do not depend on the last bit of a math library either.
class ContactDrawer {
 public:
  /// Throws Error with Assets::Required if rooms or hands have not been fetched.
  explicit ContactDrawer(Assets assets);

  /// An ordinary scene, not completed, named `<study>-<seed>-<kind>`, with "seed" and "drawn". Randomly chosen are:
  ///   desk     any table of any room; position on it, height, yaw, tilt, initial velocity (any direction not upwards)
  ///   shape    as desk, and the size of the cloth; over a sphere, or over a box in any orientation
  ///   sweep    a hand's pose, orientation, direction (any, either side), depth and speed
  ///   push     a hand's pose, orientation, direction, depth and the durations of push and hold
  ///   stretch  speed and displacement of two hands, and where they are attached
  ///   fold     radius, height, thickness and noise of a cloth folded over
  ///   keys     any numbers of the scene, each range named by its dotted key; the scene's grid stays
  ///   box      the same, and settings of solvers, from points that fill the box of all ranges evenly
  ///   crumple  height, initial velocity, thickness and noise of a cloth that stands on edge
  /// Hands come, leave and stay away for 1 s. Drops have a floor 1 m below. Hands and grips of more than 5 m/s have
  /// shorter frames: a hand moves by at most 70 mm in one. Throws Error naming a range that is missing, unknown or
  /// empty.
  nlohmann::json draw(const ContactKind&, const std::string& study, std::uint64_t seed);

 private:
  struct Tables;
  assets::AssetSource source_;
  std::shared_ptr<Tables> tables_;
};

/// Values chosen at random from named ranges and noted under their names.
class DrawnValues {
 public:
  /// `at`: file and JSON pointer of the ranges.
  DrawnValues(Dice dice, const nlohmann::json& ranges, std::string at);

  double between(const std::string& range) { return between(range, range); }
  /// A random value of a range, noted under another name.
  double between(const std::string& range, const std::string& name);
  double log_between(const std::string& range);
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

/// To 1e-6.
double rounded(double);
Vec3 rounded(const Vec3&);

/// Angles [deg] about the world's x, then y, then z axis that give this rotation (its rows).
Vec3 euler_deg(const std::array<Vec3, 3>&);

/// The hand of a sweep or a push, in colliders[0]. Returns its speed [m/s].
double draw_sweep(nlohmann::json& scene, DrawnValues&);
double draw_push(nlohmann::json& scene, DrawnValues&);
/// The two hands of a stretch, in grips. Returns their speed [m/s].
double draw_stretch(nlohmann::json& scene, DrawnValues&);

}  // namespace clothbench
