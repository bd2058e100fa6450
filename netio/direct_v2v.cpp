#include "netio/direct_v2v.h"

#include <poll.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "base/elementary.h"
#include "base/error.h"
#include "netio/posix.h"

namespace sf::netio {

namespace {

constexpr std::size_t kDirectBatch = 64;
constexpr std::size_t kDirectChannel = 0;
constexpr std::int64_t kDirectPeriod = 100'000'000;       ///< [ns]
constexpr std::uint64_t kDirectClockTrouble = 1'000'000;  ///< [us] lag from which a replayed packet is reported

ip_mreqn membership(std::uint32_t group, std::uint32_t interface_address) {
  ip_mreqn request{};
  request.imr_multiaddr.s_addr = htonl(group);
  request.imr_address.s_addr = htonl(interface_address);
  return request;
}

[[noreturn]] void refuse_group(const Endpoint& group, int error) {
  throw base::InputError(
      fmt::format("cannot use the multicast group {}: {}; name the address of an interface (--v2v-interface), as `ip "
                  "address` lists "
                  "them",
                  endpoint_text(group), error_text(error)));
}

/// Several robots of one machine may join a group at one port. The socket receives from its own interface only.
Socket join_group(const DirectV2vOptions& options) {
  const Endpoint& group = *options.group;
  if (!is_multicast(group.address))
    throw base::InputError(
        fmt::format("{} is not a multicast group; expected an address from 224.0.0.0 to "
                    "239.255.255.255, such as 239.255.0.1:9401",
                    endpoint_text(group)));
  Socket joined(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1, off = 0, size = static_cast<int>(options.receive_buffer);
  setsockopt(joined.descriptor(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  setsockopt(joined.descriptor(), SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
  setsockopt(joined.descriptor(), IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off);
  bind_socket(joined, group, "UDP");
  const ip_mreqn request = membership(group.address, options.interface_address);
  if (setsockopt(joined.descriptor(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0)
    refuse_group(group, errno);
  return joined;
}

void require_unicast(const DirectV2vOptions& options) {
  for (const Endpoint& peer : options.peers)
    if (is_multicast(peer.address))
      throw base::InputError(
          fmt::format("{} is a multicast address; use it as the group (--v2v-group)", endpoint_text(peer)));
  if (options.peers.size() > DirectV2v::kMaxReceivers)
    throw base::InputError(
        fmt::format("{} addresses to send V2V to; at most {} are possible, a multicast group reaches "
                    "more (--v2v-group)",
                    options.peers.size(), DirectV2v::kMaxReceivers));
  if (options.group && options.group->port == options.bind.port)
    throw base::InputError(fmt::format(
        "the multicast group and the robot itself receive at port {}; choose different ports (--v2v-port, --v2v-group)",
        options.bind.port));
}

/// Opens the socket that sends. A time to live of 1 keeps multicast in the local network.
Socket open_direct(const DirectV2vOptions& options) {
  require_unicast(options);
  Socket opened = open_udp(options.bind, {.receive = options.receive_buffer});
  if (!options.group) return opened;
  const int one = 1;
  setsockopt(opened.descriptor(), IPPROTO_IP, IP_MULTICAST_TTL, &one, sizeof one);
  setsockopt(opened.descriptor(), IPPROTO_IP, IP_MULTICAST_LOOP, &one, sizeof one);
  const ip_mreqn request = membership(options.group->address, options.interface_address);
  if (options.interface_address != 0 &&
      setsockopt(opened.descriptor(), IPPROTO_IP, IP_MULTICAST_IF, &request, sizeof request) != 0)
    refuse_group(*options.group, errno);
  return opened;
}

/// Returns the key of the group, else that of the robot.
std::optional<SigningKey> direct_key(const DirectV2vOptions& options, std::uint32_t robot) {
  const Peer* peer = find(options.table, PeerKind::group, 0);
  if (peer == nullptr) peer = find(options.table, PeerKind::robot, robot);
  return peer != nullptr ? peer->key : std::nullopt;
}

std::string refusal_text(PacketStatus status) {
  switch (status) {
    case PacketStatus::not_signed:
      return "not signed, but --peers has a key for it: give the sender the same entry";
    case PacketStatus::wrong_signature:
      return "signed with another key: both need the same entry in their files of --peers";
    case PacketStatus::replayed:
      return "sent before, or the sender's clock was set back";
    default:
      return "another process sends as this robot, or --peers has another address for it";
  }
}

}  // namespace

DirectV2v::DirectV2v(const DirectV2vOptions& options)
    : options_(options),
      socket_(open_direct(options)),
      group_(options.group ? join_group(options) : Socket()),
      outbox_(duplicate(socket_), {.capacity = options.peers.size() + 1}),
      batch_(kDirectBatch),
      senders_(options.others),
      newest_(options.others),
      details_(options.others.size()),
      log_(options.log_descriptor),
      rejections_(options.others) {
  for (const std::uint32_t id : options.others) {
    Sender& sender = details_[*senders_.row(id)];
    if (const Peer* peer = find(options.table, PeerKind::robot, id)) sender.address = peer->address;
    if (const auto key = direct_key(options, id)) sender.checker.emplace(*key);
  }
  if (const auto key = direct_key(options, options.robot)) signer_.emplace(*key);
}

void DirectV2v::send(std::span<const std::uint8_t> bytes) {
  packet_.assign(bytes.begin(), bytes.end());
  write_session_token(packet_, {options_.session, 0});
  if (signer_) signer_->sign(packet_);
  for (const Endpoint& peer : options_.peers) outbox_.queue(peer, packet_);
  if (options_.group) outbox_.queue(*options_.group, packet_);
  outbox_.flush();
}

void DirectV2v::begin_period(std::int64_t now) {
  if (now - period_start_ < kDirectPeriod) return;
  period_start_ = now;
  checked_ = 0;
}

bool DirectV2v::is_over_rate(std::int64_t now) {
  if (++checked_ <= kMaxPerPeriod) return false;
  ++counts_.over_rate;
  if (const std::uint64_t count = flood_.count(now); count > 0)
    log_.write(fmt::format("{} of direct V2V dropped unread: more than {} arrived within 0.1 s", packets_text(count),
                           kMaxPerPeriod),
               now);
  return true;
}

bool DirectV2v::accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now) {
  if (is_over_rate(now)) return false;
  Packet packet;
  PacketStatus status = decode(bytes, packet);
  const Header& header = packet.header;
  if (status == PacketStatus::accepted) {
    if (header.robot == options_.robot && header.session == options_.session) return ++counts_.own, false;
    if (is_repeated(header, now)) return ++counts_.duplicates, false;
    status = check_sender(packet, bytes, source);
  }
  if (status == PacketStatus::accepted) {
    if (is_far(packet, now)) return ++counts_.far, false;
    status = bind_sender(header, source, now);
  }
  counts_.packets.add(status);
  if (status != PacketStatus::accepted) note(status, bytes, source, now);
  return status == PacketStatus::accepted;
}

/// A packet that was sent both to an address and to the group arrives twice.
bool DirectV2v::is_repeated(const Header& header, std::int64_t now) const {
  const bool is_map = header.type == Type::team_map;
  if ((header.type != Type::v2v && !is_map) || !senders_.is_active(header.robot, now)) return false;
  const Sender& sender = details_[*senders_.row(header.robot)];
  return header.session == sender.session &&
         (is_map ? header.sequence == sender.map_sequence : header.sequence == sender.sequence);
}

PacketStatus DirectV2v::check_sender(const Packet& packet, std::span<const std::uint8_t> bytes,
                                     const Endpoint& source) {
  const std::uint32_t id = packet.header.robot;
  const bool is_state = std::holds_alternative<V2v>(packet.body);
  if (!is_state && !std::holds_alternative<TeamMap>(packet.body)) return PacketStatus::wrong_direction;
  if (id == options_.robot) return PacketStatus::wrong_source;
  const auto row = senders_.row(id);
  if (!row) return PacketStatus::unknown_robot;
  Sender& sender = details_[*row];
  if (sender.address && *sender.address != source.address) return PacketStatus::wrong_source;
  return sender.checker ? sender.checker->check(bytes) : PacketStatus::accepted;
}

/// Returns whether a robot with another session than before has started again. A valid signature with a newer counter
/// proves it; otherwise its silence does. The session that it replaced is not accepted again: of two processes with one
/// id, the later one remains.
bool DirectV2v::has_restarted(const Header& header, const Endpoint& source, std::int64_t now) const {
  const Sender& sender = details_[*senders_.row(header.robot)];
  if (sender.restarted && now - *sender.restarted < kSenderTimeout && header.session == sender.session_before)
    return false;
  return sender.checker || (now - sender.last >= kRestart && senders_.source(header.robot)->address == source.address);
}

/// A signature identifies a sender better than its address: whoever sends a copy of a signed packet first must not bind
/// the id to the address of the copy.
PacketStatus DirectV2v::bind_sender(const Header& header, const Endpoint& source, std::int64_t now) {
  Sender& sender = details_[*senders_.row(header.robot)];
  if (senders_.is_active(header.robot, now) && header.session != sender.session) {
    if (!has_restarted(header, source, now)) return PacketStatus::wrong_source;
    senders_.forget(header.robot);
    newest_.forget(header.robot);
    sender.session_before = sender.session;
    sender.restarted = now;
  }
  const bool is_map = header.type == Type::team_map;  // its receiver puts the pieces in order
  const Endpoint from = sender.checker ? Endpoint{} : source;
  const PacketStatus status = is_map ? senders_.renew(header.robot, from, now)
                                     : senders_.admit(header.robot, kDirectChannel, header.sequence, from, now);
  if (status != PacketStatus::accepted) return status;
  sender.last = now;
  if (is_map) {
    sender.map_sequence = header.sequence;
    return status;
  }
  if (header.session != sender.session) sender.map_sequence.reset();
  sender.session = header.session;
  sender.sequence = header.sequence;
  sender.last_state = now;
  return status;
}

/// A map has no position: its sender is as far away as its last state says.
bool DirectV2v::is_far(const Packet& packet, std::int64_t now) const {
  if (const auto* state = std::get_if<V2v>(&packet.body))
    return p_ && base::hypot(state->X_WR.x - p_->x, state->X_WR.y - p_->y) > options_.radio;
  const Sender& sender = details_[*senders_.row(packet.header.robot)];
  return packet.header.session != sender.session || !sender.last_state || now - *sender.last_state >= kSenderTimeout;
}

bool DirectV2v::admit(const Header& header, std::int64_t now) {
  const auto row = senders_.row(header.robot);
  if (!row) return false;
  const Sender& sender = details_[*row];
  const bool is_direct = header.session == sender.session;
  const bool old = !is_direct && sender.restarted && now - *sender.restarted < kSenderTimeout;
  if (!old && newest_.admit(header.robot, kDirectChannel, header.sequence, {}, now) == PacketStatus::accepted)
    return true;
  ++counts_.duplicates;
  return false;
}

/// Reports senders of malformed packets by address, and robots of the world by id.
void DirectV2v::note(PacketStatus status, std::span<const std::uint8_t> bytes, const Endpoint& source,
                     std::int64_t now) {
  rejections_.note(status, bytes, source, now, log_);
  const bool is_source = status == PacketStatus::wrong_source;
  if (!is_source && status != PacketStatus::not_signed && status != PacketStatus::wrong_signature &&
      status != PacketStatus::replayed)
    return;
  const std::uint32_t id = bytes[kRobotAt] + 256u * bytes[kRobotAt + 1];
  if (status == PacketStatus::replayed && details_[*senders_.row(id)].checker->lag() < kDirectClockTrouble) return;
  const std::uint64_t count = refused_[{id, status}].count(now, is_source ? RejectionLog::kTolerated : 0);
  if (count == 0) return;
  log_.write(fmt::format("{} of direct V2V of robot {} from {} dropped: {} (docs/packets.md)", packets_text(count), id,
                         endpoint_text(source), refusal_text(status)),
             now);
}

void DirectV2v::wait(const Socket& one, const Socket& other, int timeout_ms) const {
  pollfd readable[] = {{one.descriptor(), POLLIN, 0},
                       {other.descriptor(), POLLIN, 0},
                       {socket_.descriptor(), POLLIN, 0},
                       {group_.descriptor(), POLLIN, 0}};  // poll ignores descriptor -1
  poll(readable, std::size(readable), timeout_ms);
}

DirectV2vCounts DirectV2v::counts() const {
  DirectV2vCounts counts = counts_;
  counts.sent = outbox_.counts();
  counts.socket_drops = socket_drops(socket_) + (options_.group ? socket_drops(group_) : 0);
  counts.lines_left_out = log_.left_out();
  return counts;
}

}  // namespace sf::netio
