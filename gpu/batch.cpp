#include "gpu/batch.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/error.h"
#include "gpu/buffer_vk.h"
#include "gpu/kernel_vk.h"

namespace sf::gpu {

namespace {

/// Copies between a pair of buffers.
struct Copies {
  VkBuffer from;
  VkBuffer to;
  std::vector<VkBufferCopy> regions;
};

/// Adds a copy of `size` bytes at `offset`. Merges adjacent regions, because a GPU takes microseconds per region.
void add_copy(std::vector<Copies>& all, VkBuffer from, VkBuffer to, VkDeviceSize offset, VkDeviceSize size) {
  const auto own = std::find_if(all.begin(), all.end(), [&](const Copies& c) { return c.from == from && c.to == to; });
  std::vector<VkBufferCopy>& regions = own != all.end() ? own->regions : all.emplace_back(Copies{from, to, {}}).regions;
  VkBufferCopy* const last = regions.empty() ? nullptr : &regions.back();
  if (last != nullptr && last->srcOffset + last->size == offset)
    last->size += size;
  else
    regions.push_back({offset, offset, size});
}

}  // namespace

struct Batch::Vk {
  Device::Vk* device = nullptr;
  VkCommandPool pool = VK_NULL_HANDLE;
  std::array<VkCommandBuffer, 3> commands{};  ///< upload, run, download
  VkFence done = VK_NULL_HANDLE;
  std::vector<Copies> ups;
  std::vector<Copies> downs;
  bool submitted = false;

  VkCommandBuffer run() const { return commands[1]; }
};

namespace {

void start(VkCommandBuffer commands, VkCommandBufferUsageFlags flags) {
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = flags;
  check_vk(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
}

void wait_between(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags wrote, VkPipelineStageFlags to,
                  VkAccessFlags reads) {
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = wrote;
  barrier.dstAccessMask = reads;
  vkCmdPipelineBarrier(commands, from, to, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

constexpr VkPipelineStageFlags kCompute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags kTransfer = VK_PIPELINE_STAGE_TRANSFER_BIT;

void record_copies(VkCommandBuffer commands, std::vector<Copies>& all) {
  for (Copies& c : all) {
    if (c.regions.empty()) continue;
    vkCmdCopyBuffer(commands, c.from, c.to, static_cast<std::uint32_t>(c.regions.size()), c.regions.data());
    c.regions.clear();
  }
}

}  // namespace

Batch::Batch(Device& device) : vk_(std::make_unique<Vk>()) {
  vk_->device = &device.vk();
  if (device.is_host()) return;
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = vk_->device->family;
  check_vk(vkCreateCommandPool(vk_->device->device, &pool, nullptr, &vk_->pool), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = vk_->pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = static_cast<std::uint32_t>(vk_->commands.size());
  check_vk(vkAllocateCommandBuffers(vk_->device->device, &allocate, vk_->commands.data()), "vkAllocateCommandBuffers");
  VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check_vk(vkCreateFence(vk_->device->device, &fence, nullptr, &vk_->done), "vkCreateFence");
}

Batch::~Batch() {
  wait();
  if (vk_->device->is_host()) return;
  vkDestroyFence(vk_->device->device, vk_->done, nullptr);
  vkDestroyCommandPool(vk_->device->device, vk_->pool, nullptr);
}

void Batch::begin() {
  if (vk_->device->is_host()) return;
  start(vk_->run(), 0);
  wait_between(vk_->run(), kTransfer | VK_PIPELINE_STAGE_HOST_BIT,
               VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_HOST_WRITE_BIT, kCompute | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
               VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT);
}

void Batch::dispatch(const Kernel& kernel, const Buffer& counts, std::size_t offset) {
  const Kernel::Vk& k = kernel.vk();
  SF_CHECK(!vk_->device->is_host(), "a kernel is dispatched on the host");
  vkCmdBindPipeline(vk_->run(), VK_PIPELINE_BIND_POINT_COMPUTE, k.pipeline);
  vkCmdBindDescriptorSets(vk_->run(), VK_PIPELINE_BIND_POINT_COMPUTE, k.layout, 0, 1, &k.set, 0, nullptr);
  vkCmdDispatchIndirect(vk_->run(), counts.vk().table.buffer, offset);
}

void Batch::barrier() {
  if (vk_->device->is_host()) return;
  wait_between(vk_->run(), kCompute, VK_ACCESS_SHADER_WRITE_BIT, kCompute | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
               VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT);
}

void Batch::end() {
  if (vk_->device->is_host()) return;
  wait_between(vk_->run(), kCompute, VK_ACCESS_SHADER_WRITE_BIT, kTransfer | VK_PIPELINE_STAGE_HOST_BIT,
               VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_HOST_READ_BIT);
  check_vk(vkEndCommandBuffer(vk_->run()), "vkEndCommandBuffer");
}

void Batch::upload(const Buffer& table, std::size_t offset, std::size_t size) {
  const Buffer::Vk& b = table.vk();
  SF_CHECK(offset + size <= table.bytes(), "a copy past the end of a table");
  if (b.staging.buffer && size > 0) add_copy(vk_->ups, b.staging.buffer, b.table.buffer, offset, size);
}

void Batch::download(const Buffer& table, std::size_t offset, std::size_t size) {
  const Buffer::Vk& b = table.vk();
  SF_CHECK(offset + size <= table.bytes(), "a copy past the end of a table");
  if (b.staging.buffer && size > 0) add_copy(vk_->downs, b.table.buffer, b.staging.buffer, offset, size);
}

void Batch::submit() {
  SF_CHECK(!vk_->submitted, "a batch is submitted again before its wait");
  if (vk_->device->is_host()) return;
  std::array<VkCommandBuffer, 3> used{};
  std::uint32_t count = 0;
  const auto add_copies = [&](std::vector<Copies>& copies, VkCommandBuffer commands, bool before) {
    if (std::all_of(copies.begin(), copies.end(), [](const Copies& c) { return c.regions.empty(); })) return;
    start(commands, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT);
    record_copies(commands, copies);
    if (!before)
      wait_between(commands, kTransfer, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
    check_vk(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    used[count++] = commands;
  };
  add_copies(vk_->ups, vk_->commands[0], true);
  used[count++] = vk_->run();
  add_copies(vk_->downs, vk_->commands[2], false);

  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = count;
  submit.pCommandBuffers = used.data();
  check_vk(vkQueueSubmit(vk_->device->queue, 1, &submit, vk_->done), "vkQueueSubmit");
  vk_->submitted = true;
}

void Batch::wait() {
  if (!std::exchange(vk_->submitted, false)) return;
  check_vk(vkWaitForFences(vk_->device->device, 1, &vk_->done, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check_vk(vkResetFences(vk_->device->device, 1, &vk_->done), "vkResetFences");
}

}  // namespace sf::gpu
