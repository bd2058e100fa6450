#include "sensors/occupancy_tables.h"

#include <algorithm>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "shaders/occupancy.comp.h"
#include "shaders/occupancy_odds.comp.h"
#include "shaders/occupancy_strips.comp.h"

namespace sf::sensors {

namespace {

using gpu::Role;
using gpu::Texel;

/// Number of blocks of a map's words, and of its strips, for a scan that covers the whole map.
std::size_t word_blocks(const maps::GridGeometry& geometry) {
  return std::size_t{units_of(geometry.word_columns, SF_MAP_BLOCK)} * geometry.word_rows;
}
std::size_t strip_blocks(const maps::GridGeometry& geometry) {
  const auto blocks = [](std::int64_t along, std::int64_t across) {
    return std::size_t{units_of(along, SF_MAP_BLOCK)} * units_of(across, SF_STRIP);
  };
  return blocks(maps::columns(geometry), maps::rows(geometry)) + blocks(maps::rows(geometry), maps::columns(geometry));
}

}  // namespace

MapBatch::Tables::Tables(gpu::Device& device, base::ThreadPool& w, std::vector<MapSettings> map_settings)
    : own_device(device), thread_pool(w), unified(device.unified()), batch(device) {
  lay_out(std::move(map_settings));
  assign_layout();
  rows = std::make_unique<gpu::Buffer>(device, "due maps", Role::upload, Texel::u32x4,
                                       gpu::texels_of<MapRow>(all.size() + 1));
  lines = std::make_unique<gpu::Buffer>(device, "lines of beams", Role::upload, Texel::f32x4, all_lines + 1);
  rows->host<MapRow>()[all.size()] = MapRow{};  // for lanes without work
  ends.resize(2 * all_lines);
  std::fill_n(lines->host<BeamLine>().data(), 2 * (all_lines + 1), BeamLine{});
  words = std::make_unique<gpu::Buffer>(device, "maps", Role::download, Texel::u32, all_words + 1);
  std::fill_n(words->host<std::uint32_t>().data(), all_words + 1, 0u);
  std::size_t most = 0;
  for (const MapLayout& map : all) most += strip_blocks(map.settings.grid);
  const std::size_t lanes = make_dispatch(device, "strips of a map", strips, occupancy_strips_comp_spv, most);
  covered = std::make_unique<gpu::Buffer>(device, "covered cells", Role::download, Texel::u32, lanes);
  make_words(device, "map", plain, occupancy_comp_spv, false);
  if (std::any_of(all.begin(), all.end(), [](const MapLayout& map) { return map.settings.odds.has_value(); })) {
    odds = std::make_unique<gpu::Buffer>(device, "log odds", Role::download, Texel::u32x4,
                                         SF_ODDS_TEXELS * (all_words + 1));
    std::fill_n(odds->host<std::uint32_t>().data(), 4 * SF_ODDS_TEXELS * (all_words + 1), 0u);
    make_words(device, "map with log odds", log_odds_words, occupancy_odds_comp_spv, true);
  }
  record();
}

void MapBatch::Tables::lay_out(std::vector<MapSettings> map_settings) {
  for (MapSettings& p : map_settings) {
    auto& fan = fans[{p.fov, p.samples}];
    if (fan.empty()) fan = maps::beam_directions(p.fov, p.samples);
    all.push_back({std::move(p), 0, 0, &fan});
  }
  scan_works.reserve(all.size());
}

void MapBatch::Tables::assign_layout() {
  for (MapLayout& map : all) {
    map.words = static_cast<std::uint32_t>(all_words);
    map.lines = static_cast<std::uint32_t>(all_lines);
    all_words += maps::words(map.settings.grid);
    all_lines += pairs_of(map.settings);
  }
}

/// @return number of lanes, in whole groups
std::size_t MapBatch::Tables::make_dispatch(gpu::Device& device, const char* name, MapDispatch& dispatch,
                                            std::span<const std::uint32_t> spirv, std::size_t most_blocks) {
  dispatch.kernel = std::make_unique<gpu::Kernel>(device, name, spirv);
  // Padded to whole groups, and to whole rows of groups if there are many.
  const std::size_t group = dispatch.kernel->group_size() / SF_MAP_BLOCK;
  const std::size_t padded = gpu::most_groups_for(most_blocks, group) * group;
  dispatch.blocks = std::make_unique<gpu::Buffer>(device, "blocks of work", Role::upload, Texel::u32, 2 * padded);
  dispatch.groups = std::make_unique<gpu::Buffer>(device, "group counts", Role::upload, Texel::u32, 4);
  return SF_MAP_BLOCK * padded;
}

void MapBatch::Tables::make_words(gpu::Device& device, const char* name, MapWords& part,
                                  std::span<const std::uint32_t> spirv, bool has_log_odds) {
  std::size_t most = 0;
  for (const MapLayout& map : all)
    if (map.settings.odds.has_value() == has_log_odds) most += word_blocks(map.settings.grid);
  const std::size_t lanes = make_dispatch(device, name, part.dispatch, spirv, most);
  part.hit_words = std::make_unique<gpu::Buffer>(device, "struck cells", Role::upload, Texel::u32, lanes);
}

void MapBatch::Tables::record() {
  strips.kernel->bind(
      {{"rows", rows.get()}, {"blocks", strips.blocks.get()}, {"lines", lines.get()}, {"strips", covered.get()}});
  batch.begin();
  batch.dispatch(*strips.kernel, *strips.groups, 0);
  batch.barrier();
  for (MapWords* part : {&plain, &log_odds_words}) {
    if (!part->dispatch.kernel) continue;
    std::vector<gpu::TableBinding> tables{{"rows", rows.get()},
                                          {"blocks", part->dispatch.blocks.get()},
                                          {"strips", covered.get()},
                                          {"hit_words", part->hit_words.get()},
                                          {"words", words.get()}};
    if (part == &log_odds_words) tables.push_back({"odds", odds.get()});
    part->dispatch.kernel->bind(tables);
    batch.dispatch(*part->dispatch.kernel, *part->dispatch.groups, 0);
  }
  batch.end();
}

}  // namespace sf::sensors
