// Tables without shared memory: copies in both directions, forced on devices with shared memory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "shaders/loop.comp.h"

namespace sf::gpu {
namespace {

class Staging : public testing::Test {
 protected:
  void SetUp() override {
    if (const char* set = std::getenv("SENSORFARM_STAGING")) before_ = set;
    setenv("SENSORFARM_STAGING", "1", 1);
  }
  void TearDown() override {
    before_.empty() ? unsetenv("SENSORFARM_STAGING") : setenv("SENSORFARM_STAGING", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

void fill(Buffer& table, std::uint32_t word) { std::ranges::fill(table.host<std::uint32_t>(), word); }

std::vector<std::uint32_t> words(Buffer& table) {
  const auto host = table.host<std::uint32_t>();
  return {host.begin(), host.end()};
}

/// A batch of copies without kernels.
void run_copies(Batch& batch) {
  batch.begin();
  batch.end();
  batch.run();
}

TEST_F(Staging, EnvironmentForcesItWhenADeviceOpens) {
  EXPECT_FALSE(Device().unified());
  setenv("SENSORFARM_STAGING", "0", 1);
  const bool shared = Device().unified();
  unsetenv("SENSORFARM_STAGING");
  EXPECT_EQ(Device().unified(), shared);
  EXPECT_TRUE(shared || Device().info().driver.find("llvmpipe") == std::string::npos);
}

/// Only the listed bytes are copied, to the same offset, once.
TEST_F(Staging, CopiesOnlyTheListedBytes) {
  Device device;
  Batch batch(device);
  for (const Role role : {Role::upload, Role::download}) {
    Buffer table(device, "table", role, Texel::u32, 8);
    fill(table, 1);
    batch.upload(table, 0, table.bytes());
    run_copies(batch);

    fill(table, 2);
    batch.upload(table, 8, 12);
    batch.upload(table, 28, 4);
    batch.upload(table, 0, 0);
    run_copies(batch);
    fill(table, 3);
    run_copies(batch);

    fill(table, 9);
    batch.download(table, 4, 8);
    batch.download(table, 20, 0);
    run_copies(batch);
    EXPECT_EQ(words(table), (std::vector<std::uint32_t>{9, 1, 2, 9, 9, 9, 9, 9}));
    fill(table, 9);
    run_copies(batch);
    EXPECT_EQ(words(table), std::vector<std::uint32_t>(8, 9u)) << "each copy is requested separately";
    batch.download(table, 0, table.bytes());
    run_copies(batch);
    EXPECT_EQ(words(table), (std::vector<std::uint32_t>{1, 1, 2, 2, 2, 1, 1, 2}));
  }
}

/// Group counts at an offset, in more than one dimension.
TEST_F(Staging, KernelReadsUploadsAndWritesDownloads) {
  Device device;
  Kernel kernel(device, "loop", loop_comp_spv);
  Buffer counts(device, "counts", Role::upload, Texel::u32, 128);
  Buffer sums(device, "sums", Role::download, Texel::u32x4, 128);
  Buffer groups(device, "groups", Role::upload, Texel::u32, 8);
  kernel.bind({{"counts", &counts}, {"sums", &sums}});
  for (std::uint32_t i = 0; i < 128; ++i) counts.host<std::uint32_t>()[i] = i;
  fill(groups, 0);
  std::ranges::fill(groups.host<std::uint32_t>().subspan(4, 3), 1u);
  fill(sums, 77);
  Batch batch(device);
  batch.begin();
  batch.dispatch(kernel, groups, 16);
  batch.end();
  batch.upload(counts, 0, counts.bytes());
  batch.upload(groups, 0, groups.bytes());
  batch.upload(sums, 0, sums.bytes());
  batch.download(sums, 0, sums.bytes());
  batch.run();
  for (std::uint32_t i = 0; i < 128; ++i) {
    EXPECT_EQ(sums.host<std::uint32_t>()[4 * i], i < 64 ? i : 77) << "one group of 64";
    EXPECT_EQ(sums.host<std::uint32_t>()[4 * i + 1], i < 64 ? i : 77);
  }

  // Recorded once, run again with different group counts.
  groups.host<std::uint32_t>()[4] = 2;
  batch.upload(groups, 16, 4);
  batch.download(sums, 0, sums.bytes());
  batch.run();
  EXPECT_EQ(sums.host<std::uint32_t>()[4 * 127], 127u);
}

}  // namespace
}  // namespace sf::gpu
