#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lies.hpp"
#include "metrics/motion_check/motion_check.hpp"

namespace clothbench::liars {

/// Selects the motions to falsify: one per seed. The kind of scene and the solver depend only on the seed, so that
/// a large matrix can be split.
struct Matrix {
  std::uint64_t seed = 1000;
  int motions = 40;
  std::vector<std::string> kinds;  ///< empty: all
  std::string solver;              ///< label; empty: all that are correct for the scene
  std::string only_lie;            ///< empty: all
};

/// Result of the motion check for one motion.
struct Trial {
  std::string kind, solver, lie;
  std::uint64_t seed = 0;
  bool right = false, determined = false;
  double difference_m = 0;
  double solution = 0;  ///< error over the bound of the scene's exact solution; NaN if there is none
  std::vector<motion_check::Finding> findings;

  const motion_check::Finding& worst() const { return *motion_check::worst(findings); }
  /// Applies the rule for runs, without the bounds in the scene's file.
  bool failed() const { return !(worst().ratio <= 1) || solution > 1; }
};

/// Trials of the matrix: each correct motion, and its lies if the correct motion passes.
std::vector<Trial> tell_all(const Matrix&);

/// A line of a result file: a trial without its motion.
nlohmann::json as_json(const Trial&);

}  // namespace clothbench::liars
