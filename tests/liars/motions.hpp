#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::liars {

/// A motion as a file stores it, with the scene and the solver that it belongs to.
struct Motion {
  std::shared_ptr<const Scene> scene;
  std::string solver;  ///< name and quality: "xpbd accurate"
  std::vector<double> time_s;
  std::vector<float> position;            ///< [m] (frames, vertices, 3)
  std::vector<double> contact_offsets_m;  ///< as the solver states them

  std::size_t vertices() const { return scene->cloth.vertex_count(); }
  std::size_t frames() const { return time_s.size(); }
  Vec3 at(std::size_t frame, std::size_t vertex) const;
  void put(std::size_t frame, std::size_t vertex, const Vec3& x);
};

/// Kinds of scenes: the kinds of the studies `contact` and `physics`, scenes of the paper, and thin bodies on which a
/// cloth falls. Grids have 12 to 20 vertices per side if the kind allows. Frame rates are 60 to 144 Hz or the study's.
const std::vector<std::string>& scene_kinds();
/// Equal kind and seed give an equal scene.
Scene draw_scene(const std::string& kind, std::uint64_t seed);

/// A solver with settings that are known to give a correct motion for a kind of scene.
struct RightSolver {
  std::string name, settings_json;
  std::string label() const;
};
/// Solvers that give a correct motion of the scene. `only`: label of the one solver to use, correct or not.
std::vector<RightSolver> right_solvers(const Scene&, const std::string& only);

/// The motion by a solver; none if a step fails. `changed`: scene that the solver gets instead.
std::optional<Motion> run(const std::shared_ptr<const Scene>&, const RightSolver&,
                          const std::function<void(Scene&)>& changed = nullptr);

}  // namespace clothbench::liars
