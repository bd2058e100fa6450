#include "bench/lane_scene.h"

#include <cmath>

#include "tests/sensors/chance.h"
#include "tests/sensors/laneedge_trial.h"

namespace sf::bench {

namespace {

constexpr double kBlock = 4.0;   // [m]
constexpr double kLane = 0.5;    // [m]
constexpr double kTurn = 0.68;   // [m]
constexpr double kPaint = 0.03;  // [m]
constexpr std::size_t kRounds = 8;

/// Transforms points of a street along +x at the origin to its position.
struct Street {
  double x, y;
  bool up;
  glm::dvec2 at(double along, double aside) const {
    return up ? glm::dvec2{x - aside, y + along} : glm::dvec2{x + along, y + aside};
  }
};

void add_street(world::World& world, const Street& s) {
  const double from = kLane + kTurn;
  const double to = kBlock - kLane - kTurn;
  for (const double side : {-kLane, kLane})
    world.lane_markings.push_back(trial::marking(s.at(from, side), s.at(to, side), kPaint));
  trial::add_dashes(world, s.at(from, 0.0), s.at(to, 0.0), kPaint, 0.15, 0.15);
}

/// Adds the four turns of a crossing.
void add_turns(world::World& world, double x, double y) {
  const double c = kLane + kTurn;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double a = 0.5 * M_PI * quarter;
    const glm::dvec2 centre = glm::dvec2{x, y} + base::rotate(a, {c, c});
    world.lane_markings.push_back(trial::arc(centre, kTurn, a + M_PI, a + 1.5 * M_PI, kPaint, 1e-3));
  }
}

}  // namespace

LaneScene make_lane_scene(std::uint32_t blocks, std::uint32_t robots, double resolution) {
  LaneScene scene;
  scene.world.road_resolution = resolution;
  std::vector<Street> streets;
  for (std::uint32_t j = 0; j < blocks; ++j)
    for (std::uint32_t i = 0; i < blocks; ++i) {
      const double x = kBlock * i;
      const double y = kBlock * j;
      add_turns(scene.world, x, y);
      for (const bool up : {false, true}) streets.push_back({x, y, up});
    }
  for (const Street& s : streets) add_street(scene.world, s);

  trial::Chance chance(77);
  std::vector<base::Pose> poses;
  for (std::uint32_t k = 0; k < robots; ++k) {
    const Street& s = streets[chance.below(static_cast<std::uint32_t>(streets.size()))];
    const glm::dvec2 p = s.at(chance.between(0.0, kBlock), chance.between(-0.45, -0.05));
    const double yaw = (s.up ? 0.5 * M_PI : 0.0) + chance.between(-0.35, 0.35);
    poses.push_back({p.x, p.y, 0.0, yaw});
    trial::add_edge_eye(scene.world, poses.back(), {});
    // Half of the sensors point left to the centre line, the others right to the edge line.
    scene.world.movers.back().sensors[0].X_MS.yaw = k % 2 == 0 ? 0.5 * M_PI : -0.5 * M_PI;
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (base::Pose& X : poses) {
      X.x += chance.between(-0.003, 0.003);
      X.y += chance.between(-0.003, 0.003);
      X.yaw += chance.between(-0.05, 0.05);
    }
    scene.rounds.push_back(poses);
  }
  world::update_extent_and_hash(scene.world);
  return scene;
}

}  // namespace sf::bench
