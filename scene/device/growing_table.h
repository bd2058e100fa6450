#pragma once
// A table on the device to which records are added at its end.

#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "gpu/batch.h"
#include "gpu/buffer.h"

namespace sf::scene {

class GrowingTable {
 public:
  /// @throws base::DeviceError as gpu::Buffer
  GrowingTable(gpu::Device& device, std::string_view name, gpu::Texel texel);

  void clear() { used_ = uploaded_ = 0; }
  std::size_t bytes() const { return used_; }
  /// Adds records. @throws base::DeviceError if the table would exceed a limit of the device; it is unchanged then
  template <class Record>
  void add(std::span<const Record> records) {
    if (!records.empty()) std::memcpy(extend(records.size_bytes()), records.data(), records.size_bytes());
  }
  /// Returns true if the table is a new buffer since the last call.
  bool take_replaced();
  const gpu::Buffer& buffer() const { return buffer_; }
  /// Copies what was added since the last call to the device.
  void upload(gpu::Batch& batch);

 private:
  std::byte* extend(std::size_t size);

  gpu::Device& device_;
  std::string name_;
  gpu::Texel texel_;
  gpu::Buffer buffer_;
  std::size_t used_ = 0, uploaded_ = 0;  ///< [bytes]
  bool replaced_ = true;
};

}  // namespace sf::scene
