// A libcuda for tests, of one device with the UUID in FAKE_CUDA_UUID: imported memory is the file, mapped.

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <string>

#include "gpu/cuda_functions.h"

namespace {

struct Memory {
  void* data;
  std::size_t size;
};
int held = 0;  // contexts, memories and mappings that are not released
std::size_t last_size = 0;

}  // namespace

extern "C" {

int fake_cuda_held() { return held; }
std::size_t fake_cuda_size() { return last_size; }  ///< [bytes] of the file imported last

int cuInit(unsigned) { return 0; }
int cuDeviceGetCount(int* count) { return *count = 1, 0; }
int cuDeviceGet(int* device, int number) { return *device = number, 0; }
int cuDeviceGetUuid(sf::gpu::CudaUuid* uuid, int) {
  const char* const text = std::getenv("FAKE_CUDA_UUID");
  for (std::size_t i = 0; text != nullptr && i < uuid->size(); ++i)
    (*uuid)[i] = static_cast<unsigned char>(std::strtoul(std::string(text + 2 * i, 2).c_str(), nullptr, 16));
  return 0;
}
int cuDevicePrimaryCtxRetain(void** context, int) { return *context = &held, ++held, 0; }
int cuDevicePrimaryCtxRelease_v2(int) { return --held, 0; }
int cuCtxPushCurrent_v2(void*) { return 0; }
int cuCtxPopCurrent_v2(void**) { return 0; }

int cuImportExternalMemory(void** memory, const sf::gpu::CudaHandle* handle) {
  struct stat status {};
  if (handle->type != 1 || fstat(handle->handle.fd, &status) != 0 ||
      static_cast<unsigned long long>(status.st_size) < handle->size)
    return 1;
  last_size = static_cast<std::size_t>(status.st_size);
  void* const data = mmap(nullptr, last_size, PROT_READ | PROT_WRITE, MAP_SHARED, handle->handle.fd, 0);
  if (data == MAP_FAILED) return 1;
  close(handle->handle.fd);
  *memory = new Memory{data, last_size};
  return ++held, 0;
}
int cuExternalMemoryGetMappedBuffer(std::uint64_t* address, void* memory, const sf::gpu::CudaRange* range) {
  if (range->offset + range->size > static_cast<Memory*>(memory)->size) return 1;
  *address = reinterpret_cast<std::uint64_t>(static_cast<Memory*>(memory)->data);
  return ++held, 0;
}
int cuMemFree_v2(std::uint64_t) { return --held, 0; }
int cuDestroyExternalMemory(void* memory) {
  auto* const own = static_cast<Memory*>(memory);
  munmap(own->data, own->size);
  delete own;
  return --held, 0;
}
}
