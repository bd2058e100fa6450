#pragma once
// Reports peers whose signatures the farm refuses (another key, no signature, or a clock that is behind), peers whose
// signatures it has no key for, and peers at an unexpected address.

#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/rate_limited_log.h"
#include "netio/v2v_socket.h"

namespace sf::netio {

/// Returns what the sender's user has to change, as the continuation of "the farm at 127.0.0.1:9000 ".
/// @param who "robot 7"  @param unix_time [ns] of this machine's clock
std::string trouble_text(const SignatureTrouble& trouble, const std::string& who, std::int64_t unix_time);

/// Single-threaded.
class SignatureTroubleLog {
 public:
  /// Logs the first packet of a peer and reason, then the number of packets every ten seconds while more arrive, and
  /// answers the packet.
  /// @param reason not_signed, wrong_signature, replayed or wrong_source; others: the packet is `unchecked`
  /// @param name of the mover or light, in messages; may be empty
  /// @param now [ns] of the inbox' clock
  void note(PacketStatus reason, const Packet& packet, const Endpoint& who, const std::string& name, std::int64_t now,
            Inbox& inbox, Outbox& answers, RateLimitedLog& log);
  /// Answers a robot or light with a REFUSAL, at most twice a second.
  void answer(PacketStatus reason, const Packet& packet, const Endpoint& who, std::int64_t now, Inbox& inbox,
              Outbox& answers);

 private:
  struct Row {
    RepeatedEvent packets;
    std::int64_t next_answer = 0;  ///< [ns]
  };
  std::map<std::tuple<PeerKind, std::uint32_t, PacketStatus>, Row>
      rows_;  ///< ids of the world only, so their number is bounded
  base::Bytes answer_;
};

}  // namespace sf::netio
