#pragma once
#include <functional>
#include <optional>
#include <string>

#include "assets/assets.hpp"
#include "clothbench/scene.hpp"
#include "scenario/load.hpp"
#include "scenario/path.hpp"

namespace clothbench {

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

}  // namespace clothbench
