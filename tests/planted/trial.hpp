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

/// One thing that is wrong. Only one of the members that name its place is filled.
struct Fault {
  std::string name, stage;
  // In the solver: a kernel, what it is given, what it gives back, what it says of itself.
  std::optional<ShaderFault> shader = {};
  std::function<void(Scene&)> scene = {};
  std::function<void(const Scene&, FrameInput&)> input = {};
  std::function<void(int frame, ClothState&)> state = {};
  std::function<StepStatus(int frame)> status = {};
  std::function<void(Plan&)> plan = {};
  std::function<void(nlohmann::json&)> settings = {};
  // In the metrics: the scene they are reported, or what they make of a pass.
  std::function<void(Scene&)> metric_scene = {};
  std::function<void(AccuracyPass&)> metrics = {};
  // In what is kept of the run.
  std::function<void(RunRecord&)> record = {};
};

/// Scenes that are small enough to be run again and again, and need every part of a solver that faults are planted in.
std::vector<Stage> stages();
std::vector<Fault> faults();

/// The run as its execution leaves it, with the fault if there is one.
RunRecord execute_run(const Stage&, const Fault* fault = nullptr);

}  // namespace clothbench
