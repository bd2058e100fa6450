#include <fmt/format.h>

#include "sensors/occupancy.h"

#include <map>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/marked_values.h"
#include "maps/map_packets.h"
#include "raycast/casters.h"
#include "sensors/laser.h"
#include "sensors/occupancy_batch.h"
#include "sensors/occupancy_packets.h"
#include "sensors/occupancy_sources.h"

namespace sf::sensors {

namespace {

class Occupancies : public SensorBackend {
 public:
  Occupancies(const SensorContext& context, const ParsedSensors& sensors);

  bool prepare(std::span<const DueSample> due) override {
    due_.assign(due.begin(), due.end());
    return false;
  }
  void record_measure(gpu::Batch&) override {}
  void add_copies(gpu::Batch&) override {}
  void observe(std::span<const base::ReadingBlock> readings) override;
  void collect(std::span<base::ReadingBlock> out) override;
  void take_over(SensorBackend& before, std::uint32_t rows) override {
    auto& last = dynamic_cast<Occupancies&>(before);
    if (last.batch_) batch_->take_over(*last.batch_, last.batch_rows_);
    source_maps_.take_over(last.source_maps_, rows);
  }
  void restart(std::uint32_t row, std::int64_t /*now*/) override {
    maps_[row].sources.empty() ? batch_->restart(in_batch_[row]) : source_maps_.restart(world_, row);
  }
  SensorStats stats() const override { return {}; }
  bool on_device() const override { return false; }  // it has its own batch

 private:
  std::span<const std::uint32_t> words_of(std::uint32_t row) const {
    return maps_[row].sources.empty() ? batch_->words(in_batch_[row]) : source_maps_.words(row);
  }

  const world::World& world_;
  const std::vector<Occupancy>& maps_;
  std::vector<std::uint32_t> in_batch_;  ///< per map without sources: its row in the batch
  std::uint32_t batch_rows_ = 0;
  std::optional<MapBatch> batch_;  ///< empty: all maps have sources
  SourceMaps source_maps_;
  std::uint32_t flags_;
  std::multimap<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> of_laser_;  ///< from (mover, laser) to its maps
  std::vector<DueSample> due_;
  std::vector<MapScan> scans_;
  std::vector<std::vector<double>> marked_;  ///< per map: ranges of a scan with flags
  std::vector<std::uint32_t> wanted_;
  std::vector<std::size_t> first_;  ///< per map: index of its first value
  std::vector<double> values_;      ///< of all maps
};

/// Follows the choice for rays, because a software device is slower at both.
bool on_host(const SensorContext& context) {
  return !raycast::choose_caster(context.device.info().software, context.scene.caster).on_device;
}

Occupancies::Occupancies(const SensorContext& context, const ParsedSensors& sensors)
    : world_(context.world),
      maps_(sensors.settings_as<Occupancy>()),
      source_maps_(context.world, maps_, context.thread_pool),
      flags_(context.true_poses ? maps::kTruePoses : 0) {
  std::vector<MapSettings> in_batch;
  std::size_t values = 0;
  for (std::uint32_t i = 0; i < maps_.size(); ++i) {
    in_batch_.push_back(static_cast<std::uint32_t>(in_batch.size()));
    if (maps_[i].sources.empty()) {
      of_laser_.emplace(std::pair{maps_[i].row.mover, maps_[i].laser}, i);
      in_batch.push_back(maps_[i].settings);
    }
    first_.push_back(values);
    values += maps_[i].row.elements;
  }
  batch_rows_ = static_cast<std::uint32_t>(in_batch.size());
  if (!in_batch.empty()) batch_.emplace(context.device, context.thread_pool, std::move(in_batch), on_host(context));
  values_.resize(values);
  marked_.resize(maps_.size());
  scans_.reserve(maps_.size());
  wanted_.reserve(maps_.size());
}

void Occupancies::observe(std::span<const base::ReadingBlock> readings) {
  scans_.clear();
  wanted_.clear();
  for (const base::ReadingBlock& r : readings) {
    if (r.type != kLaser) continue;
    const auto [first, last] = of_laser_.equal_range({r.mover, r.sensor});
    for (auto it = first; it != last; ++it)
      scans_.push_back({in_batch_[it->second], r.X_WS, base::marked_values(r, marked_[it->second])});
  }
  for (const DueSample& due : due_)
    if (maps_[due.row].sources.empty()) wanted_.push_back(in_batch_[due.row]);
  if (batch_) batch_->update(scans_, wanted_);
  source_maps_.observe(readings);
}

void Occupancies::collect(std::span<base::ReadingBlock> out) {
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const std::uint32_t row = due_[i].row;
    const Occupancy& map = maps_[row];
    const std::span<const std::uint32_t> words = words_of(row);
    const std::span<double> values = std::span(values_).subspan(first_[row], words.size());
    std::copy(words.begin(), words.end(), values.begin());
    base::ReadingBlock block;
    block.mover = map.row.mover;
    block.sensor = map.row.sensor;
    block.type = kOccupancy;
    block.X_WS = {map.settings.grid.left, map.settings.grid.top, 0.0, 0.0};
    block.values = values;
    block.flags = flags_;
    out[i] = block;
  }
}

ParsedSensors parse_occupancies(const world::World& world) {
  std::vector<Occupancy> maps = occupancies_of(world);
  std::vector<SensorSpec> rows;
  for (const Occupancy& map : maps) rows.push_back(map.row);
  return {std::move(rows), std::move(maps)};
}

constexpr std::string_view kKeys[] = {"cell", "words", "offset", "laser", "sources", "log_odds"};
constexpr Column kColumns[] = {{"word", 1, true}};

}  // namespace

constinit const SensorType occupancy_type{
    .id = kOccupancy,
    .name = "occupancy",
    .word = {"occupancy", kKeys},
    .base_port = 52000,
    .list = "words",
    .columns = kColumns,
    .derived_from = kLaser,
    .parse = parse_occupancies,
    .make = make_backend<Occupancies>,
    .wire_problem = occupancy_wire_problem,
    .parts = occupancy_parts,
    .encode = encode_occupancy,
    .decode = decode_occupancy,
    .read = read_occupancy,
};

}  // namespace sf::sensors
