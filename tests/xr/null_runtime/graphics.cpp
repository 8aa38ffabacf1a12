// Vulkan: instance, device, swapchains, and a check of the rendered images.
#include "runtime.hpp"

namespace null_xr {
namespace {

XrResult XRAPI_CALL requirements(XrInstance, XrSystemId, XrGraphicsRequirementsVulkan2KHR* out) {
  out->minApiVersionSupported = XR_MAKE_VERSION(1, 0, 0);
  out->maxApiVersionSupported = XR_MAKE_VERSION(1, 3, 0);
  return XR_SUCCESS;
}

template <class Function>
Function vulkan(PFN_vkGetInstanceProcAddr get, VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(get(instance, name));
}

XrResult XRAPI_CALL create_vulkan_instance(XrInstance, const XrVulkanInstanceCreateInfoKHR* info, VkInstance* out,
                                           VkResult* result) {
  const auto create = vulkan<PFN_vkCreateInstance>(info->pfnGetInstanceProcAddr, nullptr, "vkCreateInstance");
  *result = create(info->vulkanCreateInfo, info->vulkanAllocator, out);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL graphics_device(XrInstance, const XrVulkanGraphicsDeviceGetInfoKHR* info, VkPhysicalDevice* out) {
  std::uint32_t count = 1;
  const VkResult result = vkEnumeratePhysicalDevices(info->vulkanInstance, &count, out);
  return (result == VK_SUCCESS || result == VK_INCOMPLETE) && count == 1 ? XR_SUCCESS
                                                                         : XR_ERROR_GRAPHICS_DEVICE_INVALID;
}

XrResult XRAPI_CALL create_vulkan_device(XrInstance, const XrVulkanDeviceCreateInfoKHR* info, VkDevice* out,
                                         VkResult* result) {
  *result = vkCreateDevice(info->vulkanPhysicalDevice, info->vulkanCreateInfo, info->vulkanAllocator, out);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_session(XrInstance, const XrSessionCreateInfo* info, XrSession* out) {
  Runtime& r = *runtime();
  const auto* binding = static_cast<const XrGraphicsBindingVulkan2KHR*>(info->next);
  if (binding == nullptr || binding->type != XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR || binding->device == VK_NULL_HANDLE)
    return r.fault("xrCreateSession: no Vulkan", XR_ERROR_GRAPHICS_DEVICE_INVALID);
  r.physical = binding->physicalDevice;
  r.device = binding->device;
  vkGetDeviceQueue(r.device, binding->queueFamilyIndex, binding->queueIndex, &r.queue);
  r.session = true;
  r.go(XR_SESSION_STATE_IDLE);
  r.go(XR_SESSION_STATE_READY);
  *out = handle<XrSession>(2);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_session(XrSession) {
  runtime()->session = false;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL formats(XrSession, std::uint32_t capacity, std::uint32_t* count, std::int64_t* out) {
  return list<std::int64_t>({VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_SRGB}, capacity, count, out);
}

XrResult XRAPI_CALL create_swapchain(XrSession, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
  Runtime& r = *runtime();
  auto made = std::make_unique<Swapchain>();
  made->extent = {info->width, info->height};
  VkPhysicalDeviceMemoryProperties types{};
  vkGetPhysicalDeviceMemoryProperties(r.physical, &types);
  for (int k = 0; k < 3; ++k) {
    VkImageCreateInfo image{};
    image.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = static_cast<VkFormat>(info->format);
    image.extent = {info->width, info->height, 1};
    image.mipLevels = image.arrayLayers = 1;
    image.samples = VK_SAMPLE_COUNT_1_BIT;
    image.tiling = VK_IMAGE_TILING_LINEAR;  // `look` reads it on the host
    image.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    VkImage handle_of_image = VK_NULL_HANDLE;
    if (vkCreateImage(r.device, &image, nullptr, &handle_of_image) != VK_SUCCESS) return XR_ERROR_OUT_OF_MEMORY;
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(r.device, handle_of_image, &needs);
    VkMemoryAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.allocationSize = needs.size;
    constexpr VkMemoryPropertyFlags kMapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    while ((needs.memoryTypeBits >> allocate.memoryTypeIndex & 1u) == 0 ||
           (types.memoryTypes[allocate.memoryTypeIndex].propertyFlags & kMapped) != kMapped)
      ++allocate.memoryTypeIndex;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    if (vkAllocateMemory(r.device, &allocate, nullptr, &memory) != VK_SUCCESS) return XR_ERROR_OUT_OF_MEMORY;
    vkBindImageMemory(r.device, handle_of_image, memory, 0);
    made->images.push_back(handle_of_image);
    made->memory.push_back(memory);
  }
  *out = handle<XrSwapchain>(++r.handles);
  r.swapchains[r.handles] = std::move(made);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_swapchain(XrSwapchain s) {
  Runtime& r = *runtime();
  const auto found = r.swapchains.find(number_of(s));
  if (found == r.swapchains.end()) return r.fault("xrDestroySwapchain: no such swapchain", XR_ERROR_HANDLE_INVALID);
  for (const VkImage image : found->second->images) vkDestroyImage(r.device, image, nullptr);
  for (const VkDeviceMemory memory : found->second->memory) vkFreeMemory(r.device, memory, nullptr);
  r.swapchains.erase(found);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL swapchain_images(XrSwapchain s, std::uint32_t capacity, std::uint32_t* count,
                                     XrSwapchainImageBaseHeader* out) {
  const Swapchain& c = *runtime()->swapchains.at(number_of(s));
  *count = static_cast<std::uint32_t>(c.images.size());
  if (capacity == 0) return XR_SUCCESS;
  for (std::size_t k = 0; k < c.images.size(); ++k)
    reinterpret_cast<XrSwapchainImageVulkan2KHR*>(out)[k].image = c.images[k];
  return XR_SUCCESS;
}

XrResult XRAPI_CALL acquire(XrSwapchain s, const XrSwapchainImageAcquireInfo*, std::uint32_t* index) {
  Runtime& r = *runtime();
  Swapchain& c = *r.swapchains.at(number_of(s));
  if (c.acquired != ~0u) return r.fault("xrAcquireSwapchainImage: one is out already", XR_ERROR_CALL_ORDER_INVALID);
  *index = c.acquired = c.next;
  c.next = (c.next + 1) % static_cast<std::uint32_t>(c.images.size());
  c.waited = false;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL wait_image(XrSwapchain s, const XrSwapchainImageWaitInfo*) {
  Runtime& r = *runtime();
  Swapchain& c = *r.swapchains.at(number_of(s));
  if (c.acquired == ~0u) return r.fault("xrWaitSwapchainImage: none is out", XR_ERROR_CALL_ORDER_INVALID);
  c.waited = true;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL release_image(XrSwapchain s, const XrSwapchainImageReleaseInfo*) {
  Runtime& r = *runtime();
  Swapchain& c = *r.swapchains.at(number_of(s));
  if (c.acquired == ~0u || !c.waited)
    return r.fault("xrReleaseSwapchainImage: none was waited for", XR_ERROR_CALL_ORDER_INVALID);
  c.released = c.acquired;
  c.acquired = ~0u;
  return XR_SUCCESS;
}

}  // namespace

double drawn_share(Runtime& r, const Swapchain& c) {
  vkQueueWaitIdle(r.queue);
  const VkImageSubresource colour{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0};
  VkSubresourceLayout rows{};
  vkGetImageSubresourceLayout(r.device, c.images.at(c.released), &colour, &rows);
  void* mapped = nullptr;
  vkMapMemory(r.device, c.memory.at(c.released), 0, VK_WHOLE_SIZE, 0, &mapped);
  std::size_t drawn = 0;
  for (std::uint32_t row = 0; row < c.extent.height; ++row)
    for (std::uint32_t column = 0; column < c.extent.width; ++column) {
      const auto* p = static_cast<const std::uint8_t*>(mapped) + rows.offset + row * rows.rowPitch + 4 * column;
      const bool white = p[0] == 255 && p[1] == 255 && p[2] == 255;
      drawn += !white && p[3] != 0 ? 1 : 0;
    }
  vkUnmapMemory(r.device, c.memory.at(c.released));
  return static_cast<double>(drawn) / (static_cast<double>(c.extent.width) * c.extent.height);
}

PFN_xrVoidFunction graphics_function(const std::string& name) {
  NULL_XR("xrGetVulkanGraphicsRequirements2KHR", requirements)
  NULL_XR("xrCreateVulkanInstanceKHR", create_vulkan_instance)
  NULL_XR("xrGetVulkanGraphicsDevice2KHR", graphics_device)
  NULL_XR("xrCreateVulkanDeviceKHR", create_vulkan_device)
  NULL_XR("xrCreateSession", create_session)
  NULL_XR("xrDestroySession", destroy_session)
  NULL_XR("xrEnumerateSwapchainFormats", formats)
  NULL_XR("xrCreateSwapchain", create_swapchain)
  NULL_XR("xrDestroySwapchain", destroy_swapchain)
  NULL_XR("xrEnumerateSwapchainImages", swapchain_images)
  NULL_XR("xrAcquireSwapchainImage", acquire)
  NULL_XR("xrWaitSwapchainImage", wait_image)
  NULL_XR("xrReleaseSwapchainImage", release_image)
  return nullptr;
}

}  // namespace null_xr
