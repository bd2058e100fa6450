// Maps on the device and on the host equal the update rule cell by cell, for any scan.

#include "sensors/occupancy_batch.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/device.h"
#include "tests/sensors/map_scans.h"

namespace sf::trial {
namespace {

sensors::MapSettings map_of(double fov, std::uint32_t samples, double range_max, double cell = 0.03,
                            glm::dvec2 corner = {0.0, 0.0}) {
  sensors::MapSettings p;
  p.grid = {corner.x, corner.y, cell, 30, 30};
  p.fov = fov;
  p.samples = samples;
  p.range_max = range_max;
  return p;
}

struct CellTally {
  std::size_t scans = 0;
  std::size_t cells = 0;      ///< compared
  std::size_t occupied = 0;   ///< occupied cells among these
  std::size_t free = 0;       ///< free cells among these
  std::size_t different = 0;  ///< words that differ
};

/// Adds `rounds` scans to every map, or each time to `some` of them, in both orders. Compares all maps after every
/// `every`-th scan.
CellTally contest(const std::vector<sensors::MapSettings>& map_settings, std::size_t rounds, std::size_t every,
                  std::uint64_t seed, bool some = false) {
  base::ThreadPool thread_pool;
  sensors::MapBatch batch(device(), thread_pool, map_settings, false), host(device(), thread_pool, map_settings, true);
  PlainMaps plain(map_settings);
  Chance chance(seed);
  std::vector<std::uint32_t> wanted;
  for (std::uint32_t i = 0; i < map_settings.size(); ++i) wanted.push_back(i);
  CellTally tally;
  for (std::size_t round = 1; round <= rounds; ++round) {
    std::vector<std::vector<double>> ranges;
    std::vector<sensors::MapScan> scans;
    for (const sensors::MapSettings& p : map_settings) ranges.push_back(odd_ranges(chance, p));
    for (std::uint32_t i = 0; i < map_settings.size(); ++i)
      scans.push_back({i, odd_pose(chance, map_settings[i]), ranges[i]});
    if (some) {
      std::erase_if(scans, [&](const sensors::MapScan&) { return chance.below(4) != 0; });
      if (round % 2 == 0) std::reverse(scans.begin(), scans.end());
    }
    batch.update(scans, wanted);
    host.update(scans, wanted);
    for (const sensors::MapScan& scan : scans) plain.update(scan);
    tally.scans += scans.size();
    if (round % every != 0) continue;
    for (std::uint32_t i = 0; i < map_settings.size(); ++i) {
      const auto right = plain.words(i);
      for (std::size_t w = 0; w < right.size(); ++w) {
        tally.different += (right[w] != batch.words(i)[w]) + (right[w] != host.words(i)[w]);
        for (unsigned k = 0; k < 32; k += 2) {
          ++tally.cells;
          tally.occupied += (right[w] >> k & 3u) == SF_CELL_OCCUPIED;
          tally.free += (right[w] >> k & 3u) == SF_CELL_FREE;
        }
      }
    }
  }
  return tally;
}

/// Returns many maps of equal settings, here and 100 km away.
std::vector<sensors::MapSettings> spread(const sensors::MapSettings& common, std::size_t count) {
  std::vector<sensors::MapSettings> map_settings;
  Chance chance(count);
  for (std::size_t i = 0; i < count; ++i) {
    sensors::MapSettings p = common;
    const double far = i % 3 == 2 ? 1e5 : 1.0;
    p.grid.left = chance.between(-far, far);
    p.grid.top = chance.between(-far, far);
    map_settings.push_back(p);
  }
  return map_settings;
}

TEST(OccupancyBatch, MatchesTheRuleForTheThesisLaser) {
  const CellTally tally = contest(spread(map_of(M_PI, 361, 0.75), 50), 40, 5, 1);
  EXPECT_EQ(tally.different, 0u);
  EXPECT_EQ(tally.scans, 2'000u);
  EXPECT_GT(tally.occupied, 20'000u) << "the scans hit something";
  EXPECT_GT(tally.free, 200'000u);
  RecordProperty("cells", static_cast<int>(tally.cells));
}

TEST(OccupancyBatch, MatchesTheRuleForOtherLasers) {
  const std::vector<sensors::MapSettings> cases{
      map_of(2.0 * M_PI, 720, 2.0),         // full turn: candidates wrap at the rear
      map_of(2.0 * M_PI, 7, 3.0),           // few beams, far apart
      map_of(1.9 * M_PI, 100, 1.5),         // a gap at the rear
      map_of(M_PI / 6, 61, 4.0),            // longer than the map
      map_of(0.0, 1, 3.0),                  // one beam
      map_of(0.0, 5, 3.0),                  // five parallel beams
      map_of(1e-9, 9, 3.0),                 // nearly parallel
      map_of(M_PI, 181, 8.0, 0.5),          // coarse cells
      map_of(1.5 * M_PI, 2000, 30.0, 0.1),  // dense and far, beyond the map
      map_of(M_PI, 361, 0.02),              // within one cell
  };
  std::uint64_t seed = 10;
  for (const sensors::MapSettings& settings : cases) {
    const CellTally tally = contest(spread(settings, 12), 12, 4, ++seed);
    EXPECT_EQ(tally.different, 0u) << "fov " << settings.fov << ", " << settings.samples << " beams, "
                                   << settings.range_max << " m";
    EXPECT_GT(tally.free + tally.occupied, 0u);
  }
}

TEST(OccupancyBatch, MatchesTheRuleForLasersWithAMinimumRange) {
  sensors::MapSettings settings = map_of(M_PI, 181, 1.5);
  settings.range_min = 0.2;
  EXPECT_EQ(contest(spread(settings, 20), 10, 2, 30).different, 0u);
}

TEST(OccupancyBatch, LogOddsMatchAmongPlainMaps) {
  std::vector<sensors::MapSettings> map_settings = spread(map_of(M_PI, 181, 1.2), 24);
  for (std::size_t i = 0; i < map_settings.size(); i += 2) map_settings[i].odds = maps::LogOddsUpdate{};
  map_settings[0].odds = maps::LogOddsUpdate{32767, 32767, 32767};  // the largest
  map_settings[2].odds = maps::LogOddsUpdate{1, 1, 1};              // the smallest
  map_settings[4].odds = maps::LogOddsUpdate{0, 3, 20};             // never occupied
  const CellTally tally = contest(map_settings, 25, 1, 40);
  EXPECT_EQ(tally.different, 0u);
  EXPECT_GT(tally.occupied, 1'000u);
}

TEST(OccupancyBatch, MatchesTheRuleAtTheFarthestEnds) {
  // 1022 cells: the longest lines, with the smallest differences between cells.
  sensors::MapSettings settings = map_of(2.0 * M_PI, 97, 1'022 * 0.01, 0.01);
  settings.grid.word_columns = settings.grid.word_rows = 300;
  EXPECT_EQ(contest(spread(settings, 4), 8, 2, 50).different, 0u);
}

TEST(OccupancyBatch, MatchesTheRuleForMapsOfDifferentShapes) {
  std::vector<sensors::MapSettings> map_settings;
  Chance chance(60);
  for (int i = 0; i < 30; ++i) {
    sensors::MapSettings p = map_of(chance.between(0.1, 6.2), 1 + chance.below(400), chance.between(0.1, 3.0),
                                    chance.between(0.01, 0.3), chance.in_square(50.0));
    p.grid.word_columns = 1 + chance.below(40);
    p.grid.word_rows = 1 + chance.below(40);
    map_settings.push_back(p);
  }
  EXPECT_EQ(contest(map_settings, 10, 1, 61).different, 0u);
}

TEST(OccupancyBatch, UpdatesAFewMapsAtATimeInAnyOrder) {
  std::vector<sensors::MapSettings> map_settings = spread(map_of(M_PI, 61, 1.5), 12);
  for (std::size_t i = 0; i < map_settings.size(); ++i)
    map_settings[i].samples = 30 + 7 * static_cast<std::uint32_t>(i);
  const CellTally tally = contest(map_settings, 40, 1, 70, true);
  EXPECT_EQ(tally.different, 0u);
  EXPECT_GT(tally.scans, 60u);
  EXPECT_LT(tally.scans, 200u) << "most are unchanged";
  EXPECT_GT(tally.occupied, 1'000u);
}

TEST(OccupancyBatch, EmptyScansChangeNothing) {
  base::ThreadPool thread_pool(2);
  sensors::MapBatch batch(device(), thread_pool, {map_of(M_PI, 3, 1.0), map_of(M_PI, 3, 1.0)}, false);
  const double nan = std::nan("");
  const std::vector<double> invalid{nan, -1.0, nan};
  const std::vector<double> valid{1.0, 0.5, 1.0};
  const std::uint32_t all[] = {0, 1};
  const sensors::MapScan scans[] = {{0, {1.8, -1.8, 0, 0}, invalid},  // no valid range
                                    {1, {1e9, 1e300, 0, 0}, valid}};  // far outside
  batch.update(scans, all);
  for (const std::uint32_t map : all)
    for (const std::uint32_t word : batch.words(map)) ASSERT_EQ(word, 0u);
  const sensors::MapScan unplaced[] = {{1, {nan, 0, 0, 0}, valid}};
  batch.update(unplaced, all);
  for (const std::uint32_t word : batch.words(1)) ASSERT_EQ(word, 0u);
}

TEST(OccupancyBatch, DrawsOneScanCellByCell) {
  // Cells of 1 m, with the sensor at the centre of cell (10, 10). The beam ahead hits at 3 m. The beams to both sides
  // have no return within 4 m.
  sensors::MapSettings p = map_of(M_PI, 3, 4.0, 1.0, {0.0, 40.0});
  p.grid.word_columns = p.grid.word_rows = 10;
  base::ThreadPool thread_pool(1);
  sensors::MapBatch batch(device(), thread_pool, {p}, false);
  const std::vector<double> ranges{4.0, 3.0, 4.0};
  const std::uint32_t all[] = {0};
  const sensors::MapScan scans[] = {{0, {10.5, 29.5, 0, 0}, ranges}};
  batch.update(scans, all);
  maps::OccupancyGrid grid(p.grid);
  grid.words.assign(batch.words(0).begin(), batch.words(0).end());
  for (std::int64_t row = 0; row < 40; ++row)
    for (std::int64_t column = 0; column < 40; ++column) {
      const bool ahead = row == 10 && column >= 10 && column < 13;
      const bool sideways = column == 10 && row >= 6 && row <= 14;
      const maps::Cell expected = row == 10 && column == 13 ? maps::Cell::occupied
                                  : ahead || sideways       ? maps::Cell::free
                                                            : maps::Cell::unexplored;
      ASSERT_EQ(grid.at({column, row}), expected) << column << " " << row;
    }
}

/// One word of a map fills its tables completely, and each of its cells is hit in turn.
TEST(OccupancyBatch, EveryCellOfTheSmallestMapCanBeHit) {
  sensors::MapSettings p = map_of(0.0, 1, 4.0, 1.0, {0.0, 4.0});
  p.grid.word_columns = p.grid.word_rows = 1;
  base::ThreadPool thread_pool(1);
  sensors::MapBatch batch(device(), thread_pool, {p}, false);
  const std::vector<double> none{0.0};  // the sensor's own cell
  const std::uint32_t all[] = {0};
  maps::OccupancyGrid expected(p.grid);
  for (std::int64_t row = 0; row < 4; ++row)
    for (std::int64_t column = 0; column < 4; ++column) {
      const sensors::MapScan scans[] = {
          {0, {0.5 + static_cast<double>(column), 3.5 - static_cast<double>(row), 0, 0}, none}};
      batch.update(scans, all);
      expected.set({column, row}, maps::Cell::occupied);
      ASSERT_EQ(batch.words(0)[0], expected.words[0]) << column << " " << row;
    }
}

}  // namespace
}  // namespace sf::trial
