#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "runner/run_process.hpp"

namespace clothbench {

/// What the answers of one solver in one map are answers to.
struct ProbedBy {
  std::string map, solver, setting;
  std::string scenario_sha256;    ///< of the map's completed scenario
  std::string definition_sha256;  ///< of what the map and its solver change in it, and the solver's settings
  std::string solver_version;     ///< empty where the solver is not known here

  /// Of one probe; begins with the map, the solver and the setting.
  std::string key(double x, double y, int seed) const;
};

/// The answers of a study's maps so far: `stability-probes.jsonl`, a line each. For several threads.
class Probes {
 public:
  /// With `resume` reads what is there and leaves it; without, the file begins anew.
  Probes(std::filesystem::path file, bool resume);

  /// Throws Error naming the file and what differs if stored answers of this map, solver and setting are of another
  /// scene, definition or version.
  void require_same(const ProbedBy&) const;

  /// Null if it has not been asked yet. References stay: a map's nodes do not move.
  const RunAnswer* find(const std::string& key) const;
  const RunAnswer& add(const ProbedBy&, const std::string& key, const RunAnswer&);

 private:
  struct Known {
    nlohmann::json line;
    RunAnswer answer;
  };

  const std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::map<std::string, Known> known_;
  std::uintmax_t whole_B_ = 0;  ///< of the lines that end as lines do: a kill may have torn the last
};

}  // namespace clothbench
