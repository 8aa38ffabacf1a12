#include <algorithm>
#include <nlohmann/json.hpp>

#include "vulkan/device_info.hpp"

namespace clothbench::vulkan {
namespace {

/// Every member of VkPhysicalDeviceFeatures (Vulkan 1.0) under its own name.
nlohmann::json core_features(const VkPhysicalDeviceFeatures& f) {
  nlohmann::json j;
#define PUT(member) j[#member] = f.member == VK_TRUE
  PUT(robustBufferAccess);
  PUT(fullDrawIndexUint32);
  PUT(imageCubeArray);
  PUT(independentBlend);
  PUT(geometryShader);
  PUT(tessellationShader);
  PUT(sampleRateShading);
  PUT(dualSrcBlend);
  PUT(logicOp);
  PUT(multiDrawIndirect);
  PUT(drawIndirectFirstInstance);
  PUT(depthClamp);
  PUT(depthBiasClamp);
  PUT(fillModeNonSolid);
  PUT(depthBounds);
  PUT(wideLines);
  PUT(largePoints);
  PUT(alphaToOne);
  PUT(multiViewport);
  PUT(samplerAnisotropy);
  PUT(textureCompressionETC2);
  PUT(textureCompressionASTC_LDR);
  PUT(textureCompressionBC);
  PUT(occlusionQueryPrecise);
  PUT(pipelineStatisticsQuery);
  PUT(vertexPipelineStoresAndAtomics);
  PUT(fragmentStoresAndAtomics);
  PUT(shaderTessellationAndGeometryPointSize);
  PUT(shaderImageGatherExtended);
  PUT(shaderStorageImageExtendedFormats);
  PUT(shaderStorageImageMultisample);
  PUT(shaderStorageImageReadWithoutFormat);
  PUT(shaderStorageImageWriteWithoutFormat);
  PUT(shaderUniformBufferArrayDynamicIndexing);
  PUT(shaderSampledImageArrayDynamicIndexing);
  PUT(shaderStorageBufferArrayDynamicIndexing);
  PUT(shaderStorageImageArrayDynamicIndexing);
  PUT(shaderClipDistance);
  PUT(shaderCullDistance);
  PUT(shaderFloat64);
  PUT(shaderInt64);
  PUT(shaderInt16);
  PUT(shaderResourceResidency);
  PUT(shaderResourceMinLod);
  PUT(sparseBinding);
  PUT(sparseResidencyBuffer);
  PUT(sparseResidencyImage2D);
  PUT(sparseResidencyImage3D);
  PUT(sparseResidency2Samples);
  PUT(sparseResidency4Samples);
  PUT(sparseResidency8Samples);
  PUT(sparseResidency16Samples);
  PUT(sparseResidencyAliased);
  PUT(variableMultisampleRate);
  PUT(inheritedQueries);
#undef PUT
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
