#include "sensors/laser.h"

#include <algorithm>
#include <cmath>

#include "raycast/ray_caster.h"
#include "sensors/laser_modes.h"
#include "sensors/laser_noise.h"
#include "sensors/laser_packets.h"

namespace sf::sensors {

namespace {

/// State of one laser.
struct Row {
  CastLaser cast;
  bool reworked = false;    ///< results are post-processed on the host
  std::size_t samples = 0;  ///< index of its first sample among all
  bool grazing = false;     ///< some beam of its last scan grazes
};

/// The lasers of a world and their scanners, by mover and in file order.
struct LaserTables {
  std::vector<CastLaser> lasers;
  std::vector<raycast::Scanner> scanners;
};

LaserTables lasers_in(const world::World& world) {
  LaserTables tables;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    std::uint32_t number = 0;
    for (const LaserSettings& laser : lasers_of(world.movers[m])) {
      const CastLaser& cast = tables.lasers.emplace_back(cast_laser(world, laser));
      tables.scanners.push_back({cast.laser, m, number++, cast.single});
    }
  }
  return tables;
}

class Lasers : public SensorBackend {
 public:
  explicit Lasers(const SensorContext& context) : Lasers(context, lasers_in(context.world)) {}

  void place_movers() override { caster_.place_movers(); }
  bool prepare(std::span<const DueSample> due) override {
    due_.assign(due.begin(), due.end());
    return caster_.prepare(due);
  }
  void record_measure(gpu::Batch& batch) override { caster_.record(batch); }
  void add_copies(gpu::Batch& batch) override { caster_.add_copies(batch, true); }
  void collect(std::vector<base::ReadingBlock>& out) override;
  SensorStats stats() const override { return caster_.stats(); }
  bool on_device() const override { return caster_.on_device(); }

 private:
  Lasers(const SensorContext& context, LaserTables tables);

  void shape(std::size_t i);
  void mark(std::size_t i);
  base::ReadingBlock block_of(std::size_t i);

  base::ThreadPool& thread_pool_;
  std::uint64_t seed_;
  bool noise_;
  double longest_;  ///< [m] longest surface
  raycast::RayCaster caster_;
  std::vector<Row> rows_;  ///< per laser
  std::vector<DueSample> due_;
  std::vector<double> values_;              ///< [m] of all lasers' samples, when any is reworked
  std::vector<std::uint32_t> met_;          ///< models of all lasers' samples, when any is reworked
  std::vector<base::QualityFlag> quality_;  ///< of all lasers' samples
};

Lasers::Lasers(const SensorContext& context, LaserTables tables)
    : thread_pool_(context.thread_pool),
      seed_(context.seed),
      noise_(context.noise),
      longest_(reaches_of(context.world).longest),
      caster_(context, context.world, std::move(tables.scanners)) {
  std::size_t samples = 0;
  bool any = false;
  for (CastLaser& cast : tables.lasers) {
    Row& row = rows_.emplace_back(Row{std::move(cast), false, samples});
    const LaserSettings& laser = row.cast.laser;
    const auto i = static_cast<std::uint32_t>(rows_.size() - 1);
    row.reworked = laser.resolution > 1 || !caster_.plan(i).packed || (noise_ && laser.noise.has_range());
    samples += laser.samples;
    any = any || row.reworked;
  }
  values_.resize(any ? samples : 0);
  met_.resize(any ? samples : 0);
  quality_.assign(samples, base::QualityFlag::not_cast);
  for (std::uint32_t i = 0; i < rows_.size(); ++i)
    for (const std::uint32_t sample : caster_.plan(i).samples)
      quality_[rows_[i].samples + sample] = base::QualityFlag::none;
}

void Lasers::shape(std::size_t i) {
  const DueSample& due = due_[i];
  const Row& row = rows_[due.row];
  const raycast::Scanner& fan = caster_.scanners()[due.row];
  const raycast::ScanResult results = caster_.results(i);
  const raycast::BeamPlan& plan = *results.plan;
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{results.lane};
  const double* const cast = caster_.ranges().host<double>().data() + first;
  const std::uint32_t* const cast_hits = caster_.hits().host<std::uint32_t>().data() + first;
  double* const out = values_.data() + row.samples;
  std::uint32_t* const out_hits = met_.data() + row.samples;
  finish_scan(row.cast, plan, {seed_, base::RandomStream::range_noise, fan.mover, fan.sensor, due.sequence}, noise_,
              {cast, cast_hits}, {out, fan.scan.samples}, {out_hits, fan.scan.samples});
}

/// Sets the quality flags of a scan. Flags of samples that are never cast were set at construction; grazing changes.
void Lasers::mark(std::size_t i) {
  Row& row = rows_[due_[i].row];
  const raycast::ScanResult results = caster_.results(i);
  const raycast::BeamPlan& plan = *results.plan;
  const auto beam_flags = caster_.beam_flags().host<std::uint32_t>().subspan(results.lane, plan.lanes());
  const bool grazing =
      std::any_of(beam_flags.begin(), beam_flags.end(), [](std::uint32_t v) { return v % SF_UNCERTAIN != 0; });
  if (!grazing && !row.grazing) return;
  row.grazing = grazing;
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    const std::size_t place = plan.place(k);
    const bool grazes = (beam_flags[place / SF_BEAMS_PER_LANE] >> (place % SF_BEAMS_PER_LANE) & SF_GRAZING) != 0;
    quality_[row.samples + plan.samples[k]] = grazes ? base::QualityFlag::grazing : base::QualityFlag::none;
  }
}

base::ReadingBlock Lasers::block_of(std::size_t i) {
  const Row& row = rows_[due_[i].row];
  const raycast::Scanner& fan = caster_.scanners()[due_[i].row];
  const raycast::ScanResult results = caster_.results(i);
  const std::size_t samples = fan.scan.samples;
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{results.lane};
  base::ReadingBlock block;
  block.mover = fan.mover;
  block.sensor = fan.sensor;
  block.type = kLaser;
  block.X_WS = results.X_WS;
  block.values = row.reworked ? std::span<const double>(values_).subspan(row.samples, samples)
                              : caster_.ranges().host<double>().subspan(first, samples);
  block.hits = row.reworked ? std::span<const std::uint32_t>(met_).subspan(row.samples, samples)
                            : caster_.hits().host<std::uint32_t>().subspan(first, samples);
  block.mode = row.cast.mode;
  const double away = std::max(std::abs(results.X_WS.x), std::abs(results.X_WS.y));
  block.bound = laser_bound(row.cast, longest_, away + fan.scan.range_max);
  if (row.grazing || row.cast.laser.resolution > 1)
    block.quality = std::span<const base::QualityFlag>(quality_).subspan(row.samples, samples);
  return block;
}

void Lasers::collect(std::vector<base::ReadingBlock>& out) {
  const std::size_t before = out.size();
  out.resize(before + due_.size());
  thread_pool_.parallel_for(due_.size(), 32, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      if (rows_[due_[i].row].reworked) shape(i);
      mark(i);
      out[before + i] = block_of(i);
    }
  });
  caster_.count();
}

std::vector<SensorSpec> specs_of(const world::World& world) {
  std::vector<SensorSpec> rows;
  const LaserTables tables = lasers_in(world);
  for (const CastLaser& cast : tables.lasers) {
    const LaserSettings& laser = cast.laser;
    const raycast::Scanner& scanner = tables.scanners[rows.size()];
    rows.push_back({scanner.mover, scanner.sensor, laser.name, laser.X_MS, laser.rate, laser.phase, laser.latency,
                    laser.samples, laser.range_max, 0, 0.0, cast.mode});
    rows.back().fov = laser.fov;
    rows.back().range_min = laser.range_min;
    rows.back().dependency_radius = rows.back().reach = laser.range_max;
    rows.back().noisy = laser.noise.has_range() || laser.noise.angle_sigma > 0.0;
  }
  return rows;
}

constexpr Column kColumns[] = {{"range_m", 1, false, 9}};

}  // namespace

constinit const SensorType laser_type{
    .id = kLaser,
    .name = "laser",
    .word = kLaserWord,
    .other_word = kRangerWord,
    .base_port = 10000,
    .list = "beams",
    .columns = kColumns,
    .is_scan = true,
    .modes = kLaserModes,
    .bound = bound_of_laser,
    .specs = specs_of,
    .make = make_backend<Lasers>,
    .wire_problem = laser_wire_problem,
    .parts = laser_parts,
    .encode = encode_laser,
    .decode = decode_laser,
    .read = fill_laser,
};

}  // namespace sf::sensors
