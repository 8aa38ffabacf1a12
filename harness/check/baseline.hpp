#pragma once
#include <compare>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// What a run is found by. `assets` tells npm from procedural rooms and hands; empty where the result does not say.
struct RunKey {
  std::string scene, solver, setting, assets;
  // Not <=>: strings have none yet in the libc++ of Android's NDK r25.
  bool operator==(const RunKey&) const = default;
  bool operator<(const RunKey& o) const {
    return std::tie(scene, solver, setting, assets) < std::tie(o.scene, o.solver, o.setting, o.assets);
  }

  std::string file_name() const;  ///< "<scene>__<solver>__<setting>", as the result file is called
  std::string text() const;       ///< the same with the assets in brackets, if known
};

/// What of a run does not depend on the machine.
struct BaselineRun {
  RunKey key;
  std::string scenario_sha256;
  std::string status, klass;
  int failed_frame = -1;
  std::vector<std::string> stages;        ///< "<name> (<feature>, <feature>)" in order
  std::map<std::string, double> scalars;  ///< gated ones alone; NaN or absent = not measured
  std::map<std::string, int> versions;    ///< of the metrics that these are computed from; absent = 1
};

/// How a baseline was made, for the reader of the file; nothing is computed from it.
struct BaselineOrigin {
  std::string command;                        ///< that wrote the baseline
  std::vector<std::string> runs;              ///< that computed the results
  std::vector<std::string> commits, devices;  ///< of the results, sorted
};

struct Baseline {
  BaselineOrigin origin;
  std::vector<BaselineRun> runs;  ///< sorted by key, no key twice
};

/// The part of a result that is gated. A scalar that is not finite counts as not measured and is left out.
BaselineRun gated_part(const RunRecord&);

/// Reads and checks a baseline. Throws Error with file and JSON pointer (line and column where the text is no JSON): a
/// key that is unknown or missing, a scalar that has no gate, a run that stands twice.
Baseline read_baseline(const std::filesystem::path&);

/// The file's text: one line a value, sorted; numbers read back exactly.
std::string baseline_text(const Baseline&);

}  // namespace clothbench
