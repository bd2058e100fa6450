// `serve`: receives the states of robots in other processes and sends their readings back.

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "apps/commands/commands.h"
#include "apps/commands/joining.h"
#include "apps/commands/lockstep.h"
#include "apps/commands/run_settings.h"
#include "apps/options/address.h"
#include "apps/options/automatic_accuracy.h"
#include "apps/options/bridge_options.h"
#include "apps/options/default_robot.h"
#include "apps/options/layout_options.h"
#include "apps/options/open_device.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/rate_warnings.h"
#include "apps/reports/report.h"
#include "apps/reports/strayed_robots.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/time.h"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "scenarios/run_info.h"
#include "server/service.h"
#include "server/wire_ids.h"

namespace sf::apps {

namespace {

std::optional<netio::Endpoint> mirror_of(const ServeOptions& options) {
  if (options.mirror.empty()) return std::nullopt;
  if (options.wire == sensors::WireFormat::thesis)
    throw base::InputError("--mirror: packets in the thesis' layout do not identify the robot; use `--wire farm`");
  netio::AddressBook book;
  return read_address(book, options.mirror, "--mirror");
}

server::ServiceOptions service_options(const ServeOptions& options, const world::World& world) {
  server::ServiceOptions service{.rate = options.rate, .seed = options.seed, .no_return_inf = options.no_return_inf};
  service.processor_budget = 1e-3 * options.processor_budget;
  service.network_budget = options.network_budget;
  service.receiver = {.bind = {netio::resolve(options.bind), static_cast<std::uint16_t>(options.port)},
                      .radio = options.radio,
                      .forget = options.forget,
                      .keep_heights = options.keep_heights};
  service.receiver.peers = peers_of(options, &world);
  require_signable(service.receiver.peers, options.wire);
  if (options.spat > 0) service.spat = netio::Endpoint{service.receiver.bind.address, options.spat};
  service.stale_lights = options.stale_lights;
  service.own_age = base::nanoseconds(options.own_age);
  service.mirror = mirror_of(options);
  server::StateFilterOptions& filter = service.receiver.filter;
  filter.mode = options.raw      ? server::FilterMode::off
                : options.filter ? server::FilterMode::on
                                 : server::FilterMode::automatic;
  filter.unix_time = options.unix_time;
  filter.clock.source = options.clock;
  filter.clock.least_delay = base::nanoseconds(options.link_delay);
  filter.stale_after = base::nanoseconds(options.stale_after);
  using estimation::StalePolicy;
  filter.policy = options.stale.value_or(options.raw ? StalePolicy::freeze : StalePolicy::hide);
  filter.hypotheses = options.hypotheses;
  return service;
}

/// All senders whose packets have to be signed; SPaT cannot be signed.
std::vector<NamedPeer> senders_of(const ServeOptions& options, const world::World& world,
                                  std::span<const std::uint32_t> lights) {
  std::vector<NamedPeer> senders;
  const server::WireNames names = server::wire_names(world);
  for (const auto& [id, row] : names.robots)
    senders.push_back({netio::Claim{netio::PeerKind::robot, id}, world.movers[row].name});
  for (const auto& [id, row] : names.tags)
    senders.push_back({netio::Claim{netio::PeerKind::tag, id}, world.movers[row].name});
  for (const std::uint32_t id : lights)
    senders.push_back({netio::Claim{netio::PeerKind::light, id}, fmt::format("intersection {}", id)});
  senders.push_back({netio::Claim{netio::PeerKind::start, 0}, "START"});
  if (options.spat > 0) senders.push_back({std::nullopt, "SPaT (--spat)"});
  return senders;
}

/// @throws base::InputError for an intersection that the world lacks
void require_lights(const ServeOptions& options, std::span<const netio::Peer> peers,
                    std::span<const std::uint32_t> lights) {
  for (const netio::Peer& peer : peers)
    if (peer.kind == netio::PeerKind::light && std::find(lights.begin(), lights.end(), peer.id) == lights.end())
      throw base::InputError(options.peers, 0,
                             fmt::format("the world has no intersection with the id {}; it has {}", peer.id,
                                         lights.empty() ? "none" : fmt::format("{}", fmt::join(lights, ", "))));
}

scenarios::RunSettings service_settings(const ServeOptions& options, bool software) {
  scenarios::RunSettings settings = run_settings(options, raycast::describe_caster(software), true);
  settings.estimated = true;
  return settings;
}

/// Header of a service's recording: states are estimates, and ticks and samples have times of the service's clock.
record::RunInfo run_info(const world::World& world, const sensors::SensorSet& sensor_set, const ServeOptions& options,
                         bool software) {
  record::RunInfo info = scenarios::run_info(world, sensor_set, service_settings(options, software));
  if (options.rate > 0.0) info.interval = 1.0 / options.rate;
  return info;
}

/// Adds the command-line option that resolves the error.
base::InputError port_in_use(const netio::Endpoint& bind) {
  return base::InputError(netio::endpoint_text(bind) +
                          " is in use, perhaps by another `sensorfarm serve`: stop that one, or serve on another port "
                          "(--port N, or --port 0 for any free one) and give it to the robots (robot --port N)");
}

/// Adds the names of the movers.
std::vector<RunReport::Clock> clocks_of(const server::ServiceStats& stats, const world::World& world) {
  std::vector<RunReport::Clock> clocks;
  for (const server::SenderClockState& each : stats.clocks)
    clocks.push_back({world.movers[each.mover].name, each.clock});
  return clocks;
}

RunReport report_of(const server::ServiceStats& stats, const world::World& world, const gpu::DeviceInfo& device) {
  RunReport facts;
  facts.device = device.name;
  facts.software = device.software;
  facts.caster = raycast::describe_caster(device.software);
  facts.robots = stats.robots;
  facts.ticks = stats.ticks;
  facts.wall_s = facts.simulated_s = stats.wall_s;
  facts.farm = stats.farm;
  facts.hash = stats.hash;
  facts.sent = facts.received = true;
  facts.publisher = stats.publisher;
  facts.inbox = stats.inbox;
  facts.socket_drops = stats.socket_drops;
  facts.relayed = stats.relayed;
  facts.drives = stats.drives;
  facts.fusion = stats.fusion;
  facts.lights = stats.lights;
  facts.filtered = stats.filtered;
  facts.states = stats.states;
  facts.clocks = clocks_of(stats, world);
  facts.lines_left_out = stats.lines_left_out;
  return facts;
}

}  // namespace

int serve(const ServeOptions& options) {
  if (options.lockstep) return serve_lockstep(options);
  world::World world = load_with_robots(options, options);
  const Joining joining = append_joining(world, options.join);
  const server::StreamLayout layout = stream_layout_of(world, sensors::SensorSet(world), options);
  server::ServiceOptions chosen = service_options(options, world);
  chosen.receiver.joining = joining.rows;
  gpu::Device device = open_device(options);
  choose_accuracy(world, device, options, options.seed, 0);
  const sensors::SensorSet sensor_set(world);
  if (options.rate > 0.0) warn_of_fast_sensors(sensor_set, options.rate);
  if (options.rate == 0.0) warn_of_many_times(sensor_set);
  std::optional<record::Recorder> recorder;
  try {
    server::Service service(world, sensor_set, device, layout, chosen);
    service.change_shapes_in(world);
    require_lights(options, chosen.receiver.peers, service.lights().ids());
    const std::string since =
        why_unsigned(options, chosen.receiver.peers, senders_of(options, world, service.lights().ids()));
    if (!since.empty())
      warn_of_exposure(chosen.receiver.bind.address, "report robot states and receive readings", since);
    if (!options.record.empty()) {
      recorder.emplace(options.record, run_info(world, sensor_set, options, device.info().software),
                       record::RecordingPart{.compression = options.compression});
      service.record_to(*recorder);
    }
    StrayedRobots strayed(world);
    if (strayed.names()) service.record_to(strayed);
    if (recorder && !options.BridgeOptions::any()) print_taken_names(recorder->taken_names());
    install_stop_handlers();  // before addresses are printed, which scripts wait for
    LiveBridges live(options, world, sensor_set, service_settings(options, device.info().software), false,
                     &service.drives());
    if (!live.empty()) service.record_to(live);
    if (!joining.rows.empty()) print_message("{} more may join", joining_text(joining));
    print_message("serving {} of {} on {}:{}, {:g} ticks/s, on {}; press Ctrl-C to stop",
                  counted(service.robots() - joining.robots, "robot"), world.file, options.bind, service.port(),
                  1.0 / service.interval(), device.info().name);
    service.run(stop_requested(), options.duration);
    RunReport facts = report_of(service.stats(), world, device.info());
    facts.strayed = strayed.names();
    if (recorder) {
      recorder->finish();
      facts.recording = recorder->path();
      facts.recorded_bytes = recorder->size();
      facts.recording_error = service.stats().recording_error;
    }
    print(options.json ? with_warnings(run_report_json(facts), world.warnings) : run_report_text(facts));
    print_never_valid(service.stats().never_valid);
    return facts.recording_error.empty() ? 0 : 1;
  } catch (const netio::PortInUse&) {
    throw port_in_use(chosen.receiver.bind);
  }
}

}  // namespace sf::apps
