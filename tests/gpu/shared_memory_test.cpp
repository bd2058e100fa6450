// Memory of tables that CUDA sees, with a libcuda of the tests. Drivers without VK_KHR_external_memory_fd skip what
// needs it; lavapipe of Mesa 22.3 and 25.0 has it.

#include "gpu/shared_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <vector>

#include "gpu/batch.h"
#include "gpu/device_vk.h"
#include "tests/gpu/fake_cuda.h"

namespace sf::gpu {
namespace {

class SharedMemory : public testing::Test {
 protected:
  SharedMemory() : device_(std::in_place) { FakeCuda::name_device(device_->vk().uuid); }
  bool exports() const { return device_->vk().memory_fd != nullptr; }
  Buffer table() { return {*device_, "shared", Role::download, Texel::u32, 1'000}; }

  FakeCuda cuda_;
  std::optional<Device> device_;
};

TEST_F(SharedMemory, BothSidesSeeWhatTheOtherWrites) {
  if (!exports()) GTEST_SKIP() << "the driver has no VK_KHR_external_memory_fd";
  Batch batch(*device_);
  {
    const ExportScope scope(*device_);
    Buffer table = this->table();
    std::vector<std::uint32_t> words(table.texels());
    std::iota(words.begin(), words.end(), 77u);
    std::ranges::copy(words, table.host<std::uint32_t>().begin());
    batch.begin(), batch.end();
    batch.upload(table, 0, table.bytes());
    batch.run();
    const auto memory = CudaMemory::of(table);
    ASSERT_NE(memory, nullptr);
    EXPECT_EQ(memory->device(), 0);
    std::uint32_t* const shared = FakeCuda::find(memory->data(), std::span<const std::uint32_t>(words));
    ASSERT_NE(shared, nullptr);
    shared[999] = 5;
    EXPECT_NE(table.host<std::uint32_t>()[999], 5u);
    batch.download(table, 0, table.bytes());
    batch.run();
    EXPECT_EQ(table.host<std::uint32_t>()[999], 5u);
  }
  EXPECT_EQ(FakeCuda::held(), 0);
}

TEST_F(SharedMemory, NoneForOtherTablesAndDevices) {
  const Buffer outside = table();
  EXPECT_EQ(CudaMemory::of(outside), nullptr);
  const ExportScope scope(*device_);
  const Buffer inside = table();
  FakeCuda::name_device(device_->vk().uuid, 1);
  EXPECT_EQ(CudaMemory::of(inside), nullptr) << "another GPU";
  FakeCuda::name_device(device_->vk().uuid);
  EXPECT_EQ(CudaMemory::of(inside) != nullptr, exports());
  EXPECT_EQ(FakeCuda::held(), 0);
}

/// Where host and device share memory, the host's view is the table already.
TEST_F(SharedMemory, NoneOnAUnifiedDevice) {
  unsetenv("SENSORFARM_STAGING");
  device_.reset();
  device_.emplace();
  if (!device_->unified()) GTEST_SKIP() << "the device has memory of its own";
  const ExportScope scope(*device_);
  EXPECT_EQ(CudaMemory::of(table()), nullptr);
}

}  // namespace
}  // namespace sf::gpu
