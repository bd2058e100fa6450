#include "control/teammates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/refusal.h"

namespace sf::control {
namespace {

constexpr maps::GridGeometry kArea{.left = -1.8, .top = 1.8};

/// A map with a scan of a room from `p`, recorded.
ExplorationMap map_from(glm::dvec2 p, std::uint64_t seed) {
  ExplorationMap map(kArea, 0.165, 0.19);
  map.record_changes();
  std::vector<double> ranges;
  for (std::uint32_t i = 0; i < 181; ++i) ranges.push_back(0.3 + base::random_uniform({.seed = seed, .a = i}, 0)[0]);
  map.add({{p.x, p.y, 0.0, 0.0}, ranges, maps::beam_directions(M_PI, 181), 0.02, 1.2});
  return map;
}

void expect_equal(const ExplorationMap& a, const ExplorationMap& b) {
  EXPECT_EQ(a.grid().words, b.grid().words);
  for (Node node = 0; node < a.nodes(); ++node) {
    ASSERT_EQ(a.clearance(node), b.clearance(node)) << node;
    ASSERT_EQ(a.covers_unknown(node), b.covers_unknown(node)) << node;
    ASSERT_EQ(a.occupied(node), b.occupied(node)) << node;
    ASSERT_EQ(a.explored(node), b.explored(node)) << node;
  }
}

TEST(ExplorationMap, MergingIsCommutative) {
  ExplorationMap a = map_from({0.0, 0.0}, 1), b = map_from({0.5, -0.4}, 2);
  const MapChanges of_a = a.take_changes(), of_b = b.take_changes();
  EXPECT_TRUE(a.merge(of_b));
  EXPECT_TRUE(b.merge(of_a));
  expect_equal(a, b);
  ExplorationMap third(kArea, 0.165, 0.19);  // in the other order, without own measurements
  third.merge(of_b);
  third.merge(of_a);
  expect_equal(third, a);
}

TEST(ExplorationMap, MergingIsIdempotent) {
  ExplorationMap a = map_from({0.0, 0.0}, 1), once = map_from({0.5, -0.4}, 2), twice = map_from({0.5, -0.4}, 2);
  const MapChanges of_a = a.take_changes();
  once.merge(of_a);
  twice.merge(of_a);
  EXPECT_FALSE(twice.merge(of_a));
  expect_equal(once, twice);
  EXPECT_FALSE(a.merge(of_a)) << "its own measurements";
}

TEST(ExplorationMap, MergedMeasurementsAreNotSentAgain) {
  ExplorationMap a = map_from({0.0, 0.0}, 1), b = map_from({0.5, -0.4}, 2);
  b.take_changes();
  b.merge(a.take_changes());
  EXPECT_TRUE(b.take_changes().empty());
}

TEST(ExplorationMap, BodiesOfOthersAreNotDrivenOver) {
  ExplorationMap map(kArea, 0.165, 0.19);
  map.mark_free({0, 0}, 1.2);
  const Node here = map.node_at({0.3, 0.0}), there = map.node_at({-0.5, 0.0});
  const std::vector<glm::dvec2> body{{0.0, 0.0}};
  const std::vector<double> distance{0.4};
  map.set_bodies(body, distance);
  EXPECT_TRUE(map.covers_unknown(here));
  EXPECT_FALSE(map.covers_unknown(there));
  map.set_bodies({}, {});
  EXPECT_FALSE(map.covers_unknown(here)) << "it left";
}

// ---- Claims.

/// A robot of a team at a place, without a laser.
struct Member {
  Member(std::uint32_t own_id, glm::dvec2 place) : id(own_id), p(place), team({.id = own_id}) {}
  void claim(std::vector<std::int64_t> cells) { team.publish(time += 100'000'000, std::move(cells), map); }
  bool update(std::vector<const Member*> others) {
    std::vector<Neighbour> states;
    std::vector<TeammateMap> maps;
    for (const Member* other : others) {
      states.push_back({other->id, {.X_WM = {other->p.x, other->p.y, 0, 0}}, {}});
      if (other->team.published()) maps.push_back({other->id, other->team.published()});
    }
    team.receive(maps);
    return team.update({.state = {.X_WM = {p.x, p.y, 0, 0}}, .others = states}, map);
  }

  std::uint32_t id;
  glm::dvec2 p;
  ExplorationMap map{kArea, 0.165, 0.19};
  Teammates team;
  std::int64_t time = 0;
};

TEST(Teammates, TheNearestRobotHasPriority) {
  Member a(7, {0.0, 0.0}), b(3, {1.0, 0.0});
  const maps::CellAt near_a = maps::cell_at(kArea, {0.2, 0.1}), near_b = maps::cell_at(kArea, {0.8, 0.1});
  std::vector<std::int64_t> both{a.map.key(near_a), a.map.key(near_b)};
  for (Member* m : {&a, &b}) m->claim(both);
  a.update({&b});
  b.update({&a});
  EXPECT_FALSE(a.team.claimed(near_a, a.map));
  EXPECT_TRUE(a.team.claimed(near_b, a.map));
  EXPECT_TRUE(b.team.claimed(near_a, b.map));
  EXPECT_FALSE(b.team.claimed(near_b, b.map));
}

// Ids break ties, so that exactly one robot keeps each cell.
TEST(Teammates, ClaimsAreExclusiveAmongEquallyNearRobots) {
  Member a(7, {0.5, 0.0}), b(3, {0.5, 0.0}), c(5, {0.5, 0.0});
  const maps::CellAt cell = maps::cell_at(kArea, {0.2, 0.1});
  for (Member* m : {&a, &b, &c}) m->claim({m->map.key(cell)});
  a.update({&b, &c});
  b.update({&a, &c});
  c.update({&a, &b});
  EXPECT_TRUE(a.team.claimed(cell, a.map));
  EXPECT_FALSE(b.team.claimed(cell, b.map)) << "the lowest id";
  EXPECT_TRUE(c.team.claimed(cell, c.map));
}

TEST(Teammates, ARobotThatLeavesReleasesItsClaim) {
  Member a(7, {1.0, 0.0}), b(3, {0.0, 0.0});
  const maps::CellAt cell = maps::cell_at(kArea, {0.2, 0.1});
  b.claim({b.map.key(cell)});
  a.update({&b});
  EXPECT_TRUE(a.team.claimed(cell, a.map));
  a.update({});
  EXPECT_FALSE(a.team.claimed(cell, a.map));
}

TEST(Teammates, ARobotThatReturnsSendsItsMapAgain) {
  Member a(7, {1.0, 0.0}), b(3, {0.0, 0.0});
  b.map = map_from({0.0, 0.0}, 1);
  b.claim({});
  EXPECT_TRUE(a.update({&b}));
  EXPECT_FALSE(a.update({&b})) << "no new measurements";
  Member again(3, {0.0, 0.0});
  again.map = map_from({0.5, -0.4}, 2);
  again.claim({});
  EXPECT_TRUE(a.update({&again})) << "also one sequence of changes, but another robot";
}

TEST(Teammates, MapsOfOtherAreasAreRefused) {
  Member a(7, {1.0, 0.0}), b(3, {0.0, 0.0});
  b.map = ExplorationMap({.left = -2.0, .top = 1.8}, 0.165, 0.19);
  b.claim({});
  EXPECT_EQ(refusal_of([&] { a.update({&b}); }),
            "controller 'explore': the maps of the robots with ids 7 and 3 cover different areas; expected the same "
            "`cell`, `map_left`, `map_top`, `map_width` and `map_height` for all robots of a team");
}

}  // namespace
}  // namespace sf::control
