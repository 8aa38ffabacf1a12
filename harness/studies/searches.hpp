#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runner/solver_choice.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// Arguments that studies have in common in which each result decides the next run.
struct SearchCall {
  std::vector<std::string> solvers;  ///< empty: the study's own choice
  std::vector<std::string> set;      ///< as `--set`
  std::filesystem::path out;         ///< empty: nothing is stored
  bool resume = false;
  DeviceChoice device;
  std::string command_line;        ///< stored with the study
  std::vector<std::string> words;  ///< the same, for the children of plugins; must outlive the call
  std::function<void(const std::string& what, std::size_t done)> progress = [](const auto&, std::size_t) {};
};

/// Runs, in the order in which tables list them. Tables are functions of these (report/).
struct Searched {
  std::vector<RunRecord> runs;
  bool crashed = false;  ///< a plugin's process crashed
};

/// Effective moduli of solvers; with `sweep` also at four times the substeps and iterations. Throws Error for an
/// override of the scene. A GPU solver without a device is left out, with a notice on stderr, if that is allowed.
Searched search_moduli(const SearchCall&, bool sweep);

/// The runs that the closed forms of friction need, also at each number of `substeps`.
Searched search_friction(const SearchCall&, const std::vector<int>& substeps);

/// The least friction at which each of the scenes holds.
Searched search_thresholds(const SearchCall&, const std::vector<std::string>& scenes);

/// Properties that need no truth, on their own scenes. Throws Error for an override of the scene.
Searched search_metamorphic(const SearchCall&);

}  // namespace clothbench
