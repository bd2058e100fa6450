#include "sensors/lidar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "base/random.h"
#include "base/time.h"
#include "raycast/casters.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"
#include "sensors/carrier_trail.h"
#include "sensors/host_backend.h"
#include "sensors/laser_packets.h"
#include "sensors/lidar_beams.h"
#include "sensors/lidar_echoes.h"
#include "sensors/lidar_modes.h"
#include "sensors/lidar_packets.h"
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

  void accumulate(std::int64_t now, bool between) override;
  void place_movers() override;
  bool update_outlines(const world::World& world) override;
  bool prepare(std::span<const DueSample> due) override;
  void collect(std::span<base::ReadingBlock> out) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  void restart(std::uint32_t row, std::int64_t now) override;
  SensorStats stats() const override;

 private:
  void measure_all() override;
  void cast(const Job& job, unsigned thread);
  void cast_tiles(const base::RigidTransform& X_WS, std::span<const scene::BeamTile> tiles, const Job& job,
                  unsigned thread);
  void finish(std::size_t sample, unsigned thread);
  void add_noise(std::size_t sample);
  void find_echoes(std::size_t sample, unsigned thread);
  base::Report state_of(std::size_t row) const;
  /// True if the carrier is where the last tick or sample left it, not at a pose of a single reading.
  bool moves_on(std::size_t row) const;
  /// A sample's part of a table with one entry per beam.
  template <class Value>
  std::span<Value> beams_of(std::vector<Value>& table, std::size_t sample) const {
    const std::size_t row = samples()[sample].row;
    return std::span(table).subspan(first_beam_[row], first_beam_[row + 1] - first_beam_[row]);
  }
  /// A sample's part of a table with one entry per part of the cast beams.
  template <class Value>
  std::span<Value> parts_of(std::vector<Value>& table, std::size_t sample) const {
    const std::size_t row = samples()[sample].row;
    return std::span(table).subspan(first_part_[row], first_part_[row + 1] - first_part_[row]);
  }
  scene::ScanOutput output_of(std::size_t sample);

  const std::vector<LidarSettings>& settings_;
  bool noise_;
  bool reference_;  ///< casts every beam against every face in `long double`
  SpatialScene scene_;
  Reflectances reflectances_;
  std::vector<std::uint8_t> plain_;  ///< per row: beams report what they meet, into the reading itself
  std::vector<std::uint32_t> hits_;  ///< of all beams
  std::vector<base::QualityFlag> quality_;
  std::vector<std::size_t> first_beam_;  ///< per row, plus one: index of its first beam in these tables
  // Of the parts of the cast beams of lidars that are not plain.
  std::vector<double> part_ranges_;  ///< [m]
  std::vector<float> part_cosines_;
  std::vector<std::uint32_t> part_hits_;
  std::vector<base::QualityFlag> part_quality_;
  std::vector<std::size_t> first_part_;         ///< per row, plus one
  std::vector<scene::Rasterizer> rasterizers_;  ///< per thread
  std::vector<EchoFinder> finders_;             ///< per thread
  std::vector<CarrierTrail> trails_;            ///< per row; empty: no scan is rolling
  std::vector<base::Report> last_;              ///< per row, in the last tick or sample, if a scan is rolling
  std::int64_t now_ = 0;
  std::vector<base::RigidTransform> X_WS_;  ///< per due sample
  std::vector<std::vector<scene::Instance>> instances_;
  std::vector<std::uint8_t> floor_;  ///< per due sample: the plane z = 0 is a surface
  std::vector<Job> jobs_;
  std::uint64_t rays_ = 0;
};

bool is_coarse(const LidarSettings& s) { return kLidarAngles[s.mode] > 0.0; }

/// A mixed pixel has no true range, and a simplified mesh none that is bounded along a beam.
double range_error(const LidarSettings& s) {
  return s.beams->parts == 1 && !is_coarse(s) ? scene::kRangeError : HUGE_VAL;
}

double longest_range(std::span<const LidarSettings> lidars) {
  double longest = 0.0;
  for (const LidarSettings& lidar : lidars) longest = std::max(longest, lidar.echo.range_max);
  return longest;
}

bool is_plain(const LidarSettings& s) {
  return s.beams->parts == 1 && s.beams->cast.empty() && s.echo.width == 1 && s.echo.detection_range == 0.0 &&
         s.echo.slope == 0.0 && s.echo.dropout == 0.0;
}

/// [ns] since the first beam of a rolling scan.
std::int64_t duration_of(const LidarBeams& beams) {
  return beams.times.empty() ? 0 : base::nanoseconds(-std::ranges::min(beams.times));
}

Lidars::Lidars(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, lidar_type, sensors),
      settings_(sensors.settings_as<LidarSettings>()),
      noise_(context.noise),
      reference_(!raycast::choose_caster(context.device.info().software, context.scene.caster).same_bytes),
      scene_(context.world, longest_range(settings_), std::ranges::any_of(settings_, is_coarse)),
      reflectances_(context.world),
      first_beam_(1, 0),
      first_part_(1, 0),
      rasterizers_(context.thread_pool.threads()),
      finders_(context.thread_pool.threads()) {
  for (const LidarSettings& s : settings_) {
    plain_.push_back(is_plain(s));
    first_beam_.push_back(first_beam_.back() + s.beams->directions.size());
    first_part_.push_back(first_part_.back() + (plain_.back() ? 0 : s.beams->cast_directions().size()));
  }
  hits_.resize(first_beam_.back()), quality_.resize(first_beam_.back());
  const std::size_t parts = first_part_.back();
  part_ranges_.resize(parts), part_cosines_.resize(parts), part_hits_.resize(parts), part_quality_.resize(parts);
  if (std::ranges::all_of(settings_, [](const LidarSettings& s) { return s.beams->times.empty(); })) return;
  for (std::size_t row = 0; row < settings_.size(); ++row)
    trails_.emplace_back(duration_of(*settings_[row].beams), context.world.movers[rows()[row].mover].max_forward);
  last_.resize(trails_.size());
}

base::Report Lidars::state_of(std::size_t row) const {
  base::Report state = states()[rows()[row].mover];
  state.time = now_;
  return state;
}

bool Lidars::moves_on(std::size_t row) const { return is_same_place(states()[rows()[row].mover], last_[row]); }

void Lidars::accumulate(std::int64_t now, bool between) {
  now_ = now;
  for (std::size_t row = 0; row < trails_.size(); ++row) {
    last_[row] = state_of(row);
    if (!between && !settings_[row].beams->times.empty()) trails_[row].add(last_[row]);
  }
}

void Lidars::write_state(std::uint32_t row, base::ByteWriter& out) const {
  if (!trails_.empty()) trails_[row].write(out);
}

void Lidars::read_state(std::uint32_t row, base::ByteReader& in) {
  if (!trails_.empty()) trails_[row].read(in);
}

void Lidars::restart(std::uint32_t row, std::int64_t now) {
  now_ = now;
  if (trails_.empty()) return;
  trails_[row].clear();
  last_[row] = state_of(row);
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
    const std::uint32_t row = due[i].row, mover = rows()[row].mover;
    const LidarSettings& s = settings_[row];
    X_WS_[i] = base::compose(scene_.X_WM(mover), s.X_MS);
    double reach = s.echo.range_max;
    if (!trails_.empty() && moves_on(row)) reach += trails_[row].reach(state_of(row)) + 2.0 * glm::length(s.X_MS.p);
    floor_[i] = scene_.list(mover, X_WS_[i].p, reach, instances_[i], kLidarAngles[s.mode]);
    const std::size_t tiles = s.beams->pattern.size(), size = whole ? tiles : kTilesPerJob;
    for (std::size_t first = 0; first < tiles; first += size)
      jobs_.push_back({i, first, std::min(tiles, first + size)});
  }
  return again;
}

void Lidars::cast(const Job& job, unsigned thread) {
  const std::uint32_t row = samples()[job.sample].row;
  const LidarBeams& beams = *settings_[row].beams;
  const auto tiles = std::span(beams.pattern).subspan(job.first_tile, job.end_tile - job.first_tile);
  const base::Report now = state_of(row);
  if (beams.times.empty() || !moves_on(row) || trails_[row].at_rest(now))
    return cast_tiles(X_WS_[job.sample], tiles, job, thread);
  for (const scene::BeamTile& tile : tiles) {
    const base::Report state = trails_[row].at(now_ + base::nanoseconds(tile.time), now);
    const auto X_WS = base::compose(base::transform_of(state.X_WM, state.tilt), settings_[row].X_MS);
    cast_tiles(X_WS, std::span(&tile, 1), job, thread);
  }
}

scene::ScanOutput Lidars::output_of(std::size_t i) {
  const HostSample& sample = samples()[i];
  if (plain_[sample.row]) return {sample.values, beams_of(hits_, i), beams_of(quality_, i)};
  return {parts_of(part_ranges_, i), parts_of(part_hits_, i), parts_of(part_quality_, i), parts_of(part_cosines_, i)};
}

void Lidars::cast_tiles(const base::RigidTransform& X_WS, std::span<const scene::BeamTile> tiles, const Job& job,
                        unsigned thread) {
  const std::uint32_t row = samples()[job.sample].row;
  const LidarSettings& s = settings_[row];
  const scene::ScanOutput out = output_of(job.sample);
  const scene::SceneView view{instances_[job.sample], floor_[job.sample] != 0};
  if (!reference_) {
    rasterizers_[thread].scan(X_WS, tiles, s.echo.range_max, view, out);
    return;
  }
  for (const scene::BeamTile& tile : tiles)
    for (const std::uint32_t i : std::span(tile.place).first(tile.used * scene::kWidth)) {
      const auto hit = scene::reference_scan(X_WS, s.beams->cast_directions()[i], s.echo.range_max, view);
      out.ranges[i] = static_cast<double>(hit.range);
      out.hits[i] = hit.owner;
      if (!out.cosines.empty()) out.cosines[i] = static_cast<float>(hit.cosine);
    }
}

void Lidars::finish(std::size_t i, unsigned thread) {
  plain_[samples()[i].row] ? add_noise(i) : find_echoes(i, thread);
}

/// Adds noise to hits, and flags surfaces nearer than the smallest range.
void Lidars::add_noise(std::size_t i) {
  const HostSample& sample = samples()[i];
  const EchoSettings& s = settings_[sample.row].echo;
  const SensorSpec& row = rows()[sample.row];
  const bool noisy = noise_ && s.is_noisy();
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
  const auto hits = beams_of(hits_, i);
  const auto quality = beams_of(quality_, i);
  const std::vector<std::uint32_t>& cast = s.beams->cast;
  for (std::uint32_t c = 0; c < s.beams->cast_directions().size() / parts; ++c) {
    const std::uint32_t k = cast.empty() ? c : cast[c];
    const std::size_t at = c * parts;
    EchoFinder::Echoes echoes = finders_[thread].find(s.echo,
                                                      {from.ranges.subspan(at, parts), from.cosines.subspan(at, parts),
                                                       from.hits.subspan(at, parts), from.quality.subspan(at, parts)},
                                                      reflectances_);
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
  if (!cast.empty()) interpolate_columns(*s.beams, s.echo.range_max, {sample.values, s.echo.width, hits, quality});
}

void Lidars::measure_all() {
  for (std::size_t i = 0; i < samples().size(); ++i) std::ranges::fill(output_of(i).quality, base::QualityFlag::none);
  thread_pool().parallel_for_each(jobs_.size(), 1, [&](std::size_t i, unsigned thread) { cast(jobs_[i], thread); });
  thread_pool().parallel_for_each(samples().size(), 1, [&](std::size_t i, unsigned thread) { finish(i, thread); });
}

void Lidars::collect(std::span<base::ReadingBlock> out) {
  HostBackend::collect(out);
  for (std::size_t i = 0; i < samples().size(); ++i) {
    const auto quality = beams_of(quality_, i);
    rays_ += settings_[samples()[i].row].beams->cast_directions().size();
    out[i].mode = settings_[samples()[i].row].mode;
    out[i].hits = beams_of(hits_, i);
    const auto is_flagged = [](base::QualityFlag flag) { return flag != base::QualityFlag::none; };
    if (std::ranges::any_of(quality, is_flagged)) out[i].quality = quality;
    out[i].bound = out[i].bound_without_noise = range_error(settings_[samples()[i].row]);
  }
}

SensorStats Lidars::stats() const {
  SensorStats sum{.rays = rays_};
  for (const scene::Rasterizer& rasterizer : rasterizers_) sum.uncertain += rasterizer.counts().uncertain;
  return sum;
}

ParsedSensors parse_lidars(const world::World& world) {
  LidarReader reader;
  std::size_t parts = 0;
  return parse_each(world, lidar_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    LidarSettings s = reader.read(world, sensor);
    const EchoSettings& echo = s.echo;
    row.elements = static_cast<std::uint32_t>(s.beams->directions.size());
    row.width = echo.width;
    row.mode = s.mode;
    parts += s.beams->cast_directions().size();
    if (parts > kMostBeamsInAll)
      refuse(
          sensor, "columns",
          fmt::format("the world's lidars have more than {} beams in all; give fewer 'columns', 'channels', or robots",
                      kMostBeamsInAll));
    row.X_MS = {s.X_MS.p.x, s.X_MS.p.y, s.X_MS.p.z, base::atan2(s.X_MS.R[0].y, s.X_MS.R[0].x)};
    row.limit = row.reach = echo.range_max;
    row.dependency_radius = s.beams->times.empty() ? echo.range_max : 0.0;  // else also on earlier poses
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
    .word = {"lidar", kLidarKeys},
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
