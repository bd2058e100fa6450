#include "netio/inbox.h"

#include <poll.h>

#include <algorithm>
#include <string>

#include "base/elapsed.h"
#include "base/error.h"

namespace sf::netio {

namespace {

constexpr std::size_t kBatch = 64;
constexpr std::size_t kSendBuffer = 1u << 20;  ///< [byte] for packets sent through a duplicate of the socket
constexpr std::int64_t kPeriod = 100'000'000;  ///< [ns] period of the limits on requests from strangers
constexpr std::size_t kStateChannel = 0;
constexpr std::size_t kSubscribeChannel = 1;
constexpr std::size_t kOwnReadingsChannel = 2;

void require_ids(std::span<const std::uint32_t> ids, std::uint32_t smallest, const std::string& what) {
  for (const std::uint32_t id : ids) {
    if (id >= smallest && id <= kMaxId) continue;
    throw base::InputError(what + " id " + std::to_string(id) + " does not fit into a packet, which holds " +
                           std::to_string(smallest) + " to " + std::to_string(kMaxId) + ": number the world's " + what +
                           "s within these");
  }
}

/// Senders that prove their address, and receive packets at it.
bool is_answered(PeerKind kind) {
  return kind == PeerKind::robot || kind == PeerKind::light || kind == PeerKind::centre;
}

/// The ids of control centres that the peers permit: 0, or none.
std::vector<std::uint32_t> centre_ids(std::span<const Peer> peers) {
  return find(peers, PeerKind::centre, 0) != nullptr ? std::vector<std::uint32_t>{0} : std::vector<std::uint32_t>{};
}

}  // namespace

Inbox::Inbox(const InboxOptions& options)
    : robots_(options.robots, options.take_late),
      tags_(options.tags, options.take_late),
      objects_(options.tags),
      lights_(options.lights),
      centres_(centre_ids(options.peers)),
      peers_(options.peers),
      types_(options.robots.size(), 0),
      follows_drive_(options.robots.size(), 0),
      sessions_(options.robots.size(), 0),
      light_sessions_(options.lights.size(), 0),
      session_(options.session),
      lockstep_(options.lockstep),
      socket_(open_udp(options.bind, {.receive = options.receive_buffer, .send = kSendBuffer})),
      batch_(kBatch) {
  require_ids(options.robots, 0, "robot");
  require_ids(options.tags, kMinTag, "tag");
  require_ids(options.lights, 0, "intersection");
}

void Inbox::wait(int timeout_ms) const {
  pollfd readable{socket_.descriptor(), POLLIN, 0};
  poll(&readable, 1, timeout_ms);
}

PacketStatus Inbox::accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now,
                           Packet& packet) {
  PacketStatus status = decode(bytes, packet);
  if (status == PacketStatus::accepted) status = check(packet, bytes, source, now);
  counts_.add(status);
  return status;
}

PacketStatus Inbox::check(Packet& packet, std::span<const std::uint8_t> bytes, const Endpoint& source,
                          std::int64_t now) {
  PacketStatus status = check_id(packet.header);
  if (status != PacketStatus::accepted) return status;
  const bool proven = is_proven(packet.header, source);
  packet.unchecked = has_signature(bytes) && !peers_.has_key(claim_of(packet.header));
  status = check_peer(packet.header, bytes, source, proven, now);
  if (status != PacketStatus::accepted) return status;
  return proven ? admit(packet, source, now) : PacketStatus::unproven;
}

/// Checks whether the packet can concern the farm at all.
PacketStatus Inbox::check_id(const Header& header) const {
  const auto known = [&](bool is_known) { return is_known ? PacketStatus::accepted : PacketStatus::unknown_robot; };
  const auto robot_if = [&](bool is_taken) {
    return is_taken ? known(robots_.row(header.robot).has_value()) : PacketStatus::wrong_direction;
  };
  switch (header.type) {
    case Type::subscribe:
    case Type::leave:
      if (claim_of(header).kind == PeerKind::centre) return known(centres_.row(0).has_value());
      return robot_if(true);
    case Type::v2v:
    case Type::own_readings:
      return robot_if(!lockstep_);
    case Type::command:
    case Type::step:
    case Type::fetch:
      return robot_if(lockstep_);
    case Type::start:
      if (lockstep_) break;
      return known(header.robot == kBroadcastId || robots_.row(header.robot));
    case Type::lane:
      if (lockstep_) break;
      return PacketStatus::accepted;
    case Type::tag:
    case Type::object:
      if (lockstep_) break;
      return tags_.row(header.robot) ? PacketStatus::accepted : PacketStatus::unknown_tag;
    case Type::v2i:
      if (lockstep_) break;
      return lights_.row(header.robot) ? PacketStatus::accepted : PacketStatus::unknown_light;
    case Type::challenge:
    case Type::refusal:
    case Type::neighbours:
    case Type::state:
    case Type::values:
    case Type::drive:
    case Type::team_map:
    case Type::dropped:
      break;
  }
  return PacketStatus::wrong_direction;
}

/// Checks the token of the source address. START, LANE, TAG and OBJECT have no token.
bool Inbox::is_proven(const Header& header, const Endpoint& source) const {
  const PeerKind kind = claim_of(header).kind;
  return kind == PeerKind::start || kind == PeerKind::tag || header.token == tokens_.of(source);
}

/// Always checks signatures of robots and lights at proven addresses. The cost of other checks is limited to a part of
/// a tick's time. Signatures of unproven packets do not advance counters: if a copy from another address arrives first,
/// the genuine packet is still accepted.
PacketStatus Inbox::check_peer(const Header& header, std::span<const std::uint8_t> bytes, const Endpoint& source,
                               bool proven, std::int64_t now) {
  const Claim claim = claim_of(header);
  const bool answered = is_answered(claim.kind);
  const bool bounded = peers_.has_key(claim) && !(proven && answered);
  if (bounded) begin_period(now);
  if (bounded && doubtful_signatures_ == kMaxDoubtfulSignatures) return PacketStatus::wrong_signature;
  const PacketStatus status = peers_.check(claim, bytes, source, proven);
  if (bounded && (!proven || status == PacketStatus::wrong_signature)) ++doubtful_signatures_;
  return status;
}

/// Copies of a signed packet are not reported unless the sender's clock is behind by at least this much.
bool Inbox::is_notable(PacketStatus status, const Packet& packet) {
  constexpr std::uint64_t kClockTrouble = 1'000'000;  // [us]
  switch (status) {
    case PacketStatus::accepted:
      return packet.unchecked;
    case PacketStatus::unproven:
    case PacketStatus::wrong_source:
    case PacketStatus::not_signed:
      return true;
    case PacketStatus::wrong_signature:
      return doubtful_signatures_ < kMaxDoubtfulSignatures;
    case PacketStatus::replayed:
      return peers_.lag(claim_of(packet.header)) >= kClockTrouble;
    default:
      return false;
  }
}

PacketStatus Inbox::admit(Packet& packet, const Endpoint& source, std::int64_t now) {
  const PeerKind kind = claim_of(packet.header).kind;
  if (kind == PeerKind::start) return PacketStatus::accepted;
  if (kind == PeerKind::centre) return admit_centre(packet, source, now);
  if (packet.header.type == Type::tag) return admit_state(tags_, packet, source, now);
  if (packet.header.type == Type::object)
    return objects_.admit(packet.header.robot, kStateChannel, packet.header.sequence, source, now);
  if (packet.header.type == Type::v2i) return admit_light(packet, source, now);
  if (packet.header.type == Type::leave) {
    // LEAVE is accepted even if a process in lockstep has been silent for long.
    if (lockstep_) admit_driver(packet, source, now);
    return robots_.leave(packet.header.robot, source, now);
  }
  if (packet.header.type == Type::v2v || packet.header.type == Type::subscribe) return admit_robot(packet, source, now);
  if (packet.header.type == Type::own_readings) return admit_own_readings(packet, source, now);
  return admit_driver(packet, source, now);
}

/// COMMAND, STEP and FETCH contain their tick and need no order. Their process has subscribed before.
PacketStatus Inbox::admit_driver(const Packet& packet, const Endpoint& source, std::int64_t now) {
  const Header& header = packet.header;
  if (sessions_[*robots_.row(header.robot)] != header.session) return PacketStatus::stale;
  return robots_.renew(header.robot, source, now);
}

/// A robot that is not active has no virtual readings to which its own could belong.
PacketStatus Inbox::admit_own_readings(const Packet& packet, const Endpoint& source, std::int64_t now) {
  const Header& header = packet.header;
  if (!robots_.is_active(header.robot, now) || sessions_[*robots_.row(header.robot)] != header.session)
    return PacketStatus::stale;
  return robots_.admit(header.robot, kOwnReadingsChannel, header.sequence, source, now);
}

PacketStatus Inbox::admit_robot(Packet& packet, const Endpoint& source, std::int64_t now) {
  const std::uint32_t id = packet.header.robot;
  const std::size_t row = *robots_.row(id);
  const bool was_active = robots_.is_active(id, now);
  const auto* request = std::get_if<Subscribe>(&packet.body);
  const PacketStatus status = request != nullptr
                                  ? robots_.admit(id, kSubscribeChannel, packet.header.sequence, source, now)
                                  : admit_state(robots_, packet, source, now);
  if (status != PacketStatus::accepted || packet.late) return status;
  if (!was_active) types_[row] = 0, follows_drive_[row] = 0;
  if (request != nullptr) types_[row] = request->types, follows_drive_[row] = packet.header.sensor == kFollowsDrive;
  sessions_[row] = packet.header.session;
  return PacketStatus::accepted;
}

PacketStatus Inbox::admit_light(const Packet& packet, const Endpoint& source, std::int64_t now) {
  const std::uint32_t id = packet.header.robot;
  const PacketStatus status = lights_.admit(id, kStateChannel, packet.header.sequence, source, now);
  if (status == PacketStatus::accepted) light_sessions_[*lights_.row(id)] = packet.header.session;
  return status;
}

PacketStatus Inbox::admit_centre(const Packet& packet, const Endpoint& source, std::int64_t now) {
  if (packet.header.type == Type::leave) return centres_.leave(0, source, now);
  const PacketStatus status = centres_.admit(0, kSubscribeChannel, packet.header.sequence, source, now);
  if (status == PacketStatus::accepted) centre_session_ = packet.header.session;
  return status;
}

/// Marks a state that newer states of its bound sender overtook, if such states are accepted.
PacketStatus Inbox::admit_state(SenderBindings& bindings, Packet& packet, const Endpoint& source, std::int64_t now) {
  const std::uint32_t id = packet.header.robot;
  const PacketStatus status = bindings.admit(id, kStateChannel, packet.header.sequence, source, now);
  // An inactive sender has left.
  packet.late = bindings.takes_late(id) && status == PacketStatus::stale && bindings.is_active(id, now);
  return packet.late ? PacketStatus::accepted : status;
}

void Inbox::set_take_late(PeerKind kind, std::uint32_t id, bool take) {
  (kind == PeerKind::tag ? tags_ : robots_).set_takes_late(id, take);
}

bool Inbox::challenge(const Packet& packet, const Endpoint& who, std::int64_t now, base::Bytes& out) {
  if (packet.header.type == Type::leave) return false;
  begin_period(now);
  PacketSigner* const own = peers_.signer(claim_of(packet.header));
  std::size_t& challenges = challenges_[own != nullptr ? 1 : 0];
  if (challenges == kMaxChallenges) return false;
  ++challenges;
  Header header;
  header.robot = packet.header.robot;
  header.session = session_;
  header.token = packet.header.session;
  encode(header, Challenge{tokens_.of(who)}, out);
  if (own != nullptr) own->sign(out);
  return true;
}

bool Inbox::refuse(const Packet& packet, PacketStatus reason, std::int64_t now, base::Bytes& out) {
  const PeerKind kind = claim_of(packet.header).kind;
  if (packet.header.type == Type::leave || !is_answered(kind)) return false;
  begin_period(now);
  if (refusals_ == kMaxRefusals) return false;
  ++refusals_;
  Header header;
  header.robot = packet.header.robot;
  header.time = base::unix_time();
  header.session = session_;
  header.token = packet.header.session;
  encode(header, Refusal{reason}, out);
  return true;
}

void Inbox::begin_period(std::int64_t now) {
  if (now - period_start_ < kPeriod) return;
  period_start_ = now;
  challenges_ = {};
  doubtful_signatures_ = 0;
  refusals_ = 0;
}

SessionToken Inbox::session_token_for(std::uint32_t robot) const {
  const auto row = robots_.row(robot);
  return {session_, row ? sessions_[*row] : 0};
}

std::optional<Endpoint> Inbox::light_address(std::uint32_t light, std::int64_t now) const {
  return lights_.is_active(light, now) ? lights_.source(light) : std::nullopt;
}

std::optional<Endpoint> Inbox::centre_address(std::int64_t now) const {
  return centres_.is_active(0, now) ? centres_.source(0) : std::nullopt;
}

SessionToken Inbox::light_session_token(std::uint32_t light) const {
  const auto row = lights_.row(light);
  return {session_, row ? light_sessions_[*row] : 0};
}

bool Inbox::wants_neighbours(std::uint32_t robot, std::int64_t now) const {
  return is_active(robot, now) && (types_[*robots_.row(robot)] & kNeighboursBit) != 0;
}

bool Inbox::follows_drive(std::uint32_t robot, std::int64_t now) const {
  return is_active(robot, now) && follows_drive_[*robots_.row(robot)] != 0;
}

bool Inbox::is_subscribed(std::uint32_t robot, std::uint32_t type, std::int64_t now) const {
  SF_CHECK(type < 64, "sensor type " + std::to_string(type));
  if (!is_active(robot, now)) return false;
  const base::SensorTypes types = types_[*robots_.row(robot)];
  return types == 0 || (types >> type & 1u) != 0;
}

}  // namespace sf::netio
