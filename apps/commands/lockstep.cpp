#include "apps/commands/lockstep.h"

#include <optional>

#include <fmt/format.h>

#include "apps/commands/run_settings.h"
#include "apps/options/automatic_accuracy.h"
#include "apps/options/bridge_options.h"
#include "apps/options/default_robot.h"
#include "apps/options/open_device.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "scenarios/lockstep_service.h"
#include "scenarios/run_info.h"

namespace sf::apps {

namespace {

/// @throws base::InputError if it would wait for more robots than the world has
scenarios::LockstepServiceOptions lockstep_options(const ServeOptions& options, const world::World& world) {
  if (options.wait_for > count_robots(world))
    throw base::InputError(fmt::format("--wait-for {}, but {} has {}: the first tick would never start",
                                       options.wait_for, world.file, counted(count_robots(world), "robot")));
  scenarios::LockstepServiceOptions lockstep{.seed = options.seed, .no_return_inf = options.no_return_inf};
  lockstep.lockstep = {.bind = {netio::resolve(options.bind), static_cast<std::uint16_t>(options.port)},
                       .robots = options.wait_for,
                       .timeout = options.lockstep_timeout};
  lockstep.lockstep.peers = peers_of(options, &world);
  return lockstep;
}

std::vector<NamedPeer> robots_of(const world::World& world) {
  std::vector<NamedPeer> robots;
  for (const world::Mover& mover : world.movers)
    if (!mover.is_tag) robots.push_back({netio::Claim{netio::PeerKind::robot, mover.id}, mover.name});
  return robots;
}

RunReport lockstep_report(scenarios::LockstepService& service, const world::World& world,
                          const gpu::DeviceInfo& device) {
  const farm::Farm& farm = service.simulation().farm();
  RunReport facts;
  facts.device = device.name;
  facts.software = device.software;
  facts.caster = raycast::describe_caster(device.software);
  facts.robots = static_cast<std::uint32_t>(service.lockstep().robots());
  facts.ticks = service.ticks();
  facts.simulated_s = static_cast<double>(service.ticks()) * world.interval;
  facts.wall_s = service.wall_seconds();
  facts.contacts = service.contacts();
  facts.move_s = service.simulation().move_seconds();
  facts.farm = farm.stats();
  facts.hash = farm.hash();
  facts.sent = facts.received = true;
  facts.publisher.packets = service.lockstep().sent();
  facts.inbox = service.lockstep().inbox().counts();
  facts.socket_drops = service.lockstep().inbox().socket_drops();
  facts.lines_left_out = service.lockstep().lines_left_out();
  facts.lockstep = service.lockstep().counts();
  return facts;
}

}  // namespace

int serve_lockstep(const ServeOptions& options) {
  world::World world = load_with_robots(options, options);
  const scenarios::LockstepServiceOptions chosen = lockstep_options(options, world);
  gpu::Device device = open_device(options);
  choose_accuracy(world, device, options, options.seed, 0);
  try {
    scenarios::LockstepService service(world, device, chosen);
    const std::string since = why_unsigned(options, chosen.lockstep.peers, robots_of(world));
    if (!since.empty()) warn_of_exposure(chosen.lockstep.bind.address, "drive robots and receive readings", since);
    std::optional<record::Recorder> recorder;
    if (!options.record.empty()) {
      const std::string caster = raycast::describe_caster(device.info().software);
      recorder.emplace(
          options.record,
          scenarios::run_info(world, service.simulation().farm().sensor_set(), run_settings(options, caster, true)),
          record::RecordingPart{.compression = options.compression});
      print_taken_names(recorder->taken_names());
      service.record_to(*recorder);
    }
    install_stop_handlers();
    print_message("serving {} of {} in lockstep on {}:{}, {:g} s per tick, on {}; press Ctrl-C to stop",
                  counted(service.lockstep().robots(), "robot"), world.file, options.bind,
                  service.lockstep().inbox().port(), world.interval, device.info().name);
    service.run(stop_requested(), options.duration);
    RunReport facts = lockstep_report(service, world, device.info());
    if (recorder) {
      recorder->finish();
      facts.recording = recorder->path();
      facts.recorded_bytes = recorder->size();
      facts.recording_error = service.recording_error();
    }
    print(options.json ? with_warnings(run_report_json(facts), world.warnings) : run_report_text(facts));
    return facts.recording_error.empty() && facts.lockstep->lost_robots == 0 ? 0 : 1;
  } catch (const netio::PortInUse&) {
    throw base::InputError(netio::endpoint_text(chosen.lockstep.bind) +
                           " is in use, perhaps by another `sensorfarm serve`: stop that one, or serve on another port "
                           "(--port N, or --port 0 for any free one) and give it to the clients");
  }
}

}  // namespace sf::apps
