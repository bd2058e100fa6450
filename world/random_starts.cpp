#include "world/random_starts.h"

#include <algorithm>
#include <vector>

#include "base/random.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kStartDraw = 0x72616E64;
constexpr std::uint32_t kFirstRobot = 1u << 31;

}  // namespace

void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t number) {
  mover.X_WM = X_WM;
  if (!mover.random_start.any()) return;
  const base::RandomKey key{.seed = seed, .stream = base::RandomStream::placement, .a = number, .b = kStartDraw};
  const auto [x, y] = base::random_uniform(key, 0);
  const auto [yaw, presence] = base::random_uniform(key, 1);
  const glm::dvec3& spread = mover.random_start.spread;
  mover.X_WM.x += spread.x * (2.0 * x - 1.0);
  mover.X_WM.y += spread.y * (2.0 * y - 1.0);
  mover.X_WM.yaw += spread.z * (2.0 * yaw - 1.0);
  mover.absent = presence >= mover.random_start.presence;
}

void draw_starts(std::span<Mover> movers, std::span<const Pose> X_WM, std::uint64_t seed, bool robots) {
  std::uint32_t numbers[] = {0, kFirstRobot};
  for (std::size_t row = 0; row < movers.size(); ++row) {
    Mover& mover = movers[row];
    mover.X_WM = X_WM[row];
    if (mover.random_start.any() && (robots || mover.is_tag))
      draw_start(mover, X_WM[row], seed, numbers[mover.is_tag ? 0 : 1]++);
  }
}

void draw_starts(World& world, std::uint64_t seed, bool robots) {
  const auto is_random = [](const Mover& mover) { return mover.random_start.any(); };
  if (std::ranges::none_of(world.movers, is_random)) return;
  std::vector<Pose> X_WM;
  for (const Mover& mover : world.movers) X_WM.push_back(mover.X_WM);
  draw_starts(world.movers, X_WM, seed, robots);
  update_extent_and_hash(world);
}

}  // namespace sf::world
