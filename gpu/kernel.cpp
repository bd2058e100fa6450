#include "gpu/kernel.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/error.h"
#include "gpu/buffer_vk.h"
#include "gpu/kernel_vk.h"

namespace sf::gpu {

namespace {

constexpr VkDescriptorType kTexels = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
constexpr VkDescriptorType kBuffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;

void make_layout(Kernel::Vk& vk, std::uint32_t tables) {
  std::vector<VkDescriptorSetLayoutBinding> bindings(tables);
  for (std::uint32_t i = 0; i < tables; ++i)
    bindings[i] = {i, i < vk.texels ? kTexels : kBuffer, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = tables;
  set.pBindings = bindings.data();
  check_vk(vkCreateDescriptorSetLayout(vk.device->device, &set, nullptr, &vk.tables), "vkCreateDescriptorSetLayout");

  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &vk.tables;
  check_vk(vkCreatePipelineLayout(vk.device->device, &layout, nullptr, &vk.layout), "vkCreatePipelineLayout");
}

void make_set(Kernel::Vk& vk, std::uint32_t tables) {
  const VkDescriptorPoolSize sizes[] = {{kTexels, vk.texels}, {kBuffer, tables - vk.texels}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = tables > vk.texels ? 2 : 1;
  pool.pPoolSizes = sizes;
  check_vk(vkCreateDescriptorPool(vk.device->device, &pool, nullptr, &vk.pool), "vkCreateDescriptorPool");
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = vk.pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &vk.tables;
  check_vk(vkAllocateDescriptorSets(vk.device->device, &allocate, &vk.set), "vkAllocateDescriptorSets");
}

void make_pipeline(Kernel::Vk& vk, std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> constants) {
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, 4 * i, 4});
  const VkSpecializationInfo special{static_cast<std::uint32_t>(entries.size()), entries.data(), constants.size_bytes(),
                                     constants.data()};
  VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  code.codeSize = spirv.size_bytes();
  code.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check_vk(vkCreateShaderModule(vk.device->device, &code, nullptr, &module), "vkCreateShaderModule");
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = module;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &special;
  create.layout = vk.layout;
  check_vk(vkCreateComputePipelines(vk.device->device, VK_NULL_HANDLE, 1, &create, nullptr, &vk.pipeline),
           "vkCreateComputePipelines");
  vkDestroyShaderModule(vk.device->device, module, nullptr);
}

}  // namespace

std::uint32_t group_size_of(std::span<const std::uint32_t> spirv) {
  // SPIR-V: five words of header, then instructions whose first word is (word count << 16 | opcode).
  constexpr std::uint32_t kExecutionMode = 16;
  constexpr std::uint32_t kLocalSize = 17;
  for (std::size_t at = 5; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16;
    if (words == 0 || words > spirv.size() - at) return 0;
    if ((spirv[at] & 0xFFFFu) == kExecutionMode && words >= 6 && spirv[at + 2] == kLocalSize) return spirv[at + 3];
    at += words;
  }
  return 0;
}

Kernel::Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> spirv, std::uint32_t tables,
               std::uint32_t buffers, std::span<const std::uint32_t> constants)
    : vk_(std::make_unique<Vk>()) {
  vk_->device = &device.vk();
  vk_->group_size = group_size_of(spirv);
  vk_->texels = tables - buffers;
  SF_CHECK(vk_->group_size > 0, "a SPIR-V module without LocalSize");
  make_layout(*vk_, tables);
  make_set(*vk_, tables);
  make_pipeline(*vk_, spirv, constants);
  vk_->device->add_allocation(vk_.get(), name, spirv.size_bytes(), true);
}

Kernel::~Kernel() {
  vk_->device->remove_allocation(vk_.get());
  const VkDevice device = vk_->device->device;
  vkDestroyPipeline(device, vk_->pipeline, nullptr);
  vkDestroyPipelineLayout(device, vk_->layout, nullptr);
  vkDestroyDescriptorPool(device, vk_->pool, nullptr);
  vkDestroyDescriptorSetLayout(device, vk_->tables, nullptr);
}

void Kernel::bind(std::span<Buffer* const> tables) {
  std::vector<VkWriteDescriptorSet> writes(tables.size(), {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
  std::vector<VkDescriptorBufferInfo> buffers(tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::size_t most = vk_->device->properties.limits.maxStorageBufferRange;
    buffers[i] = {tables[i]->vk().table.buffer, 0, std::min(tables[i]->bytes(), most)};
    writes[i].dstSet = vk_->set;
    writes[i].dstBinding = static_cast<std::uint32_t>(i);
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = i < vk_->texels ? kTexels : kBuffer;
    writes[i].pBufferInfo = &buffers[i];
    writes[i].pTexelBufferView = &tables[i]->vk().view;
  }
  vkUpdateDescriptorSets(vk_->device->device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

std::uint32_t Kernel::group_size() const { return vk_->group_size; }

}  // namespace sf::gpu
