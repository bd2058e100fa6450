#pragma once
// Vulkan promises little about 64-bit arithmetic, and the farm's last word on every range is 64-bit.

#include <string>

#include "gpu/device.h"

namespace sf::gpu {

/// Computes sums, products, quotients and roundings on the device and on the host.
/// @return "" when they agree to the bit, else one line that says which operation differed.
std::string self_check(Device& device);

}  // namespace sf::gpu
