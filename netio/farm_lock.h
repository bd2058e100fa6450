#pragma once
// Selects one farm for a receiver that sends nothing and therefore has no session with the farm.

#include <cstdint>
#include <optional>

#include "netio/endpoint.h"
#include "netio/sender_bindings.h"

namespace sf::netio {

/// Selects the first sender of a valid packet until it is silent for two seconds (kSenderTimeout), so that packets of
/// two farms, or of a farm and a forger, are not mixed. Reads no clock.
class FarmLock {
 public:
  /// @param host the only accepted address; 0: any
  explicit FarmLock(std::uint32_t host = 0) : host_(host) {}

  /// Returns false if packets from this address are never accepted.
  bool allows(const Endpoint& source) const { return host_ == 0 || source.address == host_; }
  /// Returns true if a valid packet from `source` at `now` [ns] with this session is accepted.
  /// @param session 0 for packets without a session
  bool admit(const Endpoint& source, std::uint32_t session, std::int64_t now) {
    const bool same = source_ == source && session_ == session;
    if (!allows(source) || (last_ && now - *last_ < kSenderTimeout && !same)) return false;
    changes_ += last_ && !same;
    source_ = source;
    session_ = session;
    last_ = now;
    return true;
  }
  std::uint64_t changes() const { return changes_; }  ///< number of changes from one farm to another

 private:
  std::uint32_t host_;
  Endpoint source_;
  std::uint32_t session_ = 0;
  std::optional<std::int64_t> last_;  ///< [ns]
  std::uint64_t changes_ = 0;
};

}  // namespace sf::netio
