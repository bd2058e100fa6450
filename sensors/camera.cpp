#include "sensors/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

#include "base/elementary.h"
#include "sensors/accuracy.h"
#include "sensors/lidar.h"
#include "sensors/lidar_packets.h"
#include "sensors/settings.h"
#include "sensors/spatial_scans.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kMostSide = 4'096;  ///< [px]
constexpr double kDegree = M_PI / 180.0;

std::vector<SpatialScanner> scanners_of(const std::vector<CameraSettings>& cameras) {
  std::vector<SpatialScanner> scanners;
  for (const CameraSettings& s : cameras) {
    // The longest beam is that of a corner.
    double least = 1.0;
    for (const glm::dvec3& d : s.beams->directions) least = std::min(least, d.x);
    scanners.push_back({.X_MS = s.X_MS,
                        .range_max = s.range_max / least * (1.0 + 1e-12),
                        .beams = s.beams,
                        .normals = s.normals,
                        .single = s.mode != 0});
  }
  return scanners;
}

double error_of(const CameraSettings& s) { return s.mode == 0 ? scene::kRangeError : scene::kSingleRangeError; }

class Cameras : public SpatialScans {
 public:
  Cameras(const SensorContext& context, const ParsedSensors& sensors)
      : SpatialScans(context, camera_type, sensors, scanners_of(sensors.settings_as<CameraSettings>())),
        settings_(sensors.settings_as<CameraSettings>()) {}

  void collect(std::span<base::ReadingBlock> out) override {
    SpatialScans::collect(out);
    for (std::size_t i = 0; i < samples().size(); ++i)
      out[i].bound = out[i].bound_without_noise = error_of(settings_[samples()[i].row]);
  }

 private:
  void finish(std::size_t sample, unsigned thread) override;

  const std::vector<CameraSettings>& settings_;
};

void Cameras::finish(std::size_t i, unsigned) {
  const HostSample& sample = samples()[i];
  const CameraSettings& s = settings_[sample.row];
  const scene::ScanOutput from = output_of(i);
  const auto hits = hits_of(i);
  const auto quality = quality_of(i);
  const std::size_t width = s.normals ? 4 : 1;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const double depth = from.ranges[k] * s.beams->directions[k].x;
    const bool seen = from.hits[k] != base::kNoHit && depth < s.range_max;
    hits[k] = seen ? from.hits[k] : base::kNoHit;
    quality[k] = seen && depth < s.range_min ? base::QualityFlag::too_near : from.quality[k];
    sample.values[k * width] = seen ? std::max(depth, s.range_min) : s.range_max;
    for (std::size_t axis = 0; axis + 1 < width; ++axis)
      sample.values[k * width + 1 + axis] = seen ? static_cast<double>(from.normals[k][static_cast<int>(axis)]) : 0.0;
  }
}

/// Beams through the centres of the pixels of all cameras with equal images.
class ImageBeams {
 public:
  std::shared_ptr<const LidarBeams> of(const CameraSettings& s) {
    auto& beams = known_[{s.width, s.height, s.focal_length}];
    if (beams) return beams;
    auto made = std::make_shared<LidarBeams>();
    for (std::uint32_t v = 0; v < s.height; ++v)
      for (std::uint32_t u = 0; u < s.width; ++u)
        made->directions.push_back(
            glm::normalize(glm::dvec3{s.focal_length, centre_of(s.width) - u, centre_of(s.height) - v}));
    made->channels = s.height;
    made->pattern = scene::make_pattern(made->directions, 0);
    return beams = std::move(made);
  }

 private:
  std::map<std::tuple<std::uint32_t, std::uint32_t, double>, std::shared_ptr<const LidarBeams>> known_;
};

void read_image(const world::Sensor& sensor, CameraSettings& s) {
  if (const auto size = tuple(sensor, "resolution", 2, "[width height]")) {
    const auto fits = [](double n) { return n >= 1.0 && n <= kMostSide && n == std::floor(n); };
    if (!fits((*size)[0]) || !fits((*size)[1]))
      refuse(sensor, "resolution",
             fmt::format("{:g} x {:g} pixels; expected whole numbers from 1 to {}", (*size)[0], (*size)[1], kMostSide));
    s.width = static_cast<std::uint32_t>((*size)[0]), s.height = static_cast<std::uint32_t>((*size)[1]);
  }
  if (s.width * s.height > kMostLidarBeams)
    refuse(sensor, "resolution",
           fmt::format("{} x {} are {} pixels; expected at most {}", s.width, s.height, s.width * s.height,
                       kMostLidarBeams));
  // Stage also gives the vertical field of view, which follows from the resolution.
  const auto fov = tuple(sensor, "fov", 1, "the horizontal field of view");
  const double angle = fov ? (*fov)[0] * sensor.radians_per_unit : 70.0 * kDegree;
  if (!(angle > 0.0 && angle <= 170.0 * kDegree * (1.0 + 1e-12)))
    refuse(sensor, "fov",
           fmt::format("a field of view of {:g} degrees; expected more than 0, to 170{}", angle / kDegree,
                       hint_of_radians(sensor, angle)));
  s.focal_length = 0.5 * s.width / base::tan(0.5 * angle);
}

CameraSettings camera_of(const world::Sensor& sensor) {
  CameraSettings s;
  s.X_MS = spatial_mount(sensor);
  if (const auto turn = tuple(sensor, "pantilt", 2, "[pan tilt]"))
    s.X_MS.R =
        s.X_MS.R * base::rotation_of(0.0, (*turn)[1] * sensor.radians_per_unit, (*turn)[0] * sensor.radians_per_unit);
  read_image(sensor, s);
  if (const auto range = tuple(sensor, "range", 2, "[min max]"))
    s.range_min = sensor.metres_per_unit * (*range)[0], s.range_max = sensor.metres_per_unit * (*range)[1];
  if (!(s.range_max > 0.0 && s.range_max <= 1e4 && s.range_min >= 0.0 && s.range_min <= s.range_max))
    refuse(sensor, "range",
           fmt::format("depths from {:g} to {:g} m; expected 0 or more, to more than that and at most "
                       "10000 m",
                       s.range_min, s.range_max));
  s.normals = whole(sensor, "normals", 0, 0, 1) == 1;
  return s;
}

ParsedSensors parse_cameras(const world::World& world) {
  ImageBeams images;
  return parse_each(world, camera_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    CameraSettings s = camera_of(sensor);
    row.mode = s.mode = mode_of("camera", kCameraModes, accuracy_of(sensor), world);
    s.beams = images.of(s);
    row.elements = s.width * s.height;
    row.width = s.normals ? 4 : 1;
    row.X_MS = {s.X_MS.p.x, s.X_MS.p.y, s.X_MS.p.z, base::atan2(s.X_MS.R[0].y, s.X_MS.R[0].x)};
    row.limit = s.range_max;
    row.range_min = s.range_min;
    const double corner = base::hypot(s.focal_length, centre_of(s.width), centre_of(s.height)) / s.focal_length;
    row.dependency_radius = row.reach = s.range_max * corner;
    return s;
  });
}

SpatialBeams beams_of_camera(const ParsedSensors& sensors, std::size_t row) {
  const CameraSettings& s = sensors.settings_as<CameraSettings>()[row];
  return {s.X_MS, s.beams->directions, {}};
}

ErrorBound bound_of_camera(const world::World&, const ParsedSensors& sensors, std::size_t row) {
  return {error_of(sensors.settings_as<CameraSettings>()[row]), ""};
}

// Depths are sent as the ranges of lidars are. Normals are not sent.

std::size_t width_of(const SensorSpec& sensor) { return sensor.width != 0 ? sensor.width : 4; }

std::vector<double> depths_of(std::span<const double> values, std::size_t width) {
  std::vector<double> depths;
  for (std::size_t i = 0; i < values.size(); i += width) depths.push_back(values[i]);
  return depths;
}

SensorSpec depth_spec(const SensorSpec& sensor) {
  SensorSpec spec = sensor;
  spec.width = 1;
  return spec;
}

std::uint8_t lidar_form(std::uint8_t type) { return static_cast<std::uint8_t>(type - kCamera + kLidar); }

std::string wire_problem(const SensorSpec& sensor, WireFormat wire) {
  return lidar_wire_problem(depth_spec(sensor), wire);
}
std::uint32_t parts(const SensorSpec& sensor, WireFormat wire) { return lidar_parts(depth_spec(sensor), wire); }

std::uint8_t encode(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire, std::uint32_t part,
                    base::Bytes& out) {
  base::ReadingBlock depths = reading;
  const std::vector<double> values = depths_of(reading.values, width_of(sensor));
  depths.values = values;
  const std::uint8_t type = encode_lidar(depth_spec(sensor), depths, wire, part, out);
  return type == 0 ? 0 : static_cast<std::uint8_t>(type - kLidar + kCamera);
}

double wire_error(const SensorSpec& sensor, const base::ReadingBlock& reading) {
  base::ReadingBlock depths = reading;
  const std::vector<double> values = depths_of(reading.values, width_of(sensor));
  depths.values = values;
  return lidar_wire_error(depth_spec(sensor), depths);
}

PayloadPart decode(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                   WireFormat wire) {
  return decode_lidar(depth_spec(sensor), payload, lidar_form(type), wire);
}

void read(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
          std::span<double> values) {
  const std::size_t width = width_of(sensor);
  std::vector<double> depths = depths_of(values, width);
  fill_lidar(depth_spec(sensor), payload, lidar_form(type), wire, depths);
  for (std::size_t i = 0; i < depths.size(); ++i) values[i * width] = depths[i];
}

constexpr Column kColumns[] = {{"depth_m", 1, false, 9}, {"normal", 3}};
constexpr std::string_view kKeys[] = {"resolution", "fov", "range", "normals", "pose6", "pantilt"};

}  // namespace

constinit const SensorType camera_type{
    .id = kCamera,
    .name = "camera",
    .word = {"camera", kKeys},
    .base_port = 15000,
    .list = "pixels",
    .columns = kColumns,
    .beams = beams_of_camera,
    .modes = kCameraModes,
    .bound = bound_of_camera,
    .parse = parse_cameras,
    .make = make_backend<Cameras>,
    .wire_problem = wire_problem,
    .parts = parts,
    .encode = encode,
    .wire_error = wire_error,
    .decode = decode,
    .read = read,
};

}  // namespace sf::sensors
