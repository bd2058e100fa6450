#include "gpu/device.h"

#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/suggest.h"
#include "gpu/device_vk.h"
#include "gpu/self_check.h"

namespace sf::gpu {

namespace {

/// Returns a hint about memory limits, because drivers then fail without a reason; empty if memory is not limited.
std::string limits_text() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return ", or raise the limit of memory (ulimit -v), which is " + std::to_string(limit.rlim_cur >> 20) + " MiB";
}

/// Compares ignoring case.
bool names_host(const std::string& wanted) {
  return std::equal(wanted.begin(), wanted.end(), kHostDevice.begin(), kHostDevice.end(),
                    [](unsigned char a, char b) { return std::tolower(a) == b; });
}

/// Returns a suggestion for a name that no device has, otherwise "".
std::string suggest_device(const std::string& wanted, const DeviceCandidates& candidates) {
  std::vector<std::string_view> names{kHostDevice};
  for (const DeviceInfo& info : candidates.info) names.emplace_back(info.name);
  std::string word = wanted;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word.empty() ? "" : base::suggest(word, names);
}

std::string no_device_message(const Instance& instance, const DeviceCandidates& candidates, const std::string& wanted) {
  const std::string suggestion = suggest_device(wanted, candidates);
  if (!instance.problem.empty())
    return "no Vulkan device: " + instance.problem + "; install a driver (Debian: mesa-vulkan-drivers)" +
           limits_text() + suggestion;
  if (candidates.info.empty())
    return "no Vulkan device found; install a driver (Debian: mesa-vulkan-drivers)" + limits_text() + suggestion;
  std::string line = "no usable Vulkan device among " + std::to_string(candidates.info.size()) + ":";
  for (const DeviceInfo& info : candidates.info) line += " " + info.name + " " + info.reason + ";";
  return line + " select another with --device or SENSORFARM_DEVICE, or install a driver" + limits_text() + suggestion;
}

/// Returns true if the device can export the memory of tables as file descriptors.
bool can_export(VkPhysicalDevice physical) {
  VkPhysicalDeviceExternalBufferInfo table{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_BUFFER_INFO};
  table.usage = VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  table.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  VkExternalBufferProperties properties{VK_STRUCTURE_TYPE_EXTERNAL_BUFFER_PROPERTIES};
  vkGetPhysicalDeviceExternalBufferProperties(physical, &table, &properties);
  const VkExternalMemoryFeatureFlags features = properties.externalMemoryProperties.externalMemoryFeatures;
  if (!(features & VK_EXTERNAL_MEMORY_FEATURE_EXPORTABLE_BIT) ||
      (features & VK_EXTERNAL_MEMORY_FEATURE_DEDICATED_ONLY_BIT))
    return false;
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, all.data());
  return std::ranges::any_of(all, [](const VkExtensionProperties& extension) {
    return std::string_view(extension.extensionName) == VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME;
  });
}

void get_uuid(Device::Vk& vk) {
  VkPhysicalDeviceIDProperties id{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &id;
  vkGetPhysicalDeviceProperties2(vk.physical, &properties);
  std::ranges::copy(id.deviceUUID, vk.uuid);
}

/// Opens the device `vk.physical`. @return "" or the reason for the failure
std::string open(Device::Vk& vk) {
  vkGetPhysicalDeviceProperties(vk.physical, &vk.properties);
  vkGetPhysicalDeviceMemoryProperties(vk.physical, &vk.memory);
  vk.family = static_cast<std::uint32_t>(compute_queue_family(vk.physical));

  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = vk.family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceFeatures features{};
  features.shaderFloat64 = VK_TRUE;
  VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.pEnabledFeatures = &features;
  const char* const fd = VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME;
  create.ppEnabledExtensionNames = &fd;
  create.enabledExtensionCount = can_export(vk.physical) ? 1 : 0;
  if (const VkResult result = vkCreateDevice(vk.physical, &create, nullptr, &vk.device); result != VK_SUCCESS) {
    vk.device = VK_NULL_HANDLE;
    return "could not be opened (vkCreateDevice gave " + std::to_string(result) + ")";
  }
  vkGetDeviceQueue(vk.device, vk.family, 0, &vk.queue);
  vk.memory_fd = create.enabledExtensionCount == 0
                     ? nullptr
                     : reinterpret_cast<PFN_vkGetMemoryFdKHR>(vkGetDeviceProcAddr(vk.device, "vkGetMemoryFdKHR"));
  get_uuid(vk);
  vk.as_gpu = is_set("SENSORFARM_STAGING");
  vk.unified = !vk.as_gpu &&
               vk.memory_type(~0u, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                       VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT) >= 0;
  return "";
}

void close(Device::Vk& vk) {
  if (!vk.device) return;
  vkDeviceWaitIdle(vk.device);
  vkDestroyDevice(vk.device, nullptr);
  vk.device = VK_NULL_HANDLE;
}

/// Opens row `row` in `device` and keeps it open if it passes the self-check. @return "" or the fault
std::string start(Device& device, DeviceCandidates& candidates, std::size_t row) {
  Device::Vk& vk = device.vk();
  DeviceInfo& info = candidates.info[row];
  vk.physical = candidates.handles[row];
  vk.info = info;
  if (const std::string fault = open(vk); !fault.empty()) return fault;
  const auto [fault, rounds32] = self_check(device);
  info.self_check = fault.empty() ? "passed" : "failed";
  vk.rounds32 = rounds32 && !vk.as_gpu;
  if (!fault.empty()) close(vk);
  return fault;
}

}  // namespace

int Device::Vk::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1u) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return static_cast<int>(i);
  return -1;
}

void Device::Vk::add_allocation(const void* what, std::string_view name, std::size_t bytes, bool is_kernel) {
  allocations.emplace_back(what, DeviceAllocation{owner, std::string(name), bytes, is_kernel});
}

void Device::Vk::remove_allocation(const void* what) {
  std::erase_if(allocations, [&](const auto& entry) { return entry.first == what; });
}

namespace {

DeviceInfo host_info() {
  return {.name = std::string(kHostDevice),
          .driver = "sensorfarm's own code",
          .kind = "CPU",
          .software = true,
          .chosen = true,
          .self_check = "not needed"};
}

/// Returns why the host is not the chosen device; "" if it is.
std::string refusal_of_host(const std::string& wanted, bool require_vulkan, bool named, bool other_chosen) {
  if (!named && !wanted.empty()) return "does not match '" + wanted + "'";
  if (require_vulkan)
    return "is not a Vulkan device, but one is required (--require-vulkan, SENSORFARM_REQUIRE_VULKAN or --caster "
           "vulkan)";
  return other_chosen ? "usable, but a Vulkan device ranks higher; select it with --device host" : "";
}

}  // namespace

DeviceList list_devices(const std::string& wanted, bool require_vulkan) {
  Device probe(std::make_unique<Device::Vk>());
  DeviceCandidates candidates = find_candidates(*probe.vk().instance);
  for (std::size_t row = 0; row < candidates.info.size(); ++row) {
    if (!candidates.info[row].reason.empty()) continue;
    candidates.info[row].reason = start(probe, candidates, row);
    close(probe.vk());
  }
  const bool named = names_host(wanted);
  for (DeviceInfo& info : candidates.info)
    if (named && info.reason.empty()) info.reason = "does not match '" + wanted + "'";
  const int row = choose_device(candidates, wanted);
  DeviceInfo host = host_info();
  host.reason = refusal_of_host(wanted, require_vulkan || is_set("SENSORFARM_REQUIRE_VULKAN"), named, row >= 0);
  host.chosen = host.reason.empty();
  candidates.info.push_back(host);
  return {candidates.info, probe.vk().instance->problem};
}

Device::Device(std::unique_ptr<Vk> vk) : vk_(std::move(vk)) { vk_->instance = std::make_unique<Instance>(); }

void Device::Vk::become_host() {
  instance.reset();
  info = host_info();
  unified = rounds32 = true;
  properties.limits.maxTexelBufferElements = properties.limits.maxStorageBufferRange = UINT32_MAX;
}

Device Device::or_host(const std::string& wanted, bool require_vulkan) {
  require_vulkan = require_vulkan || is_set("SENSORFARM_REQUIRE_VULKAN");
  try {
    Device device(wanted);
    if (device.is_host() && require_vulkan)
      throw base::DeviceError(
          "a Vulkan device is required (--require-vulkan, SENSORFARM_REQUIRE_VULKAN or --caster vulkan), but the host "
          "is selected (--device, SENSORFARM_DEVICE); leave out one of the two");
    return device;
  } catch (const base::DeviceError& error) {
    if (!wanted.empty() || require_vulkan) throw;
    Device device{std::string(kHostDevice)};
    device.vk_->notice =
        std::string(error.what()) + "; computing on the host, with the same results (--require-vulkan rejects this)";
    return device;
  }
}

Device::Device(const std::string& wanted) : vk_(std::make_unique<Vk>()) {
  if (names_host(wanted)) {
    vk_->become_host();
    return;
  }
  vk_->instance = std::make_unique<Instance>();
  DeviceCandidates candidates = find_candidates(*vk_->instance);
  std::string failed;
  const int row = choose_device(candidates, wanted, [&](DeviceCandidates& tried, std::size_t at) {
    std::string fault = start(*this, tried, at);
    if (!fault.empty()) failed += tried.info[at].name + " " + fault + "; ";
    return fault;
  });
  if (row < 0) throw base::DeviceError(no_device_message(*vk_->instance, candidates, wanted));
  vk_->info = candidates.info[static_cast<std::size_t>(row)];
  if (!failed.empty()) vk_->notice = failed + "using " + vk_->info.name + " instead";
}

Device::~Device() {
  if (vk_) close(*vk_);
}
Device::Device(Device&&) noexcept = default;

const DeviceInfo& Device::info() const { return vk_->info; }
bool Device::is_host() const { return vk_->is_host(); }
const std::string& Device::notice() const { return vk_->notice; }

bool Device::unified() const { return vk_->unified; }
bool Device::is_gpu() const { return !vk_->info.software || vk_->as_gpu; }
bool Device::rounds32() const { return vk_->rounds32; }

std::vector<DeviceAllocation> Device::allocations() const {
  std::vector<DeviceAllocation> all;
  for (const auto& [what, held] : vk_->allocations) all.push_back(held);
  return all;
}

void Device::set_owner(std::string_view owner) { vk_->owner = owner; }

std::string Device::validation_messages() const {
  if (is_host()) return "";
  const std::scoped_lock guard(vk_->instance->lock);
  return vk_->instance->messages;
}

}  // namespace sf::gpu
