#pragma once
// One Vulkan device per test program.

#include "gpu/device.h"

namespace sf {

inline gpu::Device& device() {
  static gpu::Device device;
  return device;
}

}  // namespace sf
