#pragma once
// Comparison of a device's arithmetic with the host's. Run on every device before it is used.

#include <cstdint>
#include <span>
#include <string>

#include "gpu/device.h"

namespace sf::gpu {

struct SelfCheck {
  std::string fault;      ///< "" where device and host agree, else one line with the first difference: operation,
                          ///< operands, found and expected
  bool rounds32 = false;  ///< as gpu::rounds32
};

/// Runs the operations of gpu/self_check_arithmetic.h on the device, in the form in which kernels use them, and on the
/// host.
SelfCheck self_check(Device& device);

/// The same with another kernel in place of shaders/self_check.comp.
SelfCheck self_check(Device& device, std::span<const std::uint32_t> spirv);

}  // namespace sf::gpu
