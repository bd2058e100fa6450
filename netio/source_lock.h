#pragma once
// The farm of a receiver that sends nothing itself, and so is never challenged by one.

#include <cstdint>
#include <optional>

#include "netio/client_registry.h"
#include "netio/endpoint.h"

namespace sf::netio {

/// The first sender of a good packet, until it is silent for two seconds (kClientTimeout): two farms, or a farm and its
/// forger, are never mixed. No clock is read.
class SourceLock {
 public:
  /// @param host the only address that counts; 0: any
  explicit SourceLock(std::uint32_t host = 0) : host_(host) {}

  /// False: packets from there never count.
  bool allows(const Endpoint& source) const { return host_ == 0 || source.address == host_; }
  /// Whether something good counts that came from `source` at `now` [ns], with its session (0 where packets have none).
  bool admit(const Endpoint& source, std::uint32_t session, std::int64_t now) {
    const bool same = source_ == source && session_ == session;
    if (!allows(source) || (last_ && now - *last_ < kClientTimeout && !same)) return false;
    changes_ += last_ && !same;
    source_ = source;
    session_ = session;
    last_ = now;
    return true;
  }
  std::uint64_t changes() const { return changes_; }  ///< from one farm to another

 private:
  std::uint32_t host_;
  Endpoint source_;
  std::uint32_t session_ = 0;
  std::optional<std::int64_t> last_;  ///< [ns]
  std::uint64_t changes_ = 0;
};

}  // namespace sf::netio
