#pragma once
// Sends a simulated robot's true state to renderers of camera images (`sensorfarm vps --robots`).

#include <cstdint>

#include "base/report.h"
#include "netio/outbox.h"
#include "netio/packets.h"

namespace sf::server {

/// Returns the V2V of a state, clamped to the range of a packet, whatever the world file permits.
netio::V2v v2v_of(const base::Report& report, const base::Intent& intent = {});

/// Not thread-safe.
class TruthReport {
 public:
  static constexpr std::int64_t kPeriod = 20'000'000;  ///< [ns] between two due reports

  /// @throws base::InputError if no socket can be opened
  TruthReport(const netio::Endpoint& to, std::uint32_t tag);

  bool is_due(std::int64_t now) const { return now >= due_; }
  std::int64_t due() const { return due_; }  ///< [ns]
  /// @param epoch [ns] Unix time at time 0
  void send(const base::Report& state, std::int64_t now, std::int64_t epoch);

 private:
  netio::Endpoint to_;
  netio::Header header_;
  netio::Outbox outbox_;
  base::Bytes packet_;
  std::int64_t due_ = 0;
};

}  // namespace sf::server
