#pragma once
// Opens the device of a command.

#include "apps/options/options.h"
#include "gpu/device.h"

namespace sf::apps {

/// Opens the device that `options` select. The caster `vulkan` requires a Vulkan device, as `--require-vulkan` does.
/// @throws base::DeviceError if there is no usable device
gpu::Device open_device_silently(const DeviceOption& options);

/// Prints one line that explains why a device with a higher rank is not used.
void print_notice(const gpu::Device& device);

/// Opens the device and prints the notice.
gpu::Device open_device(const DeviceOption& options);

}  // namespace sf::apps
