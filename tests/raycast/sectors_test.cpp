// Sector lists may hold too much, never too little.

#include "raycast/sectors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "raycast/sight.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"

namespace sf::raycast {
namespace {

bool lists_row(const SectorLists& lists, std::uint32_t sector, std::uint32_t row) {
  return std::any_of(lists.order.begin() + lists.first[sector], lists.order.begin() + lists.first[sector + 1],
                     [&](std::uint32_t i) { return lists.candidates[i].id == row; });
}

/// The row of the first wall along a beam, by the oracle: every wall is its own model here.
std::uint32_t first_wall(const std::vector<world::Segment>& walls, Vec2 p, double direction, double range) {
  return oracle::cast(oracle::within(walls, p, range), p, direction, range).model;
}

void every_hit_is_listed(world::World world, double range, double size, std::uint64_t seed) {
  for (std::uint32_t row = 0; row < world.walls.size(); ++row) world.walls[row].model = row;
  const Sight sight(world, 0.1, range);
  const CellShape shape{size, range, 0.01};
  Sight::Nearby nearby;
  SectorLists lists;
  trial::Chance chance(seed);
  std::size_t checked = 0;
  for (int c = 0; c < 40; ++c) {
    const Vec2 centre = chance.in_square(0.45 * (world.extent.x_max - world.extent.x_min));
    for (const bool both : {false, true}) {
      collect(sight, shape, centre, both, nearby, lists);
      for (int i = 0; i < 60; ++i) {
        const bool corner = i % 4 == 0;  // of the cell
        const Vec2 p = centre + (corner ? Vec2{(i % 8 ? 0.5 : -0.5) * size, (i % 16 < 8 ? 0.5 : -0.5) * size}
                                        : chance.in_square(0.5 * size));
        if (!both && sight.inside_solid(p)) continue;
        const double direction = chance.between(0.0, 2.0 * M_PI);
        const std::uint32_t row = first_wall(world.walls, p, direction, range);
        if (row == 0xFFFFFFFFu) continue;
        const auto sector = static_cast<std::uint32_t>(direction * SF_SECTORS / (2.0 * M_PI)) % SF_SECTORS;
        EXPECT_TRUE(lists_row(lists, sector, row)) << "wall " << row << " from " << p.x << ", " << p.y;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 500u);
}

TEST(Sectors, EveryWallABeamMeetsIsListed) {
  every_hit_is_listed(scenes::cave(300, 16.0, 3), 8.0, 0.25, 1);
  every_hit_is_listed(scenes::cave(300, 16.0, 4), 30.0, 1.0, 2);
  every_hit_is_listed(scenes::boxes(60, 16.0, 5), 8.0, 0.25, 3);
  every_hit_is_listed(scenes::boxes(60, 16.0, 6), 30.0, 0.003, 4);
}

TEST(Sectors, ListsRunNearToFarAndHoldEachWallOnce) {
  const world::World world = scenes::boxes(60, 16.0, 5);
  const Sight sight(world, 0.1, 8.0);
  Sight::Nearby nearby;
  SectorLists lists;
  collect(sight, {0.25, 8.0, 0.0}, {1.0, 0.5}, false, nearby, lists);
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) {
    std::set<std::uint32_t> seen;
    double before = 0.0;
    for (std::uint32_t at = lists.first[s]; at < lists.first[s + 1]; ++at) {
      EXPECT_TRUE(seen.insert(lists.order[at]).second);
      EXPECT_EQ(lists.candidates[lists.order[at]].facing, at < lists.behind[s]);
      if (at == lists.behind[s]) before = 0.0;
      EXPECT_GE(lists.candidates[lists.order[at]].nearest, before);
      before = lists.candidates[lists.order[at]].nearest;
    }
  }
}

/// Far fewer than all walls: the point of the lists.
TEST(Sectors, ListsAreShort) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const Sight sight(world, 0.1, 8.0);
  Sight::Nearby nearby;
  SectorLists lists;
  collect(sight, {0.25, 8.0, 0.0}, {}, false, nearby, lists);
  EXPECT_LT(lists.order.size() / SF_SECTORS, world.walls.size() / 8);
}

TEST(Sectors, IntervalsWrapAround) {
  SectorLists lists;
  const double sector = 2.0 * M_PI / SF_SECTORS;
  const auto sectors_of = [&](double low, double high) {
    lists.clear();
    lists.candidates.push_back({});
    lists.add_interval(low, high);
    std::set<std::uint32_t> touched;
    for (const auto& item : lists.items) EXPECT_TRUE(touched.insert(item.sector).second) << "twice";
    return touched;
  };
  EXPECT_EQ(sectors_of(0.1 * sector, 0.9 * sector), (std::set<std::uint32_t>{0}));
  EXPECT_EQ(sectors_of(-0.1 * sector, 0.1 * sector), (std::set<std::uint32_t>{31, 0}));
  EXPECT_EQ(sectors_of(31.5 * sector, 33.5 * sector), (std::set<std::uint32_t>{31, 0, 1}));
  EXPECT_EQ(sectors_of(-40.5 * sector, -40.1 * sector), (std::set<std::uint32_t>{23}));
  EXPECT_EQ(sectors_of(0.5 * sector, 31.5 * sector).size(), 32u) << "all round";
  EXPECT_EQ(sectors_of(0.0, 100.0).size(), 32u);
}

/// A list's word never promises more clearance than there is, and at least half of it.
TEST(Sectors, WordsRoundClearanceDown) {
  for (const float clearance : {0.05f, 0.03f, 1.0f / 64, 1e-3f, 1e-9f, 1e-30f}) {
    const double promised = std::ldexp(1.0, -static_cast<int>(list_word(5, clearance) >> SF_ROW_BITS));
    EXPECT_LE(promised, clearance);
    EXPECT_GT(2.0 * promised, clearance);
  }
  EXPECT_EQ(list_word(5, 0.0f) >> SF_ROW_BITS, std::uint32_t{SF_NO_CLEARANCE}) << "code 127 is no clearance at all";
  EXPECT_EQ(list_word(5, 1e-44f) >> SF_ROW_BITS, std::uint32_t{SF_NO_CLEARANCE}) << "too little to say";
  EXPECT_EQ(list_word(0xABCDEF, 0.01f) & SF_ROW_MASK, 0xABCDEFu);
}

/// What is written for the device: padding is in front of nothing, each chunk's least distance is a lower bound.
TEST(Sectors, WrittenListsArePadded) {
  const world::World world = scenes::boxes(7, 8.0, 5);
  const Sight sight(world, 0.1, 8.0);
  Sight::Nearby nearby;
  SectorLists lists;
  collect(sight, {0.25, 8.0, 0.0}, {}, false, nearby, lists);
  const std::uint32_t chunks = lists.all_chunks();
  std::vector<ListEntry> entries(SF_CHUNK * (chunks + 3));
  std::vector<std::uint32_t> ids(entries.size(), 7);
  std::vector<float> nearest(chunks + 3, -1.0f);
  std::vector<std::uint32_t> words;
  for (std::uint32_t row = 0; row < world.walls.size(); ++row) words.push_back(list_word(row, 0.01f));
  ListHeader headers[SF_SECTORS];
  write_lists(lists, 3, {entries.data(), ids.data(), nearest.data(), words.data()}, headers);
  EXPECT_EQ(headers[0].first, 3u);
  const ListHeader& end = headers[SF_SECTORS - 1];
  EXPECT_EQ(end.first + end.count + end.behind, chunks + 3);
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) {
    const std::uint32_t facing = lists.behind[s] - lists.first[s];
    for (std::uint32_t k = 0; k < (headers[s].count + headers[s].behind) * SF_CHUNK; ++k) {
      const std::uint32_t at = headers[s].first * SF_CHUNK + k;
      const bool faces = k < headers[s].count * SF_CHUNK;
      const std::uint32_t number = faces ? k : k - headers[s].count * SF_CHUNK;
      const std::uint32_t used = faces ? facing : lists.first[s + 1] - lists.behind[s];
      const std::uint32_t* const order = lists.order.data() + (faces ? lists.first[s] : lists.behind[s]);
      if (number >= used) {
        EXPECT_EQ(ids[at], SF_NO_HIT);
        EXPECT_LT(entries[at].ex * entries[at].ay - entries[at].ey * entries[at].ax, -1e20f);
        continue;
      }
      EXPECT_EQ(lists.candidates[order[number]].facing, faces);
      EXPECT_EQ(ids[at] & SF_ROW_MASK, lists.candidates[order[number]].id);
      EXPECT_LE(nearest[at / SF_CHUNK], lists.candidates[order[number]].nearest);
    }
  }
}

}  // namespace
}  // namespace sf::raycast
