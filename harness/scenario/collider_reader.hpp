#pragma once
#include <functional>
#include <optional>
#include <string>

#include "assets/assets.hpp"
#include "clothbench/scene.hpp"
#include "scenario/load.hpp"
#include "scenario/path.hpp"

namespace clothbench {

/// What colliders and grips are read with, one after another, and what a collider leaves beside itself.
class ColliderReader {
 public:
  ColliderReader(Scene& scene, const std::string& source, Assets wanted)
      : scene_(scene), source_(source), wanted_(wanted) {}

  /// Goes on to what is at this JSON pointer.
  void enter(std::string at);
  /// Checks it against a definition of the schema and fills in its defaults.
  void complete(nlohmann::json&, const std::string& definition) const;
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const;
  /// A vector that must be of length 1.
  Vec3 unit(const nlohmann::json&, const std::string& key) const;
  /// A path whose jumps are the scene's.
  Path path(const nlohmann::json&) const;
  const assets::AssetSource& assets();
  const std::string& source() const { return source_; }

  std::function<ColliderPose(double time_s)> pose;  ///< of what moves
  struct RoundTable {
    assets::Table table;
    ColliderMesh mesh;
  };
  std::optional<RoundTable> table;  ///< that a cloth can be put over, with the mesh round it

 private:
  Scene& scene_;
  const std::string& source_;
  Assets wanted_;
  std::string at_;
  std::optional<assets::AssetSource> assets_;
};

}  // namespace clothbench
