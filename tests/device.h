#pragma once
// One Vulkan device per test program, and the host as a device.

#include <string>

#include "gpu/device.h"

namespace sf {

inline gpu::Device& device() {
  static gpu::Device device;
  return device;
}

inline gpu::Device& host_device() {
  static gpu::Device host{std::string(gpu::kHostDevice)};
  return host;
}

}  // namespace sf
