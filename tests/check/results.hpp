#pragma once
#include "../report/fake_runs.hpp"

namespace clothbench {

/// A desk drop as the runner stores it: penetration scalars, stages, a scene of 0.5 m x 0.5 m.
inline RunRecord contact_run(const std::string& scene = "desk", const std::string& solver = "xpbd") {
  RunRecord c = fake_run(solver, 32, "double", 0.01);
  c.header.scene = scene;
  c.header.scenario_json = R"({"cloth":{"grid":[32,32],"size_m":[0.5,0.75]}})";
  c.header.scenario_sha256 = "a0b1c2d3e4f5";
  c.header.stages = {{"Predict", {}, 1}, {"Solve", {"stretch", "shear"}, 10}, {"Contact", {"static_mesh"}, 3}};
  c.summary["dispatches"] = 14;
  c.summary["contact_length_settled_m"] = 0;
  c.summary["contact_length_max_m"] = 0.1;
  c.summary["crossings_max"] = 0;
  c.summary["depth_max_m"] = 0.003;
  c.summary["slip_m"] = kMissing;
  c.summary["stretch_max"] = 0.02;
  c.summary["stretch_max_end"] = 0.01;
  c.summary["expect.crossings_max"] = 1;
  c.summary["expect.depth_max_m"] = 0;
  return c;
}

inline RunRecord with(RunRecord c, const std::string& name, double value) {
  c.summary[name] = value;
  return c;
}

inline RunRecord ended(RunRecord c, const std::string& status, const std::string& klass = "ok", int frame = -1) {
  c.outcome = {status, klass, frame, status == "ok" ? "" : "what the solver said"};
  return c;
}

/// A planned run without a file, as `collect` returns it: only its file name is known.
inline RunRecord planned(const RunRecord& of) {
  RunRecord c;
  c.header.scene = of.header.scene;
  c.header.solver = of.header.solver;
  c.header.setting = of.header.setting;
  c.outcome = {"missing", "ok", -1, "planned, not run"};
  return c;
}

}  // namespace clothbench
