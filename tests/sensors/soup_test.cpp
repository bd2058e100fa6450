// Random polygon soups from random viewpoints: outlines overlap, touch, and share vertices and edges.

#include <gtest/gtest.h>

#include "tests/instrumented.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const int kBowls = instrumented() ? 4 : 24;
constexpr double kBowl = 6.0;        ///< [m] half the side of the room around each soup
constexpr double kSoupRange = 18.0;  ///< [m] more than its diagonal
constexpr double kApart = 64.0;      ///< [m] distance that makes soups invisible to each other

std::vector<glm::dvec2> star(Chance& chance) {
  const std::uint32_t corners = 3 + chance.below(7);
  std::vector<glm::dvec2> outline;
  for (std::uint32_t i = 0; i < corners; ++i)
    outline.push_back(base::rotate(2.0 * M_PI * i / corners, {chance.between(0.05, 1.5), 0.0}));
  return outline;
}

/// Rounds to a coarse lattice, so that outlines meet exactly.
glm::dvec2 snap(glm::dvec2 p) { return {std::round(4.0 * p.x) / 4.0, std::round(4.0 * p.y) / 4.0}; }

std::vector<glm::dvec2> ingredient(const std::vector<std::vector<glm::dvec2>>& soup, Chance& chance) {
  const std::uint32_t what = soup.empty() ? 0 : chance.below(6);
  std::vector<glm::dvec2> outline = star(chance);
  const glm::dvec2 at = chance.in_square(kBowl - 2.0);
  if (what == 1) {  // a box on the lattice
    const glm::dvec2 p = snap(at);
    const double w = 0.25 * (1 + chance.below(6));
    const double h = 0.25 * (1 + chance.below(6));
    return {p, p + glm::dvec2{w, 0}, p + glm::dvec2{w, h}, p + glm::dvec2{0, h}};
  }
  const std::vector<glm::dvec2>& other =
      soup.empty() ? outline : soup[chance.below(static_cast<std::uint32_t>(soup.size()))];
  if (what == 2) return other;                                         // a duplicate
  if (what == 3) return {other[0], other[0] + chance.in_square(1.0)};  // a thin wall from a corner
  const std::uint32_t corner = chance.below(static_cast<std::uint32_t>(outline.size()));
  const glm::dvec2 target = what == 4 ? other[chance.below(static_cast<std::uint32_t>(other.size()))] : at;
  const glm::dvec2 shift = target - outline[corner];
  for (glm::dvec2& p : outline) p = p + shift;
  outline[corner] = target;  // exactly at a shared vertex
  return outline;
}

/// Adds one soup in its room around `centre`, with eyes in it: at random and aimed at vertices.
void cook(world::World& world, glm::dvec2 centre, std::uint64_t seed) {
  Chance chance(seed);
  std::vector<std::vector<glm::dvec2>> soup;
  const std::uint32_t count = 4 + chance.below(20);
  while (soup.size() < count) soup.push_back(ingredient(soup, chance));
  std::vector<glm::dvec2> corners;
  for (const std::vector<glm::dvec2>& outline : soup) {
    std::vector<glm::dvec2> moved;
    for (const glm::dvec2& p : outline) moved.push_back(centre + p);
    const std::size_t first = world.walls.size();
    scenes::add_outline(world, moved, "soup" + std::to_string(world.models.size()));
    if (moved.size() == 2) world.walls.pop_back();
    for (std::size_t i = first; i < world.walls.size() && moved.size() == 2; ++i) world.walls[i].solid_left = false;
    corners.insert(corners.end(), moved.begin(), moved.end());
  }
  scenes::add_room(world, centre, 2.0 * kBowl);
  for (int i = 0; i < 20; ++i) {
    const glm::dvec2 p = centre + chance.in_square(0.99 * kBowl);
    add_eye(world, {p.x, p.y, 0.0, chance.between(-M_PI, M_PI)}, eye(91, 2.0 * M_PI, kSoupRange));
    for (int k = 0; k < 8; ++k) {
      const glm::dvec2 corner = corners[chance.below(static_cast<std::uint32_t>(corners.size()))];
      const glm::dvec2 from = k < 6 ? p : snap(p);
      if (from.x != corner.x || from.y != corner.y)
        aim(world, from, corner, eye(k % 2 ? 1 : 5, k % 2 ? 0.0 : 1e-8, kSoupRange));
    }
  }
}

void taste(std::uint64_t seed, glm::dvec2 far) {
  world::World world;
  for (int i = 0; i < kBowls; ++i)
    cook(world, far + glm::dvec2{kApart * (i % 5), kApart * (i / 5)}, seed + static_cast<std::uint64_t>(i));
  const Tally tally = sweep(world);
  expect_exact("soups " + std::to_string(seed), tally);
  EXPECT_EQ(tally.met, tally.beams) << "something slipped out of a closed room";
  EXPECT_LT(tally.silhouettes, tally.beams / 20);
}

TEST(Soup, AtTheOrigin) { taste(100, {}); }
TEST(Soup, AHundredKilometresAway) { taste(200, {1e5, -1e5}); }
TEST(Soup, Again) { taste(300, {-0.3, 0.7}); }

}  // namespace
}  // namespace sf::trial
