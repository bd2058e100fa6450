#include "scenarios/standard_topics.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/elementary.h"
#include "base/tilted_pose.h"
#include "sensors/camera.h"
#include "sensors/compass.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/imu.h"
#include "sensors/infrared.h"
#include "sensors/lidar.h"
#include "sensors/lidar_beams.h"
#include "sensors/magnetometer.h"
#include "sensors/occupancy.h"
#include "sensors/radar.h"
#include "sensors/sonar.h"

namespace sf::scenarios {

namespace {

using record::StandardTopic;
using Message = StandardTopic::Message;

/// Returns the mover's sensor number `sensor` of a type.
record::SensorInfo& find(record::RunInfo& info, std::uint32_t mover, std::uint8_t type, std::uint32_t sensor) {
  auto& sensors = info.movers[mover].sensors;
  return *std::find_if(sensors.begin(), sensors.end(),
                       [&](const record::SensorInfo& s) { return s.type == type && sensor-- == 0; });
}

void add_ranges(std::span<const sensors::ConeArray> arrays, std::uint8_t type, record::RunInfo& info) {
  for (const sensors::ConeArray& array : arrays) {
    auto& topics = find(info, array.row.mover, type, array.row.sensor).standard;
    for (std::uint32_t i = 0; i < array.X_SC.size(); ++i)
      topics.push_back({.message = Message::range,
                        .element = i,
                        .X_SE = array.X_SC[i],
                        .infrared = type == sensors::kInfrared,
                        .fov = array.fov,
                        .range_min = array.range_min,
                        .range_max = array.range_max});
  }
}

/// Calls `body` with each sensor of a type and its settings.
template <class Settings, class Body>
void for_each_sensor(const sensors::SensorSet& sensor_set, std::uint8_t type, Body&& body) {
  const auto settings = sensor_set.settings_of<Settings>(type);
  for (std::size_t i = 0; i < settings.size(); ++i) body(sensor_set.group(type)->rows[i], settings[i]);
}

/// Directions of the beams of lidars in the frames of their clouds, which have the lidar's position and heading but are
/// level. Lidars with equal beams and mounts share them.
class CloudDirections {
 public:
  std::shared_ptr<const std::vector<glm::dvec3>> of(const sensors::SensorSpec& row,
                                                    const sensors::LidarSettings& lidar) {
    const glm::dmat3 R_LS = glm::transpose(base::transform_of(row.X_MS).R) * lidar.X_MS.R;
    const auto known = std::ranges::find_if(
        known_, [&](const Known& each) { return each.beams == lidar.beams.get() && each.R_LS == R_LS; });
    if (known != known_.end()) return known->directions;
    auto directions = std::make_shared<std::vector<glm::dvec3>>();
    for (const glm::dvec3& d : lidar.beams->directions) directions->push_back(R_LS * d);
    known_.push_back({lidar.beams.get(), R_LS, std::move(directions)});
    return known_.back().directions;
  }

 private:
  struct Known {
    const sensors::LidarBeams* beams = nullptr;
    glm::dmat3 R_LS;
    std::shared_ptr<const std::vector<glm::dvec3>> directions;
  };
  std::vector<Known> known_;
};

/// Frame of a camera's images in the sensor's level frame: z along the optical axis, x to the right (REP 103).
base::TiltedPose optical_frame(const sensors::SensorSpec& row, const sensors::CameraSettings& camera) {
  const glm::dmat3 R_SO({0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0});
  return base::tilted_pose_of({glm::transpose(base::transform_of(row.X_MS).R) * camera.X_MS.R * R_SO, {}});
}

std::vector<Message> image_messages(record::ImageMessages images, bool rgb) {
  std::vector<Message> messages{Message::camera_info};
  if (images.raw) messages.push_back(Message::depth_image);
  if (images.raw && rgb) messages.push_back(Message::color_image);
  if (images.compressed) messages.push_back(Message::depth_png);
  if (images.compressed && rgb) messages.push_back(Message::color_file);
  return messages;
}

/// Quality of a camera's JPEG files; 0: PNG.
int jpeg_of(const sensors::CameraSettings& camera, record::ImageMessages::Files files) {
  using Files = record::ImageMessages::Files;
  if (files == Files::jpeg) return camera.jpeg_quality();
  return files == Files::png ? 0 : camera.jpeg;
}

}  // namespace

void add_standard_topics(const sensors::SensorSet& sensor_set, record::ImageMessages images, record::RunInfo& info) {
  for (const std::uint8_t type : {sensors::kSonar, sensors::kInfrared})
    add_ranges(sensor_set.settings_of<sensors::ConeArray>(type), type, info);
  const auto add = [&](const sensors::SensorSpec& row, std::uint8_t type, StandardTopic topic) {
    find(info, row.mover, type, row.sensor).standard.push_back(std::move(topic));
  };
  using sensors::Encoder, sensors::Gps, sensors::Gyro, sensors::Magnetometer, sensors::Occupancy;
  for_each_sensor<Magnetometer>(sensor_set, sensors::kMagnetometer, [&](const auto& row, const Magnetometer& m) {
    for (std::uint32_t i = 0; i < m.X_SE.size(); ++i)
      add(row, sensors::kMagnetometer, {.message = Message::magnetic_field, .element = i, .X_SE = m.X_SE[i]});
  });
  // A robot's odometry is computed from its first encoders.
  for_each_sensor<Encoder>(sensor_set, sensors::kEncoder, [&](const auto& row, const Encoder& e) {
    if (row.sensor == 0) info.movers[row.mover].encoder = {sensors::kEncoder, e.per_count, e.slip, e.track};
  });
  for_each_sensor<Occupancy>(sensor_set, sensors::kOccupancy, [&](const auto& row, const Occupancy& map) {
    add(row, sensors::kOccupancy, {.message = Message::map, .grid = map.settings.grid});
  });
  CloudDirections clouds;
  for_each_sensor<sensors::LidarSettings>(sensor_set, sensors::kLidar, [&](const auto& row, const auto& lidar) {
    add(row, sensors::kLidar,
        {.message = Message::points,
         .range_min = lidar.echo.range_min,
         .range_max = lidar.echo.range_max,
         .directions = clouds.of(row, lidar),
         .rings = lidar.beams->channels,
         .width = lidar.echo.width,
         .times = lidar.beams->times.empty()
                      ? nullptr
                      : std::shared_ptr<const std::vector<double>>(lidar.beams, &lidar.beams->times)});
  });
  for_each_sensor<sensors::CameraSettings>(sensor_set, sensors::kCamera, [&](const auto& row, const auto& camera) {
    const base::TiltedPose X_SO = optical_frame(row, camera);
    StandardTopic topic{.X_SE = X_SO.X,
                        .tilt = X_SO.tilt,
                        .range_min = camera.range_min,
                        .range_max = camera.range_max,
                        .width = camera.columns(),
                        .columns = camera.width,
                        .rows = camera.height,
                        .lens = camera.lens,
                        .mono = camera.mono,
                        .jpeg = jpeg_of(camera, images.files)};
    for (const Message message : image_messages(images, camera.rgb)) {
      topic.message = message;
      add(row, sensors::kCamera, topic);
    }
  });
  for_each_sensor<sensors::RadarSettings>(sensor_set, sensors::kRadar, [&](const auto& row, const auto& radar) {
    add(row, sensors::kRadar,
        {.message = Message::radar_scan,
         .spatial = true,
         .R_FS = glm::transpose(base::transform_of(row.X_MS).R) * radar.X_MS.R});
  });
  for_each_sensor<Gps>(sensor_set, sensors::kGps, [&](const auto& row, const Gps& gps) {
    add(row, sensors::kGps, {.message = Message::fix, .spatial = gps.altitude, .sigma = gps.noise});
  });
  for_each_sensor<Gyro>(sensor_set, sensors::kGyro, [&](const auto& row, const Gyro& gyro) {
    add(row, sensors::kGyro, {.message = Message::imu, .sigma = base::hypot(gyro.noise, gyro.bias)});
  });
  for_each_sensor<sensors::Compass>(sensor_set, sensors::kCompass, [&](const auto& row, const auto& compass) {
    const sensors::TriadErrors& errors = compass.instrument.errors;
    add(row, sensors::kCompass,
        {.message = Message::magnetic_field,
         .spatial = true,
         .R_FS = glm::transpose(base::transform_of(row.X_MS).R) * compass.instrument.X_MS.R,
         .sigma = base::hypot(errors.noise * std::sqrt(row.rate), errors.bias)});
  });
  for_each_sensor<sensors::Imu>(sensor_set, sensors::kImu, [&](const auto& row, const sensors::Imu& imu) {
    const double noise = std::sqrt(row.rate);
    add(row, sensors::kImu,
        {.message = Message::imu,
         .spatial = true,
         .R_FS = glm::transpose(base::transform_of(row.X_MS).R) * imu.X_MS.R,
         .force_sigma = base::hypot(noise * imu.accel.noise, imu.accel.bias),
         .sigma = base::hypot(noise * imu.gyro.noise, imu.gyro.bias)});
  });
}

}  // namespace sf::scenarios
