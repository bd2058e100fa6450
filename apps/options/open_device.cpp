#include "apps/options/open_device.h"

#include "apps/reports/text.h"
#include "raycast/casters.h"

namespace sf::apps {

gpu::Device open_device_silently(const DeviceOption& options) {
  const bool kernels_cast = raycast::choose_caster(true).on_device;
  return gpu::Device::or_host(options.device, options.require_vulkan || kernels_cast);
}

void print_notice(const gpu::Device& device) {
  if (!device.notice().empty()) print_message(device.notice());
  const std::string messages = device.validation_messages();
  for (std::string_view rest = messages; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    print_message("{}", rest.substr(0, end));
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  }
}

gpu::Device open_device(const DeviceOption& options) {
  gpu::Device device = open_device_silently(options);
  print_notice(device);
  return device;
}

}  // namespace sf::apps
