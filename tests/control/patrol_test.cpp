#include "control/patrol.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robots/kinematics.h"
#include "robots/motion_limits.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::control {
namespace {

using base::Pose;

struct Walk {
  std::vector<std::size_t> targets;  // one after another
  Pose X_WM;
  double at_rest = 0.0;  // [s]
};

Walk walk(Patrol& patrol, const Pose& from, int ticks, const std::vector<Neighbour>& others = {},
          world::Drive how = world::Drive::differential) {
  world::Mover mover;
  mover.drive = how;
  mover.wheelbase = 0.1;
  Walk walk{.targets = {patrol.target()}, .X_WM = from};
  for (int i = 0; i < ticks; ++i) {
    const base::Twist twist = patrol.step({.time = i * kTick, .state = {.X_WM = walk.X_WM}, .others = others});
    if (twist.forward == 0.0 && twist.turn == 0.0) walk.at_rest += 0.1;
    walk.X_WM = robots::advance(walk.X_WM, robots::limit_kinematics(mover, twist), 0.1);
    if (patrol.target() != walk.targets.back()) walk.targets.push_back(patrol.target());
  }
  return walk;
}

TEST(Patrol, DrivesToTheLastPointAndBack) {
  Patrol patrol({.points = {{0, 0}, {1, 0}, {1, 1}}});
  EXPECT_EQ(walk(patrol, {}, 600).targets, (std::vector<std::size_t>{0, 1, 2, 1, 0, 1, 2}));
}

TEST(Patrol, DrivesToASinglePointAndStays) {
  Patrol patrol({.points = {{1, 0}}});
  const Walk w = walk(patrol, {}, 300);
  EXPECT_NEAR(w.X_WM.x, 1.0, 0.03 + 1e-9);
  EXPECT_GT(w.at_rest, 15.0);
}

TEST(Patrol, PausesOnlyAtTheEnds) {
  Patrol patrol({.points = {{0, 0}, {0.5, 0}, {1, 0}}, .pause = 3.0});
  const Walk w = walk(patrol, {}, 600);
  EXPECT_GE(w.at_rest, 6.0) << "at both ends, at least once";
  EXPECT_LE(w.at_rest, 13.0);
}

TEST(Patrol, CarTurnsAround) {
  Patrol patrol({.points = {{0, 0}, {2, 0}}, .reach = 0.1, .turns_in_place = false});
  EXPECT_GE(walk(patrol, {0, 0, 0, 1.0}, 900, {}, world::Drive::car).targets.size(), 4u);
}

struct Obstacle {
  glm::dvec2 other;
  bool stops;
  const char* why;
};

TEST(Patrol, StopsForRobotsInItsWay) {
  for (const Obstacle& s : {Obstacle{{0.4, 0.0}, true, "ahead"}, Obstacle{{0.47, 0.0}, false, "beyond 0.165 + 0.3 m"},
                            Obstacle{{-0.3, 0.0}, false, "behind"}, Obstacle{{0.3, 0.34}, false, "next to its lane"},
                            Obstacle{{0.3, -0.32}, true, "half in its lane"}}) {
    Patrol patrol({.points = {{0, 0}, {5, 0}}});
    const std::vector<Neighbour> others{{.id = 2, .state = {.X_WM = {s.other.x, s.other.y, 0, 0}}}};
    EXPECT_EQ(walk(patrol, {}, 1, others).at_rest > 0.0, s.stops) << s.why;
    EXPECT_EQ(patrol.stop_reason(), s.stops ? "another robot blocks its way" : "") << s.why;
    EXPECT_GE(patrol.v2v_range(), length(s.other));
  }
  Patrol patrol({.points = {{0, 0}, {5, 0}}});
  const Pose turned{1, 1, 0, M_PI / 2};
  const std::vector<Neighbour> above{{.id = 2, .state = {.X_WM = {1, 1.4, 0, 0}}}};
  EXPECT_GT(walk(patrol, turned, 1, above).at_rest, 0.0) << "ahead of a turned robot";
}

}  // namespace
}  // namespace sf::control
