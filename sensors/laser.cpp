#include "sensors/laser.h"

#include "sensors/casts.h"
#include "sensors/laser_packets.h"
#include "sensors/laser_shape.h"

namespace sf::sensors {

namespace {

/// Where the host's own results of one laser lie.
struct Shaping {
  bool needed = false;     ///< results are reworked on the host
  std::size_t values = 0;  ///< first of its samples
};

std::vector<Fan> fans_of(const world::World& world) {
  std::vector<Fan> fans;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    for (std::uint32_t i = 0; i < world.movers[m].lasers.size(); ++i) fans.push_back({world.movers[m].lasers[i], m, i});
  return fans;
}

class Lasers : public Instruments {
 public:
  explicit Lasers(const Site& site);

  void place(std::span<const Pose> poses) override { casts_.place(poses); }
  bool prepare(std::span<const Due> due, std::span<const Pose> poses) override {
    due_.assign(due.begin(), due.end());
    return casts_.prepare(due, poses);
  }
  void record_measure(gpu::Batch& batch) override { casts_.record(batch); }
  void copies(gpu::Batch& batch) override { casts_.copies(batch, true); }
  void collect(std::vector<base::ReadingBlock>& out) override;
  Work work() const override { return casts_.work(); }

 private:
  void shape(std::size_t i);

  base::Workers& workers_;
  std::uint64_t seed_;
  bool noise_;
  Casts casts_;
  std::vector<Shaping> shaping_;  ///< per laser
  std::vector<Due> due_;
  std::vector<double> values_;  ///< [m] results reworked on the host
  std::vector<std::uint32_t> met_;
};

Lasers::Lasers(const Site& site)
    : workers_(site.workers), seed_(site.seed), noise_(site.noise), casts_(site, site.world, fans_of(site.world)) {
  std::size_t samples = 0;
  for (std::uint32_t i = 0; i < casts_.fans().size(); ++i) {
    const world::Laser& laser = casts_.fans()[i].laser;
    const bool needed = laser.resolution > 1 || !casts_.plan(i).packed || (noise_ && laser.noise.has_range());
    shaping_.push_back({needed, samples});
    if (needed) samples += laser.samples;
  }
  values_.resize(samples);
  met_.resize(samples);
}

void Lasers::shape(std::size_t i) {
  const Due& due = due_[i];
  const Fan& fan = casts_.fans()[due.row];
  const FanResults results = casts_.results(i);
  const BeamPlan& plan = *results.plan;
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{results.lane};
  const double* const cast = casts_.ranges().host<double>().data() + first;
  const std::uint32_t* const cast_hits = casts_.hits().host<std::uint32_t>().data() + first;
  double* const out = values_.data() + shaping_[due.row].values;
  std::uint32_t* const out_hits = met_.data() + shaping_[due.row].values;
  shape_scan(fan.laser, plan, {seed_, base::Stream::range_noise, fan.mover, fan.sensor, due.sequence}, noise_,
             {cast, cast_hits}, {out, fan.laser.samples}, {out_hits, fan.laser.samples});
}

void Lasers::collect(std::vector<base::ReadingBlock>& out) {
  workers_.run(due_.size(), 8, [this](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i)
      if (shaping_[due_[i].row].needed) shape(i);
  });
  casts_.count();
  const std::span<const double> ranges = casts_.ranges().host<double>();
  const std::span<const std::uint32_t> hits = casts_.hits().host<std::uint32_t>();
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const Fan& fan = casts_.fans()[due_[i].row];
    const FanResults results = casts_.results(i);
    const Shaping& shaping = shaping_[due_[i].row];
    const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{results.lane};
    base::ReadingBlock block;
    block.mover = fan.mover;
    block.sensor = fan.sensor;
    block.kind = base::kLaser;
    block.X_WS = results.X_WS;
    block.values = shaping.needed ? std::span<const double>(values_).subspan(shaping.values, fan.laser.samples)
                                  : ranges.subspan(first, fan.laser.samples);
    block.hits = shaping.needed ? std::span<const std::uint32_t>(met_).subspan(shaping.values, fan.laser.samples)
                                : hits.subspan(first, fan.laser.samples);
    out.push_back(block);
  }
}

std::vector<SensorRow> rows_of(const world::World& world) {
  std::vector<SensorRow> rows;
  for (const Fan& fan : fans_of(world)) {
    const world::Laser& laser = fan.laser;
    rows.push_back({fan.mover, fan.sensor, laser.name, laser.X_MS, laser.rate, laser.phase, laser.latency,
                    laser.samples, laser.range_max});
  }
  return rows;
}

constexpr Column kColumns[] = {{"range_m"}};

}  // namespace

constinit const SensorKind laser_kind{
    .id = base::kLaser,
    .name = "laser",
    .word = {},  // world reads `laser` and `ranger` itself: Stage knows them
    .base_port = 10000,
    .list = "beams",
    .columns = kColumns,
    .rows = rows_of,
    .make = make_instruments<Lasers>,
    .refuse = refuse_laser,
    .parts = laser_parts,
    .encode = encode_laser,
    .decode = decode_laser,
    .read = fill_laser,
};

}  // namespace sf::sensors
