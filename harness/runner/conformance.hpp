#pragma once
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "runner/worker.hpp"

namespace clothbench {

/// Checks of every solver, whatever its method: six frames of each scene with every kind of sides on three grids and
/// on a triangle mesh, each scene whole at its own size, and relations of two runs that need no exact solution.
struct ConformanceCase {
  std::string scene;    ///< as commands name it: "paper/gravity"
  std::string sides;    ///< "single", "double-duplicated", "double"; empty: as the scene has it
  std::string grid;     ///< "[9,7]"; empty: as the scene has it
  std::string profile;  ///< a class of devices (DeviceOptions::profile), or empty
  bool whole = false;   ///< all frames of the scene instead of six
  bool mesh = false;    ///< the grid's cloth as a triangle mesh (as_mesh)
  /// How this run of the whole scene relates to the scene as it is. The maximum distance of a vertex in any frame from
  /// where it must be, divided by the longer side, is at most:
  ///   "repeat"    another solver object, and reset: bit for bit; 1e-6 for the averaged Jacobi of `paper`, whose atomic
  ///               additions have no fixed order
  ///   "restart"   another solver object continues from the positions and velocities half way: 1e-4, or the change due
  ///               to frames half as long, whichever is larger
  ///   "mirror"    x -> -x: 1e-4
  ///   "renumber"  numbered along the other side first: as for restart, because the order of solving may change the
  ///               result within the solver's own error
  ///   "no-op"     a sphere and a box with friction 100 m away: 1e-6
  std::string relation = {};
};

/// Cases of one scene; `profiles` adds those that emulate small devices, for solvers on a GPU. Relations, which only
/// scenes of the folder "conformance" have, come before the whole scene.
std::vector<ConformanceCase> conformance_cases(const std::string& scene, bool profiles);

/// The scene of a case. Two or three grid lines are too few for some scenes, which then get the smallest grid that
/// works. A mesh bends for the solvers that have bending of meshes.
Scene conformance_scene(const ConformanceCase&, const std::string& solver);

/// Why a case is no test of the solver, such as "xpbd has no render"; empty if it is.
std::string conformance_skip(const SolverInfo&, const Scene&);

struct ConformanceResult {
  std::string unsupported;          ///< the solver's own reason for not running the scene (UnsupportedScene)
  int frames = 0;                   ///< computed
  std::vector<std::string> faults;  ///< empty: the solver did what it must
};

/// Runs a case and lists what is wrong: stages that do not serve what the scene needs; a start elsewhere than the
/// scene's (1e-6 of the width); a frame that fails or is not finite; pins that moved (1e-6 of the width); grips farther
/// than 1 mm from where they are held; costs without a stage; device times from a CPU solver, or none from a GPU
/// solver; a reset that does not restore the start bit for bit; messages of a validation layer. A whole scene ends
/// after `limit_s` of wall time (0: never), with what was found until then. A case with a relation checks nothing else.
ConformanceResult run_conformance(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                  const Scene&, const ConformanceCase&, double limit_s = 0);

/// Relations that a scene is made for, what each changes in the scene, and its check (relations.cpp).
std::vector<std::string> relations_of(const std::string& scene);
std::vector<std::string> relation_overrides(const std::string& relation);
ConformanceResult run_relation(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                               const Scene& related, const ConformanceCase&);

/// One row of the command's answer, all cases of a scene: scene, status ("pass", "FAIL", or "skipped" if no case is one
/// for the solver), cases, skipped, frames_whole, frames_of_scene, and faults with the case before each; of a skipped
/// row the reason. A crash is a fault.
nlohmann::json ask_conformance(Worker&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                               const std::string& scene, bool whole, double limit_s);
/// The worker's side.
nlohmann::json conformance_answer(const nlohmann::json& request);
/// A row for the terminal.
std::string conformance_text(const std::string& solver, const nlohmann::json& row);

/// The chosen scenes, or if `chosen` is empty all scenes that are tested. Throws Error if a chosen scene is not tested.
std::vector<std::string> conformance_scenes(const std::vector<std::string>& chosen);

}  // namespace clothbench
