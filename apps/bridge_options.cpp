#include "apps/bridge_options.h"

#include "apps/address.h"
#include "apps/exposure_warning.h"
#include "apps/text.h"
#include "netio/bridges/player_bridge.h"
#include "netio/bridges/ros2_bridge.h"
#include "netio/bridges/viewer.h"

namespace sf::apps {

LiveBridges::LiveBridges(const BridgeOptions& options, const world::World& world, const sensors::SensorSet& sensor_set,
                         const scenarios::RunSettings& settings, bool simulated) {
  if (!options.any()) return;
  info_ = scenarios::run_info(world, sensor_set, settings);
  record::name_frames(info_);
  const bridges::Scene scene{world, sensor_set, info_, simulated};
  if (options.ros2) bridges_.add(std::make_unique<bridges::Ros2Bridge>(bridges::ros2_options(*options.ros2), scene));
  if (!options.player.empty()) {
    const netio::Endpoint bind = read_own_address(options.player, "--player");
    bridges_.add(std::make_unique<bridges::PlayerBridge>(scene, bind));
    warn_of_exposure(bind.address, simulated ? "read sensors and drive robots" : "read sensors",
                     "Player has no passwords", "--player");
  }
  if (options.view) {
    const bridges::ViewerOptions view{*options.view,
                                      simulated ? bridges::ViewerMode::run : bridges::ViewerMode::service};
    bridges_.add(std::make_unique<bridges::Viewer>(scene, view));
  }
  for (const std::string& line : bridges_.describe()) print_message("{}", line);
}

void LiveBridges::write(const base::TickRecord& record) {
  bridges_.take(ignored_);  // questions are answered, while nothing is changed
  bridges_.publish(record, {});
}

}  // namespace sf::apps
