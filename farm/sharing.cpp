#include "farm/sharing.h"

namespace sf::farm {

Sharing::Sharing(const sensors::SensorSet& sensor_set, std::size_t movers)
    : measures_(movers, 1),
      delivers_(movers, 1),
      hidden_(movers, 0),
      types_(movers, 0),
      measured_types_(movers, 0),
      delivered_types_(movers, 0),
      hashes_(sensor_set) {}

void Sharing::leave_to_others(std::uint32_t mover) {
  delivers_.at(mover) = 0;
  set_measured_here(mover, false);
}

void Sharing::set_measured_here(std::uint32_t mover, bool here) {
  measures_.at(mover) = here ? 1 : 0;
  subscribe(mover, types_[mover]);
}

void Sharing::subscribe(std::uint32_t mover, base::SensorTypes types) {
  types_.at(mover) = types;
  measured_types_[mover] = measures_[mover] != 0 ? types : 0;
  delivered_types_[mover] = delivers_[mover] != 0 ? types : 0;
}

void Sharing::add_mover(const sensors::SensorSet& sensor_set) {
  for (auto* const types : {&types_, &measured_types_, &delivered_types_}) types->push_back(0);
  for (auto* const flags : {&measures_, &delivers_}) flags->push_back(1);
  hidden_.push_back(0);
  hashes_.add_sensors(sensor_set);
}

}  // namespace sf::farm
