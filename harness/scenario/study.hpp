#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// One solver with one set of settings, as a study names it.
struct StudySolver {
  std::string solver, label;
  nlohmann::json settings;  ///< as given; `complete_settings` adds the rest
};

/// How long a trial is; the same words as in the file.
struct StudyRules {
  int frames = 0, min_frames = 0;
  double max_wall_s = 0, warmup_s = 0;
};

/// A study with its axes expanded. Scenes of one `group` have the same grid; their cells are run interleaved.
struct Study {
  struct Item {
    Scene scene;  ///< name = base name and the labels of its axis values
    int group = 0;
  };
  std::string name, why, protocol;
  std::vector<Item> scenes;
  std::vector<StudySolver> solvers;
  int trials = 0, drop_frames = 0;
  double accuracy_duration_s = 0;
  StudyRules short_rules, full_rules;
  nlohmann::json definition;  ///< completed study file
};

/// Loads a study by path or name ("table3"). Throws Error as `load_scene` does. Solver names are not looked up.
/// `overrides` are applied to every scene after its axes.
Study load_study(const std::string& name_or_path, const std::vector<std::string>& overrides = {});

/// True if the file is a study rather than a scene (has "protocol").
bool is_study(const std::string& name_or_path);

}  // namespace clothbench
