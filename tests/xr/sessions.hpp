#pragma once
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "base/json_text.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"
#include "xr/loop.hpp"

namespace clothbench::xr {

/// Sessions on the null runtime in a folder that the test removes at its end.
class Sessions : public WithFolder {
 protected:
  Sessions() {
    setenv("CLOTHBENCH_ASSETS", "procedural", 1);  // the same everywhere
    setenv("XR_RUNTIME_JSON", CLOTHBENCH_NULL_RUNTIME, 1);
  }

  LoopOptions options(const std::string& scenario, int frames, const std::string& solver = "xpbd") const {
    LoopOptions o;
    o.scenario = scenario;
    o.overrides = {"cloth.grid=[12,12]"};
    o.entry = &find_solver(solver);
    o.settings = complete_settings(o.entry->info, nlohmann::json::object());
    o.frames = frames;
    o.timeout_s = 20;
    o.out = dir_ / "out";
    return o;
  }

  /// `script` as in tests/xr/null_runtime/runtime.hpp.
  LoopResult run(const LoopOptions& o, const std::string& script) {
    const std::string log = (dir_ / "runtime.json").string();
    setenv("CLOTHBENCH_NULL_XR", (script + ",log=" + log).c_str(), 1);
    LoopResult r = run_loop(o);
    reported_ = parse_json(read_text(log), log);
    EXPECT_EQ(reported_["faults"], nlohmann::json::array()) << "what a strict runtime complains of";
    EXPECT_EQ(r.validation_messages, 0);
    EXPECT_EQ(r.outcome.status, "ok") << r.outcome.message;
    return r;
  }

  /// Positions at the end of a scenario, run as on a desktop.
  static std::vector<double> replayed(const LoopResult& live, const LoopOptions& o) {
    const Scene scene = load_scene(live.scenario.string());
    const auto solver = o.entry->make(o.settings, {});
    solver->load(scene);
    for (int k = 0; k < scene.time.frames(); ++k)
      EXPECT_EQ(solver->step({k, scene.time.at(k + 1), scene.time.dt_after(k), scene.motion_after(k)}), StepStatus::Ok);
    EXPECT_EQ(scene.time.frames(), static_cast<int>(live.log.rows().size()));
    ClothState state;
    solver->read_state(state);
    return state.position;
  }

  nlohmann::json reported_;  ///< by the runtime, when its instance ends
};

}  // namespace clothbench::xr
