#include <fmt/format.h>

#include <cmath>

#include "base/words.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kMargin_s = 5;
constexpr double kLogged = 0.8;  // required fraction of a trial in which the device's state was logged
constexpr int kMinSamples = 5;   // minimum number of samples for a mean bandwidth
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;

constexpr char kSchema[] =
#include "device_samples.schema.inc"
    ;

/// Checks conditions on a group that the schema cannot express.
void check_group(const std::string& file, const std::string& at, const json& g) {
  const json& times = g["time_unix_s"];
  for (std::size_t k = 1; k < times.size(); ++k)
    if (!(times[k - 1].get<double>() < times[k].get<double>()))
      refuse(file, fmt::format("{}/time_unix_s/{}", at, k), "expected a time after the one before");
  if (g.contains("reasons") && g["reasons"].size() != times.size())
    refuse(file, at + "/reasons", fmt::format("expected {} texts, one per time", times.size()));
  for (std::size_t k = 0; k < g["series"].size(); ++k)
    if (g["series"][k]["values"].size() != times.size())
      refuse(file, fmt::format("{}/series/{}/values", at, k),
             fmt::format("expected {} numbers or nulls, one per time", times.size()));
}

/// The samples of a source that belong to a run, and for each the index of the trial that contains it (-1: none).
struct Taken {
  std::vector<std::size_t> index;
  std::vector<double> time_unix_s, trial;
};

/// The device's state log during a trial: the time that it covers, and its reasons to distrust the trial's times.
struct StateLog {
  double logged_s = 0;
  std::set<std::string> reasons;
};
using StateLogs = std::map<int, StateLog>;  // by trial index

Taken take(const json& group, const RunRecord& r, StateLogs& logs) {
  double first = kMissing, last = kMissing;
  for (const TimedTrial& t : r.trials) {
    if (!std::isfinite(t.start_unix_s)) continue;
    if (!(first <= t.start_unix_s)) first = t.start_unix_s;
    if (!(last >= t.end_unix_s)) last = t.end_unix_s;
  }
  const double period = group["period_s"].get<double>();
  Taken out;
  for (std::size_t k = 0; k < group["time_unix_s"].size(); ++k) {
    const double t = group["time_unix_s"][k].get<double>();
    if (t < first - kMargin_s || t > last + kMargin_s) continue;
    out.index.push_back(k);
    out.time_unix_s.push_back(t);
    out.trial.push_back(-1);
    // A sample covers the period before it. A late sample of a state log covers up to two periods.
    const double since = k > 0 ? std::max(t - 2 * period, group["time_unix_s"][k - 1].get<double>()) : t - period;
    for (const TimedTrial& trial : r.trials) {
      if (t - period >= trial.start_unix_s && t <= trial.end_unix_s) out.trial.back() = trial.index;
      const double overlap_s = std::min(t, trial.end_unix_s) - std::max(since, trial.start_unix_s);
      if (!group.contains("reasons") || !(overlap_s > 0)) continue;
      logs[trial.index].logged_s += overlap_s;
      logs[trial.index].reasons.insert(group["reasons"][k]);
    }
  }
  return out;
}

/// Adds the scalar of a series with a role: mean over trials (bandwidths: at least kMinSamples samples), or maximum.
void summarise(const std::string& role, double scale, const Taken& taken, const std::vector<double>& values,
               std::map<std::string, double>& summary) {
  std::map<double, int> samples;
  for (std::size_t k = 0; k < values.size(); ++k) samples[taken.trial[k]] += std::isfinite(values[k]) ? 1 : 0;
  const int required = role == "read" || role == "write" ? kMinSamples : 1;
  double sum = 0, greatest = kMissing;
  int count = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (taken.trial[k] < 0 || !std::isfinite(values[k]) || samples[taken.trial[k]] < required) continue;
    sum += scale * values[k];
    ++count;
    if (!(greatest >= scale * values[k])) greatest = scale * values[k];
  }
  const double mean = count > 0 ? sum / count : kMissing;
  if (role == "fps") summary["sampled_fps_mean"] = mean;
  if (role == "cpu_clock" || role == "gpu_clock") summary["sampled_" + role + "_mean_Hz"] = mean;
  if (role == "read" || role == "write") summary["sampled_" + role + "_mean_B_per_s"] = mean;
  if (role == "temperature") summary["sampled_temperature_max_C"] = greatest;
}

StoredGroup store_group(const json& group, const RunRecord& r, std::map<std::string, double>& summary,
                        StateLogs& logs) {
  const Taken taken = take(group, r, logs);
  const std::uint64_t count = taken.index.size();
  StoredGroup out;
  out.path = "device_samples/" + group["name"].get<std::string>();
  out.attributes = {{"source", group["source"]}, {"period_s", group["period_s"]}};
  const auto add = [&](const std::string& name, const std::string& units, const std::string& long_name, bool integer,
                       std::vector<double> values) {
    out.arrays.push_back({name, units, long_name, {"sample"}, {count}, integer, std::move(values)});
  };
  add("time_unix_s", "s", "end of the sample by the device's clock, since 1970 UTC", false, taken.time_unix_s);
  add("trial", "1", "trial that contains the whole sample; -1: none", true, taken.trial);
  for (const json& s : group["series"]) {
    std::vector<double> values;
    for (const std::size_t k : taken.index)
      values.push_back(s["values"][k].is_number() ? s["values"][k].get<double>() : kMissing);
    summarise(s.value("role", ""), s.value("scale", 1.0), taken, values, summary);
    add(s["name"], s["units"], s["long_name"], false, std::move(values));
  }
  return out;
}

}  // namespace

DeviceSamples::DeviceSamples(const std::filesystem::path& path) {
  const std::string file = path.string();
  all_ = parse_json(read_text(path, kMaxBytes), file);
  validate_json(all_, kSchema, file);
  for (std::size_t k = 0; k < all_["groups"].size(); ++k)
    check_group(file, fmt::format("/groups/{}", k), all_["groups"][k]);
}

void DeviceSamples::attach_to(RunRecord& r) {
  StateLogs logs;
  r.samples.assign(1, {});
  for (const json& group : all_["groups"]) r.samples.push_back(store_group(group, r, r.summary, logs));
  json reasons = json::object();
  for (const TimedTrial& trial : r.trials) {
    StateLog& log = logs[trial.index];
    if (!(log.logged_s >= kLogged * (trial.end_unix_s - trial.start_unix_s)))
      log.reasons.insert("the device did not log its state throughout");
    log.reasons.erase("");
    reasons_.insert(log.reasons.begin(), log.reasons.end());
    if (!log.reasons.empty()) reasons[std::to_string(trial.index)] = joined(log.reasons, "; ");
  }
  r.samples[0].path = "device_samples";
  r.samples[0].attributes = {
      {"valid", reasons.empty() ? 1 : 0}, {"reasons", dump(reasons)}, {"device_json", dump(all_["device"])}};
  r.summary["sampled_valid"] = reasons.empty() ? 1 : 0;
  r.header.environment["distrusted_trials"] = std::move(reasons);
}

}  // namespace clothbench
