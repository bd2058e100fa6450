#pragma once
// Sends TAG packets for tracked tags.

#include <map>
#include <optional>
#include <span>
#include <string>

#include "netio/outbox.h"
#include "netio/packets.h"
#include "netio/peers.h"
#include "vision/testbed.h"
#include "vision/tracker.h"

namespace sf::apps {

/// Returns the state of the object that carries the tag, in the world frame.
netio::Tag object_state(const vision::TrackedTag& tag, const vision::TagMount& mount);

/// Sends one datagram per tag: to the address in the tag's section of the testbed file, otherwise to the file's
/// address, otherwise to `fallback`. Skips tags without an address and id 0, which is not valid in packets.
class TagSender {
 public:
  /// @param fallback "host:port" or empty
  /// @param peers packets of tags with a key in it are signed
  /// @throws base::InputError for malformed addresses and unknown hosts
  TagSender(const vision::Testbed& testbed, const std::string& fallback, std::span<const netio::Peer> peers);

  /// @param epoch [ns] time of packets at time 0 of the tags
  void send(std::span<const vision::TrackedTag> tags, std::int64_t epoch);

  bool has_addresses() const { return fallback_ || !addresses_.empty(); }
  std::uint64_t unaddressed() const { return unaddressed_; }
  netio::OutboxCounts counts() const { return outbox_.counts(); }

 private:
  const vision::Testbed& testbed_;
  std::optional<netio::Endpoint> fallback_;
  std::map<std::uint32_t, netio::Endpoint> addresses_;
  std::map<std::uint32_t, std::uint32_t> sequences_;
  std::map<std::uint32_t, netio::PacketSigner> signers_;
  netio::Header header_;
  netio::Outbox outbox_;
  base::Bytes packet_;
  std::uint64_t unaddressed_ = 0;
};

}  // namespace sf::apps
