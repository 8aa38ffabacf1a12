#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/grid.hpp"
#include "report/penetration.hpp"
#include "report/web/template.hpp"

namespace clothbench {

/// A section of the page: the tables that report.md has under the same title.
struct PageSection {
  std::string id, title;
  std::vector<Table> tables;
};

/// Data of the page; the same as the data of the tables and figures of the static report.
struct Page {
  std::string headline;
  std::vector<PageSection> sections;
  nlohmann::json rates, penetration, work;        ///< points of the figures: rates_json, contact_series_json, work_json
  nlohmann::json maps = nlohmann::json::array();  ///< as stability_maps gives them
  nlohmann::json cases = nlohmann::json::array();  ///< as stability_cases gives them
  std::vector<std::string> commands;               ///< command lines that made the results
  std::set<std::string> fronts;                    ///< files of runs on a Pareto front: shown before other settings
};

/// Data of Figs. 4 and 5: one entry per family, with the published values for the paper's Table 3. Missing = null.
nlohmann::json rates_json(const std::vector<Family>&, const nlohmann::json& published);

/// Time series of the runs with contact; six digits, missing = null.
nlohmann::json contact_series_json(const std::vector<ContactSetUp>&);

/// Environments of the runs: one column for each machine, build and protocol.
Table environment_table(const std::vector<RunRecord>& runs);

/// Command lines of the study folders among `runs`, each once.
std::vector<std::string> commands_of(const std::vector<std::filesystem::path>& runs);

/// Greatest size of packed motions and colliders in one page, as base64.
inline constexpr std::size_t kMotionBudget_B = 13'000'000;

/// Motions of the runs, for the viewer. The document has `runs` (scene, solver, strides, index into `blobs`),
/// `colliders` (each once) and `left_out` (as text). `blobs`: base64 of zlib (packed.hpp).
struct Motions {
  nlohmann::json document;
  std::vector<std::string> blobs;
};

/// Reads trajectories from the runs' files and thins them until they fit the budget: first frames, then the grid.
Motions motions_of(const std::vector<RunRecord>& runs, const std::set<std::string>& fronts,
                   std::size_t budget_B = kMotionBudget_B);

/// The document of the page, without blobs.
nlohmann::json page_document(const std::vector<RunRecord>& runs, const Page&, const Motions&);

/// One self-contained HTML page. `html` has the placeholders that bundle.mjs leaves.
std::string page_html(const std::string& html, const nlohmann::json& document, const std::vector<std::string>& blobs);

/// Writes `index.html`. If it cannot be made, removes an older one and returns the reason; otherwise returns "". Throws
/// Error if a file cannot be read or written.
std::string write_page(const std::filesystem::path& out, const std::vector<RunRecord>& runs, const Page&,
                       const PageTemplate&);

}  // namespace clothbench
