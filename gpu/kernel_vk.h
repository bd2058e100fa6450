#pragma once
// The Vulkan handles behind gpu::Kernel, for the sources of this module only.

#include "gpu/device_vk.h"
#include "gpu/kernel.h"

namespace sf::gpu {

struct Kernel::Vk {
  Device::Vk* device = nullptr;
  VkDescriptorSetLayout tables = VK_NULL_HANDLE;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  VkDescriptorSet set = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline pipeline = VK_NULL_HANDLE;
  KernelInterface declared;
};

}  // namespace sf::gpu
