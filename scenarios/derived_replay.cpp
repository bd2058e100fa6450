#include "scenarios/derived_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "base/thread_pool.h"
#include "base/time.h"
#include "farm/derivation.h"
#include "farm/farm.h"
#include "farm/stored_reading.h"
#include "record/topic_names.h"
#include "scenarios/fault_tables.h"
#include "scenarios/recorded_states.h"
#include "scenarios/run_info.h"

namespace sf::scenarios {

namespace {

constexpr double kMostDerived = 1e9;  // readings

/// A recorded reading of a measured sensor, in order of processing.
struct Feed {
  std::int64_t time;  ///< [ns] of the measurement, after which `Delivery` adds the latency; if `late`, of the delivery
  std::size_t reading;
  bool late;  ///< delivered at `time`
};

/// The faults of the recorded run; derived sensors have theirs again.
std::vector<farm::Fault> faults_of(const DerivedSource& source) {
  return source.foreign ? std::vector<farm::Fault>() : recorded_faults(source.recording);
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::memcmp(&x, &y, sizeof x) == 0 || (std::isnan(x) && std::isnan(y));
  });
}

class Replayer {
 public:
  Replayer(const DerivedSource& source, const DerivedReplayOptions& options)
      : source_(source),
        recording_(source.recording),
        device_(std::string(gpu::kHostDevice)),
        thread_pool_(options.threads),
        sensor_set_(source.world),
        derivation_(context(), sensor_set_),
        faults_(source.world, sensor_set_, faults_of(source), recording_.info.seed, true, thread_pool_),
        delivery_(sensor_set_, &faults_),
        subscribed_(source.world.movers.size(), 0) {
    if (derivation_.empty())
      throw base::InputError(recording_.file, 0, "no derived sensors: list them as [[derived]] in the file of --with");
    if (recording_.readings.empty())
      throw base::InputError(recording_.file, 0,
                             "has no readings to derive from: record the run with --record-readings");
    if (!has_all_states(recording_) || recording_.ticks == 0)
      throw base::InputError(recording_.file, 0, "has no ticks with the states of all movers: nothing can be derived");
    refuse_endless();
    // The times at which sensors measured are times at which late readings were delivered.
    if (!source.foreign && !recording_.info.estimated)
      for (const sensors::SensorSet::Group& group : sensor_set_.groups())
        if (group.type->derived == nullptr) measured_.emplace_back(context(), group, false);
    for (std::size_t i = 0; i < recording_.readings.size(); ++i) add_feed(i);
    std::ranges::stable_sort(feeds_, {}, &Feed::time);
  }

  DerivedReplay run(base::Sink& sink, const DerivedReplayOptions& options) {
    const auto ticks = recording_.states[0].size();
    for (std::size_t t = 0; t < ticks; ++t) {
      sink.write(tick(t));
      ++result_.ticks;
      const double done = static_cast<double>(t + 1) / static_cast<double>(ticks);
      result_.interrupted = options.progress && !options.progress(done);
      if (result_.interrupted) break;
    }
    result_.never_valid = derivation_.sensors().never_valid();
    return std::move(result_);
  }

 private:
  using Key = std::tuple<std::uint8_t, std::uint32_t, std::uint32_t, std::uint32_t>;  // type, mover, sensor, sequence

  sensors::SensorContext context() { return {source_.world, device_, thread_pool_, states_}; }
  std::int64_t tick_time(std::size_t t) const { return recording_.states[0][t].time; }
  void refuse_endless() const;
  void add_feed(std::size_t row);
  void subscribe();
  std::int64_t next_call() const;
  void call(std::int64_t now);
  base::ReadingBlock block_of(const record::ReadingSample& reading) const;
  void keep(const base::ReadingBlock& reading);
  base::TickRecord tick(std::size_t t);

  const DerivedSource& source_;
  const record::Recording& recording_;
  gpu::Device device_;  ///< for the context; nothing is measured
  base::ThreadPool thread_pool_;
  std::vector<base::Report> states_;
  sensors::SensorSet sensor_set_;
  farm::Derivation derivation_;
  farm::Faults faults_;
  farm::Delivery delivery_;
  std::vector<farm::SensorPipeline> measured_;
  std::vector<base::SensorTypes> subscribed_;
  std::vector<Feed> feeds_;
  std::size_t next_feed_ = 0;
  std::size_t next_fault_ = 0;           ///< row of the recorded marks
  std::map<Key, std::size_t> recorded_;  ///< readings of derived sensors
  std::vector<base::ReadingBlock> measured_now_, delivered_;
  std::vector<farm::StoredReading> kept_;  ///< of the current tick
  std::size_t kept_count_ = 0;
  std::vector<base::ReadingBlock> readings_;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
  std::vector<base::StateQuality> qualities_;
  DerivedReplay result_;
};

/// Bounds the work before it starts: a damaged recording may have arbitrary times.
void Replayer::refuse_endless() const {
  const auto& ticks = recording_.states[0];
  const auto is_back = [](const record::StateSample& a, const record::StateSample& b) { return b.time <= a.time; };
  if (tick_time(0) < 0 || std::ranges::adjacent_find(ticks, is_back) != ticks.end())
    throw base::InputError(recording_.file, 0, "the times of its ticks do not increase: it is damaged");
  const std::size_t last = ticks.size() - 1;
  const double seconds = 1e-9 * (static_cast<double>(tick_time(last)) - static_cast<double>(tick_time(0)));
  double rates = 0.0, fastest = 0.0;
  for (const sensors::SensorSet::Group& group : sensor_set_.groups())
    for (const sensors::SensorSpec& row : group.rows) {
      rates += group.type->derived != nullptr ? row.rate : 0.0;
      fastest = std::max(fastest, row.rate);
    }
  if (seconds * std::max(rates, fastest) <= kMostDerived) return;
  throw base::InputError(
      recording_.file, 0,
      fmt::format("spans {:.0f} s, in which derived sensors would have more than a billion readings", seconds));
}

void Replayer::add_feed(std::size_t row) {
  const record::ReadingSample& reading = recording_.readings[row];
  const sensors::SensorType* const type = sensors::find_sensor_type(reading.type);
  const auto sensors = type == nullptr || sensor_set_.group(reading.type) == nullptr
                           ? std::span<const sensors::SensorSpec>()
                           : sensor_set_.of(reading.type, reading.mover);
  const std::size_t expected =
      reading.sensor < sensors.size()
          ? sensors[reading.sensor].elements * sensors::element_width(*type, sensors[reading.sensor])
          : 0;
  if (reading.time < 0 || expected == 0 || reading.values.size() != expected)
    throw base::InputError(
        recording_.file, 0,
        fmt::format("a reading of sensor {} of type {} of '{}' does not fit its world: it has {} numbers; expected {}",
                    reading.sensor, reading.type, source_.world.movers.at(reading.mover).name, reading.values.size(),
                    expected));
  if (type->derived != nullptr) {
    recorded_[{reading.type, reading.mover, reading.sensor, reading.sequence}] = row;
    return;
  }
  const std::int64_t prompt = reading.time + base::nanoseconds(sensors[reading.sensor].latency);
  const auto& ticks = recording_.states[0];
  const auto first = std::ranges::lower_bound(ticks, prompt, {}, &record::StateSample::time);
  // Faults may have delayed it.
  const bool late = source_.foreign || (first != ticks.end() && reading.delivered > first->time);
  feeds_.push_back({late ? reading.delivered : reading.time, row, late});
}

/// Absent robots have no readings; their derived sensors start over when they return.
void Replayer::subscribe() {
  bool changed = result_.ticks == 0;
  for (std::size_t m = 0; m < subscribed_.size(); ++m) {
    const bool present = source_.foreign || !base::is_absent(states_[m].X_WM);
    changed = changed || (subscribed_[m] != 0) != present;
    subscribed_[m] = present ? farm::kAllSensorTypes : 0;
  }
  if (changed) derivation_.update_demand(subscribed_, measured_);
}

std::int64_t Replayer::next_call() const {
  std::int64_t next = derivation_.next_due(subscribed_);
  for (const farm::SensorPipeline& pipeline : measured_) next = std::min(next, pipeline.next_due(subscribed_));
  return next_feed_ < feeds_.size() ? std::min(next, feeds_[next_feed_].time) : next;
}

base::ReadingBlock Replayer::block_of(const record::ReadingSample& reading) const {
  return {.mover = reading.mover,
          .sensor = reading.sensor,
          .type = reading.type,
          .sequence = reading.sequence,
          .time = reading.time,
          .X_WM = states_[reading.mover].X_WM,
          .tilt = states_[reading.mover].tilt,
          .X_WS = base::kAbsent,
          .values = reading.values,
          .sigma = HUGE_VAL};
}

void Replayer::call(std::int64_t now) {
  faults_.begin();
  measured_now_.clear();
  delivered_.clear();
  for (; next_feed_ < feeds_.size() && feeds_[next_feed_].time <= now; ++next_feed_)
    (feeds_[next_feed_].late ? delivered_ : measured_now_)
        .push_back(block_of(recording_.readings[feeds_[next_feed_].reading]));
  for (farm::SensorPipeline& pipeline : measured_) pipeline.find_due(now, subscribed_);
  derivation_.find_due(now, subscribed_);
  const auto prompt = delivery_.deliver(now, measured_now_);
  delivered_.insert(delivered_.begin(), prompt.begin(), prompt.end());
  for (const base::ReadingBlock& reading :
       derivation_.derive(now, delivered_, states_, faults_, delivery_, subscribed_))
    keep(reading);
}

void Replayer::keep(const base::ReadingBlock& reading) {
  if (kept_.size() == kept_count_) kept_.emplace_back();
  kept_[kept_count_++].take(reading);
  if (sensors::find_sensor_type(reading.type)->derived == nullptr) {
    ++result_.inputs;
    return;
  }
  ++result_.derived;
  const auto found = recorded_.find({reading.type, reading.mover, reading.sensor, reading.sequence});
  if (found == recorded_.end()) return;
  const bool equal = same_bits(reading.values, recording_.readings[found->second].values);
  ++(equal ? result_.equal : result_.different);
  if (!equal && result_.different == 1)
    result_.first = fmt::format("'{}' of '{}' at {:.3f} s", sensor_set_.row(reading).name,
                                source_.world.movers[reading.mover].name, 1e-9 * static_cast<double>(reading.time));
}

base::TickRecord Replayer::tick(std::size_t t) {
  recorded_reports(recording_, t, states_);
  subscribe();
  kept_count_ = 0;
  const std::int64_t time = tick_time(t);
  for (std::int64_t due = next_call(); t > 0 && due < time; due = next_call()) call(due);
  commands_.clear();
  contacts_.clear();
  for (const auto& states : recording_.states) {
    commands_.push_back(states[t].command);
    contacts_.push_back(states[t].contact ? 1 : 0);
  }
  if (!source_.foreign && !recording_.info.estimated) derivation_.set_commands(commands_);
  call(time);
  readings_.clear();
  for (std::size_t i = 0; i < kept_count_; ++i) readings_.push_back(kept_[i].block());
  if (recording_.info.estimated) qualities_.resize(states_.size());
  std::span<const base::LightStatus> lights;
  if (t < recording_.lights.size()) lights = recording_.lights[t].lights;
  if (lights.size() != source_.world.lights.size()) lights = {};
  const std::size_t fault = next_fault_;
  while (next_fault_ < recording_.faults.size() && recording_.faults[next_fault_].time <= time) ++next_fault_;
  const auto marks = std::span(recording_.faults).subspan(fault, next_fault_ - fault);
  return {recording_.states[0][t].tick, time, states_, commands_, contacts_, readings_, qualities_, lights, marks};
}

}  // namespace

record::RunInfo derived_run_info(const DerivedSource& source) {
  const record::RunInfo& recorded = source.recording.info;
  const sensors::SensorSet sensor_set(source.world);
  record::RunInfo info = run_info(source.world, sensor_set,
                                  {.seed = recorded.seed,
                                   .record_readings = true,
                                   .no_return_inf = record::option_of(recorded, record::kNoReturn) == "inf",
                                   .caster = std::string(record::option_of(recorded, "caster")),
                                   .estimated = recorded.estimated,
                                   .too_near_min = !record::option_of(recorded, record::kTooNear).empty(),
                                   .naming = record::naming_of(recorded)});
  info.world = recorded.world;
  info.mode = recorded.mode;
  info.interval = recorded.interval;
  for (const auto& option : recorded.options)
    if (option.first != "states" && record::option_of(info, option.first).empty()) info.options.push_back(option);
  return info;
}

DerivedReplay replay_derived(const DerivedSource& source, base::Sink& sink, const DerivedReplayOptions& options) {
  return Replayer(source, options).run(sink, options);
}

}  // namespace sf::scenarios
