#include <algorithm>
#include <nlohmann/json.hpp>

#include "vulkan/device_info.hpp"

namespace clothbench::vulkan {
namespace {

// Every member of VkPhysicalDeviceFeatures (Vulkan 1.0).
// clang-format off
#define CLOTHBENCH_FEATURES(X) \
  X(robustBufferAccess) X(fullDrawIndexUint32) X(imageCubeArray) X(independentBlend) X(geometryShader) \
  X(tessellationShader) X(sampleRateShading) X(dualSrcBlend) X(logicOp) X(multiDrawIndirect) \
  X(drawIndirectFirstInstance) X(depthClamp) X(depthBiasClamp) X(fillModeNonSolid) X(depthBounds) X(wideLines) \
  X(largePoints) X(alphaToOne) X(multiViewport) X(samplerAnisotropy) X(textureCompressionETC2) \
  X(textureCompressionASTC_LDR) X(textureCompressionBC) X(occlusionQueryPrecise) X(pipelineStatisticsQuery) \
  X(vertexPipelineStoresAndAtomics) X(fragmentStoresAndAtomics) X(shaderTessellationAndGeometryPointSize) \
  X(shaderImageGatherExtended) X(shaderStorageImageExtendedFormats) X(shaderStorageImageMultisample) \
  X(shaderStorageImageReadWithoutFormat) X(shaderStorageImageWriteWithoutFormat) \
  X(shaderUniformBufferArrayDynamicIndexing) X(shaderSampledImageArrayDynamicIndexing) \
  X(shaderStorageBufferArrayDynamicIndexing) X(shaderStorageImageArrayDynamicIndexing) X(shaderClipDistance) \
  X(shaderCullDistance) X(shaderFloat64) X(shaderInt64) X(shaderInt16) X(shaderResourceResidency) \
  X(shaderResourceMinLod) X(sparseBinding) X(sparseResidencyBuffer) X(sparseResidencyImage2D) \
  X(sparseResidencyImage3D) X(sparseResidency2Samples) X(sparseResidency4Samples) X(sparseResidency8Samples) \
  X(sparseResidency16Samples) X(sparseResidencyAliased) X(variableMultisampleRate) X(inheritedQueries)
// clang-format on

nlohmann::json core_features(const VkPhysicalDeviceFeatures& f) {
  nlohmann::json j;
#define CLOTHBENCH_PUT(member) j[#member] = f.member == VK_TRUE;
  CLOTHBENCH_FEATURES(CLOTHBENCH_PUT)
#undef CLOTHBENCH_PUT
  return j;
}

}  // namespace

nlohmann::json features_json(VkPhysicalDevice physical) {
  const std::vector<std::string> names = extensions(physical);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  VkPhysicalDevice16BitStorageFeatures storage16{};
  storage16.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES;
  VkPhysicalDeviceVariablePointersFeatures pointers{};
  pointers.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VARIABLE_POINTERS_FEATURES;
  pointers.pNext = &storage16;
  VkPhysicalDeviceShaderFloat16Int8Features float16{};
  float16.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES;
  VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomics{};
  atomics.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT;
  VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &pointers, {}};
  void** end = &storage16.pNext;
  if (has(VK_KHR_SHADER_FLOAT16_INT8_EXTENSION_NAME)) {
    *end = &float16;
    end = &float16.pNext;
  }
  if (has(VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME)) *end = &atomics;
  vkGetPhysicalDeviceFeatures2(physical, &all);

  nlohmann::json j = core_features(all.features);
  j["storageBuffer16BitAccess"] = storage16.storageBuffer16BitAccess == VK_TRUE;
  j["variablePointersStorageBuffer"] = pointers.variablePointersStorageBuffer == VK_TRUE;
  j["shaderFloat16"] = float16.shaderFloat16 == VK_TRUE;
  j["shaderInt8"] = float16.shaderInt8 == VK_TRUE;
  j["shaderBufferFloat32Atomics"] = atomics.shaderBufferFloat32Atomics == VK_TRUE;
  j["shaderBufferFloat32AtomicAdd"] = atomics.shaderBufferFloat32AtomicAdd == VK_TRUE;
  j["shaderSharedFloat32AtomicAdd"] = atomics.shaderSharedFloat32AtomicAdd == VK_TRUE;
  return j;
}

nlohmann::json queue_families_json(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  nlohmann::json j = nlohmann::json::array();
  for (const auto& f : families)
    j.push_back({{"flags", f.queueFlags}, {"count", f.queueCount}, {"timestampValidBits", f.timestampValidBits}});
  return j;
}

}  // namespace clothbench::vulkan
