// A live session whose device is lost: the frames so far are stored and can be replayed, and the error is reported.
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <cmath>
#include <set>

#include "results/store.hpp"
#include "sessions.hpp"

namespace {

/// A device that is lost after this number of calls that submit or wait (-1: never) and stays lost. Its work is
/// finished by then.
struct {
  int calls_left = -1;
  bool lost = false;
  std::string by;
} device;

/// Whether this call finds the device lost; once, `finish` lets it finish its work.
template <class Fn>
bool goes(const char* call, Fn finish) {
  if (device.lost) return true;
  if (device.calls_left < 0 || device.calls_left-- > 0) return false;
  finish();
  device.by = call;
  return device.lost = true;
}

}  // namespace

// The linker puts these between this program and Vulkan (-Wl,--wrap). The null runtime makes its calls itself.
extern "C" {
VkResult __real_vkQueueSubmit(VkQueue, uint32_t, const VkSubmitInfo*, VkFence);
VkResult __real_vkWaitForFences(VkDevice, uint32_t, const VkFence*, VkBool32, uint64_t);
VkResult __wrap_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
  if (goes("vkQueueSubmit", [&] { vkQueueWaitIdle(queue); })) return VK_ERROR_DEVICE_LOST;
  return __real_vkQueueSubmit(queue, count, submits, fence);
}
VkResult __wrap_vkWaitForFences(VkDevice of, uint32_t count, const VkFence* fences, VkBool32 all, uint64_t timeout) {
  if (goes("vkWaitForFences", [&] { vkDeviceWaitIdle(of); })) return VK_ERROR_DEVICE_LOST;
  return __real_vkWaitForFences(of, count, fences, all, timeout);
}
}

namespace clothbench::xr {
namespace {

class Loss : public Sessions {
 protected:
  ~Loss() override { device = {}; }

  /// The device is lost `calls` calls after the session begins.
  LoopResult lost_after(LoopOptions o, int calls) {
    o.tell = [calls](const std::string& text) {
      if (text.ends_with(" Hz")) device.calls_left = calls;
    };
    const LoopResult r = run_loop(o);
    failed_ = device.by;
    device = {};
    return r;
  }

  static void expect_stored(const LoopResult& r, const LoopOptions& o) {
    EXPECT_EQ(r.outcome.status, "device_lost") << r.outcome.message;
    EXPECT_FALSE(r.outcome.message.empty());
    ASSERT_GT(r.log.rows().size(), 5u);
    ASSERT_LT(r.log.rows().size(), 60u);
    const RunRecord stored = read_run(r.file);
    EXPECT_EQ(stored.outcome.status, "device_lost");
    EXPECT_EQ(stored.outcome.klass, "F3");
    ASSERT_EQ(stored.trials.size(), 1u);
    EXPECT_EQ(stored.trials[0].frame_wall_s.size(), r.log.rows().size());
    EXPECT_EQ(stored.summary.at("xr_frames"), static_cast<double>(r.log.rows().size()));
    for (const double x : replayed(r, o))
      ASSERT_TRUE(std::isfinite(x)) << "as many frames as were logged, and each of them runs";
  }

  std::string failed_;
};

/// A step submits and waits, and so does rendering: the device is lost at each of the four calls.
TEST_F(Loss, WhereverInAFrame) {
  const LoopOptions o = options("paper/capsule-sweep", 60);
  std::set<std::string> failed;
  for (int calls = 40; calls < 44; ++calls) {
    SCOPED_TRACE(calls);
    const LoopResult r = lost_after(o, calls);
    expect_stored(r, o);
    EXPECT_TRUE(std::isnan(r.final_position_m.at(0))) << "the device had them";
    failed.insert(failed_);
    std::filesystem::remove_all(o.out);
  }
  EXPECT_EQ(failed, (std::set<std::string>{"vkQueueSubmit", "vkWaitForFences"}));
}

TEST_F(Loss, OfPicturesAlone) {
  const LoopOptions o = options("paper/gravity", 60, "ballistic");
  const LoopResult r = lost_after(o, 40);
  expect_stored(r, o);
  EXPECT_EQ(replayed(r, o), r.final_position_m) << "a solver on the CPU has lost nothing";
}

}  // namespace
}  // namespace clothbench::xr
