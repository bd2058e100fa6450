#pragma once
// The Vulkan device that computes, and the reasons against the others, or the host in its place. No Vulkan type leaves
// this module.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sf::gpu {

/// Name of the host as a device: no kernel runs, and sensors are computed by the host's code, with the same bytes.
/// In any case of its letters.
inline constexpr std::string_view kHostDevice = "host";

/// One Vulkan device with the result of its check, or the host.
struct DeviceInfo {
  std::string name;       ///< as reported by the driver; `kHostDevice`
  std::string driver;     ///< driver name and version
  std::string api;        ///< Vulkan version, e.g. "1.3.230"; empty for the host
  std::string kind;       ///< "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other"
  bool software = false;  ///< true: implemented on the CPU
  bool chosen = false;
  std::string reason;                  ///< why it was refused or not chosen; empty for the chosen one
  std::string self_check = "not run";  ///< "passed", "failed" (with the difference in `reason`), "not run" or, for the
                                       ///< host, "not needed"
};

/// The devices of this machine.
struct DeviceList {
  std::vector<DeviceInfo> devices;  ///< the last one is the host
  std::string problem;              ///< failure of Vulkan itself; empty when it opened
};
/// Opens Vulkan, checks every device, and runs the self-check on each suitable one.
/// @param wanted empty (best usable device, else the host), a row number of the list, a part of a device's name, or
/// `kHostDevice`
/// @param require_vulkan as in `Device::or_host`
/// @return without a usable device, a list without a chosen row; does not throw
DeviceList list_devices(const std::string& wanted, bool require_vulkan = false);

/// A table or a kernel on a device.
struct DeviceAllocation {
  std::string owner;  ///< value of `Device::set_owner` at its construction
  std::string name;
  std::size_t bytes = 0;  ///< of the table, or of the kernel's SPIR-V
  bool is_kernel = false;
};

/// One open device with one compute queue, or the host. Not thread-safe; must outlive all objects made on it.
class Device {
 public:
  /// Opens the best Vulkan device that matches `wanted` and passes the self-check. `kHostDevice` names the host.
  /// @throws base::DeviceError: one line with every device and the reason for its refusal
  explicit Device(const std::string& wanted = "");
  /// The same; without a usable Vulkan device the host, with a `notice`, where nothing asks for a device.
  /// @param wanted empty: nothing asks for one by name
  /// @param require_vulkan the host is refused, as it is where the environment variable SENSORFARM_REQUIRE_VULKAN=1 is
  /// set
  /// @throws base::DeviceError as above, and for a host that is refused
  static Device or_host(const std::string& wanted, bool require_vulkan);
  ~Device();
  /// Only before anything was made on it.
  Device(Device&&) noexcept;
  Device& operator=(Device&&) = delete;

  const DeviceInfo& info() const;
  bool is_host() const;  ///< no kernel may be dispatched: backends compute on the host
  /// One line for the user: why a device that ranks higher is not used; "" where there is none.
  const std::string& notice() const;
  /// True when host and device share memory, so that uploads and downloads copy nothing. Always false when
  /// SENSORFARM_STAGING=1 was set at construction, which has any device treated as a GPU with its own memory.
  bool unified() const;
  bool is_gpu() const;  ///< not software, or treated as a GPU
  /// True when 32-bit roots and quotients are correctly rounded: the constant kRounds32 of kernels. False for GPUs that
  /// differ, and where a device is treated as a GPU.
  bool rounds32() const;
  /// All tables and kernels on the device, in order of construction.
  std::vector<DeviceAllocation> allocations() const;
  /// Sets the owner of tables and kernels made from now on: a sensor type's name.
  void set_owner(std::string_view owner);
  /// Messages of the validation layer so far; "" without messages. The environment variable SENSORFARM_VALIDATE=1
  /// enables it.
  std::string validation_messages() const;

  struct Vk;  ///< the Vulkan handles, for this module only
  explicit Device(std::unique_ptr<Vk> vk);
  Vk& vk() const { return *vk_; }

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
