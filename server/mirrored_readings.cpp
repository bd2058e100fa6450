#include "server/mirrored_readings.h"

#include <cmath>

#include "maps/borders.h"
#include "netio/packets.h"
#include "sensors/laneedge_settings.h"
#include "sensors/occupancy.h"

namespace sf::server {

namespace {

std::vector<SensorStream> all_sensors(const sensors::SensorSet& sensor_set) {
  std::vector<SensorStream> sources;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows) sources.push_back({group.type, &row});
  return sources;
}

netio::ReceiverOptions receiver_options(const world::World& world, const std::vector<SensorStream>& sources) {
  netio::ReceiverOptions options;
  for (const SensorStream& source : sources)
    options.streams.push_back({{.robot = world.movers[source.row->mover].id, .sensor = source.row->sensor},
                               source.row->elements * sensors::element_width(*source.type, *source.row)});
  options.inspect = [&sources](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload) {
    return inspect_payload(sources[i], sensors::WireFormat::farm, header, payload);
  };
  options.read = [&sources](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload,
                            std::span<double> values) {
    decode_payload(sources[i], sensors::WireFormat::farm, header, payload, values);
  };
  return options;
}

}  // namespace

MirroredReadings::MirroredReadings(const world::World& world, const sensors::SensorSet& sensor_set)
    : sources_(all_sensors(sensor_set)), receiver_(receiver_options(world, sources_)) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const sensors::SensorSpec& row = *sources_[i].row;
    streams_[{sources_[i].type->id, static_cast<std::uint16_t>(world.movers[row.mover].id),
              static_cast<std::uint16_t>(row.sensor)}] = i;
    by_mover_[row.mover].push_back(i);
  }
  const auto stream_of = [&](std::uint8_t type, const sensors::SensorSpec& row) {
    return streams_.at(
        {type, static_cast<std::uint16_t>(world.movers[row.mover].id), static_cast<std::uint16_t>(row.sensor)});
  };
  for (const sensors::LaneEdge& edge : sensor_set.settings_of<sensors::LaneEdge>(sensors::kLaneEdge))
    perpendiculars_[stream_of(sensors::kLaneEdge, edge.row)] = edge.perpendicular;
  for (const sensors::Occupancy& map : sensor_set.settings_of<sensors::Occupancy>(sensors::kOccupancy))
    maps_.push_back({.stream = stream_of(sensors::kOccupancy, map.row), .grid = map.settings.grid});
}

void MirroredReadings::accept(std::span<const std::uint8_t> bytes, std::int64_t now) {
  netio::Header header;
  std::span<const std::uint8_t> payload;
  netio::decode_reading(bytes, {}, header, payload);  // only to identify the sensor
  const auto stream = streams_.find({netio::sensor_type_of(header.type), header.robot, header.sensor});
  if (stream == streams_.end())
    ++unknown_;
  else
    receiver_.accept(stream->second, bytes, now);
}

void MirroredReadings::add_lines(std::uint32_t mover, const base::Pose& X_WM, std::int64_t now,
                                 std::vector<SightLine>& lines) const {
  const auto streams = by_mover_.find(mover);
  if (streams == by_mover_.end()) return;
  for (const std::size_t i : streams->second) {
    const auto reading = receiver_.newest(i);
    if (!reading || now - reading->arrival > kFresh) continue;
    const base::Pose X_WS = base::compose(X_WM, sources_[i].row->X_MS);
    if (sources_[i].type->is_scan) add_scan(*sources_[i].row, X_WS, reading->values, lines);
    if (sources_[i].type->id == sensors::kLaneEdge) add_edge(i, X_WS, reading->values[0], lines);
  }
}

void MirroredReadings::add_maps(std::int64_t now, std::vector<SightLine>& lines) {
  for (Map& map : maps_) {
    const auto reading = receiver_.newest(map.stream);
    if (!reading) continue;
    const double period = 1e9 / sources_[map.stream].row->rate;  // [ns]
    if (static_cast<double>(now - reading->arrival - kFresh) > 3.0 * period) continue;
    if (map.sequence != reading->sequence || map.arrival != reading->arrival) draw(map, reading->values);
    map.sequence = reading->sequence;
    map.arrival = reading->arrival;
    lines.insert(lines.end(), map.lines.begin(), map.lines.end());
  }
}

void MirroredReadings::draw(Map& map, std::span<const double> words) {
  maps::OccupancyGrid grid(map.grid);
  for (std::size_t i = 0; i < grid.words.size(); ++i)
    if (std::isfinite(words[i])) grid.words[i] = static_cast<std::uint32_t>(words[i]);
  const maps::MapBorders borders = maps::borders_of(grid, kMostBorders);
  map.lines.clear();
  for (const auto& [a, b] : borders.explored) map.lines.push_back({SightLine::Kind::explored, {a, b}});
  for (const auto& [a, b] : borders.occupied) map.lines.push_back({SightLine::Kind::occupied, {a, b}});
}

void MirroredReadings::add_scan(const sensors::SensorSpec& laser, const base::Pose& X_WS,
                                std::span<const double> ranges, std::vector<SightLine>& lines) const {
  const std::uint32_t every = (laser.elements + kMostBeams - 1) / kMostBeams;
  const double step = laser.fov / std::max(1u, laser.elements - 1);  // [rad]
  SightLine echoes{SightLine::Kind::echoes, {}, X_WS.z};
  const auto end_echoes = [&] {
    if (echoes.points.size() > 1) lines.push_back(echoes);
    echoes.points.clear();
  };
  for (std::uint32_t i = 0; i < laser.elements; ++i) {
    const bool too_near = laser.range_min > 0.0 && ranges[i] <= laser.range_min;  // position unknown
    const bool returned = !too_near && ranges[i] < laser.limit;
    const double range = std::min(ranges[i], laser.limit);
    const glm::dvec2 end = base::transform(X_WS, base::rotate(sensors::bearing_of(laser, i), {range, 0.0}));
    if (i % every == 0) lines.push_back({SightLine::Kind::beam, {{X_WS.x, X_WS.y}, end}, X_WS.z});
    // A step in range that no surface at up to 80 degrees explains is an edge.
    const double before = i > 0 ? std::min(ranges[i - 1], laser.limit) : range;
    const double most = 0.05 + 5.7 * step * std::min(range, before);
    if (!returned || std::abs(range - before) > most) end_echoes();
    if (returned) echoes.points.push_back(end);
  }
  end_echoes();
}

/// NaN: no edge in range.
void MirroredReadings::add_edge(std::size_t stream, const base::Pose& X_WS, double distance,
                                std::vector<SightLine>& lines) const {
  constexpr double kHalf = 0.15;  // [m]
  if (!std::isfinite(distance)) return;
  const glm::dvec2 ahead = perpendiculars_.at(stream);
  const glm::dvec2 along{-ahead.y, ahead.x};
  const auto at = [&](glm::dvec2 p_S) { return base::transform(X_WS, p_S); };
  lines.push_back({SightLine::Kind::beam, {at({0.0, 0.0}), at(distance * ahead)}, X_WS.z});
  lines.push_back({SightLine::Kind::lane_edge,
                   {at(distance * ahead - kHalf * along), at(distance * ahead + kHalf * along)},
                   X_WS.z});
}

}  // namespace sf::server
