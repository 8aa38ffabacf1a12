#include "vulkan/kernel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace clothbench::vulkan {

// Delegates to another constructor, so that the destructor runs if this one throws.
Kernel::Kernel(std::shared_ptr<Device> device, std::string name, SpirV code, std::vector<std::uint32_t> specialization,
               const Buffers& buffers, std::uint32_t push_bytes)
    : Kernel(std::move(device), std::move(name), code) {
  for (const auto& [number, access] : accesses_of(code_)) {
    const auto found = buffers.find(number);
    if (found == buffers.end()) throw Error(fmt::format("kernel {}: buffer {} is missing", name_, number));
    bindings_.push_back({number, found->second, access});
  }
  if (const std::uint32_t most = device_->limits().maxComputeWorkGroupInvocations; specialization.at(0) > most)
    throw Error(fmt::format("kernel {}: its workgroups have {} threads; this device or its profile allows {}", name_,
                            specialization[0], most));
  create_layout(push_bytes);
  create_set();
  create_pipeline(specialization);
}

Kernel::~Kernel() {
  vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
  vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
  vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_->handle(), set_layout_, nullptr);
}

void Kernel::create_layout(std::uint32_t push_bytes) {
  std::vector<VkDescriptorSetLayoutBinding> slots;
  for (const Binding& b : bindings_)
    slots.push_back({b.number, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  make_storage_set(*device_, slots, set_layout_, pool_, set_);
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
  layout.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(device_->handle(), &layout, nullptr, &layout_), "vkCreatePipelineLayout");
}

void Kernel::create_set() {
  std::vector<VkDescriptorBufferInfo> infos;
  for (const Binding& b : bindings_) infos.push_back({b.buffer->handle(), 0, VK_WHOLE_SIZE});
  std::vector<VkWriteDescriptorSet> writes;
  for (std::uint32_t k = 0; k < infos.size(); ++k) {
    VkWriteDescriptorSet w{};
    w.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    w.dstSet = set_;
    w.dstBinding = bindings_[k].number;
    w.descriptorCount = 1;
    w.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    w.pBufferInfo = &infos[k];
    writes.push_back(w);
  }
  vkUpdateDescriptorSets(device_->handle(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

void Kernel::create_pipeline(const std::vector<std::uint32_t>& specialization) {
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = code_.bytes;
  module_info.pCode = code_.words;
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device_->handle(), &module_info, nullptr, &module), "vkCreateShaderModule");
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t k = 0; k < specialization.size(); ++k) entries.push_back({k, 4 * k, 4});
  const VkSpecializationInfo constants{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                       4 * specialization.size(), specialization.data()};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.layout = layout_;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  const VkResult result = vkCreateComputePipelines(device_->handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_);
  vkDestroyShaderModule(device_->handle(), module, nullptr);
  check(result, ("vkCreateComputePipelines(" + name_ + ")").c_str());
}

void Kernel::bind(VkCommandBuffer commands) const {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
}

void Kernel::push(VkCommandBuffer commands, const std::vector<std::uint8_t>& constants) const {
  if (constants.empty()) return;
  vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<std::uint32_t>(constants.size()),
                     constants.data());
}

Groups groups_for(std::uint64_t items, std::uint32_t group_size) {
  constexpr std::uint64_t kMost = 65535;  // minimum of maxComputeWorkGroupCount that Vulkan guarantees
  const std::uint64_t groups = items / group_size + (items % group_size != 0 ? 1 : 0);
  if (groups * group_size > std::numeric_limits<std::uint32_t>::max() || groups > kMost * kMost)
    throw Error(fmt::format("{} items in groups of {}: expected at most 2^32 items in a dispatch", items, group_size));
  const std::uint64_t rows = std::max<std::uint64_t>(1, (groups + kMost - 1) / kMost);
  return {static_cast<std::uint32_t>((groups + rows - 1) / rows), static_cast<std::uint32_t>(rows)};
}

// Delegates to another constructor, so that the destructor runs if this one throws.
Buffer::Buffer(std::shared_ptr<Device> device, std::string name, VkDeviceSize bytes, Place place)
    : Buffer(std::move(device)) {
  name_ = std::move(name);
  bytes_ = bytes;
  place_ = place;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  check(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);

  constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex =
      place_ == Place::Device
          ? device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
          // Host-cached memory if there is any, because the host reads positions back through it.
          : device_->memory_type(needs.memoryTypeBits, kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (memory.memoryTypeIndex == Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, place_ == Place::Device ? 0 : kMapped);
  check(vkAllocateMemory(device_->handle(), &memory, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindBufferMemory(device_->handle(), buffer_, memory_, 0), "vkBindBufferMemory");
  if (place_ == Place::Host)
    check(vkMapMemory(device_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

Buffer::~Buffer() {
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  vkFreeMemory(device_->handle(), memory_, nullptr);
}

}  // namespace clothbench::vulkan
