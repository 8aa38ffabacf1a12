#include "common/frame_builder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"

namespace clothbench::pbd_gpu {

using vulkan::Buffer;

std::vector<float> inverse_masses(const Scene& scene) {
  std::vector<float> w;
  for (double m : vertex_masses(scene)) w.push_back(static_cast<float>(1 / m));
  for (std::uint32_t v : scene.pins.vertices) w[v] = 0;
  for (std::uint32_t v : scene.grips.vertices) w[v] = 0;
  return w;
}

std::string why_no_room(const std::string& name, std::uint64_t bytes, std::uint64_t all_B, std::uint64_t largest_B,
                        std::uint64_t memory_B) {
  constexpr double kMiB = 1024.0 * 1024;
  if (bytes > largest_B)
    return fmt::format("buffer \"{}\" of {:.1f} MiB, but the device's limit is {:.1f} MiB", name, bytes / kMiB,
                       largest_B / kMiB);
  if (all_B <= memory_B) return "";
  return fmt::format("buffers of at least {:.1f} MiB, but the device has {:.1f} MiB", all_B / kMiB, memory_B / kMiB);
}

void FrameBuilder::require_room(const std::string& name, std::uint64_t bytes) const {
  std::uint64_t all = bytes;
  for (const BufferPlan& b : plan_.buffers) all += b.device_local ? b.bytes : 0;
  const std::string why = why_no_room(name, bytes, all, device_->limits().maxStorageBufferRange, device_->memory_B());
  if (why.empty()) return;
  const Cloth& c = scene_->cloth;
  throw Error(fmt::format("{}: {}: {} vertices{} do not fit {}: they need {}", scene_->source,
                          c.mesh ? "/cloth/mesh" : "/cloth/grid", c.vertex_count(),
                          c.mesh ? fmt::format(" and {} triangles", c.mesh->triangles.size()) : std::string(),
                          device_->info().name, why));
}

FrameBuilder::FrameBuilder(const nlohmann::json& settings, const DeviceOptions& device)
    : settings_(settings), device_(vulkan::Device::get(device)) {}

void FrameBuilder::begin(const Scene& scene) {
  scene_ = &scene;
  for (auto* program : {&frame_, &upload_, &download_}) *program = std::make_unique<vulkan::Program>(device_);
  constexpr std::uint64_t kBytes = 64 * 4 * sizeof(std::uint32_t);  // no scene has 64 stages
  if (!settings_.value("count_bytes", false)) return;
  counters_ = &add_buffer(BIND_COUNTER, "byte counters", kBytes);
  counted_ = &add_host_buffer("bytes counted", kBytes);
  zeros_ = &add_host_buffer("no bytes counted", kBytes);
}

const Buffer& FrameBuilder::add_buffer(int binding, const std::string& name, std::uint64_t bytes, const void* initial,
                                       std::size_t initial_bytes) {
  require_room(name, bytes);
  buffers_.push_back(std::make_unique<Buffer>(device_, name, bytes, Buffer::Place::Device));
  const Buffer& buffer = *buffers_.back();
  if (binding != kUnbound) bound_[static_cast<std::uint32_t>(binding)] = &buffer;
  plan_.buffers.push_back({name, bytes, true});
  const Buffer& staging = add_host_buffer(name + " (initial)", bytes);
  if (initial_bytes > 0) std::memcpy(staging.mapped(), initial, std::min<std::size_t>(initial_bytes, bytes));
  upload_->copy(0, staging, buffer);
  return buffer;
}

const Buffer& FrameBuilder::add_host_buffer(const std::string& name, std::uint64_t bytes, int binding) {
  buffers_.push_back(std::make_unique<Buffer>(device_, name, bytes, Buffer::Place::Host));
  const Buffer& buffer = *buffers_.back();
  std::memset(buffer.mapped(), 0, bytes);
  if (binding != kUnbound) bound_[static_cast<std::uint32_t>(binding)] = &buffer;
  plan_.buffers.push_back({name, bytes, false});
  return buffer;
}

int FrameBuilder::add_stage(const std::string& name, FeatureSet serves) {
  plan_.stages.push_back({name, serves, 0, kMissing, kMissing});
  copied_B_.push_back(0);
  return static_cast<int>(plan_.stages.size()) - 1;
}

vulkan::Buffers FrameBuilder::buffers_with(vulkan::Buffers own) const {
  own.insert(bound_.begin(), bound_.end());
  if (const auto positions = own.find(BIND_POSITIONS); positions != own.end())
    for (std::uint32_t k = 0; k < BIND_COUNT; ++k) own.try_emplace(k, positions->second);
  return own;
}

const FrameKernel* FrameBuilder::add_kernel(int stage, const std::string& name, std::uint32_t push_bytes,
                                            std::vector<std::uint32_t> constants, std::uint32_t group_size,
                                            const vulkan::Buffers& own) {
  vulkan::SpirV code = shader(name);
  std::vector<std::uint32_t> counting;
  if (counters_ != nullptr) {
    counting = vulkan::with_byte_counters(code, BIND_COUNTER, 4 * static_cast<std::uint32_t>(stage),
                                          {BIND_BARRIER, BIND_TIMED_OUT});
    code = {counting.data(), counting.size() * sizeof(std::uint32_t)};
  }
  constants.resize(std::max<std::size_t>(1, constants.size()));
  constants[0] = group_size;
  kernels_.push_back(std::unique_ptr<FrameKernel>(
      new FrameKernel{stage, group_size, std::move(counting),
                      vulkan::Kernel(device_, name, code, constants, buffers_with(own), push_bytes)}));
  return kernels_.back().get();
}

void FrameBuilder::copy(int stage, const Buffer& from, const Buffer& to) {
  frame_->copy(stage, from, to);
  copied_B_[static_cast<std::size_t>(stage)] += static_cast<double>(std::min(from.bytes(), to.bytes()));
}

namespace {

#include "kernels.inc"  // generated by CMake: an array of 32-bit words for each kernel, and KERNELS

}  // namespace

vulkan::SpirV shader(const std::string& name) {
  static const std::map<std::string, vulkan::SpirV> all = {KERNELS};
  if (const auto found = all.find(name); found != all.end()) return found->second;
  throw Error("no kernel " + name);
}

}  // namespace clothbench::pbd_gpu
