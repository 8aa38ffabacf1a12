#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kMargin_s = 5;
constexpr double kWindow_s = 5;  // of the paper's Fig. 5

[[noreturn]] void fail(const std::string& file, const std::string& pointer, const std::string& expected) {
  throw Error(file + ": " + pointer + ": expected " + expected);
}

double number(const json& v) { return v.is_number() ? v.get<double>() : kMissing; }

void check_group(const std::string& file, const std::string& at, const json& g) {
  if (!g.is_object()) fail(file, at, "an object");
  for (const char* key : {"name", "source"})
    if (!g.contains(key) || !g[key].is_string()) fail(file, at + "/" + key, "a text");
  const std::string name = g["name"].get<std::string>();
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), plain)) fail(file, at + "/name", "letters, digits and _");
  if (!(number(g.value("period_s", json())) > 0)) fail(file, at + "/period_s", "a positive number");
  if (!g.contains("time_unix_s") || !g["time_unix_s"].is_array()) fail(file, at + "/time_unix_s", "a list of numbers");
  double before = 0;
  for (std::size_t k = 0; k < g["time_unix_s"].size(); ++k) {
    const double t = number(g["time_unix_s"][k]);
    if (!(t > before)) fail(file, fmt::format("{}/time_unix_s/{}", at, k), "a time after the one before");
    before = t;
  }
  if (!g.contains("series") || !g["series"].is_array()) fail(file, at + "/series", "a list");
  for (std::size_t k = 0; k < g["series"].size(); ++k) {
    const json& s = g["series"][k];
    const std::string here = fmt::format("{}/series/{}", at, k);
    for (const char* key : {"name", "units", "long_name"})
      if (!s.is_object() || !s.contains(key) || !s[key].is_string()) fail(file, here + "/" + key, "a text");
    if (s["name"].get<std::string>().find_first_of("/.") != std::string::npos) fail(file, here + "/name", "no / or .");
    if (!s.contains("values") || !s["values"].is_array() || s["values"].size() != g["time_unix_s"].size())
      fail(file, here + "/values", fmt::format("{} numbers or nulls, one a time", g["time_unix_s"].size()));
    for (std::size_t i = 0; i < s["values"].size(); ++i)
      if (!s["values"][i].is_number() && !s["values"][i].is_null())
        fail(file, fmt::format("{}/values/{}", here, i), "a number or null");
  }
}

/// The samples of one source that belong to a run, and the trial each lies in as a whole; -1: in none.
struct Taken {
  std::vector<std::size_t> index;
  std::vector<double> time_unix_s;
  std::vector<const TimedTrial*> trial;
};

Taken take(const json& group, const RunRecord& r) {
  double first = kMissing, last = kMissing;
  for (const TimedTrial& t : r.trials) {
    if (!std::isfinite(t.start_unix_s)) continue;
    if (!(first <= t.start_unix_s)) first = t.start_unix_s;
    if (!(last >= t.end_unix_s)) last = t.end_unix_s;
  }
  const double period = group.at("period_s").get<double>();
  Taken out;
  for (std::size_t k = 0; k < group.at("time_unix_s").size(); ++k) {
    const double t = group["time_unix_s"][k].get<double>();
    if (t < first - kMargin_s || t > last + kMargin_s) continue;
    const TimedTrial* in = nullptr;
    // A sample tells of the period before it.
    for (const TimedTrial& trial : r.trials)
      if (t - period >= trial.start_unix_s && t <= trial.end_unix_s) in = &trial;
    out.index.push_back(k);
    out.time_unix_s.push_back(t);
    out.trial.push_back(in);
  }
  return out;
}

struct Window {
  double start_unix_s, greatest;
};

/// Windows of 5 s counted from each trial's first timed frame; those without a sample are left out.
std::vector<Window> window_maxima(const Taken& taken, const std::vector<double>& values) {
  std::vector<Window> out;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (taken.trial[k] == nullptr || !std::isfinite(values[k])) continue;
    const double begin = taken.trial[k]->start_unix_s;
    const double start = begin + kWindow_s * std::floor((taken.time_unix_s[k] - begin) / kWindow_s);
    if (out.empty() || out.back().start_unix_s != start) out.push_back({start, values[k]});
    out.back().greatest = std::max(out.back().greatest, values[k]);
  }
  return out;
}

void summarise(const std::string& role, double scale, const Taken& taken, const std::vector<double>& values,
               std::map<std::string, double>& summary) {
  double sum = 0, most = kMissing;
  int count = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (taken.trial[k] == nullptr || !std::isfinite(values[k])) continue;
    sum += scale * values[k];
    ++count;
    if (!(most >= scale * values[k])) most = scale * values[k];
  }
  const double mean = count > 0 ? sum / count : kMissing;
  if (role == "fps") summary["sampled_fps_mean"] = mean;
  if (role == "cpu_clock" || role == "gpu_clock") summary["sampled_" + role + "_mean_Hz"] = mean;
  if (role == "temperature") summary["sampled_temperature_max_C"] = most;
  if (role != "read" && role != "write") return;
  summary["sampled_" + role + "_mean_B_per_s"] = mean;
  summary["sampled_" + role + "_peak_B_per_s"] = most;  // the greatest of the windows' maxima
  summary["sampled_" + role + "_samples"] = count;
}

StoredGroup store_group(const json& group, const RunRecord& r, std::map<std::string, double>& summary) {
  const Taken taken = take(group, r);
  StoredGroup out;
  out.path = "device_samples/" + group.at("name").get<std::string>();
  out.attributes = {{"source", group.at("source")}, {"period_s", group.at("period_s")}};
  const std::uint64_t count = taken.index.size();
  std::vector<double> trials;
  for (const TimedTrial* t : taken.trial) trials.push_back(t == nullptr ? -1 : t->index);
  out.arrays.push_back({"time_unix_s",
                        "s",
                        "end of the sample by the device's clock, since 1970 UTC",
                        {"sample"},
                        {count},
                        false,
                        taken.time_unix_s});
  out.arrays.push_back(
      {"trial", "1", "trial the sample lies in as a whole; -1: in none", {"sample"}, {count}, true, trials});
  std::vector<StoredArray> windows;
  for (const json& s : group.at("series")) {
    const std::string name = s.at("name"), role = s.value("role", "");
    StoredArray a{name, s.at("units"), s.at("long_name"), {"sample"}, {count}, false, {}};
    for (const std::size_t k : taken.index) a.values.push_back(number(s.at("values")[k]));
    summarise(role, s.value("scale", 1.0), taken, a.values, summary);
    if (role == "read" || role == "write") {
      StoredArray start{
          name + "_window_start_unix_s", "s", "start of the window, since 1970 UTC", {name + "_window"}, {}, false, {}};
      StoredArray most{
          name + "_window_max", a.units, a.long_name + ", maximum within 5 s", {name + "_window"}, {}, false, {}};
      for (const Window& w : window_maxima(taken, a.values)) {
        start.values.push_back(w.start_unix_s);
        most.values.push_back(w.greatest);
      }
      start.shape = most.shape = {start.values.size()};
      windows.insert(windows.end(), {start, most});
    }
    out.arrays.push_back(std::move(a));
  }
  out.arrays.insert(out.arrays.end(), windows.begin(), windows.end());
  return out;
}

}  // namespace

DeviceSamples::DeviceSamples(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream in(path);
  if (!in) throw Error(file + ": cannot be read; expected samples.json of scripts/quest_run.py");
  all_ = json::parse(in, nullptr, false);
  if (all_.is_discarded() || !all_.is_object()) throw Error(file + ": not JSON");
  if (all_.value("format", json()) != "clothbench-device-samples")
    fail(file, "/format", "\"clothbench-device-samples\"");
  if (all_.value("format_version", json()) != 1) fail(file, "/format_version", "1");
  if (!all_.value("valid", json()).is_boolean()) fail(file, "/valid", "true or false");
  if (!all_.value("device", json()).is_object()) fail(file, "/device", "an object");
  const json reasons = all_.value("reasons", json());
  if (!reasons.is_array()) fail(file, "/reasons", "a list of texts");
  for (std::size_t k = 0; k < reasons.size(); ++k)
    if (!reasons[k].is_string()) fail(file, fmt::format("/reasons/{}", k), "a text");
  if (all_["valid"].get<bool>() != reasons.empty())
    fail(file, "/valid", "true without reasons against it, false with some");
  if (!all_.value("groups", json()).is_array()) fail(file, "/groups", "a list");
  for (std::size_t k = 0; k < all_["groups"].size(); ++k)
    check_group(file, fmt::format("/groups/{}", k), all_["groups"][k]);
}

void DeviceSamples::attach_to(RunRecord& r) const {
  StoredGroup top;
  top.path = "device_samples";
  top.attributes = {{"valid", all_.at("valid").get<bool>() ? 1 : 0},
                    {"reasons", joined(all_.at("reasons").get<std::vector<std::string>>(), "; ")},
                    {"device_json", all_.at("device").dump()}};
  r.samples = {std::move(top)};
  for (const json& group : all_.at("groups")) r.samples.push_back(store_group(group, r, r.summary));
  r.summary["sampled_valid"] = all_.at("valid").get<bool>() ? 1 : 0;
  r.header.environment["device_samples"] = {
      {"valid", all_.at("valid")}, {"reasons", all_.at("reasons")}, {"device", all_.at("device")}};
}

}  // namespace clothbench
