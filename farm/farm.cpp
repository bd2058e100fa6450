#include "farm/farm.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/thread_pool.h"
#include "farm/copy_calls.h"
#include "farm/delivery.h"
#include "farm/derivation.h"
#include "farm/faults.h"
#include "farm/pose_changes.h"
#include "farm/processor_budget.h"
#include "farm/sensor_pipeline.h"
#include "gpu/batch.h"
#include "robots/fleet.h"
#include "robots/kinematics.h"
#include "sensors/laser_noise.h"
#include "sensors/occupancy.h"

namespace sf::farm {

namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time since the last lap to a counter. For statistics only; results do not depend on it.
class Stopwatch {
 public:
  void lap(double& total) {
    const auto now = Clock::now();
    total += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

struct Farm::State {
  const world::World& world;
  gpu::Device& device;
  base::ThreadPool thread_pool;
  sensors::SensorSet sensor_set;
  raycast::Episodes episodes;
  bool reuse_unchanged;
  bool no_return_inf;
  std::vector<std::vector<double>> marked;  ///< per thread: ranges as sent
  std::vector<SensorPipeline> pipelines;    ///< of all types except derived ones
  std::unique_ptr<Derivation> derivation;
  std::span<const base::Twist> commands;         ///< for the next tick
  std::span<const base::ReadingBlock> received;  ///< for the next tick
  bool demand_changed = true;                    ///< subscriptions have changed since `update_demand`
  std::unique_ptr<gpu::Batch> batch;
  bool must_record = false;  ///< the batch is new
  Faults faults;
  Fuse fuse;
  Delivery delivery;
  std::optional<ProcessorBudget> budget;      ///< nullopt: no limit
  std::vector<SensorPipeline*> budgeted;      ///< all, for `budget`
  std::unique_ptr<PoseChanges> pose_changes;  ///< of the current tick
  std::vector<base::Report> states;           ///< per mover, as sensed in this tick or sample; backends view it
  std::vector<base::Report> tick_states;      ///< of the last tick, while samples follow it
  bool between = false;                       ///< `states` belongs to a sample
  std::vector<base::SensorTypes> subscribed;  ///< per mover
  std::vector<std::uint8_t> gone;             ///< per mover
  std::vector<base::StateQuality> qualities;  ///< per mover; empty: none was set
  std::vector<base::ReadingBlock> blocks;
  SensorPipeline* lender = nullptr;   ///< its vector of readings is swapped with `blocks`
  std::vector<std::uint64_t> hashes;  ///< of the readings of one tick
  FarmStats stats;
  sensors::SensorStats earlier_work;  ///< of replaced backends
  CopyCalls calls;
  std::optional<Sharing> sharing;  ///< nullopt: this farm senses the whole fleet
  FarmOptions options;
  std::int64_t last_call = -1;  ///< [ns] of the last tick or sample; -1: none yet
  std::int64_t last_tick = -1;  ///< [ns] of the last tick; -1: none yet

  State(const world::World& w, gpu::Device& d, const FarmOptions& given)
      : world(w),
        device(d),
        thread_pool(given.threads),
        sensor_set(w),
        episodes(w, given.seed),
        reuse_unchanged(given.reuse_unchanged),
        no_return_inf(given.no_return_inf),
        marked(thread_pool.threads()),
        faults(w, sensor_set, given.faults, given.seed, given.noise, thread_pool),
        delivery(sensor_set, &faults, episodes),
        states(robots::states_at_load(w)),
        subscribed(w.movers.size(), 0),
        gone(w.movers.size(), 0),
        calls(episodes),
        options(given) {
    SF_CHECK(w.unread.empty(), "the walls of " + w.unread.front().file + " are not read");
    pipelines = make_pipelines(sensor_set, states);
    derivation = std::make_unique<Derivation>(context_of(states), sensor_set);
    batch = std::make_unique<gpu::Batch>(device);
    pose_changes = std::make_unique<PoseChanges>(world);
    if (options.shared) sharing.emplace(sensor_set, w.movers.size());
    if (options.shared) {
      derivation->require_own_inputs(world);
      sensors::require_own_sources(world, sensor_set.settings_of<sensors::Occupancy>(sensors::kOccupancy));
    }
    if (options.processor_budget <= 0.0) return;
    SF_CHECK(!options.shared, "a budget for a shared fleet");
    if (!options.processor_clock) options.processor_clock = process_seconds;
    const double tick = options.budget_tick > 0.0 ? options.budget_tick : world.interval;
    budget.emplace(options.processor_budget / tick, 2.0 * options.processor_budget, derivation->sensors().nodes());
  }

  sensors::SensorContext context_of(std::span<const base::Report> sensed) {
    return {world, device, thread_pool, sensed, episodes, options.noise, options.true_poses, options.scene};
  }
  std::vector<SensorPipeline> make_pipelines(const sensors::SensorSet& of, std::span<const base::Report> sensed);
  std::shared_ptr<const void> add_mover();
  std::shared_ptr<const void> update_outlines();
  ReadingExchange* exchange() const { return sharing ? sharing->exchange() : nullptr; }
  bool is_gone(std::uint32_t mover) const { return gone.at(mover) != 0 || (sharing && sharing->is_hidden(mover)); }
  void begin_tick(bool is_sample);
  void find_calls();
  void apply(const base::Report& report);
  std::span<const base::ReadingBlock> read(std::int64_t now);
  std::span<const base::ReadingBlock> read_accumulated(std::int64_t now);
  std::span<const base::ReadingBlock> restart(std::span<const Restart> restarts, std::span<const base::Report> reports);
  void update_demand();
  bool find_due(std::int64_t now);
  void keep_budget(std::int64_t now);
  void prepare();
  void submit();
  void collect(SensorPipeline& pipeline, std::int64_t now, bool reuse);
  void clear_blocks();
  void append(SensorPipeline& pipeline);
  /// @param reuse whether cached readings may be used @param live a tick or sample: faults apply, and readings are
  /// fused
  void measure(std::int64_t now, bool reuse, bool live);
  void subscribe(std::uint32_t mover, base::SensorTypes types);
  void add_to_hash(std::int64_t now, std::span<const base::ReadingBlock> readings);
  std::span<const double> sent(const base::ReadingBlock& reading, unsigned thread);
};

/// @param of must outlive the pipelines, as must the states
std::vector<SensorPipeline> Farm::State::make_pipelines(const sensors::SensorSet& of,
                                                        std::span<const base::Report> sensed) {
  const sensors::SensorContext context = context_of(sensed);
  std::vector<SensorPipeline> made;
  for (const auto& group : of.groups()) {
    if (group.type->derived != nullptr) continue;
    device.set_owner(group.type->name);
    made.emplace_back(context, group);
  }
  blocks.reserve(of.count());
  hashes.reserve(of.count());
  return made;
}

/// Rebuilds all tables for the movers of the world, of which the last is new. Everything that can fail comes first.
std::shared_ptr<const void> Farm::State::add_mover() {
  SF_CHECK(exchange() == nullptr, "readings are exchanged");
  clear_blocks();
  sensors::SensorSet all(world);
  const base::Report absent{.mover = static_cast<std::uint32_t>(states.size()), .X_WM = base::kAbsent, .velocity = {}};
  std::vector<base::Report> sensed = states;
  sensed.push_back(absent);
  auto made = make_pipelines(all, sensed);
  struct Before {
    std::vector<SensorPipeline> pipelines;
    std::unique_ptr<Derivation> derivation;
  };
  auto before = std::make_shared<Before>(std::move(pipelines), std::move(derivation));
  batch = std::make_unique<gpu::Batch>(device);
  pipelines = std::move(made);
  states.swap(sensed);
  std::swap(sensor_set, all);  // `before` points into it
  derivation = std::make_unique<Derivation>(context_of(states), sensor_set);
  if (between) tick_states.resize(states.size(), absent);
  subscribed.resize(states.size(), 0);
  gone.resize(states.size(), 0);
  if (!qualities.empty()) qualities.resize(gone.size());
  pose_changes = std::make_unique<PoseChanges>(world);
  faults.add_sensors(world, sensor_set);
  delivery.add_sensors();
  if (sharing) sharing->add_mover(sensor_set);
  for (SensorPipeline& pipeline : pipelines) {
    const auto same = [&](const SensorPipeline& other) { return other.group->type == pipeline.group->type; };
    const auto old = std::find_if(before->pipelines.begin(), before->pipelines.end(), same);
    pipeline.go_on(old == before->pipelines.end() ? nullptr : &*old, last_tick, last_call);
  }
  derivation->go_on(*before->derivation, last_tick, last_call);
  if (budget) budget->set_derived(derivation->sensors().nodes());
  demand_changed = true;
  for (const SensorPipeline& pipeline : before->pipelines) earlier_work += pipeline.backend->stats();
  return before;
}

/// Updates the sensors whose tables allow it, and replaces the others. What can fail comes first.
std::shared_ptr<const void> Farm::State::update_outlines() {
  SF_CHECK(exchange() == nullptr, "readings are exchanged");
  clear_blocks();
  const sensors::SensorContext context = context_of(states);
  std::vector<std::pair<SensorPipeline*, SensorPipeline>> made;
  for (SensorPipeline& pipeline : pipelines) {
    pipeline.cache = ReadingCache(pipeline.group->rows, context.noise);
    if (pipeline.backend->update_outlines(world)) continue;
    device.set_owner(pipeline.group->type->name);
    made.emplace_back(&pipeline, SensorPipeline(context, *pipeline.group));
  }
  pose_changes = std::make_unique<PoseChanges>(world);
  auto before = std::make_shared<std::vector<SensorPipeline>>();
  if (made.empty()) return before;
  batch = std::make_unique<gpu::Batch>(device);
  must_record = demand_changed = true;
  for (auto& [pipeline, next] : made) {
    next.go_on(pipeline, last_tick, last_call);
    earlier_work += pipeline->backend->stats();
    before->push_back(std::exchange(*pipeline, std::move(next)));
  }
  return before;
}

void Farm::State::update_demand() {
  if (!std::exchange(demand_changed, false) || derivation->empty()) return;
  if (sharing)
    derivation->update_demand(sharing->delivered_types(), {});
  else
    derivation->update_demand(subscribed, pipelines, gone);
}

/// Finds the copies that take part in a sample: those with a due sensor.
void Farm::State::find_calls() {
  calls.begin(false);
  for (const std::span<SensorPipeline> each : {std::span(pipelines), derivation->pipelines()})
    for (const SensorPipeline& pipeline : each)
      for (const sensors::DueSample& due : pipeline.due) calls.add(pipeline.movers[due.row]);
}

bool Farm::State::find_due(std::int64_t now) {
  update_demand();
  for (SensorPipeline& pipeline : pipelines)
    stats.missed += pipeline.find_due(now, !sharing             ? std::span<const base::SensorTypes>(subscribed)
                                           : pipeline.derived() ? sharing->delivered_types()
                                                                : sharing->measured_types());
  stats.missed += derivation->find_due(now, sharing ? sharing->delivered_types() : subscribed);
  if (budget) keep_budget(now);
  if (world.copies > 1 && between) find_calls();
  return std::any_of(pipelines.begin(), pipelines.end(), [](const SensorPipeline& s) { return !s.due.empty(); });
}

void Farm::State::keep_budget(std::int64_t now) {
  budgeted.clear();
  for (const std::span<SensorPipeline> each : {std::span(pipelines), derivation->pipelines()})
    for (SensorPipeline& pipeline : each) budgeted.push_back(&pipeline);
  budget->admit(now, budgeted);
  stats.dropped += budget->dropped().size();
}

void Farm::State::begin_tick(bool is_sample) {
  if (is_sample && !between) tick_states = states;
  between = is_sample;
  calls.begin(true);
  pose_changes->begin();
  for (std::uint32_t m = 0; m < gone.size(); ++m) {
    base::Pose& X = states[m].X_WM;
    if (!is_gone(m) || base::is_absent(X)) continue;
    pose_changes->add(m, X, base::kAbsent);
    X = base::kAbsent;
  }
}

void Farm::State::apply(const base::Report& report) {
  if (is_gone(report.mover)) return;
  const base::Pose& X = report.X_WM;
  const base::Tilt &before = states[report.mover].tilt, &tilt = report.tilt;
  SF_CHECK(std::isfinite(X.x + X.y + X.z + X.yaw + tilt.roll + tilt.pitch),
           "the pose of mover " + std::to_string(report.mover) + " is not finite");
  const bool tilted = tilt.roll != before.roll || tilt.pitch != before.pitch;
  pose_changes->add(report.mover, states[report.mover].X_WM, X, tilted);
  states[report.mover] = report;
}

void Farm::State::prepare() {
  bool rerecord = std::exchange(must_record, false);
  for (SensorPipeline& pipeline : pipelines) {
    device.set_owner(pipeline.group->type->name);  // tables may grow
    rerecord |= pipeline.prepare();
  }
  if (!rerecord) return;
  // A kernel is compiled when it is first recorded, so kernels that were never needed are not recorded.
  batch->begin();
  for (SensorPipeline& pipeline : pipelines)
    if (pipeline.active) pipeline.backend->record_measure(*batch);
  batch->barrier();
  for (SensorPipeline& pipeline : pipelines)
    if (pipeline.active) pipeline.backend->record_derive(*batch);
  batch->end();
}

void Farm::State::submit() {
  if (std::none_of(pipelines.begin(), pipelines.end(), [](const SensorPipeline& s) { return s.needs_device(); }))
    return;
  for (SensorPipeline& pipeline : pipelines) pipeline.add_copies(*batch);
  batch->submit();
  ++stats.batches;
}

void Farm::State::measure(std::int64_t now, bool reuse, bool live) {
  Stopwatch watch;
  for (SensorPipeline& pipeline : pipelines) {
    pipeline.split(reuse);
    if (!pipeline.to_measure.empty()) pipeline.backend->place_movers();
  }
  watch.lap(stats.place_s);
  prepare();
  watch.lap(stats.lists_s);
  submit();
  watch.lap(stats.device_s);
  // Reads sensors of the host while the device runs.
  const auto collect_all = [&](bool from_device) {
    for (SensorPipeline& pipeline : pipelines)
      if (!pipeline.derived() && pipeline.needs_device() == from_device) collect(pipeline, now, reuse);
  };
  collect_all(false);
  watch.lap(stats.collect_s);
  batch->wait();
  watch.lap(stats.device_s);
  collect_all(true);
  for (SensorPipeline& pipeline : pipelines)
    if (!pipeline.derived()) append(pipeline);
  watch.lap(stats.collect_s);
  if (exchange() != nullptr) exchange()->exchange(blocks);
  watch.lap(stats.exchange_s);
  const bool faulty = live && !faults.empty();
  if (faulty) faults.apply(blocks, 0);
  if (live && fuse) fuse(blocks);
  const std::size_t known = blocks.size();
  for (SensorPipeline& pipeline : pipelines) {
    if (!pipeline.derived()) continue;
    pipeline.backend->observe(std::span(blocks).first(known));
    collect(pipeline, now, reuse);
    append(pipeline);
  }
  if (faulty) faults.apply(blocks, known);
  watch.lap(stats.collect_s);
}

void Farm::State::collect(SensorPipeline& pipeline, std::int64_t now, bool reuse) {
  stats.reused += pipeline.collect(now, states, thread_pool);
  if (reuse) pipeline.store();
}

void Farm::State::clear_blocks() {
  if (lender != nullptr) blocks.swap(lender->blocks);
  lender = nullptr;
  blocks.clear();
}

/// Appends a type's readings. Swaps the readings of the first type instead of copying them.
void Farm::State::append(SensorPipeline& pipeline) {
  if (blocks.empty() && exchange() == nullptr) {
    blocks.swap(pipeline.blocks);
    lender = &pipeline;
    return;
  }
  blocks.insert(blocks.end(), pipeline.blocks.begin(), pipeline.blocks.end());
}

/// Returns the values of a reading as sent, from which the hash is computed.
std::span<const double> Farm::State::sent(const base::ReadingBlock& reading, unsigned thread) {
  if (!no_return_inf || reading.hits.empty()) return reading.values;
  std::vector<double>& values = marked[thread];
  values.resize(reading.values.size());
  sensors::mark_no_return(reading, sensor_set.row(reading).limit, values);
  return values;
}

void Farm::State::add_to_hash(std::int64_t now, std::span<const base::ReadingBlock> readings) {
  hashes.resize(readings.size());
  thread_pool.parallel_for_each(readings.size(), 16, [&](std::size_t i, unsigned thread) {
    const base::ReadingBlock& r = readings[i];
    const std::uint64_t head[] = {episodes.copies().row_of(r.mover), r.type, r.sensor, r.sequence,
                                  static_cast<std::uint64_t>(r.time)};
    hashes[i] = base::hash_bytes(head, sizeof head);
    const std::span<const double> values = sent(r, thread);
    hashes[i] = base::hash_bytes(values.data(), values.size_bytes(), hashes[i]);
    hashes[i] = base::hash_bytes(r.hits.data(), r.hits.size_bytes(), hashes[i]);
  });
  if (sharing)
    sharing->add_call(now, readings, hashes);
  else
    calls.chain(readings, hashes);
}

void Farm::State::subscribe(std::uint32_t mover, base::SensorTypes types) {
  subscribed.at(mover) = types;
  demand_changed = true;
  if (sharing) sharing->subscribe(mover, types);
}

std::span<const base::ReadingBlock> Farm::State::read(std::int64_t now) {
  last_call = now;
  const double before = budget ? options.processor_clock() : 0.0;
  for (SensorPipeline& pipeline : pipelines) pipeline.backend->accumulate(now, between);
  const auto delivered = read_accumulated(now);
  if (budget) budget->spent(options.processor_clock() - before);
  return delivered;
}

std::span<const base::ReadingBlock> Farm::State::read_accumulated(std::int64_t now) {
  for (SensorPipeline& pipeline : pipelines) pipeline.cache.invalidate(*pose_changes, states);
  clear_blocks();
  faults.begin();
  if (find_due(now) || exchange() != nullptr) measure(now, reuse_unchanged, true);
  if (!qualities.empty())
    for (base::ReadingBlock& block : blocks) block.state = qualities[block.mover];
  Stopwatch watch;
  auto delivered = delivery.deliver(now, blocks, calls);
  if (!derivation->empty()) delivered = derivation->derive(now, delivered, states, faults, delivery, subscribed);
  add_to_hash(now, delivered);
  watch.lap(stats.collect_s);
  stats.readings += delivered.size();
  return delivered;
}

/// Sensors of the other copies are not due, since they were read at this time.
std::span<const base::ReadingBlock> Farm::State::restart(std::span<const Restart> restarts,
                                                         std::span<const base::Report> reports) {
  SF_CHECK(last_tick >= 0 && !between && !sharing && !budget && faults.empty(), "a farm that cannot restart worlds");
  begin_tick(false);
  calls.begin(false);
  for (const base::Report& report : reports) apply(report);
  // As in the first tick of a world alone, nothing was commanded before.
  std::vector<base::Twist> first_commands(derivation->empty() ? 0 : states.size(), base::Twist{NAN, NAN, NAN});
  const auto movers = static_cast<std::uint32_t>(world.movers.size() / world.copies);
  for (const Restart& restart : restarts) {
    const std::uint32_t first = restart.copy * movers, end = first + movers;
    episodes.begin(restart.copy, restart.seed, last_tick);
    calls.restart(restart.copy);
    calls.add(first);
    delivery.drop(first, end);
    for (SensorPipeline& pipeline : pipelines) {
      pipeline.restart(first, end);
      for (std::uint32_t m = first; m < end; ++m)
        pipeline.for_rows_of(m, [&](std::uint32_t row) { pipeline.backend->restart(row, last_tick); });
    }
    derivation->restart(first, end);
    for (std::uint32_t m = first; m < end && !derivation->empty(); ++m) first_commands[m] = {};
  }
  derivation->set_commands(first_commands);
  return read_accumulated(last_tick);
}

Farm::Farm(const world::World& world, gpu::Device& device, const FarmOptions& options)
    : s_(std::make_unique<State>(world, device, options)) {}

Farm::~Farm() = default;

void Farm::subscribe(std::uint32_t mover, base::SensorTypes types) {
  s_->subscribe(mover, s_->gone.at(mover) != 0 ? 0 : types);
}
void Farm::set_absent(std::uint32_t mover, bool gone) {
  s_->gone.at(mover) = gone ? 1 : 0;
  s_->demand_changed = true;
  if (gone) s_->subscribe(mover, 0);
}
std::shared_ptr<const void> Farm::add_mover() {
  SF_CHECK(s_->states.size() + 1 == s_->world.movers.size(), std::to_string(s_->states.size()));
  return s_->add_mover();
}
std::shared_ptr<const void> Farm::update_outlines() {
  SF_CHECK(s_->states.size() == s_->world.movers.size(), std::to_string(s_->states.size()));
  return s_->update_outlines();
}
void Farm::set_state_quality(std::uint32_t mover, const base::StateQuality& quality) {
  s_->qualities.resize(s_->gone.size());
  s_->qualities.at(mover) = quality;
}
void Farm::subscribe_all() {
  for (std::uint32_t m = 0; m < s_->subscribed.size(); ++m) subscribe(m, kAllSensorTypes);
}

void Farm::fuse_with(Fuse fuse) { s_->fuse = std::move(fuse); }

const raycast::Episodes& Farm::episodes() const { return s_->episodes; }
const sensors::SensorSet& Farm::sensor_set() const { return s_->sensor_set; }
base::ThreadPool& Farm::thread_pool() { return s_->thread_pool; }

std::span<const base::ReadingBlock> Farm::tick(std::int64_t now, std::span<const base::Report> reports) {
  ++s_->stats.ticks;
  s_->derivation->set_commands(std::exchange(s_->commands, {}));
  s_->derivation->set_received(std::exchange(s_->received, {}));
  s_->last_tick = now;
  s_->begin_tick(false);
  for (const base::Report& report : reports) s_->apply(report);
  return s_->read(now);
}

std::span<const base::ReadingBlock> Farm::restart(std::span<const Restart> restarts,
                                                  std::span<const base::Report> reports) {
  return s_->restart(restarts, reports);
}

void Farm::set_commands(std::span<const base::Twist> commands) { s_->commands = commands; }
void Farm::set_received(std::span<const base::ReadingBlock> readings) { s_->received = readings; }

std::span<const DroppedReading> Farm::dropped() const {
  return s_->budget ? s_->budget->dropped() : std::span<const DroppedReading>();
}

std::vector<std::string> Farm::never_valid() const { return s_->derivation->sensors().never_valid(); }

std::vector<Farm::ReceivedInput> Farm::received_inputs(std::uint8_t type) const {
  std::vector<ReceivedInput> inputs;
  for (const sensors::DerivedNode& node : s_->derivation->sensors().nodes())
    for (const sensors::WiredInput& input : node.inputs)
      if (input.type == type) inputs.push_back({input.mover, node.spec.mover});
  std::ranges::sort(inputs);
  inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
  return inputs;
}

std::int64_t Farm::next_delivery() const { return s_->delivery.next(); }
std::int64_t Farm::delivery_time(const base::ReadingBlock& reading) const { return s_->delivery.time_of(reading); }
std::span<const base::FaultMark> Farm::fault_marks() const { return s_->faults.marks(); }

std::span<const base::ReadingBlock> Farm::sample(std::int64_t now, std::span<const base::Report> reports) {
  s_->begin_tick(true);
  for (const base::Report& report : reports) s_->apply(report);
  return s_->read(now);
}

std::span<const base::ReadingBlock> Farm::sample_between(std::int64_t now, std::span<const base::Report> next) {
  SF_CHECK(next.size() == s_->states.size(), std::to_string(next.size()) + " reports");
  s_->begin_tick(true);
  for (const base::Report& report : next) {
    const base::Report& last = s_->tick_states.at(report.mover);
    s_->apply(base::is_absent(last.X_WM) ? report : robots::interpolate(last, report, now));
  }
  return s_->read(now);
}

std::int64_t Farm::next_due() const {
  s_->update_demand();
  std::int64_t soonest = s_->derivation->next_due(s_->subscribed);
  for (const SensorPipeline& pipeline : s_->pipelines) soonest = std::min(soonest, pipeline.next_due(s_->subscribed));
  return soonest;
}

base::ReadingBlock Farm::sense(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor, const base::Pose& X_WM,
                               const base::Tilt& tilt) {
  State& s = *s_;
  s.clear_blocks();
  s.derivation->request(mover, type, sensor, s.pipelines);
  s.demand_changed = true;
  const base::Pose stands = std::exchange(s.states[mover].X_WM, X_WM);
  const base::Tilt leans = std::exchange(s.states[mover].tilt, tilt);
  s.measure(0, false, false);
  std::span<const base::ReadingBlock> readings = s.blocks;
  if (!s.derivation->empty()) readings = s.derivation->evaluate(0, s.blocks, s.states);
  s.states[mover].X_WM = stands;
  s.states[mover].tilt = leans;
  const auto reading = std::ranges::find_if(readings, [&](const base::ReadingBlock& block) {
    return block.mover == mover && block.type == type && block.sensor == sensor;
  });
  SF_CHECK(reading != readings.end(), "mover " + std::to_string(mover) + " has no sensor " + std::to_string(sensor) +
                                          " of type " + std::to_string(type));
  return *reading;
}

std::uint64_t Farm::hash(std::uint32_t copy) const {
  return s_->sharing ? s_->sharing->hash() : s_->calls.hash_of(copy);
}
Sharing& Farm::sharing() {
  SF_CHECK(s_->sharing.has_value(), "the farm is not shared");
  return *s_->sharing;
}

void Farm::write_sensors(std::uint32_t mover, base::ByteWriter& out) const {
  for (const SensorPipeline& pipeline : s_->pipelines)
    pipeline.for_rows_of(mover, [&](std::uint32_t row) { pipeline.backend->write_state(row, out); });
}
void Farm::read_sensors(std::uint32_t mover, base::ByteReader& in) {
  for (const SensorPipeline& pipeline : s_->pipelines)
    pipeline.for_rows_of(mover, [&](std::uint32_t row) { pipeline.backend->read_state(row, in); });
}

FarmStats Farm::stats() const {
  FarmStats stats = s_->stats;
  stats.faults = s_->faults.counts();
  stats.work += s_->earlier_work;
  for (const SensorPipeline& pipeline : s_->pipelines) stats.work += pipeline.backend->stats();
  return stats;
}

}  // namespace sf::farm
