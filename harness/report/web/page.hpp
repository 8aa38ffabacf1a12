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

/// A part of the page: the tables that report.md has under the same title.
struct PageSection {
  std::string id, title;
  std::vector<Table> tables;
};

/// What the page is made of. Everything here is what the tables and figures of the static report are made of.
struct Page {
  std::string headline;
  std::vector<PageSection> sections;
  nlohmann::json rates, penetration, work;        ///< points of the figures: rates_json, contact_series_json, work_json
  nlohmann::json maps = nlohmann::json::array();  ///< as stability_maps gives them
  nlohmann::json cases = nlohmann::json::array();  ///< as stability_cases gives them
  std::vector<std::string> commands;               ///< that made the results
  std::set<std::string> fronts;                    ///< files of runs on a front: shown before other settings
};

/// Figs. 4 and 5: one family each, with the published values where it is the paper's Table 3. Missing = null.
nlohmann::json rates_json(const std::vector<Family>&, const nlohmann::json& published);

/// Series over time of the runs with contact; six digits, missing = null.
nlohmann::json contact_series_json(const std::vector<ContactSetUp>&);

/// Where the runs ran: one column for each machine, build and protocol.
Table environment_table(const std::vector<RunRecord>& runs);

/// Command lines of the study folders among `runs`, each once.
std::vector<std::string> commands_of(const std::vector<std::filesystem::path>& runs);

/// Bytes of packed motion and colliders, in base64, that one page holds.
inline constexpr std::size_t kMotionBudget_B = 13'000'000;

/// Motions of the runs, for the viewer. `runs`: scene, solver, how thinned, index into `blobs`; `colliders`: each
/// once; `left_out`: in words. `blobs`: base64 of zlib (packed.hpp).
struct Motions {
  nlohmann::json document;
  std::vector<std::string> blobs;
};

/// Reads trajectories from the runs' files, thinned until they fit the budget: frames first, then the grid.
Motions motions_of(const std::vector<RunRecord>& runs, const std::set<std::string>& fronts,
                   std::size_t budget_B = kMotionBudget_B);

/// The document of the page, without blobs.
nlohmann::json page_document(const std::vector<RunRecord>& runs, const Page&, const Motions&);

/// One HTML page that needs nothing else. `html` has the marks that bundle.mjs leaves.
std::string page_html(const std::string& html, const nlohmann::json& document, const std::vector<std::string>& blobs);

/// Writes `index.html`; an older one is removed where none can be made. Returns why there is none, or nothing. Throws
/// Error if a file cannot be read or written.
std::string write_page(const std::filesystem::path& out, const std::vector<RunRecord>& runs, const Page&,
                       const PageTemplate&);

}  // namespace clothbench
