#include "server/own_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "maps/map_packets.h"
#include "netio/address_token.h"
#include "netio/own_end.h"
#include "netio/packets.h"
#include "sensors/laser.h"
#include "sensors/occupancy_packets.h"

namespace sf::server {

namespace {

constexpr double kCell = 0.03;  // [m] as in the thesis

/// Returns a map of the whole world, aligned with the lattice shared by all maps of this cell size.
world::Sensor whole_world(const world::Extent& extent, double range) {
  const auto words = [](double low, double high, double cell) {
    return std::ceil(std::ceil(high / cell) / 4.0 - std::floor(low / cell) / 4.0);
  };
  double cell = kCell, columns = 0.0, rows = 0.0;
  for (;; cell *= 2.0) {
    columns = std::max(words(extent.x_min, extent.x_max, cell), 1.0);
    rows = std::max(words(extent.y_min, extent.y_max, cell), 1.0);
    const bool held = columns <= maps::kMaxWordColumns && rows <= maps::kMaxWordColumns &&
                      columns * rows <= maps::kMaxWords && range <= maps::kMaxRangeCells * cell;
    if (held || cell > 100.0) break;
  }
  world::Sensor sensor;
  sensor.type = "occupancy";
  sensor.name = "map";
  sensor.settings = {
      {"cell", {cell}, "", 0, ""},
      {"words", {columns, rows}, "", 0, ""},
      {"offset", {-cell * std::floor(extent.x_min / cell), -cell * std::ceil(extent.y_max / cell)}, "", 0, ""}};
  return sensor;
}

sensors::Occupancy settings_of(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover) {
  const auto maps = sensor_set.settings_of<sensors::Occupancy>(sensors::kOccupancy, mover);
  if (!maps.empty()) return maps.front();
  const std::span<const sensors::SensorSpec> lasers = sensor_set.of(sensors::kLaser, mover);
  if (lasers.empty())
    throw base::InputError("map: '" + world.movers[mover].name +
                           "' has no laser to build a map with; expected laser( ... ) in its definition");
  world::World with;
  with.movers = {world.movers[mover]};
  with.movers[0].sensors.push_back(whole_world(world.extent, lasers[0].limit));
  return sensors::occupancies_of(with).front();
}

}  // namespace

OwnMap::OwnMap(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
               const OwnMapOptions& options)
    : settings_(settings_of(world, sensor_set, mover)),
      X_ML_(settings_.sources.empty() ? sensor_set.of(sensors::kLaser, mover)[settings_.laser].X_MS : base::Pose{}),
      options_(options),
      robot_(static_cast<std::uint16_t>(world.movers[mover].id)),
      session_(netio::random_session()),
      map_({&settings_.settings, 1}, thread_pool_),
      words_(settings_.row.elements) {
  if (!settings_.sources.empty()) {
    for (const sensors::RangeSensor& source : settings_.sources)
      if (source.mover != mover)
        throw base::InputError(
            fmt::format("map: '{}' of '{}' has sources of other robots, whose readings it does not "
                        "receive; expected its own sensors",
                        settings_.row.name, world.movers[mover].name));
    source_maps_.emplace(world, std::span(&settings_, 1), thread_pool_);
  }
  if (!options.receiver) return;
  outbox_.emplace(netio::OutboxOptions{.bind = netio::own_end_for(options.receiver->address)});
  const std::string problem = sensors::occupancy_wire_problem(settings_.row, options.wire);
  if (!problem.empty()) throw base::InputError("--map: " + problem);
}

void OwnMap::add(const base::ReadingBlock& reading, const base::Pose& X_WM) {
  if (!(source_maps_ ? add_to_sources(reading, X_WM) : add_scan(reading, X_WM))) return;
  X_WM_ = X_WM;
  ++scans_;
}

bool OwnMap::add_scan(const base::ReadingBlock& reading, const base::Pose& X_WM) {
  if (reading.type != sensors::kLaser || reading.sensor != settings_.laser) return false;
  if ((last_scan_ && reading.time <= *last_scan_) || reading.values.size() != settings_.settings.samples) return false;
  last_scan_ = reading.time;
  const sensors::MapScan scan{0, base::compose(X_WM, X_ML_), reading.values};
  map_.update({&scan, 1});
  return true;
}

bool OwnMap::add_to_sources(const base::ReadingBlock& reading, const base::Pose& X_WM) {
  const sensors::RangeSensor source{reading.type, settings_.row.mover, reading.sensor};
  if (!std::ranges::binary_search(settings_.sources, source)) return false;
  const auto [last, is_first] = last_times_.try_emplace(source, reading.time);
  if (!is_first && reading.time <= std::exchange(last->second, std::max(last->second, reading.time))) return false;
  base::ReadingBlock placed = reading;
  placed.mover = source.mover, placed.X_WM = X_WM;
  source_maps_->observe({&placed, 1});
  return true;
}

void OwnMap::send(std::int64_t now, bool true_poses) {
  if (now < next_ || scans_ == 0) return;
  next_ = now + std::llround(1e9 / settings_.row.rate);
  if (outbox_) send_parts(now, true_poses);
  if (options_.show) options_.show(grid(), X_WM_);
  ++sequence_;
}

maps::OccupancyGrid OwnMap::grid() const {
  const std::span<const std::uint32_t> words = map_words();
  maps::OccupancyGrid grid(settings_.settings.grid);
  std::copy(words.begin(), words.end(), grid.words.begin());
  return grid;
}

void OwnMap::send_parts(std::int64_t now, bool true_poses) {
  const std::span<const std::uint32_t> words = map_words();
  std::copy(words.begin(), words.end(), words_.begin());

  const maps::GridGeometry& grid = settings_.settings.grid;
  const base::ReadingBlock reading{.type = sensors::kOccupancy,
                                   .time = now,
                                   .X_WS = {grid.left, grid.top, 0.0, 0.0},
                                   .values = words_,
                                   .flags = true_poses ? maps::kTruePoses : 0u};
  const netio::Header header{.robot = robot_, .sequence = sequence_, .time = now, .session = session_};
  for (std::uint32_t part = 0; part < sensors::occupancy_parts(settings_.row, options_.wire); ++part) {
    payload_.clear();
    const std::uint8_t type = sensors::encode_occupancy(settings_.row, reading, options_.wire, part, payload_);
    if (options_.wire == sensors::WireFormat::farm) netio::encode_reading(header, type, payload_, packet_);
    outbox_->queue(*options_.receiver, options_.wire == sensors::WireFormat::farm ? packet_ : payload_);
  }
  outbox_->flush();
}

OwnMapCounts OwnMap::counts() const { return {scans_, sequence_, outbox_ ? outbox_->counts() : netio::OutboxCounts{}}; }

}  // namespace sf::server
