#include "scenarios/recording_verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include "base/thread_pool.h"
#include "base/tilted_pose.h"
#include "farm/farm.h"
#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "scenarios/fault_tables.h"
#include "scenarios/recorded_states.h"
#include "scenarios/run_info.h"
#include "sensors/bumper.h"
#include "sensors/derived/wiring.h"
#include "sensors/laser.h"
#include "sensors/laser_noise.h"
#include "sensors/laser_reference.h"
#include "sensors/occupancy.h"

namespace sf::scenarios {

namespace {

/// Identity of a reading: type, mover, sensor, sequence.
using Name = std::tuple<std::uint8_t, std::uint32_t, std::uint32_t, std::uint32_t>;

/// Scans recomputed in parallel at a time.
constexpr std::size_t kBatch = 256;

/// @param allowed largest allowed difference; 0: bitwise equality
void compare(double ours, double theirs, double allowed, Comparison& into) {
  ++into.values;
  if (std::memcmp(&ours, &theirs, sizeof ours) == 0 || (std::isnan(ours) && std::isnan(theirs))) return;
  const double apart = std::abs(ours - theirs);
  into.largest = std::max(into.largest, std::isnan(apart) ? std::numeric_limits<double>::infinity() : apart);
  if (!(apart <= allowed)) ++into.different;
}

/// Compares one reading. @param where its location for messages
void compare(std::span<const double> ours, std::span<const double> theirs, const std::string& where, Comparison& into,
             double allowed = 0.0) {
  ++into.readings;
  const std::uint64_t before = into.different;
  if (ours.size() != theirs.size()) {
    ++into.different;
    into.largest = std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i) compare(ours[i], theirs[i], allowed, into);
  if (before == 0 && into.different > 0) into.first = where;
}

/// A recording without any mark has no surface that is too near, or the value of the sensor's minimum there.
bool any_marked(const record::Recording& recording) {
  return std::any_of(recording.readings.begin(), recording.readings.end(), [](const record::ReadingSample& reading) {
    return std::find(reading.values.begin(), reading.values.end(), -HUGE_VAL) != reading.values.end();
  });
}

bool has_near(const base::ReadingBlock& scan) {
  return std::find(scan.quality.begin(), scan.quality.end(), base::QualityFlag::too_near) != scan.quality.end();
}

/// Returns a caster that reproduces the recorded bytes: the recorded one if its bytes are unique, else any other.
const raycast::CasterType& caster_of(const record::Recording& recording, bool software) {
  const std::string_view described = record::option_of(recording.info, "caster");
  for (const raycast::CasterType* type : raycast::casters())
    if (!type->same_bytes && described.substr(0, described.find(',')) == type->name) return *type;
  const raycast::CasterType& chosen = raycast::choose_caster(software);
  return chosen.same_bytes ? chosen : raycast::host_caster;
}

/// A scan to be recomputed by plain C++.
struct Asked {
  std::uint32_t mover, sensor, sequence;
  std::size_t tick;            ///< of its measurement, or the next one
  std::int64_t time;           ///< [ns] of the measurement
  std::vector<double> ranges;  ///< [m] as recorded, or as computed by this device
  double allowed;              ///< [m] largest allowed difference; 0: bitwise equality
};

class Verifier {
 public:
  Verifier(const record::Recording& recording, gpu::Device& device, const VerifyOptions& options)
      : recording_(recording),
        options_(options),
        world_(recorded_world(recording)),
        shapes_(recording, world_),
        caster_(caster_of(recording, device.info().software)),
        farm_(world_, device,
              {.seed = recording.info.seed,
               .threads = options.threads,
               .scene = {.caster = &caster_},
               .faults = recorded_faults(recording)}),
        earlier_world_(recording.shapes.empty() ? std::nullopt : std::optional(world_)),
        reference_(earlier_world_ ? *earlier_world_ : world_, recording.info.seed),
        longest_(sensors::reaches_of(world_).longest),
        infinite_(record::option_of(recording.info, record::kNoReturn) == "inf"),
        marks_too_near_(any_marked(recording)),
        is_earlier_(!marks_too_near_ && record::option_of(recording.info, record::kTooNear).empty()),
        near_(world_.movers.size()) {
    for (std::size_t i = 0; i < recording.readings.size(); ++i) {
      const record::ReadingSample& r = recording.readings[i];
      readings_[{r.type, r.mover, r.sensor, r.sequence}] = i;
    }
    if (earlier_world_) reference_shapes_.emplace(recording, *earlier_world_);
    farm_.subscribe_all();
    const auto nodes = sensors::wire(world_, farm_.sensor_set());
    for (std::size_t before = 1; before != from_received_.size();) {
      before = from_received_.size();
      for (const sensors::DerivedNode& node : nodes)
        for (const sensors::WiredInput& input : node.inputs)
          if (input.type == sensors::kCameraInput || input.type == sensors::kV2vInput ||
              from_received_.contains({input.type, input.mover, input.sensor}))
            from_received_.insert({node.type->id, node.spec.mover, node.spec.sensor});
    }
  }

  Verification run() {
    result_.reference.type = "laser";
    result_.damage = recording_.damage;
    result_.truncated = recording_.truncated;
    if (recording_.truncated && recording_.ticks == 0) {
      result_.damage.push_back("the recording was cut off before its first tick: nothing was compared");
      return std::move(result_);
    }
    if (!has_all_states(recording_)) {
      result_.damage.push_back("ticks without the states of all movers: nothing was compared");
      return std::move(result_);
    }
    count_scans();
    if (recording_.info.estimated) {
      verify_estimated();
    } else {
      verify_simulated();
    }
    result_.scans = seen_;
    for (auto& [type, compared] : again_) result_.recomputed.push_back(std::move(compared));
    return std::move(result_);
  }

 private:
  void verify_simulated() {
    const std::size_t ticks = recording_.states.empty() ? 0 : recording_.states[0].size();
    for (std::size_t t = 0; t < ticks; ++t) {
      look_at_tick(t);
      if (asked_.size() >= kBatch || t + 1 == ticks) cast_again();
      ++result_.ticks;
      if (options_.progress && !options_.progress(static_cast<double>(t + 1) / static_cast<double>(ticks))) break;
    }
    cast_again();
    result_.interrupted = result_.ticks < ticks;
    result_.missing = !result_.interrupted ? readings_.size() : 0;
    if (unfelt_ > 0)
      result_.skipped.push_back(
          fmt::format("{} readings of bumpers: where a robot was touched is not recorded", unfelt_));
    if (marks_ != recording_.faults && !result_.interrupted && !recording_.truncated)
      result_.damage.push_back(fmt::format("{} marks of faulty readings, but {} when recomputed, or others",
                                           recording_.faults.size(), marks_.size()));
    if (received_ > 0)
      result_.skipped.push_back(fmt::format(
          "{} readings computed from poses of cameras or states by V2V: what robots received is not recorded",
          received_));
    if (faulty_scans_ > 0)
      result_.skipped.push_back(
          fmt::format("{} faulty scans in plain C++, which has no faults of sensors", faulty_scans_));
    add_spatial();
    if (near_maps_ > 0)
      result_.skipped.push_back(
          fmt::format("{} occupancy maps: earlier versions treated surfaces nearer than a laser's minimum as obstacles",
                      near_maps_));
    if (recording_.readings.empty() && farm_.sensor_set().group(sensors::kLaser) == nullptr)
      result_.skipped.emplace_back(
          "all readings: none were recorded, and no robot has a laser to compare with plain C++");
  }

  void add_spatial() {
    if (spatial_scans_ > 0)
      result_.skipped.push_back(
          fmt::format("{} scans of rolling or tilted lasers or on terrain in plain C++, which casts level ones "
                      "from one pose",
                      spatial_scans_));
  }

  /// A service's readings are those that robots subscribed to, at times of its clock. Only scans can be recomputed,
  /// each from the states at its own time.
  void verify_estimated() {
    std::uint64_t others = 0, lost = 0;
    for (const record::ReadingSample& r : recording_.readings) {
      if (r.type != sensors::kLaser) {
        ++others;
      } else if (!has_states_at(r.time)) {
        ++lost;
      } else if (is_spatial(r.mover, r.sensor, recording_.states[r.mover][tick_at(r.time)].tilt)) {
        ++spatial_scans_;
      } else if (seen_++ % stride_ == 0) {
        const std::size_t tick = tick_at(r.time);
        asked_.push_back({r.mover, r.sensor, r.sequence, tick, r.time, r.values, allowed_at(r.mover, r.sensor, tick)});
      }
      if (asked_.size() < kBatch) continue;
      cast_again();
      const auto done = static_cast<double>(&r - recording_.readings.data());
      result_.interrupted =
          options_.progress && !options_.progress(done / static_cast<double>(recording_.readings.size()));
      if (result_.interrupted) return;
    }
    cast_again();
    result_.ticks = recording_.ticks;
    add_spatial();
    if (recording_.readings.empty()) result_.skipped.push_back("no robot requested readings");
    if (lost > 0)
      result_.skipped.push_back(fmt::format("{} scans: the states at their times are missing or damaged", lost));
    if (others > 0)
      result_.skipped.push_back(fmt::format("{} readings of other sensors: a service measures on request", others));
  }

  void look_at_tick(std::size_t tick) {
    if (shapes_.go_to(recording_.states[0][tick].time)) farm_.update_outlines();
    recorded_reports(recording_, tick, reports_);
    set_absent(reports_, farm_);
    const std::int64_t time = reports_[0].time;
    const auto look_at = [this](std::span<const base::ReadingBlock> readings) {
      for (const base::FaultMark& mark : farm_.fault_marks()) {
        marks_.push_back(mark);
        faulty_.insert({mark.type, mark.mover, mark.sensor, mark.sequence});
      }
      for (const base::ReadingBlock& reading : readings) check_reading(reading);
    };
    for (std::int64_t due = farm_.next_due(); tick > 0 && due < time; due = farm_.next_due())
      look_at(farm_.sample_between(due, reports_));
    commands_.clear();
    for (const auto& states : recording_.states) commands_.push_back(states[tick].command);
    farm_.set_commands(commands_);
    look_at(farm_.tick(time, reports_));
  }

  /// Returns the poses of all movers at the time of `asked`.
  void poses_of(const Asked& asked, std::vector<base::Pose>& poses) const {
    poses.clear();
    for (const auto& states : recording_.states) {
      const record::StateSample& s = states[asked.tick];
      const base::Report after = record::report_of(s, 0);
      const record::StateSample& p = states[asked.tick - (asked.time < s.time ? 1 : 0)];
      const base::Report before = record::report_of(p, 0);
      const bool between = asked.time < s.time && !base::is_absent(p.X_WM) && !base::is_absent(s.X_WM);
      poses.push_back(between ? robots::interpolate(before, after, asked.time).X_WM : s.X_WM);
    }
  }

  /// Counts all scans, so that a sample is spread evenly.
  void count_scans() {
    const auto is_scan = [](const record::ReadingSample& r) { return r.type == sensors::kLaser; };
    auto all = static_cast<std::size_t>(std::count_if(recording_.readings.begin(), recording_.readings.end(), is_scan));
    recorded_ = all > 0;
    const auto* const lasers = farm_.sensor_set().group(sensors::kLaser);
    if (all == 0 && lasers != nullptr)
      for (const sensors::SensorSpec& laser : lasers->rows)
        all += static_cast<std::size_t>(1.0 + laser.rate * 1e-9 * static_cast<double>(recording_.end_time));
    stride_ = options_.sample == 0 ? 1 : std::max<std::size_t>(1, all / options_.sample);
  }

  /// Returns whether a recorded tick has exactly this time.
  bool has_states_at(std::int64_t time) const {
    const auto& all = recording_.states;
    return !all.empty() && !all[0].empty() && all[0][tick_at(time)].time == time;
  }

  std::size_t tick_at(std::int64_t time) const {
    const auto& states = recording_.states[0];
    const auto at = std::lower_bound(states.begin(), states.end(), time,
                                     [](const record::StateSample& s, std::int64_t t) { return s.time < t; });
    return std::min(static_cast<std::size_t>(at - states.begin()), states.size() - 1);
  }

  std::string place_of(const base::ReadingBlock& r) const {
    return fmt::format("{}, sensor {}, {:g} s", world_.movers[r.mover].name, r.sensor,
                       1e-9 * static_cast<double>(r.time));
  }

  void check_reading(const base::ReadingBlock& reading) {
    const bool is_scan = reading.type == sensors::kLaser;
    const auto at = readings_.find({reading.type, reading.mover, reading.sensor, reading.sequence});
    if (at == readings_.end()) {
      if (is_scan && !recorded_)
        ask(reading, message_ranges(reading.mover, reading.sensor, reading.values, reading.quality));
      return;
    }
    const std::vector<double>& theirs = recording_.readings[at->second].values;
    readings_.erase(at);
    if (reading.type == sensors::kBumper) {
      ++unfelt_;
      return;
    }
    if (from_received_.contains({reading.type, reading.mover, reading.sensor})) {
      ++received_;
      return;
    }
    near_[reading.mover] = near_[reading.mover] || (is_scan && has_near(reading));
    if (reading.type == sensors::kOccupancy && is_earlier_ && near_[reading.mover]) {
      ++near_maps_;
      return;
    }
    if (!is_scan)
      return compare(message_values(reading.values, reading.quality), theirs, place_of(reading),
                     compared(reading.type));
    const std::vector<double> ours = message_ranges(reading.mover, reading.sensor, reading.values, reading.quality);
    compare(ours, settled(laser_of(reading.mover, reading.sensor), theirs), place_of(reading), compared(reading.type));
    ask(reading, theirs);
  }

  /// Returns the allowed difference from plain C++: the bound of 32-bit modes, or of a caster with its own bytes, and
  /// the precision of recordings. Other modes are compared bitwise.
  double allowed_of(std::uint32_t mover, std::uint32_t sensor, const base::Pose& X_WS) const {
    const sensors::CastLaser& cast = reference_.laser(mover, sensor);
    if (!cast.single && caster_.same_bytes) return 0.0;
    const double range_max = cast.laser.range_max;
    const double farthest = std::max(std::abs(X_WS.x), std::abs(X_WS.y)) + range_max;
    double bound = sensors::laser_bound(range_max, cast.single, longest_, farthest);
    if (!caster_.same_bytes) bound += caster_.bound(range_max, longest_, farthest);
    // Noise proportional to the range scales with the error of the range.
    return (1.0 + 8.0 * cast.laser.noise.range_proportional) * bound + recorded_rounding(range_max);
  }

  /// The same for a reading of which only the scan is recorded, at the sensor's pose at a tick.
  double allowed_at(std::uint32_t mover, std::uint32_t sensor, std::size_t tick) const {
    const base::Pose& X_MS = reference_.laser(mover, sensor).laser.X_MS;
    return allowed_of(mover, sensor, base::compose(recording_.states[mover][tick].X_WM, X_MS));
  }

  /// Returns values as they appear in messages.
  /// @param flags of the reading's elements; empty: none
  std::vector<double> message_values(std::span<const double> values, std::span<const base::QualityFlag> flags) const {
    std::vector<double> all(values.begin(), values.end());
    if (marks_too_near_) base::mark_too_near(flags, all);
    return all;
  }

  const sensors::SensorSpec& laser_of(std::uint32_t mover, std::uint32_t sensor) const {
    return farm_.sensor_set().of(sensors::kLaser, mover)[sensor];
  }

  /// Treats the last float32 before range_max as no echo, and one below range_min as range_min, because earlier
  /// versions rounded ranges in this way.
  std::vector<double> settled(const sensors::SensorSpec& laser, std::vector<double> ranges) const {
    const double none = infinite_ ? HUGE_VAL : laser.limit;
    const double first = base::float_above(laser.range_min);
    const double last = base::rep117_range(std::nextafter(laser.limit, 0.0), limits_of(laser));
    for (double& range : ranges) {
      if (range >= last) range = none;
      if (std::isfinite(range)) range = std::max(range, first);
    }
    return ranges;
  }

  /// Returns ranges as they appear in recorded scans.
  std::vector<double> message_ranges(std::uint32_t mover, std::uint32_t sensor, std::span<const double> ranges,
                                     std::span<const base::QualityFlag> flags) const {
    const sensors::SensorSpec& laser = laser_of(mover, sensor);
    std::vector<double> all = message_values(ranges, flags);
    for (double& range : all) range = base::rep117_range(range, limits_of(laser));
    return settled(laser, std::move(all));
  }

  /// True for scans that are not planar: on terrain, of tilted robots or lasers, or rolling ones.
  bool is_spatial(std::uint32_t mover, std::uint32_t sensor, const base::Tilt& tilt) const {
    const sensors::LaserSettings& laser = reference_.laser(mover, sensor).laser;
    return !world_.terrain.empty() || !base::is_level(tilt) || !base::is_level(laser.tilt) || laser.scan_time > 0.0;
  }

  /// Adds every `stride_`-th scan to the list for plain C++.
  void ask(const base::ReadingBlock& reading, const std::vector<double>& ranges) {
    if (faulty_.contains({reading.type, reading.mover, reading.sensor, reading.sequence})) {
      ++faulty_scans_;
      return;
    }
    if (is_spatial(reading.mover, reading.sensor, reading.tilt)) {
      ++spatial_scans_;
      return;
    }
    if (seen_++ % stride_ == 0)
      asked_.push_back({reading.mover, reading.sensor, reading.sequence, tick_at(reading.time), reading.time, ranges,
                        allowed_of(reading.mover, reading.sensor, reading.X_WS)});
  }

  /// Recomputes the collected scans in plain C++, grouped by time, because scans at one time share the movers' poses.
  void cast_again() {
    std::stable_sort(asked_.begin(), asked_.end(), [](const Asked& a, const Asked& b) { return a.time < b.time; });
    std::vector<std::vector<double>> scans(asked_.size());
    std::vector<base::Pose> poses;
    for (std::size_t first = 0; first < asked_.size();) {
      std::size_t last = first;
      while (last < asked_.size() && asked_[last].time == asked_[first].time) ++last;
      poses_of(asked_[first], poses);
      // Delayed scans may be older than those compared before them.
      if (reference_shapes_) reference_shapes_->go_to(recording_.states[0][asked_[first].tick].time);
      reference_.set_poses(poses);
      farm_.thread_pool().parallel_for(last - first, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = first + begin; i < first + end; ++i) scans[i] = cast_in_plain_cpp(asked_[i]);
      });
      first = last;
    }
    for (std::size_t i = 0; i < asked_.size(); ++i) judge(asked_[i], std::move(scans[i]));
    asked_.clear();
  }

  /// Computes a scan in plain C++, in the form of recorded scans. Errors of 32-bit ranges may cross range_min, where
  /// noise is added on one side only; such beams are taken on the side of `asked`.
  std::vector<double> cast_in_plain_cpp(const Asked& asked) const {
    const auto cast = [&](double slack) {
      const auto scan = reference_.scan(asked.mover, asked.sensor, asked.sequence, slack);
      return message_ranges(asked.mover, asked.sensor, scan.ranges, scan.quality);
    };
    std::vector<double> ours = cast(0.0);
    const auto agree = [](double a, double b) { return (a == -HUGE_VAL) == (b == -HUGE_VAL); };
    const std::size_t count = std::min(ours.size(), asked.ranges.size());
    if (asked.allowed == 0.0 || std::equal(ours.begin(), ours.begin() + count, asked.ranges.begin(), agree))
      return ours;
    for (const double slack : {-asked.allowed, asked.allowed}) {
      const std::vector<double> other = cast(slack);
      for (std::size_t i = 0; i < count; ++i)
        if (!agree(ours[i], asked.ranges[i]) && agree(other[i], asked.ranges[i])) ours[i] = other[i];
    }
    return ours;
  }

  void judge(const Asked& asked, std::vector<double> ours) {
    const sensors::SensorSpec& laser = laser_of(asked.mover, asked.sensor);
    std::vector<double> theirs = settled(laser, asked.ranges);
    // Errors of 32-bit ranges may reach range_max, where no echo is infinity.
    for (std::vector<double>* const ranges : {&ours, &theirs})
      if (asked.allowed > 0.0) std::replace(ranges->begin(), ranges->end(), HUGE_VAL, laser.limit);
    compare(ours, theirs,
            fmt::format("{}, laser {}, reading {}", world_.movers[asked.mover].name, asked.sensor, asked.sequence),
            result_.reference, asked.allowed);
  }

  Comparison& compared(std::uint8_t type) {
    Comparison& into = again_[type];
    if (into.type.empty()) into.type = sensors::find_sensor_type(type)->name;
    return into;
  }

  const record::Recording& recording_;
  const VerifyOptions& options_;
  world::World world_;  ///< with the shapes of the current tick
  RecordedShapes shapes_;
  const raycast::CasterType& caster_;
  farm::Farm farm_;
  std::optional<world::World> earlier_world_;  ///< of `reference_` if shapes change
  std::optional<RecordedShapes> reference_shapes_;
  sensors::LaserReference reference_;
  const double longest_;                  ///< [m] surface of the world
  const bool infinite_;                   ///< beams without a return are recorded as infinity
  const bool marks_too_near_;             ///< ranges of surfaces that are too near are recorded as -infinity
  const bool is_earlier_;                 ///< recorded by a version without these marks, or without such surfaces
  std::vector<bool> near_;                ///< per mover: whether its lasers had such surfaces
  bool recorded_ = false;                 ///< whether the recording has scans
  std::map<Name, std::size_t> readings_;  ///< recorded readings not yet compared
  std::vector<base::Report> reports_;     ///< of one tick
  std::vector<base::Twist> commands_;
  std::map<std::uint8_t, Comparison> again_;
  std::vector<Asked> asked_;
  std::size_t stride_ = 1, seen_ = 0;
  std::uint64_t unfelt_ = 0, near_maps_ = 0, faulty_scans_ = 0, spatial_scans_ = 0, received_ = 0;
  /// Type, mover and number of derived sensors that depend on what robots received.
  std::set<std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>> from_received_;
  std::vector<base::FaultMark> marks_;  ///< of all recomputed readings
  std::set<Name> faulty_;               ///< their readings
  Verification result_;
};

}  // namespace

std::uint64_t Verification::compared() const {
  std::uint64_t readings = reference.readings;
  for (const Comparison& c : recomputed) readings += c.readings;
  return readings;
}

bool Verification::faulty() const {
  const auto differs = [](const Comparison& c) { return c.different > 0; };
  return differs(reference) || std::any_of(recomputed.begin(), recomputed.end(), differs) || missing > 0 ||
         !damage.empty();
}

Verification verify(const record::Recording& recording, gpu::Device& device, const VerifyOptions& options) {
  return Verifier(recording, device, options).run();
}

}  // namespace sf::scenarios
