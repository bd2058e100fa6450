#pragma once
// How a robot's process went.

#include <cstdint>
#include <string>

#include "apps/control_report.h"
#include "apps/robot_link.h"
#include "base/pose.h"

namespace sf::apps {

struct RobotReport {
  std::string robot;  ///< name in the world
  std::uint32_t id = 0;
  std::string controller;
  std::string farm;  ///< "127.0.0.1:9000"
  double wall_s = 0.0;
  std::uint64_t steps = 0;  ///< of the controller
  bool started = true;      ///< it did not wait for a start signal, or it came
  bool done = false;        ///< as the controller says
  bool answered = false;    ///< anything came from the farm
  bool listens = true;      ///< it has sensors, so that something should have come
  LinkCounts link;
  std::uint64_t contacts = 0;        ///< that began
  std::uint64_t stops = 0;           ///< times that it stood for want of readings
  std::uint64_t lines_left_out = 0;  ///< of its log
  double distance_m = 0.0;           ///< driven
  base::Pose pose;                   ///< at the end
  ErrorSummary error;
};

std::string json_of(const RobotReport& facts);
std::string text_of(const RobotReport& facts);

}  // namespace sf::apps
