#pragma once
// The functions of the Vulkan loader. The loader is opened when the first instance is created, so the program starts
// even if it is not installed.

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <string>

namespace sf::gpu {

#define SF_VULKAN_FUNCTIONS(each)                                                                                      \
  each(vkAllocateCommandBuffers) each(vkAllocateDescriptorSets) each(vkAllocateMemory) each(vkBeginCommandBuffer)      \
      each(vkBindBufferMemory) each(vkCmdBindDescriptorSets) each(vkCmdBindPipeline) each(vkCmdCopyBuffer)             \
          each(vkCmdDispatchIndirect) each(vkCmdPipelineBarrier) each(vkCreateBuffer) each(vkCreateBufferView) each(   \
              vkCreateCommandPool) each(vkCreateComputePipelines) each(vkCreateDescriptorPool)                         \
              each(vkCreateDescriptorSetLayout) each(vkCreateDevice) each(vkCreateFence) each(vkCreateInstance) each(  \
                  vkCreatePipelineLayout) each(vkCreateShaderModule) each(vkDestroyBuffer) each(vkDestroyBufferView)   \
                  each(vkDestroyCommandPool) each(vkDestroyDescriptorPool) each(vkDestroyDescriptorSetLayout)          \
                      each(vkDestroyDevice) each(vkDestroyFence) each(vkDestroyInstance) each(vkDestroyPipeline) each( \
                          vkDestroyPipelineLayout) each(vkDestroyShaderModule) each(vkDeviceWaitIdle)                  \
                          each(vkEndCommandBuffer) each(vkEnumerateDeviceExtensionProperties) each(                    \
                              vkEnumerateInstanceLayerProperties) each(vkEnumeratePhysicalDevices) each(vkFreeMemory)  \
                              each(vkGetBufferMemoryRequirements) each(vkGetDeviceProcAddr) each(vkGetDeviceQueue)     \
                                  each(vkGetInstanceProcAddr) each(vkGetPhysicalDeviceExternalBufferProperties)        \
                                      each(vkGetPhysicalDeviceFeatures) each(vkGetPhysicalDeviceFormatProperties)      \
                                          each(vkGetPhysicalDeviceMemoryProperties)                                    \
                                              each(vkGetPhysicalDeviceProperties) each(vkGetPhysicalDeviceProperties2) \
                                                  each(vkGetPhysicalDeviceQueueFamilyProperties) each(vkMapMemory)     \
                                                      each(vkQueueSubmit) each(vkResetFences)                          \
                                                          each(vkUpdateDescriptorSets) each(vkWaitForFences)

#define SF_DECLARE_FUNCTION(name) extern PFN_##name name;
SF_VULKAN_FUNCTIONS(SF_DECLARE_FUNCTION)
#undef SF_DECLARE_FUNCTION

/// Opens the loader at the first call; thread-safe. The functions may be called after a success.
/// @return "" or the reason for the failure
const std::string& open_vulkan_loader();

}  // namespace sf::gpu
