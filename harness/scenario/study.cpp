#include "scenario/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "base/words.hpp"
#include "scenario/draw_contact.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

constexpr double kFpsAccuracy_s = 0.5;
constexpr int kQuickRatio = 8;  ///< ratio of successive values in a settings sweep (full form: 2)
constexpr std::uint64_t kGreatestSeed = std::uint64_t{1} << 53;  ///< largest integer that JSON readers keep exactly

StudyRules read_rules(const json& j) {
  return {j["frames"].get<int>(), j["min_frames"].get<int>(), j["max_wall_s"].get<double>(),
          j["warmup_s"].get<double>(), j["agree"].get<double>()};
}

/// Converts {"cloth.sides": "double"} to arguments as for `--set`.
Words assignments(const json& set) {
  Words out;
  for (const auto& [key, value] : set.items()) out.push_back(key + "=" + dump(value));
  return out;
}

/// Whether the choice contains one of the tags. An empty choice accepts all tags.
bool chosen(const json& choice, const Words& tags) {
  return choice.empty() ||
         std::any_of(choice.begin(), choice.end(), [&](const json& c) { return contains(tags, c.get<std::string>()); });
}

/// One combination of values on a scene's axes.
struct Variant {
  std::string suffix;     ///< of the scene's name: "-32-single"
  Words overrides, tags;  ///< overrides: as for `--set`; tags: labels of its values
};

void check_lengths(const json& axis, std::size_t a, const std::string& pointer, const std::string& source) {
  if (axis["values"].size() != axis["labels"].size())
    throw Error(fmt::format("{}: {}/axes/{}/labels: expected one label per value, {}; found {}", source, pointer, a,
                            axis["values"].size(), axis["labels"].size()));
  for (const auto& [key, values] : axis["with"].items())
    if (values.size() != axis["values"].size())
      throw Error(fmt::format("{}: {}/axes/{}/with/{}: expected one per value of the axis, {}; found {}", source,
                              pointer, a, key, axis["values"].size(), values.size()));
}

/// Refuses an override of the axis's key, because it would give all values of the axis the same scene.
void check_free(const json& axis, const std::vector<std::string>& set) {
  const std::string start = axis["key"].get<std::string>() + "=";
  for (const std::string& item : set)
    if (item.starts_with(start))
      throw Error("--set " + shortened(item, 200) + ": the study varies this key; give it in a copy of the study file");
}

Variant with_value(Variant v, const json& axis, std::size_t k) {
  v.tags.push_back(axis["labels"][k].get<std::string>());
  v.suffix += "-" + v.tags.back();
  v.overrides.push_back(axis["key"].get<std::string>() + "=" + dump(axis["values"][k]));
  for (const auto& [key, values] : axis["with"].items()) v.overrides.push_back(key + "=" + dump(values[k]));
  return v;
}

/// Cartesian product of a scene's axes; the first varies slowest. Throws Error with `source` and JSON pointer if the
/// numbers of values and labels differ or if there would be more than `kMostRuns` scenes, and Error if one of `set`
/// (`key=value`, as in `--set`) is the key of an axis.
std::vector<Variant> expand(const json& axes, const std::string& pointer, const std::string& source,
                            const std::vector<std::string>& set) {
  std::vector<Variant> all(1);
  double count = 1;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const json& axis = axes[a];
    check_lengths(axis, a, pointer, source);
    check_free(axis, set);
    count *= static_cast<double>(axis["values"].size());
  }
  if (!(count <= static_cast<double>(kMostRuns)))
    throw Error(fmt::format("{}: {}/axes: they make {:.0f} scenes; a study may have at most {} runs", source, pointer,
                            count, kMostRuns));
  for (const json& axis : axes) {
    std::vector<Variant> next;
    for (const Variant& v : all)
      for (std::size_t k = 0; k < axis["values"].size(); ++k) next.push_back(with_value(v, axis, k));
    all = std::move(next);
  }
  return all;
}

/// Builds a Study from its completed JSON.
class Builder {
 public:
  Builder(json definition, const std::filesystem::path& file, const StudyOptions& options)
      : j_(std::move(definition)), file_(file), source_(file.string()), options_(options) {}

  Study build() {
    study_.length = options_.length;
    if (study_.length == StudyLength::Quick) {
      if (!j_.contains("quick")) throw Error(source_ + ": \"quick\" is missing, so this study has no quick form");
      quick_ = j_["quick"];
    }
    study_.name = j_["name"].get<std::string>();
    study_.why = j_["why"].get<std::string>();
    study_.protocol = j_["protocol"].get<std::string>();
    study_.trials = (quick_.is_null() ? j_ : quick_)["trials"].get<int>();
    study_.drop_frames = j_["drop_frames"].get<int>();
    study_.rules = read_rules((quick_.is_null() ? j_ : quick_)["rules"]);
    const double standard_s = study_.protocol == "fps" ? kFpsAccuracy_s : std::numeric_limits<double>::infinity();
    study_.accuracy_duration_s = j_.value("accuracy_duration_s", standard_s);
    study_.run_limit_s = j_["run_limit_s"].get<double>();
    study_.pipelined = j_["pipelined"].get<bool>();
    read_solvers();
    if (study_.protocol == "contact")
      draw_scenes();
    else
      for (std::size_t k = 0; k < j_["scenes"].size(); ++k) read_scene(k);
    check_tags();
    if (study_.scenes.empty()) throw Error(source_ + ": expected at least one scene with a solver");
    study_.definition = std::move(j_);
    return std::move(study_);
  }

 private:
  void read_solvers() {
    Words named;
    for (std::size_t k = 0; k < j_["solvers"].size(); ++k) {
      const json& s = j_["solvers"][k];
      StudySolver solver{s["solver"].get<std::string>(), s["label"].get<std::string>(), s["settings"],
                         assignments(s["set"]), s["tags"]};
      solver_names_.push_back(solver.name());
      named.push_back(solver.solver);
      const std::string at = fmt::format("{}: /solvers/{}/ladder", source_, k);
      for (StudySolver& rung : climb(solver, s.contains("ladder") ? s["ladder"].get<Words>() : Words{}, at)) {
        stays_.push_back(stays(solver));
        study_.solvers.push_back(std::move(rung));
      }
    }
    for (const std::string& name : options_.solvers) {
      if (contains(named, name)) continue;
      const auto knobs = options_.knobs.find(name);
      const bool climbs = knobs != options_.knobs.end() && j_.contains("ladder");
      for (StudySolver& rung : climb({name, "default", json::object(), {}, json::array(), true},
                                     climbs ? knobs->second : Words{}, source_)) {
        study_.solvers.push_back(std::move(rung));
        stays_.push_back(true);
      }
      named.push_back(name);
    }
  }

  /// The solver with each combination of its sweep settings, by increasing work; if `knobs` is empty, only the solver
  /// itself.
  std::vector<StudySolver> climb(const StudySolver& solver, const Words& knobs, const std::string& at) const {
    if (knobs.empty()) return {solver};
    if (!j_.contains("ladder")) throw Error(at + ": the study has no \"ladder\"");
    const json& ladder = j_["ladder"];
    const int most = ladder["product_at_most"].get<int>(), ratio = quick_.is_null() ? 2 : kQuickRatio;
    std::vector<StudySolver> rungs = {solver};
    rungs[0].label.clear();
    rungs[0].work = 1;
    for (const std::string& knob : knobs) {
      const int end = std::min(most, ladder["at_most"].value(knob, most));
      std::vector<StudySolver> next;
      for (const StudySolver& rung : rungs)
        for (int value = 1; rung.work * value <= most && value <= end; value *= ratio) {
          StudySolver s = rung;
          s.settings[knob] = value;
          s.work *= value;
          s.label += fmt::format("{}{}={}", s.label.empty() ? "" : ",", knob, value);
          next.push_back(std::move(s));
        }
      rungs = std::move(next);
    }
    for (StudySolver& rung : rungs)
      if (rung.label.empty()) rung.label = solver.label;
    std::stable_sort(rungs.begin(), rungs.end(), [](const auto& a, const auto& b) { return a.work < b.work; });
    return rungs;
  }

  /// Tags per solver name; null if `quick.tags` is one list for all solvers, or outside the quick form.
  json quick_by_solver() const {
    const json tags = quick_.is_null() ? json() : quick_["tags"];
    return tags.is_object() ? tags : json();
  }

  /// Whether a solver stays in the quick form. A requested solver always stays. If the form names some of the solver's
  /// settings, only these stay.
  bool stays(const StudySolver& s) const {
    const json quick = quick_by_solver();
    const bool in_quick = quick.is_null() || quick.contains(s.name());
    if (options_.solvers.empty()) return in_quick;
    bool quick_has_it = false;
    for (const auto& [name, unused] : quick.items())
      quick_has_it = quick_has_it || name == s.solver || name.starts_with(s.solver + " ");
    return contains(options_.solvers, s.solver) && (in_quick || !quick_has_it);
  }

  std::filesystem::path scene_path(std::size_t k) const {
    const std::string name = j_["scenes"][k]["file"].get<std::string>();
    std::filesystem::path path = name;
    std::error_code ec;
    if (path.is_relative() && std::filesystem::exists(file_.parent_path() / path, ec))
      path = file_.parent_path() / path;
    if (!std::filesystem::exists(path, ec))
      throw Error(fmt::format("{}: /scenes/{}/file: {}: no such file", source_, k, in_quotes(name)));
    return path;
  }

  /// Each entry of "scenes" is a kind. Kinds alternate with the seed, so that a seed determines its kind.
  void draw_scenes() {
    std::vector<ContactKind> kinds;
    for (std::size_t k = 0; k < j_["scenes"].size(); ++k) {
      kinds.push_back(contact_kind(j_["scenes"][k], scene_path(k), fmt::format("{}: /scenes/{}", source_, k),
                                   quick_.is_null() ? json::object() : quick_, j_["box"]));
      kinds.back().kinds = j_["scenes"].size();
      tags_.insert(kinds.back().name);
    }
    const std::uint64_t first = options_.seed.value_or(1);
    const int all = (quick_.is_null() ? j_ : quick_).value("count", j_["count"].get<int>());
    const int count = options_.count > 0 ? options_.count : all;
    if (!(first <= kGreatestSeed - static_cast<std::uint64_t>(count)))
      throw Error(
          fmt::format("--seed {}: expected at most {}", first, kGreatestSeed - static_cast<std::uint64_t>(count)));
    if (!(static_cast<double>(count) * static_cast<double>(study_.solvers.size()) <= static_cast<double>(kMostRuns)))
      throw Error(fmt::format("{}: {} scenes with {} solvers are {:.0f} runs; a study may have at most {}", source_,
                              count, study_.solvers.size(),
                              static_cast<double>(count) * static_cast<double>(study_.solvers.size()), kMostRuns));
    ContactDrawer drawer(options_.assets);
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
      const std::size_t k = seed % kinds.size();
      Variant v;
      v.tags = j_["scenes"][k]["tags"].get<Words>();
      v.tags.push_back(kinds[k].name);
      add_forms(drawer.draw(kinds[k], study_.name, seed), scene_path(k).string(), v, fmt::format("/scenes/{}", k));
    }
    j_["seed"] = first;
    j_["count"] = count;
  }

  void read_scene(std::size_t k) {
    const json& item = j_["scenes"][k];
    const std::string pointer = fmt::format("/scenes/{}", k);
    if (item.contains("draw")) throw Error(source_ + ": " + pointer + "/draw: only for protocol contact");
    const std::filesystem::path path = scene_path(k);
    const json scenario = parse_json(read_text(path), path.string());
    const json name_at = scenario.is_object() ? scenario.value("name", json()) : json();
    const std::string name = name_at.is_string() ? name_at.get<std::string>() : "";
    for (Variant& v : expand(item["axes"], pointer, source_, options_.overrides)) {
      const auto tags = item["tags"].get<Words>();
      v.tags.insert(v.tags.end(), tags.begin(), tags.end());
      v.tags.push_back(name + v.suffix);
      tags_.insert(v.tags.begin(), v.tags.end());
      add_forms(scenario, path.string(), v, pointer);
    }
  }

  /// Adds one item per set of solvers that make equal changes to the scene. The names of their runs must differ.
  void add_forms(const json& scenario, const std::string& path, const Variant& v, const std::string& pointer) {
    std::map<Words, std::size_t> forms;
    for (std::size_t s = 0; s < study_.solvers.size(); ++s) {
      const StudySolver& solver = study_.solvers[s];
      if (!stays_[s] || !runs(solver, v.tags)) continue;
      const auto [at, is_new] = forms.emplace(solver.set, study_.scenes.size());
      if (is_new) {
        Words all = v.overrides;
        for (const Words* more : {&solver.set, &options_.overrides}) all.insert(all.end(), more->begin(), more->end());
        Scene scene = scene_from_json(scenario, path, all, options_.assets);
        scene.name += v.suffix;
        const int group = group_of(scene);
        study_.scenes.push_back(
            {std::move(scene), group, {}, scenario.value("/drawn/settings"_json_pointer, json::object())});
      }
      Study::Item& item = study_.scenes[at->second];
      const bool is_first = names_.insert(item.scene.name + " " + solver.name()).second;
      if (names_.size() > kMostRuns)
        throw Error(
            fmt::format("{}: {}: more than {} runs; expected fewer scenes, values of axes, sweep settings or solvers",
                        source_, pointer, kMostRuns));
      item.solvers.push_back(s);
      if (!is_first)
        throw Error(fmt::format("{}: {}: two runs are named {} with {}; labels must differ", source_, pointer,
                                in_quotes(item.scene.name), in_quotes(solver.name())));
    }
  }

  /// Whether this form of the study runs a scene with these tags. A requested solver that the quick form does not name
  /// runs all scenes of the form.
  bool runs(const StudySolver& s, const Words& tags) const {
    if (!chosen(s.tags, tags)) return false;
    if (quick_.is_null()) return true;
    const json quick = quick_by_solver();
    if (quick.is_null()) return chosen(quick_["tags"], tags);
    if (quick.contains(s.name())) return chosen(quick[s.name()], tags);
    return std::any_of(quick.begin(), quick.end(), [&](const json& choice) { return chosen(choice, tags); });
  }

  int group_of(const Scene& scene) {
    const bool by_scene = study_.protocol != "fps";
    const std::string key = by_scene ? scene.name : fmt::format("{} {}", scene.cloth.columns, scene.cloth.rows);
    return groups_.emplace(key, static_cast<int>(groups_.size())).first->second;
  }

  /// Refuses a tag that selects nothing, which is probably a spelling error.
  void check_tags() const {
    const auto check = [&](const std::string& pointer, const std::string& word, const Words& known) {
      if (!contains(known, word))
        throw Error(
            fmt::format("{}: {}: {} is unknown{}", source_, pointer, in_quotes(word), nearest_known(word, known)));
    };
    const Words tags(tags_.begin(), tags_.end());
    const auto check_all = [&](const std::string& pointer, const json& words) {
      for (std::size_t k = 0; k < words.size(); ++k) check(fmt::format("{}/{}", pointer, k), words[k], tags);
    };
    for (std::size_t s = 0; s < j_["solvers"].size(); ++s)
      check_all(fmt::format("/solvers/{}/tags", s), j_["solvers"][s]["tags"]);
    if (!j_.contains("quick")) return;
    const json& quick = j_["quick"]["tags"];
    if (quick.is_array()) return check_all("/quick/tags", quick);
    for (const auto& [solver, words] : quick.items()) {
      check("/quick/tags", solver, solver_names_);
      check_all("/quick/tags/" + solver, words);
    }
  }

  json j_, quick_;  ///< quick_: null unless the quick form was requested
  const std::filesystem::path file_;
  const std::string source_;
  const StudyOptions& options_;
  Study study_;
  Words solver_names_;
  std::vector<bool> stays_;  ///< by solver index
  std::set<std::string> tags_, names_;
  std::map<std::string, int> groups_;
};

json protocol_in(const std::string& name_or_path) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const json j = parse_json(read_text(file), file.string());
  return j.is_object() ? j.value("protocol", json()) : json();
}

}  // namespace

Study load_study(const std::string& name_or_path, const StudyOptions& options) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const std::string source = file.string();
  json j = parse_json(read_text(file), source);
  validate_json(j, kStudySchema, source);
  if (j.contains("quick") && !j["quick"].contains("rules")) j["quick"]["rules"] = j.value("rules", json::object());
  fill_defaults(j, kStudySchema);
  return Builder(std::move(j), file, options).build();
}

bool is_study(const std::string& name_or_path) { return !protocol_in(name_or_path).is_null(); }

bool is_study_of(const std::string& name_or_path, const std::string& protocol) {
  return protocol_in(name_or_path) == protocol;
}

std::string StudySolver::name() const { return label == "default" ? solver : solver + " " + label; }

bool is_drawn(const Study& study) { return study.protocol == "contact"; }

}  // namespace clothbench
