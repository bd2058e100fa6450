#include "bridges/player_bridge.h"

#include <fmt/format.h>

namespace sf::bridges {

PlayerBridge::PlayerBridge(const Scene& scene, const netio::Endpoint& bind, double silent, int log_descriptor,
                           const player::Follows& follows)
    : devices_(scene.world, scene.sensor_set),
      exchange_(scene, devices_),
      server_(scene, devices_, exchange_, bind, silent, log_descriptor, follows) {}

void PlayerBridge::publish(const base::TickRecord& tick, const RunState& state) {
  exchange_.publish(tick, state);
  server_.wake();
}

void PlayerBridge::publish(const RunState& state) { exchange_.publish(state); }

void PlayerBridge::take(Requests& requests) { exchange_.take(requests); }

std::string PlayerBridge::describe() const {
  const netio::Endpoint first = endpoint();
  std::string line = fmt::format("Player server on {}", netio::endpoint_text(first));
  if (server_.ports() == 2) line += fmt::format(" for all robots, port {} for robot 2 alone", first.port + 1);
  if (server_.ports() > 2)
    line += fmt::format(" for all robots, ports {1} to {2} for robots 2 to {0} alone", server_.ports(), first.port + 1,
                        first.port + server_.ports() - 1);
  return line;
}

}  // namespace sf::bridges
