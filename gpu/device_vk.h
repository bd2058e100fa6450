#pragma once
// The Vulkan handles behind gpu::Device, for the sources of this module only.

#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gpu/device.h"
#include "gpu/vulkan_functions.h"

namespace sf::gpu {

/// Returns true when an environment variable is neither empty nor "0".
bool is_set(const char* variable);

/// Aborts with the call's name if `result` is an error: a Vulkan call that fails after start-up indicates a bug or a
/// lost device.
void check_vk(VkResult result, const char* call);

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  std::string problem;   ///< why there is no instance
  std::string messages;  ///< messages of the validation layer
  std::mutex lock;

  Instance();
  ~Instance();
};

struct Device::Vk {
  std::unique_ptr<Instance> instance;  ///< null: the host
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  bool as_gpu = false;  ///< SENSORFARM_STAGING was set at construction
  bool unified = false;
  bool rounds32 = false;
  PFN_vkGetMemoryFdKHR memory_fd = nullptr;  ///< null: memory is not exported
  bool exporting = false;                    ///< new tables are exported
  std::uint8_t uuid[VK_UUID_SIZE]{};
  DeviceInfo info;
  std::string notice;  ///< Device::notice
  std::string owner;
  std::vector<std::pair<const void*, DeviceAllocation>> allocations;  ///< in order of construction

  void become_host();
  bool is_host() const { return instance == nullptr; }
  void add_allocation(const void* what, std::string_view name, std::size_t bytes, bool is_kernel);
  void remove_allocation(const void* what);
  /// Returns the row of a memory type among `allowed` that has all properties in `wanted`, or -1.
  int memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;
};

/// All physical devices of `instance`, before any is chosen. Row i of `info` belongs to row i of `handles`. A non-empty
/// `reason` names a missing feature.
struct DeviceCandidates {
  std::vector<VkPhysicalDevice> handles;
  std::vector<DeviceInfo> info;
};
DeviceCandidates find_candidates(const Instance& instance);

/// Returns the text for `DeviceInfo::kind`.
const char* device_type_text(VkPhysicalDeviceType type);

/// Marks the chosen row and gives the others a reason. @return the chosen row, or -1
int choose_device(DeviceCandidates& candidates, const std::string& wanted);

/// Same, but calls `start` on the chosen row. If it returns a fault, the fault becomes the row's reason and the next
/// best row is tried.
using TryDevice = std::function<std::string(DeviceCandidates&, std::size_t row)>;
int choose_device(DeviceCandidates& candidates, const std::string& wanted, const TryDevice& start);

/// Features that a device must have.
struct DeviceFeatures {
  std::uint32_t api = 0;  ///< encoded as by VK_MAKE_API_VERSION
  bool doubles = false;
  bool compute = false;
  bool votes = false;             ///< subgroup votes in kernels
  std::vector<VkFormat> missing;  ///< formats without support for storage texel buffers
};

/// Returns the first missing feature, or "".
std::string missing_feature(const DeviceFeatures& supported);

/// Returns the index of a compute queue family, preferably without graphics, or -1.
int compute_queue_family(std::span<const VkQueueFamilyProperties> families);
int compute_queue_family(VkPhysicalDevice physical);

}  // namespace sf::gpu
