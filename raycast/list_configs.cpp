#include "raycast/list_configs.h"

#include <algorithm>

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

ListConfigs::ListConfigs(const world::World& world) : walls_(world.walls), breaks_(height_breaks(walls_)) {}

std::uint32_t ListConfigs::add(const ListConfig& config) {
  const auto interval =
      static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), config.z) - breaks_.begin());
  auto& wall_index = wall_indices_[interval];
  if (!wall_index) wall_index = std::make_unique<WallIndex>(walls_, config.z);
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    ListConfig& known = rows_[i].config;
    if (rows_[i].wall_index != wall_index.get() || known.range != config.range || known.z != config.z) continue;
    known.spread = std::max(known.spread, config.spread);
    known.fov = std::max(known.fov, config.fov);
    return i;
  }
  rows_.push_back({config, wall_index.get()});
  return static_cast<std::uint32_t>(rows_.size() - 1);
}

}  // namespace sf::raycast
