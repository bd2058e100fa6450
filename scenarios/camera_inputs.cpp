#include "scenarios/camera_inputs.h"

#include <algorithm>

#include "sensors/derived/wiring.h"

namespace sf::scenarios {

void CameraInputs::add(const farm::Farm& farm, const world::World& world, const PositioningOptions& options) {
  for (const auto& [mover, receiver] : farm.received_inputs(sensors::kCameraInput))
    if (std::ranges::find(robots_, mover, &Robot::mover) == robots_.end())
      robots_.push_back({mover, Positioning(options, world.movers[mover].id)});
}

std::span<const base::ReadingBlock> CameraInputs::receive(std::int64_t time, std::span<const base::Report> states,
                                                          const std::vector<bool>& absent) {
  values_.clear(), readings_.clear();
  for (Robot& robot : robots_) {
    if (!absent[robot.mover]) robot.positioning.measure(time, states[robot.mover].X_WM);
    for (const control::MeasuredPose& pose : robot.positioning.receive(time)) {
      values_.push_back({pose.X_WM.x, pose.X_WM.y, pose.X_WM.yaw, 1.0});
      std::ranges::copy(pose.covariance, values_.back().begin() + 4);
      readings_.push_back(
          {.mover = robot.mover, .type = sensors::kCameraInput, .sequence = robot.received++, .time = pose.time});
    }
  }
  for (std::size_t i = 0; i < readings_.size(); ++i) readings_[i].values = values_[i];
  return readings_;
}

}  // namespace sf::scenarios
