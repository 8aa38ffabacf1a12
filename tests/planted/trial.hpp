#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "shader_variant.hpp"

namespace clothbench {

/// A scene and the solver that runs it.
struct Stage {
  std::string name;
  Scene scene;
  SolverEntry entry;
  int trials = 0;
  nlohmann::json settings = nlohmann::json::object();
};

/// One fault. Exactly one of the optional members and functions is set.
struct Fault {
  std::string name, stage;
  // In the solver: a kernel, its input, its output, or its declarations.
  std::optional<ShaderFault> shader = {};
  std::function<void(Scene&)> scene = {};
  std::function<void(const Scene&, FrameInput&)> input = {};
  std::function<void(int frame, ClothState&)> state = {};
  std::function<StepStatus(int frame)> status = {};
  std::function<void(Plan&)> plan = {};
  std::function<void(nlohmann::json&)> settings = {};
  // In the metrics: the scene that they get, or their results for a pass.
  std::function<void(Scene&)> metric_scene = {};
  std::function<void(AccuracyPass&)> metrics = {};
  // In the stored record of the run.
  std::function<void(RunRecord&)> record = {};
};

/// Small scenes that can run many times and together use every part of the solver that has a planted fault.
std::vector<Stage> stages();
std::vector<Fault> faults();

/// Executes the stage, with the fault if one is given, and returns the record of the run.
RunRecord execute_run(const Stage&, const Fault* fault = nullptr);

}  // namespace clothbench
