#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "runner/run_process.hpp"

namespace clothbench {

/// What the stored results of one solver in one map depend on.
struct ProbedBy {
  std::string map, solver, setting;
  std::string scenario_sha256;    ///< of the map's completed scenario
  std::string definition_sha256;  ///< of the changes that the map and its solver make to it, and the solver's settings
  std::string solver_version;     ///< empty if the solver is not known here

  /// Key of one probe; begins with the map, the solver and the setting.
  std::string key(double x, double y, int seed) const;
};

/// The results of a study's maps so far: `stability-probes.jsonl`, one line each. Thread-safe.
class Probes {
 public:
  /// With `resume`, reads the file and keeps it; without, starts the file anew.
  Probes(std::filesystem::path file, bool resume);

  /// Throws Error naming the file and the difference if stored results of this map, solver and setting are of another
  /// scene, definition or version.
  void require_same(const ProbedBy&) const;

  /// Null if this probe has not been run yet. References stay valid: a map's nodes do not move.
  const RunRecord* find(const std::string& key) const;
  const RunRecord& add(const ProbedBy&, const std::string& key, const RunRecord&);

 private:
  struct Known {
    nlohmann::json line;
    RunRecord answer;
  };

  const std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::map<std::string, Known> known_;
  std::uintmax_t whole_B_ = 0;  ///< size of the complete lines; the last line may be incomplete after a kill
};

}  // namespace clothbench
