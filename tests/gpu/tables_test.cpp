// Buffers, kernels and what the device must be able to do.

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "gpu/self_check.h"
#include "gpu/vk.h"
#include "shaders/loop.comp.h"

namespace sf::gpu {
namespace {

TEST(Buffer, HasTheTexelsAskedForAndAHostView) {
  Device device;
  Buffer table(device, "table", Role::upload, Texel::u32x4, 5);
  EXPECT_EQ(table.texels(), 5u);
  EXPECT_EQ(table.bytes(), 80u);
  EXPECT_EQ(table.host<double>().size(), 10u);
  table.host<double>()[9] = 1.5;
  Buffer other(std::move(table));
  EXPECT_EQ(other.host<double>()[9], 1.5);
}

TEST(Device, NamesWhatItHolds) {
  Device device;
  EXPECT_TRUE(device.held().empty()) << "the self-check leaves nothing behind";
  Buffer first(device, "first", Role::upload, Texel::u32, 3);
  device.owned_by("laser");
  {
    const Buffer second(device, "second", Role::download, Texel::f32x4, 2);
    const Buffer moved(std::move(first));
    ASSERT_EQ(device.held().size(), 2u);
    EXPECT_EQ(device.held()[0].name, "first");
    EXPECT_EQ(device.held()[0].owner, "");
    EXPECT_EQ(device.held()[1].owner, "laser");
    EXPECT_EQ(device.held()[1].bytes, 32u);
    EXPECT_FALSE(device.held()[1].is_kernel);
  }
  EXPECT_TRUE(device.held().empty());
}

/// More than the device's limit is refused with the limit and what to do, not with a crash.
TEST(Buffer, MoreThanTheDeviceHoldsIsRefused) {
  Device device;
  try {
    Buffer table(device, "table", Role::upload, Texel::f32, std::size_t{1} << 40);
    FAIL();
  } catch (const base::DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("elements in one table"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("use fewer robots or beams"), std::string::npos) << error.what();
  }
}

TEST(Kernel, GroupSizeIsReadFromTheModule) {
  EXPECT_EQ(group_size_of(loop_comp_spv), 64u);
  EXPECT_EQ(group_size_of(std::span<const std::uint32_t>(loop_comp_spv).first(5)), 0u) << "a header alone";
  EXPECT_EQ(group_size_of({}), 0u);
}

TEST(SelfCheck, TheChosenDeviceKnowsItsDoubles) {
  Device device;
  EXPECT_EQ(self_check(device), "");
}

/// The layer speaks when something is wrong: so its silence elsewhere means something.
TEST(Validation, TheLayerReportsAMistake) {
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
