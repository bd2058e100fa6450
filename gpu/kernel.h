#pragma once
// A compute shader with the tables it reads and writes.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "gpu/buffer.h"
#include "gpu/device.h"

namespace sf::gpu {

/// Binding i of descriptor set 0 is the i-th table given to `bind`: an `imageBuffer` of the table's texel, or a
/// `buffer`.
class Kernel {
 public:
  /// @param name what it computes, for Device::allocations
  /// @param spirv words of a module with one entry point `main`; its group size is read from the module.
  /// @param buffers how many of the tables, the last ones, are bound as buffers: as much of them as the device bears
  /// @param constants of the module, from constant_id 0 on: one word each
  Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> spirv, std::uint32_t tables,
         std::uint32_t buffers = 0, std::span<const std::uint32_t> constants = {});
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Which tables the next recorded dispatches use. Tables must outlive those dispatches.
  void bind(std::span<Buffer* const> tables);

  std::uint32_t group_size() const;  ///< invocations along x per group

  struct Vk;
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

/// LocalSize x of a SPIR-V module's entry point; 0 when it has none.
std::uint32_t group_size_of(std::span<const std::uint32_t> spirv);

}  // namespace sf::gpu
