#pragma once
// The Vulkan device that computes, with the reasons for rejecting the others, or the host instead. No Vulkan type
// leaves this module.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sf::gpu {

/// Name of the host as a device, in upper or lower case. The host runs no kernels: sensors are computed by host code,
/// with the same bytes.
inline constexpr std::string_view kHostDevice = "host";

/// One Vulkan device with the result of its check, or the host.
struct DeviceInfo {
  std::string name;       ///< as reported by the driver; `kHostDevice`
  std::string driver;     ///< driver name and version
  std::string api;        ///< Vulkan version, e.g. "1.3.230"; empty for the host
  std::string kind;       ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  bool software = false;  ///< true: implemented on the CPU
  bool chosen = false;
  std::string reason;                  ///< why it was rejected or not chosen; empty for the chosen device
  std::string self_check = "not run";  ///< "passed", "failed" (with the difference in `reason`), "not run" or, for the
                                       ///< host, "not needed"
};

/// The devices of this machine.
struct DeviceList {
  std::vector<DeviceInfo> devices;  ///< the last one is the host
  std::string problem;              ///< failure of Vulkan itself; empty if it opened
};
/// Opens Vulkan, checks every device, and runs the self-check on each suitable one.
/// @param wanted empty (best usable device, else the host), a row number of the list, a part of a device's name, or
/// `kHostDevice`
/// @param require_vulkan as in `Device::or_host`
/// @return a list without a chosen row if no device is usable; does not throw
DeviceList list_devices(const std::string& wanted, bool require_vulkan = false);

/// A table or a kernel on a device.
struct DeviceAllocation {
  std::string owner;  ///< value of `Device::set_owner` when it was constructed
  std::string name;
  std::size_t bytes = 0;  ///< of the table, or of the kernel's SPIR-V
  bool is_kernel = false;
};

/// One open device with one compute queue, or the host. Not thread-safe. Must outlive all objects created on it.
class Device {
 public:
  /// Opens the best Vulkan device that matches `wanted` and passes the self-check. `kHostDevice` selects the host.
  /// @throws base::DeviceError: one line with every device and the reason for its rejection
  explicit Device(const std::string& wanted = "");
  /// Same, but falls back to the host, with a `notice`, if there is no usable Vulkan device and none was requested.
  /// @param wanted empty: no device was requested by name
  /// @param require_vulkan rejects the host, as does the environment variable SENSORFARM_REQUIRE_VULKAN=1
  /// @throws base::DeviceError as above, and when the host is rejected
  static Device or_host(const std::string& wanted, bool require_vulkan);
  ~Device();
  /// Move a device only before objects are created on it.
  Device(Device&&) noexcept;
  Device& operator=(Device&&) = delete;

  const DeviceInfo& info() const;
  bool is_host() const;  ///< true: kernels cannot be dispatched; backends compute on the host
  /// Returns one line for the user that explains why a higher-ranked device is not used; "" if there is none.
  const std::string& notice() const;
  /// Returns true when host and device share memory, so uploads and downloads copy nothing. Always false if
  /// SENSORFARM_STAGING=1 was set at construction, which makes any device be treated as a GPU with its own memory.
  bool unified() const;
  bool is_gpu() const;  ///< true: not software, or treated as a GPU
  /// Returns true when 32-bit roots and quotients are correctly rounded: the constant kRounds32 of kernels. False for
  /// GPUs that round differently and for devices treated as GPUs.
  bool rounds32() const;
  /// Returns all tables and kernels on the device, in order of construction.
  std::vector<DeviceAllocation> allocations() const;
  /// Sets the owner, a sensor type's name, of tables and kernels created from now on.
  void set_owner(std::string_view owner);
  /// Returns the messages of the validation layer so far, or "". The environment variable SENSORFARM_VALIDATE=1 enables
  /// the layer.
  std::string validation_messages() const;

  struct Vk;  ///< the Vulkan handles, for this module only
  explicit Device(std::unique_ptr<Vk> vk);
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
