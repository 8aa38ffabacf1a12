#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "runner/again.hpp"

namespace clothbench {

/// A solver's behaviour under a change of scene whose effect is known without any truth.
struct MetamorphicResult {
  std::string property, scene;
  std::string status;    ///< "pass", "fail", "unsupported", or how a run failed
  double distance = 0;   ///< greatest of all vertices and frames, over the cloth's longer side
  bool bitwise = false;  ///< every bit of every position and velocity is as expected
  double at_most = 0;    ///< bound on the distance; 0 = bitwise wanted
};

struct MetamorphicProperty {
  std::string name, doc;
};
/// In the order of tables: similarity-2, similarity, mirror, rotation, renumbering, flip, repeat, no-op, restart.
const std::vector<MetamorphicProperty>& metamorphic_properties();

/// Scenes of the tests: a pinned sheet, the swinging strip, a cloth that is thrown over a level face, a two-sided one
/// that comes down on an open mesh.
std::vector<Scene> metamorphic_scenes();

/// Runs every property on every scene with default settings but for `settings` (complete). Deterministic: its rotations
/// and scales are fixed. Bounds, as shares of L:
///   similarity-2  lengths x2, time x2, mass x4 (so g /2, stiffness x1): bit for bit
///   similarity    lengths x1.7, time x0.6, mass x3.1: 1e-4
///   mirror        x -> -x: 1e-4
///   rotation      the scene with gravity, by two rotations: 1e-4
///   renumbering   flipped along u and v, and transposed: 1e-4, or what twice the substeps change, whichever is more:
///   an order of
///                 solving is the solver's own affair within its own error
///   flip          transposed, the cloth two-sided ("double", or "double-duplicated" where the solver knows that
///   alone): vertices, edges
///                 and triangles in the same places, normals the other way; bound as for renumbering, which also
///                 changes the triangles' diagonals and leaves a scene's sides as they are, and so says nothing of
///                 contact from behind
///   repeat        another solver object, and reset: bit for bit
///   no-op         a ball, a box and a mesh with friction 100 m away: 1e-6
///   restart       another solver object goes on from the positions and velocities half way (ClothSolver::restart):
///   1e-4, or what
///                 twice the substeps change; "unsupported" where the solver says that they do not tell all
/// `note` is called for each before it runs.
std::vector<MetamorphicResult> run_metamorphic(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                               const std::vector<Scene>& scenes,
                                               const std::function<void(const std::string&)>& note = {});

/// As `clothbench metamorphic --json` tells it.
nlohmann::json metamorphic_json(const std::string& solver, const MetamorphicResult&);

/// Every property on one scene, a plugin's in a child; "crashed" for all of them where it brings that down at one.
std::vector<MetamorphicResult> ask_metamorphic(Guard&, const SolverEntry&, const nlohmann::json& settings,
                                               const DeviceOptions&, const Scene&,
                                               const std::function<void(const std::string&)>& note);

}  // namespace clothbench
