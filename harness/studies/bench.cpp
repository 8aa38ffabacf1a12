// The runs of Table 3 under Google Benchmark: one benchmark a run, one iteration a frame, the clock is the frame's wall
// time.
#include "studies/bench.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>

#include "runner/environment.hpp"
#include "runner/frame_loop.hpp"
#include "runner/study_plan.hpp"

namespace clothbench {
namespace {

/// Fixed, so that a slow clock cannot make the library repeat a run for minutes.
constexpr int kFrames = 72;

/// False where the solver failed.
bool execute_run(benchmark::State& state, const RunSpec& spec, const DeviceOptions& device) {
  const auto solver = load_solver(*spec.entry, spec.settings, device, *spec.scene);
  double device_s = 0;
  FrameLoop loop(*solver, *spec.scene, {.frames = kAsManyAsItTakes, .interrupted = nullptr});
  for (auto unused : state) {
    (void)unused;
    const bool good = loop.next();
    state.SetIterationTime(loop.wall_s());
    if (!good) {
      state.SkipWithError("the solver failed");
      break;
    }
    device_s += solver->last_cost().device_s;
  }
  const Plan plan = solver->plan();
  double read_B = 0, write_B = 0;
  for (const StagePlan& s : plan.stages) {
    read_B += s.read_B;
    write_B += s.write_B;
  }
  state.counters["fps"] = benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate);
  // Not there for CPU solvers rather than zero.
  if (std::isfinite(device_s)) state.counters["device_us"] = device_s / (loop.index() + 1) * 1e6;
  if (std::isfinite(read_B)) state.counters["read_B"] = read_B;
  if (std::isfinite(write_B)) state.counters["write_B"] = write_B;
  return !loop.failed();
}

void add_context(const RunPlan& plan, const DeviceOptions& options) {
  DeviceInfo device;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (c.entry->info.on_gpu && device.name.empty()) device = c.entry->make(c.settings, options)->device();
  const nlohmann::json e = describe_environment(device, "bench");
  for (const char* key :
       {"gpu", "driver", "gpu_is_software", "cpu", "compiler", "shader_compiler", "git_commit", "version"})
    benchmark::AddCustomContext(std::string("clothbench_") + key,
                                e[key].is_string() ? e[key].get<std::string>() : e[key].dump());
  // The library's own field tells how the library was built, not this program.
  benchmark::AddCustomContext("clothbench_build_type", e["build_type"].get<std::string>());
}

}  // namespace

bool bench(const std::string& study_name, const DeviceOptions& device, std::vector<std::string> words) {
  words.insert(words.begin(), "clothbench");
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw Error(std::string("bench: unknown argument ") + argv[1]);
  const Study study = load_study(study_name);
  const RunPlan plan = plan_study(study);
  add_context(plan, device);
  benchmark::ClearRegisteredBenchmarks();  // those of an earlier command of this process
  bool good = true;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group) {
      if (!unsupported(c.entry->info, c.scene->needs).empty()) continue;
      benchmark::RegisterBenchmark(
          fmt::format("{}/{}/{}", c.scene->name, c.entry->info.name, c.setting).c_str(),
          [&c, &good, &device](benchmark::State& state) { good = execute_run(state, c, device) && good; })
          ->UseManualTime()
          ->Iterations(kFrames)
          ->Unit(benchmark::kMicrosecond);
    }
  const std::size_t matched = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  if (matched == 0)
    throw Error("bench: --benchmark_filter matches no run of study " + study.name +
                " that a solver of this build supports");
  return good;
}

}  // namespace clothbench
