#pragma once
// The farm's types as those of the public interface (sensorfarm/).

#include "sensorfarm/controller.h"
#include "sensorfarm/sensor.h"
#include "sensors/sensor_type.h"
#include "sensors/settings.h"

namespace sf::sensors {

inline sensorfarm::Pose public_pose(const base::Pose& X) { return {X.x, X.y, X.z, X.yaw}; }
inline sensorfarm::Twist public_twist(const base::Twist& twist) { return {twist.forward, twist.left, twist.turn}; }
sensorfarm::SensorInfo public_info(const SensorType& type, const SensorSpec& spec);
/// Returns a view of a reading, valid as long as its block's spans.
sensorfarm::Reading public_reading(const base::ReadingBlock& reading, const SensorType& type);

/// Reads the settings of a sensor for users' code.
class PublicSensorSettings final : public sensorfarm::SensorSettings {
 public:
  explicit PublicSensorSettings(const world::Sensor& sensor) : sensor_(sensor) {}
  double number(std::string_view key, double fallback, double least, double most) const override {
    return sensors::number(sensor_, key, fallback, least, most);
  }
  double length(std::string_view key, double fallback, double least, double most) const override {
    return sensors::length(sensor_, key, fallback, least, most);
  }
  double angle(std::string_view key, double fallback, double least, double most) const override {
    return sensors::angle(sensor_, key, fallback, least, most);
  }
  std::string text(std::string_view key, const std::string& fallback) const override {
    const world::Setting* const setting = find(sensor_, key);
    return setting == nullptr ? fallback : setting->text;
  }
  void refuse(std::string_view key, const std::string& message) const override {
    sensors::refuse(sensor_, key, message);
  }

 private:
  const world::Sensor& sensor_;
};

}  // namespace sf::sensors
