#pragma once
// Compares a device's arithmetic with the host's. Runs on every device before it is used.

#include <cstdint>
#include <span>
#include <string>

#include "gpu/device.h"

namespace sf::gpu {

struct SelfCheck {
  std::string fault;      ///< "" if device and host agree, else one line with the first difference: operation,
                          ///< operands, found and expected
  bool rounds32 = false;  ///< as gpu::rounds32
};

/// Runs the operations of gpu/self_check_arithmetic.h on the host, and on the device in the form in which kernels use
/// them.
SelfCheck self_check(Device& device);

/// Same, with another kernel instead of shaders/self_check.comp.
SelfCheck self_check(Device& device, std::span<const std::uint32_t> spirv);

}  // namespace sf::gpu
