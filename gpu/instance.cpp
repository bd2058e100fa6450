#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/error.h"
#include "gpu/device_vk.h"

namespace sf::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  if (severity < VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) return VK_FALSE;
  auto* instance = static_cast<Instance*>(user);
  const std::scoped_lock guard(instance->lock);
  instance->messages += std::string(data->pMessage) + "\n";
  return VK_FALSE;
}

bool has_layer(const char* wanted) {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  for (const auto& layer : layers)
    if (std::strcmp(layer.layerName, wanted) == 0) return true;
  return false;
}

}  // namespace

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value && std::strcmp(value, "0") != 0;
}

void check_vk(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  base::check(false, __FILE__, __LINE__, std::string(call) + " gave VkResult " + std::to_string(result));
}

Instance::Instance() {
  problem = open_vulkan_loader();
  if (!problem.empty()) return;
  const bool wanted = is_set("SENSORFARM_VALIDATE");
  const bool validate = wanted && has_layer(kValidationLayer);
  if (wanted && !validate) messages = "SENSORFARM_VALIDATE is set, but the validation layer is not installed\n";

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "sensorfarm";
  application.apiVersion = VK_API_VERSION_1_2;

  VkDebugUtilsMessengerCreateInfoEXT listen{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  listen.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  listen.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  listen.pfnUserCallback = on_message;
  listen.pUserData = this;

  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  create.pApplicationInfo = &application;
  if (validate) {
    create.pNext = &listen;
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &kValidationLayer;
    create.enabledExtensionCount = 1;
    create.ppEnabledExtensionNames = &extension;
  }
  const VkResult result = vkCreateInstance(&create, nullptr, &handle);
  if (result != VK_SUCCESS) {
    handle = VK_NULL_HANDLE;
    problem = "Vulkan has no usable driver (vkCreateInstance gave " + std::to_string(result) + ")";
    return;
  }
  if (!validate) return;
  const auto make = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(handle, "vkCreateDebugUtilsMessengerEXT"));
  if (make) check_vk(make(handle, &listen, nullptr, &messenger), "vkCreateDebugUtilsMessengerEXT");
}

Instance::~Instance() {
  if (!handle) return;
  const auto unmake = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(handle, "vkDestroyDebugUtilsMessengerEXT"));
  if (messenger && unmake) unmake(handle, messenger, nullptr);
  vkDestroyInstance(handle, nullptr);
}

}  // namespace sf::gpu
