#include "scenario/study.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "scenario/json_text.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

StudyRules read_rules(const json& j) {
  return {j["frames"].get<int>(), j["min_frames"].get<int>(), j["max_wall_s"].get<double>(), j["warmup_s"].get<double>()};
}

struct Variant {
  std::string suffix;
  std::vector<std::string> overrides;
};

/// Product of the axes, the first varying slowest.
std::vector<Variant> expand(const json& axes, const std::string& pointer, const std::string& source) {
  std::vector<Variant> all(1);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const json& axis = axes[a];
    if (axis["values"].size() != axis["labels"].size())
      throw Error(fmt::format("{}: {}/axes/{}/labels: expected one label a value, {}; found {}", source, pointer, a,
                              axis["values"].size(), axis["labels"].size()));
    std::vector<Variant> next;
    for (const Variant& v : all)
      for (std::size_t k = 0; k < axis["values"].size(); ++k) {
        Variant w = v;
        w.suffix += "-" + axis["labels"][k].get<std::string>();
        w.overrides.push_back(axis["key"].get<std::string>() + "=" + axis["values"][k].dump());
        next.push_back(std::move(w));
      }
    all = std::move(next);
  }
  return all;
}

}  // namespace

bool is_study(const std::string& name_or_path) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const json j = parse_json(read_text(file), file.string());
  return j.is_object() && j.contains("protocol");
}

Study load_study(const std::string& name_or_path, const std::vector<std::string>& overrides) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const std::string source = file.string();
  json j = parse_json(read_text(file), source);
  validate_json(j, kStudySchema, source);
  fill_defaults(j, kStudySchema);

  Study study;
  study.name = j["name"].get<std::string>();
  study.why = j["why"].get<std::string>();
  study.protocol = j["protocol"].get<std::string>();
  study.trials = j["trials"].get<int>();
  study.drop_frames = j["drop_frames"].get<int>();
  study.accuracy_duration_s = j["accuracy_duration_s"].get<double>();
  study.short_rules = read_rules(j["short"]);
  study.full_rules = read_rules(j["full"]);
  for (const json& s : j["solvers"])
    study.solvers.push_back({s["solver"].get<std::string>(), s["label"].get<std::string>(), s["settings"]});

  std::map<std::pair<int, int>, int> groups;
  std::set<std::string> names;
  for (std::size_t k = 0; k < j["scenes"].size(); ++k) {
    const json& item = j["scenes"][k];
    const std::string pointer = fmt::format("/scenes/{}", k), scene_file = item["file"].get<std::string>();
    std::filesystem::path path = scene_file;
    if (path.is_relative() && std::filesystem::exists(file.parent_path() / path)) path = file.parent_path() / path;
    if (!std::filesystem::exists(path)) throw Error(source + ": " + pointer + "/file: \"" + scene_file + "\": no such file");
    const json scenario = parse_json(read_text(path), path.string());
    for (const Variant& v : expand(item["axes"], pointer, source)) {
      std::vector<std::string> all = v.overrides;
      all.insert(all.end(), overrides.begin(), overrides.end());
      Scene scene = scene_from_json(scenario, path.string(), all);
      scene.name += v.suffix;
      if (!names.insert(scene.name).second) throw Error(source + ": " + pointer + ": two scenes are named \"" + scene.name + "\"; labels must differ");
      const int next = static_cast<int>(groups.size());
      const int group = groups.emplace(std::pair{scene.cloth.columns, scene.cloth.rows}, next).first->second;
      study.scenes.push_back({std::move(scene), group});
    }
  }
  study.definition = std::move(j);
  return study;
}

}  // namespace clothbench
