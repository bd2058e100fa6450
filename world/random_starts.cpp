#include "world/random_starts.h"

#include "base/random.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kStartDraw = 0x72616E64;

}  // namespace

void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t row) {
  mover.X_WM = X_WM;
  if (!mover.random_start.any()) return;
  const base::RandomKey key{.seed = seed, .stream = base::RandomStream::placement, .a = row, .b = kStartDraw};
  const auto [x, y] = base::random_uniform(key, 0);
  const auto [yaw, presence] = base::random_uniform(key, 1);
  const glm::dvec3& spread = mover.random_start.spread;
  mover.X_WM.x += spread.x * (2.0 * x - 1.0);
  mover.X_WM.y += spread.y * (2.0 * y - 1.0);
  mover.X_WM.yaw += spread.z * (2.0 * yaw - 1.0);
  mover.absent = presence >= mover.random_start.presence;
}

void draw_starts(World& world, std::uint64_t seed) {
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    draw_start(world.movers[row], world.movers[row].X_WM, seed, row);
}

}  // namespace sf::world
