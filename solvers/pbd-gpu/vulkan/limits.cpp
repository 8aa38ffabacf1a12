#include <nlohmann/json.hpp>

#include "vulkan/device_info.hpp"

namespace clothbench::vulkan {

// Every member of VkPhysicalDeviceLimits (Vulkan 1.1) under its own name.
nlohmann::json limits_json(const VkPhysicalDeviceLimits& limits) {
  nlohmann::json j;
#define PUT(member) j[#member] = limits.member
  PUT(maxImageDimension1D);
  PUT(maxImageDimension2D);
  PUT(maxImageDimension3D);
  PUT(maxImageDimensionCube);
  PUT(maxImageArrayLayers);
  PUT(maxTexelBufferElements);
  PUT(maxUniformBufferRange);
  PUT(maxStorageBufferRange);
  PUT(maxPushConstantsSize);
  PUT(maxMemoryAllocationCount);
  PUT(maxSamplerAllocationCount);
  PUT(bufferImageGranularity);
  PUT(sparseAddressSpaceSize);
  PUT(maxBoundDescriptorSets);
  PUT(maxPerStageDescriptorSamplers);
  PUT(maxPerStageDescriptorUniformBuffers);
  PUT(maxPerStageDescriptorStorageBuffers);
  PUT(maxPerStageDescriptorSampledImages);
  PUT(maxPerStageDescriptorStorageImages);
  PUT(maxPerStageDescriptorInputAttachments);
  PUT(maxPerStageResources);
  PUT(maxDescriptorSetSamplers);
  PUT(maxDescriptorSetUniformBuffers);
  PUT(maxDescriptorSetUniformBuffersDynamic);
  PUT(maxDescriptorSetStorageBuffers);
  PUT(maxDescriptorSetStorageBuffersDynamic);
  PUT(maxDescriptorSetSampledImages);
  PUT(maxDescriptorSetStorageImages);
  PUT(maxDescriptorSetInputAttachments);
  PUT(maxVertexInputAttributes);
  PUT(maxVertexInputBindings);
  PUT(maxVertexInputAttributeOffset);
  PUT(maxVertexInputBindingStride);
  PUT(maxVertexOutputComponents);
  PUT(maxTessellationGenerationLevel);
  PUT(maxTessellationPatchSize);
  PUT(maxTessellationControlPerVertexInputComponents);
  PUT(maxTessellationControlPerVertexOutputComponents);
  PUT(maxTessellationControlPerPatchOutputComponents);
  PUT(maxTessellationControlTotalOutputComponents);
  PUT(maxTessellationEvaluationInputComponents);
  PUT(maxTessellationEvaluationOutputComponents);
  PUT(maxGeometryShaderInvocations);
  PUT(maxGeometryInputComponents);
  PUT(maxGeometryOutputComponents);
  PUT(maxGeometryOutputVertices);
  PUT(maxGeometryTotalOutputComponents);
  PUT(maxFragmentInputComponents);
  PUT(maxFragmentOutputAttachments);
  PUT(maxFragmentDualSrcAttachments);
  PUT(maxFragmentCombinedOutputResources);
  PUT(maxComputeSharedMemorySize);
  PUT(maxComputeWorkGroupInvocations);
  PUT(subPixelPrecisionBits);
  PUT(subTexelPrecisionBits);
  PUT(mipmapPrecisionBits);
  PUT(maxDrawIndexedIndexValue);
  PUT(maxDrawIndirectCount);
  PUT(maxSamplerLodBias);
  PUT(maxSamplerAnisotropy);
  PUT(maxViewports);
  PUT(viewportSubPixelBits);
  PUT(minMemoryMapAlignment);
  PUT(minTexelBufferOffsetAlignment);
  PUT(minUniformBufferOffsetAlignment);
  PUT(minStorageBufferOffsetAlignment);
  PUT(minTexelOffset);
  PUT(maxTexelOffset);
  PUT(minTexelGatherOffset);
  PUT(maxTexelGatherOffset);
  PUT(minInterpolationOffset);
  PUT(maxInterpolationOffset);
  PUT(subPixelInterpolationOffsetBits);
  PUT(maxFramebufferWidth);
  PUT(maxFramebufferHeight);
  PUT(maxFramebufferLayers);
  PUT(framebufferColorSampleCounts);
  PUT(framebufferDepthSampleCounts);
  PUT(framebufferStencilSampleCounts);
  PUT(framebufferNoAttachmentsSampleCounts);
  PUT(maxColorAttachments);
  PUT(sampledImageColorSampleCounts);
  PUT(sampledImageIntegerSampleCounts);
  PUT(sampledImageDepthSampleCounts);
  PUT(sampledImageStencilSampleCounts);
  PUT(storageImageSampleCounts);
  PUT(maxSampleMaskWords);
  PUT(timestampComputeAndGraphics);
  PUT(timestampPeriod);
  PUT(maxClipDistances);
  PUT(maxCullDistances);
  PUT(maxCombinedClipAndCullDistances);
  PUT(discreteQueuePriorities);
  PUT(pointSizeGranularity);
  PUT(lineWidthGranularity);
  PUT(strictLines);
  PUT(standardSampleLocations);
  PUT(optimalBufferCopyOffsetAlignment);
  PUT(optimalBufferCopyRowPitchAlignment);
  PUT(nonCoherentAtomSize);
  PUT(maxComputeWorkGroupCount);
  PUT(maxComputeWorkGroupSize);
  PUT(maxViewportDimensions);
  PUT(viewportBoundsRange);
  PUT(pointSizeRange);
  PUT(lineWidthRange);
#undef PUT
  return j;
}

}  // namespace clothbench::vulkan
