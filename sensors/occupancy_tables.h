#pragma once
// Tables shared by the sources of sensors::MapBatch: layout of the maps, and the device's buffers.

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "maps/traced_scan.h"
#include "sensors/occupancy_batch.h"
#include "sensors/occupancy_records.h"

namespace sf::sensors {

/// Layout of one map in the tables.
struct MapLayout {
  MapSettings settings;
  std::uint32_t words = 0;                         ///< index of its first word
  std::uint32_t lines = 0;                         ///< index of its first pair of beams
  const std::vector<glm::dvec2>* beams = nullptr;  ///< shared by lasers with equal beams
};

/// One dispatch over blocks of eight lanes.
struct MapDispatch {
  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> blocks;
  std::unique_ptr<gpu::Buffer> groups;  ///< group counts
  std::size_t count = 0;                ///< blocks of this update, including padding
};

/// Words of the maps with one update rule: log odds or overwriting.
struct MapWords {
  MapDispatch dispatch;
  std::unique_ptr<gpu::Buffer> hit_words;  ///< one word per lane: cells in which beams ended
};

/// Work of one scan.
struct ScanWork {
  maps::TracedScan scan;
  maps::CellBox cells;          ///< cells of the map, in whole words
  std::size_t first_block = 0;  ///< index of its words' first block
};

/// Returns the number of units that hold `cells` cells, rounded up.
inline std::uint32_t units_of(std::int64_t cells, std::int64_t unit) {
  return static_cast<std::uint32_t>((cells + unit - 1) / unit);
}

inline std::uint32_t pairs_of(const MapSettings& settings) { return (settings.samples + 1) / 2; }

struct MapBatch::Tables {
  gpu::Device& own_device;
  base::ThreadPool& thread_pool;
  bool unified;
  std::vector<MapLayout> all;
  std::size_t all_words = 0, all_lines = 0;  ///< size of the tables on the device
  std::vector<MapScan> scans;                ///< scans of this update, on the device
  std::vector<std::uint32_t> wanted;         ///< maps wanted in this update, on the device
  std::map<std::pair<double, std::uint32_t>, std::vector<glm::dvec2>> fans;
  MapDispatch strips;
  MapWords plain;
  MapWords log_odds_words;
  std::unique_ptr<gpu::Buffer> rows;
  std::unique_ptr<gpu::Buffer> lines;
  std::vector<std::uint32_t> ends;       ///< ends of all maps: two per pair of lines
  std::unique_ptr<gpu::Buffer> covered;  ///< one word per strip
  std::unique_ptr<gpu::Buffer> words;
  std::unique_ptr<gpu::Buffer> odds;
  std::vector<ScanWork> scan_works;  ///< per scan
  gpu::Batch batch;
  bool blank = true;                     ///< maps are not yet on the device
  std::vector<std::uint32_t> restarted;  ///< maps that are unexplored here, and not yet on the device

  Tables(gpu::Device& device, base::ThreadPool& w, std::vector<MapSettings> map_settings);
  void update(std::span<const MapScan> some, std::span<const std::uint32_t> read);
  void restart(std::uint32_t map);
  void take_over(Tables& before);
  void lay_out(std::vector<MapSettings> map_settings);
  void assign_layout();
  std::size_t make_dispatch(gpu::Device& device, const char* name, MapDispatch& dispatch,
                            std::span<const std::uint32_t> spirv, std::size_t most_blocks);
  void make_words(gpu::Device& device, const char* name, MapWords& part, std::span<const std::uint32_t> spirv,
                  bool has_log_odds);
  void record();
  std::span<std::uint32_t> ends_of(const MapLayout& map) {
    return std::span(ends).subspan(2 * std::size_t{map.lines}, map.settings.samples);
  }
  void trace();
  void assign_blocks();
  void add_strips(std::uint32_t row, const maps::CellBox& cells, bool steep, StripTable& table);
  void add_words(MapWords& part, std::uint32_t row, ScanWork& share);
  void mark_hits();
  void close(MapDispatch& dispatch);
  void send_scans();
  void send();
};

}  // namespace sf::sensors
