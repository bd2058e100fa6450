// Which of several devices is taken, with devices that are made up.

#include <gtest/gtest.h>

#include "gpu/vk.h"

namespace sf::gpu {
namespace {

constexpr VkPhysicalDeviceType kDiscrete = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
constexpr VkPhysicalDeviceType kIntegrated = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
constexpr VkPhysicalDeviceType kVirtual = VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU;
constexpr VkPhysicalDeviceType kCpu = VK_PHYSICAL_DEVICE_TYPE_CPU;
constexpr VkPhysicalDeviceType kOther = VK_PHYSICAL_DEVICE_TYPE_OTHER;

DeviceFacts device(const std::string& name, VkPhysicalDeviceType type, const std::string& lack = "") {
  DeviceFacts facts;
  facts.name = name;
  facts.driver = "Driver of " + name;
  facts.kind = kind_text(type);
  facts.reason = lack;
  return facts;
}

Considered five() {
  Considered considered;
  considered.facts = {device("llvmpipe", kCpu), device("Iris", kIntegrated), device("GeForce", kDiscrete),
                      device("virgl", kVirtual), device("Old", kDiscrete, "has no compute queue")};
  return considered;
}

std::string chosen_of(const std::vector<DeviceFacts>& devices, const std::string& wanted = "") {
  Considered considered;
  considered.facts = devices;
  const int row = choose(considered, wanted);
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(considered.facts[i].chosen, static_cast<int>(i) == row);
    EXPECT_EQ(considered.facts[i].reason.empty(), considered.facts[i].chosen) << considered.facts[i].name;
  }
  return row < 0 ? "" : considered.facts[static_cast<std::size_t>(row)].name;
}

TEST(Choose, TheBestKindOfDeviceWhateverTheOrder) {
  const DeviceFacts other = device("other", kOther), cpu = device("cpu", kCpu), guest = device("virtual", kVirtual),
                    integrated = device("integrated", kIntegrated), discrete = device("discrete", kDiscrete);
  EXPECT_EQ(chosen_of({discrete, integrated, guest, cpu, other}), "discrete");
  EXPECT_EQ(chosen_of({other, cpu, guest, integrated, discrete}), "discrete");
  EXPECT_EQ(chosen_of({other, cpu, guest, integrated}), "integrated");
  EXPECT_EQ(chosen_of({integrated, guest}), "integrated");
  EXPECT_EQ(chosen_of({cpu, guest, other}), "virtual");
  EXPECT_EQ(chosen_of({other, cpu}), "cpu");
  EXPECT_EQ(chosen_of({other}), "other");
  EXPECT_EQ(chosen_of({}), "");
  EXPECT_EQ(chosen_of({device("first", kCpu), device("second", kCpu)}), "first") << "of equals the first";
}

TEST(Choose, KindsHaveTheirWords) {
  EXPECT_EQ(device("", kDiscrete).kind, "discrete GPU");
  EXPECT_EQ(device("", kIntegrated).kind, "integrated GPU");
  EXPECT_EQ(device("", kVirtual).kind, "virtual GPU");
  EXPECT_EQ(device("", kCpu).kind, "CPU");
  EXPECT_EQ(device("", kOther).kind, "other");
}

TEST(Choose, ADeviceThatLacksSomethingIsNeverTaken) {
  EXPECT_EQ(chosen_of(five().facts), "GeForce");
  EXPECT_EQ(chosen_of(five().facts, "Old"), "");
  EXPECT_EQ(chosen_of(five().facts, "4"), "");
}

TEST(Choose, AWishIsARowOrAPartOfNameOrDriverInAnyCase) {
  EXPECT_EQ(chosen_of(five().facts, "0"), "llvmpipe");
  EXPECT_EQ(chosen_of(five().facts, "3"), "virgl");
  EXPECT_EQ(chosen_of(five().facts, "5"), "") << "one past the last row";
  EXPECT_EQ(chosen_of(five().facts, "LLVM"), "llvmpipe");
  EXPECT_EQ(chosen_of(five().facts, "geforce"), "GeForce");
  EXPECT_EQ(chosen_of(five().facts, "dRIVER OF iRIS"), "Iris");
  EXPECT_EQ(chosen_of(five().facts, "0x"), "") << "a number with more behind it is a name";
  EXPECT_EQ(chosen_of(five().facts, "driver"), "GeForce") << "the best that it names";
}

TEST(Choose, EveryOtherDeviceHasItsReason) {
  Considered considered = five();
  EXPECT_EQ(choose(considered, ""), 2);
  EXPECT_EQ(considered.facts[0].reason, "usable, but another ranks higher; name it with --device");
  EXPECT_EQ(considered.facts[4].reason, "has no compute queue");
  considered = five();
  EXPECT_EQ(choose(considered, "iris"), 1);
  EXPECT_EQ(considered.facts[2].reason, "is not the wanted one ('iris')");
}

/// A device that does not compute as the host does makes way for the next best, and is told why.
TEST(Choose, WhatFailsItsSelfCheckMakesWay) {
  Considered considered = five();
  std::vector<std::size_t> tried;
  const Start only_software = [&](Considered& all, std::size_t row) {
    tried.push_back(row);
    all.facts[row].self_check = row == 0 ? "passed" : "failed";
    return std::string(row == 0 ? "" : "differs in a + b");
  };
  EXPECT_EQ(choose(considered, "", only_software), 0);
  EXPECT_EQ(tried, (std::vector<std::size_t>{2, 1, 3, 0}));
  EXPECT_TRUE(considered.facts[0].chosen);
  EXPECT_EQ(considered.facts[0].reason, "");
  EXPECT_EQ(considered.facts[0].self_check, "passed");
  EXPECT_EQ(considered.facts[2].reason, "differs in a + b");
  EXPECT_EQ(considered.facts[2].self_check, "failed");
  EXPECT_EQ(considered.facts[4].self_check, "not run");

  considered = five();
  EXPECT_EQ(choose(considered, "geforce", only_software), -1) << "what was asked for is not replaced";
  EXPECT_EQ(considered.facts[2].reason, "differs in a + b");
}

TEST(Lacks, EachLackIsNamed) {
  const Abilities able{VK_API_VERSION_1_2, true, true, {}};
  EXPECT_EQ(lacks(able), "");
  Abilities old = able;
  old.api = VK_MAKE_API_VERSION(0, 1, 1, 4095);
  EXPECT_EQ(lacks(old), "needs Vulkan 1.2, has 1.1.4095");
  Abilities narrow = able;
  narrow.doubles = false;
  EXPECT_EQ(lacks(narrow), "has no 64-bit floating point in shaders (shaderFloat64)");
  Abilities drawing = able;
  drawing.compute = false;
  EXPECT_EQ(lacks(drawing), "has no compute queue");
  Abilities texels = able;
  texels.missing = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_UINT};
  EXPECT_EQ(lacks(texels), "has no storage texel buffers of VkFormat 100");
}

TEST(ComputeFamily, OneWithoutGraphicsIfThereIsOne) {
  const VkQueueFamilyProperties both{VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, 1, 0, {}};
  const VkQueueFamilyProperties plain{VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT, 1, 0, {}};
  const VkQueueFamilyProperties copies{VK_QUEUE_TRANSFER_BIT, 1, 0, {}};
  const auto family = [](std::vector<VkQueueFamilyProperties> families) { return compute_family(families); };
  EXPECT_EQ(family({both, copies, plain, plain}), 2);
  EXPECT_EQ(family({plain, both}), 0);
  EXPECT_EQ(family({copies, both, both}), 1);
  EXPECT_EQ(family({copies}), -1);
  EXPECT_EQ(family({}), -1);
}

}  // namespace
}  // namespace sf::gpu
