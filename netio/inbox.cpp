#include "netio/inbox.h"

#include <poll.h>

#include <algorithm>
#include <string>

#include "base/error.h"

namespace sf::netio {

namespace {

constexpr std::size_t kBatch = 64;
constexpr std::size_t kSendBuffer = 1u << 20;         ///< [byte] of what is sent through a duplicate of the socket
constexpr std::int64_t kChallengeSpan = 100'000'000;  ///< [ns]
constexpr std::size_t kStateLine = 0;
constexpr std::size_t kSubscribeLine = 1;

void require_ids(std::span<const std::uint32_t> ids, std::uint32_t smallest, const std::string& what) {
  for (const std::uint32_t id : ids) {
    if (id >= smallest && id <= kMaxId) continue;
    throw base::InputError(what + " id " + std::to_string(id) + " does not fit a packet, which holds " +
                           std::to_string(smallest) + " to " + std::to_string(kMaxId) + ": number the world's " + what +
                           "s within these");
  }
}

}  // namespace

Inbox::Inbox(const InboxOptions& options)
    : robots_(options.robots),
      tags_(options.tags),
      kinds_(options.robots.size(), 0),
      sessions_(options.robots.size(), 0),
      session_(options.session),
      socket_(open_udp(options.bind, {.receive = options.receive_buffer, .send = kSendBuffer})),
      batch_(kBatch) {
  require_ids(options.robots, 0, "robot");
  require_ids(options.tags, kMinTag, "tag");
}

void Inbox::wait(int timeout_ms) const {
  pollfd readable{socket_.descriptor(), POLLIN, 0};
  poll(&readable, 1, timeout_ms);
}

Reason Inbox::accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now, Packet& packet) {
  Reason reason = decode(bytes, packet);
  if (reason == Reason::accepted) reason = judge(packet, source, now);
  counts_.add(reason);
  return reason;
}

Reason Inbox::judge(const Packet& packet, const Endpoint& source, std::int64_t now) {
  switch (packet.header.type) {
    case Type::v2v:
    case Type::subscribe:
      return judge_robot(packet, source, now);
    case Type::leave:
      if (!robots_.row(packet.header.robot)) return Reason::unknown_robot;
      if (packet.header.token != tokens_.of(source)) return Reason::unproven;
      return robots_.leave(packet.header.robot, source, now);
    case Type::tag:
      if (!tags_.row(packet.header.robot)) return Reason::unknown_tag;
      return tags_.admit(packet.header.robot, kStateLine, packet.header.sequence, source, now);
    case Type::start:
      return packet.header.robot == kEveryone || robots_.row(packet.header.robot) ? Reason::accepted
                                                                                  : Reason::unknown_robot;
    case Type::challenge:
    case Type::neighbours:
      break;
  }
  return Reason::wrong_direction;
}

Reason Inbox::judge_robot(const Packet& packet, const Endpoint& source, std::int64_t now) {
  const std::uint32_t id = packet.header.robot;
  const auto row = robots_.row(id);
  if (!row) return Reason::unknown_robot;
  if (packet.header.token != tokens_.of(source)) return Reason::unproven;

  const bool was_heard = robots_.heard(id, now);
  const auto* request = std::get_if<Subscribe>(&packet.body);
  const Reason reason =
      robots_.admit(id, request != nullptr ? kSubscribeLine : kStateLine, packet.header.sequence, source, now);
  if (reason != Reason::accepted) return reason;
  if (!was_heard) kinds_[*row] = 0;
  if (request != nullptr) kinds_[*row] = request->kinds;
  sessions_[*row] = packet.header.session;
  return Reason::accepted;
}

bool Inbox::challenge(const Packet& packet, const Endpoint& who, std::int64_t now, base::Bytes& out) {
  if (packet.header.type == Type::leave) return false;
  if (now - challenging_since_ >= kChallengeSpan) {
    challenging_since_ = now;
    challenges_ = 0;
  }
  if (challenges_ == kMostChallenges) return false;
  ++challenges_;
  Header header;
  header.robot = packet.header.robot;
  header.session = session_;
  header.token = packet.header.session;
  encode(header, Challenge{tokens_.of(who)}, out);
  return true;
}

Stamp Inbox::stamp_for(std::uint32_t robot) const {
  const auto row = robots_.row(robot);
  return {session_, row ? sessions_[*row] : 0};
}

bool Inbox::asks_for_others(std::uint32_t robot, std::int64_t now) const {
  return heard(robot, now) && (kinds_[*robots_.row(robot)] & kOthers) != 0;
}

bool Inbox::wants(std::uint32_t robot, std::uint32_t kind, std::int64_t now) const {
  SF_CHECK(kind < 32, "sensor kind " + std::to_string(kind));
  if (!heard(robot, now)) return false;
  const std::uint32_t kinds = kinds_[*robots_.row(robot)];
  return kinds == 0 || (kinds >> kind & 1u) != 0;
}

}  // namespace sf::netio
