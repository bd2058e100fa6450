#pragma once
// The Vulkan handles behind gpu::Device, for the sources of this room only.

#include <vulkan/vulkan.h>

#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gpu/device.h"

namespace sf::gpu {

/// An environment variable that is neither empty nor 0.
bool is_set(const char* variable);

/// Aborts with the call's name: a Vulkan call that fails after start-up is our bug or a lost device.
void must(VkResult result, const char* call);

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  std::string problem;   ///< why there is no instance
  std::string messages;  ///< of the validation layer
  std::mutex lock;

  Instance();
  ~Instance();
};

struct Device::Vk {
  std::unique_ptr<Instance> instance;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  bool unified = false;
  DeviceFacts facts;
  std::string owner;
  std::vector<std::pair<const void*, Held>> held;  ///< in the order in which they were made

  void hold(const void* what, std::string_view name, std::size_t bytes, bool is_kernel);
  void let_go(const void* what);
  /// Row of a memory type with all of `wanted` among `allowed`, or -1.
  int memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;
};

/// All physical devices of `instance`, considered but none chosen yet: row i of `facts` belongs to row i of `handles`.
/// A non-empty `reason` says what the device lacks.
struct Considered {
  std::vector<VkPhysicalDevice> handles;
  std::vector<DeviceFacts> facts;
};
Considered consider(const Instance& instance);

/// As in `DeviceFacts::kind`.
const char* kind_text(VkPhysicalDeviceType type);

/// Marks the chosen row, gives the others a reason, and returns the chosen row or -1.
int choose(Considered& considered, const std::string& wanted);

/// As above, but a row for which `start` gives a fault has that for its reason, and the next best is chosen.
using Start = std::function<std::string(Considered&, std::size_t row)>;
int choose(Considered& considered, const std::string& wanted, const Start& start);

/// The features that a device must have.
struct Abilities {
  std::uint32_t api = 0;  ///< as VK_MAKE_API_VERSION
  bool doubles = false;
  bool compute = false;
  std::vector<VkFormat> missing;  ///< formats without storage texel buffers
};

/// The first of its lacks, or "".
std::string lacks(const Abilities& abilities);

/// Compute queue family, one without graphics if there is one, or -1.
int compute_family(std::span<const VkQueueFamilyProperties> families);
int compute_family(VkPhysicalDevice physical);

}  // namespace sf::gpu
