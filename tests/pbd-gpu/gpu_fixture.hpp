#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "common/gpu_solver.hpp"
#include "sheets.hpp"

namespace clothbench::pbd_gpu {

/// Whether the case of this number in a matrix is run now: every fifth in the quick tier, each with
/// CLOTHBENCH_WHOLE_MATRIX=1 (the slow tier's pbd_gpu.matrix). A pipeline takes a CPU device a good part of a second.
inline bool in_turn(std::size_t number) {
  constexpr std::size_t kEvery = 5;
  return std::getenv("CLOTHBENCH_WHOLE_MATRIX") != nullptr || number % kEvery == 0;
}

/// Every test runs under core and synchronization validation and ends with no message.
class Gpu : public ::testing::Test {
 protected:
  static DeviceOptions options() { return {-1, true}; }

  void SetUp() override {
    try {
      device_ = vulkan::Device::get(options());
    } catch (const Error& e) {
      const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
      if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
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

  /// The same bits from a second solver, and after a reset.
  static void expect_repeats(const Scene& s, int frames, const nlohmann::json& given = nlohmann::json::object());

  std::shared_ptr<vulkan::Device> device_;
};

inline void Gpu::expect_repeats(const Scene& s, int frames, const nlohmann::json& given) {
  const auto one = make("xpbd", given), two = make("xpbd", given);
  one->load(s);
  two->load(s);
  const ClothState a = after(*one, s, frames), b = after(*two, s, frames);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  one->reset();
  EXPECT_EQ(after(*one, s, frames).position, a.position) << "reset restores everything";
}

}  // namespace clothbench::pbd_gpu
