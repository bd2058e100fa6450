// `run`: a simulated fleet in the loop, recorded and sent as asked.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/automatic_accuracy.h"
#include "apps/commands.h"
#include "apps/controller_options.h"
#include "apps/default_robot.h"
#include "apps/layout_options.h"
#include "apps/progress_line.h"
#include "apps/rate_warnings.h"
#include "apps/report.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "base/contact_onset.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/time.h"
#include "netio/address_token.h"
#include "netio/server/no_return_filter.h"
#include "netio/server/reading_publisher.h"
#include "raycast/caster_choice.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

/// Where readings go: a recording, the network, both or neither.
class Outputs {
 public:
  Outputs(const world::World& world, const sensors::SensorSet& sensor_set,
          const std::optional<server::StreamLayout>& layout, const std::string& caster, const RunOptions& options)
      : sensor_set_(sensor_set), no_return_filter_(sensor_set, options.no_return_inf) {
    if (layout) {
      address_ = netio::resolve(options.send);
      publisher_.emplace(world, sensor_set, *layout, netio::Outbox(server::outbox_options(sensor_set)));
    }
    if (!options.record.empty())
      recorder_.emplace(options.record,
                        scenarios::run_info(world, sensor_set,
                                            {options.seed, options.record_readings, options.no_return_inf, caster}));
  }

  /// @param wait called with the time [ns] at which a reading is delivered, before it is sent: the tick's, or one
  /// before it
  template <class Wait>
  void write(base::TickRecord tick, Wait&& wait) {
    const auto start = Clock::now();
    tick.readings = no_return_filter_.apply(tick.readings);
    double waited = 0.0;
    std::int64_t sent_at = tick.time;
    for (const base::ReadingBlock& reading : publisher_ ? tick.readings : std::span<const base::ReadingBlock>{}) {
      const std::int64_t time =
          std::min<std::int64_t>(tick.time, reading.time + base::nanoseconds(sensor_set_.row(reading).latency));
      if (time != std::exchange(sent_at, time)) {
        send();
        const auto before = Clock::now();
        wait(time);
        waited += base::seconds_since(before);
      }
      addressed_readings_.push_back({&reading, address_, session_token_});
    }
    if (publisher_) send();
    if (recorder_) recorder_->write(tick);
    seconds_ += base::seconds_since(start) - waited;
  }

  void finish(RunReport& facts) {
    facts.out_s = seconds_;
    if (publisher_) {
      facts.sent = true;
      facts.publisher = publisher_->counts();
    }
    if (!recorder_) return;
    recorder_->finish();
    facts.recording = recorder_->path();
    facts.recorded_bytes = recorder_->size();
  }

 private:
  void send() {
    publisher_->queue(addressed_readings_);
    publisher_->flush();
    addressed_readings_.clear();
  }

  const sensors::SensorSet& sensor_set_;
  server::NoReturnFilter no_return_filter_;
  std::vector<server::AddressedReading> addressed_readings_;  ///< that go at one time
  std::uint32_t address_ = 0;
  netio::SessionToken session_token_{netio::random_session(), 0};
  std::optional<server::ReadingPublisher> publisher_;
  std::optional<record::Recorder> recorder_;
  double seconds_ = 0.0;
};

/// `refusal` of a controller names one of several robots that are driven.
bool names_one_of_several(const std::string& refusal, const world::World& world, const RunOptions& options) {
  const std::size_t driven = options.drive.empty() ? count_robots(world) : options.drive.size();
  return driven > 1 && std::any_of(world.movers.begin(), world.movers.end(), [&](const world::Mover& mover) {
           return refusal.find("'" + mover.name + "'") != std::string::npos;
         });
}

scenarios::SimulationOptions simulation_options(const world::World& world, const RunOptions& options) {
  scenarios::SimulationOptions simulation{
      .seed = options.seed, .threads = options.threads, .no_return_inf = options.no_return_inf};
  simulation.actor.controller = controller_config_of(options);
  simulation.actors = make_actors(world, options);
  return simulation;
}

/// `act()`; where a controller refuses one of several robots, with a remedy. Some do when they are made, some when they
/// start.
template <class Act>
auto advised(const world::World& world, const RunOptions& options, Act&& act) {
  try {
    return act();
  } catch (const base::InputError& error) {
    if (!names_one_of_several(error.what(), world, options)) throw;
    throw base::InputError(error.what() + std::string("; or name the robots that are driven (--drive NAME)"));
  }
}

}  // namespace

int run(const RunOptions& options) {
  world::World world = load_with_robots(options.world, options.load, options.robots, options.seed, options.of);
  std::optional<server::StreamLayout> layout;
  if (!options.send.empty()) layout = stream_layout_of(world, sensors::SensorSet(world), options);
  gpu::Device device(options.device);
  choose_accuracy(world, device, options, options.seed, options.threads);
  const sensors::SensorSet sensor_set(world);
  warn_of_many_times(sensor_set);
  scenarios::Simulation simulation =
      advised(world, options, [&] { return scenarios::Simulation(world, device, simulation_options(world, options)); });
  if (!simulation.warnings().empty()) print_warnings(simulation.warnings().front().file, simulation.warnings());
  ControlMetrics tally(simulation, world.movers.size(), options.controller);
  std::vector<base::ContactOnset> contacts(world.movers.size());
  const std::string caster = raycast::describe_caster(device.info().software);
  Outputs outputs(world, sensor_set, layout, caster, options);
  install_stop_handlers();

  const auto ticks = static_cast<std::uint64_t>(std::llround(options.duration / world.interval));
  RunReport facts;
  const auto start = Clock::now();
  {
    Progress progress("simulating");
    for (; facts.ticks < ticks && !stop_requested(); ++facts.ticks) {
      const base::TickRecord tick = advised(world, options, [&] { return simulation.step(); });
      tally.update(tick);
      // Motion and readings of a tick are worked out at its end, so what is due on the way is sent a tick later.
      outputs.write(tick, [&](std::int64_t time) {
        if (options.real_time) keep_pace(start, 1e-9 * static_cast<double>(time) + world.interval);
      });
      for (std::size_t m = 0; m < contacts.size(); ++m)
        facts.contacts += !world.movers[m].is_tag && contacts[m].begins(tick.contacts[m] != 0);
      const double simulated = static_cast<double>(facts.ticks + 1) * world.interval;
      progress.show(simulated / options.duration, fmt::format("{:.0f} s of {:g} s", simulated, options.duration));
      if (options.real_time) keep_pace(start, simulated);
    }
  }
  facts.wall_s = base::seconds_since(start);
  facts.simulated_s = static_cast<double>(facts.ticks) * world.interval;
  facts.interrupted = facts.ticks < ticks;
  facts.device = device.info().name;
  facts.software = device.info().software;
  facts.caster = caster;
  facts.robots = static_cast<std::uint32_t>(count_robots(world));
  facts.control = tally.facts(world);
  facts.move_s = simulation.move_seconds();
  facts.farm = simulation.farm().stats();
  facts.hash = simulation.farm().hash();
  outputs.finish(facts);
  std::vector<world::Warning> warnings = world.warnings;
  warnings.insert(warnings.end(), simulation.warnings().begin(), simulation.warnings().end());
  print(options.json ? with_warnings(json_of(facts), warnings) : text_of(facts));
  const netio::OutboxCounts& packets = facts.publisher.packets;
  if (packets.failed == 0) return 0;
  print_message("{} of {} packets were not sent: {}", packets.failed, packets.queued, packets.first_failure);
  return 1;
}

}  // namespace sf::apps
