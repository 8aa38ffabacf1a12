// Statements of a report about all of its runs: title, facts, warnings, notes.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "base/words.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

bool flag(const RunRecord& c, const char* key) { return environment_of(c, key) == json(true); }

/// The value of a run's environment as the heading shows it.
std::string fact(const RunRecord& c, const std::string& key) {
  const std::string value = environment_text(c, key.c_str());
  if ((key == "gpu" || key == "driver") && environment_text(c, "gpu") == "CPU") return "";
  if (key == "gpu") return value + (flag(c, "gpu_is_software") ? " (software)" : "");
  if (key == "git_commit") return value.substr(0, 12) + (flag(c, "git_dirty") ? " (with local changes)" : "");
  return key == "created" ? value.substr(0, 10) : value;
}

/// A line for each build of a plugin among the runs; two builds differ by the hash.
std::set<std::string> plugin_lines(const std::vector<RunRecord>& runs) {
  std::set<std::string> out;
  for (const RunRecord& c : runs) {
    const json p = environment_of(c, "plugin");
    if (!p.is_object()) continue;
    const auto part = [&](const char* key) { return or_dash(p.value(key, "")); };
    out.insert(fmt::format("{} is a plugin, version {}: {}. Library {}, SHA-256 {}.", c.header.solver,
                           or_dash(environment_text(c, "solver_version")), part("summary"),
                           std::filesystem::path(part("path")).filename().string(), part("sha256").substr(0, 16)));
  }
  return out;
}

}  // namespace

Heading heading_of(const RunTable& table, const std::vector<std::string>& studies) {
  static constexpr std::pair<const char*, const char*> kFacts[] = {
      {"gpu", "GPU"},           {"driver", "driver"},    {"cpu", "CPU"},     {"protocol", "protocol"},
      {"git_commit", "commit"}, {"build_type", "build"}, {"created", "date"}};
  Heading h;
  std::string device;
  for (const auto& [key, name] : kFacts) {
    std::set<std::string> values, short_names;  // "llvmpipe" of "llvmpipe (LLVM 15.0.6, 256 bits)"
    for (const RunRecord& c : table.runs())
      if (const std::string value = fact(c, key); !value.empty()) {
        values.insert(value);
        short_names.insert(value.substr(0, value.find(" (")));
      }
    if (values.empty()) continue;
    if (device.empty()) device = joined(short_names);
    const bool span = std::string(key) == "created" && values.size() > 1;
    h.facts.emplace_back(name, span ? *values.begin() + " to " + *values.rbegin() : joined(values));
  }
  std::set<std::string> trials;
  for (const RunRecord& c : table.runs())
    if (!c.trials.empty()) trials.insert(std::to_string(c.trials.size()));
  h.facts.emplace_back("trials", trials.empty() ? "none timed" : joined(trials));
  h.title = fmt::format("Cloth solvers on {}: {}", device.empty() ? "an unknown machine" : device,
                        studies.empty() ? "runs" : joined(studies));
  return h;
}

std::vector<std::string> warnings_of(const RunTable& table) {
  std::set<std::string> software, invalid;
  std::vector<const Row*> all;
  for (const Row& r : table.rows()) {
    const RunRecord& c = *r.run;
    all.push_back(&r);
    if (environment_text(c, "gpu") != "CPU" && flag(c, "gpu_is_software")) software.insert(environment_text(c, "gpu"));
    if (const json s = environment_of(c, "device_samples"); s.is_object() && !s.value("valid", true))
      for (const json& reason : s.value("reasons", json::array())) invalid.insert(reason.get<std::string>());
  }
  std::vector<std::string> out;
  for (const std::string& device : software)
    out.push_back(
        fmt::format("Software Vulkan device ({}): it shows correctness; its times say nothing of a GPU.", device));
  for (const std::string& reason : invalid) out.push_back(fmt::format("Not a valid measurement: {}.", reason));
  if (const std::string withheld = withheld_note(all); !withheld.empty()) out.push_back(withheld);
  return out;
}

std::vector<std::string> notes_of(const RunTable& table) {
  const std::set<std::string> plugins = plugin_lines(table.runs());
  std::vector<std::string> out(plugins.begin(), plugins.end());
  if (const VerdictCounts n = count_verdicts(table.runs()); n.runs > 0)
    out.push_back(n.text() + ", of those whose scene has acceptance criteria.");
  return out;
}

}  // namespace clothbench
