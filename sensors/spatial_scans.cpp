#include "sensors/spatial_scans.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/time.h"
#include "raycast/casters.h"
#include "scene/reference_scan.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kTilesPerJob = 16;

double longest_range(std::span<const SpatialScanner> scanners) {
  double longest = 0.0;
  for (const SpatialScanner& scanner : scanners) longest = std::max(longest, scanner.range_max);
  return longest;
}

SceneExtras extras_of(std::span<const SpatialScanner> scanners) {
  SceneExtras extras;
  for (const SpatialScanner& s : scanners)
    extras.coarse = extras.coarse || s.angle > 0.0, extras.materials = extras.materials || s.materials;
  return extras;
}

/// [ns] since the first beam of a rolling scan.
std::int64_t duration_of(const LidarBeams& beams) {
  return beams.times.empty() ? 0 : base::nanoseconds(-std::ranges::min(beams.times));
}

}  // namespace

SpatialScans::SpatialScans(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors,
                           std::vector<SpatialScanner> scanners)
    : HostBackend(context, type, sensors),
      scanners_(std::move(scanners)),
      reference_(!raycast::choose_caster(context.device.info().software, context.scene.caster).same_bytes),
      scene_(context.world, longest_range(scanners_), extras_of(scanners_)),
      first_beam_(1, 0),
      first_part_(1, 0),
      rasterizers_(context.thread_pool.threads()) {
  bool normals = false, rolling = false;
  for (const SpatialScanner& s : scanners_) {
    first_beam_.push_back(first_beam_.back() + s.beams->directions.size());
    first_part_.push_back(first_part_.back() + (s.plain ? 0 : s.beams->cast_directions().size()));
    normals = normals || s.normals, rolling = rolling || !s.beams->times.empty();
  }
  hits_.resize(first_beam_.back()), quality_.resize(first_beam_.back());
  const std::size_t parts = first_part_.back();
  part_ranges_.resize(parts), part_cosines_.resize(parts), part_hits_.resize(parts), part_quality_.resize(parts);
  if (normals) part_normals_.resize(parts);
  if (!materials().empty()) part_materials_.resize(parts);
  for (std::size_t row = 0; rolling && row < scanners_.size(); ++row)
    trails_.emplace_back(duration_of(*scanners_[row].beams), context.world.movers[rows()[row].mover].max_forward);
  last_.resize(trails_.size());
  if (raycast::choose_caster(context.device.info().software, context.scene.caster).on_device)
    device_.emplace(context.device);
}

base::Report SpatialScans::state_of(std::size_t row) const {
  base::Report state = states()[rows()[row].mover];
  state.time = now_;
  return state;
}

void SpatialScans::accumulate(std::int64_t now, bool between) {
  now_ = now;
  for (std::size_t row = 0; row < trails_.size(); ++row) {
    last_[row] = state_of(row);
    if (!between && !scanners_[row].beams->times.empty()) trails_[row].add(last_[row]);
  }
}

void SpatialScans::write_state(std::uint32_t row, base::ByteWriter& out) const {
  if (!trails_.empty()) trails_[row].write(out);
}

void SpatialScans::read_state(std::uint32_t row, base::ByteReader& in) {
  if (!trails_.empty()) trails_[row].read(in);
}

void SpatialScans::restart(std::uint32_t row, std::int64_t now) {
  now_ = now;
  if (trails_.empty()) return;
  trails_[row].clear();
  last_[row] = state_of(row);
}

bool SpatialScans::update_outlines(const world::World& world) {
  scene_.update_movers(world);
  if (device_) device_->forget();
  return true;
}

bool SpatialScans::prepare(std::span<const DueSample> due) {
  bool again = HostBackend::prepare(due);
  jobs_.clear();
  if (device_) device_->begin();
  on_device_.assign(due.size(), std::nullopt);
  X_WS_.resize(due.size());
  instances_.resize(std::max(instances_.size(), due.size()));
  floor_.resize(due.size());
  const bool whole = due.size() >= 8 * rasterizers_.size();  // enough work for all threads without dividing scans
  for (std::size_t i = 0; i < due.size(); ++i) {
    const std::uint32_t row = due[i].row, mover = rows()[row].mover;
    const SpatialScanner& s = scanners_[row];
    X_WS_[i] = base::compose(scene_.X_WM(mover), s.X_MS);
    double reach = s.range_max;
    if (!trails_.empty() && moves_on(row)) reach += trails_[row].reach(state_of(row)) + 2.0 * glm::length(s.X_MS.p);
    floor_[i] = scene_.list(mover, X_WS_[i].p, reach, instances_[i], s.angle);
    if (device_ && !moves(row)) {
      const scene::SceneView view{instances_[i], floor_[i] != 0, scene_.terrain()};
      on_device_[i] = device_->add(X_WS_[i], s.beams->pattern, s.range_max, view);
    }
    if (device_ && !on_device_[i]) ++host_scans_;
    const std::size_t tiles = s.beams->pattern.size(), size = whole ? tiles : kTilesPerJob;
    for (std::size_t first = 0; first < tiles; first += size)
      jobs_.push_back({i, first, std::min(tiles, first + size)});
  }
  if (device_) again = device_->prepare() || again;
  return again;
}

void SpatialScans::record_measure(gpu::Batch& batch) {
  if (device_) device_->record(batch);
}

void SpatialScans::add_copies(gpu::Batch& batch) {
  if (device_) device_->add_copies(batch);
}

bool SpatialScans::moves(std::size_t row) const {
  return !trails_.empty() && !scanners_[row].beams->times.empty() && moves_on(row) &&
         !trails_[row].at_rest(state_of(row));
}

std::span<const scene::CastBeam> SpatialScans::cast_beams_of(const Job& job) {
  const std::optional<std::size_t> first = on_device_[job.sample];
  if (!first) return {};
  return device_->results(*first + job.first_tile, job.end_tile - job.first_tile);
}

void SpatialScans::cast(const Job& job, unsigned thread) {
  const std::uint32_t row = samples()[job.sample].row;
  const LidarBeams& beams = *scanners_[row].beams;
  const auto tiles = std::span(beams.pattern).subspan(job.first_tile, job.end_tile - job.first_tile);
  if (!moves(row)) return cast_tiles(X_WS_[job.sample], tiles, job, thread, cast_beams_of(job));
  const base::Report now = state_of(row);
  for (const scene::BeamTile& tile : tiles) {
    const base::Report state = trails_[row].at(now_ + base::nanoseconds(tile.time), now);
    const auto X_WS = base::compose(base::transform_of(state.X_WM, state.tilt), scanners_[row].X_MS);
    cast_tiles(X_WS, std::span(&tile, 1), job, thread);
  }
}

scene::ScanOutput SpatialScans::output_of(std::size_t i) {
  const HostSample& sample = samples()[i];
  if (scanners_[sample.row].plain) return {sample.values, beams_of(hits_, i), beams_of(quality_, i)};
  scene::ScanOutput out{parts_of(part_ranges_, i), parts_of(part_hits_, i), parts_of(part_quality_, i),
                        parts_of(part_cosines_, i)};
  if (scanners_[sample.row].normals) out.normals = parts_of(part_normals_, i);
  if (scanners_[sample.row].materials && !part_materials_.empty()) out.materials = parts_of(part_materials_, i);
  return out;
}

void SpatialScans::cast_tiles(const base::RigidTransform& X_WS, std::span<const scene::BeamTile> tiles, const Job& job,
                              unsigned thread, std::span<const scene::CastBeam> cast) {
  const std::uint32_t row = samples()[job.sample].row;
  const SpatialScanner& s = scanners_[row];
  const scene::ScanOutput out = output_of(job.sample);
  const scene::SceneView view{instances_[job.sample], floor_[job.sample] != 0, scene_.terrain()};
  if (!reference_) {
    rasterizers_[thread].scan(X_WS, tiles, s.range_max, view, out, cast);
    return;
  }
  for (const scene::BeamTile& tile : tiles)
    for (const std::uint32_t i : std::span(tile.place).first(tile.used * scene::kWidth)) {
      const auto hit = scene::reference_scan(X_WS, s.beams->cast_directions()[i], s.range_max, view);
      out.ranges[i] = static_cast<double>(hit.range);
      out.hits[i] = hit.owner;
      if (!out.cosines.empty()) out.cosines[i] = static_cast<float>(hit.cosine);
      if (!out.normals.empty()) out.normals[i] = hit.normal;
      if (!out.materials.empty()) out.materials[i] = hit.material;
    }
}

void SpatialScans::measure_all() {
  for (std::size_t i = 0; i < samples().size(); ++i) std::ranges::fill(output_of(i).quality, base::QualityFlag::none);
  thread_pool().parallel_for_each(jobs_.size(), 1, [&](std::size_t i, unsigned thread) { cast(jobs_[i], thread); });
  thread_pool().parallel_for_each(samples().size(), 1, [&](std::size_t i, unsigned thread) { finish(i, thread); });
}

void SpatialScans::collect(std::span<base::ReadingBlock> out) {
  HostBackend::collect(out);
  for (std::size_t i = 0; i < samples().size(); ++i) {
    const auto quality = beams_of(quality_, i);
    rays_ += scanner_of(i).beams->cast_directions().size();
    out[i].mode = rows()[samples()[i].row].mode;
    out[i].hits = beams_of(hits_, i);
    const auto is_flagged = [](base::QualityFlag flag) { return flag != base::QualityFlag::none; };
    if (std::ranges::any_of(quality, is_flagged)) out[i].quality = quality;
  }
}

SensorStats SpatialScans::stats() const {
  SensorStats sum{.rays = rays_, .host_scans = host_scans_};
  for (const scene::Rasterizer& rasterizer : rasterizers_) sum.uncertain += rasterizer.counts().uncertain;
  return sum;
}

}  // namespace sf::sensors
