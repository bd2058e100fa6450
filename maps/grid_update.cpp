#include "maps/grid_update.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "maps/scan_raster.h"

namespace sf::maps {

namespace {

ScanRaster& raster() {
  thread_local ScanRaster own;
  return own;
}

/// Packs the states of sixteen cells, one byte each, into a word of a map.
std::uint32_t word_of(const std::uint8_t* states) {
  static_assert(std::endian::native == std::endian::little);
  std::uint32_t word = 0;
  for (int half = 0; half < 2; ++half) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, states + 8 * half, sizeof bits);
    bits = (bits | bits >> 6) & 0x000F'000F'000F'000Fu;
    bits = (bits | bits >> 12) & 0x0000'00FF'0000'00FFu;
    bits = (bits | bits >> 24) & 0xFFFFu;
    word |= static_cast<std::uint32_t>(bits) << 16 * half;
  }
  return word;
}

/// Updates the log odds of a word's cells. @return their states
std::uint32_t weigh(const LogOddsUpdate& rule, const std::uint8_t* covered, std::int16_t* odds) {
  std::uint8_t states[16];
  for (int i = 0; i < 16; ++i) {
    const std::int32_t more = covered[i] == SF_CELL_OCCUPIED ? rule.hit : covered[i] == SF_CELL_FREE ? -rule.miss : 0;
    const std::int32_t sum = std::clamp(odds[i] + more, -rule.limit, rule.limit);
    odds[i] = static_cast<std::int16_t>(sum);
    states[i] = state_of(sum);
  }
  return word_of(states);
}

}  // namespace

void add_traced_scan(OccupancyGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends) {
  raster().add(grid.geometry, scan, ends, [&](std::size_t at, const std::uint8_t* covered) {
    const std::uint32_t states = word_of(covered), low = (states | states >> 1) & 0x5555'5555u;
    grid.words[at] = (grid.words[at] & ~(low | low << 1)) | states;
  });
}

void add_traced_scan(LogOddsGrid& grid, const TracedScan& scan, std::span<const std::uint32_t> ends) {
  raster().add(grid.geometry, scan, ends, [&](std::size_t at, const std::uint8_t* covered) {
    grid.words[at] = weigh(grid.rule, covered, &grid.cells[16 * at]);
  });
}

void add_scan(OccupancyGrid& grid, const ScanView& scan) {
  std::vector<std::uint32_t> ends(scan.ranges.size());
  add_traced_scan(grid, trace_scan(grid.geometry, scan, ends), ends);
}

void add_scan(LogOddsGrid& grid, const ScanView& scan) {
  std::vector<std::uint32_t> ends(scan.ranges.size());
  add_traced_scan(grid, trace_scan(grid.geometry, scan, ends), ends);
}

OccupancyGrid to_occupancy(const LogOddsGrid& grid) {
  OccupancyGrid states(grid.geometry);
  states.words = grid.words;
  return states;
}

}  // namespace sf::maps
