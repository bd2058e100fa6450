#include "gpu/kernel.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "gpu/buffer_vk.h"
#include "gpu/kernel_vk.h"

namespace sf::gpu {

namespace {

constexpr VkDescriptorType kTexels = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
constexpr VkDescriptorType kBuffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;

VkDescriptorType type_of(const KernelTable& table) { return table.is_buffer ? kBuffer : kTexels; }

void make_layout(Kernel::Vk& vk) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const KernelTable& table : vk.declared.tables)
    bindings.push_back({table.binding, type_of(table), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check_vk(vkCreateDescriptorSetLayout(vk.device->device, &set, nullptr, &vk.tables), "vkCreateDescriptorSetLayout");

  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &vk.tables;
  check_vk(vkCreatePipelineLayout(vk.device->device, &layout, nullptr, &vk.layout), "vkCreatePipelineLayout");
}

void make_set(Kernel::Vk& vk) {
  std::vector<VkDescriptorPoolSize> sizes;
  for (const KernelTable& table : vk.declared.tables) sizes.push_back({type_of(table), 1});
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
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

KernelInterface interface_of(std::span<const std::uint32_t> spirv) {
  // SPIR-V: a header of five words, then instructions whose first word is (word count << 16 | opcode).
  constexpr std::uint32_t kName = 5, kExecutionMode = 16, kVariable = 59, kDecorate = 71;
  constexpr std::uint32_t kLocalSize = 17, kBinding = 33, kStorageBuffer = 12;
  KernelInterface found;
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, std::uint32_t> bindings;
  for (std::size_t at = 5; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16, opcode = spirv[at] & 0xFFFFu;
    if (words == 0 || words > spirv.size() - at) return {};
    const auto op = spirv.subspan(at, words);
    if (opcode == kExecutionMode && words >= 6 && op[2] == kLocalSize && found.group_size == 0)
      found.group_size = op[3];
    if (opcode == kName && words >= 3) {
      const auto* const text = reinterpret_cast<const char*>(&op[2]);
      names[op[1]].assign(text, strnlen(text, 4 * (words - 2)));
    }
    if (opcode == kDecorate && words >= 4 && op[2] == kBinding) bindings[op[1]] = op[3];
    // Names and decorations precede their targets.
    if (opcode == kVariable && words >= 4 && bindings.count(op[2]) > 0)
      found.tables.push_back({names[op[2]], bindings[op[2]], op[3] == kStorageBuffer});
    at += words;
  }
  return found;
}

Kernel::Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> spirv,
               std::span<const std::uint32_t> constants)
    : vk_(std::make_unique<Vk>()) {
  vk_->device = &device.vk();
  vk_->declared = interface_of(spirv);
  SF_CHECK(vk_->declared.group_size > 0, "a SPIR-V module without LocalSize");
  if (device.is_host()) return;
  make_layout(*vk_);
  make_set(*vk_);
  make_pipeline(*vk_, spirv, constants);
  vk_->device->add_allocation(vk_.get(), name, spirv.size_bytes(), true);
}

Kernel::~Kernel() {
  if (vk_->device->is_host()) return;
  vk_->device->remove_allocation(vk_.get());
  const VkDevice device = vk_->device->device;
  vkDestroyPipeline(device, vk_->pipeline, nullptr);
  vkDestroyPipelineLayout(device, vk_->layout, nullptr);
  vkDestroyDescriptorPool(device, vk_->pool, nullptr);
  vkDestroyDescriptorSetLayout(device, vk_->tables, nullptr);
}

void Kernel::bind(const std::vector<TableBinding>& tables) {
  const std::vector<KernelTable>& declared = vk_->declared.tables;
  SF_CHECK(tables.size() == declared.size(),
           std::to_string(tables.size()) + " tables for a kernel that declares " + std::to_string(declared.size()));
  std::vector<VkWriteDescriptorSet> writes(tables.size(), {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
  std::vector<VkDescriptorBufferInfo> buffers(tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const auto named = std::ranges::find(tables, declared[i].name, &TableBinding::name);
    SF_CHECK(named != tables.end(), "no table for the kernel's '" + declared[i].name + "'");
    const Buffer::Vk& table = named->table->vk();
    const std::size_t most = vk_->device->properties.limits.maxStorageBufferRange;
    buffers[i] = {table.table.buffer, 0, std::min(named->table->bytes(), most)};
    writes[i].dstSet = vk_->set;
    writes[i].dstBinding = declared[i].binding;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = type_of(declared[i]);
    writes[i].pBufferInfo = &buffers[i];
    writes[i].pTexelBufferView = &table.view;
  }
  if (vk_->device->is_host()) return;
  vkUpdateDescriptorSets(vk_->device->device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

std::uint32_t Kernel::group_size() const { return vk_->declared.group_size; }

}  // namespace sf::gpu
