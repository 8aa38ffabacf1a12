#include "check/print.hpp"

#include <fmt/format.h>

#include "base/table.hpp"
#include "base/tint.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// Table and messages of `cells`, worst verdict first; empty if there is no finding. `worse`: what a failure is called.
std::string findings_text(const std::string& title, const std::vector<CheckedCell>& cells, const char* worse) {
  Table table{title, "", {{"cell", "quantity", "verdict", "baseline", "found", "allowed"}}};
  std::string messages;
  for (const Verdict verdict : {Verdict::Failed, Verdict::Improved, Verdict::New})
    for (const CheckedCell& cell : cells)
      for (const Finding& f : cell.findings) {
        if (f.verdict != verdict) continue;
        table.rows.push_back({cell.key.text(), f.quantity, f.verdict == Verdict::Failed ? worse : word_for(f.verdict),
                              f.baseline, f.found, f.allowed});
        if (!f.message.empty() && verdict != Verdict::New)
          messages += wrapped(fmt::format("{}: {}: {}", cell.key.text(), f.quantity, f.message), 2, kConsoleColumns);
      }
  return table.rows.size() == 1 ? "" : table.console() + messages + "\n";
}

json key_json(const CellKey& key) {
  json j = {{"scene", key.scene}, {"solver", key.solver}, {"setting", key.setting}};
  if (!key.assets.empty()) j["assets"] = key.assets;
  return j;
}

json cell_json(const CheckedCell& cell) {
  json j = key_json(cell.key);
  j["verdict"] = word_for(cell.verdict());
  j["findings"] = json::array();
  for (const Finding& f : cell.findings)
    j["findings"].push_back({{"verdict", word_for(f.verdict)},
                             {"quantity", f.quantity},
                             {"baseline", f.baseline},
                             {"found", f.found},
                             {"allowed", f.allowed},
                             {"message", f.message}});
  return j;
}

std::string cells_word(std::size_t n) { return fmt::format("{} cell{}", n, n == 1 ? "" : "s"); }

}  // namespace

std::string check_text(const Checked& checked, const std::string& file) {
  std::string out = findings_text("Not as in " + file, checked.cells, word_for(Verdict::Failed));
  out += fmt::format("check {}: {}: {} failed, {} improved, {} new, {} as in {}",
                     checked.passed() ? tinted(Tone::Good, "passed") : tinted(Tone::Bad, "FAILED"),
                     cells_word(checked.cells.size()), checked.count(Verdict::Failed), checked.count(Verdict::Improved),
                     checked.count(Verdict::New), checked.count(Verdict::Same), file);
  if (checked.other_assets > 0)
    out += fmt::format("; {} more of the baseline stand for other assets", cells_word(checked.other_assets));
  if (checked.passed() && checked.count(Verdict::Improved) > 0) out += "; accept what improved with --update";
  return out + "\n";
}

json check_json(const Checked& checked, const std::string& file) {
  json j = {{"baseline", file},
            {"passed", checked.passed()},
            {"failed", checked.count(Verdict::Failed)},
            {"improved", checked.count(Verdict::Improved)},
            {"new", checked.count(Verdict::New)},
            {"same", checked.count(Verdict::Same)},
            {"other_assets", checked.other_assets},
            {"cells", json::array()}};
  for (const CheckedCell& cell : checked.cells) j["cells"].push_back(cell_json(cell));
  return j;
}

std::string update_text(const Updated& u, const std::string& file) {
  std::string out = findings_text("Changed in " + file, u.changes, "changed");
  for (const CellKey& key : u.removed) out += "  removed, no result: " + key.text() + "\n";
  return out + fmt::format("{}: {}: {} changed or new, {} removed, {} with other values within slack\n", file,
                           cells_word(u.baseline.cells.size()), u.changes.size(), u.removed.size(), u.within_slack);
}

json update_json(const Updated& u, const std::string& file) {
  json j = {{"baseline", file},
            {"cells", u.baseline.cells.size()},
            {"within_slack", u.within_slack},
            {"changes", json::array()},
            {"removed", json::array()}};
  for (const CheckedCell& cell : u.changes) j["changes"].push_back(cell_json(cell));
  for (const CellKey& key : u.removed) j["removed"].push_back(key_json(key));
  return j;
}

}  // namespace clothbench
