#pragma once
// Receives and validates datagrams with states and requests. No datagram can stop it, and it allocates nothing after
// construction.
//
//   Inbox inbox({.robots = ids});
//   inbox.receive(now, [&](const Packet& packet) { ... });                     // each accepted packet
//   if (inbox.is_active(7, now) && inbox.is_subscribed(7, type, now)) ...      // send to *inbox.address(7)
//
// Packets of a robot are accepted only with the token that was sent to their source address (netio/address_token.h).
// Without it the answer is a CHALLENGE, which is no larger than the packet. Peers with a key must also sign their
// packets, and receive signed packets.
//
// Single-threaded. Reads no clock: `now` [ns] is from any clock that does not decrease.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "netio/address_token.h"
#include "netio/endpoint.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/peers.h"
#include "netio/ports.h"
#include "netio/sender_bindings.h"
#include "netio/socket.h"

namespace sf::netio {

struct InboxOptions {
  Endpoint bind = {kLoopback, kInboxPort};   ///< address 0 (0.0.0.0): all interfaces of the machine
  std::size_t receive_buffer = 4u << 20;     ///< [byte] requested from the kernel
  std::vector<std::uint32_t> robots;         ///< ids of the world's robots, distinct, each in [0, kMaxId]
  std::vector<std::uint32_t> tags;           ///< ids of the world's tags, distinct, each in [kMinTag, kMaxId]
  std::uint32_t session = random_session();  ///< session of the farm
  std::vector<Peer> peers;                   ///< peers among these robots and tags, and START; each at most once
  bool take_late = false;                    ///< accept states that newer states of their sender overtook, marked by
                                             ///< `Packet::late`
  bool lockstep = false;              ///< accept COMMAND, STEP and FETCH in place of V2V, OWN_READINGS, TAG, START, V2I
                                      ///< and OBJECT
  std::vector<std::uint32_t> lights;  ///< ids of the world's intersections, distinct, each in [0, kMaxId]
};

class Inbox {
 public:
  /// Maximum number of datagrams per `receive`, which bounds its duration under a flood.
  static constexpr std::size_t kMaxPerReceive = 65'536;
  /// Maximum number of CHALLENGE packets in 0.1 s, separately for robots without a key and robots with one. Further
  /// requests are not answered.
  static constexpr std::size_t kMaxChallenges = 1000;
  /// Maximum number of signatures checked in 0.1 s that belong to unproven robots, or are wrong signatures of tags and
  /// START. Further packets of tags, START and unproven robots with keys are dropped as wrong_signature.
  static constexpr std::size_t kMaxDoubtfulSignatures = 10'000;
  static constexpr std::size_t kMaxRefusals = 100;  ///< REFUSAL packets in 0.1 s

  /// @throws base::InputError if the address cannot be bound or an id does not fit a packet
  explicit Inbox(const InboxOptions& options);

  /// Reads all waiting datagrams. Calls `take(const Packet&)` for each accepted packet, in order of arrival. Calls
  /// `on_notable(PacketStatus, const Packet&, const Endpoint& source)` for each valid packet that is unproven, from the
  /// wrong source, or refused for its signature, and for accepted packets that are `unchecked`; not for copies of
  /// signed packets, nor for packets whose signature was not checked because of the limit.
  /// @return number of datagrams read
  /// @param on_dropped called for each dropped datagram: (PacketStatus, bytes, const Endpoint& source)
  template <class Take, class OnNotable, class OnDropped>
  std::size_t receive(std::int64_t now, Take&& take, OnNotable&& on_notable, OnDropped&& on_dropped) {
    Packet packet;
    return batch_.drain(socket_, kMaxPerReceive, [&](std::span<const std::uint8_t> bytes, const Endpoint& source) {
      const PacketStatus status = accept(bytes, source, now, packet);
      if (status == PacketStatus::accepted) take(packet);
      if (is_notable(status, packet)) on_notable(status, packet, source);
      if (status != PacketStatus::accepted) on_dropped(status, bytes, source);
    });
  }

  template <class Take>
  std::size_t receive(std::int64_t now, Take&& take) {
    return receive(
        now, take, [](PacketStatus, const Packet&, const Endpoint&) {},
        [](PacketStatus, std::span<const std::uint8_t>, const Endpoint&) {});
  }

  /// Validates and counts one datagram from `source`. Fills `packet` if the status is accepted, or if `on_notable` is
  /// called for it (undefined otherwise). `receive` calls this for each datagram of the socket.
  PacketStatus accept(std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now, Packet& packet);

  /// Sets whether overtaken states of one robot or tag are accepted, in place of `InboxOptions::take_late`.
  /// @pre the id is known
  void set_take_late(PeerKind kind, std::uint32_t id, bool take);

  /// Renews the binding of `robot` if `source` is its last sender.
  void renew(std::uint32_t robot, const Endpoint& source, std::int64_t now) { robots_.renew(robot, source, now); }

  /// Encodes the CHALLENGE for an unproven packet of a robot, except LEAVE, from `who`.
  /// @return false if no challenge is due or the limit of challenges is reached
  bool challenge(const Packet& packet, const Endpoint& who, std::int64_t now, base::Bytes& out);

  /// Returns whether a V2V or SUBSCRIBE of `robot` was accepted less than two seconds before `now`, with no LEAVE
  /// since.
  bool is_active(std::uint32_t robot, std::int64_t now) const { return robots_.is_active(robot, now); }

  /// Returns whether `robot` is active and its last SUBSCRIBE since then includes sensor type `type` in [1, 63].
  /// Without a SUBSCRIBE it includes all types.
  bool is_subscribed(std::uint32_t robot, std::uint32_t type, std::int64_t now) const;

  /// Returns whether `robot` is active and its last SUBSCRIBE since then requests the states of other robots.
  bool wants_neighbours(std::uint32_t robot, std::int64_t now) const;

  /// Returns whether `robot` is active and its last SUBSCRIBE since then states that it follows DRIVE.
  bool follows_drive(std::uint32_t robot, std::int64_t now) const;

  /// Encodes the REFUSAL for a packet of a robot or light whose signature or source is refused, except LEAVE. It is
  /// unsigned and no larger than the packet. @return false if no refusal is due or the limit of refusals is reached
  bool refuse(const Packet& packet, PacketStatus reason, std::int64_t now, base::Bytes& out);
  /// Returns `SignatureChecker::lag` of the last checked packet with this claim.
  std::uint64_t lag(const Claim& claim) { return peers_.lag(claim); }

  /// Returns the address of `robot`; nullopt if it never sent a packet or has left. Its readings are sent to this
  /// address, to the port of each sensor.
  std::optional<Endpoint> address(std::uint32_t robot) const { return robots_.source(robot); }

  /// Returns the token that packets from `who` must carry.
  std::uint32_t token(const Endpoint& who) const { return tokens_.of(who); }
  /// Returns the farm's session and the robot's last session, for packets to `robot`.
  SessionToken session_token_for(std::uint32_t robot) const;
  /// Returns the signer of packets to `robot`; null if it has no key. Valid as long as the inbox.
  PacketSigner* signer(std::uint32_t robot) { return peers_.signer({PeerKind::robot, robot}); }
  PacketSigner* light_signer(std::uint32_t light) { return peers_.signer({PeerKind::light, light}); }

  /// Returns the address that sends the states of tag `tag` or switches its object.
  std::optional<Endpoint> tag_address(std::uint32_t tag) const { return tags_.source(tag); }
  std::optional<Endpoint> object_address(std::uint32_t tag) const { return objects_.source(tag); }
  /// Returns the address that sends the V2I of intersection `light`; nullopt if none was accepted in the last two
  /// seconds.
  std::optional<Endpoint> light_address(std::uint32_t light, std::int64_t now) const;
  /// Returns the address of the control centre; nullopt if no SUBSCRIBE of a permitted one was accepted in the last two
  /// seconds.
  std::optional<Endpoint> centre_address(std::int64_t now) const;
  SessionToken centre_session_token() const { return {session_, centre_session_}; }
  PacketSigner* centre_signer() { return peers_.signer({PeerKind::centre, 0}); }
  /// The same as `session_token_for`, for packets to that sender.
  SessionToken light_session_token(std::uint32_t light) const;

  std::uint16_t port() const { return bound_endpoint(socket_).port; }
  const PacketCounts& counts() const { return counts_; }
  std::uint64_t socket_drops() const { return netio::socket_drops(socket_); }
  /// Returns the same socket under a second descriptor, so that answers are sent from the port that robots send to.
  Socket socket() const { return duplicate(socket_); }
  std::uint32_t session() const { return session_; }  ///< session of the farm
  /// Sleeps until a datagram waits, a signal arrives, or `timeout_ms` >= 0 has passed.
  void wait(int timeout_ms) const;

 private:
  PacketStatus check(Packet& packet, std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now);
  PacketStatus check_id(const Header& header) const;
  bool is_notable(PacketStatus status, const Packet& packet);
  bool is_proven(const Header& header, const Endpoint& source) const;
  PacketStatus check_peer(const Header& header, std::span<const std::uint8_t> bytes, const Endpoint& source,
                          bool proven, std::int64_t now);
  void begin_period(std::int64_t now);
  PacketStatus admit(Packet& packet, const Endpoint& source, std::int64_t now);
  static PacketStatus admit_state(SenderBindings& bindings, Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus admit_driver(const Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus admit_own_readings(const Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus admit_light(const Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus admit_centre(const Packet& packet, const Endpoint& source, std::int64_t now);
  PacketStatus admit_robot(Packet& packet, const Endpoint& source, std::int64_t now);

  SenderBindings robots_;
  SenderBindings tags_;
  SenderBindings objects_;  ///< objects, bound by the id of their tag
  SenderBindings lights_;
  SenderBindings centres_;  ///< id 0 if the peers contain a control centre; otherwise none
  PeerTable peers_;
  std::vector<base::SensorTypes> types_;       ///< per robot row: mask of its last SUBSCRIBE, 0 for all
  std::vector<std::uint8_t> follows_drive_;    ///< per robot row: by its last SUBSCRIBE
  std::vector<std::uint32_t> sessions_;        ///< per robot row: of its last packet
  std::vector<std::uint32_t> light_sessions_;  ///< the same per row of lights
  std::uint32_t centre_session_ = 0;           ///< of the control centre's last packet
  std::uint32_t session_;
  bool lockstep_;
  AddressTokens tokens_;
  std::int64_t period_start_ = 0;            ///< [ns]
  std::array<std::size_t, 2> challenges_{};  ///< in that period, without and with a key
  std::size_t doubtful_signatures_ = 0;      ///< in that period
  std::size_t refusals_ = 0;                 ///< in that period
  PacketCounts counts_;
  Socket socket_;
  ReceiveBatch batch_;
};

}  // namespace sf::netio
