#include "scenario/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/solver.hpp"
#include "scenario/draw_contact.hpp"
#include "scenario/irrelevant.hpp"
#include "scenario/load.hpp"
#include "scenario/schemas.hpp"
#include "scenario/study_axes.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

constexpr double kFpsAccuracy_s = 0.5;
constexpr const char* kAllOn = "all-on";
constexpr std::uint64_t kGreatestSeed = std::uint64_t{1} << 53;  ///< what every reader of JSON keeps

/// All features that a solver could be given in this scene; none if the build does not have the solver.
FeatureSet usable_features(const std::string& solver, FeatureSet needs) {
  for (const SolverEntry& e : solvers()) {
    if (e.info.name != solver || !e.make) continue;
    FeatureSet out = e.info.supports;
    for (const auto& [feature, beside] : e.info.only_with)
      if (!needs.has(beside)) out = out - FeatureSet{feature};
    return out;
  }
  return {};
}

StudyRules read_rules(const json& j) {
  return {j["frames"].get<int>(),      j["min_frames"].get<int>(),        j["max_wall_s"].get<double>(),
          j["warmup_s"].get<double>(), j["ladder_limit_s"].get<double>(), j["agree"].get<double>()};
}

/// Converts {"cloth.sides": "double"} to the form of `--set`.
Words assignments(const json& set) {
  Words out;
  for (const auto& [key, value] : set.items()) out.push_back(key + "=" + value.dump());
  return out;
}

/// Whether the choice has one of the labels. An empty choice accepts all.
bool chosen(const Words& choice, const Words& labels) {
  return choice.empty() ||
         std::any_of(labels.begin(), labels.end(), [&](const auto& l) { return contains(choice, l); });
}

/// Builds a Study from its completed file.
class Builder {
 public:
  Builder(json definition, const std::filesystem::path& file, const StudyOptions& options)
      : j_(std::move(definition)), file_(file), source_(file.string()), options_(options) {}

  Study build() {
    study_.length = options_.length;
    if (study_.length == StudyLength::Quick) {
      if (!j_.contains("quick")) throw Error(source_ + ": \"quick\" is missing, so this study has no short form");
      quick_ = j_["quick"];
    }
    study_.name = j_["name"].get<std::string>();
    study_.why = j_["why"].get<std::string>();
    study_.protocol = j_["protocol"].get<std::string>();
    study_.trials = (quick_.is_null() ? j_ : quick_)["trials"].get<int>();
    study_.drop_frames = j_["drop_frames"].get<int>();
    study_.rules =
        read_rules(!quick_.is_null() ? quick_["rules"] : j_[study_.length == StudyLength::Full ? "full" : "short"]);
    const double standard_s = study_.protocol == "fps" ? kFpsAccuracy_s : std::numeric_limits<double>::infinity();
    study_.accuracy_duration_s = j_.value("accuracy_duration_s", standard_s);
    study_.run_limit_s = j_["run_limit_s"].get<double>();
    study_.stage_times = j_["stage_times"].get<bool>();
    study_.pipelined = j_["pipelined"].get<bool>();
    read_solvers();
    if (study_.protocol == "feature-cost") add_all_on();
    if (study_.protocol == "contact")
      draw_scenes();
    else
      for (std::size_t k = 0; k < j_["scenes"].size(); ++k) read_scene(k);
    check_words();
    if (study_.scenes.empty()) throw Error(source_ + ": expected at least one scene with a solver");
    add_pairs();
    study_.definition = std::move(j_);
    return std::move(study_);
  }

 private:
  void read_solvers() {
    Words named;
    for (std::size_t k = 0; k < j_["solvers"].size(); ++k) {
      const json& s = j_["solvers"][k];
      StudySolver solver{s["solver"].get<std::string>(), s["label"].get<std::string>(), s["settings"],
                         assignments(s["set"]), s["only"].get<Words>()};
      solver.pair = s.value("pair", json());
      solver_names_.push_back(solver.name());
      named.push_back(solver.solver);
      solver.timed = s["timed"].get<bool>();
      const std::string at = fmt::format("{}: /solvers/{}/ladder", source_, k);
      for (StudySolver& rung : climb(solver, s.contains("ladder") ? s["ladder"].get<Words>() : Words{}, at)) {
        stays_.push_back(stays(solver));
        study_.solvers.push_back(std::move(rung));
      }
    }
    for (const std::string& name : options_.solvers) {
      if (contains(named, name)) continue;
      const auto knobs = options_.knobs.find(name);
      const bool climbs = knobs != options_.knobs.end() && ladder().is_object();
      for (StudySolver& rung :
           climb({name, "default", json::object(), {}, {}, true}, climbs ? knobs->second : Words{}, source_)) {
        study_.solvers.push_back(std::move(rung));
        stays_.push_back(true);
      }
      named.push_back(name);
    }
  }

  /// Adds every solver a second time, with all features on.
  void add_all_on() {
    const std::size_t count = study_.solvers.size();
    for (std::size_t k = 0; k < count; ++k) {
      StudySolver s = study_.solvers[k];
      s.label = s.label == "default" ? kAllOn : s.label + "," + kAllOn;
      s.all_on = true;
      s.pair = {{"relation", "irrelevant"}, {"with", {study_.solvers[k].label}}};
      study_.solvers.push_back(std::move(s));
      stays_.push_back(stays_[k]);
    }
  }

  /// The ladder for this form of the study; null if it has none.
  json ladder() const {
    if (!quick_.is_null() && quick_.contains("ladder")) return quick_["ladder"];
    if (study_.length == StudyLength::Short && j_.contains("short_ladder")) return j_["short_ladder"];
    return j_.value("ladder", json());
  }

  /// The solver with each combination of its ladder settings, in order of increasing work; only the solver itself if
  /// `knobs` is empty.
  std::vector<StudySolver> climb(const StudySolver& solver, const Words& knobs, const std::string& at) const {
    if (knobs.empty()) return {solver};
    const json ladder = this->ladder();
    if (!ladder.is_object()) throw Error(at + ": the study has no \"ladder\"");
    const int most = ladder["product_at_most"].get<int>(), ratio = ladder["ratio"].get<int>();
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

  /// A requested solver stays even if the quick form leaves it out. If the form has some of its settings, only these
  /// stay.
  bool stays(const StudySolver& s) const {
    const Words quick = quick_.is_null() ? Words{} : quick_["solvers"].get<Words>();
    const bool in_quick = quick.empty() || contains(quick, s.name());
    if (options_.solvers.empty()) return in_quick;
    const bool quick_has_it = std::any_of(quick.begin(), quick.end(), [&](const std::string& q) {
      return q == s.solver || q.starts_with(s.solver + " ");
    });
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

  /// Every scene of the study is a kind; kinds take turns, so that a seed says which one it draws.
  void draw_scenes() {
    std::vector<ContactKind> kinds;
    for (std::size_t k = 0; k < j_["scenes"].size(); ++k) {
      kinds.push_back(contact_kind(j_["scenes"][k], scene_path(k), fmt::format("{}: /scenes/{}", source_, k),
                                   quick_.is_null() ? json::object() : quick_["ranges"]));
      labels_.insert(kinds.back().name);
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
      v.labels = j_["scenes"][k]["labels"].get<Words>();
      v.labels.push_back(kinds[k].name);
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
      const auto labels = item["labels"].get<Words>();
      v.labels.insert(v.labels.end(), labels.begin(), labels.end());
      v.labels.push_back(name + v.suffix);
      v.timed = item["timed"].get<bool>();
      v.pair = item.value("pair", json());
      v.set_up = item.value("set_up", "");
      labels_.insert(v.labels.begin(), v.labels.end());  // labels of the study, even if this form leaves it out
      if (item["only_full"].get<bool>() && study_.length != StudyLength::Full) continue;
      if (!quick_.is_null() && !chosen(quick_["scenes"].get<Words>(), v.labels)) continue;
      add_forms(scenario, path.string(), v, pointer);
    }
  }

  /// Adds one item for all solvers with the same changes to the scene. The names of their runs must differ.
  void add_forms(const json& scenario, const std::string& path, const Variant& v, const std::string& pointer) {
    std::map<Words, std::size_t> forms;
    for (std::size_t s = 0; s < study_.solvers.size(); ++s) {
      const StudySolver& solver = study_.solvers[s];
      if (!stays_[s] || !chosen(solver.only, v.labels) || !quick_runs(solver, v.labels)) continue;
      Words key = solver.set;
      if (solver.all_on) key.push_back(kAllOn + solver.solver);
      const auto [at, is_new] = forms.emplace(key, study_.scenes.size());
      if (is_new) {
        Words all = v.overrides;
        const Words quick = quick_.is_null() ? Words{} : assignments(quick_["set"]);
        for (const Words* more : {&solver.set, &quick, &options_.overrides})
          all.insert(all.end(), more->begin(), more->end());
        Scene scene = scene_from_json(scenario, path, all, options_.assets);
        if (solver.all_on) {
          json form = scenario;
          for (const std::string& o : all) apply_override(form, o, path);
          form = with_irrelevant(std::move(form), scene.needs, usable_features(solver.solver, scene.needs));
          if (!form.contains("irrelevant")) {  // no feature to switch on
            forms.erase(at);
            continue;
          }
          scene = scene_from_json(std::move(form), path, {}, options_.assets);
        }
        scene.name += v.suffix;
        if (!v.set_up.empty()) j_["set_ups"][scene.name] = v.set_up;
        const int group = group_of(scene);
        study_.scenes.push_back({std::move(scene), group, v.timed, {}, v.pair});
      }
      Study::Item& item = study_.scenes[at->second];
      const bool is_first = runs_.insert(item.scene.name + " " + solver.name()).second;
      if (runs_.size() > kMostRuns)
        throw Error(fmt::format("{}: {}: more than {} runs; expected fewer scenes, values of axes, rungs or solvers",
                                source_, pointer, kMostRuns));
      if (!is_first && v.merged) continue;  // another scene of the study has become the same
      item.solvers.push_back(s);
      if (!is_first)
        throw Error(fmt::format("{}: {}: two runs are named {} with {}; labels must differ", source_, pointer,
                                in_quotes(item.scene.name), in_quotes(solver.name())));
    }
  }

  void add_pairs() {
    const auto add = [&](const Study::Item& item, const StudySolver& s, const json& pair, const char* name) {
      if (pair.is_null()) return;
      json row = {
          {"relation", pair["relation"]}, {"scene", item.scene.name}, {"solver", s.solver}, {"setting", s.label}};
      row["with"] = {{"scene", {item.scene.name}}, {"setting", {s.label}}};
      row["with"][name] = pair["with"];
      j_["pairs"].push_back(std::move(row));
    };
    for (const Study::Item& item : study_.scenes)
      for (const std::size_t k : item.solvers) {
        add(item, study_.solvers[k], item.pair, "scene");
        add(item, study_.solvers[k], study_.solvers[k].pair, "setting");
      }
  }

  /// Whether the quick form runs a scene with this solver: it may restrict a solver to some scenes.
  bool quick_runs(const StudySolver& s, const Words& labels) const {
    if (quick_.is_null() || !quick_["only"].contains(s.name())) return true;
    return chosen(quick_["only"][s.name()].get<Words>(), labels);
  }

  int group_of(const Scene& scene) {
    const bool by_scene = study_.protocol != "fps";
    const std::string key = by_scene ? scene.name : fmt::format("{} {}", scene.cloth.columns, scene.cloth.rows);
    return groups_.emplace(key, static_cast<int>(groups_.size())).first->second;
  }

  /// A word that selects nothing is treated as a spelling error.
  void check_words() const {
    const auto check = [&](const std::string& pointer, const json& words, const Words& known) {
      for (std::size_t k = 0; k < words.size(); ++k) {
        const auto word = words[k].get<std::string>();
        if (contains(known, word)) continue;
        throw Error(fmt::format("{}: {}/{}: {} names none{}", source_, pointer, k, in_quotes(word),
                                nearest_known(word, known)));
      }
    };
    const Words labels(labels_.begin(), labels_.end());
    for (std::size_t k = 0; k < j_["scenes"].size(); ++k)
      if (j_["scenes"][k].contains("pair"))
        check(fmt::format("/scenes/{}/pair/with", k), j_["scenes"][k]["pair"]["with"], labels);
    for (std::size_t s = 0; s < j_["solvers"].size(); ++s) {
      const json& solver = j_["solvers"][s];
      check(fmt::format("/solvers/{}/only", s), solver["only"], labels);
      Words settings;  // of this solver
      for (const json& other : j_["solvers"])
        if (other["solver"] == solver["solver"]) settings.push_back(other["label"].get<std::string>());
      if (solver.contains("pair")) check(fmt::format("/solvers/{}/pair/with", s), solver["pair"]["with"], settings);
    }
    if (!j_.contains("quick")) return;
    check("/quick/scenes", j_["quick"]["scenes"], labels);
    check("/quick/solvers", j_["quick"]["solvers"], solver_names_);
    for (const auto& [solver, scenes] : j_["quick"]["only"].items()) {
      check("/quick/only", json::array({solver}), solver_names_);
      check("/quick/only/" + solver, scenes, labels);
    }
  }

  json j_, quick_;  ///< quick_: null unless the quick form was requested
  const std::filesystem::path file_;
  const std::string source_;
  const StudyOptions& options_;
  Study study_;
  Words solver_names_;
  std::vector<bool> stays_;  ///< by solver index
  std::set<std::string> labels_, runs_;
  std::map<std::string, int> groups_;
};

}  // namespace

Study load_study(const std::string& name_or_path, const StudyOptions& options) {
  const std::filesystem::path file = find_scenario(name_or_path);
  const std::string source = file.string();
  json j = parse_json(read_text(file), source);
  validate_json(j, kStudySchema, source);
  fill_defaults(j, kStudySchema);
  return Builder(std::move(j), file, options).build();
}

}  // namespace clothbench
