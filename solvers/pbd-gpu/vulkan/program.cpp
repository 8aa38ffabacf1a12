#include "vulkan/program.hpp"

#include <algorithm>

#include "clothbench/record.hpp"

namespace clothbench::vulkan {
namespace {

constexpr VkPipelineStageFlags kWork = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
constexpr VkAccessFlags kWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags kAll = kWrites | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;

}  // namespace

Program::Program(std::shared_ptr<Device> device) : device_(std::move(device)) {}

Program::~Program() {
  // A run that timed out may still be in flight.
  vkDeviceWaitIdle(device_->handle());
  for (const Copy& c : copies_) {
    vkDestroyQueryPool(device_->handle(), c.queries, nullptr);
    vkDestroyFence(device_->handle(), c.fence, nullptr);
    if (c.commands != VK_NULL_HANDLE) vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &c.commands);
  }
}

Program::Touched Program::touched(const Step& s) {
  const auto bit = [&](auto* b) { return Buffers().set(numbers_.try_emplace(b, numbers_.size()).first->second); };
  if (s.kernel == nullptr) return {bit(s.from), bit(s.to)};
  const auto [known, is_new] = touched_by_.try_emplace(s.kernel);
  Touched& t = known->second;
  if (!is_new) return t;
  for (const Binding& b : s.kernel->bindings()) {
    if (b.access != Access::Write) t.read |= bit(b.buffer);
    if (b.access != Access::Read) t.written |= bit(b.buffer);
  }
  return t;
}

void Program::barrier(VkPipelineStageFlags before, VkPipelineStageFlags after, VkAccessFlags written,
                      VkAccessFlags next) {
  VkMemoryBarrier memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  memory.srcAccessMask = written;
  memory.dstAccessMask = next;
  vkCmdPipelineBarrier(commands_, before, after, 0, 1, &memory, 0, nullptr, 0, nullptr);
  recorded_.push_back({true, before, after, written, next, nullptr, nullptr, nullptr});
}

void Program::barrier_if_needed(const Touched& next, Touched& since) {
  if (((since.written & (next.read | next.written)) | (since.read & next.written)).any()) {
    barrier(kWork, kWork, kWrites, kAll);
    since = {};
  }
  since.read |= next.read;
  since.written |= next.written;
}

void Program::timestamp(VkQueryPool queries, std::uint32_t query) {
  if (query_count_ > 0) vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries, query);
}

void Program::record(bool time_stages) {
  time_stages_ = time_stages;
  query_count_ = !device_->has_timestamps() ? 0 : time_stages ? static_cast<std::uint32_t>(steps_.size()) + 1 : 2;
  recorded_copies_ = 0;
  need_copies(1);
}

void Program::need_copies(std::size_t count) {
  while (recorded_copies_ < count) record_copy(recorded_copies_++);
}

void Program::record_copy(std::size_t k) {
  if (copies_.size() == k) {
    copies_.emplace_back();
    copies_.back().fence = make_fence(*device_);
    copies_.back().commands = make_commands(*device_);
  }
  Copy& copy = copies_[k];
  vkDestroyQueryPool(device_->handle(), copy.queries, nullptr);
  copy.queries = VK_NULL_HANDLE;
  if (query_count_ > 0) copy.queries = make_timestamps(*device_, query_count_);
  recorded_.clear();
  record_steps(copy);
}

void Program::record_steps(Copy& copy) {
  commands_ = copy.commands;
  begin(commands_);
  if (query_count_ > 0) vkCmdResetQueryPool(commands_, copy.queries, 0, query_count_);
  // Waits for all accesses of earlier submissions. Host writes before a submission are visible to it without a barrier.
  barrier(kWork, kWork, kWrites, kAll);
  timestamp(copy.queries, 0);
  Touched since, all;
  const Kernel* bound = nullptr;
  for (std::uint32_t k = 0; k < steps_.size(); ++k) {
    const Step& s = steps_[k];
    const Touched t = touched(s);
    barrier_if_needed(t, since);
    all.written |= t.written;
    if (s.kernel != nullptr) {
      if (bound != s.kernel) s.kernel->bind(commands_);
      bound = s.kernel;
      s.kernel->push(commands_, s.constants);
      vkCmdDispatch(commands_, s.groups.x, s.groups.y, 1);
    } else {
      const VkBufferCopy region{0, 0, std::min(s.from->bytes(), s.to->bytes())};
      vkCmdCopyBuffer(commands_, s.from->handle(), s.to->handle(), 1, &region);
    }
    recorded_.push_back({false, 0, 0, 0, 0, s.kernel, s.from, s.to});
    if (time_stages_) timestamp(copy.queries, k + 1);
  }
  if (!time_stages_) timestamp(copy.queries, 1);
  // Makes writes to host buffers visible before the host reads them.
  const bool for_host = std::any_of(numbers_.begin(), numbers_.end(), [&](const auto& n) {
    return all.written[n.second] && n.first->place() == Buffer::Place::Host;
  });
  if (for_host) barrier(kWork, VK_PIPELINE_STAGE_HOST_BIT, kWrites, VK_ACCESS_HOST_READ_BIT);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

void Program::wait(std::size_t k, double timeout_s) {
  Copy& copy = copies_.at(k);
  if (!copy.in_flight) return;
  check(vkWaitForFences(device_->handle(), 1, &copy.fence, VK_TRUE, static_cast<std::uint64_t>(timeout_s * 1e9)),
        "vkWaitForFences");
  copy.in_flight = false;
  check(vkResetFences(device_->handle(), 1, &copy.fence), "vkResetFences");
  if (query_count_ == 0) return;
  ticks_.resize(query_count_);
  check(vkGetQueryPoolResults(device_->handle(), copy.queries, 0, query_count_, ticks_.size() * 8, ticks_.data(), 8,
                              VK_QUERY_RESULT_64_BIT),
        "vkGetQueryPoolResults");
}

void Program::submit(std::size_t k) {
  Copy& copy = copies_.at(k);
  vulkan::submit(*device_, copy.commands, copy.fence);
  copy.in_flight = true;
}

void Program::run(double timeout_s) {
  for (std::size_t k = 0; k < copies_.size(); ++k) wait(k, timeout_s);
  submit(0);
  wait(0, timeout_s);
}

double Program::device_s() const {
  return ticks_.size() < 2 ? kMissing : device_->seconds(ticks_.front(), ticks_.back());
}

std::vector<double> Program::stage_s(int stages) const {
  if (!time_stages_ || ticks_.size() != steps_.size() + 1)
    return std::vector<double>(static_cast<std::size_t>(stages), kMissing);
  std::vector<double> sum(static_cast<std::size_t>(stages), 0);
  for (std::size_t k = 0; k < steps_.size(); ++k)
    sum[static_cast<std::size_t>(steps_[k].stage)] += device_->seconds(ticks_[k], ticks_[k + 1]);
  return sum;
}

int Program::dispatches(int stage) const {
  return static_cast<int>(std::count_if(steps_.begin(), steps_.end(),
                                        [&](const Step& s) { return s.stage == stage && s.kernel != nullptr; }));
}

}  // namespace clothbench::vulkan
