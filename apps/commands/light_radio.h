#pragma once
// Sends V2I to a farm, and receives the robots' states from it for the detectors of the lights.

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "netio/peers.h"
#include "netio/v2v_socket.h"
#include "server/v2i_messages.h"
#include "world/lights.h"
#include "world/world.h"

namespace sf::apps {

/// One sender per intersection, with its key in `peers`. The world must outlive it. Not thread-safe.
class LightRadio {
 public:
  /// @param farm "HOST:PORT" @param first as `server::intersections_of`
  /// @throws base::InputError if it has another form or the host is unknown
  LightRadio(const world::World& world, const world::RoadNetwork* roads, const std::string& farm,
             const std::vector<netio::Peer>& peers, std::uint32_t first = 1);

  /// Processes received packets. Calls `hear` with the position [m] of each robot state.
  void receive(std::int64_t now, const std::function<void(glm::dvec2)>& hear);
  /// @param forecasts one per row of `World::lights`
  void send(std::span<const world::SignalForecast> forecasts, std::int64_t now);

  /// Prints on standard error why the farm rejects the states: at once, then every ten seconds.
  void report_trouble(std::int64_t now);

  const std::string& to() const { return farm_; }
  /// "V2I to 127.0.0.1:9000: sent 12; received 30 states"
  std::string summary() const;

 private:
  std::string farm_;
  server::V2iMessages messages_;
  std::deque<netio::V2vSocket> sockets_;  ///< one per intersection; addresses must stay valid
  std::uint64_t heard_ = 0;               ///< number of states received
  bool answered_ = false;
  std::uint64_t troubles_ = 0;     ///< refused packets at the last report, all sockets together
  std::int64_t next_trouble_ = 0;  ///< [ns] earliest time of the next report
};

}  // namespace sf::apps
