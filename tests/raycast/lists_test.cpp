// Lists of walls and sectors are conservative: they may contain too much, but never miss a hit.

#include "raycast/sector_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "raycast/candidate_walls.h"
#include "raycast/reference_caster.h"
#include "raycast/wall_blocks.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"
#include "world/wall_tree.h"

namespace sf::raycast {
namespace {

/// Returns the row of the first wall along a beam, by brute force. Needs walls whose `model` is their row.
std::uint32_t first_wall(const std::vector<world::Segment>& walls, glm::dvec2 p, double direction, double range) {
  const WideBeam beam = wide_beam(p, {}, direction);
  return nearest_surface(std::span<const world::Segment>(oracle::within(walls, p, range)), beam, range).model;
}

void every_hit_is_listed(world::World world, double range, double size, std::uint64_t seed) {
  for (std::uint32_t row = 0; row < world.walls.size(); ++row) world.walls[row].model = row;
  const WallIndex wall_index(world.walls);
  const CellShape shape{size, range};
  CandidateWalls walls;
  trial::Chance chance(seed);
  std::size_t checked = 0;
  for (int c = 0; c < 40; ++c) {
    const glm::dvec2 centre = chance.in_square(0.45 * (world.extent.x_max - world.extent.x_min));
    for (const bool both : {false, true}) {
      find_candidate_walls(wall_index, shape, centre, 0.1, both, walls);
      SectorLists lists;
      for (const CandidateWall& w : walls.front_facing) lists.add(w.bearing, w.half, w.row);
      lists.sort();
      for (int i = 0; i < 60; ++i) {
        const bool corner = i % 4 == 0;  // of the cell
        const glm::dvec2 p =
            centre + (corner ? glm::dvec2{(i % 8 ? 0.5 : -0.5) * size, (i % 16 < 8 ? 0.5 : -0.5) * size}
                             : chance.in_square(0.5 * size));
        if (!both && wall_index.inside_solid(p, 0.1)) continue;
        const double direction = chance.between(0.0, 2.0 * M_PI);
        const std::uint32_t row = first_wall(world.walls, p, direction, range);
        if (row == 0xFFFFFFFFu) continue;
        const auto sector = static_cast<std::uint32_t>(direction * SF_SECTORS / (2.0 * M_PI)) % SF_SECTORS;
        EXPECT_EQ(std::ranges::count(lists.of(sector), row) > 0, true)
            << "wall " << row << " from " << p.x << ", " << p.y;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 500u);
}

TEST(Sectors, ListsEveryWallThatABeamMeets) {
  every_hit_is_listed(scenes::cave(300, 16.0, 3), 8.0, 0.25, 1);
  every_hit_is_listed(scenes::cave(300, 16.0, 4), 30.0, 1.0, 2);
  every_hit_is_listed(scenes::boxes(60, 16.0, 5), 8.0, 0.25, 3);
  every_hit_is_listed(scenes::boxes(60, 16.0, 6), 30.0, 0.003, 4);
}

/// The corners of a cell are the worst viewpoints. From there, both ends of a wall are within its interval, and no
/// point of it is nearer than its `nearest`.
TEST(CandidateWalls, IntervalsAndDistancesCoverTheCorners) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const WallIndex wall_index(world.walls);
  trial::Chance chance(7);
  std::size_t checked = 0;
  for (const double size : {0.05, 0.25, 1.0}) {
    CandidateWalls walls;
    for (int c = 0; c < 20; ++c) {
      find_candidate_walls(wall_index, {size, 8.0}, chance.in_square(6.0), 0.1, true, walls);
      for (const CandidateWall& w : walls.front_facing)
        for (const glm::dvec2& corner : {glm::dvec2{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
          const glm::dvec2 p = 0.5 * size * corner;
          ASSERT_LE(w.nearest, world::distance(p, w.a, w.b) + 1e-12);
          if (w.half > M_PI) continue;
          for (const glm::dvec2& end : {w.a - p, w.b - p}) {
            const double off = base::wrap_angle(std::atan2(end.y, end.x) - w.bearing);
            ASSERT_LE(std::abs(off), w.half) << "wall " << w.row << " from a cell of " << size << " m";
            ++checked;
          }
        }
    }
  }
  EXPECT_GT(checked, 10'000u);
}

/// Blocks contain the sorted walls, independent of the order in which they were found, and their bounds apply to each
/// of their walls.
TEST(CandidateWalls, BlocksDoNotDependOnSearchOrder) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const WallIndex wall_index(world.walls);
  CandidateWalls walls;
  find_candidate_walls(wall_index, {0.25, 8.0}, {0.5, 0.25}, 0.1, false, walls);
  ASSERT_GT(walls.front_facing.size(), 3u * kBlock);
  std::vector<CandidateWall> found = walls.front_facing, backwards(found.rbegin(), found.rend());
  std::vector<SegmentBlock> blocks, others;
  std::vector<BlockBounds> bounds, other_bounds;
  append_blocks(found, blocks, bounds);
  append_blocks(backwards, others, other_bounds);
  ASSERT_EQ(blocks.size(), (found.size() + kBlock - 1) / kBlock);
  ASSERT_EQ(bounds.size(), blocks.size());
  ASSERT_EQ(others.size(), blocks.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t block = i / kBlock;
    EXPECT_EQ(blocks[block].row[i % kBlock], found[i].row) << i;
    EXPECT_EQ(others[block].row[i % kBlock], found[i].row) << i;
    EXPECT_LE(found[i > 0 ? i - 1 : 0].distance_ring, found[i].distance_ring) << "nearest first";
    EXPECT_LE(bounds[block].nearest, found[i].nearest);
    const double offset = std::abs(base::wrap_angle(found[i].bearing - double{bounds[block].bearing}));
    EXPECT_LE(offset + found[i].half, double{bounds[block].half} + 1e-6) << i;
  }
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    EXPECT_EQ(bounds[k].nearest, other_bounds[k].nearest);
    EXPECT_EQ(bounds[k].bearing, other_bounds[k].bearing);
    EXPECT_EQ(bounds[k].half, other_bounds[k].half);
  }
}

/// Lists must be far shorter than the set of all walls.
TEST(Sectors, ListsAreShort) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const WallIndex wall_index(world.walls);
  CandidateWalls walls;
  find_candidate_walls(wall_index, {0.25, 8.0}, {}, 0.1, false, walls);
  SectorLists lists;
  for (const CandidateWall& w : walls.front_facing) lists.add(w.bearing, w.half, w.row);
  lists.sort();
  std::size_t all = 0;
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) all += lists.of(s).size();
  EXPECT_LT(all / SF_SECTORS, world.walls.size() / 8);
}

TEST(Sectors, IntervalsWrapAround) {
  const double sector = 2.0 * M_PI / SF_SECTORS;
  const auto sectors_of = [&](double low, double high) {
    SectorLists lists;
    lists.add(0.5 * (low + high), 0.5 * (high - low), 7);
    lists.sort();
    std::set<std::uint32_t> touched;
    for (std::uint32_t s = 0; s < SF_SECTORS; ++s) {
      EXPECT_LE(lists.of(s).size(), 1u) << "twice";
      if (!lists.of(s).empty()) touched.insert(s);
    }
    return touched;
  };
  EXPECT_EQ(sectors_of(0.1 * sector, 0.9 * sector), (std::set<std::uint32_t>{0}));
  EXPECT_EQ(sectors_of(-0.1 * sector, 0.1 * sector), (std::set<std::uint32_t>{31, 0}));
  EXPECT_EQ(sectors_of(31.5 * sector, 33.5 * sector), (std::set<std::uint32_t>{31, 0, 1}));
  EXPECT_EQ(sectors_of(-40.5 * sector, -40.1 * sector), (std::set<std::uint32_t>{23}));
  EXPECT_EQ(sectors_of(0.5 * sector, 31.5 * sector).size(), 32u) << "all round";
  EXPECT_EQ(sectors_of(0.0, 100.0).size(), 32u);
}

TEST(Sectors, ItemsKeepTheirOrder) {
  SectorLists lists;
  for (const std::uint32_t item : {5u, 3u, 9u}) lists.add(0.1 * item, 4.0, item);
  lists.sort();
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s)
    EXPECT_TRUE(std::ranges::equal(lists.of(s), std::vector<std::uint32_t>{5, 3, 9})) << s;
  lists.clear();
  lists.sort();
  EXPECT_TRUE(lists.of(0).empty());
}

}  // namespace
}  // namespace sf::raycast
