#include "gpu/device.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace sf::gpu {
namespace {

TEST(Device, OpensTheBestDeviceAndSaysWhatItIs) {
  const Device device;
  EXPECT_FALSE(device.facts().name.empty());
  EXPECT_TRUE(device.facts().chosen);
  EXPECT_EQ(device.facts().software, device.facts().kind == "CPU");
}

TEST(Device, SurveyChoosesExactlyOneAndGivesTheOthersAReason) {
  const Survey survey = survey_devices("");
  int chosen = 0;
  for (const DeviceFacts& facts : survey.devices) {
    chosen += facts.chosen;
    EXPECT_EQ(facts.chosen, facts.reason.empty()) << facts.name;
  }
  EXPECT_EQ(chosen, 1);
}

TEST(Device, AnUnknownNameIsRefusedWithEveryDeviceAndItsReason) {
  try {
    Device device("no such device");
    FAIL() << "opened " << device.facts().name;
  } catch (const base::DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("is not the wanted one ('no such device')"), std::string::npos)
        << error.what();
  }
}

TEST(Device, ARowNumberNamesADevice) { EXPECT_EQ(Device("0").facts().name, survey_devices("0").devices[0].name); }

}  // namespace
}  // namespace sf::gpu
