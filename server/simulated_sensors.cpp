#include "server/simulated_sensors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/pose.h"

namespace sf::server {

SimulatedSensors::Schedule::Schedule(const sensors::SensorSet& sensor_set, std::uint8_t type, std::uint32_t mover) {
  const sensors::SensorSpec& row = sensor_set.of(type, mover)[0];
  period = std::llround(1e9 / row.rate);
  latency = std::llround(1e9 * row.latency);
  X_MS = row.X_MS;
}

bool SimulatedSensors::Schedule::is_due(std::int64_t now) {
  if (now < next) return false;
  next = std::max(next + period, now - period);
  ++sequence;
  return true;
}

SimulatedSensors::SimulatedSensors(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
                                   const control::PositionSensors& sensors, std::uint64_t seed) {
  if (sensors.wheels) wheels_.emplace(*sensors.wheels, base::RandomKey{seed, base::RandomStream::slip, mover}, true);
  if (sensors.gyro)
    gyro_ = {Schedule(sensor_set, sensors::kGyro, mover),
             sensors::GyroModel(*sensors.gyro, {seed, base::RandomStream::gyro, mover}, true)};
  if (sensors.gps)
    gps_ = {Schedule(sensor_set, sensors::kGps, mover),
            {sensors.gps->noise, sensors::constellation(sensors.gps->satellites)},
            sensors::GnssVisibility(world),
            {seed, base::RandomStream::satellites, mover}};
}

void SimulatedSensors::measure(const base::Pose& before, const base::Report& after, std::int64_t now, OwnState& own) {
  if (wheels_) {
    const std::int64_t since = std::exchange(measured_, now);
    const double seconds = since < 0 ? 0.0 : 1e-9 * static_cast<double>(now - since);
    if (after.wheels.are_known())
      wheels_->add({seconds * after.wheels.left, seconds * after.wheels.right});
    else
      wheels_->roll(before, after.X_WM);
    own.add_wheels(now, wheels_->counted());
  }
  if (gyro_ && gyro_->schedule.is_due(now))
    own.add_gyro(now, gyro_->model.measure(after.velocity.turn, gyro_->schedule.sequence));
  if (gps_) measure_gps(after.X_WM, now, own);
}

void SimulatedSensors::measure_gps(const base::Pose& X_WM, std::int64_t now, OwnState& own) {
  Schedule& schedule = gps_->schedule;
  if (schedule.is_due(now)) {
    const base::Pose X_WS = base::compose(X_WM, schedule.X_MS);
    gps_->draw.c = schedule.sequence;
    fixes_.push_back({now, gps_->model.measure(gps_->visibility, gps_->draw, X_WS)});
  }
  for (; !fixes_.empty() && fixes_.front().time + schedule.latency <= now; fixes_.pop_front()) {
    const auto& [x, y, hdop, satellites, z, vdop] = fixes_.front().values;
    own.add_gps(fixes_.front().time, {x, y}, hdop, {schedule.X_MS.x, schedule.X_MS.y});
  }
}

}  // namespace sf::server
