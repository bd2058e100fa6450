// `run`: a simulated fleet in the loop, recorded and sent as asked.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "apps/automatic_accuracy.h"
#include "apps/bridge_options.h"
#include "apps/commands.h"
#include "apps/controller_options.h"
#include "apps/default_robot.h"
#include "apps/layout_options.h"
#include "apps/progress_line.h"
#include "apps/rate_warnings.h"
#include "apps/report.h"
#include "apps/run_outputs.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "base/contact_onset.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "raycast/caster_choice.h"
#include "scenarios/operator.h"
#include "scenarios/simulation.h"

namespace sf::apps {

namespace {

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

/// A fleet from time 0 on, with what follows it.
struct Course {
  scenarios::Simulation simulation;
  ControlMetrics tally;
  std::vector<base::ContactOnset> contacts;
  RunOutputs outputs;
  std::uint64_t ticks = 0;
  std::uint64_t contacts_begun = 0;

  Course(const world::World& world, gpu::Device& device, const sensors::SensorSet& sensor_set,
         const std::optional<server::StreamLayout>& layout, const std::string& caster, const RunOptions& options,
         const std::string& record)
      : simulation(world, device, simulation_options(world, options)),
        tally(simulation, world.movers.size(), options.controller),
        contacts(world.movers.size()),
        outputs(world, sensor_set, layout, caster, options, record) {}

  double simulated(const world::World& world) const { return static_cast<double>(ticks) * world.interval; }

  /// Motion and readings of a tick are worked out at its end, so what is due on the way is sent a tick later.
  void step(const world::World& world, scenarios::Operator& users) {
    const base::TickRecord tick = simulation.step();
    tally.update(tick);
    users.publish(tick);
    outputs.write(tick, [&](std::int64_t time) { users.keep_pace(1e-9 * static_cast<double>(time) + world.interval); });
    for (std::size_t m = 0; m < contacts.size(); ++m)
      contacts_begun += !world.movers[m].is_tag && contacts[m].begins(tick.contacts[m] != 0);
    ++ticks;
  }

  void report(const world::World& world, RunReport& facts) {
    facts.ticks = ticks;
    facts.simulated_s = simulated(world);
    facts.contacts = contacts_begun;
    facts.control = tally.facts(world);
    facts.move_s = simulation.move_seconds();
    facts.farm = simulation.farm().stats();
    facts.hash = simulation.farm().hash();
    outputs.finish(facts);
  }
};

constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();

/// [1] Simulated over real time. @param watched by users of bridges
double speed_of(const RunOptions& options, bool watched) {
  const double speed = options.speed.value_or(watched ? 1.0 : 0.0);
  return speed > 0.0 ? speed : std::numeric_limits<double>::infinity();
}

/// Folder of the recording after `resets`: each begins one of its own.
std::string recording_folder(const RunOptions& options, std::uint32_t resets) {
  return options.record.empty() || resets == 0 ? options.record : fmt::format("{}-{}", options.record, resets + 1);
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
  const std::string caster = raycast::describe_caster(device.info().software);
  std::optional<Course> course;
  const auto begin = [&](std::uint32_t resets) {
    course.reset();
    advised(world, options, [&] {
      course.emplace(world, device, sensor_set, layout, caster, options, recording_folder(options, resets));
    });
  };
  begin(0);
  const std::vector<world::Warning> heard = course->simulation.warnings();
  if (!heard.empty()) print_warnings(heard.front().file, heard);
  LiveBridges live(options, world, sensor_set, {options.seed, true, options.no_return_inf, caster}, true);
  scenarios::Operator users(live.bridges(), stop_requested(), speed_of(options, !live.empty()));
  install_stop_handlers();

  const double duration = options.duration.value_or(live.empty() ? 60.0 : kWithoutEnd);
  const double ticks = std::round(duration / world.interval);
  RunReport facts;
  const auto start = std::chrono::steady_clock::now();
  {
    Progress progress("simulating");
    auto next = scenarios::Operator::Next::tick;
    while (static_cast<double>(course->ticks) < ticks) {
      next = users.wait(course->simulation, course->simulated(world));
      if (next == scenarios::Operator::Next::stop) break;
      if (next == scenarios::Operator::Next::reset) {
        users.begin_again();
        begin(users.resets());
        continue;
      }
      advised(world, options, [&] { course->step(world, users); });
      const double simulated = course->simulated(world);
      if (duration < kWithoutEnd)
        progress.show(simulated / duration, fmt::format("{:.0f} s of {:g} s", simulated, duration));
    }
    facts.interrupted = next == scenarios::Operator::Next::stop;
    users.keep_pace(course->simulated(world));  // a tick lasts until the next one would begin
  }
  facts.wall_s = base::seconds_since(start);
  facts.device = device.info().name;
  facts.software = device.info().software;
  facts.caster = caster;
  facts.robots = static_cast<std::uint32_t>(count_robots(world));
  course->report(world, facts);
  std::vector<world::Warning> warnings = world.warnings;
  warnings.insert(warnings.end(), heard.begin(), heard.end());
  print(options.json ? with_warnings(json_of(facts), warnings) : text_of(facts));
  const netio::OutboxCounts& packets = facts.publisher.packets;
  if (packets.failed == 0) return 0;
  print_message("{} of {} packets were not sent: {}", packets.failed, packets.queued, packets.first_failure);
  return 1;
}

}  // namespace sf::apps
