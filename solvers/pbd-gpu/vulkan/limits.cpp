#include <nlohmann/json.hpp>

#include "vulkan/device_info.hpp"

namespace clothbench::vulkan {

// Every member of VkPhysicalDeviceLimits (Vulkan 1.1).
// clang-format off
#define CLOTHBENCH_LIMITS(X) \
  X(maxImageDimension1D) X(maxImageDimension2D) X(maxImageDimension3D) X(maxImageDimensionCube) \
  X(maxImageArrayLayers) X(maxTexelBufferElements) X(maxUniformBufferRange) X(maxStorageBufferRange) \
  X(maxPushConstantsSize) X(maxMemoryAllocationCount) X(maxSamplerAllocationCount) X(bufferImageGranularity) \
  X(sparseAddressSpaceSize) X(maxBoundDescriptorSets) X(maxPerStageDescriptorSamplers) \
  X(maxPerStageDescriptorUniformBuffers) X(maxPerStageDescriptorStorageBuffers) X(maxPerStageDescriptorSampledImages) \
  X(maxPerStageDescriptorStorageImages) X(maxPerStageDescriptorInputAttachments) X(maxPerStageResources) \
  X(maxDescriptorSetSamplers) X(maxDescriptorSetUniformBuffers) X(maxDescriptorSetUniformBuffersDynamic) \
  X(maxDescriptorSetStorageBuffers) X(maxDescriptorSetStorageBuffersDynamic) X(maxDescriptorSetSampledImages) \
  X(maxDescriptorSetStorageImages) X(maxDescriptorSetInputAttachments) X(maxVertexInputAttributes) \
  X(maxVertexInputBindings) X(maxVertexInputAttributeOffset) X(maxVertexInputBindingStride) \
  X(maxVertexOutputComponents) X(maxTessellationGenerationLevel) X(maxTessellationPatchSize) \
  X(maxTessellationControlPerVertexInputComponents) X(maxTessellationControlPerVertexOutputComponents) \
  X(maxTessellationControlPerPatchOutputComponents) X(maxTessellationControlTotalOutputComponents) \
  X(maxTessellationEvaluationInputComponents) X(maxTessellationEvaluationOutputComponents) \
  X(maxGeometryShaderInvocations) X(maxGeometryInputComponents) X(maxGeometryOutputComponents) \
  X(maxGeometryOutputVertices) X(maxGeometryTotalOutputComponents) X(maxFragmentInputComponents) \
  X(maxFragmentOutputAttachments) X(maxFragmentDualSrcAttachments) X(maxFragmentCombinedOutputResources) \
  X(maxComputeSharedMemorySize) X(maxComputeWorkGroupInvocations) X(subPixelPrecisionBits) X(subTexelPrecisionBits) \
  X(mipmapPrecisionBits) X(maxDrawIndexedIndexValue) X(maxDrawIndirectCount) X(maxSamplerLodBias) \
  X(maxSamplerAnisotropy) X(maxViewports) X(viewportSubPixelBits) X(minMemoryMapAlignment) \
  X(minTexelBufferOffsetAlignment) X(minUniformBufferOffsetAlignment) X(minStorageBufferOffsetAlignment) \
  X(minTexelOffset) X(maxTexelOffset) X(minTexelGatherOffset) X(maxTexelGatherOffset) X(minInterpolationOffset) \
  X(maxInterpolationOffset) X(subPixelInterpolationOffsetBits) X(maxFramebufferWidth) X(maxFramebufferHeight) \
  X(maxFramebufferLayers) X(framebufferColorSampleCounts) X(framebufferDepthSampleCounts) \
  X(framebufferStencilSampleCounts) X(framebufferNoAttachmentsSampleCounts) X(maxColorAttachments) \
  X(sampledImageColorSampleCounts) X(sampledImageIntegerSampleCounts) X(sampledImageDepthSampleCounts) \
  X(sampledImageStencilSampleCounts) X(storageImageSampleCounts) X(maxSampleMaskWords) X(timestampComputeAndGraphics) \
  X(timestampPeriod) X(maxClipDistances) X(maxCullDistances) X(maxCombinedClipAndCullDistances) \
  X(discreteQueuePriorities) X(pointSizeGranularity) X(lineWidthGranularity) X(strictLines) \
  X(standardSampleLocations) X(optimalBufferCopyOffsetAlignment) X(optimalBufferCopyRowPitchAlignment) \
  X(nonCoherentAtomSize) X(maxComputeWorkGroupCount) X(maxComputeWorkGroupSize) X(maxViewportDimensions) \
  X(viewportBoundsRange) X(pointSizeRange) X(lineWidthRange)
// clang-format on

nlohmann::json limits_json(const VkPhysicalDeviceLimits& limits) {
  nlohmann::json j;
#define CLOTHBENCH_PUT(member) j[#member] = limits.member;
  CLOTHBENCH_LIMITS(CLOTHBENCH_PUT)
#undef CLOTHBENCH_PUT
  return j;
}

}  // namespace clothbench::vulkan
