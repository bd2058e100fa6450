#include "gpu/device.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "base/error.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "tests/refusal.h"

namespace sf::gpu {
namespace {

TEST(Device, OpensAndDescribesTheBestDevice) {
  const Device device;
  EXPECT_FALSE(device.info().name.empty());
  EXPECT_TRUE(device.info().chosen);
  EXPECT_EQ(device.info().software, device.info().kind == "CPU");
  EXPECT_NE(device.info().driver, "");
  EXPECT_EQ(device.info().api.find("1."), 0u) << device.info().api;
}

TEST(Device, ListChoosesExactlyOneAndGivesTheOthersAReason) {
  const DeviceList survey = list_devices("");
  int chosen = 0;
  for (const DeviceInfo& info : survey.devices) {
    chosen += info.chosen;
    EXPECT_EQ(info.chosen, info.reason.empty()) << info.name;
  }
  EXPECT_EQ(chosen, 1);
}

TEST(Device, UnknownNameListsEveryDeviceAndReason) {
  const std::string text = refusal_of<base::DeviceError>([] { Device("no such device"); });
  const std::size_t devices = list_devices("").devices.size() - 1;  // excludes the host
  EXPECT_EQ(text.find("no usable Vulkan device among " + std::to_string(devices) + ": "), 0u) << text;
  expect_in("does not match 'no such device';", text);
  expect_in("select another with --device", text);
}

TEST(Device, MissingDriverErrorNamesTheDriverToInstall) {
  const char* set = std::getenv("VK_DRIVER_FILES");
  const std::string before = set ? set : "";
  setenv("VK_DRIVER_FILES", "/no/such/driver.json", 1);
  unsetenv("SENSORFARM_REQUIRE_VULKAN");
  const DeviceList survey = list_devices("");
  ASSERT_EQ(survey.devices.size(), 1u);
  EXPECT_EQ(survey.devices[0].name, kHostDevice);
  EXPECT_TRUE(survey.devices[0].chosen);
  EXPECT_FALSE(list_devices("", true).devices[0].chosen) << "a Vulkan device is required";
  EXPECT_FALSE(list_devices("0").devices[0].chosen) << "a row asks for a Vulkan device";
  const Device host = Device::or_host("", false);
  EXPECT_TRUE(host.is_host());
  EXPECT_NE(host.notice().find("computing on the host"), std::string::npos) << host.notice();
  EXPECT_THROW(Device::or_host("", true), base::DeviceError);
  EXPECT_THROW(Device::or_host("0", false), base::DeviceError);
  setenv("SENSORFARM_REQUIRE_VULKAN", "1", 1);
  EXPECT_THROW(Device::or_host("", false), base::DeviceError);
  EXPECT_THROW(Device::or_host("host", false), base::DeviceError);
  unsetenv("SENSORFARM_REQUIRE_VULKAN");
  EXPECT_EQ(survey.problem.find("Vulkan has no usable driver"), 0u) << survey.problem;
  EXPECT_EQ(refusal_of<base::DeviceError>([] { Device(); }),
            "no Vulkan device: " + survey.problem + "; install a driver (Debian: mesa-vulkan-drivers)");
  before.empty() ? unsetenv("VK_DRIVER_FILES") : setenv("VK_DRIVER_FILES", before.c_str(), 1);
}

TEST(Device, HostHasTablesAndKernelsButRunsNone) {
  Device host{std::string(kHostDevice)};
  EXPECT_EQ(host.info().name, "host");
  EXPECT_TRUE(host.info().software && host.unified() && host.rounds32() && !host.is_gpu());
  EXPECT_EQ(host.notice(), "");
  Buffer table(host, "table", Role::upload, Texel::u32, 1000);
  table.host<std::uint32_t>()[999] = 7;
  Batch batch(host);
  batch.begin(), batch.barrier(), batch.end();
  batch.upload(table, 0, table.bytes());
  batch.run();
  EXPECT_EQ(table.host<std::uint32_t>()[999], 7u);
  EXPECT_EQ(host.allocations().size(), 1u) << "of the table alone";
}

TEST(Device, ReportsAMissingValidationLayer) {
  const char* const names[] = {"SENSORFARM_VALIDATE", "VK_LAYER_PATH"};
  std::optional<std::string> before[2];
  for (int i = 0; i < 2; ++i)
    if (const char* set = std::getenv(names[i])) before[i] = set;
  setenv(names[0], "1", 1);
  setenv(names[1], "/no/such/layers", 1);
  EXPECT_EQ(Device().validation_messages(), "SENSORFARM_VALIDATE is set, but the validation layer is not installed\n");
  unsetenv(names[0]);
  EXPECT_EQ(Device().validation_messages(), "") << "not requested";
  for (int i = 0; i < 2; ++i) before[i] ? setenv(names[i], before[i]->c_str(), 1) : unsetenv(names[i]);
}

TEST(Device, AcceptsARowNumber) { EXPECT_EQ(Device("0").info().name, list_devices("0").devices[0].name); }

}  // namespace
}  // namespace sf::gpu
