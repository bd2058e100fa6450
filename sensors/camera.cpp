#include "sensors/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "base/elementary.h"
#include "base/random.h"
#include "base/srgb.h"
#include "sensors/accuracy.h"
#include "sensors/camera_light.h"
#include "sensors/image_packets.h"
#include "sensors/lidar.h"
#include "sensors/lidar_packets.h"
#include "sensors/settings.h"
#include "sensors/spatial_scans.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kNoiseId = 1u << 31;       ///< added to the numbers of cameras, in the random numbers of lidars
constexpr std::uint32_t kDepthNoiseId = 3u << 30;  ///< the same for depths

/// Range of the longest beam to the largest depth, over that depth.
double stretch(const CameraSettings& s) {
  double least = 1.0;
  for (const glm::dvec3& d : s.beams->directions) least = std::min(least, d.x);
  return 1.0 / least;
}

std::vector<SpatialScanner> scanners_of(const std::vector<CameraSettings>& cameras) {
  std::vector<SpatialScanner> scanners;
  for (const CameraSettings& s : cameras)
    scanners.push_back({.X_MS = s.X_MS,
                        .range_max = s.range_max * stretch(s) * (1.0 + 1e-12),
                        .beams = s.beams,
                        .plain = s.columns() == 1 && s.samples == 1 && s.beams->cast.empty(),
                        .normals = s.normals,
                        .materials = s.rgb,
                        .follows = s.rgb,
                        .textures = s.rgb,
                        .single = s.mode != 0,
                        .depth_max = s.range_max});
  return scanners;
}

double error_of(const CameraSettings& s) { return s.mode == 0 ? scene::kRangeError : scene::kSingleRangeError; }

/// Replaces colours by their luminance.
void make_grey(std::uint32_t beams, CameraLight::Lanes& lanes) {
  for (std::uint32_t k = 0; k < beams; ++k) {
    const glm::vec3 color(lanes.light[0][k], lanes.light[1][k], lanes.light[2][k]);
    for (auto& light : lanes.light) light[k] = glm::dot(glm::vec3(base::kLuminance), color);
  }
}

class Cameras : public SpatialScans {
 public:
  Cameras(const SensorContext& context, const ParsedSensors& sensors);

  bool update_outlines(const world::World& world) override;
  bool prepare(std::span<const DueSample> due) override;
  void collect(std::span<base::ReadingBlock> out) override {
    SpatialScans::collect(out);
    for (std::size_t i = 0; i < samples().size(); ++i)
      out[i].bound = out[i].bound_without_noise = error_of(settings_[samples()[i].row]);
  }

 private:
  void begin_follow(std::size_t sample, const base::RigidTransform& X_WS, unsigned thread) override;
  void begin_shadows(std::size_t sample, const base::RigidTransform& X_WS, std::span<const scene::Instance> instances,
                     unsigned thread);
  void follow(std::size_t sample, const base::RigidTransform& X_WS, const scene::BeamTile& tile,
              const scene::TileSurfaces& surfaces, unsigned thread) override;
  void finish(std::size_t sample, unsigned thread) override;
  void write_pixels(std::size_t sample);
  void add_depth_noise(std::size_t sample);
  std::vector<glm::vec3> blurred_light(std::size_t sample);
  std::uint32_t color_of(std::size_t sample, std::size_t pixel, std::span<const glm::vec3> light) const;

  const std::vector<CameraSettings>& settings_;
  bool noise_;
  // Of cameras with colours.
  std::optional<CameraLight> light_;
  std::vector<glm::vec3> part_light_;          ///< empty if all cameras have plain colours
  std::vector<std::uint32_t> part_colors_;     ///< of cameras with plain colours: 0xRRGGBB
  std::vector<CameraLight::Scratch> scratch_;  ///< per thread
  std::vector<SceneList> casting_;             ///< per due sample: surfaces that cast shadows
};

Cameras::Cameras(const SensorContext& context, const ParsedSensors& sensors)
    : SpatialScans(context, camera_type, sensors, scanners_of(sensors.settings_as<CameraSettings>())),
      settings_(sensors.settings_as<CameraSettings>()),
      noise_(context.noise) {
  if (std::ranges::none_of(settings_, &CameraSettings::rgb)) return;
  light_.emplace(context.world, materials(), textures());
  if (std::ranges::any_of(settings_, [](const CameraSettings& s) { return s.rgb && !s.is_plain(); }))
    part_light_.resize(parts());
  part_colors_.resize(parts());
  scratch_.resize(context.thread_pool.threads());
}

bool Cameras::update_outlines(const world::World& world) {
  if (light_) light_->update(world);
  return SpatialScans::update_outlines(world);
}

bool Cameras::prepare(std::span<const DueSample> due) {
  const bool again = SpatialScans::prepare(due);
  if (!light_ || !light_->has_sun()) return again;
  casting_.resize(std::max(casting_.size(), due.size()));
  const double further = light_->shadow_reach(scene().largest());
  for (std::size_t i = 0; i < due.size(); ++i) {
    if (!settings_[due[i].row].rgb) continue;
    SensorView view = sensor_view(i);
    view.range += further, view.own = true;
    scene().list(view, casting_[i]);
  }
  return again;
}

void Cameras::begin_shadows(std::size_t i, const base::RigidTransform& X_WS, std::span<const scene::Instance> instances,
                            unsigned thread) {
  const bool exact = settings_[samples()[i].row].mode == 0;
  const float least = exact ? scene::kLeastShadow : 2.0f * static_cast<float>(scene::kSingleRangeError);
  scratch_[thread].shadows.begin(X_WS.p, light_->to_sun(), {instances, false, scene().terrain()}, least);
}

void Cameras::begin_follow(std::size_t i, const base::RigidTransform& X_WS, unsigned thread) {
  if (light_->has_sun()) begin_shadows(i, X_WS, casting_[i].instances, thread);
}

void Cameras::follow(std::size_t i, const base::RigidTransform& X_WS, const scene::BeamTile& tile,
                     const scene::TileSurfaces& surfaces, unsigned thread) {
  CameraLight::Scratch& scratch = scratch_[thread];
  if (light_->has_sun() && !casting_[i].moving.empty()) {
    move_to_tile(tile, casting_[i], scratch.moved);
    begin_shadows(i, X_WS, scratch.moved, thread);
  }
  const CameraSettings& s = settings_[samples()[i].row];
  const double pixel = 1.0 / (s.lens.focal.x * s.lens.focal.y * s.samples);
  light_->shade(X_WS, tile, {s.range_max, static_cast<float>(pixel), !s.lens.fisheye}, surfaces, scratch);
  const auto& light = scratch.lanes.light;
  const std::uint32_t beams = tile.used * scene::kWidth;
  if (s.mono) make_grey(beams, scratch.lanes);
  if (s.is_plain()) {
    std::uint32_t colors[scene::kTileBeams];
    base::srgb_colors(light[0], light[1], light[2], std::span(colors).first(beams));
    const auto out = parts_of(part_colors_, i);
    for (std::uint32_t k = 0; k < beams; ++k) out[tile.place[k]] = colors[k];
  } else {
    const auto out = parts_of(part_light_, i);
    for (std::uint32_t k = 0; k < beams; ++k) out[tile.place[k]] = {light[0][k], light[1][k], light[2][k]};
  }
}

/// Returns the light of all pixels, blurred by the lens.
std::vector<glm::vec3> Cameras::blurred_light(std::size_t i) {
  const CameraSettings& s = settings_[samples()[i].row];
  const std::span<const glm::vec3> light = parts_of(part_light_, i);
  std::vector<glm::vec3> image(s.width * s.height);
  for (std::size_t c = 0; c < light.size() / s.samples; ++c) {
    glm::vec3& pixel = image[s.beams->cast.empty() ? c : s.beams->cast[c]];
    for (const glm::vec3& each : light.subspan(c * s.samples, s.samples)) pixel += each;
    pixel /= static_cast<float>(s.samples);
  }
  LensBlur(s.response.blur).apply(image, s.width);
  return image;
}

/// @param light of the samples of a pixel
std::uint32_t Cameras::color_of(std::size_t i, std::size_t pixel, std::span<const glm::vec3> light) const {
  const HostSample& sample = samples()[i];
  const CameraSettings& s = settings_[sample.row];
  glm::vec3 sum{};
  for (const glm::vec3& each : light) sum += each;
  glm::dvec3 mean = s.response.gain / static_cast<double>(light.size()) * glm::dvec3(sum);
  mean *= s.response.falloff({pixel % s.width, pixel / s.width}, {s.width, s.height});
  if (noise_ && s.response.is_noisy()) {
    const SensorSpec& row = rows()[sample.row];
    const base::RandomKey key =
        episodes().key(base::RandomStream::spatial_range, row.mover, kNoiseId + row.sensor, sample.sequence);
    const auto index = static_cast<std::uint32_t>(2 * pixel);
    const auto a = base::random_normal(key, index), b = base::random_normal(key, index + 1);
    const glm::dvec3 normal = s.mono ? glm::dvec3(a[0]) : glm::dvec3(a[0], a[1], b[0]);
    for (int k = 0; k < 3; ++k) mean[k] += normal[k] * s.response.noise_of(mean[k]);
  }
  return s.linear ? base::linear_bytes(glm::vec3(mean)) : base::srgb_color(glm::vec3(mean));
}

/// Pixels of a whole image without a surface.
void see_nothing(const CameraSettings& s, std::span<double> values, std::span<std::uint32_t> hits) {
  std::ranges::fill(hits, base::kNoHit);
  std::ranges::fill(values, 0.0);
  for (std::size_t i = 0; i < values.size(); i += s.columns()) values[i] = s.range_max;
}

/// Flags surfaces nearer than the smallest depth. @param step numbers per pixel
void flag_near(double least, std::span<double> values, std::size_t step, std::span<base::QualityFlag> quality) {
  for (std::size_t k = 0; k < quality.size(); ++k)
    if (double& depth = values[k * step]; depth < least) depth = least, quality[k] = base::QualityFlag::too_near;
}

void Cameras::finish(std::size_t i, unsigned) {
  if (!scanner_of(i).plain) write_pixels(i);
  if (noise_ && settings_[samples()[i].row].depth_noise > 0.0) add_depth_noise(i);
  if (const double least = settings_[samples()[i].row].range_min; least > 0.0)
    flag_near(least, samples()[i].values, settings_[samples()[i].row].columns(), quality_of(i));
}

/// Writes the pixels of a camera that is not plain.
void Cameras::write_pixels(std::size_t i) {
  const HostSample& sample = samples()[i];
  const CameraSettings& s = settings_[sample.row];
  const scene::ScanOutput from = output_of(i);
  const auto hits = hits_of(i);
  const auto quality = quality_of(i);
  const std::size_t width = s.columns(), parts = s.samples;
  const std::vector<std::uint32_t>& cast = s.beams->cast;
  if (!cast.empty()) see_nothing(s, sample.values, hits);
  const bool plain = s.is_plain();
  const auto light = s.rgb && !plain ? parts_of(part_light_, i) : std::span<glm::vec3>();
  const auto colors = s.rgb && plain ? parts_of(part_colors_, i) : std::span<std::uint32_t>();
  const std::vector<glm::vec3> blurred = s.response.blur > 0.0 ? blurred_light(i) : std::vector<glm::vec3>();
  const auto light_of = [&](std::size_t c, std::size_t k) -> std::span<const glm::vec3> {
    if (blurred.empty()) return light.subspan(c * parts, parts);
    return {&blurred[k], 1};
  };
  for (std::size_t c = 0; c < from.ranges.size() / parts; ++c) {
    const std::size_t k = cast.empty() ? c : cast[c], first = c * parts;
    const std::span<double> pixel = sample.values.subspan(k * width, width);
    hits[k] = from.hits[first], quality[k] = from.quality[first];
    pixel[0] = from.ranges[first];
    if (width > 1) pixel[1] = !s.rgb ? 0.0 : plain ? colors[c] : color_of(i, k, light_of(c, k));
    const glm::vec3 normal = s.normals ? from.normals[first] : glm::vec3{};
    for (std::size_t axis = 0; axis + 2 < width; ++axis) pixel[2 + axis] = normal[static_cast<int>(axis)];
  }
}

/// Surfaces that noise moves beyond the largest depth are not seen.
void Cameras::add_depth_noise(std::size_t i) {
  const HostSample& sample = samples()[i];
  const CameraSettings& s = settings_[sample.row];
  const SensorSpec& row = rows()[sample.row];
  const base::RandomKey key =
      episodes().key(base::RandomStream::spatial_range, row.mover, kDepthNoiseId + row.sensor, sample.sequence);
  const auto hits = hits_of(i);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    if (hits[k] == base::kNoHit) continue;
    double& depth = sample.values[k * s.columns()];
    depth = std::max(0.0,
                     depth + s.depth_sigma(depth) * base::random_normal(key, static_cast<std::uint32_t>(k / 2))[k % 2]);
    if (depth < s.range_max) continue;
    depth = s.range_max, hits[k] = base::kNoHit;
  }
}

ParsedSensors parse_cameras(const world::World& world) {
  CameraReader reader;
  BeamBudget budget(world, "cameras", "pixels, 'samples',");
  const world::Daylight day = world::daylight_of(world);
  const bool sunny = day.elevation > 0.0 && day.sun > 0.0;
  return parse_each(world, camera_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    CameraSettings s = reader.read(sensor);
    row.mode = s.mode = mode_of("camera", kCameraModes, accuracy_of(sensor), world);
    budget.add(sensor, "resolution", s.beams->cast_directions().size());
    row.elements = s.width * s.height;
    row.width = static_cast<std::uint32_t>(s.columns());
    row.across = s.width;
    row.X_MS = planar_mount(s.X_MS);
    row.limit = s.range_max;
    row.range_min = s.range_min;
    row.sigma = s.depth_sigma(s.range_max);
    const double reach = s.range_max * stretch(s);
    if (!(s.rgb && sunny)) row.reach = reach;  // shadows come from anywhere
    // Else readings also depend on these, on earlier poses, or on noise in colours.
    const bool near = !(s.rgb && sunny) && s.beams->times.empty() && !s.response.is_noisy();
    row.dependency_radius = near ? reach : 0.0;
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

/// The noise of a depth grows with its square: no standard deviation is that of all.
double noise_of_camera(const ParsedSensors& sensors, std::size_t row, std::uint32_t offset) {
  return offset == 0 && sensors.settings_as<CameraSettings>()[row].depth_noise == 0.0 ? 0.0 : HUGE_VAL;
}

// Depths are sent as the ranges of lidars are, colours as a file (sensors/image_packets.h). Normals are not sent.

std::size_t width_of(const SensorSpec& sensor) { return sensor.width != 0 ? sensor.width : 5; }

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
  const std::uint16_t form = wire == WireFormat::farm ? camera_form(type, payload) : std::uint16_t{0};
  if (form > kJpegForm) return {.fault = PayloadError::out_of_range};
  if (form >= kPngForm) {
    ImagePart image;
    const PayloadError fault = read_image(payload, image);
    return {.fault = fault, .part = image.part, .parts = 0};
  }
  return decode_lidar(depth_spec(sensor), payload, lidar_form(type), wire);
}

void read(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
          std::span<double> values) {
  const std::size_t width = width_of(sensor);
  std::vector<double> depths = depths_of(values, width);
  fill_lidar(depth_spec(sensor), payload, lidar_form(type), wire, depths);
  for (std::size_t i = 0; i < depths.size(); ++i) values[i * width] = depths[i];
}

constexpr Column kColumns[] = {{"depth_m", 1, false, 9}, {"rgb", 1, true}, {"normal", 3}};
}  // namespace

constinit const SensorType camera_type{
    .id = kCamera,
    .name = "camera",
    .word = {"camera", kCameraKeys},
    .base_port = 15000,
    .list = "pixels",
    .columns = kColumns,
    .beams = beams_of_camera,
    .modes = kCameraModes,
    .bound = bound_of_camera,
    .noise = noise_of_camera,
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
