#include "apps/commands/cloud_replay.h"

#include <algorithm>

#include "apps/reports/text.h"
#include "scenarios/run_info.h"
#include "sensors/lidar.h"

namespace sf::apps {

bool has_lidar(const RecordingPart& part, const world::World& world) {
  const auto is_lidar = [](const world::Sensor& sensor) { return sensor.type == sensors::lidar_type.name; };
  for (std::size_t m = 0; m < part.chosen.size(); ++m)
    if (part.chosen[m] != 0 && std::ranges::any_of(world.movers[m].sensors, is_lidar)) return true;
  return false;
}

CloudReplay::CloudReplay(const RecordingPart& part, const world::World& world)
    : part_(part),
      sensor_set_(world),
      lidars_(sensor_set_.settings_of<sensors::LidarSettings>(sensors::kLidar)),
      replay_(part.recording,
              scenarios::run_info(world, sensor_set_, {.seed = part.recording.info.seed, .record_readings = true})) {}

std::vector<Cloud> CloudReplay::at(std::size_t tick, bool newest) {
  const bool all = newest || tick == 0;
  const base::TickRecord record = replay_.tick(tick, all ? std::nullopt : std::optional(tick - 1));
  std::vector<Cloud> clouds;
  for (const base::ReadingBlock& reading : record.readings) {
    if (reading.type != sensors::kLidar || part_.chosen[reading.mover] == 0) continue;
    const sensors::SensorSpec& row = sensor_set_.row(reading);
    const sensors::LidarSettings& lidar =
        lidars_[static_cast<std::size_t>(&row - sensor_set_.group(reading.type)->rows.data())];
    clouds.push_back({reading.time, reading.mover, row, lidar, reading.values,
                      base::compose(base::transform_of(reading.X_WM, reading.tilt), lidar.X_MS)});
  }
  return clouds;
}

std::unique_ptr<CloudReplay> clouds_to_draw(const RecordingPart& part, const world::World& world) {
  if (!has_lidar(part, world)) return nullptr;
  if (!part.recording.readings.empty()) return std::make_unique<CloudReplay>(part, world);
  print_message("no clouds of lidars: the run was recorded without --record-readings");
  return nullptr;
}

viz::PolyData echoes_of(std::span<const Cloud> clouds) {
  viz::PolyData out;
  for (const char* name : {"range", "ring", "robot", "sensor", "time", "intensity"})
    out.point_data.push_back({name, 1, {}});
  for (const Cloud& cloud : clouds)
    for (std::size_t i = 0; i < cloud.beams(); ++i) {
      if (!cloud.has_echo(i)) continue;
      out.dots.push_back({static_cast<std::int64_t>(out.points.size())});
      out.points.push_back(cloud.point_W(i));
      const double values[] = {cloud.range(i),
                               static_cast<double>(cloud.ring(i)),
                               static_cast<double>(cloud.mover),
                               static_cast<double>(cloud.row.sensor),
                               1e-9 * static_cast<double>(cloud.time),
                               cloud.has_intensity() ? cloud.intensity(i) : 0.0};
      for (std::size_t k = 0; k < std::size(values); ++k) out.point_data[k].values.push_back(values[k]);
    }
  return out;
}

}  // namespace sf::apps
