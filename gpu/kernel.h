#pragma once
// A compute shader with its tables.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/device.h"

namespace sf::gpu {

/// A table as the kernel's source declares it.
struct KernelTable {
  std::string name;
  std::uint32_t binding = 0;  ///< in descriptor set 0
  bool is_buffer = false;     ///< true: a `buffer`; false: an `imageBuffer` of the table's texel
};

/// Declarations of a SPIR-V module.
struct KernelInterface {
  std::uint32_t group_size = 0;  ///< LocalSize x of its entry point; 0 without one
  std::vector<KernelTable> tables;
};
KernelInterface interface_of(std::span<const std::uint32_t> spirv);

struct TableBinding {
  std::string_view name;  ///< as the kernel declares it
  const Buffer* table;
};

/// On the host device, a kernel has its group size and checks its tables, but cannot be dispatched.
class Kernel {
 public:
  /// @param name for Device::allocations
  /// @param spirv words of a module with one entry point `main`; its group size and tables are read from the module.
  /// @param constants values of the module's constant_ids from 0 on, one word each
  Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> spirv,
         std::span<const std::uint32_t> constants = {});
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Sets the tables for all dispatches of the kernel. Call it before they are recorded. Takes all tables that the
  /// kernel declares, in any order. A `buffer` larger than the device's limit is bound up to that limit. Tables must
  /// outlive the dispatches.
  void bind(const std::vector<TableBinding>& tables);

  std::uint32_t group_size() const;  ///< invocations along x per group
  /// Returns `invocations` rounded up to whole groups.
  std::size_t padded(std::size_t invocations) const {
    return (invocations + group_size() - 1) / group_size() * group_size();
  }

  struct Vk;
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
