#include "raycast/families.h"

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

Families::Families(const world::World& world) : walls_(world.walls), breaks_(height_breaks(walls_)) {}

std::uint32_t Families::add(const Family& family) {
  const auto interval =
      static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), family.z) - breaks_.begin());
  auto& sight = sights_[interval];
  if (!sight) {
    world::World view;
    view.walls = walls_;
    sight = std::make_unique<Sight>(view, family.z, family.range);
  }
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    Family& known = rows_[i].family;
    if (rows_[i].sight != sight.get() || known.range != family.range || known.z != family.z) continue;
    known.spread = std::max(known.spread, family.spread);
    known.fov = std::max(known.fov, family.fov);
    return i;
  }
  rows_.push_back({family, sight.get()});
  return static_cast<std::uint32_t>(rows_.size() - 1);
}

}  // namespace sf::raycast
