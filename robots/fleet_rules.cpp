#include "robots/fleet_rules.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/report.h"

namespace sf::robots {

std::vector<std::uint32_t> ranks_of(const world::World& world) {
  std::vector<std::uint32_t> order(world.movers.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) {
    const world::Mover &a = world.movers[p], &b = world.movers[q];
    return std::tuple(a.is_tag, a.id, p) < std::tuple(b.is_tag, b.id, q);
  });
  std::vector<std::uint32_t> ranks(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) ranks[order[k]] = k;
  return ranks;
}

int halvings_to_gap(double step) {
  constexpr double kGap = 4e-4;  // [m] largest gap between a stopped mover and the obstacle
  int count = 0;
  for (; step > kGap; step *= 0.5) ++count;
  return count;
}

glm::dvec2 contact_border(std::uint32_t k) {
  return base::direction(2.0 * M_PI * (k % base::kContactSectors) / base::kContactSectors);
}

}  // namespace sf::robots
