// Chooses the device. Unsuitable devices are rejected first; then the user's choice decides, then the device type.

#include <algorithm>
#include <cctype>
#include <charconv>

#include "gpu/device_vk.h"

namespace sf::gpu {

namespace {

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

int rank(const DeviceInfo& info) {
  if (info.kind == "discrete GPU") return 4;
  if (info.kind == "integrated GPU") return 3;
  if (info.kind == "virtual GPU") return 2;
  return info.kind == "CPU" ? 1 : 0;
}

bool subgroups_vote(VkPhysicalDevice physical) {
  VkPhysicalDeviceSubgroupProperties subgroups{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  all.pNext = &subgroups;
  vkGetPhysicalDeviceProperties2(physical, &all);
  return (subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
         (subgroups.supportedOperations & VK_SUBGROUP_FEATURE_VOTE_BIT) != 0;
}

DeviceFeatures features_of(VkPhysicalDevice physical, std::uint32_t api) {
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(physical, &features);
  DeviceFeatures supported{
      api, features.shaderFloat64 == VK_TRUE, compute_queue_family(physical) >= 0, subgroups_vote(physical), {}};
  for (const VkFormat format :
       {VK_FORMAT_R32_UINT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_UINT}) {
    VkFormatProperties support;
    vkGetPhysicalDeviceFormatProperties(physical, format, &support);
    if (!(support.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT)) supported.missing.push_back(format);
  }
  return supported;
}

DeviceInfo info_of(VkPhysicalDevice physical) {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceProperties plain;
  vkGetPhysicalDeviceProperties(physical, &plain);
  if (plain.apiVersion >= VK_API_VERSION_1_2) all.pNext = &driver;
  vkGetPhysicalDeviceProperties2(physical, &all);
  DeviceInfo info;
  info.name = all.properties.deviceName;
  info.driver = std::string(driver.driverName) + (driver.driverInfo[0] ? " " : "") + driver.driverInfo;
  info.api = version_text(all.properties.apiVersion);
  info.kind = device_type_text(all.properties.deviceType);
  info.software = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.reason = missing_feature(features_of(physical, all.properties.apiVersion));
  return info;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_wanted(const DeviceInfo& info, std::size_t row, const std::string& wanted) {
  if (wanted.empty()) return true;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (error == std::errc() && end == wanted.data() + wanted.size()) return number == row;
  return lower(info.name + " " + info.driver).find(lower(wanted)) != std::string::npos;
}

}  // namespace

const char* device_type_text(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "CPU";
    default:
      return "other";
  }
}

std::string missing_feature(const DeviceFeatures& supported) {
  if (supported.api < VK_API_VERSION_1_2) return "needs Vulkan 1.2, has " + version_text(supported.api);
  if (!supported.doubles) return "has no 64-bit floating point in shaders (shaderFloat64)";
  if (!supported.compute) return "has no compute queue";
  if (!supported.votes) return "has no votes of subgroups in compute shaders (VK_SUBGROUP_FEATURE_VOTE_BIT)";
  if (supported.missing.empty()) return "";
  return "has no storage texel buffers of VkFormat " + std::to_string(supported.missing.front());
}

int compute_queue_family(std::span<const VkQueueFamilyProperties> families) {
  int best = -1;
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
    const bool plain = !(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT);
    if (best < 0 || plain) best = static_cast<int>(i);
    if (plain) break;
  }
  return best;
}

int compute_queue_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  return compute_queue_family(families);
}

DeviceCandidates find_candidates(const Instance& instance) {
  DeviceCandidates candidates;
  if (!instance.handle) return candidates;
  std::uint32_t count = 0;
  if (vkEnumeratePhysicalDevices(instance.handle, &count, nullptr) != VK_SUCCESS) return candidates;
  candidates.handles.resize(count);
  if (vkEnumeratePhysicalDevices(instance.handle, &count, candidates.handles.data()) < 0) count = 0;
  candidates.handles.resize(count);
  for (const VkPhysicalDevice physical : candidates.handles) candidates.info.push_back(info_of(physical));
  return candidates;
}

int choose_device(DeviceCandidates& candidates, const std::string& wanted) {
  int best = -1;
  for (std::size_t row = 0; row < candidates.info.size(); ++row) {
    DeviceInfo& info = candidates.info[row];
    if (!info.reason.empty()) continue;
    if (!is_wanted(info, row, wanted)) {
      info.reason = "does not match '" + wanted + "'";
      continue;
    }
    if (best < 0 || rank(info) > rank(candidates.info[static_cast<std::size_t>(best)])) best = static_cast<int>(row);
  }
  for (std::size_t row = 0; row < candidates.info.size(); ++row) {
    DeviceInfo& info = candidates.info[row];
    info.chosen = static_cast<int>(row) == best;
    if (!info.chosen && info.reason.empty()) info.reason = "usable, but another ranks higher; select it with --device";
  }
  return best;
}

int choose_device(DeviceCandidates& candidates, const std::string& wanted, const TryDevice& start) {
  DeviceCandidates working = candidates;
  for (;;) {
    candidates = working;
    const int best = choose_device(candidates, wanted);
    if (best < 0) return best;
    const auto row = static_cast<std::size_t>(best);
    const std::string fault = start(candidates, row);
    if (fault.empty()) return best;
    working.info[row].reason = fault;
    working.info[row].self_check = candidates.info[row].self_check;
  }
}

}  // namespace sf::gpu
