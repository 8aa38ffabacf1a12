#pragma once
#include <bitset>
#include <cstring>
#include <map>
#include <vector>

#include "vulkan/kernel.hpp"

namespace clothbench::vulkan {

/// A sequence of dispatches and copies, such as a frame; each has its stage. Barriers are placed only where a step
/// reads or writes a buffer that an earlier step wrote, or writes one that an earlier step read.
class Program {
 public:
  explicit Program(std::shared_ptr<Device> device);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  template <class Constants>
  void dispatch(int stage, const Kernel& kernel, Groups groups, const Constants& constants) {
    std::vector<std::uint8_t> bytes(sizeof constants);
    std::memcpy(bytes.data(), &constants, sizeof constants);
    steps_.push_back({stage, &kernel, groups, std::move(bytes), nullptr, nullptr});
  }
  void copy(int stage, const Buffer& from, const Buffer& to) { steps_.push_back({stage, nullptr, {}, {}, &from, &to}); }
  void clear() { steps_.clear(); }

  /// Records once; `run` submits the same commands repeatedly. With `time_stages` a timestamp follows every step;
  /// otherwise there are only a first and a last one.
  void record(bool time_stages);
  /// Submits and waits; after a time-out, first waits for the earlier submissions. Throws Failure (VK_TIMEOUT after
  /// `timeout_s`, VK_ERROR_DEVICE_LOST, ...).
  void run(double timeout_s);

  /// Repeats the last recording until there are `count` copies, so that as many can be in flight at once. Each copy has
  /// its own commands, fence and queries, and begins with a barrier against all earlier work, so copies run in order.
  void need_copies(std::size_t count);
  /// Submits a copy that is not in flight. Throws Failure.
  void submit(std::size_t copy);
  /// Waits until a copy is no longer in flight. Throws like `run`.
  void wait(std::size_t copy, double timeout_s);

  double device_s() const;                        ///< first to last timestamp of the last run; NaN without timestamps
  std::vector<double> stage_s(int stages) const;  ///< summed by stage; NaN unless recorded with time_stages
  int dispatches(int stage) const;

  /// The recorded commands, in order, so that a test finds missing and superfluous barriers.
  struct Recorded {
    // If `is_barrier`:
    bool is_barrier = false;
    VkPipelineStageFlags stages_before = 0, stages_after = 0;
    VkAccessFlags written = 0, next = 0;
    // Otherwise a dispatch of `kernel` or, if that is null, a copy:
    const Kernel* kernel = nullptr;
    const Buffer *from = nullptr, *to = nullptr;
  };
  const std::vector<Recorded>& recorded() const { return recorded_; }

 private:
  struct Step {
    int stage;
    const Kernel* kernel;
    Groups groups;
    std::vector<std::uint8_t> constants;
    const Buffer *from, *to;
  };
  using Buffers = std::bitset<128>;  ///< bit n: buffer n
  struct Touched {
    Buffers read, written;
  };
  Touched touched(const Step&);
  void barrier(VkPipelineStageFlags before, VkPipelineStageFlags after, VkAccessFlags written, VkAccessFlags next);
  /// `since`: accesses of the steps since the last barrier.
  void barrier_if_needed(const Touched& next, Touched& since);
  /// Objects that each submission in flight needs for itself.
  struct Copy {
    VkCommandBuffer commands = VK_NULL_HANDLE;  ///< reused by later recordings
    VkFence fence = VK_NULL_HANDLE;
    VkQueryPool queries = VK_NULL_HANDLE;
    bool in_flight = false;
  };
  void record_copy(std::size_t k);
  void record_steps(Copy&);
  void timestamp(VkQueryPool queries, std::uint32_t query);

  std::shared_ptr<Device> device_;
  std::vector<Step> steps_;
  std::map<const Buffer*, std::size_t> numbers_;
  std::map<const Kernel*, Touched> touched_by_;  ///< a kernel's bindings never change
  VkCommandBuffer commands_ = VK_NULL_HANDLE;    ///< being recorded
  std::vector<Copy> copies_;
  std::size_t recorded_copies_ = 0;  ///< the copies before this index hold the last recording
  std::uint32_t query_count_ = 0;
  bool time_stages_ = false;
  std::vector<Recorded> recorded_;
  std::vector<std::uint64_t> ticks_;
};

}  // namespace clothbench::vulkan
