#include "check/baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string stage_text(const StageRecord& s) {
  return s.serves.empty() ? s.name : s.name + " (" + joined(s.serves) + ")";
}

double number_at(const json& value, const std::string& name, const std::string& where) {
  if (find_gate(name) == nullptr)
    throw Error(fmt::format("{}: not a scalar that is checked{} (the table is in harness/check/README.md)", where,
                            nearest_known(name, gated_names())));
  if (value.is_null()) return kMissing;
  if (!value.is_number())
    throw Error(fmt::format("{}: expected number, or null for not measured; found {}", where, value.dump()));
  return value.get<double>();
}

BaselineRun run_from(const json& j, const std::string& where) {
  BaselineRun c;
  c.key = {j.at("scene"), j.at("solver"), j.at("setting")};
  for (const auto& [what, value] : j.at("conditions").items())
    c.conditions.push_back({kind_of_condition(what), what, value});
  c.status = j.at("status");
  c.klass = j.at("class");
  c.failed_frame = j.at("failed_frame");
  c.stages = j.at("stages");
  for (const auto& [name, value] : j.at("scalars").items())
    c.scalars[name] = number_at(value, name, where + "/scalars/" + name);
  return c;
}

ordered_json json_of(const BaselineRun& c) {
  ordered_json j = {{"scene", c.key.scene}, {"solver", c.key.solver}, {"setting", c.key.setting}};
  std::map<std::string, std::string> conditions;  // in the order in which they are read
  for (const Condition& condition : c.conditions) conditions[condition.what] = condition.value;
  j["conditions"] = conditions;
  j["status"] = c.status;
  j["class"] = c.klass;
  j["failed_frame"] = c.failed_frame;
  j["stages"] = c.stages;
  j["scalars"] = ordered_json::object();
  for (const auto& [name, v] : c.scalars) j["scalars"][name] = std::isfinite(v) ? ordered_json(v) : ordered_json();
  return j;
}

/// The part of a result without the scalars that `has` leaves out.
BaselineRun part_of(const RunRecord& r, bool (*has)(const std::string& name)) {
  BaselineRun c;
  c.key = {r.header.scene, r.header.solver, r.header.setting};
  c.conditions = conditions_of_results(r);
  c.status = r.outcome.status;
  c.klass = r.outcome.klass;
  c.failed_frame = r.outcome.failed_frame;
  for (const StageRecord& s : r.header.stages) c.stages.push_back(stage_text(s));
  for (const auto& [name, v] : r.summary)
    if (has(name) && std::isfinite(v)) c.scalars[name] = v;
  return c;
}

}  // namespace

std::string RunKey::file_name() const { return run_name(scene, solver, setting); }

BaselineRun gated_part(const RunRecord& r) {
  return part_of(r, [](const std::string& name) { return find_gate(name) != nullptr; });
}

BaselineRun whole_part(const RunRecord& r) {
  return part_of(r, [](const std::string& name) { return !is_of_machine(name); });
}

Baseline read_baseline(const std::filesystem::path& file) {
  const std::string source = file.string();
  const json j = parse_json(read_text(file), source);
  validate_json(j, kBaselineSchema, source);
  Baseline b;
  std::set<RunKey> seen;
  for (std::size_t k = 0; k < j.at("runs").size(); ++k) {
    const std::string where = fmt::format("{}: /runs/{}", source, k);
    b.runs.push_back(run_from(j["runs"][k], where));
    if (!seen.insert(b.runs.back().key).second)
      throw Error(where + ": this run occurs twice; expected it once: " + b.runs.back().key.file_name());
  }
  std::sort(b.runs.begin(), b.runs.end(), [](const BaselineRun& x, const BaselineRun& y) { return x.key < y.key; });
  return b;
}

std::string baseline_text(const Baseline& b) {
  ordered_json j = {{"format", "clothbench-baseline"}, {"format_version", 1}};
  j["runs"] = ordered_json::array();
  for (const BaselineRun& c : b.runs) j["runs"].push_back(json_of(c));
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

namespace {

constexpr Gate kVerdict{};  // its tolerance is in the scene

}  // namespace

const Gate* find_gate(const std::string& name) {
  if (is_verdict(name)) return &kVerdict;
  const Scalar* s = find_scalar(name);
  return s == nullptr ? nullptr : s->gate;
}

bool is_verdict(const std::string& name) { return name.starts_with(kExpect); }

std::vector<std::string> gated_names() {
  std::vector<std::string> names = {kExpect + "*"};
  for (const Scalar& s : scalars())
    if (s.gate != nullptr) names.push_back(s.name);
  return names;
}

double slack(const Gate& g, double baseline, double length_m) {
  if (g.zero_stays_zero && baseline == 0) return 0;
  const double unit = g.unit == SlackUnit::Length ? length_m : 1;
  return g.absolute * unit + g.relative * std::fabs(baseline);
}

std::string slack_text(const Gate& g) {
  const char* unit = g.unit == SlackUnit::Length ? " L" : "";
  std::string text;
  if (g.absolute > 0) text = fmt::format("{}{}", g.absolute, unit);
  if (g.relative > 0) text += (text.empty() ? "" : " + ") + fmt::format("{} %", 100 * g.relative);
  if (text.empty()) return "none";
  return text + (g.zero_stays_zero ? "; none at 0" : "");
}

}  // namespace clothbench
