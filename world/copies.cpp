#include "world/copies.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace sf::world {

void copy_movers(World& world, std::uint32_t count) {
  SF_CHECK(world.copies == 1, "copies of copies");
  if (count == 0 || count > kMostCopies)
    throw base::InputError(fmt::format("{} worlds requested; expected from 1 to {}", count, kMostCopies));
  const std::size_t movers = world.movers.size();
  if (movers * count > kMostCopiedMovers)
    throw base::InputError(world.file, 0,
                           fmt::format("{} worlds of {} robots and tags are more than {} movers; expected fewer worlds",
                                       count, movers, kMostCopiedMovers));
  const auto magnetic = std::ranges::find_if(world.movers, [](const Mover& mover) { return !mover.magnets.empty(); });
  if (count > 1 && magnetic != world.movers.end())
    throw base::InputError(world.file, 0,
                           fmt::format("'{}' carries magnets, whose field would reach the other worlds; expected "
                                       "magnets on the floor, or one world",
                                       magnetic->name));
  world.movers.reserve(movers * count);
  for (std::uint32_t copy = 1; copy < count; ++copy)
    for (std::size_t row = 0; row < movers; ++row) world.movers.push_back(world.movers[row]);
  world.copies = movers == 0 ? 1 : count;
}

}  // namespace sf::world
