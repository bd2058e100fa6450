// `start`, `object` and `lane`: send a signal to a farm several times, since packets may be lost.

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <thread>

#include "apps/commands/commands.h"
#include "apps/options/farm_endpoint.h"
#include "apps/options/peers_option.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "netio/outbox.h"
#include "netio/own_end.h"
#include "netio/packets.h"
#include "world/roads/lane_use.h"
#include "world/roads/rndf_statement_reader.h"
#include "world/shapes.h"

namespace sf::apps {

namespace {

constexpr int kRepetitions = 3;

/// Returns the local port from which OBJECTs of one tag are sent. The farm refuses a second source for two seconds, so
/// consecutive commands share a port.
std::uint16_t port_of_object(std::uint32_t tag) { return static_cast<std::uint16_t>(49152 + tag % 16384); }

/// @param port 0, or one that is taken: any
netio::Outbox outbox_at(std::uint32_t farm, std::uint16_t port) {
  try {
    return netio::Outbox({.bind = netio::own_end_for(farm, port)});
  } catch (const base::InputError&) {
    if (port == 0) throw;
    return outbox_at(farm, 0);
  }
}

/// Returns a number that grows from command to command: milliseconds.
std::uint32_t next_sequence() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

/// @throws base::InputError if the table lacks the key, since a farm with a key would drop the packet
std::optional<netio::PacketSigner> signer_of(const PeersOption& options, const netio::Claim& claim,
                                             std::string_view what) {
  if (options.peers.empty()) return std::nullopt;
  const std::vector<netio::Peer> peers = peers_of(options, nullptr);
  const netio::Peer* own = netio::find(peers, claim.kind, claim.id);
  const bool start = claim.kind == netio::PeerKind::start;
  if (own == nullptr || !own->key)
    throw base::InputError(options.peers, 0,
                           fmt::format("has no key for {}; expected a [[peer]] section with {} and key", what,
                                       start ? "start = true" : fmt::format("tag = {}", claim.id)));
  return netio::PacketSigner(*own->key);
}

template <class Body>
void send_repeatedly(const netio::Endpoint& farm, netio::Header header, const Body& body,
                     std::optional<netio::PacketSigner> signer, std::uint16_t port = 0) {
  netio::Outbox outbox = outbox_at(farm.address, port);
  base::Bytes packet;
  for (int i = 0; i < kRepetitions; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    header.sequence = next_sequence();
    netio::encode(header, body, packet);
    if (signer) signer->sign(packet);
    outbox.queue(farm, packet);
    outbox.flush();
  }
  if (outbox.counts().sent == 0) throw base::InputError("nothing was sent: " + outbox.counts().first_failure);
}

}  // namespace

int start(const StartOptions& options) {
  const netio::Endpoint farm = farm_of(options);
  send_repeatedly(farm, {.robot = static_cast<std::uint16_t>(options.start_id)}, netio::Start{},
                  signer_of(options, {netio::PeerKind::start, 0}, "START"));
  print_message("start signal sent to {} for {}, {} times; it is not acknowledged", netio::endpoint_text(farm),
                options.start_id == netio::kBroadcastId ? "all robots" : ("robot " + std::to_string(options.start_id)),
                kRepetitions);
  return 0;
}

int object(const ObjectOptions& options) {
  const netio::Endpoint farm = farm_of(options);
  netio::Object object{.present = options.state == ObjectOptions::State::present,
                       .shape = options.shape,
                       .color = std::nullopt,
                       .size = options.size};
  if (!options.shape.empty() && !base::is_shape_name(options.shape))
    throw base::InputError(
        fmt::format("--shape: '{}' is no name of a shape; expected ASCII letters, digits, '_', '-' "
                    "or '.'",
                    options.shape));
  if (!options.color.empty()) object.color = world::color_named(options.color);
  send_repeatedly(farm, {.robot = static_cast<std::uint16_t>(options.tag)}, object,
                  signer_of(options, {netio::PeerKind::tag, options.tag}, "the object"), port_of_object(options.tag));
  print_message("'{}{}' sent to {} for the object of tag {}, {} times; it is not acknowledged",
                object.present ? "present" : "absent", object.changes_shape() ? ", with another shape" : "",
                netio::endpoint_text(farm), options.tag, kRepetitions);
  return 0;
}

int lane(const LaneOptions& options) {
  const netio::Endpoint farm = farm_of(options);
  const auto id = world::read_point_id(options.lane + ".1");
  if (!id) throw base::InputError(fmt::format("'{}' is no lane; expected segment.lane, such as 3.1", options.lane));
  const world::LaneUse use = world::lane_use_of(options.use);
  send_repeatedly(farm, {.robot = netio::kBroadcastId},
                  netio::Lane{id->segment, id->lane, static_cast<std::uint32_t>(use.rule), use.reversed},
                  signer_of(options, {netio::PeerKind::start, 0}, "LANE"));
  print_message("'{}' sent to {} for lane {}, {} times; it is not acknowledged", options.use,
                netio::endpoint_text(farm), options.lane, kRepetitions);
  return 0;
}

}  // namespace sf::apps
