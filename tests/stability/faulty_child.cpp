// Replaces `clothbench run-child`. Each solver fails at the load or in frame 3, in the way that its name says.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <new>
#include <thread>

#include "runner/study_runner.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

/// Falls freely until it fails.
class Faulty final : public StillSolver {
 public:
  using StillSolver::StillSolver;
  void load(const Scene& s) override {
    if (info_.name == "refuses") throw Error("solver refuses: no such cloth");
    if (info_.name == "no-memory") throw std::bad_alloc();
    StillSolver::load(s);
  }
  StepStatus step(const FrameInput& f) override {
    for (std::size_t k = 0; k < state_.position.size(); ++k)
      state_.position[k] += f.dt_s * (state_.velocity[k] += scene_->gravity_m_per_s2[k % 3] * f.dt_s);
    if (f.index != 2) return StepStatus::Ok;
    if (info_.name == "crashes") std::raise(SIGSEGV);
    if (info_.name == "aborts") {
      std::fprintf(stderr, "the assertion failed\n");
      std::fflush(stderr);
      std::abort();
    }
    if (info_.name == "says") std::fprintf(stderr, "something else\n");
    if (info_.name == "exits") std::_Exit(2);
    if (info_.name == "hangs")
      while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
    if (info_.name == "throws") throw std::runtime_error("thrown in a frame");
    if (info_.name == "loses-device") return StepStatus::DeviceLost;
    if (info_.name == "nan") state_.position[4] = std::numeric_limits<double>::quiet_NaN();
    return StepStatus::Ok;
  }
};

const SolverEntry* look_up(const std::string& name) {
  static std::map<std::string, SolverEntry> all;
  SolverEntry& entry = all[name];
  SolverInfo info;
  info.name = name;
  info.precision = "float64";
  info.ignores = all_features();
  entry.info = info;
  entry.make = [info](const nlohmann::json&, const DeviceOptions&) { return std::make_unique<Faulty>(info); };
  entry.free_fall_m = [](const Scene& s, const nlohmann::json&, int n) {
    const double h = s.time.dt();
    return s.gravity_m_per_s2[1] * h * h * n * (n + 1) / 2;
  };
  return &entry;
}

}  // namespace
}  // namespace clothbench

int main(int argc, char**) {
  if (argc != 2) return 64;
  using namespace clothbench;
  return run_child_main({{"plan", [](const nlohmann::json& request, const WorkerProgress& progress) {
                            return execute_plan(request, progress, look_up, nullptr);
                          }}});
}
