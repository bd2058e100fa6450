#include "gpu/buffer.h"

#include <new>

#include "base/error.h"
#include "gpu/buffer_vk.h"

namespace sf::gpu {

namespace {

constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kCached = kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

VkFormat format_of(Texel texel) {
  switch (texel) {
    case Texel::u32:
      return VK_FORMAT_R32_UINT;
    case Texel::f32:
      return VK_FORMAT_R32_SFLOAT;
    case Texel::u32x4:
      return VK_FORMAT_R32G32B32A32_UINT;
    default:
      return VK_FORMAT_R32G32B32A32_SFLOAT;
  }
}

/// Allocates in the first memory type of `wishes` that the device supports.
Storage allocate(const Device::Vk& vk, VkDeviceSize size, VkBufferUsageFlags usage,
                 std::initializer_list<VkMemoryPropertyFlags> wishes, bool exported = false) {
  Storage storage;
  storage.exported = exported;
  VkExternalMemoryBufferCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO};
  VkExportMemoryAllocateInfo exporting{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO};
  external.handleTypes = exporting.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
  VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  create.size = size;
  create.usage = usage;
  create.pNext = exported ? &external : nullptr;
  check_vk(vkCreateBuffer(vk.device, &create, nullptr, &storage.buffer), "vkCreateBuffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(vk.device, storage.buffer, &needs);
  int type = -1;
  for (const VkMemoryPropertyFlags wish : wishes)
    if (type < 0) type = vk.memory_type(needs.memoryTypeBits, wish);
  VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocation.allocationSize = storage.size = needs.size;
  allocation.pNext = exported ? &exporting : nullptr;
  allocation.memoryTypeIndex = static_cast<std::uint32_t>(type < 0 ? 0 : type);
  if (type < 0 || vkAllocateMemory(vk.device, &allocation, nullptr, &storage.memory) != VK_SUCCESS) {
    vkDestroyBuffer(vk.device, storage.buffer, nullptr);
    throw base::DeviceError("the Vulkan device " + vk.info.name + " has no room for " + std::to_string(size >> 20) +
                            " MiB; use fewer robots or beams");
  }
  check_vk(vkBindBufferMemory(vk.device, storage.buffer, storage.memory, 0), "vkBindBufferMemory");
  return storage;
}

void release(const Device::Vk& vk, const Storage& storage) {
  vkDestroyBuffer(vk.device, storage.buffer, nullptr);
  vkFreeMemory(vk.device, storage.memory, nullptr);
}

/// [bytes] alignment of tables on the host: a cache line.
constexpr std::align_val_t kHostAlignment{64};

void allocate_on_host(Buffer::Vk& vk, std::size_t size) {
  vk.mapped = ::operator new[](size, kHostAlignment, std::nothrow);
  if (vk.mapped == nullptr)
    throw base::DeviceError("no room for " + std::to_string(size >> 20) + " MiB; use fewer robots or beams");
}

void make_storage(Buffer::Vk& vk, const Device& device, VkDeviceSize size) {
  const VkBufferUsageFlags table = VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                   VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                   VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const VkBufferUsageFlags staging = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (device.unified()) {
    vk.table = allocate(*vk.device, size, table, {kCached | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT});
  } else {
    vk.table = allocate(*vk.device, size, table, {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0}, vk.device->exporting);
    // Cached, because the host also reads tables that grow.
    vk.staging = allocate(*vk.device, size, staging, {kCached, kHost});
  }
  const VkDeviceMemory seen = vk.staging.memory ? vk.staging.memory : vk.table.memory;
  check_vk(vkMapMemory(vk.device->device, seen, 0, VK_WHOLE_SIZE, 0, &vk.mapped), "vkMapMemory");
}

}  // namespace

std::size_t texel_size(Texel texel) { return texel == Texel::u32 || texel == Texel::f32 ? 4 : 16; }

Buffer::Buffer(Device& device, std::string_view name, Role role, Texel texel, std::size_t texels)
    : vk_(std::make_unique<Vk>()) {
  vk_->device = &device.vk();
  vk_->role = role;
  vk_->texel = texel;
  vk_->texels = texels;
  const std::size_t limit = device.vk().properties.limits.maxTexelBufferElements;
  if (texels > limit)
    throw base::DeviceError("the device " + device.info().name + " holds at most " + std::to_string(limit) +
                            " elements in one table, " + std::to_string(texels) +
                            " are needed; use fewer robots or beams");
  device.is_host() ? allocate_on_host(*vk_, bytes()) : make_storage(*vk_, device, bytes());
  vk_->device->add_allocation(vk_.get(), name, bytes(), false);
  if (device.is_host()) return;

  VkBufferViewCreateInfo view{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  view.buffer = vk_->table.buffer;
  view.format = format_of(texel);
  view.range = VK_WHOLE_SIZE;
  check_vk(vkCreateBufferView(vk_->device->device, &view, nullptr, &vk_->view), "vkCreateBufferView");
}

Buffer::~Buffer() {
  if (!vk_) return;
  vk_->device->remove_allocation(vk_.get());
  if (vk_->device->is_host()) {
    ::operator delete[](vk_->mapped, kHostAlignment);
    return;
  }
  vkDestroyBufferView(vk_->device->device, vk_->view, nullptr);
  release(*vk_->device, vk_->table);
  release(*vk_->device, vk_->staging);
}

Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(vk_, other.vk_);
  return *this;
}

std::size_t Buffer::bytes() const { return vk_->texels * texel_size(vk_->texel); }
std::size_t Buffer::texels() const { return vk_->texels; }
bool Buffer::fits_storage_buffer() const { return bytes() <= vk_->device->properties.limits.maxStorageBufferRange; }
void* Buffer::mapped() const { return vk_->mapped; }

}  // namespace sf::gpu
