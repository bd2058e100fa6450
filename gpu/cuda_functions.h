#pragma once
// The functions of libcuda that share memory, declared here so that no headers of CUDA are needed (CUDA 10.2 and
// later).

#include <array>
#include <cstdint>

namespace sf::gpu {

using CudaUuid = std::array<unsigned char, 16>;

/// CUDA_EXTERNAL_MEMORY_HANDLE_DESC
struct CudaHandle {
  int type = 1;  ///< CU_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD
  union {
    int fd;
    void* pair[2];
  } handle{};
  unsigned long long size = 0;
  unsigned flags = 0;
  unsigned reserved[16]{};
};

/// CUDA_EXTERNAL_MEMORY_BUFFER_DESC
struct CudaRange {
  unsigned long long offset = 0, size = 0;
  unsigned flags = 0;
  unsigned reserved[16]{};
};
static_assert(sizeof(CudaHandle) == 104 && sizeof(CudaRange) == 88);

/// All return 0 on success. Null: libcuda is missing.
struct CudaFunctions {
  int (*init)(unsigned) = nullptr;
  int (*count)(int*) = nullptr;
  int (*get)(int* device, int number) = nullptr;
  int (*uuid)(CudaUuid*, int device) = nullptr;
  int (*retain)(void** context, int device) = nullptr;
  int (*release)(int device) = nullptr;
  int (*push)(void* context) = nullptr;
  int (*pop)(void** context) = nullptr;
  int (*import)(void** memory, const CudaHandle*) = nullptr;
  int (*map)(std::uint64_t* address, void* memory, const CudaRange*) = nullptr;
  int (*unmap)(std::uint64_t address) = nullptr;
  int (*destroy)(void* memory) = nullptr;
};

/// Opens libcuda at the first call; thread-safe. @return null if it is missing, too old or finds no device
const CudaFunctions* open_cuda();

}  // namespace sf::gpu
