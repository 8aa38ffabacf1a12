#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lies.hpp"
#include "metrics/motion_check/motion_check.hpp"

namespace clothbench::liars {

/// Which motions are told lies of. One motion per seed, which alone decides on the kind of scene and the solver, so
/// that many small matrices are the same as a large one.
struct Matrix {
  std::uint64_t seed = 1000;
  int motions = 40;
  std::vector<std::string> kinds;      ///< empty: all
  std::string solver;                  ///< label; empty: all that are right for the scene
  std::string only_lie;                ///< empty: all
  std::filesystem::path motion_cache;  ///< folder of motions that have been computed; empty: none
  std::filesystem::path store;         ///< folder for liar_plugin.c: motions by number, and their scenes; empty: none
};

/// What the check of motions says of one.
struct Trial {
  std::string kind, solver, lie;
  std::uint64_t seed = 0;
  bool right = false, determined = false;
  double difference_m = 0;
  std::vector<motion_check::Finding> findings;
  int number = -1;  ///< of the file in Matrix::store; -1: none, since a solver cannot leave out frames

  bool failed() const;
  const motion_check::Finding& worst() const { return *motion_check::worst(findings); }
};

/// Motions of the matrix that pass, with their lies, and those that are right and fail. `progress`: called after each.
std::vector<Trial> tell_all(const Matrix&, void (*progress)(const std::string&) = nullptr);

/// Caught and told of the lies that positions determine, and passed of the right motions.
struct Totals {
  std::size_t told = 0, caught = 0, undetermined = 0, undetermined_caught = 0, right = 0, passed = 0, noisy = 0,
              noisy_passed = 0;
};
Totals totals(const std::vector<Trial>&);

std::string as_text(const std::vector<Trial>&);
nlohmann::json as_json(const std::vector<Trial>&);

}  // namespace clothbench::liars
