#pragma once
// Robots outside of the known space of a ROS map, where walls are missing.

#include <optional>
#include <string>
#include <vector>

#include "base/tick_record.h"
#include "world/ros_map.h"

namespace sf::apps {

class StrayedRobots final : public base::Sink {
 public:
  /// @param world must outlive it
  explicit StrayedRobots(const world::World& world);

  /// Updates the set of robots whose origin is outside. Reports the first on standard error.
  void write(const base::TickRecord& tick) override;
  /// Returns all robots that have been outside so far, in file order; nullopt: the world has no ROS map.
  std::optional<std::vector<std::string>> names() const;

 private:
  const world::World& world_;
  world::KnownSpace known_;
  std::vector<bool> outside_;  ///< per mover: true if it has ever been outside
};

}  // namespace sf::apps
