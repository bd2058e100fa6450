#pragma once
// Pictures of the maps that the robots of a run build while they drive: a file that is replaced, and a page in the
// browser. A map is the one that a robot's controller keeps, else one of its laser's scans at the poses it drives by.
// The maps of several robots are also merged into one.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands/live_map.h"
#include "base/tick_record.h"
#include "scenarios/simulation.h"
#include "server/own_map.h"

namespace sf::apps {

class RunMaps {
 public:
  static constexpr std::size_t kMostRobots = 32;  ///< bounds memory and time

  /// World and simulation must outlive it.
  /// @param file picture of the map, merged if there are several; empty: none @param view of the page; nullopt: none
  /// @throws base::InputError if no robot or too many robots build maps, or if their maps cannot be merged
  RunMaps(const world::World& world, const scenarios::Simulation& simulation, const std::string& file,
          const std::optional<bridges::WebAddress>& view);

  /// Adds the scans, and passes the maps on to be drawn if the last pictures are old enough.
  void write(const base::TickRecord& tick);
  /// Draws the last maps. @throws base::InputError if the file could not be written
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct RobotMap {
    std::uint32_t mover = 0;
    std::unique_ptr<server::OwnMap> scans;  ///< null: its controller keeps the map
    base::Pose X_WM;                        ///< its own estimate, of the last tick
    bool lost = false;                      ///< it has no estimate yet
  };

  maps::OccupancyGrid grid_of(const RobotMap& robot) const;
  std::vector<viz::PoseMarker> place_of(const RobotMap& robot) const;
  void show();

  const world::World& world_;
  const scenarios::Simulation& simulation_;
  std::string file_;
  bool page_;
  std::vector<RobotMap> robots_;  ///< in the order of rows
  Clock::time_point next_{};
  std::optional<LiveMap> live_;
};

}  // namespace sf::apps
