#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// One solver with one set of settings, as a study names it.
struct StudySolver {
  std::string solver, label;
  nlohmann::json settings;                        ///< only those given; `complete_settings` adds the defaults
  std::vector<std::string> set;                   ///< changes to the scenes for this solver only, `dotted.key=JSON`
  nlohmann::json tags = nlohmann::json::array();  ///< tags of the scenes that it runs; empty: all
  bool joined = false;                            ///< added by StudyOptions::solvers, not by the study
  int work = 0;                                   ///< product of its sweep settings; 0: not in the settings sweep
  std::string name() const;                       ///< name in tables: "paper", "paper readback=blocking"
};

/// Length of a trial, and the rule for ending trials early. Member names as in the file.
struct StudyRules {
  int frames = 0, min_frames = 0;
  double max_wall_s = 0, warmup_s = 0;
  double agree = 0;
};

/// The quick form has fewer scenes and solvers, and shorter trials.
enum class StudyLength { Full, Quick };

struct StudyOptions {
  std::vector<std::string> overrides;  ///< applied to every scene after all changes by the study
  StudyLength length = StudyLength::Full;
  Assets assets = Assets::MayBeProcedural;
  /// If not empty, only these solvers run. Those that the study lacks get default settings and unchanged scenes.
  std::vector<std::string> solvers = {};
  /// Settings that the study's sweep, if any, varies for such an added solver; a solver without an entry is not varied.
  std::map<std::string, std::vector<std::string>> knobs = {};
  /// For protocol contact: generate the scenes of the seeds seed, seed + 1, ... Default: 1.
  std::optional<std::uint64_t> seed = {};
  int count = 0;  ///< number of seeds; 0: the study's number
};

/// A study with its axes expanded. The runs of one `group` are interleaved; with protocol fps these are all runs on one
/// grid, otherwise all runs of one scene.
struct Study {
  /// One form of a scene, and the solvers that run it. A solver's own changes make another form with the same name.
  struct Item {
    Scene scene;  ///< name = base name and the labels of its axis values
    int group = 0;
    std::vector<std::size_t> solvers;  ///< indices into Study::solvers
    /// Random settings by solver, sampled with the scene; they replace the study's settings.
    nlohmann::json drawn_settings = nlohmann::json::object();
  };
  std::string name, why, protocol;
  StudyLength length = StudyLength::Full;
  std::vector<Item> scenes;
  std::vector<StudySolver> solvers;
  int trials = 0, drop_frames = 0;
  double accuracy_duration_s = 0;  ///< infinite: the whole scene
  double run_limit_s = 0;          ///< 0 = none
  bool pipelined = false;
  StudyRules rules;           ///< rules that belong to `length`
  nlohmann::json definition;  ///< the file with its defaults filled in
};

/// Loads a study by path or name ("table3"). Throws Error as `load_scene` does, and if the quick form is requested but
/// not defined. Solver names are not looked up.
Study load_study(const std::string& name_or_path, const StudyOptions& = {});

/// True for protocol contact, whose scenes are generated from --seed.
bool is_drawn(const Study&);

/// True if the file is a study rather than a scene (has "protocol").
bool is_study(const std::string& name_or_path);
/// True if the file is a study of this protocol.
bool is_study_of(const std::string& name_or_path, const std::string& protocol);

/// Maximum number of runs of a study: each is a file, and all are planned before the first begins.
inline constexpr std::size_t kMostRuns = 100000;

}  // namespace clothbench
