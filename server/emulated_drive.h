#pragma once
// A real robot that is emulated: it drives in a world of its own, which stands for the laboratory, and its own sensors
// read this world alone. It shares nothing with the farm.

#include <memory>
#include <string>

#include "farm/farm.h"
#include "gpu/device.h"
#include "robots/robot_body.h"
#include "server/real_robot.h"

namespace sf::server {

class EmulatedDrive final : public RealRobot {
 public:
  /// @param options their world has the robot  @param X_WM start pose, as in that world
  /// @throws base::InputError if it starts elsewhere, or its sensors are invalid
  EmulatedDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double track);

  void drive(const base::Twist& twist, std::int64_t) override { command_ = twist; }
  void stop() override { command_ = {}; }
  const base::Report& truth() const { return body_.state(); }  ///< in its world

 private:
  void start(std::int64_t) override {}
  void take(std::span<const std::uint8_t>, std::int64_t) override {}
  void run(std::int64_t now) override;
  void measure(std::int64_t now);

  std::shared_ptr<const world::World> world_;
  std::uint32_t mover_;
  gpu::Device device_;
  farm::Farm farm_;
  robots::RobotBody body_;
  base::Twist command_;
};

}  // namespace sf::server
