#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/words.hpp"
#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

constexpr const char* kNotStated = "–";
constexpr const char* kAssets = "rooms and hands";

std::string shown_value(const nlohmann::json& value) {
  if (value.is_null() || value == "") return kNotStated;
  return value.is_string() ? value.get<std::string>() : dump(value);
}

std::string trial_frames(const RunRecord& r) {
  std::set<int> frames;
  for (const TimedTrial& t : r.trials) frames.insert(t.frames());
  return joined(frames, ", ", [](int n) { return std::to_string(n); });
}

using nlohmann::json;
using nlohmann::ordered_json;

std::string stage_text(const StageRecord& s) {
  return s.serves.empty() ? s.name : s.name + " (" + joined(s.serves) + ")";
}

double number_at(const json& value, const std::string& name, const std::string& where) {
  if (find_gate(name) == nullptr)
    throw Error(fmt::format("{}: no regression rule for this scalar{} (see the table in harness/check/README.md)",
                            where, nearest_known(name, gated_names())));
  if (value.is_null()) return kMissing;
  if (!value.is_number())
    throw Error(fmt::format("{}: expected a number, or null for not measured; found {}", where, dump(value)));
  return value.get<double>();
}

/// The kind of a condition, as used by --allow ("GPU": "device").
std::string kind_of_condition(const std::string& what) {
  return what == "GPU"                                ? "device"
         : what == "precision"                        ? "precision"
         : what == "scene SHA-256" || what == kAssets ? "scene"
                                                      : "length";
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
  std::map<std::string, std::string> conditions;  // in the order of reading
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

/// Conditions on which results depend: all except the machine, the driver, the device profile and the trials.
std::vector<Condition> conditions_of_results(const RunRecord& r) {
  std::vector<Condition> out = conditions_of(r);
  std::erase_if(out, [](const Condition& c) {
    return c.kind == "machine" || c.kind == "trials" || (c.kind == "device" && c.what != "GPU");
  });
  return out;
}

/// The part of a result with only those scalars for which `has` is true.
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

constexpr Gate kVerdict{};  // the scene's bound includes the tolerance

}  // namespace

const std::vector<std::string>& condition_kinds() {
  static const std::vector<std::string> kinds = {"scene",  "machine", "device", "precision",
                                                 "length", "trials",  "order"};
  return kinds;
}

std::vector<Condition> conditions_of(const RunRecord& r) {
  const nlohmann::json& e = r.header.environment;
  const auto environment = [&](const char* key) {
    return e.is_object() ? shown_value(e.value(key, nlohmann::json())) : std::string(kNotStated);
  };
  std::vector<Condition> out = {
      {"scene", "scene SHA-256", shown_value(r.header.scenario_sha256)},
      {"machine", "CPU", environment("cpu")},
      {"machine", "CPU threads", environment("cpu_threads")},
      {"device", "GPU", environment("gpu")},
      {"device", "driver", environment("driver")},
      {"device", "device profile", environment("device_profile")},
      {"precision", "precision", environment("precision")},
  };
  // Procedural rooms and hands differ from the scanned ones: a run without the scans must not count as a run with them.
  const nlohmann::json scene = json_or_discarded(r.header.scenario_json);
  if (scene.is_object() && scene.contains("assets"))
    out.insert(out.begin() + 1, {"scene", kAssets, shown_value(scene["assets"])});
  if (r.outcome.status == "ok") {
    const std::vector<double>& time = r.accuracy.time_s;
    out.push_back({"length", "frames", std::to_string(time.empty() ? 0 : time.size() - 1)});
    out.push_back({"length", "simulated time [s]", time.empty() ? kNotStated : fmt::format("{:.6g}", time.back())});
    if (!r.trials.empty()) out.push_back({"trials", "frames of a trial", trial_frames(r)});
    const double window_s = e.is_object() ? e.value("window_s", 0.0) : 0;
    if (!r.trials.empty()) out.push_back({"trials", "window [s], 0: none", fmt::format("{:g}", window_s)});
  }
  return out;
}

std::vector<ConditionDifference> differences(const std::vector<Condition>& a, const std::vector<Condition>& b) {
  std::vector<ConditionDifference> out;
  for (const Condition& p : a)
    for (const Condition& q : b)
      if (p.what == q.what && p.value != q.value) out.push_back({p.kind, p.what, p.value, q.value});
  return out;
}

std::string scene_difference(const RunRecord& a, const RunRecord& b) {
  constexpr std::size_t kShown = 4;
  const nlohmann::json p = json_or_discarded(a.header.scenario_json), q = json_or_discarded(b.header.scenario_json);
  if (!p.is_object() || !q.is_object()) return "";
  const nlohmann::json left = p.flatten(), right = q.flatten();
  std::set<std::string> keys;
  for (const auto* side : {&left, &right})
    for (const auto& [key, unused] : side->items()) keys.insert(key);
  std::vector<std::string> found;
  const auto at = [](const nlohmann::json& side, const std::string& key) {
    return side.contains(key) ? dump(side[key]) : std::string(kNotStated);
  };
  for (const std::string& key : keys)
    if (at(left, key) != at(right, key)) found.push_back(key + ": " + at(left, key) + ", " + at(right, key));
  const std::size_t all = found.size();
  found.resize(std::min(all, kShown));
  return joined(found, "; ") + (all > kShown ? fmt::format("; {} more", all - kShown) : "");
}

void DifferingRuns::add(const std::string& run, const ConditionDifference& d) {
  auto at = std::find_if(all_.begin(), all_.end(), [&](const Entry& other) { return other.difference == d; });
  if (at == all_.end()) at = all_.insert(at, {d, {}});
  if (!contains(at->runs, run)) at->runs.push_back(run);
}

std::string DifferingRuns::line(const Entry& e) const {
  const ConditionDifference& d = e.difference;
  return fmt::format("{}: {}: {} and {} ({}{})", d.kind, d.what, d.a, d.b, e.runs.front(),
                     e.runs.size() > 1 ? fmt::format(" and {} more", e.runs.size() - 1) : "");
}

void DifferingRuns::refuse(const std::string& a, const std::string& b) const {
  std::string lines;
  std::vector<std::string> kinds;
  for (const Entry& e : all_) {
    if (contains(allowed_, e.difference.kind)) continue;
    lines += "\n  " + line(e);
    if (!contains(kinds, e.difference.kind)) kinds.push_back(e.difference.kind);
  }
  if (lines.empty()) return;
  throw Error(fmt::format("{} and {} were not compared, because their conditions differ:{}\nRepeat one of them under "
                          "the conditions of the other, or use `--allow {}` to compare them anyway and mark the output",
                          a, b, lines, joined(kinds, ",")),
              ExitCode::BadInput);
}

std::string DifferingRuns::marks(const std::string& what) const {
  std::string out;
  for (const Entry& e : all_) out += fmt::format("{}: {}\n", what, line(e));
  return out;
}

nlohmann::json DifferingRuns::json() const {
  nlohmann::json out = nlohmann::json::array();
  for (const Entry& e : all_)
    out.push_back({{"kind", e.difference.kind},
                   {"what", e.difference.what},
                   {"a", e.difference.a},
                   {"b", e.difference.b},
                   {"runs", e.runs}});
  return out;
}

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
