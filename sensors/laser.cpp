#include "sensors/laser.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/random.h"
#include "sensors/laser_tables.h"
#include "shaders/laser.comp.h"

namespace sf::sensors {

namespace {

/// Lasers with the same beams share their tables.
using BeamKey = std::tuple<double, std::uint32_t, std::uint32_t>;

}  // namespace

Lasers::Lasers(const world::World& world, Scene& scene, gpu::Device& device, base::Workers& workers,
               const LaserOptions& options)
    : t_(std::make_unique<Tables>(scene, workers, options)) {
  t_->plan(world);
  t_->turned.resize(workers.threads());
  t_->kernel = std::make_unique<gpu::Kernel>(device, laser_comp_spv, 14);
  std::uint32_t beam_lanes = 0;
  std::map<BeamKey, std::uint32_t> shared;
  for (LaserRow& row : t_->lasers) {
    const BeamKey key{row.laser.fov, row.laser.samples, row.laser.resolution};
    const auto known = shared.find(key);
    if (!row.turns && known != shared.end()) {
      row.beams = known->second;
      continue;
    }
    row.beams = beam_lanes;
    if (!row.turns) shared[key] = beam_lanes;
    beam_lanes += row.plan.lanes();
  }
  t_->make_tables(device, beam_lanes);
  t_->write_all_beams();
}

Lasers::~Lasers() = default;

const std::vector<LaserOwner>& Lasers::owners() const { return t_->owners; }
std::uint64_t Lasers::rays() const { return t_->rays; }
std::uint64_t Lasers::doubts() const { return t_->doubts_seen; }

bool Lasers::prepare(std::span<const LaserDue> due, std::span<const Pose> poses) {
  Tables& t = *t_;
  t.due.assign(due.begin(), due.end());
  t.views.resize(due.size());
  for (std::size_t i = 0; i < due.size(); ++i) {
    const LaserRow& row = t.lasers[due[i].row];
    const std::uint32_t mover = t.owners[due[i].row].mover;
    Pose X_WS = base::compose(poses[mover], row.laser.X_MS);
    X_WS.z = row.height;
    t.views[i] = {row.family, mover, X_WS};
    t.rays += row.plan.samples.size();
  }
  const auto ray_rows = t.rows->host<RayRow>().first(due.size());
  const bool replaced = t.scene.serve(t.views, ray_rows);
  for (std::size_t i = 0; i < due.size(); ++i) {
    const LaserRow& row = t.lasers[due[i].row];
    ray_rows[i].beams = row.beams;
    ray_rows[i].out = row.out;
    ray_rows[i].range_min = row.laser.range_min;
  }
  t.write_lanes();
  t.workers.run(due.size(), 1, [&t](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i)
      if (t.lasers[t.due[i].row].turns) t.turn_beams(t.due[i], thread);
  });
  const bool again = replaced || !t.bound;
  if (again) t.bind();
  return again;
}

void Lasers::record(gpu::Batch& batch) { batch.dispatch(*t_->kernel, *t_->groups, 0); }

void Lasers::copies(gpu::Batch& batch) {
  Tables& t = *t_;
  batch.up(*t.rows, 0, t.due.size() * sizeof(RayRow));
  batch.up(*t.lanes, 0, t.lanes->bytes());
  batch.up(*t.groups, 0, t.groups->bytes());
  const bool turning = std::any_of(t.lasers.begin(), t.lasers.end(), [](const LaserRow& row) { return row.turns; });
  if (t.beams_changed || turning) {
    batch.up(*t.directions, 0, t.directions->bytes());
    batch.up(*t.middles, 0, t.middles->bytes());
    batch.up(*t.directions64, 0, t.directions64->bytes());
    t.beams_changed = false;
  }
  batch.down(*t.ranges, 0, t.ranges->bytes());
  batch.down(*t.hits, 0, t.hits->bytes());
  batch.down(*t.doubts, 0, t.doubts->bytes());
}

void Lasers::Tables::shape(const LaserDue& d) {
  const LaserRow& row = lasers[d.row];
  const double* const cast = ranges->host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  const std::uint32_t* const cast_hits = hits->host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  double* const out = values.data() + row.values;
  std::uint32_t* const out_hits = met.data() + row.values;
  const base::Draw draw{options.seed, base::Stream::range_noise, owners[d.row].mover, owners[d.row].sensor, d.sequence};
  const world::LaserNoise& noise = row.laser.noise;

  std::uint32_t before = 0;
  for (std::size_t k = 0; k < row.plan.samples.size(); ++k) {
    const std::uint32_t i = row.plan.samples[k];
    double range = cast[row.plan.place(k)];
    const std::uint32_t hit = cast_hits[row.plan.place(k)];
    if (options.noise && has_range_noise(noise) && hit != SF_NO_HIT) {
      const double sigma = std::hypot(noise.range_sigma, noise.range_proportional * range);
      range = std::clamp(range + sigma * base::random_normal(draw, i)[0], row.laser.range_min, row.laser.range_max);
    }
    out[i] = range;
    out_hits[i] = hit;
    // What `resolution` left out lies on a straight line between its neighbours.
    for (std::uint32_t j = before + 1; j < i; ++j) {
      const double part = static_cast<double>(j - before) / (i - before);
      out[j] = out[before] + part * (range - out[before]);
      out_hits[j] = out_hits[before] == hit ? hit : base::kNoHit;
    }
    before = i;
  }
}

void Lasers::collect(std::vector<base::ReadingBlock>& out) {
  Tables& t = *t_;
  t.workers.run(t.due.size(), 8, [&t](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i)
      if (t.lasers[t.due[i].row].shaped) t.shape(t.due[i]);
  });
  const auto doubts = t.doubts->host<std::uint32_t>();
  for (std::size_t i = 0; i < t.due.size(); ++i) {
    const LaserRow& row = t.lasers[t.due[i].row];
    base::ReadingBlock block;
    block.mover = t.owners[t.due[i].row].mover;
    block.sensor = t.owners[t.due[i].row].sensor;
    block.kind = 1;
    block.X_WS = t.views[i].X_WS;
    const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{row.out};
    block.values = row.shaped ? std::span(t.values).subspan(row.values, row.laser.samples)
                              : std::span<const double>(t.ranges->host<double>()).subspan(first, row.laser.samples);
    block.hits = row.shaped
                     ? std::span(t.met).subspan(row.values, row.laser.samples)
                     : std::span<const std::uint32_t>(t.hits->host<std::uint32_t>()).subspan(first, row.laser.samples);
    for (std::uint32_t lane = 0; lane < row.plan.lanes(); ++lane) t.doubts_seen += doubts[row.out + lane];
    out.push_back(block);
  }
}

}  // namespace sf::sensors
