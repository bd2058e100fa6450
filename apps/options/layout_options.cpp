#include "apps/options/layout_options.h"
#include "apps/reports/text.h"

namespace sf::apps {

server::StreamLayout stream_layout_of(const world::World& world, const sensors::SensorSet& sensor_set,
                                      const PortOptions& options) {
  server::StreamLayout layout =
      server::stream_layout(world, sensor_set, {options.base_ports, options.ports_per_robot, options.wire});
  for (const std::string& note : layout.notes) print_message(note);
  return layout;
}

}  // namespace sf::apps
