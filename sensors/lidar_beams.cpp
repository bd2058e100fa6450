#include "sensors/lidar_beams.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/time.h"
#include "sensors/accuracy.h"
#include "sensors/lidar_layout.h"
#include "sensors/lidar_modes.h"
#include "sensors/settings.h"
#include "sensors/spatial_scene.h"
#include "world/beam_table.h"

namespace sf::sensors {

namespace {

constexpr double kDegree = M_PI / 180.0;

/// A real device, by its manufacturer's data sheet.
struct Preset {
  std::string_view name;
  std::uint32_t channels, columns;
  double low, high;  ///< [degrees] elevations of the first and the last channel
  double fov;        ///< [degrees]
  double range;      ///< [m]
  double sigma;      ///< [m] of the range
};

// Velodyne 63-9243 Rev. E: 16 channels from -15 to 15 degrees, 0.2 degrees at 10 Hz, 100 m, typically 3 cm.
// Velodyne 97-0038 Rev. N: 32 channels from -30.67 to 10.67 degrees, 0.16 degrees at 10 Hz, 100 m, 2 cm.
// Ouster OS1 Rev. 6: 64 channels over 45 degrees, 1024 columns at 10 Hz, 120 m, 0.7 to 5 cm.
// Livox Mid-40: a circle of 38.4 degrees, 100 000 points/s, 260 m, 2 cm at 20 m.
constexpr Preset kPresets[] = {{"VLP-16", 16, 1800, -15.0, 15.0, 360.0, 100.0, 0.03},
                               {"HDL-32E", 32, 2250, -30.67, 10.67, 360.0, 100.0, 0.02},
                               {"OS1-64", 64, 1024, -22.5, 22.5, 360.0, 120.0, 0.03},
                               {"Mid-40", 1, 10000, 0.0, 0.0, 38.4, 260.0, 0.02}};
constexpr const Preset& kRosette = kPresets[3];

std::optional<std::vector<double>> angles(const world::Sensor& sensor, std::string_view key, std::size_t least,
                                          const std::string& meaning, double most) {
  auto values = tuple(sensor, key, least, meaning);
  if (!values) return values;
  for (double& value : *values) {
    value *= sensor.radians_per_unit;
    if (!(std::abs(value) <= most * (1.0 + 1e-12)))
      refuse(sensor, key,
             fmt::format("'{}' has an angle of {:g} degrees; expected {:g} to {:g}{}", key, value / kDegree,
                         -most / kDegree, most / kDegree, hint_of_radians(sensor, value)));
  }
  return values;
}

/// Reads `elevations`, or spreads `channels` over `fov_v`.
std::vector<double> elevations_of(const world::Sensor& sensor, const Preset* preset) {
  if (auto table = angles(sensor, "elevations", 1, "one elevation per channel", M_PI / 2)) {
    if (find(sensor, "channels") != nullptr || find(sensor, "fov_v") != nullptr)
      refuse(sensor, "elevations", "'elevations' has one number per channel; leave out 'channels' and 'fov_v'");
    if (table->size() > kMostChannels)
      refuse(sensor, "elevations", fmt::format("{} channels; expected at most {}", table->size(), kMostChannels));
    return *table;
  }
  const std::uint32_t channels = whole(sensor, "channels", preset != nullptr ? preset->channels : 16, 1, kMostChannels);
  const auto ends = angles(sensor, "fov_v", 2, "[lowest highest] of the channels' elevations", M_PI / 2);
  const double low = ends ? (*ends)[0] : kDegree * (preset != nullptr ? preset->low : -15.0);
  const double high = ends ? (*ends)[1] : kDegree * (preset != nullptr ? preset->high : 15.0);
  std::vector<double> elevations;
  for (std::uint32_t i = 0; i < channels; ++i)
    elevations.push_back(channels == 1 ? 0.5 * (low + high) : low + (high - low) * i / (channels - 1));
  return elevations;
}

void read_rings(const world::Sensor& sensor, LidarLayout& layout) {
  const Preset* const preset = preset_of(sensor, kPresets);
  layout.rosette = preset == &kRosette;
  for (const char* key : {"channels", "fov_v", "elevations", "azimuth_offsets"})
    if (layout.rosette && find(sensor, key) != nullptr)
      refuse(sensor, key,
             fmt::format("the beams of \"{}\" form no rings, so '{}' has no effect; expected 'columns' (beams) and "
                         "'fov' (of the circle) at most",
                         kRosette.name, key));
  layout.elevations = elevations_of(sensor, preset);
  layout.columns = whole(sensor, "columns", preset != nullptr ? preset->columns : 1800, 1, kMostLidarBeams);
  layout.fov = std::min(
      angle(sensor, "fov", kDegree * (preset != nullptr ? preset->fov : 360.0), 1e-9, 2.0 * M_PI * (1.0 + 1e-12)),
      2.0 * M_PI);
  const auto offsets = angles(sensor, "azimuth_offsets", 1, "one angle per channel", M_PI);
  layout.offsets = offsets ? *offsets : std::vector<double>(layout.elevations.size());
  if (layout.offsets.size() != layout.elevations.size())
    refuse(sensor, "azimuth_offsets",
           fmt::format("{} offsets of {} channels; expected one per channel", layout.offsets.size(),
                       layout.elevations.size()));
}

void read_parts(const world::Sensor& sensor, LidarLayout& layout) {
  layout.divergence = angle(sensor, "divergence", 0.0, 0.0, 0.2);
  if (layout.divergence > 0.0) {
    layout.parts = whole(sensor, "beam_parts", 7, 2, kMostBeamParts);
  } else if (find(sensor, "beam_parts") != nullptr) {
    refuse(sensor, "beam_parts", "'beam_parts' divides the cone of a beam; expected 'divergence' with it");
  }
}

void require_few(const world::Sensor& sensor, const LidarLayout& layout) {
  const std::size_t cast = layout.beams() * layout.parts;
  if (cast <= kMostLidarBeams) return;
  if (layout.parts > 1)
    refuse(sensor, "beam_parts",
           fmt::format("{} beams of {} parts are {}; expected at most {}", layout.beams(), layout.parts, cast,
                       kMostLidarBeams));
  refuse(sensor, "columns",
         fmt::format("'channels' {} times 'columns' {} are {} beams; expected at most {}", layout.elevations.size(),
                     layout.columns, cast, kMostLidarBeams));
}

void require_few_times(const world::Sensor& sensor, std::vector<double> times) {
  std::ranges::sort(times);
  const auto different = static_cast<std::size_t>(std::unique(times.begin(), times.end()) - times.begin());
  if (different > kMostBeamTimes)
    refuse(sensor, "rolling",
           fmt::format("the beams have {} different times; expected at most {}: use fewer columns, or "
                       "round the times in the file",
                       different, kMostBeamTimes));
}

void read_range(const world::Sensor& sensor, EchoSettings& s) {
  if (const auto range = tuple(sensor, "range", 2, "[min max]"))
    s.range_min = sensor.metres_per_unit * (*range)[0], s.range_max = sensor.metres_per_unit * (*range)[1];
  s.range_min = length(sensor, "range_min", s.range_min, -HUGE_VAL, HUGE_VAL);
  s.range_max = length(sensor, "range_max", s.range_max, -HUGE_VAL, HUGE_VAL);
  const std::string_view key = find(sensor, "range_max") != nullptr ? "range_max" : "range";
  require_range(sensor, key, "a range", s.range_min, s.range_max, kLongestLidarRange);
}

void read_noise(const world::Sensor& sensor, EchoSettings& s) {
  s.dropout = number(sensor, "dropout", 0.0, 0.0, 1.0);
  const auto noise = tuple(sensor, "noise", 1, "[constant proportional slope], standard deviations");
  if (!noise) return;
  s.sigma = (*noise)[0] * sensor.metres_per_unit;
  s.proportional = noise->size() > 1 ? (*noise)[1] : 0.0;
  s.slope = noise->size() > 2 ? (*noise)[2] * sensor.metres_per_unit : 0.0;
  if (!(s.sigma >= 0.0 && s.proportional >= 0.0 && s.slope >= 0.0))
    refuse(sensor, "noise", "'noise' is negative; expected standard deviations of 0 or more");
}

void read_echoes(const world::Sensor& sensor, EchoSettings& s) {
  const bool two = whole(sensor, "returns", 1, 1, 2) == 2, incidence = whole(sensor, "incidence", 0, 0, 1) == 1;
  const bool intensity = whole(sensor, "intensity", 0, 0, 1) == 1;
  s.width = two ? 5 : incidence ? 3 : intensity ? 2 : 1;
  s.intensity_range = length(sensor, "intensity_range", 0.0, 0.0, kLongestLidarRange);
  s.separation = length(sensor, "separation", s.separation, 0.0, kLongestLidarRange);
  if (s.intensity_range > 0.0 && s.width == 1)
    refuse(sensor, "intensity_range", "'intensity_range' scales intensities; expected 'intensity 1' with it");
  if (two && find(sensor, "divergence") == nullptr)
    refuse(sensor, "returns", "a beam without a width meets one surface; expected 'divergence' with 'returns 2'");
  if (const auto detects = tuple(sensor, "detects", 2, "[range reflectance]")) {
    s.detection_range = (*detects)[0] * sensor.metres_per_unit, s.detection_reflectance = (*detects)[1];
    if (!(s.detection_range > 0.0 && s.detection_range <= kLongestLidarRange && s.detection_reflectance > 0.0 &&
          s.detection_reflectance <= 100.0))
      refuse(sensor, "detects",
             "expected the range at which a surface that faces the sensor is just detected, above 0, and its "
             "reflectance, above 0 to 100");
  }
}

}  // namespace

std::int64_t LidarBeams::duration() const { return times.empty() ? 0 : base::nanoseconds(-std::ranges::min(times)); }

void BeamBudget::add(const world::Sensor& sensor, std::string_view key, std::size_t beams) {
  if (used_ == 0) require_mesh_places(world_);
  used_ += beams;
  if (used_ > kMost)
    refuse(
        sensor, key,
        fmt::format("the world's {} have more than {} beams in all; give fewer {} or robots", sensors_, kMost, fewer_));
}

std::shared_ptr<const LidarBeams> LidarReader::beams_of(const world::World& world, const world::Sensor& sensor,
                                                        std::uint32_t skip) {
  LidarLayout layout;
  if (const world::Setting* const file = find(sensor, "directions")) {
    for (const char* key :
         {"preset", "channels", "columns", "fov", "fov_v", "elevations", "azimuth_offsets", "scan_time"})
      if (find(sensor, key) != nullptr)
        refuse(sensor, key, fmt::format("'{}' and 'directions'; expected one of them", key));
    layout.table = world::find_beam_table(world, *file);
    if (layout.table == nullptr)
      refuse(sensor, "directions",
             fmt::format("the world has no table '{}'; expected the name of a CSV file", file->text));
    layout.columns = static_cast<std::uint32_t>(layout.table->rows.size());
    layout.elevations.resize(1);
  } else {
    read_rings(sensor, layout);
  }
  read_parts(sensor, layout);
  if (layout.has_rings()) layout.skip = skip;
  require_few(sensor, layout);
  if (whole(sensor, "rolling", 0, 0, 1) == 1)
    layout.scan_time = number(sensor, "scan_time", 1.0 / rate_of(sensor, 10.0), 1e-6, 60.0);
  if (layout.scan_time > 0.0 && layout.table != nullptr && !layout.table->timed)
    refuse(sensor, "rolling", "the table of 'directions' has no column time_s; expected one for rolling scans");
  const std::vector<double> description = layout.description();
  const auto same = [&](const auto& known) { return known.first == description; };
  const auto known = std::ranges::find_if(known_, same);
  if (known != known_.end()) return known->second;
  require_few_times(sensor, times_of(layout));
  auto beams = std::make_shared<LidarBeams>(sensors::beams_of(layout));
  return known_.emplace_back(description, std::move(beams)).second;
}

LidarSettings LidarReader::read(const world::World& world, const world::Sensor& sensor) {
  const Preset* const preset = preset_of(sensor, kPresets);
  LidarSettings s;
  s.X_MS = spatial_mount(sensor);
  if (preset != nullptr) s.echo.range_max = preset->range, s.echo.sigma = preset->sigma;
  read_range(sensor, s.echo);
  read_noise(sensor, s.echo);
  read_echoes(sensor, s.echo);
  s.mode = mode_of("lidar", kLidarModes, accuracy_of(sensor), world);
  s.beams = beams_of(world, sensor, kLidarSkips[s.mode]);
  return s;
}

}  // namespace sf::sensors
