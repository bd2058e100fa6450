#pragma once
// Tables that the device reads and writes as texel buffers. On lavapipe, loads from texel buffers are vectorized
// gathers, while loads from storage buffers are not; stores to storage buffers take a fifth of the time.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "gpu/device.h"

namespace sf::gpu {

/// Format of one texel: one word or four. Every Vulkan device must support stores to these formats.
enum class Texel { u32, f32, u32x4, f32x4 };

/// Direction of a table's copies.
enum class Role {
  upload,    ///< written by the host, read by kernels
  download,  ///< written by kernels, read by the host
};

std::size_t texel_size(Texel texel);  ///< [bytes] 4 or 16

/// Returns the number of 16-byte texels in a table of `records` records.
template <class Record>
constexpr std::size_t texels_of(std::size_t records) {
  static_assert(sizeof(Record) % 16 == 0);
  return sizeof(Record) / 16 * records;
}

/// A table of texels with a host view. On a unified device the host view is the table itself; on others, a Batch copies
/// between them.
class Buffer {
 public:
  /// @param name description of the contents, for Device::allocations
  /// @param texels capacity, at least 1
  /// @throws base::DeviceError, with the device's limit, when the table is too large
  Buffer(Device& device, std::string_view name, Role role, Texel texel, std::size_t texels);
  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

  /// Returns a host view of the whole table, valid as long as the buffer. `sizeof(T)` must divide the table's size.
  template <class T>
  std::span<T> host() {
    return {static_cast<T*>(mapped()), bytes() / sizeof(T)};
  }
  std::size_t bytes() const;
  std::size_t texels() const;
  /// Returns true when a kernel can write the whole table as a storage `buffer`.
  bool fits_storage_buffer() const;

  struct Vk;
  Vk& vk() const { return *vk_; }

 private:
  void* mapped() const;
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
