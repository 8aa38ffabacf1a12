#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "xr/loop.hpp"

namespace clothbench::xr {

nlohmann::json loop_json(const LoopResult& r) {
  return {{"file", r.file.string()},
          {"scenario", r.scenario.string()},
          {"status", r.outcome.status},
          {"message", r.outcome.message},
          {"summary", r.summary}};
}

std::string loop_text(const LoopResult& r) {
  const auto of = [&](const char* name) { return r.summary.contains(name) ? r.summary.at(name) : kMissing; };
  return fmt::format("{:.0f} frames: {}\n", of("xr_frames"), r.outcome.status) +
         fmt::format("frames a second    median {:.1f}   mean {:.1f}   worst {:.1f}\n", of("xr_fps_median"),
                     of("xr_fps_mean"), of("xr_fps_worst")) +
         fmt::format("shown after        1 period {:.1f} %   2 {:.1f} %   3 {:.1f} %   more {:.1f} %\n",
                     100 * of("xr_share_1_period"), 100 * of("xr_share_2_periods"), 100 * of("xr_share_3_periods"),
                     100 * of("xr_share_more_periods")) +
         fmt::format("step               median {:.3f} ms   99 % {:.3f} ms   on the device {:.3f} ms\n",
                     1e3 * of("xr_step_median_s"), 1e3 * of("xr_step_p99_s"), 1e3 * of("xr_step_device_median_s")) +
         fmt::format("both pictures      median {:.3f} ms on the device\n", 1e3 * of("xr_paint_device_median_s")) +
         fmt::format("results in {}; the session replays with: clothbench run {}\n", r.file.string(),
                     r.scenario.string());
}

}  // namespace clothbench::xr
