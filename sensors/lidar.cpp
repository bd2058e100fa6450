#include "sensors/lidar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/elementary.h"
#include "base/random.h"
#include "scene/rasterizer.h"
#include "sensors/lidar_beams.h"
#include "sensors/lidar_echoes.h"
#include "sensors/lidar_modes.h"
#include "sensors/lidar_packets.h"
#include "sensors/road_paint.h"
#include "sensors/settings.h"
#include "sensors/spatial_scans.h"

namespace sf::sensors {

namespace {

class Lidars : public SpatialScans {
 public:
  Lidars(const SensorContext& context, const ParsedSensors& sensors);

  void collect(std::span<base::ReadingBlock> out) override;

 private:
  void follow(std::size_t sample, const base::RigidTransform& X_WS, const scene::BeamTile& tile,
              const scene::TileSurfaces& surfaces, unsigned thread) override;
  void finish(std::size_t sample, unsigned thread) override;
  void add_noise(std::size_t sample);
  void find_echoes(std::size_t sample, unsigned thread);

  const std::vector<LidarSettings>& settings_;
  bool noise_;
  Reflectances reflectances_;
  std::optional<RoadPaint> paint_;             ///< nullopt: no lidar depends on it
  std::vector<std::uint32_t> part_materials_;  ///< of lidars that do, with Reflectances::kPaint
  std::vector<EchoFinder> finders_;            ///< per thread
};

bool is_coarse(const LidarSettings& s) { return kLidarAngles[s.mode] > 0.0; }

/// A mixed pixel has no true range, and a simplified mesh none that is bounded along a beam.
double range_error(const LidarSettings& s) {
  if (s.beams->parts > 1 || is_coarse(s)) return HUGE_VAL;
  return kLidarSingle[s.mode] ? scene::kSingleRangeError : scene::kRangeError;
}

/// True if a lidar reports what its beams meet.
bool is_plain(const LidarSettings& s) {
  return s.beams->parts == 1 && s.echo.width == 1 && s.echo.detection_range == 0.0 && s.echo.slope == 0.0 &&
         s.echo.dropout == 0.0;
}

/// True if a reading depends on the power of echoes.
bool has_powers(const LidarSettings& s) {
  return s.echo.width > 1 || s.beams->parts > 1 || s.echo.detection_range > 0.0;
}

std::vector<SpatialScanner> scanners_of(const world::World& world, const std::vector<LidarSettings>& lidars) {
  std::vector<SpatialScanner> scanners;
  for (const LidarSettings& s : lidars)
    scanners.push_back({.X_MS = s.X_MS,
                        .range_max = s.echo.range_max,
                        .angle = kLidarAngles[s.mode],
                        .beams = s.beams,
                        .plain = is_plain(s),
                        .cosines = !is_plain(s),
                        .materials = has_powers(s),
                        .follows = has_powers(s) && !world.lane_markings.empty(),
                        .single = kLidarSingle[s.mode]});
  return scanners;
}

Lidars::Lidars(const SensorContext& context, const ParsedSensors& sensors)
    : SpatialScans(context, lidar_type, sensors, scanners_of(context.world, sensors.settings_as<LidarSettings>())),
      settings_(sensors.settings_as<LidarSettings>()),
      noise_(context.noise),
      reflectances_(context.world, materials()),
      finders_(context.thread_pool.threads()) {
  if (context.world.lane_markings.empty() || std::ranges::none_of(settings_, has_powers)) return;
  paint_.emplace(context.world);
  part_materials_.resize(parts());
}

/// Keeps the materials that a tile's beams meet, and paint where they meet the ground.
void Lidars::follow(std::size_t i, const base::RigidTransform& X_WS, const scene::BeamTile& tile,
                    const scene::TileSurfaces& surfaces, unsigned) {
  const auto out = parts_of(part_materials_, i);
  for (std::uint32_t k = 0; k < tile.used * scene::kWidth; ++k) {
    const glm::dvec3 beam = surfaces.ranges[k] * glm::dvec3(tile.dx[k], tile.dy[k], tile.dz[k]);
    const bool painted =
        surfaces.hits[k] == base::kFloorHit && paint_->color_at(base::transform(X_WS, beam)) != nullptr;
    out[tile.place[k]] = painted ? Reflectances::kPaint : surfaces.materials[k];
  }
}

void Lidars::finish(std::size_t i, unsigned thread) {
  scanner_of(i).plain ? add_noise(i) : find_echoes(i, thread);
  const HostSample& sample = samples()[i];
  const LidarSettings& s = settings_[sample.row];
  if (!s.beams->cast.empty())
    interpolate_columns(*s.beams, s.echo.range_max, {sample.values, s.echo.width, hits_of(i), quality_of(i)});
}

/// Adds noise to hits, and flags surfaces nearer than the smallest range.
void Lidars::add_noise(std::size_t i) {
  const HostSample& sample = samples()[i];
  const EchoSettings& s = settings_[sample.row].echo;
  const SensorSpec& row = rows()[sample.row];
  const bool noisy = noise_ && s.is_noisy();
  if (!noisy && s.range_min == 0.0) return;
  const base::RandomKey key = episodes().key(base::RandomStream::spatial_range, row.mover, row.sensor, sample.sequence);
  const auto hits = hits_of(i);
  const auto quality = quality_of(i);
  const std::vector<std::uint32_t>& cast = settings_[sample.row].beams->cast;
  const std::size_t count = cast.empty() ? sample.values.size() : cast.size();
  for (std::size_t c = 0; c < count; ++c) {
    const std::size_t k = cast.empty() ? c : cast[c];
    double& range = sample.values[k];
    if (hits[k] == base::kNoHit) continue;
    if (range < s.range_min) quality[k] = base::QualityFlag::too_near;
    range = std::max(range, s.range_min);
    if (!noisy) continue;
    const auto pair = base::random_normal(key, static_cast<std::uint32_t>(k / 2));
    range = noisy_range(s, {.range = range}, pair[k % 2]);
    if (!(range < s.range_max)) hits[k] = base::kNoHit;
  }
}

/// Writes the echoes of a scan's beams.
void Lidars::find_echoes(std::size_t i, unsigned thread) {
  const HostSample& sample = samples()[i];
  const LidarSettings& s = settings_[sample.row];
  const SensorSpec& row = rows()[sample.row];
  const auto key = [&](base::RandomStream stream) {
    return episodes().key(stream, row.mover, row.sensor, sample.sequence);
  };
  const base::RandomKey first = key(base::RandomStream::spatial_range),
                        second = key(base::RandomStream::spatial_second),
                        drop = key(base::RandomStream::spatial_dropout);
  const std::size_t parts = s.beams->parts;
  const scene::ScanOutput from = output_of(i);
  const auto hits = hits_of(i);
  const auto quality = quality_of(i);
  const auto materials = scanner_of(i).follows ? parts_of(part_materials_, i) : from.materials;
  const std::vector<std::uint32_t>& cast = s.beams->cast;
  for (std::uint32_t c = 0; c < s.beams->cast_directions().size() / parts; ++c) {
    const std::uint32_t k = cast.empty() ? c : cast[c];
    const std::size_t at = s.beams->in_place ? k : c * parts;
    BeamParts beam{from.ranges.subspan(at, parts), from.cosines.subspan(at, parts), from.hits.subspan(at, parts),
                   from.quality.subspan(at, parts)};
    if (!materials.empty()) beam.materials = materials.subspan(at, parts);
    EchoFinder::Echoes echoes = finders_[thread].find(s.echo, beam, reflectances_);
    if (noise_ && s.echo.dropout > 0.0 && base::random_uniform(drop, k)[0] < s.echo.dropout) echoes = {};
    for (std::size_t e = 0; e < echoes.size(); ++e) {
      auto& echo = echoes[e];
      if (!echo) continue;
      if (echo->range < s.echo.range_min) echo->quality = base::QualityFlag::too_near;
      echo->range = std::max(echo->range, s.echo.range_min);
      if (noise_) echo->range = noisy_range(s.echo, *echo, base::random_normal(e == 0 ? first : second, k / 2)[k % 2]);
      if (!(echo->range < s.echo.range_max)) echo.reset();
    }
    write_echoes(s.echo, echoes, sample.values.subspan(k * s.echo.width, s.echo.width));
    hits[k] = echoes[0] ? echoes[0]->hit : base::kNoHit;
    quality[k] = echoes[0] ? echoes[0]->quality : base::QualityFlag::none;
  }
}

void Lidars::collect(std::span<base::ReadingBlock> out) {
  SpatialScans::collect(out);
  for (std::size_t i = 0; i < samples().size(); ++i)
    out[i].bound = out[i].bound_without_noise = range_error(settings_[samples()[i].row]);
}

ParsedSensors parse_lidars(const world::World& world) {
  LidarReader reader;
  BeamBudget budget(world, "lidars", "'columns', 'channels',");
  return parse_each(world, lidar_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    LidarSettings s = reader.read(world, sensor);
    const EchoSettings& echo = s.echo;
    row.elements = static_cast<std::uint32_t>(s.beams->directions.size());
    row.width = echo.width;
    row.mode = s.mode;
    budget.add(sensor, "columns", s.beams->cast_directions().size());
    row.X_MS = planar_mount(s.X_MS);
    row.limit = row.reach = echo.range_max;
    row.dependency_radius = s.beams->times.empty() ? echo.range_max : 0.0;  // else also on earlier poses
    row.sweep = 1e-9 * static_cast<double>(s.beams->duration());
    row.range_min = echo.range_min;
    row.sigma = echo.dropout > 0.0 || (echo.is_noisy() && s.beams->parts > 1)
                    ? HUGE_VAL
                    : base::hypot(echo.sigma, echo.proportional * echo.range_max, 10.0 * echo.slope);
    return s;
  });
}

SpatialBeams beams_of_lidar(const ParsedSensors& sensors, std::size_t row) {
  const LidarSettings& s = sensors.settings_as<LidarSettings>()[row];
  return {s.X_MS, s.beams->directions, s.beams->times};
}

ErrorBound bound_of_lidar(const world::World&, const ParsedSensors& sensors, std::size_t row) {
  const LidarSettings& s = sensors.settings_as<LidarSettings>()[row];
  return {range_error(s), is_coarse(s)         ? "none for simplified meshes"
                          : s.beams->parts > 1 ? "none for beams with a divergence"
                                               : ""};
}

constexpr Column kColumns[] = {
    {"range_m", 1, false, 9}, {"intensity"}, {"incidence_rad"}, {"second_range_m", 1, false, 9}, {"second_intensity"}};

}  // namespace

constinit const SensorType lidar_type{
    .id = kLidar,
    .name = "lidar",
    .word = {.type = "lidar", .keys = kLidarKeys, .table_key = "directions"},
    .base_port = 14000,
    .list = "beams",
    .columns = kColumns,
    .beams = beams_of_lidar,
    .modes = kLidarModes,
    .bound = bound_of_lidar,
    .parse = parse_lidars,
    .make = make_backend<Lidars>,
    .wire_problem = lidar_wire_problem,
    .parts = lidar_parts,
    .encode = encode_lidar,
    .wire_error = lidar_wire_error,
    .decode = decode_lidar,
    .read = fill_lidar,
};

}  // namespace sf::sensors
