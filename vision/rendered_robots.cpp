#include "vision/rendered_robots.h"

#include "vision/tag_family.h"

namespace sf::vision {

RenderedRobots::RenderedRobots(const Testbed& testbed) : testbed_(testbed), ids_(family_size(testbed.dictionary)) {}

bool RenderedRobots::update(std::uint32_t id, const base::Pose& X_WO, glm::dvec2 velocity, double turn, double time) {
  auto at = robots_.find(id);
  if (at == robots_.end()) {
    if (id >= ids_ || robots_.size() == kMaxRobots) return false;
    at = robots_.emplace(id, Robot{family_pattern(testbed_.dictionary, id), {}, 0.0}).first;
  }
  const TagMount& mount = testbed_.mount(id);
  const glm::dvec2 arm = base::rotate(X_WO.yaw, {mount.X_OT.x, mount.X_OT.y});
  const base::Pose X_WT = base::compose(X_WO, mount.X_OT);
  at->second.state = {id, X_WT, velocity + turn * glm::dvec2{-arm.y, arm.x}, turn};
  at->second.time = time;
  return true;
}

Scene RenderedRobots::scene_at(double time) const {
  Scene scene;
  scene.gradient = {0.06, -0.04};
  for (const auto& [id, robot] : robots_) {
    TrueTag state = robot.state;
    double of = robot.time;
    if (time - of > kMaxExtrapolation) {
      state.X_WT.x += kMaxExtrapolation * state.velocity.x;
      state.X_WT.y += kMaxExtrapolation * state.velocity.y;
      state.X_WT.yaw = base::wrap_angle(state.X_WT.yaw + kMaxExtrapolation * state.turn);
      state.velocity = {};
      state.turn = 0.0;
      of = time;
    }
    add_tag(scene, state, of, testbed_.mount(id).side, robot.pattern);
  }
  return scene;
}

}  // namespace sf::vision
