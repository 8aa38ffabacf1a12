// Hot functions under Google Benchmark: a frame of every solver on small scenes, and the metrics of a frame. Build the
// target `benchmarks`; Google Benchmark's compare.py reads the output of `benchmarks --benchmark_format=json`.
#include <benchmark/benchmark.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "runner/frame_loop.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// One iteration is one frame, measured as the frame's wall time. The scene restarts at its end.
void time_frames(benchmark::State& state, const SolverEntry& entry, const std::string& scene_name) {
  const Scene scene = load_scene(scene_name);
  const auto solver = load_solver(entry, complete_settings(entry.info, nlohmann::json::object()), {}, scene);
  FrameLoop loop(*solver, scene,
                 {.frames = kAsManyAsItTakes, .drop_frames = scene.time.frames(), .interrupted = nullptr});
  double device_s = 0;
  for (auto unused : state) {
    (void)unused;
    const bool good = loop.next();
    state.SetIterationTime(loop.wall_s());
    if (!good) return state.SkipWithError("the solver failed");
    device_s += solver->last_cost().device_s;
  }
  if (std::isfinite(device_s)) state.counters["device_us"] = device_s / (loop.index() + 1) * 1e6;
}

/// Metrics of one frame in contact.
void time_metrics(benchmark::State& state, const std::string& scene_name) {
  const Scene scene = load_scene(scene_name);
  const SolverEntry& entry = find_solver("ballistic");
  const nlohmann::json settings = complete_settings(entry.info, nlohmann::json::object());
  const auto solver = load_solver(entry, settings, {}, scene);
  const MetricContext context{scene, entry, settings};
  ClothState cloth;
  for (FrameLoop loop(*solver, scene, {.frames = scene.time.frames() / 2, .interrupted = nullptr}); loop.next();) {
  }
  solver->read_state(cloth);
  for (auto unused : state) {
    (void)unused;
    MetricPass pass(context);
    pass.add(cloth);
    benchmark::DoNotOptimize(pass.take());
  }
}

void register_all() {
  for (const std::string scene : {"paper/gravity", "contact/sphere", "contact/self-fold"}) {
    const Scene loaded = load_scene(scene);
    for (const SolverEntry& entry : solvers())
      if (unsupported(entry.info, loaded.needs).empty())
        benchmark::RegisterBenchmark(("frame/" + scene + "/" + entry.info.name).c_str(),
                                     [=, &entry](benchmark::State& state) { time_frames(state, entry, scene); })
            ->UseManualTime()
            ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("metrics/" + scene).c_str(), [=](benchmark::State& state) {
      time_metrics(state, scene);
    })->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace
}  // namespace clothbench

int main(int argc, char** argv) {
  try {
    clothbench::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
  } catch (const clothbench::Error& e) {
    std::fprintf(stderr, "benchmarks: %s\n", e.what());
    return static_cast<int>(e.code());
  }
}
