#pragma once
// A simulated testbed whose robots are moved from outside, by their true states: what its cameras see.

#include <cstdint>
#include <map>

#include "vision/testbed_patches.h"

namespace sf::vision {

/// Robots are named by their tags, which they carry at the height and with the `offset` of the testbed file.
class RenderedRobots {
 public:
  static constexpr std::size_t kMaxRobots = 1000;   ///< others are left out
  static constexpr double kMaxExtrapolation = 0.5;  ///< [s] with the last velocity; then a robot stands

  /// @param testbed lives longer
  explicit RenderedRobots(const Testbed& testbed);

  /// @param X_WO true pose of the robot with tag `id` at `time` [s]; z does not count
  /// @param velocity [m/s] of its origin in the world
  /// @return false, and nothing changes, where the dictionary has no such tag, or the robots are too many
  bool update(std::uint32_t id, const base::Pose& X_WO, glm::dvec2 velocity, double turn, double time);

  /// Of an image whose middle is at `time` [s].
  Scene scene_at(double time) const;
  std::size_t size() const { return robots_.size(); }

 private:
  struct Robot {
    TagPattern pattern;
    TrueTag state;
    double time = 0.0;  ///< [s]
  };

  const Testbed& testbed_;
  std::uint32_t ids_;  ///< of the dictionary, from 0
  std::map<std::uint32_t, Robot> robots_;
};

}  // namespace sf::vision
