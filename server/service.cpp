#include "server/service.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "base/elapsed.h"
#include "base/error.h"
#include "base/thread_pool.h"
#include "base/time.h"
#include "robots/motion_limits.h"

namespace sf::server {

class Service::Clock {
 public:
  std::int64_t now() const {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

namespace {

StateReceiverOptions with_lights(StateReceiverOptions options, std::vector<std::uint32_t> ids) {
  options.lights = std::move(ids);
  return options;
}

/// Objects that join belong to their senders.
std::vector<std::uint32_t> own_models(const world::World& world, const StateReceiverOptions& options) {
  std::vector<std::uint32_t> rows = control::controlled_models(world);
  std::erase_if(rows, [&](std::uint32_t row) {
    return std::find(options.joining.begin(), options.joining.end(), row) != options.joining.end();
  });
  return rows;
}

double interval_of(const world::World& world, const ServiceOptions& options) {
  return options.rate > 0.0 ? 1.0 / options.rate : world.interval;
}

}  // namespace

Service::Service(const world::World& world, const sensors::SensorSet& sensor_set, gpu::Device& device,
                 const StreamLayout& layout, const ServiceOptions& options)
    : world_(world),
      sensor_set_(sensor_set),
      layout_(layout),
      lights_(world, {.spat = options.spat, .stale = options.stale_lights, .peers = options.receiver.peers},
              options.receiver.radio),
      lanes_(world),
      receiver_(world, with_lights(options.receiver, lights_.ids())),
      drives_(world),
      publisher_(world, sensor_set, layout, netio::Outbox(receiver_.inbox().socket(), outbox_options(sensor_set)),
                 options.mirror),
      fusion_(world, sensor_set, {.max_age = options.own_age, .clock = options.receiver.filter.clock}),
      farm_(world, device,
            farm::FarmOptions{.seed = options.seed,
                              .true_poses = false,
                              .no_return_inf = options.no_return_inf,
                              .processor_budget = options.processor_budget,
                              .budget_tick = interval_of(world, options)}),
      radio_(options.receiver.radio),
      models_(world, own_models(world, options.receiver),
              {.seed = options.seed, .interval = interval_of(world, options)}),
      absent_(world.movers.size(), false),
      no_return_filter_(sensor_set, options.no_return_inf),
      interval_(interval_of(world, options)),
      only_at_ticks_(options.rate > 0.0) {
  for (const std::uint32_t row : options.receiver.joining) models_.remove(row);
  if (options.network_budget > 0.0) publisher_.limit(options.network_budget, 2.0 * options.network_budget * interval_);
  receiver_.set_light_handler([this](const netio::Header& header, const netio::V2i& signals, std::int64_t now) {
    lights_.accept(header, signals, now);
  });
  receiver_.set_own_readings_handler(
      [this](const netio::Header& header, const netio::OwnReadings& own, std::uint32_t mover, std::int64_t now) {
        fusion_.take(header, own, mover, now, receiver_.log());
      });
  v2v_inputs_.add(farm_);
  farm_.fuse_with([this](std::span<base::ReadingBlock> readings) { fusion_.fuse(readings); });
  receiver_.set_lane_handler([this](const netio::Lane& lane) { lanes_.accept(lane); });
}

void Service::run(const std::atomic<bool>& stop, double duration) {
  const Clock clock;
  receiver_.filter().set_epoch(base::unix_time());
  fusion_.set_epoch(receiver_.filter().options().epoch);
  farm_.thread_pool().interrupt_on([&stop] { return stop.load(); });
  try {
    run_ticks(clock, stop, duration);
  } catch (const base::Interrupted&) {
    // The tick takes too long: abandon it.
  }
  farm_.thread_pool().interrupt_on({});
  receive_pending(clock.now());  // include waiting datagrams in the counts
  wall_s_ = 1e-9 * static_cast<double>(clock.now());
}

void Service::run_ticks(const Clock& clock, const std::atomic<bool>& stop, double duration) {
  const std::int64_t step = base::nanoseconds(interval_);
  std::int64_t next = 0;  // [ns] of the tick
  while (!stop) {
    wait_until(clock, std::min(next, next_due()), stop);
    if (stop) break;
    const std::int64_t now = clock.now();
    if (duration > 0.0 && 1e-9 * static_cast<double>(now) >= duration) break;
    if (now < next) {
      sample(now);
      continue;
    }
    tick(now);
    next = std::max(next + step, clock.now() - step);
  }
}

/// Sleeps until `when` while processing received packets. Never returns early: at an early tick, a sensor of the same
/// rate would not be due yet.
void Service::wait_until(const Clock& clock, std::int64_t when, const std::atomic<bool>& stop) {
  for (;;) {
    const std::int64_t left = when - clock.now();
    if (left <= 0 || stop) return;
    const std::int64_t whole = left / 1'000'000;  // [ms]
    if (whole == 0) std::this_thread::sleep_for(std::chrono::nanoseconds(left));
    if (whole > 0) receiver_.inbox().wait(static_cast<int>(std::min<std::int64_t>(whole, 100)));
    receive_pending(clock.now());
  }
}

std::int64_t Service::next_due() const {
  return only_at_ticks_ ? farm::kNever : std::min(farm_.next_due(), farm_.next_delivery());
}

/// Rebuilding takes time, and anyone may send an OBJECT: hence the period. Undoes changes for which the device is too
/// small.
void Service::change_shapes(std::int64_t now) {
  if (now < next_shapes_) return;
  const auto changes = receiver_.take_shape_changes();
  if (!changes.empty()) next_shapes_ = now + kShapePeriod;
  std::vector<base::ShapeState> before;
  bool outlines = false;
  for (const auto& [row, change] : changes) {
    before.push_back(world::shape_state(world_, row));
    outlines |= change_shape(row, change, now);
  }
  try {
    if (outlines) farm_.update_outlines();
  } catch (const base::DeviceError& error) {
    for (const base::ShapeState& state : before)
      if (world::restore_shape(*shapes_world_, state)) receiver_.update_outline(state.mover);
    shapes_.clear();
    receiver_.log().write(fmt::format("{} changes of shapes are undone: {}", before.size(), error.what()), now);
  }
}

/// @return whether the outline changed
bool Service::change_shape(std::uint32_t row, const world::ShapeChange& change, std::int64_t now) {
  try {
    if (shapes_world_ == nullptr) throw base::InputError("shapes do not change in this service");
    const std::uint32_t color = world::shape_state(world_, row).color;
    const bool outline = world::change_shape(*shapes_world_, row, change);
    const base::ShapeState state = world::shape_state(world_, row);
    if (outline || state.color != color) shapes_.push_back(state);
    if (outline) receiver_.update_outline(row);
    return outline;
  } catch (const base::InputError& error) {
    auto& [refusal, at] = refused_[row];  // senders repeat their packets
    if (refusal != error.what() || now - at > netio::kSenderTimeout)
      receiver_.log().write(fmt::format("OBJECT for tag {}: {}", world_.movers[row].id, error.what()), now);
    refusal = error.what(), at = now;
    return false;
  }
}

void Service::tick(std::int64_t now) {
  receive_pending(now);
  change_shapes(now);
  publish_due(now, false);
  lights_.publish(now, receiver_);
  lanes_.update(now, receiver_.states(now), absent_, receiver_.log());
  lanes_.publish(now, receiver_);
  drives_.send(now, receiver_);
  drop_notices_.publish(now, receiver_);
  receiver_.relay(now);
  call_models(now);
  ++ticks_;
}

/// An object belongs to its controller until the first packet that moves it.
void Service::call_models(std::int64_t now) {
  if (models_.empty()) return;
  for (const auto& [id, row] : receiver_.tags()) {
    if (!receiver_.is_moved_by_packets(row) || !models_.remove(row)) continue;
    receiver_.log().write(fmt::format("'{}' is moved by packets from now on: its controller is no longer called",
                                      world_.movers[row].name),
                          now);
  }
  if (models_.empty()) return;
  const auto states = receiver_.states(now);
  for (const auto& change : models_.call({now, states, absent_, receiver_.fleet(), shapes_world_ != nullptr})) {
    receiver_.change_shape(change.mover, change.shape);
    if (!change.velocity) continue;
    receiver_.place({change.mover, now, change.X_WM.value_or(states[change.mover].X_WM),
                     robots::limit_kinematics(world_.movers[change.mover], *change.velocity),
                     change.X_WM ? base::Tilt{} : states[change.mover].tilt},
                    change.present.value_or(!absent_[change.mover]));
  }
}

void Service::publish_due(std::int64_t now, bool between) {
  receive_pending(now);
  lights_.update(now);
  receiver_.predict(now);
  const auto states = update_movers(now);
  if (!between && !v2v_inputs_.empty()) receive_v2v(now, states);
  const auto readings = no_return_filter_.apply(between ? farm_.sample(now, states) : farm_.tick(now, states));
  address(readings);
  publisher_.queue(addressed_readings_, now);
  publisher_.flush();
  note_dropped(now);
  addressed_readings_.clear();
  if (!sinks_.empty()) record(now, states, readings);
  shapes_.clear();
  warn_of_missed(now);
}

/// Updates which movers are in the world and what they subscribe to.
/// @return the newest states
std::span<const base::Report> Service::update_movers(std::int64_t now) {
  for (const auto& [id, row] : receiver_.robots()) {
    absent_[row] = receiver_.update_absent(id, now);
    farm_.set_absent(row, absent_[row]);
    farm_.subscribe(row, subscribed_types(id, now));
    farm_.set_state_quality(row, receiver_.quality(row, now));
  }
  for (const auto& [id, row] : receiver_.tags()) {
    absent_[row] = receiver_.update_absent_tag(id, now);
    farm_.set_absent(row, absent_[row]);
  }
  for (const auto& [id, row] : receiver_.lights()) {
    absent_[row] = receiver_.update_absent_light(id, now);
    farm_.set_absent(row, absent_[row]);
  }
  return receiver_.states(now);
}

/// Passes the states that robots sent since the last tick to derived sensors, predicted to `now`.
void Service::receive_v2v(std::int64_t now, std::span<const base::Report> states) {
  const auto newest = [&](std::uint32_t mover, std::uint32_t) -> std::optional<farm::V2vInputs::Received> {
    const base::StateQuality quality = receiver_.quality(mover, now);
    if (quality.age == base::kNoStateYet) return std::nullopt;
    return farm::V2vInputs::Received{now - quality.age, now, states[mover], quality};
  };
  farm_.set_received(v2v_inputs_.receive(world_, radio_, newest, states, absent_));
}

void Service::address(std::span<const base::ReadingBlock> readings) {
  for (const base::ReadingBlock& reading : readings) {
    // A delayed reading of a robot that has left has no address.
    const std::uint32_t id = world_.movers[reading.mover].id;
    const auto to = receiver_.inbox().address(id);
    if (to)
      addressed_readings_.push_back(
          {&reading, to->address, receiver_.inbox().session_token_for(id), receiver_.inbox().signer(id)});
  }
}

void Service::note_dropped(std::int64_t now) {
  for (const farm::DroppedReading& reading : farm_.dropped()) {
    const std::uint32_t id = world_.movers[reading.mover].id;
    if (receiver_.inbox().is_subscribed(id, reading.type, now))
      drop_notices_.add(id, reading.type, reading.sensor, DropNotices::Reason::processor, now);
  }
  for (const base::ReadingBlock* const reading : publisher_.dropped())
    drop_notices_.add(world_.movers[reading->mover].id, reading->type, reading->sensor, DropNotices::Reason::network,
                      reading->time);
}

void Service::record(std::int64_t now, std::span<const base::Report> states,
                     std::span<const base::ReadingBlock> readings) {
  states_.assign(states.begin(), states.end());
  qualities_.clear();
  for (base::Report& state : states_) {
    if (absent_[state.mover]) state.X_WM = base::kAbsent;
    qualities_.push_back(receiver_.quality(state.mover, now));
  }
  light_states_.clear();
  for (const world::Signal& signal : lights_.signals()) light_states_.push_back(world::status_of(signal));
  const base::TickRecord tick{.tick = records_++,
                              .time = now,
                              .reports = states_,
                              .readings = readings,
                              .qualities = qualities_,
                              .lights = light_states_,
                              .shapes = shapes_};
  std::erase_if(sinks_, [&](base::Sink* sink) { return !write(*sink, tick); });
}

/// Returns false once the sink accepts no more.
bool Service::write(base::Sink& sink, const base::TickRecord& record) {
  try {
    sink.write(record);
    return true;
  } catch (const base::InputError& error) {
    recording_error_ = error.what();
    receiver_.log().write(fmt::format("recording ends here: {}", error.what()), record.time);
    return false;
  }
}

/// Bit k: robot `id` is active and subscribed to sensors of type k.
base::SensorTypes Service::subscribed_types(std::uint32_t id, std::int64_t now) const {
  base::SensorTypes types = 0;
  for (const sensors::SensorSet::Group& group : sensor_set_.groups())
    if (receiver_.inbox().is_subscribed(id, group.type->id, now) && layout_.sends_any(group))
      types |= base::only(group.type->id);
  return types;
}

/// Warns once, when more than one reading in twenty is missed.
void Service::warn_of_missed(std::int64_t now) {
  const farm::FarmStats stats = farm_.stats();
  if (warned_of_missed_ || only_at_ticks_ || stats.missed < 20 || 20 * stats.missed < stats.readings) return;
  warned_of_missed_ = true;
  receiver_.log().write(
      "this machine is too slow for the sensors' rates: readings are missed; lower the rates, or let fewer robots "
      "subscribe",
      now);
}

ServiceStats Service::stats() const {
  ServiceStats stats;
  stats.robots = static_cast<std::uint32_t>(robots());
  stats.ticks = ticks_;
  stats.wall_s = wall_s_;
  stats.farm = farm_.stats();
  stats.hash = farm_.hash();
  stats.publisher = publisher_.counts();
  stats.inbox = receiver_.inbox().counts();
  stats.socket_drops = receiver_.inbox().socket_drops();
  stats.relayed = receiver_.relayed();
  stats.lights = lights_.counts();
  stats.drives = drives_.counts();
  stats.fusion = fusion_.counts();
  stats.answers = receiver_.answered();
  stats.lines_left_out = receiver_.log().left_out();
  stats.never_valid = farm_.never_valid();
  stats.states = receiver_.filter().counts();
  stats.clocks = receiver_.filter().clocks();
  stats.filtered = receiver_.filter().used();
  stats.recording_error = recording_error_;
  return stats;
}

}  // namespace sf::server
