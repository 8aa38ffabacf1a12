#pragma once
#include <functional>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// A solver's response to a change of the scene whose effect is known without a truth.
struct MetamorphicResult {
  std::string property, scene;
  std::string status;    ///< "pass", "fail", "unsupported" or "failed"
  double distance = 0;   ///< greatest over all vertices and frames, relative to the cloth's longer side
  bool bitwise = false;  ///< every bit of every position and velocity is as expected
  double at_most = 0;    ///< bound on the distance; 0 = must be bitwise equal
  Outcome outcome = {};  ///< of the first run that did not end well
};

struct MetamorphicProperty {
  std::string name, doc;
};
/// In the order of tables: similarity-2, similarity, mirror, rotation, renumbering, flip, repeat, no-op, restart.
const std::vector<MetamorphicProperty>& metamorphic_properties();

/// Scenes of the tests: a pinned sheet, the swinging strip, a cloth thrown over a level face, and a two-sided cloth
/// that falls onto an open mesh.
std::vector<Scene> metamorphic_scenes();

/// Runs every property on every scene with default settings except for `settings` (complete). Deterministic: rotations
/// and scales are fixed. Bounds, as shares of L:
///   similarity-2  lengths x2, time x2, mass x4 (so g /2, stiffness x1): bit for bit
///   similarity    lengths x1.7, time x0.6, mass x3.1: 1e-4
///   mirror        x -> -x: 1e-4
///   rotation      the scene with gravity, by two rotations: 1e-4
///   renumbering   flipped along u and v, and transposed: 1e-4, or the change due to twice the substeps, whichever is
///                 greater: the order of solving may affect the result within the solver's own error
///   flip          transposed, the cloth two-sided ("double", or "double-duplicated" if the solver supports only that):
///                 vertices, edges and triangles in the same places, normals reversed; bound as for renumbering. It
///                 also changes the triangles' diagonals and keeps a scene's sides, so it does not test contact from
///                 behind
///   repeat        another solver object, and reset: bit for bit
///   no-op         a ball, a box and a mesh with friction 100 m away: 1e-6
///   restart       another solver object continues from the positions and velocities half way (ClothSolver::restart):
///                 1e-4, or the change due to twice the substeps; "unsupported" if the solver declares that they are
///                 not its whole state
/// `note` is called for each before it runs.
std::vector<MetamorphicResult> run_metamorphic(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                               const std::vector<Scene>& scenes,
                                               const std::function<void(const std::string&)>& note = {});

/// Every property on one scene, each stored as a run of its own without positions (report/metamorphic.hpp), and each in
/// a child for a plugin, whose crash is that run's outcome. A resumed study measures only what is not stored.
std::vector<RunRecord> metamorphic_runs(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                                        const std::string& setting, const Scene&,
                                        const std::function<void(const std::string&)>& note);

}  // namespace clothbench
