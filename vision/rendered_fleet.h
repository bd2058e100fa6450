#pragma once
// A simulated testbed for the cameras of a testbed file: tags move on circles, each in a separate part of the field of
// view, with clutter on the floor and occluders above. Everything is a function of time, so the ground truth is exact.

#include <cstdint>
#include <vector>

#include "vision/testbed_patches.h"

namespace sf::vision {

struct FleetOptions {
  std::uint32_t tags = 30;      ///< with ids 1 to this number, or the first ids listed in the testbed file
  double speed = 0.5;           ///< [m/s] of the fastest tag; the others have 20 to 100 % of it
  std::uint32_t occluders = 0;  ///< dark discs of 0.3 m, 1 m above the floor, on separate circles
  bool clutter = true;          ///< lane markings and framed black squares on the floor
  std::uint64_t seed = 1;
};

class RenderedFleet {
 public:
  /// @param testbed must outlive the fleet
  /// @throws base::InputError if the tags do not fit into the field of view, or the dictionary is too small
  RenderedFleet(const Testbed& testbed, const FleetOptions& options);

  /// Returns the scene near `time` [s]; its patches move straight with the tags' velocities at that time.
  Scene scene_at(double time) const;
  TrueTag truth(std::size_t tag, double time) const;
  std::size_t size() const { return tags_.size(); }
  /// True if `camera` sees the whole tag with its white border at `time`.
  bool is_visible(const Camera& camera, std::size_t tag, double time) const;

 private:
  struct Circle {
    glm::dvec2 center;
    double radius = 0.0, speed = 0.0, phase = 0.0;  ///< [m], [m/s] (negative: clockwise), [rad]
  };
  struct Tag {
    std::uint32_t id = 0;
    Circle circle;
    double yaw = 0.0;  ///< [rad] relative to the direction of travel
    TagPattern pattern;
  };
  static glm::dvec2 place(const Circle& circle, double time);

  const Testbed& testbed_;
  FleetOptions options_;
  std::vector<Tag> tags_;
  std::vector<Circle> occluders_;
  std::vector<Patch> clutter_;
  double pitch_ = 0.0;  ///< [m] between circles
};

}  // namespace sf::vision
