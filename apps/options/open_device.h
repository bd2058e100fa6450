#pragma once
// The device of a command.

#include "apps/options/options.h"
#include "gpu/device.h"

namespace sf::apps {

/// Opens the device as `options` choose it. The caster `vulkan` asks for a Vulkan device, as `--require-vulkan` does.
/// @throws base::DeviceError without a usable one
gpu::Device open_device_silently(const DeviceOption& options);

/// Says in one line why a device that ranks higher is not used.
void print_notice(const gpu::Device& device);

/// Both.
gpu::Device open_device(const DeviceOption& options);

}  // namespace sf::apps
