#include "results/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

constexpr const char* kNotStated = "–";
constexpr const char* kAssets = "rooms and hands";

std::string shown_value(const nlohmann::json& value) {
  if (value.is_null() || value == "") return kNotStated;
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string trial_frames(const RunRecord& r) {
  std::set<int> frames;
  for (const TimedTrial& t : r.trials) frames.insert(t.frames());
  return joined(frames, ", ", [](int n) { return std::to_string(n); });
}

}  // namespace

const std::vector<std::string>& condition_kinds() {
  static const std::vector<std::string> kinds = {"scene",  "machine", "device", "precision",
                                                 "length", "trials",  "order"};
  return kinds;
}

std::string kind_of_condition(const std::string& what) {
  return what == "GPU"                                ? "device"
         : what == "precision"                        ? "precision"
         : what == "scene SHA-256" || what == kAssets ? "scene"
                                                      : "length";
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
  // Procedural rooms and hands are other scenes than scanned ones: a run without the scans must not pass for them.
  const nlohmann::json scene = nlohmann::json::parse(r.header.scenario_json, nullptr, false);
  if (scene.is_object() && scene.contains("assets"))
    out.insert(out.begin() + 1, {"scene", kAssets, shown_value(scene["assets"])});
  if (r.outcome.status == "ok") {
    const std::vector<double>& time = r.accuracy.time_s;
    out.push_back({"length", "frames", std::to_string(time.empty() ? 0 : time.size() - 1)});
    out.push_back({"length", "simulated time [s]", time.empty() ? kNotStated : fmt::format("{:.6g}", time.back())});
    if (!r.trials.empty()) out.push_back({"trials", "frames of a trial", trial_frames(r)});
  }
  return out;
}

std::vector<Condition> conditions_of_results(const RunRecord& r) {
  std::vector<Condition> out = conditions_of(r);
  std::erase_if(out, [](const Condition& c) {
    return c.kind == "machine" || c.kind == "trials" || (c.kind == "device" && c.what != "GPU");
  });
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
  const nlohmann::json p = nlohmann::json::parse(a.header.scenario_json, nullptr, false),
                       q = nlohmann::json::parse(b.header.scenario_json, nullptr, false);
  if (!p.is_object() || !q.is_object()) return "";
  const nlohmann::json left = p.flatten(), right = q.flatten();
  std::set<std::string> keys;
  for (const auto* side : {&left, &right})
    for (const auto& [key, unused] : side->items()) keys.insert(key);
  std::vector<std::string> found;
  const auto at = [](const nlohmann::json& side, const std::string& key) {
    return side.contains(key) ? side[key].dump() : std::string(kNotStated);
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
  throw Error(
      fmt::format("{} and {} cannot be compared, so nothing was:{}\nRepeat one of them under the conditions of the "
                  "other. `--allow {}` compares them nevertheless and marks the output",
                  a, b, lines, joined(kinds, ",")),
      ExitCode::BadInput);
}

std::string DifferingRuns::marks() const {
  std::string out;
  for (const Entry& e : all_) out += fmt::format("Compared although it differs, by --allow: {}\n", line(e));
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

}  // namespace clothbench
