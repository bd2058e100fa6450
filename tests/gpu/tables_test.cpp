// Buffers, kernels and required device features.

#include <gtest/gtest.h>

#include <cstdlib>
#include <utility>

#include "base/error.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/device_vk.h"
#include "gpu/kernel.h"
#include "gpu/self_check.h"
#include "shaders/loop.comp.h"
#include "shaders/wrong.comp.h"
#include "tests/refusal.h"

namespace sf::gpu {
namespace {

TEST(Buffer, HasTheRequestedTexelsAndAHostView) {
  Device device;
  Buffer table(device, "table", Role::upload, Texel::u32x4, 5);
  EXPECT_EQ(table.texels(), 5u);
  EXPECT_EQ(table.bytes(), 80u);
  EXPECT_EQ(table.host<double>().size(), 10u);
  table.host<double>()[9] = 1.5;
  Buffer other(std::move(table));
  EXPECT_EQ(other.host<double>()[9], 1.5);
}

TEST(Buffer, AssignmentSwaps) {
  Device device;
  Buffer table(device, "table", Role::upload, Texel::u32, 2);
  {
    Buffer other(device, "other", Role::upload, Texel::f32x4, 3);
    other.host<double>()[5] = 2.5;
    table = std::move(other);
  }
  EXPECT_EQ(table.texels(), 3u);
  EXPECT_EQ(table.host<double>()[5], 2.5);
  ASSERT_EQ(device.allocations().size(), 1u);
  EXPECT_EQ(device.allocations()[0].name, "other");
}

TEST(Device, ListsItsAllocations) {
  Device device;
  EXPECT_TRUE(device.allocations().empty()) << "the self-check leaves nothing behind";
  Buffer first(device, "first", Role::upload, Texel::u32, 3);
  device.set_owner("laser");
  {
    const Buffer second(device, "second", Role::download, Texel::f32x4, 2);
    const Buffer moved(std::move(first));
    ASSERT_EQ(device.allocations().size(), 2u);
    EXPECT_EQ(device.allocations()[0].name, "first");
    EXPECT_EQ(device.allocations()[0].owner, "");
    EXPECT_EQ(device.allocations()[1].owner, "laser");
    EXPECT_EQ(device.allocations()[1].bytes, 32u);
    EXPECT_FALSE(device.allocations()[1].is_kernel);
  }
  EXPECT_TRUE(device.allocations().empty());
}

/// The driver's limit counts bytes, not texels: 5 texels of 16 bytes.
TEST(Buffer, StorageBufferLimitCountsBytes) {
  Device device;
  const Buffer table(device, "table", Role::upload, Texel::u32x4, 5);
  std::uint32_t& limit = device.vk().properties.limits.maxStorageBufferRange;
  limit = 80;
  EXPECT_TRUE(table.fits_storage_buffer());
  limit = 79;
  EXPECT_FALSE(table.fits_storage_buffer());
}

/// A table above the device's limit is rejected with the limit and a remedy.
TEST(Buffer, RejectsTablesAboveTheDeviceLimit) {
  Device device;
  const std::string error =
      refusal_of<base::DeviceError>([&] { Buffer(device, "table", Role::upload, Texel::f32, std::size_t{1} << 40); });
  expect_in("elements in one table", error);
  expect_in("use fewer robots or beams", error);
}

/// Without memory of any wanted type, the error equals that of a full device.
TEST(Buffer, OutOfMemoryErrorNamesTheSize) {
  Device device;
  const std::uint32_t types = std::exchange(device.vk().memory.memoryTypeCount, 0);
  expect_in("has no room for 16 MiB; use fewer robots or beams",
            refusal_of<base::DeviceError>([&] { Buffer(device, "table", Role::upload, Texel::u32x4, 1 << 20); }));
  device.vk().memory.memoryTypeCount = types;
  EXPECT_TRUE(device.allocations().empty());
}

TEST(Batch, CopyPastTheEndAborts) {
  Device device;
  Batch batch(device);
  Buffer table(device, "table", Role::upload, Texel::u32, 4);
  batch.upload(table, 12, 4);
  batch.download(table, 16, 0);
  EXPECT_DEATH(batch.upload(table, 12, 8), "a copy past the end of a table");
  EXPECT_DEATH(batch.download(table, 16, 4), "a copy past the end of a table");
}

TEST(Vulkan, FailedCallAbortsWithItsName) {
  check_vk(VK_SUCCESS, "vkQueueSubmit");
  EXPECT_DEATH(check_vk(VK_ERROR_DEVICE_LOST, "vkQueueSubmit"), "vkQueueSubmit gave VkResult -4");
}

TEST(Batch, SubmitAndWaitAreSeparate) {
  Device device;
  Batch batch(device);
  batch.begin();
  batch.end();
  batch.wait();  // nothing was submitted
  batch.submit();
  EXPECT_DEATH(batch.submit(), "a batch is submitted again before its wait");
  batch.wait();
  batch.wait();
  batch.submit();  // destroyed without `wait`: the destructor waits
}

TEST(Kernel, GroupSizeIsReadFromTheModule) {
  EXPECT_EQ(interface_of(loop_comp_spv).group_size, 64u);
  EXPECT_EQ(interface_of(std::span<const std::uint32_t>(loop_comp_spv).first(5)).group_size, 0u) << "a header alone";
  EXPECT_EQ(interface_of({}).group_size, 0u);
}

TEST(Kernel, OnlyLocalSizeIsTheGroupSize) {
  const auto size_of = [](std::vector<std::uint32_t> instructions) {
    instructions.insert(instructions.begin(), 5, 0x07230203u);
    return interface_of(instructions).group_size;
  };
  constexpr std::uint32_t kMode = 6u << 16 | 16u;
  EXPECT_EQ(size_of({2u << 16 | 17u, 1u, kMode, 4u, 17u, 32u, 1u, 1u}), 32u) << "behind another instruction";
  EXPECT_EQ(size_of({kMode, 4u, 38u, 32u, 1u, 1u, kMode, 4u, 17u, 16u, 1u, 1u}), 16u) << "behind another mode";
  EXPECT_EQ(size_of({6u << 16 | 15u, 4u, 17u, 32u, 1u, 1u}), 0u) << "no execution mode";
  EXPECT_EQ(size_of({3u << 16 | 16u, 4u, 17u}), 0u) << "too short";
  EXPECT_EQ(size_of({kMode, 4u, 17u}), 0u) << "cut off";
  EXPECT_EQ(size_of({0u, kMode, 4u, 17u, 32u, 1u, 1u}), 0u) << "an instruction of no words";
}

TEST(Kernel, ReadsTableNamesFromTheModule) {
  const std::vector<KernelTable> tables = interface_of(loop_comp_spv).tables;
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0].name, "counts");
  EXPECT_EQ(tables[1].name, "sums");
  EXPECT_EQ(tables[1].binding, 1u);
  EXPECT_FALSE(tables[1].is_buffer);
}

TEST(Kernel, TablesAreBoundByName) {
  Device device;
  Kernel kernel(device, "loop", loop_comp_spv);
  const Buffer counts(device, "counts", Role::upload, Texel::u32, 64);
  const Buffer sums(device, "sums", Role::download, Texel::u32x4, 64);
  kernel.bind({{"sums", &sums}, {"counts", &counts}});
  EXPECT_DEATH(kernel.bind({{"sum", &sums}, {"counts", &counts}}), "no table for the kernel's 'sums'");
  EXPECT_DEATH(kernel.bind({{"sums", &sums}}), "1 tables for a kernel that declares 2");
}

TEST(SelfCheck, ChosenDeviceMatchesTheHost) {
  Device device;
  EXPECT_EQ(self_check(device).fault, "");
  EXPECT_EQ(device.info().self_check, "passed");
}

TEST(SelfCheck, DetectsAWrongKernel) {
  Device device;
  const std::string fault = self_check(device, wrong_comp_spv).fault;
  EXPECT_EQ(fault.find("differs from IEEE 754 in "), 0u) << fault;
}

TEST(SelfCheck, ListIncludesItForEveryCompleteDevice) {
  for (const DeviceInfo& info : list_devices("").devices) {
    if (info.name == kHostDevice) continue;
    EXPECT_NE(info.self_check, "") << info.name;
    EXPECT_EQ(info.self_check == "passed", info.chosen || info.reason.find("usable") == 0) << info.name;
  }
}

/// The first allowed type with all wanted properties.
TEST(Device, FindsMemoryTypesByProperties) {
  Device device;
  Device::Vk& vk = device.vk();
  const VkPhysicalDeviceMemoryProperties own = vk.memory;
  constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  constexpr VkMemoryPropertyFlags kSeen = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
  vk.memory.memoryTypeCount = 3;
  vk.memory.memoryTypes[0].propertyFlags = kLocal;
  vk.memory.memoryTypes[1].propertyFlags = kSeen;
  vk.memory.memoryTypes[2].propertyFlags = kLocal | kSeen;
  EXPECT_EQ(vk.memory_type(~0u, kLocal), 0);
  EXPECT_EQ(vk.memory_type(~0u, kSeen), 1);
  EXPECT_EQ(vk.memory_type(~0u, kLocal | kSeen), 2);
  EXPECT_EQ(vk.memory_type(0b101u, kSeen), 2) << "the second is not allowed";
  EXPECT_EQ(vk.memory_type(0b011u, kLocal | kSeen), -1);
  EXPECT_EQ(vk.memory_type(0b110u, 0), 1);
  vk.memory.memoryTypeCount = 2;
  EXPECT_EQ(vk.memory_type(~0u, kLocal | kSeen), -1) << "past the last type";
  vk.memory = own;
}

TEST(Environment, EmptyAndZeroAreNotSet) {
  unsetenv("SENSORFARM_TEST");
  EXPECT_FALSE(is_set("SENSORFARM_TEST"));
  for (const auto& [value, set] :
       std::vector<std::pair<const char*, bool>>{{"", false}, {"0", false}, {"1", true}, {"00", true}}) {
    setenv("SENSORFARM_TEST", value, 1);
    EXPECT_EQ(is_set("SENSORFARM_TEST"), set) << value;
  }
  unsetenv("SENSORFARM_TEST");
}

/// The layer reports an error, so its silence in other tests is meaningful.
TEST(Validation, LayerReportsAnError) {
  setenv("SENSORFARM_VALIDATE", "1", 1);
  {
    Device device;
    if (device.validation_messages().find("not installed") != std::string::npos)
      GTEST_SKIP() << "the validation layer is not installed";
    EXPECT_EQ(device.validation_messages(), "");
    VkBufferCreateInfo empty{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    empty.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    VkBuffer buffer = VK_NULL_HANDLE;
    if (vkCreateBuffer(device.vk().device, &empty, nullptr, &buffer) == VK_SUCCESS)
      vkDestroyBuffer(device.vk().device, buffer, nullptr);
    EXPECT_NE(device.validation_messages(), "") << "a buffer of no bytes";
  }
  unsetenv("SENSORFARM_VALIDATE");
}

}  // namespace
}  // namespace sf::gpu
