#pragma once
// A simulated testbed with robots that are moved from outside, by their true states.

#include <cstdint>
#include <map>

#include "vision/testbed_patches.h"

namespace sf::vision {

/// Robots are identified by their tags. The `offset` of a tag is that of the testbed file.
class RenderedRobots {
 public:
  static constexpr std::size_t kMaxRobots = 1000;   ///< further robots are ignored
  static constexpr double kMaxExtrapolation = 0.5;  ///< [s] with the last velocity; after that, a robot stops

  /// @param testbed must outlive this
  explicit RenderedRobots(const Testbed& testbed);

  /// @param X_WO true pose of the robot with tag `id` at `time` [s]; z is ignored
  /// @param velocity [m/s] of its origin in the world
  /// @return false, without a change, if the dictionary lacks the tag or there are too many robots
  bool update(std::uint32_t id, const base::Pose& X_WO, glm::dvec2 velocity, double turn, double time);

  /// Returns the scene for an image whose middle is at `time` [s].
  Scene scene_at(double time) const;
  std::size_t size() const { return robots_.size(); }

 private:
  struct Robot {
    TagPattern pattern;
    TrueTag state;
    double time = 0.0;  ///< [s]
  };

  const Testbed& testbed_;
  std::uint32_t ids_;  ///< size of the dictionary; ids start at 0
  std::map<std::uint32_t, Robot> robots_;
};

}  // namespace sf::vision
