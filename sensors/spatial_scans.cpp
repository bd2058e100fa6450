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
    extras.coarse |= s.angle > 0.0, extras.materials |= s.materials, extras.textures |= s.textures;
  return extras;
}

std::int64_t longest_scan(std::span<const SpatialScanner> scanners) {
  std::int64_t longest = 0;
  for (const SpatialScanner& scanner : scanners) longest = std::max(longest, scanner.beams->duration());
  return longest;
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
      rasterizers_(context.thread_pool.threads()),
      trails_(context.world, context.states, longest_scan(scanners_)),
      moved_(rasterizers_.size()) {
  bool cosines = false, normals = false;
  for (const SpatialScanner& s : scanners_) {
    first_beam_.push_back(first_beam_.back() + s.beams->directions.size());
    first_part_.push_back(first_part_.back() + (s.plain ? 0 : s.beams->placed_directions().size()));
    cosines = cosines || s.cosines, normals = normals || s.normals;
  }
  hits_.resize(first_beam_.back()), quality_.resize(first_beam_.back());
  const std::size_t parts = first_part_.back();
  part_ranges_.resize(parts), part_hits_.resize(parts), part_quality_.resize(parts);
  if (cosines) part_cosines_.resize(parts);
  if (normals) part_normals_.resize(parts);
  if (!materials().empty()) part_materials_.resize(parts);
  if (raycast::choose_caster(context.device.info().software, context.scene.caster).on_device)
    device_.emplace(context.device);
}

void SpatialScans::write_state(std::uint32_t row, base::ByteWriter& out) const {
  if (scanners_[row].beams->duration() > 0) trails_.write(rows()[row].mover, out);
}

void SpatialScans::read_state(std::uint32_t row, base::ByteReader& in) {
  if (scanners_[row].beams->duration() > 0) trails_.read(in);
}

void SpatialScans::take_over(SensorBackend& before, std::uint32_t) {
  trails_.take_over(static_cast<SpatialScans&>(before).trails_);
}

bool SpatialScans::update_outlines(const world::World& world) {
  scene_.update_movers(world);
  if (device_) device_->forget();
  return true;
}

SensorView SpatialScans::sensor_view(std::size_t i) const {
  const std::uint32_t row = samples()[i].row, mover = rows()[row].mover;
  const SpatialScanner& s = scanners_[row];
  SensorView view{.mover = mover, .p = X_WS(i).p, .range = s.range_max, .angle = s.angle};
  const std::int64_t duration = s.beams->duration();
  if (duration > 0 && trails_.is_here(mover)) {
    view.trails = &trails_, view.since = trails_.now() - duration;
    view.range += trails_.reach(mover) + 2.0 * glm::length(s.X_MS.p);
  }
  return view;
}

void SpatialScans::list_scene(std::size_t i) {
  const std::uint32_t row = samples()[i].row, mover = rows()[row].mover;
  Surroundings& around = surroundings_[i];
  around.X_WS = base::compose(scene_.X_WM(mover), scanners_[row].X_MS);
  const SensorView view = sensor_view(i);
  scene_.list(view, around.list);
  around.rolling = view.trails != nullptr && (!around.list.moving.empty() || !trails_.at_rest(mover, view.since));
}

void SpatialScans::move_to_tile(const scene::BeamTile& tile, const SceneList& list,
                                std::vector<scene::Instance>& out) const {
  out = list.instances;
  move_to(trails_.now() + base::nanoseconds(tile.time), trails_, list, out);
}

bool SpatialScans::prepare(std::span<const DueSample> due) {
  bool again = HostBackend::prepare(due);
  jobs_.clear();
  if (device_) device_->begin();
  on_device_.assign(due.size(), std::nullopt);
  surroundings_.resize(std::max(surroundings_.size(), due.size()));
  const bool whole = due.size() >= 8 * rasterizers_.size();  // enough work for all threads without dividing scans
  for (std::size_t i = 0; i < due.size(); ++i) {
    list_scene(i);
    const Surroundings& around = surroundings_[i];
    const SpatialScanner& s = scanner_of(i);
    if (device_ && !around.rolling)
      on_device_[i] = device_->add(around.X_WS, s.beams->pattern, s.range_max, view_of(around.list.instances, i));
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

std::span<const scene::CastBeam> SpatialScans::cast_beams_of(const Job& job) {
  const std::optional<std::size_t> first = on_device_[job.sample];
  if (!first) return {};
  return device_->results(*first + job.first_tile, job.end_tile - job.first_tile);
}

void SpatialScans::cast(const Job& job, unsigned thread) {
  const Surroundings& around = surroundings_[job.sample];
  const auto tiles =
      std::span(scanner_of(job.sample).beams->pattern).subspan(job.first_tile, job.end_tile - job.first_tile);
  if (around.rolling)
    cast_rolling(job, tiles, thread);
  else
    cast_tiles(around.X_WS, around.list.instances, tiles, job, thread, cast_beams_of(job));
}

/// Casts each tile from and among the poses at its time.
void SpatialScans::cast_rolling(const Job& job, std::span<const scene::BeamTile> tiles, unsigned thread) {
  const std::uint32_t row = samples()[job.sample].row;
  const SceneList& list = surroundings_[job.sample].list;
  std::vector<scene::Instance>& instances = moved_[thread];
  instances = list.instances;
  for (const scene::BeamTile& tile : tiles) {
    const std::int64_t time = trails_.now() + base::nanoseconds(tile.time);
    move_to(time, trails_, list, instances);
    const auto X_WS = base::compose(trails_.X_WM(rows()[row].mover, time), scanners_[row].X_MS);
    cast_tiles(X_WS, instances, std::span(&tile, 1), job, thread);
  }
}

scene::ScanOutput SpatialScans::output_of(std::size_t i) {
  const HostSample& sample = samples()[i];
  const SpatialScanner& s = scanners_[sample.row];
  scene::ScanOutput out{sample.values, beams_of(hits_, i), beams_of(quality_, i)};
  if (!s.plain) out = {parts_of(part_ranges_, i), parts_of(part_hits_, i), parts_of(part_quality_, i)};
  out.single = s.single, out.depth_max = s.depth_max;
  if (s.cosines) out.cosines = parts_of(part_cosines_, i);
  if (s.normals) out.normals = parts_of(part_normals_, i);
  if (s.materials && !s.follows && !part_materials_.empty()) out.materials = parts_of(part_materials_, i);
  return out;
}

/// Passes tiles on.
struct SpatialScans::Follower final : scene::TileSink {
  SpatialScans& scans;
  std::size_t sample;
  const base::RigidTransform& X_WS;
  unsigned thread;

  Follower(SpatialScans& owner, std::size_t i, const base::RigidTransform& X, unsigned of)
      : scans(owner), sample(i), X_WS(X), thread(of) {}
  void take(const scene::BeamTile& tile, const scene::TileSurfaces& surfaces) override {
    scans.follow(sample, X_WS, tile, surfaces, thread);
  }
};

/// Casts a tile by the reference.
void SpatialScans::cast_reference(const base::RigidTransform& X_WS, const scene::BeamTile& tile,
                                  const SpatialScanner& s, const scene::SceneView& view, const scene::ScanOutput& out) {
  scene::TileSurfaces surfaces;
  for (std::uint32_t k = 0; k < tile.used * scene::kWidth; ++k) {
    const std::uint32_t i = tile.place[k];
    const auto hit = scene::reference_scan(X_WS, s.beams->placed_directions()[i], s.range_max, view);
    out.ranges[i] = surfaces.ranges[k] = static_cast<double>(hit.range);
    out.hits[i] = surfaces.hits[k] = hit.owner;
    if (out.depth_max > 0.0) {
      out.ranges[i] = std::min(surfaces.ranges[k] * tile.dx[k], out.depth_max);
      if (out.ranges[i] == out.depth_max) out.hits[i] = base::kNoHit;
    }
    surfaces.x[k] = hit.normal.x, surfaces.y[k] = hit.normal.y, surfaces.z[k] = hit.normal.z;
    surfaces.materials[k] = hit.material;
    surfaces.u[k] = hit.coordinates.x, surfaces.v[k] = hit.coordinates.y, surfaces.spread[k] = hit.spread;
    if (!out.cosines.empty()) out.cosines[i] = static_cast<float>(hit.cosine);
    if (!out.normals.empty()) out.normals[i] = out.hits[i] == base::kNoHit ? glm::vec3{} : hit.normal;
    if (!out.materials.empty()) out.materials[i] = hit.material;
  }
  if (out.sink != nullptr) out.sink->take(tile, surfaces);
}

void SpatialScans::cast_tiles(const base::RigidTransform& X_WS, std::span<const scene::Instance> instances,
                              std::span<const scene::BeamTile> tiles, const Job& job, unsigned thread,
                              std::span<const scene::CastBeam> cast) {
  const SpatialScanner& s = scanners_[samples()[job.sample].row];
  scene::ScanOutput out = output_of(job.sample);
  Follower follower(*this, job.sample, X_WS, thread);
  if (s.follows) {
    begin_follow(job.sample, X_WS, thread);
    out.sink = &follower;
  }
  const scene::SceneView view = view_of(instances, job.sample);
  if (reference_)
    for (const scene::BeamTile& tile : tiles) cast_reference(X_WS, tile, s, view, out);
  else
    rasterizers_[thread].scan(X_WS, tiles, s.range_max, view, out, cast);
}

void SpatialScans::measure_all() {
  const auto clear = [this](std::size_t i) { std::ranges::fill(output_of(i).quality, base::QualityFlag::none); };
  const std::size_t count = samples().size();
  if (jobs_.size() == count)  // one per sample, finished while its hits are in the cache
    return thread_pool().parallel_for_each(
        count, 1, [&](std::size_t i, unsigned thread) { clear(i), cast(jobs_[i], thread), finish(i, thread); });
  for (std::size_t i = 0; i < count; ++i) clear(i);
  thread_pool().parallel_for_each(jobs_.size(), 1, [&](std::size_t i, unsigned thread) { cast(jobs_[i], thread); });
  thread_pool().parallel_for_each(count, 1, [&](std::size_t i, unsigned thread) { finish(i, thread); });
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
