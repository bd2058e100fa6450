#include "gpu/shared_memory.h"

#include <unistd.h>

#include <algorithm>

#include "gpu/buffer_vk.h"
#include "gpu/cuda_functions.h"

namespace sf::gpu {

namespace {

/// Returns the number of CUDA's device with this UUID, or -1. @param handle out: its CUdevice
int cuda_device_of(const CudaFunctions& cuda, const std::uint8_t (&uuid)[VK_UUID_SIZE], int& handle) {
  int count = 0;
  if (cuda.count(&count) != 0) return -1;
  for (int number = 0; number < count; ++number) {
    CudaUuid own{};
    if (cuda.get(&handle, number) == 0 && cuda.uuid(&own, handle) == 0 && std::ranges::equal(own, uuid)) return number;
  }
  return -1;
}

/// Returns a file descriptor of the table's memory, or -1.
int exported_fd(const Buffer::Vk& vk) {
  VkMemoryGetFdInfoKHR get{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR};
  get.memory = vk.table.memory;
  get.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  int fd = -1;
  return vk.table.exported && vk.device->memory_fd(vk.device->device, &get, &fd) == VK_SUCCESS ? fd : -1;
}

}  // namespace

ExportScope::ExportScope(Device& device) : device_(device) {
  device_.vk().exporting = device_.vk().memory_fd != nullptr && !device_.unified();
}
ExportScope::~ExportScope() { device_.vk().exporting = false; }

std::shared_ptr<CudaMemory> CudaMemory::of(const Buffer& table) {
  const Buffer::Vk& vk = table.vk();
  const CudaFunctions* const cuda = vk.table.exported ? open_cuda() : nullptr;
  if (cuda == nullptr) return nullptr;
  std::shared_ptr<CudaMemory> made(new CudaMemory);
  made->device_ = cuda_device_of(*cuda, vk.device->uuid, made->cu_device_);
  void* context = nullptr;
  if (made->device_ < 0 || cuda->retain(&context, made->cu_device_) != 0) return nullptr;
  made->retained_ = true;
  if (cuda->push(context) != 0) return nullptr;
  CudaHandle handle;
  handle.size = vk.table.size;
  handle.handle.fd = exported_fd(vk);
  CudaRange range;
  range.size = table.bytes();
  std::uint64_t address = 0;
  if (handle.handle.fd >= 0 && cuda->import(&made->handle_, &handle) != 0) {
    ::close(handle.handle.fd);  // CUDA owns it only after a success
    made->handle_ = nullptr;
  }
  if (made->handle_ != nullptr && cuda->map(&address, made->handle_, &range) == 0)
    made->data_ = reinterpret_cast<void*>(address);
  cuda->pop(&context);
  return made->data_ == nullptr ? nullptr : made;
}

CudaMemory::~CudaMemory() {
  if (!retained_) return;
  const CudaFunctions& cuda = *open_cuda();
  void* context = nullptr;
  if (cuda.retain(&context, cu_device_) == 0) {
    if (cuda.push(context) == 0) {  // fails once CUDA has ended, at the exit of the process
      if (data_ != nullptr) cuda.unmap(reinterpret_cast<std::uint64_t>(data_));
      if (handle_ != nullptr) cuda.destroy(handle_);
      cuda.pop(&context);
    }
    cuda.release(cu_device_);
  }
  cuda.release(cu_device_);
}

}  // namespace sf::gpu
