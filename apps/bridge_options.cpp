#include "apps/bridge_options.h"

#include "apps/text.h"

namespace sf::apps {

LiveBridges::LiveBridges(const BridgeOptions& options, const world::World& world, const sensors::SensorSet& sensor_set,
                         const scenarios::RunSettings& settings, bool simulated) {
  if (!options.any()) return;
  info_ = scenarios::run_info(world, sensor_set, settings);
  record::name_frames(info_);
  [[maybe_unused]] const bridges::Scene scene{world, sensor_set, info_, simulated};
  for (const std::string& line : bridges_.describe()) print_message("{}", line);
}

void LiveBridges::write(const base::TickRecord& record) { bridges_.publish(record, {}); }

}  // namespace sf::apps
