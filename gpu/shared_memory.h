#pragma once
// Tables of a Vulkan device with its own memory, as CUDA sees them on the same GPU.
//
//   const ExportScope scope(device);       // tables made from here on can be shared
//   Buffer table(device, ...);
//   auto memory = CudaMemory::of(table);   // null: no libcuda, another GPU, or a driver that exports no memory
//
// libcuda.so.1, or the file that SENSORFARM_LIBCUDA names, is opened at the first use. It has not run on hardware: the
// tests use a libcuda of their own.

#include <cstddef>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/device.h"

namespace sf::gpu {

/// Tables that are constructed on a device while this object exists have memory that other processes and APIs can
/// import, where the device exports any and does not share its memory with the host.
class ExportScope {
 public:
  explicit ExportScope(Device& device);
  ~ExportScope();
  ExportScope(const ExportScope&) = delete;
  ExportScope& operator=(const ExportScope&) = delete;

 private:
  Device& device_;
};

/// The memory of a table that kernels use; valid as long as the table.
class CudaMemory {
 public:
  /// Returns null where the memory cannot be shared.
  static std::shared_ptr<CudaMemory> of(const Buffer& table);
  ~CudaMemory();
  CudaMemory(const CudaMemory&) = delete;
  CudaMemory& operator=(const CudaMemory&) = delete;

  void* data() const { return data_; }    ///< address in CUDA's primary context of `device`
  int device() const { return device_; }  ///< CUDA's number, not its CUdevice

 private:
  CudaMemory() = default;
  int device_ = -1, cu_device_ = -1;
  void* data_ = nullptr;
  void* handle_ = nullptr;  ///< CUexternalMemory
  bool retained_ = false;   ///< the primary context
};

}  // namespace sf::gpu
