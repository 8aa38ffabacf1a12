#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "common/gpu_solver.hpp"
#include "sheets.hpp"
#include "solvers.hpp"

namespace clothbench::pbd_gpu {

/// Whether this case of a matrix runs now: every fifth in the quick tier, all with CLOTHBENCH_WHOLE_MATRIX=1 (the slow
/// tier's pbd_gpu.matrix). Compiling a pipeline takes a CPU device most of a second.
inline bool in_turn(std::size_t number) {
  constexpr std::size_t kEvery = 5;
  return std::getenv("CLOTHBENCH_WHOLE_MATRIX") != nullptr || number % kEvery == 0;
}

/// Every test runs under core and synchronization validation and fails if there is a message.
class Gpu : public ::testing::Test {
 protected:
  static DeviceOptions options() { return {-1, true}; }

  void SetUp() override {
    try {
      device_ = vulkan::Device::get(options());
    } catch (const Error& e) {
      if (may_lack_device(e)) GTEST_SKIP() << e.what();
      FAIL() << e.what();
    }
  }
  void TearDown() override {
    if (device_) {
      EXPECT_EQ(device_->messages(), std::vector<std::string>{});
    }
  }

  static std::unique_ptr<GpuSolver> make(const std::string& name,
                                         const nlohmann::json& given = nlohmann::json::object()) {
    return name == "paper" ? make_paper(complete_settings(paper_info(), given), options())
                           : make_xpbd(complete_settings(xpbd_info(), given), options());
  }

  /// The state at the end of the scene, computed by any solver.
  static ClothState end_of(const Scene& s, const std::string& solver, const nlohmann::json& settings) {
    const SolverEntry& e = find_solver(solver);
    const auto made = e.make(complete_settings(e.info, settings), solver == "xpbd" ? options() : DeviceOptions{});
    made->load(s);
    return after(*made, s, s.time.frames());
  }

  std::shared_ptr<vulkan::Device> device_;
};

}  // namespace clothbench::pbd_gpu
