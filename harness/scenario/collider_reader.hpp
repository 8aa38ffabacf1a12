#pragma once
#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assets/assets.hpp"
#include "assets/hand_track.hpp"
#include "assets/room.hpp"
#include "clothbench/collider.hpp"
#include "clothbench/scene.hpp"
#include "scenario/load.hpp"
#include "scenario/recorded_hand.hpp"

namespace clothbench {

/// Motion of a bar or a capsule. The speed rises as sin^2(pi t / 2 ramp_s), then stays constant until `stop_s`. Jumps
/// are added to this, each within the frame that contains its time.
struct Path {
  Vec3 velocity_m_per_s{};
  double ramp_s = 0, start_s = 0;
  std::optional<double> stop_s, release_s;
  struct At {
    double time_s = 0;
    Vec3 by_m{};
  };
  std::vector<At> jumps;

  /// Reads velocity_m_per_s from completed JSON, and ramp_s, start_s, stop_s, release_s, jumps where present.
  static Path read(const nlohmann::json&);
  /// Displacement [m] at `time_s`.
  Vec3 displacement(double time_s) const;
  bool held(double time_s) const { return !release_s || time_s < *release_s; }
};

/// Adds this path's jumps to the scene, each with the frame that contains it.
void note_jumps(const Path&, Scene&);

/// A capsule about `center_m` at a time: `length_m` along `axis` (a unit vector), turned by `spin_rad_per_s` x time.
Capsule moved_capsule(const Path&, const Vec3& center_m, const Vec3& axis, double length_m, double radius_m,
                      const Vec3& spin_rad_per_s, double time_s);

/// Context in which colliders and grips are read, one after another. It also takes a collider's motion and table.
class ColliderReader {
 public:
  ColliderReader(Scene& scene, const std::string& source, Assets wanted)
      : scene_(scene), source_(source), wanted_(wanted) {}

  /// Starts the object at this JSON pointer and clears `pose` and `table`.
  void enter(std::string at);
  /// Checks the object against a definition of the schema and fills in its defaults.
  void complete(nlohmann::json&, const std::string& definition) const;
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const;
  /// File and JSON pointer of a key of the object, as messages name them.
  std::string where(const std::string& key) const { return source_ + ": " + at_ + key; }
  /// Reads a vector, which must have length 1.
  Vec3 unit(const nlohmann::json&, const std::string& key) const;
  /// Reads a path and adds its jumps to the scene.
  Path path(const nlohmann::json&) const;
  const assets::AssetSource& assets();
  const std::string& source() const { return source_; }
  /// JSON pointer of the object.
  const std::string& pointer() const { return at_; }

  std::function<ColliderPose(double time_s)> pose;  ///< of a dynamic collider
  struct RoundTable {
    assets::Table table;
    ColliderMesh mesh;
  };
  std::optional<RoundTable> table;  ///< a table that a cloth can be placed over, with the mesh around it

 private:
  Scene& scene_;
  const std::string& source_;
  Assets wanted_;
  std::string at_;
  std::optional<assets::AssetSource> assets_;
};

/// A moving hand, with the data to sample its motion.
struct MovingHand {
  std::optional<assets::Hand> hand;  ///< empty if a recording needs no hand model
  assets::HandTrack track;
  std::optional<assets::HandRecording> recording;    ///< instead of the track
  assets::Vector offset_m = assets::Vector::Zero();  ///< of the whole track
};

/// Reads the keys `track` and `speed_m_per_s` of a collider or a grip.
MovingHand moving_hand(const nlohmann::json&, ColliderReader&, bool as_mesh);

/// Reads a hand as a collider: its mesh, or its capsules.
void read_hand(const nlohmann::json&, ColliderReader&, Collider&, bool as_mesh);

/// Initial pose of a sheet above a table.
struct TablePose {
  Vec3 center_m{}, axis_u{}, axis_v{};
};

/// A level rectangle: its centre, the directions of its sides (unit vectors), and their lengths.
struct Footprint {
  Vec3 center_m{};
  std::array<Vec3, 2> axes{};
  std::array<double, 2> size_m{};
};

/// Height [m] of the mesh's highest point above or below the rectangle; -infinity if nothing is there.
double highest_below(const ColliderMesh&, const Footprint&);

/// Level, centred on the table and aligned with its sides, `drop_m` above the highest point of `mesh` below the cloth.
/// Throws Error if no part of the mesh is below the cloth.
TablePose flat_over(const assets::Table&, const ColliderMesh& mesh, const Cloth&, double drop_m);

/// Corner first: the lowest corner is `drop_m` above the table and `inset_m` inside the middle of a long edge. One
/// diagonal rises at `tilt` [rad] along that edge; the other is level and across it, so that half the cloth is beyond
/// the edge if `inset_m` is 0.
TablePose corner_first_over(const assets::Table&, const Cloth&, double drop_m, double tilt, double inset_m);

}  // namespace clothbench
