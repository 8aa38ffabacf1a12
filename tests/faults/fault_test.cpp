// Every Vulkan call of a small run that may fail is made to fail, once or permanently. The run must end in a row or in
// an error that names the cause, keep what was finished before, leak no object, and continue to bit-identical results.
// With CLOTHBENCH_ALL_FAULTS every call with every result, otherwise every fifth call with one result.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "solvers.hpp"
#include "vulkan/device.hpp"
#include "vulkan_faults.hpp"
#include "with_folder.hpp"

// Leaks of the driver: LLVM keeps compiled code.
extern "C" const char* __lsan_default_suppressions() { return "leak:libvulkan_lvp\nleak:libLLVM\nleak:libvulkan.so\n"; }

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr VkResult kResults[] = {VK_ERROR_DEVICE_LOST, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_INITIALIZATION_FAILED,
                                 VK_TIMEOUT};
constexpr int kTrials = 2;

class Faults : public WithFolder, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    try {
      vulkan::Device::get({});
    } catch (const Error& e) {
      if (may_lack_device(e)) GTEST_SKIP() << e.what();
      FAIL() << e.what();
    }
    plan_.protocol = "test";
    plan_.rules.trials = kTrials;
    plan_.rules.frames = 2;
    plan_.rules.warmup_s = 0;
    plan_.rules.accuracy_duration_s = 3.0 / 60;
    plan_.rules.profiled_frames = 0;
    plan_.groups = {
        {{&scene_, &find_solver(GetParam()), complete_settings(find_solver(GetParam()).info, {}), "default"}}};
  }
  void TearDown() override { faults::disarm(); }

  /// Discards the existing device, so that creating one is part of the run.
  static void forget_device() { vulkan::Device::get({})->mark_lost(); }

  RunResult run(const std::string& folder, bool resume = false) {
    RunOptions options;
    options.out = dir_ / folder;
    options.resume = resume;
    fs::create_directories(options.out);
    return execute_runs(plan_, options);
  }

  static void expect_same(const RunRecord& a, const RunRecord& b) {
    ASSERT_EQ(a.accuracy.position.size(), b.accuracy.position.size());
    // paper's atomic sums have no fixed order, so positions may differ by some float32 rounding steps of coordinates.
    const float off = std::string(GetParam()) == "paper" ? 1e-5F : 0;
    for (std::size_t k = 0; k < a.accuracy.position.size(); ++k)
      ASSERT_LE(std::abs(a.accuracy.position[k] - b.accuracy.position[k]), off) << "number " << k;
    ASSERT_EQ(a.trials.size(), b.trials.size());
    for (std::size_t k = 0; k < a.trials.size(); ++k) EXPECT_EQ(a.trials[k].frames(), b.trials[k].frames());
  }

  /// Result of one refused call.
  void inject(int call, VkResult result, bool sticky, const RunRecord& right) {
    const std::string folder = std::to_string(call) + "_" + std::to_string(result) + (sticky ? "s" : "");
    forget_device();
    const auto alive_before = faults::alive();
    std::string error;
    RunResult got;
    faults::arm(call, result, sticky);
    try {
      got = run(folder);
    } catch (const Error& e) {
      error = e.what();
    }
    const std::string failed = faults::failed_call();
    faults::disarm();
    SCOPED_TRACE(failed + ", call " + std::to_string(call) + " of the run, gave " + std::to_string(result) +
                 (sticky ? ", like every later call" : ""));
    ASSERT_FALSE(failed.empty());
    if (error.empty()) {
      ASSERT_EQ(got.files.size(), 1u);
      const RunRecord found = read_run(got.files[0]);
      const std::set<std::string> rows = {"ok", "device_lost", "timed_out"};
      EXPECT_TRUE(rows.contains(found.outcome.status)) << found.outcome.status << " " << found.outcome.message;
      EXPECT_EQ(found.outcome.message.empty(), found.outcome.status == "ok");
      if (found.outcome.status == "ok") expect_same(found, right);
      for (const TimedTrial& t : found.trials) EXPECT_LE(t.frames(), right.trials[0].frames());
    } else {
      EXPECT_TRUE(error.find("vk") != std::string::npos || error.find("Vulkan") != std::string::npos) << error;
    }
    // The same process continues to the same end: finished trials are read, not repeated.
    const RunResult again = run(error.empty() ? folder + "_again" : folder, !error.empty());
    ASSERT_EQ(again.files.size(), 1u);
    expect_same(read_run(again.files[0]), right);
    forget_device();
    vulkan::Device::get({});
    EXPECT_EQ(faults::alive(), alive_before);
    fs::remove_all(dir_ / folder);
    fs::remove_all(dir_ / (folder + "_again"));
  }

  /// Number of calls of a run without faults, and its result.
  std::pair<int, RunRecord> undisturbed() {
    forget_device();
    faults::disarm();
    const RunResult result = run("right");
    return {faults::calls(), read_run(result.files.at(0))};
  }

  const Scene scene_ = load_scene(
      "paper/gravity", {"cloth.grid=[5,4]", "time.frame_rate_hz=60", "pins=[{\"edge\":\"u0\"}]", "cloth.sides=single"});
  const bool all_ = std::getenv("CLOTHBENCH_ALL_FAULTS") != nullptr;
  RunPlan plan_;
};

TEST_P(Faults, EveryCallThatFailsOnceIsARowOrANamedError) {
  const auto [calls, right] = undisturbed();
  ASSERT_EQ(right.outcome.status, "ok") << right.outcome.message;
  ASSERT_EQ(right.trials.size(), static_cast<std::size_t>(kTrials));
  ASSERT_GT(calls, 50);
  std::printf("%d calls\n", calls);
  RecordProperty("calls", calls);
  for (int call = 0; call < calls; call += all_ ? 1 : 5)
    for (std::size_t k = 0; k < std::size(kResults); ++k)
      if (all_ || k == static_cast<std::size_t>(call / 5) % std::size(kResults))
        inject(call, kResults[k], false, right);
}

TEST_P(Faults, ADeviceThatStaysLostIsARowOrANamedError) {
  const auto [calls, right] = undisturbed();
  for (int call = 0; call < calls; call += all_ ? 1 : 23)
    inject(call, kResults[static_cast<std::size_t>(call) % 2], true, right);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Faults, ::testing::Values("xpbd", "paper"),
                         [](const auto& p) { return std::string(p.param); });

TEST(FaultTable, HasEveryCallOfTheSolver) {
  std::set<std::string> known;
  for (const std::string& name : faults::names()) known.insert(name);
  // Calls that return no result.
  const std::regex cannot_fail("vk(Cmd|Get(Physical|Device|Buffer|InstanceProcAddr)|UpdateDescriptorSets).*");
  const std::regex call("\\bvk[A-Z][A-Za-z0-9]*(?=\\()");
  int found = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLOTHBENCH_SOURCE_DIR) / "solvers/pbd-gpu")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const std::string source = text.str();
    for (std::sregex_iterator at(source.begin(), source.end(), call), end; at != end; ++at) {
      ++found;
      const std::string name = at->str();
      EXPECT_TRUE(known.contains(name) || std::regex_match(name, cannot_fail)) << name << " in " << entry.path();
    }
  }
  EXPECT_GT(found, 40);
}

}  // namespace
}  // namespace clothbench
