// `robot`: runs one simulated robot in its own process, with a serving farm.

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/commands/commands.h"
#include "apps/commands/live_map.h"
#include "apps/options/address.h"
#include "apps/options/controller_options.h"
#include "apps/options/default_robot.h"
#include "apps/options/farm_endpoint.h"
#include "apps/options/layout_options.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/report.h"
#include "apps/reports/robot_report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/time.h"
#include "netio/address_book.h"
#include "netio/outbox.h"
#include "netio/own_end.h"
#include "server/robot_client.h"

namespace sf::apps {

namespace {

constexpr std::string_view kStart = "start=";

/// Set by its command-line option or by the control shell's setting.
bool waits_for_start(const RobotOptions& options) {
  return options.wait_for_start || std::any_of(options.set.begin(), options.set.end(), [](const std::string& text) {
           return text.compare(0, kStart.size(), kStart) == 0 &&
                  control::read_text(std::string_view(text).substr(kStart.size())) == "signal";
         });
}

/// Returns the robot's key; warns if the table has none.
std::optional<netio::SigningKey> key_of(const RobotOptions& options, const std::vector<netio::Peer>& peers,
                                        const world::Mover& mover) {
  const netio::Peer* own = netio::find(peers, netio::PeerKind::robot, mover.id);
  const std::optional<netio::SigningKey> key = own != nullptr ? own->key : std::nullopt;
  if (key) require_signable({*own}, options.wire);
  if (!options.peers.empty() && !key)
    print_message("warning: {} has no key for {} (id {}): its packets to the farm are not signed", options.peers,
                  mover.name, mover.id);
  return key;
}

bool builds_map(const RobotOptions& options) {
  return !options.map.empty() || !options.map_file.empty() || options.view;
}

server::CameraOptions cameras_of(const RobotOptions& options, const netio::Endpoint& farm,
                                 const std::vector<netio::Peer>& peers, const world::Mover& mover) {
  server::CameraOptions cameras;
  cameras.bind = netio::own_end_for(farm.address, options.cameras);
  cameras.clock.source = options.camera_clock;
  const std::uint32_t id = options.tag > 0 ? options.tag : mover.id;
  if (const netio::Peer* tag = netio::find(peers, netio::PeerKind::tag, id)) cameras.peers = {*tag};
  return cameras;
}

/// Receives on loopback only if all others are there.
netio::DirectV2vOptions direct_v2v_of(const RobotOptions& options, netio::AddressBook& book,
                                      const std::vector<netio::Peer>& peers) {
  netio::DirectV2vOptions direct{.radio = options.radio, .table = peers};
  for (const std::string& text : options.v2v_peers) direct.peers.push_back(read_address(book, text, "--v2v-peers"));
  if (!options.v2v_group.empty()) direct.group = read_address(book, options.v2v_group, "--v2v-group");
  if (!options.v2v_interface.empty()) direct.interface_address = netio::resolve(options.v2v_interface);
  const bool local = !direct.group && options.v2v_interface.empty() &&
                     std::all_of(direct.peers.begin(), direct.peers.end(),
                                 [](const auto& peer) { return netio::is_loopback(peer.address); });
  const bool is_default = options.v2v_port == 0 && !direct.peers.empty();
  direct.bind = {local ? netio::kLoopback : direct.interface_address, is_default ? kDirectV2vPort : options.v2v_port};
  return direct;
}

/// Anyone who can reach the port can send as a robot without a key.
void warn_of_unsigned_v2v(const RobotOptions& options, const world::World& world, const server::RobotLink& link) {
  if (link.direct() == nullptr || netio::is_loopback(link.direct()->options().bind.address)) return;
  const std::vector<netio::Peer>& peers = link.direct()->options().table;
  if (netio::find(peers, netio::PeerKind::group, 0) != nullptr) return;
  std::vector<NamedPeer> senders;
  for (const world::Mover& mover : world.movers)
    if (!mover.is_tag) senders.push_back({netio::Claim{netio::PeerKind::robot, mover.id}, mover.name});
  const std::string why = why_unsigned(options, peers, senders);
  if (!why.empty())
    print_message("warning: anyone who can reach UDP port {} can send V2V as another robot: {}", link.direct()->port(),
                  why);
}

server::RobotClientOptions client_options(const RobotOptions& options, const world::World& world,
                                          const world::Mover& mover) {
  server::RobotClientOptions client;
  client.link.farm = farm_of(options);
  // The id of the robot's tag need not be in the world.
  const std::vector<netio::Peer> peers = peers_of(options, options.cameras > 0 ? nullptr : &world);
  client.link.key = key_of(options, peers, mover);
  client.link.model = {.delay = options.delay,
                       .jitter = options.jitter,
                       .loss = options.loss,
                       .seed = options.seed,
                       .duplicate = options.duplicate,
                       .corrupt = options.corrupt};
  client.controller = controller_config_of(options);
  if (!options.controller_given && mover.controller != "none")
    client.controller = control::controller_of(mover, client.controller);
  client.controller.rate = options.rate;
  client.seed = options.seed;
  client.forget = options.forget;
  client.stop_after = options.stop_after;
  client.stop_without_farm = options.stop_without_farm;
  client.wait_for_start = waits_for_start(options);
  if (options.spat > 0) client.spat = netio::own_end_for(client.link.farm.address, options.spat);
  client.tag = options.tag;
  client.most_sigma = options.most_sigma;
  if (options.cameras > 0) client.cameras = cameras_of(options, client.link.farm, peers, mover);
  netio::AddressBook book;
  if (!options.v2v_peers.empty() || !options.v2v_group.empty())
    client.link.direct = direct_v2v_of(options, book, peers);
  if (!options.truth.empty()) client.truth = read_address(book, options.truth, "--truth");
  if (builds_map(options)) client.map.emplace();
  if (!options.map.empty()) client.map->receiver = read_address(book, options.map, "--map");
  if (client.map) client.map->wire = options.wire;
  if (!options.serial.empty())
    client.real = server::RealRobotOptions{options.robot_type, options.serial, options.baud, {}};
  if (!options.player.empty())
    client.real = server::RealRobotOptions{"player", {}, 0, read_address(book, options.player, "--player")};
  client.shares_readings = !options.keep_readings;
  if (!options.real_world.empty()) {
    auto real =
        std::make_shared<world::World>(world::load_world(options.real_world, {.sensors = sensors::world_file_words()}));
    print_warnings(options.real_world, real->warnings);
    client.real =
        server::RealRobotOptions{.type = "emulated", .device = mover.name, .world = real, .seed = options.seed};
  }
  return client;
}

std::uint32_t find_robot(const world::World& world, const std::string& name) {
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    if (world.movers[i].is_tag) continue;
    if (world.movers[i].name == name) return i;
    names.emplace_back(world.movers[i].name);
  }
  refuse_robot(world, name, names);
}

}  // namespace

int robot(const RobotOptions& options) {
  const world::World world = load_with_robots(options);
  const sensors::SensorSet sensor_set(world);
  const std::uint32_t mover = find_robot(world, options.robot);
  server::RobotClientOptions client = client_options(options, world, world.movers[mover]);
  std::optional<LiveMap> live;
  if (!options.map_file.empty() || options.view) {
    const std::string& name = world.movers[mover].name;
    live.emplace(LiveMapOptions{"map of " + name, {name}, options.view});
    client.map->show = [&](const maps::OccupancyGrid& grid, const base::Pose& X_WR) {
      live->show(0, grid, {"Map of " + name, "", {{name, X_WR}}}, options.map_file);
    };
  }
  server::RobotClient process(world, sensor_set, mover, stream_layout_of(world, sensor_set, options), client);
  if (options.spat > 0 && !netio::is_loopback(process.link().farm().address))
    print_message(
        "warning: --spat {} accepts light states from anyone who can reach this machine, since these messages are not "
        "signed",
        options.spat);
  warn_of_unsigned_v2v(options, world, process.link());
  install_stop_handlers();
  print_message("{} (id {}) runs controller '{}' {} with the farm at {}{}; press Ctrl-C to stop",
                world.movers[mover].name, world.movers[mover].id, client.controller.name,
                process.on_scans() ? "on each new scan" : fmt::format("at {:g} Hz", process.rate()),
                netio::endpoint_text(process.link().farm()),
                waits_for_start(options) ? ", after the start signal" : "");
  process.run(stop_requested(), options.duration);
  if (live) live->finish();
  const server::RobotClientStats facts = process.stats();
  print(options.json ? with_warnings(robot_client_json(facts), world.warnings) : robot_client_text(facts));
  return facts.answered || !facts.listens ? 0 : 1;
}

}  // namespace sf::apps
