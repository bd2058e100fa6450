// Which device is used. A device is refused for what it lacks, then the user's wish decides, then the kind of device.

#include <algorithm>
#include <cctype>
#include <charconv>

#include "gpu/vk.h"

namespace sf::gpu {

namespace {

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

int rank(const DeviceFacts& facts) {
  if (facts.kind == "discrete GPU") return 4;
  if (facts.kind == "integrated GPU") return 3;
  if (facts.kind == "virtual GPU") return 2;
  return facts.kind == "CPU" ? 1 : 0;
}

Abilities abilities_of(VkPhysicalDevice physical, std::uint32_t api) {
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(physical, &features);
  Abilities abilities{api, features.shaderFloat64 == VK_TRUE, compute_family(physical) >= 0, {}};
  for (const VkFormat format :
       {VK_FORMAT_R32_UINT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_UINT}) {
    VkFormatProperties support;
    vkGetPhysicalDeviceFormatProperties(physical, format, &support);
    if (!(support.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT)) abilities.missing.push_back(format);
  }
  return abilities;
}

DeviceFacts facts_of(VkPhysicalDevice physical) {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceProperties plain;
  vkGetPhysicalDeviceProperties(physical, &plain);
  if (plain.apiVersion >= VK_API_VERSION_1_2) all.pNext = &driver;
  vkGetPhysicalDeviceProperties2(physical, &all);
  DeviceFacts facts;
  facts.name = all.properties.deviceName;
  facts.driver = std::string(driver.driverName) + (driver.driverInfo[0] ? " " : "") + driver.driverInfo;
  facts.api = version_text(all.properties.apiVersion);
  facts.kind = kind_text(all.properties.deviceType);
  facts.software = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  facts.reason = lacks(abilities_of(physical, all.properties.apiVersion));
  return facts;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_wanted(const DeviceFacts& facts, std::size_t row, const std::string& wanted) {
  if (wanted.empty()) return true;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (error == std::errc() && end == wanted.data() + wanted.size()) return number == row;
  return lower(facts.name + " " + facts.driver).find(lower(wanted)) != std::string::npos;
}

}  // namespace

const char* kind_text(VkPhysicalDeviceType type) {
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

std::string lacks(const Abilities& abilities) {
  if (abilities.api < VK_API_VERSION_1_2) return "needs Vulkan 1.2, has " + version_text(abilities.api);
  if (!abilities.doubles) return "has no 64-bit floating point in shaders (shaderFloat64)";
  if (!abilities.compute) return "has no compute queue";
  if (abilities.missing.empty()) return "";
  return "has no storage texel buffers of VkFormat " + std::to_string(abilities.missing.front());
}

int compute_family(std::span<const VkQueueFamilyProperties> families) {
  int best = -1;
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
    const bool plain = !(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT);
    if (best < 0 || plain) best = static_cast<int>(i);
    if (plain) break;
  }
  return best;
}

int compute_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  return compute_family(families);
}

Considered consider(const Instance& instance) {
  Considered considered;
  if (!instance.handle) return considered;
  std::uint32_t count = 0;
  if (vkEnumeratePhysicalDevices(instance.handle, &count, nullptr) != VK_SUCCESS) return considered;
  considered.handles.resize(count);
  if (vkEnumeratePhysicalDevices(instance.handle, &count, considered.handles.data()) < 0) count = 0;
  considered.handles.resize(count);
  for (const VkPhysicalDevice physical : considered.handles) considered.facts.push_back(facts_of(physical));
  return considered;
}

int choose(Considered& considered, const std::string& wanted) {
  int best = -1;
  for (std::size_t row = 0; row < considered.facts.size(); ++row) {
    DeviceFacts& facts = considered.facts[row];
    if (!facts.reason.empty()) continue;
    if (!is_wanted(facts, row, wanted)) {
      facts.reason = "is not the wanted one ('" + wanted + "')";
      continue;
    }
    if (best < 0 || rank(facts) > rank(considered.facts[static_cast<std::size_t>(best)])) best = static_cast<int>(row);
  }
  for (std::size_t row = 0; row < considered.facts.size(); ++row) {
    DeviceFacts& facts = considered.facts[row];
    facts.chosen = static_cast<int>(row) == best;
    if (!facts.chosen && facts.reason.empty()) facts.reason = "usable, but another ranks higher; name it with --device";
  }
  return best;
}

int choose(Considered& considered, const std::string& wanted, const Start& start) {
  Considered working = considered;
  for (;;) {
    considered = working;
    const int best = choose(considered, wanted);
    if (best < 0) return best;
    const auto row = static_cast<std::size_t>(best);
    const std::string fault = start(considered, row);
    if (fault.empty()) return best;
    working.facts[row].reason = fault;
    working.facts[row].self_check = considered.facts[row].self_check;
  }
}

}  // namespace sf::gpu
