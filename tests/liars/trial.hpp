#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lies.hpp"
#include "metrics/motion_check/motion_check.hpp"

namespace clothbench::liars {

/// Which motions are told lies of. One motion per seed; only the seed decides on the kind of scene and the solver, so a
/// large matrix can be split into small ones.
struct Matrix {
  std::uint64_t seed = 1000;
  int motions = 40;
  std::vector<std::string> kinds;  ///< empty: all
  std::string solver;              ///< label; empty: all that are right for the scene
  std::string only_lie;            ///< empty: all
};

/// Result of the motion check for one motion.
struct Trial {
  std::string kind, solver, lie;
  std::uint64_t seed = 0;
  bool right = false, determined = false;
  double difference_m = 0;
  double solution = 0;  ///< error against the scene's exact solution over its bound; NaN if there is none
  std::vector<motion_check::Finding> findings;

  const motion_check::Finding& worst() const { return *motion_check::worst(findings); }
  /// As a run fails, without any bound that a scene states.
  bool failed() const { return !(worst().ratio <= 1) || solution > 1; }
};

/// Motions of the matrix that pass, with their lies, and those that are right and fail.
std::vector<Trial> tell_all(const Matrix&);

/// A line of a result file: a trial without its motion.
nlohmann::json as_json(const Trial&);

}  // namespace clothbench::liars
