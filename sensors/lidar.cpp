#include "sensors/lidar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "base/random.h"
#include "raycast/casters.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"
#include "sensors/host_backend.h"
#include "sensors/laser.h"
#include "sensors/laser_packets.h"
#include "sensors/lidar_beams.h"
#include "sensors/settings.h"
#include "sensors/spatial_scene.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kTilesPerJob = 16;
constexpr std::size_t kMostBeamsInAll = 100'000'000;

/// Part of a scan, the work of one thread.
struct Job {
  std::size_t sample = 0;
  std::size_t first_tile = 0, end_tile = 0;
};

class Lidars : public HostBackend {
 public:
  Lidars(const SensorContext& context, const ParsedSensors& sensors);

  void place_movers() override;
  bool update_outlines(const world::World& world) override;
  bool prepare(std::span<const DueSample> due) override;
  void collect(std::span<base::ReadingBlock> out) override;
  SensorStats stats() const override;

 private:
  void measure_all() override;
  void cast(const Job& job, unsigned thread);
  void cast_reference(const base::RigidTransform& X_WS, std::span<const scene::BeamTile> tiles, const LidarSettings& s,
                      const scene::SceneView& view, const scene::ScanOutput& out) const;
  void finish(std::size_t sample);
  /// A sample's part of a table with one entry per beam of all lidars.
  template <class Value>
  std::span<Value> beams_of(std::vector<Value>& table, std::size_t sample) const {
    return std::span(table).subspan(first_value(samples()[sample].row), samples()[sample].values.size());
  }

  const std::vector<LidarSettings>& settings_;
  bool noise_;
  bool reference_;  ///< casts every beam against every face in `long double`
  SpatialScene scene_;
  std::vector<std::uint32_t> hits_;  ///< of all beams
  std::vector<base::QualityFlag> quality_;
  std::vector<scene::Rasterizer> rasterizers_;  ///< per thread
  std::vector<base::RigidTransform> X_WS_;      ///< per due sample
  std::vector<std::vector<scene::Instance>> instances_;
  std::vector<std::uint8_t> floor_;  ///< per due sample: the plane z = 0 is a surface
  std::vector<Job> jobs_;
  std::uint64_t rays_ = 0;
};

double longest_range(std::span<const LidarSettings> lidars) {
  double longest = 0.0;
  for (const LidarSettings& lidar : lidars) longest = std::max(longest, lidar.range_max);
  return longest;
}

Lidars::Lidars(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, lidar_type, sensors),
      settings_(sensors.settings_as<LidarSettings>()),
      noise_(context.noise),
      reference_(!raycast::choose_caster(context.device.info().software, context.scene.caster).same_bytes),
      scene_(context.world, longest_range(settings_)),
      rasterizers_(context.thread_pool.threads()) {
  hits_.resize(first_value(rows().size()));
  quality_.resize(hits_.size());
}

void Lidars::place_movers() { scene_.place(states()); }

bool Lidars::update_outlines(const world::World& world) {
  scene_.update_movers(world);
  return true;
}

bool Lidars::prepare(std::span<const DueSample> due) {
  const bool again = HostBackend::prepare(due);
  jobs_.clear();
  X_WS_.resize(due.size());
  instances_.resize(std::max(instances_.size(), due.size()));
  floor_.resize(due.size());
  const bool whole = due.size() >= 8 * rasterizers_.size();  // enough work for all threads without dividing scans
  for (std::size_t i = 0; i < due.size(); ++i) {
    const LidarSettings& s = settings_[due[i].row];
    X_WS_[i] = base::compose(scene_.X_WM(rows()[due[i].row].mover), s.X_MS);
    floor_[i] = scene_.list(rows()[due[i].row].mover, X_WS_[i].p, s.range_max, instances_[i]);
    const std::size_t tiles = s.beams->pattern.size(), size = whole ? tiles : kTilesPerJob;
    for (std::size_t first = 0; first < tiles; first += size)
      jobs_.push_back({i, first, std::min(tiles, first + size)});
  }
  return again;
}

void Lidars::cast(const Job& job, unsigned thread) {
  const HostSample& sample = samples()[job.sample];
  const LidarSettings& s = settings_[sample.row];
  const auto tiles = std::span(s.beams->pattern).subspan(job.first_tile, job.end_tile - job.first_tile);
  const scene::ScanOutput out{sample.values, beams_of(hits_, job.sample), beams_of(quality_, job.sample)};
  const scene::SceneView view{instances_[job.sample], floor_[job.sample] != 0};
  if (reference_) return cast_reference(X_WS_[job.sample], tiles, s, view, out);
  rasterizers_[thread].scan(X_WS_[job.sample], tiles, s.range_max, view, out);
}

void Lidars::cast_reference(const base::RigidTransform& X_WS, std::span<const scene::BeamTile> tiles,
                            const LidarSettings& s, const scene::SceneView& view, const scene::ScanOutput& out) const {
  for (const scene::BeamTile& tile : tiles)
    for (const std::uint32_t i : tile.place) {
      const auto hit = scene::reference_scan(X_WS, s.beams->directions[i], s.range_max, view);
      out.ranges[i] = static_cast<double>(hit.range);
      out.hits[i] = hit.owner;
    }
}

/// Adds noise to hits, and flags surfaces nearer than the smallest range.
void Lidars::finish(std::size_t i) {
  const HostSample& sample = samples()[i];
  const LidarSettings& s = settings_[sample.row];
  const SensorSpec& row = rows()[sample.row];
  const bool noisy = noise_ && row.sigma > 0.0;
  if (!noisy && s.range_min == 0.0) return;
  const base::RandomKey key = episodes().key(base::RandomStream::spatial_range, row.mover, row.sensor, sample.sequence);
  const auto hits = beams_of(hits_, i);
  const auto quality = beams_of(quality_, i);
  for (std::size_t k = 0; k < sample.values.size(); ++k) {
    double& range = sample.values[k];
    if (hits[k] == base::kNoHit) continue;
    if (range < s.range_min) quality[k] = base::QualityFlag::too_near;
    range = std::max(range, s.range_min);
    if (!noisy) continue;
    const double sigma = base::hypot(s.range_sigma, s.range_proportional * range);
    const auto pair = base::random_normal(key, static_cast<std::uint32_t>(k / 2));
    range = std::clamp(range + sigma * pair[k % 2], s.range_min, s.range_max);
    if (!(range < s.range_max)) hits[k] = base::kNoHit;
  }
}

void Lidars::measure_all() {
  for (std::size_t i = 0; i < samples().size(); ++i) std::ranges::fill(beams_of(quality_, i), base::QualityFlag::none);
  thread_pool().parallel_for_each(jobs_.size(), 1, [&](std::size_t i, unsigned thread) { cast(jobs_[i], thread); });
  thread_pool().parallel_for_each(samples().size(), 1, [&](std::size_t i, unsigned) { finish(i); });
}

void Lidars::collect(std::span<base::ReadingBlock> out) {
  HostBackend::collect(out);
  for (std::size_t i = 0; i < samples().size(); ++i) {
    const auto quality = beams_of(quality_, i);
    rays_ += quality.size();
    out[i].hits = beams_of(hits_, i);
    const auto is_flagged = [](base::QualityFlag flag) { return flag != base::QualityFlag::none; };
    if (std::ranges::any_of(quality, is_flagged)) out[i].quality = quality;
    out[i].bound = out[i].bound_without_noise = scene::kRangeError;
  }
}

SensorStats Lidars::stats() const {
  SensorStats sum{.rays = rays_};
  for (const scene::Rasterizer& rasterizer : rasterizers_) sum.uncertain += rasterizer.counts().uncertain;
  return sum;
}

ParsedSensors parse_lidars(const world::World& world) {
  LidarReader reader;
  std::size_t beams = 0;
  return parse_each(world, lidar_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    LidarSettings s = reader.read(sensor);
    row.elements = static_cast<std::uint32_t>(s.beams->directions.size());
    beams += row.elements;
    if (beams > kMostBeamsInAll)
      refuse(
          sensor, "columns",
          fmt::format("the world's lidars have more than {} beams in all; give fewer 'columns', 'channels', or robots",
                      kMostBeamsInAll));
    row.X_MS = {s.X_MS.p.x, s.X_MS.p.y, s.X_MS.p.z, base::atan2(s.X_MS.R[0].y, s.X_MS.R[0].x)};
    row.limit = row.dependency_radius = row.reach = s.range_max;
    row.range_min = s.range_min;
    row.sigma = base::hypot(s.range_sigma, s.range_proportional * s.range_max);
    return s;
  });
}

SpatialBeams beams_of_lidar(const ParsedSensors& sensors, std::size_t row) {
  const LidarSettings& s = sensors.settings_as<LidarSettings>()[row];
  return {s.X_MS, s.beams->directions};
}

ErrorBound bound_of_lidar(const world::World&, const ParsedSensors&, std::size_t) { return {scene::kRangeError, ""}; }

// Payloads are those of lasers, with this type's id.

std::uint8_t laser_form(std::uint8_t type) { return static_cast<std::uint8_t>(type - kLidar + kLaser); }

std::uint8_t encode(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire, std::uint32_t part,
                    base::Bytes& out) {
  const std::uint8_t type = encode_laser(sensor, reading, wire, part, out);
  return type == 0 ? 0 : static_cast<std::uint8_t>(type - kLaser + kLidar);
}

PayloadPart decode(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                   WireFormat wire) {
  return decode_laser(sensor, payload, laser_form(type), wire);
}

void read_payload(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                  std::span<double> values) {
  fill_laser(sensor, payload, laser_form(type), wire, values);
}

constexpr Column kColumns[] = {{"range_m", 1, false, 9}};

}  // namespace

constinit const SensorType lidar_type{
    .id = kLidar,
    .name = "lidar",
    .word = {"lidar", kLidarKeys},
    .base_port = 14000,
    .list = "beams",
    .columns = kColumns,
    .beams = beams_of_lidar,
    .bound = bound_of_lidar,
    .parse = parse_lidars,
    .make = make_backend<Lidars>,
    .wire_problem = laser_wire_problem,
    .parts = laser_parts,
    .encode = encode,
    .wire_error = laser_wire_error,
    .decode = decode,
    .read = read_payload,
};

}  // namespace sf::sensors
