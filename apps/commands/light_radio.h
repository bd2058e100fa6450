#pragma once
// V2I to a farm, and states of robots from it, as detectors of lights hear them.

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

/// One sender for each intersection, with the key that `peers` has for it. The world must outlive it. One thread.
class LightRadio {
 public:
  /// @param farm "HOST:PORT"
  /// @throws base::InputError for another form, and an unknown host
  LightRadio(const world::World& world, const world::RoadNetwork* roads, const std::string& farm,
             const std::vector<netio::Peer>& peers);

  /// Takes what came: `hear` is given the place [m] of each state of a robot.
  void receive(std::int64_t now, const std::function<void(glm::dvec2)>& hear);
  /// @param forecasts one per row of `World::lights`
  void send(std::span<const world::SignalForecast> forecasts, std::int64_t now);

  /// States on standard error why the farm does not take the states, at once and then every ten seconds.
  void report_trouble(std::int64_t now);

  const std::string& to() const { return farm_; }
  /// "V2I to 127.0.0.1:9000: sent 12; heard 30 states"
  std::string summary() const;

 private:
  std::string farm_;
  server::V2iMessages messages_;
  std::deque<netio::V2vSocket> sockets_;  ///< per intersection; they do not move
  std::uint64_t heard_ = 0;               ///< states
  bool answered_ = false;
  std::uint64_t troubles_ = 0;     ///< refused packets that came before, of all
  std::int64_t next_trouble_ = 0;  ///< [ns] not stated before
};

}  // namespace sf::apps
