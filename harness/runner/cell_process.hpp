#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// One cell to be run in a process of its own: a scene from beginning to end, untimed. Everything as it goes into the
/// file that the process is handed.
struct CellRequest {
  nlohmann::json scenario;       ///< as in its file, not completed
  std::string source;            ///< that file
  std::vector<std::string> set;  ///< overrides of the scene, `dotted.key=JSON`
  std::string name;              ///< of the scene in this form
  std::string solver, setting;
  nlohmann::json settings = nlohmann::json::object();
  DeviceOptions device = {};
  std::string protocol;
  double limit_s = 0;         ///< of wall time
  std::filesystem::path out;  ///< folder for the result file; empty: nothing but the answer is kept
};

/// What it comes to. `status` beside those of Outcome: `crashed`, with the signal or exit status as message.
struct CellAnswer {
  Outcome outcome;
  std::map<std::string, double> summary;
  double wall_s = kMissing;
};

nlohmann::json to_json(const CellRequest&);
CellRequest request_from_json(const nlohmann::json&);
nlohmann::json to_json(const CellAnswer&);
CellAnswer answer_from_json(const nlohmann::json&);

using SolverLookup = std::function<const SolverEntry&(const std::string&)>;

/// Runs the cell here: the other side of `run_in_process`.
CellAnswer run_request(const CellRequest&, const SolverLookup&);

/// What a program does that is run as `PROGRAM run-cell REQUEST.json ANSWER.json`: reads the one, writes the other.
int run_cell_main(const std::filesystem::path& request, const std::filesystem::path& answer, const SolverLookup&);

/// Runs the cell in a child process, `program run-cell …`, killed 5 s (and a fifth) after the cell's own limit. A child
/// that crashes, hangs or ends without an answer makes the outcome `crashed` or `timed_out` with class F8 and its last
/// words; where results are kept such a cell gets a result file too. `scratch` is a folder for what passes between the
/// two.
CellAnswer run_in_process(const CellRequest&, const std::filesystem::path& program,
                          const std::filesystem::path& scratch);

}  // namespace clothbench
