#include "sensors/laser.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/random.h"
#include "sensors/beams.h"
#include "shaders/laser.comp.h"

namespace sf::sensors {

namespace {

/// Groups along x of a dispatch; more rows of groups follow along y. Devices promise 65 535.
constexpr std::uint32_t kGroupsAcross = 32'768;

/// One laser, planned at load.
struct LaserRow {
  world::Laser laser;
  BeamPlan plan;
  double height = 0.0;  ///< [m] of the beams in the world, fixed at load: the world is 2.5-D
  std::uint32_t family = 0;
  std::uint32_t beams = 0;  ///< first lane of its beam tables
  std::uint32_t out = 0;    ///< first lane of its results
  std::size_t values = 0;   ///< first of its samples in the host's own results
  bool turns = false;       ///< has angular noise: beams are its own and change
  bool shaped = false;      ///< results are reworked on the host
};

/// Lasers with the same beams share their tables.
using BeamKey = std::tuple<double, std::uint32_t, std::uint32_t>;

bool has_range_noise(const world::LaserNoise& noise) {
  return noise.range_sigma > 0.0 || noise.range_proportional > 0.0;
}

}  // namespace

struct Lasers::Tables {
  Scene& scene;
  base::Workers& workers;
  LaserOptions options;
  std::vector<LaserOwner> owners;
  std::vector<LaserRow> lasers;
  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> rows, lanes, groups, directions, middles, directions64, ranges, hits, doubts;
  std::vector<LaserDue> due;
  std::vector<std::uint32_t> lanes_written;  ///< due rows, in order, that `lanes` holds
  std::vector<Viewpoint> views;
  std::vector<RayRow> ray_rows;
  std::vector<double> values;  ///< [m] results reworked on the host
  std::vector<std::uint32_t> met;
  std::vector<std::vector<double>> turned;  ///< scratch per thread
  std::uint32_t out_lanes = 0;
  std::uint32_t due_lanes = 0;
  std::uint64_t rays = 0;
  std::uint64_t doubts_seen = 0;
  bool bound = false;
  bool beams_changed = true;

  Tables(Scene& s, base::Workers& w, const LaserOptions& o) : scene(s), workers(w), options(o) {}
  void plan(const world::World& world);
  void make_tables(gpu::Device& device, std::uint32_t beam_lanes);
  void write_all_beams();
  void write_lanes();
  void turn_beams(const LaserDue& d, unsigned thread);
  void shape(const LaserDue& d);
  void bind();
  BeamTables beam_tables(std::uint32_t lane) const {
    return {directions->host<float>().data() + 8 * std::size_t{lane}, middles->host<float>().data() + lane,
            directions64->host<double>().data() + 8 * std::size_t{lane}};
  }
};

void Lasers::Tables::plan(const world::World& world) {
  std::size_t samples = 0;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const world::Mover& mover = world.movers[m];
    std::size_t beams = 0;
    for (const world::Laser& laser : mover.lasers) beams += laser.samples / laser.resolution;
    for (std::uint32_t i = 0; i < mover.lasers.size(); ++i) {
      LaserRow row;
      row.laser = mover.lasers[i];
      row.plan = plan_beams(row.laser, options.noise);
      row.height = mover.X_WM.z + row.laser.X_MS.z;
      const double turn = options.noise ? kMostSigmas * row.laser.noise.angle_sigma : 0.0;
      row.family = scene.add_family({row.height, row.laser.range_max, row.plan.spread, row.laser.fov + 2.0 * turn,
                                     static_cast<std::uint32_t>(std::min<std::size_t>(beams, 1'000'000))});
      row.turns = options.noise && row.laser.noise.angle_sigma > 0.0;
      row.shaped = row.laser.resolution > 1 || !row.plan.packed || (options.noise && has_range_noise(row.laser.noise));
      row.out = out_lanes;
      row.values = samples;
      out_lanes += row.plan.lanes();
      if (row.shaped) samples += row.laser.samples;
      owners.push_back({m, i});
      lasers.push_back(std::move(row));
    }
  }
  values.resize(samples);
  met.resize(samples);
}

void Lasers::Tables::make_tables(gpu::Device& device, std::uint32_t beam_lanes) {
  using gpu::Role;
  using gpu::Texel;
  const std::size_t group = kernel->group_size();
  const std::size_t count = std::max<std::size_t>(1, lasers.size());
  // Lanes are padded to whole groups, and groups to whole rows of groups where there are many.
  const std::size_t most_groups = out_lanes / group + 1;
  const std::size_t padded = (most_groups > kGroupsAcross ? most_groups + kGroupsAcross : most_groups) * group;
  rows = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, SF_ROW_TEXELS * count);
  lanes = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 2 * padded);
  groups = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 4);
  directions = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::f32x4, 2 * std::size_t{beam_lanes} + 2);
  middles = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::f32, std::size_t{beam_lanes} + 1);
  directions64 = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, 4 * std::size_t{beam_lanes} + 4);
  ranges = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, 2 * std::size_t{out_lanes} + 2);
  hits = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, std::size_t{out_lanes} + 1);
  doubts = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32, std::size_t{out_lanes} + 1);
}

void Lasers::Tables::write_all_beams() {
  for (const LaserRow& row : lasers) write_beams(row.laser, row.plan, {}, beam_tables(row.beams));
}

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

void Lasers::Tables::turn_beams(const LaserDue& d, unsigned thread) {
  const LaserRow& row = lasers[d.row];
  std::vector<double>& turns = turned[thread];
  turns.resize(row.plan.samples.size());
  const base::Draw draw{options.seed, base::Stream::angle_noise, owners[d.row].mover, owners[d.row].sensor, d.sequence};
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const double normal = base::random_normal(draw, row.plan.samples[k])[0];
    turns[k] = row.laser.noise.angle_sigma * std::clamp(normal, -kMostSigmas, kMostSigmas);
  }
  write_beams(row.laser, row.plan, turns, beam_tables(row.beams));
}

void Lasers::Tables::write_lanes() {
  const bool same = lanes_written.size() == due.size() &&
                    std::equal(due.begin(), due.end(), lanes_written.begin(),
                               [](const LaserDue& d, std::uint32_t row) { return d.row == row; });
  if (same) return;
  lanes_written.clear();
  const auto table = lanes->host<Lane>();
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    for (std::uint32_t lane = 0; lane < lasers[due[i].row].plan.lanes(); ++lane) table[at++] = {i, lane};
    lanes_written.push_back(due[i].row);
  }
  due_lanes = static_cast<std::uint32_t>(at);
  const std::uint32_t group = kernel->group_size();
  const std::uint32_t needed = (due_lanes + group - 1) / group;
  const std::uint32_t across = std::min(needed, kGroupsAcross);
  const std::uint32_t down = across > 0 ? (needed + across - 1) / across : 0;
  // Padding repeats the last lane, which then is written more than once with the same values.
  const Lane last = at > 0 ? table[at - 1] : Lane{0, 0};
  std::fill(table.begin() + static_cast<std::ptrdiff_t>(at), table.begin() + std::ptrdiff_t{across} * down * group,
            last);
  const auto counts = groups->host<std::uint32_t>();
  counts[0] = across;
  counts[1] = down;
  counts[2] = across > 0 ? 1 : 0;
}

bool Lasers::prepare(std::span<const LaserDue> due, std::span<const Pose> poses) {
  Tables& t = *t_;
  t.due.assign(due.begin(), due.end());
  t.views.resize(due.size());
  t.ray_rows.resize(due.size());
  for (std::size_t i = 0; i < due.size(); ++i) {
    const LaserRow& row = t.lasers[due[i].row];
    const std::uint32_t mover = t.owners[due[i].row].mover;
    Pose X_WS = base::compose(poses[mover], row.laser.X_MS);
    X_WS.z = row.height;
    t.views[i] = {row.family, mover, X_WS};
    t.rays += row.plan.samples.size();
  }
  const bool replaced = t.scene.serve(t.views, t.ray_rows);
  for (std::size_t i = 0; i < due.size(); ++i) {
    const LaserRow& row = t.lasers[due[i].row];
    t.ray_rows[i].beams = row.beams;
    t.ray_rows[i].out = row.out;
    t.ray_rows[i].range_min = row.laser.range_min;
  }
  std::copy(t.ray_rows.begin(), t.ray_rows.end(), t.rows->host<RayRow>().begin());
  t.write_lanes();
  t.workers.run(due.size(), 1, [&t](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i)
      if (t.lasers[t.due[i].row].turns) t.turn_beams(t.due[i], thread);
  });
  const bool again = replaced || !t.bound;
  if (again) t.bind();
  return again;
}

void Lasers::Tables::bind() {
  gpu::Buffer* const tables[] = {rows.get(),         lanes.get(),       directions.get(), middles.get(),
                                 directions64.get(), &scene.headers(),  &scene.entries(), &scene.ids(),
                                 &scene.nearest(),   &scene.segments(), &scene.models(),  ranges.get(),
                                 hits.get(),         doubts.get()};
  kernel->bind(tables);
  bound = true;
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
