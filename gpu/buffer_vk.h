#pragma once
// The Vulkan handles behind gpu::Buffer, for the sources of this module only.

#include "gpu/buffer.h"
#include "gpu/device_vk.h"

namespace sf::gpu {

/// A VkBuffer with its memory.
struct Storage {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;  ///< [bytes] of the memory
  bool exported = false;  ///< the memory has a file descriptor (gpu/shared_memory.h)
};

struct Buffer::Vk {
  Device::Vk* device = nullptr;
  Role role = Role::upload;
  Texel texel = Texel::u32;
  std::size_t texels = 0;
  Storage table;    ///< bound to kernels
  Storage staging;  ///< mapped by the host, if separate from the table
  VkBufferView view = VK_NULL_HANDLE;
  void* mapped = nullptr;
};

}  // namespace sf::gpu
