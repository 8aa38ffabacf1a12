#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// One solver with one set of settings, as a study names it.
struct StudySolver {
  std::string solver, label;
  nlohmann::json settings;        ///< as given; `complete_settings` adds the rest
  std::vector<std::string> set;   ///< changes to the scenes for this solver alone, `dotted.key=JSON`
  std::vector<std::string> only;  ///< labels of the scenes it runs; empty: all
  bool joined = false;            ///< not of the study but of StudyOptions::solvers
  int work = 0;                   ///< product of its knobs on the ladder; 0: it climbs none
  bool all_on = false;            ///< every other feature it has switched on where it cannot matter (irrelevant.hpp)
  std::string name() const;       ///< as tables name it: "paper", "paper whole-room"
};

/// How long a trial is; the same words as in the file.
struct StudyRules {
  int frames = 0, min_frames = 0;
  double max_wall_s = 0, warmup_s = 0;
  double ladder_limit_s = 0, agree = 0;
};

/// Which of its protocols a study runs: trials as in its "short", "full" or "quick"; quick also leaves out scenes and
/// solvers.
enum class StudyLength { Short, Full, Quick };

struct StudyOptions {
  std::vector<std::string> overrides;  ///< applied to every scene, after everything the study says
  StudyLength length = StudyLength::Short;
  Assets assets = Assets::MayBeProcedural;
  /// Only these, if any. One that the study does not name joins it, with its default settings and every scene as it is.
  std::vector<std::string> solvers = {};
  /// Knobs by which such a solver climbs the study's ladder, where it has one; it does not without an entry here.
  std::map<std::string, std::vector<std::string>> knobs = {};
};

/// A study with its axes expanded. Runs of one `group` are interleaved: with the protocol fps those of one grid,
/// with penetration those of one scene.
struct Study {
  /// A scene in one form, and the solvers that run it so. A solver's own changes make another form of the same name.
  struct Item {
    Scene scene;  ///< name = base name and the labels of its axis values
    int group = 0;
    bool timed = true;                 ///< false: its runs have the accuracy pass alone
    std::vector<std::size_t> solvers;  ///< indices into Study::solvers
  };
  std::string name, why, protocol;
  StudyLength length = StudyLength::Short;
  std::vector<Item> scenes;
  std::vector<StudySolver> solvers;
  int trials = 0, drop_frames = 0;
  double accuracy_duration_s = 0;  ///< infinite: the whole scene
  double run_limit_s = 0;          ///< 0 = none
  bool stage_times = true, pipelined = false;
  StudyRules rules;           ///< of `length`
  nlohmann::json definition;  ///< completed study file
};

/// Loads a study by path or name ("table3"). Throws Error as `load_scene` does, and if the study has no "quick" where
/// that is asked for. Solver names are not looked up.
Study load_study(const std::string& name_or_path, const StudyOptions& = {});

/// True if the file is a study rather than a scene (has "protocol").
bool is_study(const std::string& name_or_path);

}  // namespace clothbench
