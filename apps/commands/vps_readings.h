#pragma once
// Draws the robots' sensor readings and maps over the images of the cameras that see them (`vps --readings`).

#include <span>
#include <string>
#include <vector>

#include "netio/socket.h"
#include "sensors/sensor_set.h"
#include "server/mirrored_readings.h"
#include "vision/overlay.h"
#include "vision/testbed.h"
#include "vision/tracker.h"
#include "world/world.h"

namespace sf::apps {

class SeenReadings {
 public:
  /// @param bind where the farm sends copies (`serve --mirror`) @param testbed must outlive this
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound or the world cannot be read
  SeenReadings(const std::string& world_file, const netio::Endpoint& bind, const vision::Testbed& testbed);

  const world::World& world() const { return world_; }
  /// Processes received packets, and returns the lines of all maps, and of the readings of robots whose tags
  /// were seen. Valid until the next call.
  std::span<const vision::PlaneLine> lines(std::span<const vision::TrackedTag> tags);

 private:
  /// Returns the row of the tag's mover: the linked object `tagN`, or the robot that carries the tag.
  std::optional<std::uint32_t> mover_of(std::uint32_t tag) const;

  const vision::Testbed& testbed_;
  world::World world_;
  sensors::SensorSet sensor_set_;
  server::MirroredReadings readings_;
  netio::Socket socket_;
  netio::ReceiveBatch batch_{64};
  std::vector<server::SightLine> sights_;
  std::vector<vision::PlaneLine> lines_;
};

}  // namespace sf::apps
