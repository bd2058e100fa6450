#pragma once
// A Player server (playerstage.sourceforge.net): programs written for a Create, a Pioneer or Stage read virtual sensors
// and drive robots (docs/bridges.md).

#include "bridges/bridge.h"
#include "bridges/player/server.h"
#include "netio/endpoint.h"

namespace sf::bridges {

/// `publish` copies the readings of opened devices.
class PlayerBridge : public Bridge {
 public:
  /// @param bind, silent, log_descriptor, follows see player::Server
  /// @throws base::InputError if a port is in use
  PlayerBridge(const Scene& scene, const netio::Endpoint& bind, double silent = player::kSilent, int log_descriptor = 2,
               const player::Follows& follows = {});

  void publish(const base::TickRecord& tick, const RunState& state) override;
  void publish(const RunState& state) override;
  void take(Requests& requests) override;
  std::string describe() const override;

  netio::Endpoint endpoint() const { return server_.endpoint(); }
  player::ServerCounts counts() const { return server_.counts(); }

 private:
  player::Devices devices_;
  player::Exchange exchange_;
  player::Server server_;
};

}  // namespace sf::bridges
