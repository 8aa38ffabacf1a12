#include "render/pipelines.hpp"

#include <vector>

#include "render/render_shared.h"
#include "vulkan/device.hpp"

namespace clothbench::render {
namespace {

using vulkan::check;

const std::uint32_t kClothVert[] = {
#include "cloth.vert.inc"
};
const std::uint32_t kColliderVert[] = {
#include "collider.vert.inc"
};
const std::uint32_t kSurfaceFrag[] = {
#include "surface.frag.inc"
};

/// A shader module, destroyed once the pipeline exists.
struct Module : Owned<VkShaderModule, vkDestroyShaderModule> {
  Module(VkDevice device, const std::uint32_t* words, std::size_t bytes) {
    auto info = blank<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    info.codeSize = bytes;
    info.pCode = words;
    check(vkCreateShaderModule(device, &info, nullptr, create(device)), "vkCreateShaderModule");
  }
};

/// Creates a view of a colour or a depth image.
void create_view(VkDevice device, VkImage image, VkFormat format, Owned<VkImageView, vkDestroyImageView>& view) {
  auto info = blank<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  const bool depth = format == Pipelines::kDepthFormat;
  info.subresourceRange = {
      static_cast<VkImageAspectFlags>(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1, 0, 1};
  check(vkCreateImageView(device, &info, nullptr, view.create(device)), "vkCreateImageView");
}

constexpr VkShaderStageFlags kBoth = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

}  // namespace

Pipelines::Pipelines(std::shared_ptr<vulkan::Device> device, VkFormat colour, VkSampleCountFlagBits samples)
    : device_(std::move(device)) {
  create_pass(colour, samples);
  std::vector<VkDescriptorSetLayoutBinding> slots(kBindings);
  for (std::uint32_t k = 0; k < kBindings; ++k)
    slots[k] = {k, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, nullptr};
  vulkan::make_storage_set(*device_, slots, *set_layout_.create(device_->handle()), *pool_.create(device_->handle()),
                           set_);
  const VkPushConstantRange range{kBoth, 0, sizeof(Drawn)};
  auto info = blank<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  const VkDescriptorSetLayout set_layout = set_layout_;
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(device_->handle(), &info, nullptr, layout_.create(device_->handle())),
        "vkCreatePipelineLayout");
  create(true, samples, cloth_);
  create(false, samples, collider_);
}

/// Samples and depth are not stored after the pass, so a tiled GPU keeps them on chip.
void Pipelines::create_pass(VkFormat colour, VkSampleCountFlagBits samples) {
  std::array<VkAttachmentDescription, 3> a{};
  for (VkAttachmentDescription& one : a) {
    one.samples = samples;
    one.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    one.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    one.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    one.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    one.format = colour;
    one.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  }
  a[1].format = kDepthFormat;
  a[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  a[2].samples = VK_SAMPLE_COUNT_1_BIT;
  a[2].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  a[2].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  const VkAttachmentReference drawn{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolved{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &drawn;
  subpass.pResolveAttachments = &resolved;
  subpass.pDepthStencilAttachment = &depth;
  // The first dependency orders an earlier image's use of these attachments before the use by this image. The second
  // orders the result of this image before all later commands.
  constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                            VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                            VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags kWritten =
      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  std::array<VkSubpassDependency, 2> orders{};
  orders[0] = {VK_SUBPASS_EXTERNAL,
               0,
               kDrawing | VK_PIPELINE_STAGE_TRANSFER_BIT,
               kDrawing,
               kWritten,
               kWritten | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
               0};
  orders[1] = {0,
               VK_SUBPASS_EXTERNAL,
               VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
               VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
               VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
               VK_ACCESS_MEMORY_READ_BIT,
               0};
  auto info = blank<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = static_cast<std::uint32_t>(a.size());
  info.pAttachments = a.data();
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = static_cast<std::uint32_t>(orders.size());
  info.pDependencies = orders.data();
  check(vkCreateRenderPass(device_->handle(), &info, nullptr, pass_.create(device_->handle())), "vkCreateRenderPass");
}

void Pipelines::create(bool cloth, VkSampleCountFlagBits samples, Pipeline& to) const {
  const Module vertex = cloth ? Module(device_->handle(), kClothVert, sizeof kClothVert)
                              : Module(device_->handle(), kColliderVert, sizeof kColliderVert);
  const Module fragment(device_->handle(), kSurfaceFrag, sizeof kSurfaceFrag);
  const VkBool32 is_cloth = cloth ? VK_TRUE : VK_FALSE;
  const VkSpecializationMapEntry entry{0, 0, sizeof is_cloth};
  const VkSpecializationInfo constants{1, &entry, sizeof is_cloth, &is_cloth};
  auto stage = blank<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  stage.pName = "main";
  std::array stages = {stage, stage};
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = vertex;
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = fragment;
  stages[1].pSpecializationInfo = &constants;
  // Triangles, no culling, depth test, opaque; the viewport is dynamic.
  const auto input =
      blank<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  auto assembly =
      blank<VkPipelineInputAssemblyStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport = blank<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster =
      blank<VkPipelineRasterizationStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  auto multisample =
      blank<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  multisample.rasterizationSamples = samples;
  auto depth = blank<VkPipelineDepthStencilStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask = 0xf;
  auto blend = blank<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = 1;
  blend.pAttachments = &opaque;
  constexpr std::array kDynamic = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = blank<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(kDynamic.size());
  dynamic.pDynamicStates = kDynamic.data();
  auto info = blank<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_;
  info.renderPass = pass_;
  check(vkCreateGraphicsPipelines(device_->handle(), VK_NULL_HANDLE, 1, &info, nullptr, to.create(device_->handle())),
        "vkCreateGraphicsPipelines");
}

void Pipelines::bind(const std::array<const vulkan::Buffer*, kBindings>& buffers) {
  std::array<VkDescriptorBufferInfo, kBindings> infos{};
  std::array<VkWriteDescriptorSet, kBindings> writes{};
  for (std::uint32_t k = 0; k < kBindings; ++k) {
    if (buffers[k]->bytes() > device_->limits().maxStorageBufferRange)
      throw Error(buffers[k]->name() + ": larger than this device's maximum storage buffer");
    infos[k] = {buffers[k]->handle(), 0, VK_WHOLE_SIZE};
    writes[k] = blank<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    writes[k].dstSet = set_;
    writes[k].dstBinding = k;
    writes[k].descriptorCount = 1;
    writes[k].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[k].pBufferInfo = &infos[k];
  }
  vkUpdateDescriptorSets(device_->handle(), kBindings, writes.data(), 0, nullptr);
}

void Pipelines::use(VkCommandBuffer commands, bool cloth, const void* constants, std::uint32_t bytes) const {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, cloth ? cloth_ : collider_);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set_, 0, nullptr);
  vkCmdPushConstants(commands, layout_, kBoth, 0, bytes, constants);
}

Image::Image(std::shared_ptr<vulkan::Device> device, VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples,
             VkImageUsageFlags usage)
    : device_(std::move(device)) {
  auto info = blank<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {extent.width, extent.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  check(vkCreateImage(device_->handle(), &info, nullptr, image_.create(device_->handle())), "vkCreateImage");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device_->handle(), image_, &needs);
  auto memory = blank<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex = vulkan::Device::kNoMemory;
  // A tiled GPU needs no memory for an attachment that stays on chip.
  if ((usage & VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT) != 0)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT);
  if (memory.memoryTypeIndex == vulkan::Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (memory.memoryTypeIndex == vulkan::Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, 0);
  check(vkAllocateMemory(device_->handle(), &memory, nullptr, memory_.create(device_->handle())), "vkAllocateMemory");
  check(vkBindImageMemory(device_->handle(), image_, memory_, 0), "vkBindImageMemory");
  create_view(device_->handle(), image_, format, view_);
}

Targets::Targets(std::shared_ptr<vulkan::Device> device, VkRenderPass pass, VkFormat colour,
                 VkSampleCountFlagBits samples, VkExtent2D extent)
    : device_(device),
      pass_(pass),
      format_(colour),
      extent_(extent),
      colour_(device, colour, extent, samples,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT),
      depth_(device, Pipelines::kDepthFormat, extent, samples,
             VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT) {}

VkFramebuffer Targets::framebuffer(VkImage image) {
  Held& h = held_[image];
  if (h.framebuffer != VK_NULL_HANDLE) return h.framebuffer;
  if (h.view == VK_NULL_HANDLE) create_view(device_->handle(), image, format_, h.view);
  const std::array<VkImageView, 3> views = {colour_.view(), depth_.view(), h.view};
  auto info = blank<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  info.renderPass = pass_;
  info.attachmentCount = static_cast<std::uint32_t>(views.size());
  info.pAttachments = views.data();
  info.width = extent_.width;
  info.height = extent_.height;
  info.layers = 1;
  check(vkCreateFramebuffer(device_->handle(), &info, nullptr, h.framebuffer.create(device_->handle())),
        "vkCreateFramebuffer");
  return h.framebuffer;
}

}  // namespace clothbench::render
