#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "assets/assets.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// A scene with contact and the ranges of what is drawn in it: one entry of a study of protocol contact.
struct ContactKind {
  std::string name;     ///< in tables, such as "sweep-mesh"
  std::string how;      ///< which code draws it: "draw/how" of the study's schema
  nlohmann::json base;  ///< the scene, with the changes of the study
  nlohmann::json ranges;
  std::string at;  ///< file and JSON pointer of the block, for messages
};

/// The kind that an entry of a study's "scenes" describes. `base`: the file of its scene; `at`: file and JSON pointer
/// of the entry; `ranges`: these instead of the entry's of the same names. Throws Error if the entry has no "draw".
ContactKind contact_kind(const nlohmann::json& entry, const std::filesystem::path& base, const std::string& at,
                         const nlohmann::json& ranges);

/// Draws contact scenes. The same study, kind, seed and assets give the same scene on any machine: see `Dice`; numbers
/// are rounded to 1e-6, so that they do not depend on the last bit of a math library either.
class ContactDrawer {
 public:
  /// Throws Error with Assets::Required if rooms or hands have not been fetched.
  explicit ContactDrawer(Assets assets);
  ~ContactDrawer();

  /// An ordinary scene, not completed, named `<study>-<seed>-<kind>`, with "seed" and "drawn". What is drawn:
  ///   desk     any table of any room; place on it, height, yaw, tilt, throw (any direction not upwards)
  ///   shape    size, place, height, yaw, tilt and throw of a cloth over a ball, or over a box in any orientation
  ///   sweep    a hand's pose, orientation, way (any direction, either side), depth and speed
  ///   push     a hand's pose, orientation, way, depth and the durations of push and hold
  ///   stretch  speed and way of two hands, and where they hold the cloth
  ///   fold     radius, height, thickness and unevenness of a cloth folded over
  ///   crumple  height, throw, thickness and unevenness of a cloth that stands on edge
  /// Hands come, leave and stay away for 1 s. Drops have a floor 1 m below. Hands and grips of more than 5 m/s have
  /// shorter frames: a hand moves by at most 70 mm in one. Throws Error naming a range that is missing, unknown or
  /// empty.
  nlohmann::json draw(const ContactKind&, const std::string& study, std::uint64_t seed);

 private:
  struct Tables;
  assets::AssetSource source_;
  std::unique_ptr<Tables> tables_;
};

}  // namespace clothbench
