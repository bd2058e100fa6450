#include "raycast/list_configs.h"

#include <algorithm>
#include <cmath>

namespace sf::raycast {

namespace {

std::vector<double> height_breaks(const std::vector<world::Segment>& walls) {
  std::vector<double> breaks;
  for (const world::Segment& s : walls) {
    breaks.push_back(s.z_min);
    breaks.push_back(s.z_max);
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

}  // namespace

ListConfigs::ListConfigs(const world::World& world)
    : walls_(world.walls), breaks_(height_breaks(walls_)), wall_index_(walls_) {}

std::uint32_t ListConfigs::add(const ListConfig& config) {
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    ListConfig& known = rows_[i];
    if (known.range != config.range || known.z != config.z) continue;
    known.spread = std::max(known.spread, config.spread);
    known.fov = std::max(known.fov, config.fov);
    return i;
  }
  rows_.push_back(config);
  return static_cast<std::uint32_t>(rows_.size() - 1);
}

std::uint32_t ListConfigs::level_of(double z) const {
  return static_cast<std::uint32_t>(std::upper_bound(breaks_.begin(), breaks_.end(), z) - breaks_.begin());
}

double ListConfigs::z_of(std::int64_t level) const {
  return level == 0 ? -HUGE_VAL : breaks_[static_cast<std::size_t>(level - 1)];
}

}  // namespace sf::raycast
