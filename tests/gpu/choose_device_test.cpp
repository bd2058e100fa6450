// Chooses among several synthetic devices.

#include <gtest/gtest.h>

#include "gpu/device_vk.h"

namespace sf::gpu {
namespace {

constexpr VkPhysicalDeviceType kDiscrete = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
constexpr VkPhysicalDeviceType kIntegrated = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
constexpr VkPhysicalDeviceType kVirtual = VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU;
constexpr VkPhysicalDeviceType kCpu = VK_PHYSICAL_DEVICE_TYPE_CPU;
constexpr VkPhysicalDeviceType kOther = VK_PHYSICAL_DEVICE_TYPE_OTHER;

DeviceInfo device(const std::string& name, VkPhysicalDeviceType type, const std::string& lack = "") {
  DeviceInfo info;
  info.name = name;
  info.driver = "Driver of " + name;
  info.kind = device_type_text(type);
  info.reason = lack;
  return info;
}

DeviceCandidates five() {
  DeviceCandidates candidates;
  candidates.info = {device("llvmpipe", kCpu), device("Iris", kIntegrated), device("GeForce", kDiscrete),
                     device("virgl", kVirtual), device("Old", kDiscrete, "has no compute queue")};
  return candidates;
}

std::string chosen_of(const std::vector<DeviceInfo>& devices, const std::string& wanted = "") {
  DeviceCandidates candidates;
  candidates.info = devices;
  const int row = choose_device(candidates, wanted);
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(candidates.info[i].chosen, static_cast<int>(i) == row);
    EXPECT_EQ(candidates.info[i].reason.empty(), candidates.info[i].chosen) << candidates.info[i].name;
  }
  return row < 0 ? "" : candidates.info[static_cast<std::size_t>(row)].name;
}

TEST(Choose, PrefersTheBestKindInAnyOrder) {
  const DeviceInfo other = device("other", kOther), cpu = device("cpu", kCpu), guest = device("virtual", kVirtual),
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

TEST(Choose, NamesTheKinds) {
  EXPECT_EQ(device("", kDiscrete).kind, "discrete GPU");
  EXPECT_EQ(device("", kIntegrated).kind, "integrated GPU");
  EXPECT_EQ(device("", kVirtual).kind, "virtual GPU");
  EXPECT_EQ(device("", kCpu).kind, "CPU");
  EXPECT_EQ(device("", kOther).kind, "other");
}

TEST(Choose, NeverSelectsAnIncompleteDevice) {
  EXPECT_EQ(chosen_of(five().info), "GeForce");
  EXPECT_EQ(chosen_of(five().info, "Old"), "");
  EXPECT_EQ(chosen_of(five().info, "4"), "");
}

TEST(Choose, MatchesRowOrPartOfNameOrDriverIgnoringCase) {
  EXPECT_EQ(chosen_of(five().info, "0"), "llvmpipe");
  EXPECT_EQ(chosen_of(five().info, "3"), "virgl");
  EXPECT_EQ(chosen_of(five().info, "5"), "") << "one past the last row";
  EXPECT_EQ(chosen_of(five().info, "LLVM"), "llvmpipe");
  EXPECT_EQ(chosen_of(five().info, "geforce"), "GeForce");
  EXPECT_EQ(chosen_of(five().info, "dRIVER OF iRIS"), "Iris");
  EXPECT_EQ(chosen_of(five().info, "0x"), "") << "a number with more behind it is a name";
  EXPECT_EQ(chosen_of(five().info, "driver"), "GeForce") << "the best that it names";
}

TEST(Choose, GivesAReasonForEveryOtherDevice) {
  DeviceCandidates candidates = five();
  EXPECT_EQ(choose_device(candidates, ""), 2);
  EXPECT_EQ(candidates.info[0].reason, "usable, but another ranks higher; select it with --device");
  EXPECT_EQ(candidates.info[4].reason, "has no compute queue");
  candidates = five();
  EXPECT_EQ(choose_device(candidates, "iris"), 1);
  EXPECT_EQ(candidates.info[2].reason, "does not match 'iris'");
}

/// A device that fails its self-check gets the fault as its reason, and the next best is chosen.
TEST(Choose, SkipsADeviceThatFailsItsSelfCheck) {
  DeviceCandidates candidates = five();
  std::vector<std::size_t> tried;
  const TryDevice only_software = [&](DeviceCandidates& all, std::size_t row) {
    tried.push_back(row);
    all.info[row].self_check = row == 0 ? "passed" : "failed";
    return std::string(row == 0 ? "" : "differs in a + b");
  };
  EXPECT_EQ(choose_device(candidates, "", only_software), 0);
  EXPECT_EQ(tried, (std::vector<std::size_t>{2, 1, 3, 0}));
  EXPECT_TRUE(candidates.info[0].chosen);
  EXPECT_EQ(candidates.info[0].reason, "");
  EXPECT_EQ(candidates.info[0].self_check, "passed");
  EXPECT_EQ(candidates.info[2].reason, "differs in a + b");
  EXPECT_EQ(candidates.info[2].self_check, "failed");
  EXPECT_EQ(candidates.info[4].self_check, "not run");

  candidates = five();
  EXPECT_EQ(choose_device(candidates, "geforce", only_software), -1) << "a requested device is not replaced";
  EXPECT_EQ(candidates.info[2].reason, "differs in a + b");
}

TEST(Lacks, NamesEachMissingFeature) {
  const DeviceFeatures able{VK_API_VERSION_1_2, true, true, true, {}};
  EXPECT_EQ(missing_feature(able), "");
  DeviceFeatures old = able;
  old.api = VK_MAKE_API_VERSION(0, 1, 1, 4095);
  EXPECT_EQ(missing_feature(old), "needs Vulkan 1.2, has 1.1.4095");
  DeviceFeatures narrow = able;
  narrow.doubles = false;
  EXPECT_EQ(missing_feature(narrow), "has no 64-bit floating point in shaders (shaderFloat64)");
  DeviceFeatures drawing = able;
  drawing.compute = false;
  EXPECT_EQ(missing_feature(drawing), "has no compute queue");
  DeviceFeatures silent = able;
  silent.votes = false;
  EXPECT_EQ(missing_feature(silent), "has no votes of subgroups in compute shaders (VK_SUBGROUP_FEATURE_VOTE_BIT)");
  DeviceFeatures texels = able;
  texels.missing = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_UINT};
  EXPECT_EQ(missing_feature(texels), "has no storage texel buffers of VkFormat 100");
}

TEST(ComputeFamily, PrefersAFamilyWithoutGraphics) {
  const VkQueueFamilyProperties both{VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, 1, 0, {}};
  const VkQueueFamilyProperties plain{VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT, 1, 0, {}};
  const VkQueueFamilyProperties copies{VK_QUEUE_TRANSFER_BIT, 1, 0, {}};
  const auto family = [](std::vector<VkQueueFamilyProperties> families) { return compute_queue_family(families); };
  EXPECT_EQ(family({both, copies, plain, plain}), 2);
  EXPECT_EQ(family({plain, both}), 0);
  EXPECT_EQ(family({copies, both, both}), 1);
  EXPECT_EQ(family({copies}), -1);
  EXPECT_EQ(family({}), -1);
}

}  // namespace
}  // namespace sf::gpu
