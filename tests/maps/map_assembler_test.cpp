// Maps over a network with loss, duplicates and reordering, from restarted senders, and from arbitrary bytes.

#include "maps/map_assembler.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/chance.h"

namespace sf::maps {
namespace {

GridGeometry map_geometry() { return {-1.8, 1.8, 0.03, 30, 30}; }

/// A map whose words encode the number of the map and of the word.
OccupancyGrid numbered(std::uint32_t map, const GridGeometry& p = map_geometry()) {
  OccupancyGrid grid(p);
  for (std::uint32_t i = 0; i < grid.words.size(); ++i) grid.words[i] = (map * 2654435761u + i) & 0x55555555u;
  return grid;
}

std::vector<base::Bytes> parts_of(const OccupancyGrid& grid, std::uint32_t flags = 0) {
  std::vector<base::Bytes> parts(maps::parts_of(grid.geometry));
  for (std::uint32_t p = 0; p < parts.size(); ++p)
    put_part(
        grid.geometry, p, flags, [&](std::uint32_t i) { return grid.words[i]; }, parts[p]);
  return parts;
}

std::vector<base::Bytes> plain_parts(const OccupancyGrid& grid) {
  std::vector<base::Bytes> parts(2);
  const std::uint32_t half = plain_half(words(grid.geometry));
  parts[0] = {static_cast<std::uint8_t>(grid.geometry.word_rows),
              static_cast<std::uint8_t>(grid.geometry.word_columns)};
  for (std::uint32_t i = 0; i < grid.words.size(); ++i) base::ByteWriter(parts[i < half ? 0 : 1]).put(grid.words[i]);
  return parts;
}

TEST(MapPackets, EncodesEveryByteOfAPart) {
  OccupancyGrid grid(GridGeometry{1.0, -2.0, 0.5, 2, 1});
  grid.words = {0x00000001u, 0x8A000000u};
  const base::Bytes bytes = parts_of(grid, kTruePoses)[0];
  const base::Bytes expected{0,    0,    0, 0, 0, 0, 0xF0, 0x3F, 0, 0, 0, 0, 0, 0, 0, 0xC0, 0, 0, 0, 0, 0, 0,
                             0xE0, 0x3F, 0, 0, 1, 0, 2,    0,    1, 0, 1, 0, 2, 0, 1, 0,    0, 0, 0, 0, 0, 0x8A};
  EXPECT_EQ(bytes, expected);
}

TEST(MapPackets, PartsFillADatagram) {
  const auto parts = parts_of(numbered(0));
  ASSERT_EQ(parts.size(), 3u) << "900 words of 305";
  EXPECT_EQ(parts[0].size(), 1256u) << "1400 with the header and a signature";
  EXPECT_EQ(parts[2].size(), 36u + 4 * 290);
  EXPECT_EQ(plain_parts(numbered(0))[0].size(), 1802u) << "two of about 1.8 kB";
  EXPECT_EQ(plain_parts(numbered(0))[1].size(), 1800u);
}

TEST(MapPackets, RejectsMalformedParts) {
  const base::Bytes good = parts_of(numbered(3))[2];
  MapPart part;
  ASSERT_EQ(read_part(good, part), PartFault::none);
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_EQ(read_part(std::span(good).first(n), part), PartFault::too_short) << n;
  base::Bytes longer = good;
  longer.push_back(0);
  EXPECT_EQ(read_part(longer, part), PartFault::too_long);
  const auto patched = [&](std::size_t at, auto value) {
    base::Bytes bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return read_part(bytes, part);
  };
  EXPECT_EQ(patched(0, std::nan("")), PartFault::out_of_range) << "left";
  EXPECT_EQ(patched(8, 1.1e7), PartFault::out_of_range) << "top";
  EXPECT_EQ(patched(16, 0.0), PartFault::out_of_range) << "cell";
  EXPECT_EQ(patched(24, std::uint16_t{3}), PartFault::out_of_range) << "a part beyond the last";
  EXPECT_EQ(patched(26, std::uint16_t{4}), PartFault::out_of_range) << "parts";
  EXPECT_EQ(patched(28, std::uint16_t{0}), PartFault::out_of_range) << "no columns";
  EXPECT_EQ(patched(30, std::uint16_t{5000}), PartFault::out_of_range) << "rows";
  EXPECT_EQ(patched(32, std::uint16_t{2}), PartFault::out_of_range) << "undefined flags";
  EXPECT_EQ(patched(36, std::uint32_t{3}), PartFault::out_of_range) << "an invalid state";
}

TEST(MapAssembler, AcceptsPartsInAnyOrder) {
  MapAssembler assembler;
  EXPECT_EQ(assembler.map(), nullptr);
  const OccupancyGrid grid = numbered(1);
  const auto parts = parts_of(grid, kTruePoses);
  EXPECT_EQ(assembler.add_part(7, parts[2]), MapPartStatus::incomplete);
  EXPECT_EQ(assembler.add_part(7, parts[0]), MapPartStatus::incomplete);
  EXPECT_EQ(assembler.add_part(7, parts[0]), MapPartStatus::duplicate);
  EXPECT_EQ(assembler.add_part(7, parts[1]), MapPartStatus::complete);
  EXPECT_EQ(assembler.add_part(7, parts[1]), MapPartStatus::duplicate);
  EXPECT_EQ(assembler.map()->words, grid.words);
  EXPECT_EQ(assembler.map()->geometry, grid.geometry);
  EXPECT_TRUE(assembler.true_poses());
  EXPECT_EQ(assembler.complete_maps(), 1u);
  EXPECT_EQ(assembler.incomplete_maps(), 0u);
}

TEST(MapAssembler, LostPartsKeepTheirOldContent) {
  MapAssembler assembler;
  for (const base::Bytes& part : parts_of(numbered(1))) assembler.add_part(1, part);
  const auto next = parts_of(numbered(2));
  assembler.add_part(2, next[0]);
  assembler.add_part(2, next[2]);
  EXPECT_EQ(assembler.add_part(3, parts_of(numbered(3))[0]), MapPartStatus::incomplete) << "a newer map begins";
  EXPECT_EQ(assembler.incomplete_maps(), 1u);
  EXPECT_EQ(assembler.complete_maps(), 1u);
  EXPECT_EQ(assembler.map()->words[0], numbered(3).words[0]);
  EXPECT_EQ(assembler.map()->words[400], numbered(1).words[400]) << "its newest part";
  EXPECT_EQ(assembler.map()->words[899], numbered(2).words[899]);
}

TEST(MapAssembler, IgnoresLateParts) {
  MapAssembler assembler;
  const auto old = parts_of(numbered(1));
  assembler.add_part(1, old[0]);
  for (const base::Bytes& part : parts_of(numbered(2))) assembler.add_part(2, part);
  EXPECT_EQ(assembler.add_part(1, old[1]), MapPartStatus::late);
  EXPECT_EQ(assembler.add_part(1, old[2]), MapPartStatus::late)
      << "another of the same old map is no sign of a restart";
  EXPECT_EQ(assembler.map()->words, numbered(2).words);
}

TEST(MapAssembler, AcceptsARestartedSender) {
  MapAssembler assembler;
  for (const base::Bytes& part : parts_of(numbered(1))) assembler.add_part(1000, part);
  const auto again = [&](std::uint32_t sequence) {
    MapPartStatus last = MapPartStatus::faulty;
    for (const base::Bytes& part : parts_of(numbered(50 + sequence))) last = assembler.add_part(sequence, part);
    return last;
  };
  EXPECT_EQ(again(0), MapPartStatus::late) << "it could be a late one";
  EXPECT_EQ(again(1), MapPartStatus::complete);
  EXPECT_EQ(again(2), MapPartStatus::complete);
  EXPECT_EQ(assembler.map()->words, numbered(52).words);
}

TEST(MapAssembler, CountersWrap) {
  MapAssembler assembler;
  for (const base::Bytes& part : parts_of(numbered(1))) assembler.add_part(0xFFFFFFFFu, part);
  MapPartStatus last = MapPartStatus::faulty;
  for (const base::Bytes& part : parts_of(numbered(2))) last = assembler.add_part(0, part);
  EXPECT_EQ(last, MapPartStatus::complete);
}

/// If two numbers are half of the range apart, neither is newer.
TEST(MapAssembler, HalfTheRangeAheadIsNotNewer) {
  const auto after = [](std::uint32_t first, std::uint32_t next) {
    MapAssembler assembler;
    for (const base::Bytes& part : parts_of(numbered(1))) assembler.add_part(first, part);
    return assembler.add_part(next, parts_of(numbered(2))[0]);
  };
  EXPECT_EQ(after(5, 5 + 0x7FFFFFFFu), MapPartStatus::incomplete);  // the largest lead
  EXPECT_EQ(after(5, 5 + 0x80000000u), MapPartStatus::late);
  EXPECT_EQ(after(5 + 0x80000000u, 5), MapPartStatus::late);
  EXPECT_EQ(after(5, 4), MapPartStatus::late);
}

TEST(MapAssembler, NewGeometryStartsANewMap) {
  MapAssembler assembler;
  for (const base::Bytes& part : parts_of(numbered(1))) assembler.add_part(1, part);
  GridGeometry other = map_geometry();
  other.word_rows = 2;
  EXPECT_EQ(assembler.add_part(1, parts_of(numbered(2, other))[0]), MapPartStatus::contradicts);
  EXPECT_EQ(assembler.add_part(2, parts_of(numbered(2, other))[0]), MapPartStatus::complete);
  EXPECT_EQ(assembler.map()->words.size(), 60u);
}

TEST(MapAssembler, ThesisFormUsesTwoDatagrams) {
  MapAssembler assembler;
  const OccupancyGrid grid = numbered(4);
  const auto parts = plain_parts(grid);
  EXPECT_EQ(assembler.add_plain_part(parts[1]), MapPartStatus::orphan) << "whose half is it?";
  EXPECT_EQ(assembler.add_plain_part(parts[0]), MapPartStatus::incomplete);
  EXPECT_EQ(assembler.add_plain_part(parts[1]), MapPartStatus::complete);
  EXPECT_EQ(assembler.map()->words, grid.words);
  EXPECT_EQ(assembler.add_plain_part(parts[1]), MapPartStatus::duplicate);
  GridGeometry odd = map_geometry();
  odd.word_columns = 3;
  odd.word_rows = 5;
  for (const base::Bytes& part : plain_parts(numbered(5, odd))) assembler.add_plain_part(part);
  EXPECT_EQ(assembler.map()->words, numbered(5, odd).words) << "8 words and 7";
  GridGeometry one = map_geometry();
  one.word_columns = one.word_rows = 1;
  EXPECT_EQ(assembler.add_plain_part(plain_parts(numbered(6, one))[0]), MapPartStatus::complete)
      << "one word is all in the first";
}

TEST(MapAssembler, SurvivesAnyBytesAndAnyNetwork) {
  // Parts of a few maps, truncated, flipped, repeated and shuffled: no crash, and all content was sent before.
  trial::Chance chance(9);
  MapAssembler assembler, plain;
  std::uint64_t used = 0;
  for (int k = 0; k < 20'000; ++k) {
    const std::uint32_t map = chance.below(8);
    const auto parts = chance.below(2) == 0 ? parts_of(numbered(map)) : plain_parts(numbered(map));
    base::Bytes bytes = parts[chance.below(static_cast<std::uint32_t>(parts.size()))];
    const std::uint32_t harm = chance.below(4);
    if (harm == 0) bytes.resize(chance.below(static_cast<std::uint32_t>(bytes.size())));
    if (harm == 1)
      for (int flips = 0; flips < 3; ++flips)
        bytes[chance.below(40)] ^= static_cast<std::uint8_t>(1u << chance.below(8));
    const MapPartStatus taken = assembler.add_part(chance.below(6), bytes);
    used += taken == MapPartStatus::incomplete || taken == MapPartStatus::complete;
    plain.add_plain_part(bytes);
    for (const MapAssembler* a : {&assembler, &plain}) {
      if (a->map() == nullptr) continue;
      ASSERT_TRUE(a == &plain || is_valid(a->map()->geometry));
      ASSERT_LE(a->map()->words.size(), std::size_t{kMaxWords});
    }
  }
  EXPECT_GT(used, 500u);
}

}  // namespace
}  // namespace sf::maps
