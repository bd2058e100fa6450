#include "sensors/camera_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "sensors/pixel_samples.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kMostSide = 4'096;   ///< [px]
constexpr double kPerDegree = M_PI / 180.0;  ///< [rad]
constexpr double kMostFov = 170.0 * kPerDegree;
constexpr std::uint32_t kMostSamples = 64;
constexpr std::uint32_t kMostCameraBeams = 4'000'000;  ///< of one camera
constexpr double kMostFocal = 1e6;                     ///< [px]
constexpr double kMostDepthNoise = 0.25;               ///< [-] of the largest depth, whose noise is never below 0 then
constexpr double kMostBlur = 20.0;                     ///< [px]

void read_resolution(const world::Sensor& sensor, CameraSettings& s) {
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
}

/// Reads `distortion` or `fisheye`.
void read_distortion(const world::Sensor& sensor, base::Lens& lens) {
  const auto fisheye = tuple(sensor, "fisheye", 4, "[k1 k2 k3 k4]");
  const auto pinhole = tuple(sensor, "distortion", 4, "[k1 k2 p1 p2], [k1 k2 p1 p2 k3] or [k1 k2 p1 p2 k3 k4 k5 k6]");
  if (fisheye && pinhole) refuse(sensor, "fisheye", "'distortion' and 'fisheye'; expected one of them");
  lens.fisheye = fisheye.has_value();
  const auto& given = fisheye ? fisheye : pinhole;
  if (!given) return;
  const bool counted = fisheye ? given->size() == 4 : given->size() <= 5 || given->size() == 8;
  if (!counted)
    refuse(sensor, fisheye ? "fisheye" : "distortion",
           fmt::format("{} coefficients; expected {}", given->size(), fisheye ? "4" : "4, 5 or 8, as OpenCV's"));
  std::ranges::copy(*given, lens.distortion.begin());
}

/// Reads `focal`, or derives it from `fov`: half of the width is imaged at half of the angle, without the distortion of
/// a pinhole.
void read_focal(const world::Sensor& sensor, CameraSettings& s) {
  // Stage also gives the vertical field of view, which follows from the resolution.
  const auto fov = tuple(sensor, "fov", 1, "a field of view, or as in Stage [horizontal vertical]");
  if (const auto focal = tuple(sensor, "focal", 1, "[fx fy], or one number for both [px]")) {
    if (fov) refuse(sensor, "focal", "'fov' and 'focal'; expected one of them");
    s.lens.focal = {focal->front(), focal->back()};
    for (int axis = 0; axis < 2; ++axis) {
      const double f = s.lens.focal[axis], half = 0.5 * (axis == 0 ? s.width : s.height);
      const double least = s.lens.fisheye ? 1.0 : half / base::tan(0.5 * kMostFov);
      if (!(f >= least * (1.0 - 1e-12) && f <= kMostFocal))
        refuse(sensor, "focal",
               fmt::format("a focal length of {:g} px; expected {:.4g} to {:g}{}", f, least, kMostFocal,
                           s.lens.fisheye ? "" : ": a field of view of at most 170 degrees"));
    }
    return;
  }
  const double angle = fov ? (*fov)[0] * sensor.radians_per_unit : 70.0 * kPerDegree;
  if (!(angle > 0.0 && angle <= kMostFov * (1.0 + 1e-12)))
    refuse(sensor, "fov",
           fmt::format("a field of view of {:g} degrees; expected more than 0, to 170{}", angle / kPerDegree,
                       hint_of_radians(sensor, angle)));
  const double half = s.lens.fisheye ? base::fisheye_radius(s.lens, 0.5 * angle) : base::tan(0.5 * angle);
  if (!(half > 0.0))
    refuse(sensor, "fisheye", "the lens images half of 'fov' at its axis, or beyond; expected smaller coefficients");
  s.lens.focal = glm::dvec2(0.5 * s.width / half);
}

void read_lens(const world::Sensor& sensor, CameraSettings& s) {
  read_distortion(sensor, s.lens);
  read_focal(sensor, s);
  s.lens.center = 0.5 * glm::dvec2(s.width - 1.0, s.height - 1.0);
  if (const auto principal = tuple(sensor, "principal", 2, "[cx cy] [px]")) {
    s.lens.center = {(*principal)[0], (*principal)[1]};
    if (!(glm::length(s.lens.center) <= kMostFocal))
      refuse(sensor, "principal", fmt::format("the principal point is more than {:g} px away", kMostFocal));
  }
}

void read_depths(const world::Sensor& sensor, CameraSettings& s) {
  if (const auto range = tuple(sensor, "range", 2, "[min max]"))
    s.range_min = sensor.metres_per_unit * (*range)[0], s.range_max = sensor.metres_per_unit * (*range)[1];
  require_range(sensor, "range", "depths", s.range_min, s.range_max, 1e4);
  s.depth_noise = length(sensor, "depth_noise", 0.0, 0.0, 1e3);  // at 1 m
  if (const double share = s.depth_noise * s.range_max; !(share <= kMostDepthNoise))
    refuse(sensor, "depth_noise",
           fmt::format("a standard deviation of {:.3g} m at the largest depth, {:g} m; expected at most {:g} of it",
                       s.depth_sigma(s.range_max), s.range_max, kMostDepthNoise));
}

void read_colours(const world::Sensor& sensor, CameraSettings& s) {
  s.mono = whole(sensor, "mono", 0, 0, 1) == 1;
  s.rgb = whole(sensor, "rgb", 0, 0, 1) == 1;
  if (s.rgb && s.mono) refuse(sensor, "mono", "'rgb' and 'mono'; expected one of them");
  s.rgb = s.rgb || s.mono;
  for (const char* key : {"jpeg", "samples", "exposure", "gain", "vignetting", "noise", "blur", "linear"})
    if (!s.rgb && find(sensor, key) != nullptr)
      refuse(sensor, key, fmt::format("'{}' changes colours; expected 'rgb 1' or 'mono 1' with it", key));
  s.jpeg = static_cast<int>(whole(sensor, "jpeg", 0, 0, 100));
  s.samples = whole(sensor, "samples", 1, 1, kMostSamples);
  if (s.width * s.height > kMostCameraBeams / s.samples)
    refuse(sensor, "samples",
           fmt::format("{} x {} pixels of {} samples; expected at most {} in all", s.width, s.height, s.samples,
                       kMostCameraBeams));
  s.linear = whole(sensor, "linear", 0, 0, 1) == 1;
}

void read_response(const world::Sensor& sensor, CameraResponse& s) {
  s.gain = number(sensor, "gain", 1.0, 0.0, 1e6);
  s.vignetting = number(sensor, "vignetting", 0.0, 0.0, 1.0);
  s.blur = number(sensor, "blur", 0.0, 0.0, kMostBlur);
  const auto noise = tuple(sensor, "noise", 1, "[dark shot]: a standard deviation, and a variance per light");
  if (!noise) return;
  s.read_noise = (*noise)[0], s.shot_noise = noise->size() > 1 ? (*noise)[1] : 0.0;
  if (!(s.read_noise >= 0.0 && s.read_noise <= 1e6 && s.shot_noise >= 0.0 && s.shot_noise <= 1e6))
    refuse(sensor, "noise", "'noise' is negative; expected a standard deviation and a variance of 0 or more");
}

void read_times(const world::Sensor& sensor, CameraSettings& s) {
  s.exposure = number(sensor, "exposure", 0.0, 0.0, 10.0);
  if (s.exposure > 0.0 && s.samples == 1)
    refuse(sensor, "exposure", "'exposure' is divided among the samples of a pixel; expected 'samples' of 2 or more");
  if (whole(sensor, "rolling", 0, 0, 1) == 1)
    s.readout = number(sensor, "scan_time", 1.0 / rate_of(sensor, 10.0), 1e-6, 60.0);
  else if (find(sensor, "scan_time") != nullptr)
    refuse(sensor, "scan_time", "'scan_time' is that of a rolling shutter; expected 'rolling 1' with it");
  const std::size_t times = (s.readout > 0.0 ? s.height : 1) * (s.exposure > 0.0 ? s.samples : 1);
  if (times > kMostBeamTimes)
    refuse(sensor, s.readout > 0.0 ? "rolling" : "exposure",
           fmt::format("the beams have {} different times; expected at most {}: use fewer rows or samples", times,
                       kMostBeamTimes));
}

/// Times of all parts [s], relative to the reading, at which the first sample of the last row is cast; empty: all are
/// 0. Sets LidarBeams::times to those of each pixel's earliest sample.
std::vector<double> times_of(const CameraSettings& s, LidarBeams& beams) {
  std::vector<double> times;
  if (s.exposure == 0.0 && s.readout == 0.0) return times;
  const Shutter shutter{s.exposure, s.readout, s.height, s.samples};
  const auto time_of = [&](std::size_t pixel, std::uint32_t sample) {
    return shutter.time_of(pixel / s.width, sample);
  };
  for (std::size_t i = 0; i < beams.directions.size(); ++i) beams.times.push_back(time_of(i, s.samples - 1));
  for (std::size_t part = 0; part < beams.cast_directions().size(); ++part) {
    const std::size_t c = part / s.samples;
    times.push_back(time_of(beams.cast.empty() ? c : beams.cast[c], static_cast<std::uint32_t>(part % s.samples)));
  }
  return times;
}

/// Unit vector in the sensor's frame. @param n normalised coordinates
glm::dvec3 beam_of(glm::dvec2 n) { return glm::normalize(glm::dvec3{1.0, -n.x, -n.y}); }

void add_parts(const base::LensImage& lens, const CameraSettings& s, LidarBeams& beams) {
  const std::size_t count = beams.cast.empty() ? beams.directions.size() : beams.cast.size();
  const PixelSamples samples(s.samples);
  for (std::size_t c = 0; c < count; ++c) {
    const std::uint32_t i = beams.cast.empty() ? static_cast<std::uint32_t>(c) : beams.cast[c];
    beams.part_directions.push_back(beams.directions[i]);
    const std::uint32_t u = i % s.width, v = i / s.width;
    for (std::uint32_t k = 1; k < s.samples; ++k) {
      const auto n = lens.direction(glm::dvec2(u, v) + samples.at(k, u, v));
      beams.part_directions.push_back(n ? beam_of(*n) : beams.directions[i]);
    }
  }
}

}  // namespace

std::shared_ptr<const LidarBeams> CameraReader::beams_of(const world::Sensor& sensor, const CameraSettings& s) {
  const Image image{s.width, s.height, s.lens, s.samples, s.exposure, s.readout};
  const auto known = std::ranges::find(known_, image, [](const auto& each) { return each.first; });
  if (known != known_.end()) return known->second;
  const base::LensImage lens(s.lens, s.width, s.height);
  if (const auto pixel = lens.fold())
    refuse(sensor, s.lens.fisheye ? "fisheye" : "distortion",
           fmt::format("the lens folds its image between the axis and pixel ({}, {}); expected coefficients that are "
                       "invertible in the whole image: calibrate with corners of the image, or use fewer of them",
                       pixel->x, pixel->y));
  auto made = std::make_shared<LidarBeams>();
  for (std::uint32_t v = 0; v < s.height; ++v)
    for (std::uint32_t u = 0; u < s.width; ++u) {
      const auto n = lens.direction({u, v});
      if (n) made->cast.push_back(static_cast<std::uint32_t>(made->directions.size()));
      made->directions.push_back(n ? beam_of(*n) : glm::dvec3{1.0, 0.0, 0.0});
    }
  if (made->cast.empty())
    refuse(sensor, "principal", "no pixel sees anything; expected a fisheye's circle in the image");
  if (made->cast.size() == made->directions.size()) made->cast.clear();
  made->channels = s.height;
  made->parts = s.samples;
  if (s.samples > 1 || !made->cast.empty()) add_parts(lens, s, *made);
  const std::vector<double> times = times_of(s, *made);
  made->pattern = made->part_directions.empty() && times.empty()
                      ? scene::make_image_pattern(made->directions, s.width)
                      : scene::make_pattern(made->cast_directions(), 0, times);
  return known_.emplace_back(image, std::move(made)).second;
}

CameraSettings CameraReader::read(const world::Sensor& sensor) {
  CameraSettings s;
  s.X_MS = spatial_mount(sensor);
  if (const auto turn = tuple(sensor, "pantilt", 2, "[pan tilt]"))
    s.X_MS.R =
        s.X_MS.R * base::rotation_of(0.0, (*turn)[1] * sensor.radians_per_unit, (*turn)[0] * sensor.radians_per_unit);
  read_resolution(sensor, s);
  read_lens(sensor, s);
  read_depths(sensor, s);
  s.normals = whole(sensor, "normals", 0, 0, 1) == 1;
  read_colours(sensor, s);
  read_response(sensor, s.response);
  read_times(sensor, s);
  s.beams = beams_of(sensor, s);
  return s;
}

}  // namespace sf::sensors
