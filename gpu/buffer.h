#pragma once
// Tables the device reads and writes, as texel buffers: on lavapipe their loads are vector gathers, storage buffers'
// are not, but these are stored to in a fifth of the time.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "gpu/device.h"

namespace sf::gpu {

/// Shape of one texel. One word or four: the formats every Vulkan device must be able to store to.
enum class Texel { u32, f32, u32x4, f32x4 };

/// Which way a table travels.
enum class Role {
  upload,    ///< written by the host, read by kernels
  download,  ///< written by kernels, read by the host
};

std::size_t texel_size(Texel texel);  ///< [bytes] 4 or 16

/// A table of texels with a host view. On a unified device the host view is the table itself; elsewhere a Batch copies.
class Buffer {
 public:
  /// @param name what is in it, for Device::allocations
  /// @param texels capacity, at least 1.
  /// @throws base::DeviceError when the device cannot hold so many, saying its limit.
  Buffer(Device& device, std::string_view name, Role role, Texel texel, std::size_t texels);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  /// Host view of the whole table; lives as long as the buffer. `sizeof(T)` divides the table's size.
  template <class T>
  std::span<T> host() {
    return {static_cast<T*>(mapped()), bytes() / sizeof(T)};
  }
  std::size_t bytes() const;
  std::size_t texels() const;
  /// Whether a kernel can write all of it as a `buffer`.
  bool fits_storage_buffer() const;

  struct Vk;
  Vk& vk() const { return *vk_; }

 private:
  void* mapped() const;
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
