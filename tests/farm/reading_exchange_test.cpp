// Readings as bytes between the processes of a shared fleet.

#include "farm/reading_exchange.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace sf::farm {
namespace {

using base::QualityFlag;

/// Owns the numbers of a block.
struct Reading {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<QualityFlag> quality;

  base::ReadingBlock block(std::uint32_t number) const {
    const double n = number;
    return {.mover = number,
            .sensor = number + 1,
            .type = static_cast<std::uint8_t>(number + 2),
            .sequence = number + 3,
            .time = 1'000'000'007ll * number,
            .X_WM = {n + 0.1, n + 0.2, n + 0.3, n + 0.4},
            .X_WS = {n + 0.5, n + 0.6, n + 0.7, n + 0.8},
            .values = values,
            .hits = hits,
            .flags = number + 4,
            .mode = static_cast<std::uint8_t>(number + 5),
            .bound = 1e-9 * n,
            .quality = quality};
  }
};

void expect_same_reading(const base::ReadingBlock& a, const base::ReadingBlock& b) {
  EXPECT_EQ(a.mover, b.mover);
  EXPECT_EQ(a.sensor, b.sensor);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(std::memcmp(&a.X_WM, &b.X_WM, sizeof a.X_WM), 0);
  EXPECT_EQ(std::memcmp(&a.X_WS, &b.X_WS, sizeof a.X_WS), 0);
  EXPECT_TRUE(std::ranges::equal(a.values, b.values));
  EXPECT_TRUE(std::ranges::equal(a.hits, b.hits));
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.bound, b.bound);
  EXPECT_TRUE(std::ranges::equal(a.quality, b.quality));
}

/// Reads a scan with all fields, a plain reading and an empty one with one reader: no data of an earlier reading
/// remains.
TEST(ReadingExchange, ReadingsRoundTripInSequence) {
  const Reading scan{{1.0 / 3.0, 8.0, 0.5}, {7, base::kNoHit, 9}, {QualityFlag::none, QualityFlag::grazing}};
  const Reading plain{{0.25}, {}, {}};
  const Reading empty;
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  const Reading* const all[] = {&scan, &plain, &empty, &scan};
  for (std::uint32_t i = 0; i < 4; ++i) write_reading(all[i]->block(10 * i), out);
  base::ByteReader in(bytes);
  ReadingFromBytes read;
  for (std::uint32_t i = 0; i < 4; ++i) {
    SCOPED_TRACE(i);
    read.read(in);
    expect_same_reading(read.block, all[i]->block(10 * i));
    EXPECT_EQ(read.block.values.data(), read.values.data());
  }
  EXPECT_EQ(in.left(), 0u);
}

}  // namespace
}  // namespace sf::farm
