#include "check/print.hpp"

#include <fmt/format.h>

#include "base/columns.hpp"
#include "base/tint.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// Table and messages of `runs`, worst verdict first; empty if there is no finding. `worse`: what a failure is called.
std::string findings_text(const std::string& title, const std::vector<CheckedRun>& runs, const char* worse) {
  struct Row {
    std::string run;
    const Finding* finding;
  };
  std::vector<Row> rows;
  std::string messages;
  for (const Verdict verdict : {Verdict::Failed, Verdict::Improved, Verdict::New})
    for (const CheckedRun& run : runs)
      for (const Finding& f : run.findings) {
        if (f.verdict != verdict) continue;
        rows.push_back({run.key.text(), &f});
        if (!f.message.empty() && verdict != Verdict::New)
          messages += wrapped(fmt::format("{}: {}: {}", run.key.text(), f.quantity, f.message), 2, kConsoleColumns);
      }
  if (rows.empty()) return "";
  const Columns<Row> columns = {
      {"", "run", &Row::run},
      {"", "quantity", [](auto& r) { return r.finding->quantity; }},
      {"", "verdict",
       [=](auto& r) { return r.finding->verdict == Verdict::Failed ? worse : word_for(r.finding->verdict); }},
      {"", "baseline", [](auto& r) { return r.finding->baseline; }},
      {"", "found", [](auto& r) { return r.finding->found; }},
      {"", "allowed", [](auto& r) { return r.finding->allowed; }}};
  return columns.table({title, "", {}}, rows).console() + messages + "\n";
}

json key_json(const RunKey& key) {
  json j = {{"scene", key.scene}, {"solver", key.solver}, {"setting", key.setting}};
  if (!key.assets.empty()) j["assets"] = key.assets;
  return j;
}

json run_json(const CheckedRun& run) {
  json j = key_json(run.key);
  j["verdict"] = word_for(run.verdict());
  j["findings"] = json::array();
  for (const Finding& f : run.findings)
    j["findings"].push_back({{"verdict", word_for(f.verdict)},
                             {"quantity", f.quantity},
                             {"baseline", f.baseline},
                             {"found", f.found},
                             {"allowed", f.allowed},
                             {"message", f.message}});
  return j;
}

std::string runs_word(std::size_t n) { return fmt::format("{} run{}", n, n == 1 ? "" : "s"); }

}  // namespace

std::string check_text(const Checked& checked, const std::string& file) {
  std::string out = checked.differing.marks();
  out += findings_text("Different from " + file, checked.runs, word_for(Verdict::Failed));
  out += fmt::format("check {}: {}: {} failed, {} improved, {} new, {} as in {}",
                     checked.passed() ? tinted(Tone::Good, "passed") : tinted(Tone::Bad, "FAILED"),
                     runs_word(checked.runs.size()), checked.count(Verdict::Failed), checked.count(Verdict::Improved),
                     checked.count(Verdict::New), checked.count(Verdict::Same), file);
  if (checked.other_assets > 0)
    out += fmt::format("; {} more in the baseline are for other assets", runs_word(checked.other_assets));
  if (checked.passed() && checked.count(Verdict::Improved) > 0) out += "; --update accepts the improved ones";
  return out + "\n";
}

json check_json(const Checked& checked, const std::string& file) {
  json j = {{"baseline", file},
            {"passed", checked.passed()},
            {"overridden", checked.differing.json()},
            {"failed", checked.count(Verdict::Failed)},
            {"improved", checked.count(Verdict::Improved)},
            {"new", checked.count(Verdict::New)},
            {"same", checked.count(Verdict::Same)},
            {"other_assets", checked.other_assets},
            {"runs", json::array()}};
  for (const CheckedRun& run : checked.runs) j["runs"].push_back(run_json(run));
  return j;
}

std::string update_text(const Updated& u, const std::string& file) {
  std::string out = findings_text("Changed in " + file, u.changes, "changed");
  for (const RunKey& key : u.removed) out += "  removed, no result: " + key.text() + "\n";
  return out + fmt::format("{}: {}: {} changed or new, {} removed, {} with other values within slack\n", file,
                           runs_word(u.baseline.runs.size()), u.changes.size(), u.removed.size(), u.within_slack);
}

json update_json(const Updated& u, const std::string& file) {
  json j = {{"baseline", file},
            {"runs", u.baseline.runs.size()},
            {"within_slack", u.within_slack},
            {"changes", json::array()},
            {"removed", json::array()}};
  for (const CheckedRun& run : u.changes) j["changes"].push_back(run_json(run));
  for (const RunKey& key : u.removed) j["removed"].push_back(key_json(key));
  return j;
}

}  // namespace clothbench
