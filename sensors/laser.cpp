#include "sensors/laser.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "base/elementary.h"
#include "base/tilted_pose.h"
#include "base/time.h"
#include "raycast/casters.h"
#include "raycast/ray_caster.h"
#include "sensors/laser_modes.h"
#include "sensors/laser_noise.h"
#include "sensors/laser_packets.h"
#include "sensors/mover_trails.h"
#include "sensors/tilted_scans.h"

namespace sf::sensors {

namespace {

/// A laser's place in the tables and the data that its readings need. Kept small, because a fleet may have very many.
struct Row {
  std::span<const double> values;  ///< [m] ranges of its readings
  std::span<const std::uint32_t> hits;
  std::span<const std::uint32_t> beam_flags;  ///< flags of its lanes
  std::size_t first_sample;                   ///< index among the samples of all lasers
  double range_max;                           ///< [m]
  std::uint32_t mover, sensor;
  std::uint8_t mode;
  bool single;
  bool reworked;          ///< results are post-processed on the host
  bool interpolated;      ///< some samples are not cast
  bool grazing = false;   ///< a beam of its last scan grazes a surface
  bool too_near = false;  ///< a surface of its last scan is nearer than its minimum
};

std::vector<raycast::Scanner> scanners_of(const ParsedSensors& sensors) {
  std::vector<raycast::Scanner> scanners;
  for (const CastLaser& cast : sensors.settings_as<CastLaser>()) {
    const SensorSpec& row = sensors.rows[scanners.size()];
    scanners.push_back({cast_settings(cast.laser), row.mover, row.sensor, cast.single});
  }
  return scanners;
}

/// [ns] from the first beam to the reading; 0: all beams are cast at once.
std::int64_t duration_of(const LaserSettings& laser) { return base::nanoseconds(laser.scan_time); }

std::int64_t longest_scan(const std::vector<CastLaser>& lasers) {
  std::int64_t longest = 0;
  for (const CastLaser& each : lasers) longest = std::max(longest, duration_of(each.laser));
  return longest;
}

class Lasers : public SensorBackend {
 public:
  Lasers(const SensorContext& context, const ParsedSensors& sensors);

  void accumulate(std::int64_t now, bool between) override { trails_.add(now, between); }
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  void take_over(SensorBackend& before, std::uint32_t) override {
    trails_.take_over(static_cast<Lasers&>(before).trails_);
  }
  void restart(std::uint32_t row, std::int64_t now) override { trails_.restart(rows_[row].mover, now); }
  void place_movers() override { caster_.place_movers(); }
  bool update_outlines(const world::World& world) override {
    longest_ = reaches_of(world).longest;
    if (tilted_) tilted_->update_movers(world);
    return caster_.update_outlines(world);
  }
  bool prepare(std::span<const DueSample> due) override {
    due_.assign(due.begin(), due.end());
    prepare_scene();
    return caster_.prepare(due);
  }
  void record_measure(gpu::Batch& batch) override { caster_.record(batch); }
  void add_copies(gpu::Batch& batch) override { caster_.add_copies(batch, true); }
  void collect(std::span<base::ReadingBlock> out) override;
  SensorStats stats() const override { return caster_.stats(); }
  bool on_device() const override { return caster_.on_device(); }

 private:
  Row make_row(std::uint32_t i, std::size_t first_sample) const;
  void find_results(std::uint32_t i);
  void shape(std::size_t i);
  void mark(std::size_t i);
  void write(std::size_t i, base::ReadingBlock& block) const;
  bool moves(std::uint32_t row) const;
  bool needs_scene(std::size_t i) const;
  void prepare_scene();
  void cast_in_scene(std::size_t i, unsigned thread);

  const world::World& world_;
  std::span<const base::Report> states_;
  bool reference_;
  base::ThreadPool& thread_pool_;
  raycast::Episodes episodes_;
  bool noise_;
  double longest_;  ///< [m] longest surface
  raycast::RayCaster caster_;
  const std::vector<CastLaser>& lasers_;
  std::vector<Row> rows_;  ///< per laser
  std::vector<DueSample> due_;
  std::vector<std::uint8_t> rolling_;                    ///< per due sample, as `moves`
  std::vector<double> values_;                           ///< [m] samples of all lasers, if any laser is reworked
  std::vector<std::uint32_t> met_;                       ///< models of all lasers' samples, if any laser is reworked
  std::vector<base::QualityFlag> quality_;               ///< flags of all lasers' samples
  std::unique_ptr<TiltedScans> tilted_;                  ///< null: no scan has needed it
  std::map<std::vector<double>, PlanarBeams> patterns_;  ///< by the cast bearings [rad] and times [s]
  std::vector<TiltedScan> scans_;                        ///< per thread
  MoverTrails trails_;                                   ///< empty: no scan is rolling
};

Lasers::Lasers(const SensorContext& context, const ParsedSensors& sensors)
    : world_(context.world),
      states_(context.states),
      reference_(!raycast::choose_caster(context.device.info().software, context.scene.caster).same_bytes),
      thread_pool_(context.thread_pool),
      episodes_(context.episodes),
      noise_(context.noise),
      longest_(reaches_of(context.world).longest),
      caster_(context, context.world, scanners_of(sensors)),
      lasers_(sensors.settings_as<CastLaser>()),
      trails_(context.world, context.states, longest_scan(lasers_)) {
  std::size_t samples = 0;
  for (std::uint32_t i = 0; i < lasers_.size(); ++i) {
    rows_.push_back(make_row(i, samples));
    samples += lasers_[i].laser.samples;
  }
  const bool any = std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.reworked; });
  values_.resize(any ? samples : 0);
  met_.resize(any ? samples : 0);
  quality_.assign(samples, base::QualityFlag::not_cast);
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    find_results(i);
    for (const std::uint32_t sample : caster_.plan(i).samples)
      quality_[rows_[i].first_sample + sample] = base::QualityFlag::none;
  }
}

Row Lasers::make_row(std::uint32_t i, std::size_t first_sample) const {
  const LaserSettings& laser = lasers_[i].laser;
  const raycast::Scanner& scanner = caster_.scanners()[i];
  const bool interpolated = laser.resolution > 1;
  return {.first_sample = first_sample,
          .range_max = laser.range_max,
          .mover = scanner.mover,
          .sensor = scanner.sensor,
          .mode = lasers_[i].mode,
          .single = lasers_[i].single,
          .reworked =
              interpolated || !caster_.plan(i).packed || (noise_ && laser.noise.has_range()) || laser.range_min > 0.0,
          .interpolated = interpolated};
}

void Lasers::find_results(std::uint32_t i) {
  Row& row = rows_[i];
  const std::size_t lane = caster_.lane(i), samples = lasers_[i].laser.samples;
  const std::size_t first = row.reworked ? row.first_sample : SF_BEAMS_PER_LANE * lane;
  const std::span<const double> ranges = row.reworked ? std::span(values_) : caster_.ranges().host<double>();
  const std::span<const std::uint32_t> hits = row.reworked ? std::span(met_) : caster_.hits().host<std::uint32_t>();
  row.values = ranges.subspan(first, samples);
  row.hits = hits.subspan(first, samples);
  row.beam_flags = caster_.beam_flags().subspan(lane, caster_.plan(i).lanes());
}

void Lasers::shape(std::size_t i) {
  const DueSample& due = due_[i];
  Row& row = rows_[due.row];
  const CastLaser& cast = lasers_[due.row];
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{caster_.lane(due.row)};
  const double* const ranges = caster_.ranges().host<double>().data() + first;
  const std::uint32_t* const hits = caster_.hits().host<std::uint32_t>().data() + first;
  row.too_near = finish_scan(cast, caster_.plan(due.row),
                             episodes_.key(base::RandomStream::range_noise, row.mover, row.sensor, due.sequence),
                             noise_, {ranges, hits},
                             {{values_.data() + row.first_sample, cast.laser.samples},
                              {met_.data() + row.first_sample, cast.laser.samples},
                              {quality_.data() + row.first_sample, cast.laser.samples}});
}

/// Sets the quality flags of a scan, unless they still are as set at construction. `shape` adds those that are too
/// near.
void Lasers::mark(std::size_t i) {
  Row& row = rows_[due_[i].row];
  const bool grazing =
      std::any_of(row.beam_flags.begin(), row.beam_flags.end(), [](std::uint32_t v) { return v % SF_UNCERTAIN != 0; });
  if (!grazing && !row.grazing && !row.too_near) return;
  row.grazing = grazing;
  const raycast::BeamPlan& plan = caster_.plan(due_[i].row);
  std::fill_n(quality_.begin() + static_cast<std::ptrdiff_t>(row.first_sample), row.values.size(),
              base::QualityFlag::not_cast);
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    const std::size_t place = plan.place(k);
    const bool grazes = (row.beam_flags[place / SF_BEAMS_PER_LANE] >> (place % SF_BEAMS_PER_LANE) & SF_GRAZING) != 0;
    quality_[row.first_sample + plan.samples[k]] = grazes ? base::QualityFlag::grazing : base::QualityFlag::none;
  }
}

/// Writes every field that the farm does not fill in, in place: copying 248 bytes would double the time.
void Lasers::write(std::size_t i, base::ReadingBlock& block) const {
  const Row& row = rows_[due_[i].row];
  block.mover = row.mover;
  block.sensor = row.sensor;
  block.type = kLaser;
  block.X_WS = caster_.X_WS(i);
  block.values = row.values;
  block.hits = row.hits;
  block.flags = 0;
  block.mode = row.mode;
  const double away = std::max(std::abs(block.X_WS.x), std::abs(block.X_WS.y));
  block.bound = block.bound_without_noise = caster_.bound(row.range_max, longest_, away + row.range_max, row.single);
  block.sigma = 0.0;
  block.quality = {};
  if (row.grazing || row.interpolated || row.too_near)
    block.quality = std::span(quality_).subspan(row.first_sample, row.values.size());
  block.state = {};
}

void Lasers::write_state(std::uint32_t row, base::ByteWriter& out) const {
  if (duration_of(lasers_[row].laser) > 0) trails_.write(rows_[row].mover, out);
}

void Lasers::read_state(std::uint32_t row, base::ByteReader& in) {
  if (duration_of(lasers_[row].laser) > 0) trails_.read(in);
}

/// True if a rolling laser's carrier, or another mover within its range, moved during its scan.
bool Lasers::moves(std::uint32_t row) const {
  const std::int64_t duration = duration_of(lasers_[row].laser);
  const std::uint32_t mover = rows_[row].mover;
  return duration > 0 && trails_.is_here(mover) &&
         trails_.any_moves(mover, trails_.now() - duration,
                           rows_[row].range_max + base::hypot(lasers_[row].laser.X_MS.x, lasers_[row].laser.X_MS.y));
}

/// The planar caster sees no terrain, and no tilt.
bool Lasers::needs_scene(std::size_t i) const {
  const std::uint32_t row = due_[i].row;
  return !world_.terrain.empty() || !base::is_level(states_[rows_[row].mover].tilt) ||
         !base::is_level(lasers_[row].laser.tilt) || rolling_[i] != 0;
}

/// Bearings [rad] of the cast beams of a laser, without angular noise.
std::vector<double> bearings_of(const raycast::ScanSettings& scan, const raycast::BeamPlan& plan) {
  std::vector<double> bearings;
  for (const std::uint32_t sample : plan.samples) bearings.push_back(raycast::bearing_of(scan, sample));
  return bearings;
}

/// Times [s] of the cast beams of a rolling laser, the last one at the reading's.
std::vector<double> times_of(const LaserSettings& laser, const raycast::BeamPlan& plan) {
  std::vector<double> times;
  for (const std::uint32_t sample : plan.samples)
    times.push_back(-laser.scan_time * static_cast<double>(laser.samples - 1 - sample) / laser.samples);
  return times;
}

std::vector<double> pattern_key(const std::vector<double>& bearings, const std::vector<double>& times) {
  std::vector<double> key = bearings;
  key.insert(key.end(), times.begin(), times.end());
  return key;
}

void Lasers::prepare_scene() {
  bool any = false;
  rolling_.resize(due_.size());
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const std::uint32_t row = due_[i].row;
    rolling_[i] = moves(row);
    if (!needs_scene(i)) continue;
    any = true;
    const auto bearings = bearings_of(caster_.scanners()[row].scan, caster_.plan(row));
    const auto times = rolling_[i] != 0 ? times_of(lasers_[row].laser, caster_.plan(row)) : std::vector<double>();
    const auto key = pattern_key(bearings, times);
    if (!patterns_.contains(key)) patterns_.emplace(key, planar_beams(bearings, times));
  }
  if (!any) return;
  if (!tilted_) {
    double reach = 0.0;
    for (const Row& row : rows_) reach = std::max(reach, row.range_max);
    tilted_ = std::make_unique<TiltedScans>(world_, reach, reference_, thread_pool_.threads());
    scans_.resize(thread_pool_.threads());
  }
  tilted_->place(states_);
}

/// Replaces the results of the planar caster, in its tables, by those in the scene of solids.
void Lasers::cast_in_scene(std::size_t i, unsigned thread) {
  const std::uint32_t r = due_[i].row;
  Row& row = rows_[r];
  const raycast::BeamPlan& plan = caster_.plan(r);
  const raycast::ScanSettings& scan = caster_.scanners()[r].scan;
  std::vector<double> bearings = bearings_of(scan, plan);
  const auto times = rolling_[i] != 0 ? times_of(lasers_[r].laser, plan) : std::vector<double>();
  const PlanarBeams* beams = &patterns_.at(pattern_key(bearings, times));
  PlanarBeams noisy;
  if (noise_ && scan.noise.angle_sigma > 0.0) {
    std::vector<double> noise(bearings.size());
    raycast::draw_angle_noise(
        scan, plan, episodes_.key(base::RandomStream::angle_noise, row.mover, row.sensor, due_[i].sequence), noise);
    for (std::size_t k = 0; k < noise.size(); ++k) bearings[k] += noise[k];
    noisy = planar_beams(bearings, times);
    beams = &noisy;
  }
  TiltedScan& out = scans_[thread];
  tilted_->cast(*beams, row.mover, mount_of(lasers_[r].laser), row.range_max, times.empty() ? nullptr : &trails_,
                thread, out);
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{caster_.lane(r)};
  row.grazing = false;
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    caster_.ranges().host<double>()[first + plan.place(k)] = out.ranges[k];
    caster_.hits().host<std::uint32_t>()[first + plan.place(k)] = out.hits[k];
    quality_[row.first_sample + plan.samples[k]] = out.quality[k];
    row.grazing = row.grazing || out.quality[k] != base::QualityFlag::none;
  }
}

void Lasers::collect(std::span<base::ReadingBlock> out) {
  caster_.take_flags();
  thread_pool_.parallel_for_each(due_.size(), 32, [&](std::size_t i, unsigned thread) {
    const bool in_scene = needs_scene(i);
    in_scene ? cast_in_scene(i, thread) : mark(i);
    if (rows_[due_[i].row].reworked) shape(i);
    write(i, out[i]);
    if (in_scene) out[i].bound = out[i].bound_without_noise = scene::kRangeError;
  });
}

SensorSpec spec_of(const CastLaser& cast, std::uint32_t mover, std::uint32_t number) {
  const LaserSettings& laser = cast.laser;
  SensorSpec row{.mover = mover,
                 .sensor = number,
                 .name = laser.name,
                 .X_MS = laser.X_MS,
                 .rate = laser.rate,
                 .phase = laser.phase,
                 .latency = laser.latency,
                 .priority = laser.priority,
                 .elements = laser.samples,
                 .limit = laser.range_max,
                 .mode = cast.mode};
  row.fov = laser.fov;
  row.range_min = laser.range_min;
  row.reach = laser.range_max;
  row.dependency_radius = laser.scan_time > 0.0 ? 0.0 : laser.range_max;  // else also on earlier poses
  row.sweep = laser.scan_time;
  const raycast::ScanNoise& noise = laser.noise;
  row.sigma = noise.angle_sigma > 0.0  // a beam that turns may hit another surface
                  ? HUGE_VAL
                  : base::hypot(noise.range_sigma, noise.range_proportional * laser.range_max);
  return row;
}

ParsedSensors parse_lasers(const world::World& world) {
  std::vector<SensorSpec> rows;
  std::vector<CastLaser> lasers;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    std::uint32_t number = 0;
    for (const LaserSettings& laser : lasers_of(world.movers[m]))
      rows.push_back(spec_of(lasers.emplace_back(cast_laser(world, laser)), m, number++));
  }
  return {std::move(rows), std::move(lasers)};
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
    .parse = parse_lasers,
    .make = make_backend<Lasers>,
    .wire_problem = laser_wire_problem,
    .parts = laser_parts,
    .encode = encode_laser,
    .wire_error = laser_wire_error,
    .decode = decode_laser,
    .read = fill_laser,
};

}  // namespace sf::sensors
