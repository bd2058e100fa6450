#include "world/random_starts.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/random.h"
#include "world/ground.h"
#include "world/shapes.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kStartDraw = 0x72616E64;
constexpr std::uint32_t kFirstRobot = 1u << 31;

/// Indices of draws.
enum Draw : std::uint32_t { kPosition, kYawAndPresence, kSize, kHeight, kMotion, kNoise };

base::RandomKey key_of(std::uint64_t seed, std::uint32_t number) {
  return {.seed = seed, .stream = base::RandomStream::placement, .a = number, .b = kStartDraw};
}

const Mover& mover_of(const Mover& mover) { return mover; }
const Mover& mover_of(const Original& original) { return original.mover; }

/// Calls `visit(row, number)` for the movers that have random starts or variations.
template <class Row, class Visit>
void for_random(std::span<Row> rows, Visit&& visit) {
  std::uint32_t numbers[] = {0, kFirstRobot};
  for (std::uint32_t row = 0; row < rows.size(); ++row) {
    const Mover& mover = mover_of(rows[row]);
    if (mover.random_start.any()) visit(row, numbers[mover.is_tag ? 0 : 1]++);
  }
}

}  // namespace

std::vector<Original> originals_of(const World& world) {
  std::vector<Original> originals;
  for (const Mover& mover : world.movers) originals.push_back({mover, size_of(world, mover)});
  return originals;
}

void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t number) {
  mover.X_WM = X_WM;
  if (!mover.random_start.places()) return;
  const base::RandomKey key = key_of(seed, number);
  const auto [x, y] = base::random_uniform(key, kPosition);
  const auto [yaw, presence] = base::random_uniform(key, kYawAndPresence);
  const glm::dvec3& spread = mover.random_start.spread;
  mover.X_WM.x += spread.x * (2.0 * x - 1.0);
  mover.X_WM.y += spread.y * (2.0 * y - 1.0);
  mover.X_WM.yaw += spread.z * (2.0 * yaw - 1.0);
  mover.absent = presence >= mover.random_start.presence;
}

glm::dvec3 draw_size(const RandomStart& random, const glm::dvec3& size, std::uint64_t seed, std::uint32_t number) {
  const base::RandomKey key = key_of(seed, number);
  const auto [x, y] = base::random_uniform(key, kSize);
  const double z = base::random_uniform(key, kHeight)[0];
  return size + random.size_spread * (2.0 * glm::dvec3{x, y, z} - 1.0);
}

Variation draw_variation(const RandomStart& random, std::uint64_t seed, std::uint32_t number) {
  const base::RandomKey key = key_of(seed, number);
  const auto [slip, acceleration] = base::random_uniform(key, kMotion);
  const double noise = base::random_uniform(key, kNoise)[0];
  return {random.slip * slip, 1.0 - random.acceleration * acceleration, 1.0 - random.noise * noise};
}

void set_size(World& world, std::uint32_t mover, const Original& original, const glm::dvec3& size) {
  resize(world.movers[mover], original.mover, original.size, size);
  if (world.copies == 1) world.models[original.mover.model].size = {size.x, size.y};
}

void draw_poses(World& world, std::uint32_t first, std::span<const Original> originals, std::uint64_t seed,
                bool robots) {
  const std::span<Mover> movers = std::span(world.movers).subspan(first, originals.size());
  for (std::size_t row = 0; row < movers.size(); ++row) {
    movers[row].X_WM = originals[row].mover.X_WM;
    movers[row].absent = originals[row].mover.absent;
  }
  std::optional<Ground> ground;  // made only for movers that move
  for_random(originals, [&](std::uint32_t row, std::uint32_t number) {
    if (!robots && !movers[row].is_tag) return;
    const Mover& original = originals[row].mover;
    draw_start(movers[row], original.X_WM, seed, number);
    if (!original.random_start.places()) return;
    if (!ground) ground.emplace(world.ramps, world.terrain);
    movers[row].X_WM = ground->stand(original.X_WM, movers[row].X_WM);
  });
}

std::vector<glm::dvec3> draw_sizes(std::span<const Original> originals, std::uint64_t seed) {
  std::vector<glm::dvec3> sizes;
  for (const Original& original : originals) sizes.push_back(original.size);
  for_random(originals, [&](std::uint32_t row, std::uint32_t number) {
    const RandomStart& random = originals[row].mover.random_start;
    if (random.size_spread != glm::dvec3{}) sizes[row] = draw_size(random, sizes[row], seed, number);
  });
  return sizes;
}

void draw_starts(World& world, std::uint64_t seed, bool robots) {
  const auto is_random = [](const Mover& mover) { return mover.random_start.any(); };
  if (std::ranges::none_of(world.movers, is_random)) return;
  const std::vector<Original> originals = originals_of(world);
  draw_poses(world, 0, originals, seed, robots);
  const std::vector<glm::dvec3> sizes = draw_sizes(originals, seed);
  for (std::uint32_t row = 0; row < sizes.size(); ++row)
    if (sizes[row] != originals[row].size) set_size(world, row, originals[row], sizes[row]);
  update_extent_and_hash(world);
}

void draw_variations(World& world, std::uint32_t first, std::size_t count, std::uint64_t seed) {
  const std::span<const Mover> movers = std::span(world.movers).subspan(first, count);
  std::fill_n(world.variations.begin() + std::min<std::ptrdiff_t>(first, std::ssize(world.variations)),
              world.variations.empty() ? 0 : count, Variation{});
  for_random(movers, [&](std::uint32_t row, std::uint32_t number) {
    if (!movers[row].random_start.varies()) return;
    world.variations.resize(world.movers.size());
    world.variations[first + row] = draw_variation(movers[row].random_start, seed, number);
  });
}

void draw_variations(World& world, std::uint64_t seed) {
  draw_variations(world, 0, world.movers.size(), seed);
  if (!world.variations.empty()) update_extent_and_hash(world);
}

}  // namespace sf::world
