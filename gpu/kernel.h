#pragma once
// A compute shader with its tables.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "gpu/buffer.h"
#include "gpu/device.h"

namespace sf::gpu {

/// Binding i of descriptor set 0 is the i-th table of `bind`: an `imageBuffer` in the table's texel format, or a
/// `buffer`.
class Kernel {
 public:
  /// @param name for Device::allocations
  /// @param spirv words of a module with one entry point `main`; its group size is read from the module
  /// @param buffers number of tables, the last ones, that are bound as storage buffers, up to the device's size limit
  /// @param constants values of the module's constant_ids from 0 on, one word each
  Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> spirv, std::uint32_t tables,
         std::uint32_t buffers = 0, std::span<const std::uint32_t> constants = {});
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Sets the tables of the dispatches recorded next. Tables must outlive these dispatches.
  void bind(std::span<Buffer* const> tables);

  std::uint32_t group_size() const;  ///< invocations along x per group

  struct Vk;
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

/// LocalSize x of a SPIR-V module's entry point; 0 without one.
std::uint32_t group_size_of(std::span<const std::uint32_t> spirv);

}  // namespace sf::gpu
