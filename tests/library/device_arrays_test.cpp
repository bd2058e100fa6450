// Memory of worlds on a device that CUDA sees, with the libcuda of the tests.

#include <gtest/gtest.h>

#include <cstring>
#include <optional>
#include <vector>

#include "gpu/device_vk.h"
#include "sensorfarm/device_worlds.h"
#include "tests/gpu/fake_cuda.h"

namespace sensorfarm {
namespace {

constexpr const char* kCorner =
    "define wall model( size [4 0.2 1] ) wall( pose [0 2 0 0] ) wall( pose [2 0 0 90] )"
    "position( name \"bot\" size [0.3 0.3 0.2] pose [-1 -1 0 0] drive \"diff\" laser( samples 7 range_max 5 ) )";

class DeviceArrays : public testing::Test {
 protected:
  void SetUp() override {
    const sf::gpu::Device device;
    sf::gpu::FakeCuda::name_device(device.vk().uuid);
    if (device.vk().memory_fd == nullptr) GTEST_SKIP() << "the driver has no VK_KHR_external_memory_fd";
  }

 private:
  sf::gpu::FakeCuda cuda_;
};

/// Commands in the memory of the device: those of a step are there, written ones are executed and survive restarts of
/// other worlds, and a restart stops its own world.
TEST_F(DeviceArrays, CommandsThroughCuda) {
  const Options options{.seed = 3, .copies = 2};
  DeviceWorlds worlds = DeviceWorlds::from_text(kCorner, options), twin = DeviceWorlds::from_text(kCorner, options);
  worlds.step(std::vector<Twist>{{0.25, 0, 0.5}, {0.125, 0, 1}}),
      twin.step(std::vector<Twist>{{0.25, 0, 0.5}, {0.125, 0, 1}});
  const DeviceArray array = worlds.array(DeviceTable::commands);
  ASSERT_EQ(array.cuda, 0);
  EXPECT_FALSE(array.copied);
  ASSERT_EQ(array.stride, 4u);
  const std::vector<double> given{0.25, 0, 0.5, 0, 0.125, 0, 1, 0};
  double* const shared = sf::gpu::FakeCuda::find(array.data, std::span<const double>(given));
  ASSERT_NE(shared, nullptr);
  const auto expect_same = [&] {
    EXPECT_EQ(std::memcmp(worlds.poses().data(), twin.poses().data(), twin.poses().size_bytes()), 0);
  };
  shared[0] = -0.5, shared[4] = 0.5;
  worlds.step(), twin.step(std::vector<Twist>{{-0.5, 0, 0.5}, {0.5, 0, 1}}), expect_same();
  const std::uint32_t second[] = {1};
  const std::uint64_t seed[] = {9};
  worlds.reset(second, seed), twin.reset(second, seed);
  EXPECT_EQ(shared[0], -0.5);
  EXPECT_EQ(shared[4], 0.0);
  shared[4] = 0.75;  // written right after the restart: no later copy may undo it
  worlds.step(), twin.step(std::vector<Twist>{{-0.5, 0, 0.5}, {0.75, 0, 0}}), expect_same();
  worlds.step(std::vector<Twist>(2));
  EXPECT_EQ(shared[4], 0.0);
}

TEST_F(DeviceArrays, ResultsThroughCudaOutliveTheWorlds) {
  std::optional<DeviceWorlds> worlds(DeviceWorlds::from_text(kCorner, {.copies = 2}));
  worlds->observe({.stack = 2});
  std::optional<DeviceArray> array(worlds->array(DeviceTable::observations));
  ASSERT_EQ(array->cuda, 0);
  worlds->step(std::vector<Twist>{{0.25, 0, 0.5}, {0.125, 0, 1}});
  worlds->step();
  const auto seen = worlds->observations();
  EXPECT_EQ(array->rows * array->columns, seen.size());
  float* const shared = sf::gpu::FakeCuda::find(array->data, seen);
  ASSERT_NE(shared, nullptr);
  const float last = seen.back();
  worlds->observe(), worlds.reset();
  EXPECT_EQ(shared[array->rows * array->columns - 1], last);
  array.reset();
  EXPECT_EQ(sf::gpu::FakeCuda::held(), 0);
}

}  // namespace
}  // namespace sensorfarm
