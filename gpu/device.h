#pragma once
// Which Vulkan device computes, and why the others do not. No Vulkan type leaves this module.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sf::gpu {

/// One Vulkan device as it was considered.
struct DeviceInfo {
  std::string name;       ///< as the driver gives it
  std::string driver;     ///< driver name and version
  std::string api;        ///< Vulkan version, e.g. "1.3.230"
  std::string kind;       ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  bool software = false;  ///< computed on the CPU
  bool chosen = false;
  std::string reason;                  ///< why it was refused or not chosen; empty for the chosen one
  std::string self_check = "not run";  ///< "passed", "failed" (`reason` says in what) or "not run"
};

/// Opens Vulkan, considers every device, and runs the self-check on each that lacks nothing.
/// `wanted` is empty (best usable device), a row number of the list, or a part of a device's name.
/// Throws nothing for "no device": the list then has no chosen row. `problem` says what is wrong with Vulkan itself, if
/// anything.
struct DeviceList {
  std::vector<DeviceInfo> devices;
  std::string problem;
};
DeviceList list_devices(const std::string& wanted);

/// A table or a kernel on a device.
struct DeviceAllocation {
  std::string owner;  ///< as `Device::set_owner` had it when it was made
  std::string name;
  std::size_t bytes = 0;  ///< of the table, or of the kernel's SPIR-V
  bool is_kernel = false;
};

/// One open device with one compute queue. Used by one thread at a time; must outlive all that is made on it.
class Device {
 public:
  /// The first device, best first, that is wanted, opens and passes the self-check.
  /// @throws base::DeviceError: one line that lists every device considered and why it was refused.
  explicit Device(const std::string& wanted = "");
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;
  /// Host and device share memory: uploads and downloads copy nothing. Never so where the environment had
  /// SENSORFARM_STAGING=1 when it was opened, by which tests copy on any device.
  bool unified() const;
  /// All tables and kernels that live on it, in the order in which they were made.
  std::vector<DeviceAllocation> allocations() const;
  /// Whose what is made from here on is: a kind of sensor.
  void set_owner(std::string_view owner);
  /// Messages of the validation layer so far; it is on when the environment has SENSORFARM_VALIDATE=1. "" when silent.
  std::string validation_messages() const;

  struct Vk;  ///< the Vulkan handles, for this module only
  explicit Device(std::unique_ptr<Vk> vk);
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
