#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
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

namespace clothbench {

inline Vec3 to_vec3(const assets::Vector& v) { return {v.x(), v.y(), v.z()}; }

/// Finds a file that a scene names: next to the scene `source`, or in the scenarios folder; empty if in neither.
std::optional<std::filesystem::path> file_of_scene(const std::string& name, const std::string& source);
/// As file_of_scene, but throws Error at `pointer` of the scene if the file is not found.
std::filesystem::path needed_file(const std::string& name, const std::string& source, const std::string& pointer);

/// A mesh for solvers; `closed` if it is the closed surface of a solid, with outward normals.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::TriangleMesh&);
/// Mesh of a hand for solvers. It follows the hand's joints; `closed` has the same condition.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::SkinnedMesh&);

/// The 19 capsules of a hand, and the matrices by which a hand's mesh follows its joints. A replay and the live session
/// that records it both use these functions, so they agree bit for bit.
ColliderPose capsules_pose(const std::array<assets::Capsule, assets::kCapsuleCount>&, const assets::Vector& offset_m);
ColliderPose mesh_pose(const assets::Hand&, const assets::JointFrames&, const assets::Vector& offset_m);

/// Motion of a bar or a capsule. The speed rises as sin^2(pi t / 2 ramp_s), then stays constant until `stop_s`. A
/// jump adds its `by_m` to the displacement in the frame that contains its time.
struct Path {
  Vec3 velocity_m_per_s{};
  double ramp_s = 0, start_s = 0;
  std::optional<double> stop_s, release_s;
  struct At {
    double time_s = 0;
    Vec3 by_m{};
  };
  std::vector<At> jumps;

  /// Displacement [m] at `time_s`.
  Vec3 displacement(double time_s) const;
  bool held(double time_s) const { return !release_s || time_s < *release_s; }
};

/// Reads colliders and grips one after another. It also stores the motion and the table of the collider being read.
class ColliderReader {
 public:
  ColliderReader(Scene& scene, const std::string& source, Assets wanted)
      : scene_(scene), source_(source), wanted_(wanted) {}

  /// Begins with the object at this JSON pointer; clears `pose` and `table`.
  void enter(std::string at);
  /// Checks the object against a definition of the schema and fills in its defaults.
  void complete(nlohmann::json&, const std::string& definition) const;
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const;
  /// File and JSON pointer of a key of the object, as messages name them.
  std::string where(const std::string& key) const { return source_ + ": " + at_ + key; }
  /// Reads a vector, which must have length 1.
  Vec3 unit(const nlohmann::json&, const std::string& key) const;
  /// Reads velocity_m_per_s from completed JSON, and ramp_s, start_s, stop_s, release_s, jumps if present. Adds the
  /// jumps to the scene, each with the frame that contains it.
  Path path(const nlohmann::json&) const;
  const assets::AssetSource& assets();
  const std::string& source() const { return source_; }
  /// JSON pointer of the object.
  const std::string& pointer() const { return at_; }

  std::function<ColliderPose(double time_s)> pose;  ///< of a kinematic collider
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

/// A moving hand, with the data needed to sample its motion.
struct MovingHand {
  std::optional<assets::Hand> hand;  ///< empty if a recording needs no hand model
  assets::HandTrack track;
  std::optional<assets::HandRecording> recording;    ///< replaces the track
  assets::Vector offset_m = assets::Vector::Zero();  ///< added to the whole track
};

/// Reads the keys `track` and `speed_m_per_s` of a collider or a grip.
MovingHand moving_hand(const nlohmann::json&, ColliderReader&, bool as_mesh);

/// Reads a hand collider as a mesh or as capsules.
void read_hand(const nlohmann::json&, ColliderReader&, Collider&, bool as_mesh);

/// A horizontal rectangle: centre, directions of its sides (unit vectors), and their lengths.
struct Footprint {
  Vec3 center_m{};
  std::array<Vec3, 2> axes{};
  std::array<double, 2> size_m{};
};

/// Maximum height [m] of the mesh within the rectangle's vertical prism; -infinity if it has no point there.
double highest_below(const ColliderMesh&, const Footprint&);

}  // namespace clothbench
