#pragma once
// Sightings of all cameras merged and tracked: pose and velocity of each tag.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "vision/tag_detector.h"

namespace sf::vision {

/// The state of one tag.
struct TrackedTag {
  std::uint32_t id = 0;
  double time = 0.0;    ///< [s] of the pose
  base::Pose X_WT;      ///< measured, not smoothed; yaw in [-pi, pi]
  glm::dvec2 velocity;  ///< [m/s] in the world
  double turn = 0.0;    ///< [rad/s]
  int cameras = 0;      ///< that saw it this time
};

/// One filter for each tag and axis (x, y, heading), with constant velocity and white acceleration (Bar-Shalom, Li,
/// Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 6.2.2). The velocity turns
/// with the measured heading, as that of a wheeled robot does, so that it does not lag behind in curves.
///
/// A tag is reported from its second sighting on, since the velocity of the first is unknown and a single one may be
/// false. Views of several cameras are moved to one time by the tag's velocity and averaged, weighted by the size of
/// their pixels.
class Tracker {
 public:
  /// Takes the sightings of all cameras of one moment, those of one camera after those of another. Replaces the content
  /// of `out` by the tags seen, in ascending order of ids.
  void update(std::span<const Sighting> sightings, std::vector<TrackedTag>& out);

  /// Sightings that were refused: too far from the tag's last place, older than its last one, or at a second place at
  /// the same time.
  std::uint64_t refused() const { return refused_; }

 private:
  /// Position and velocity along one axis, with their covariance.
  struct Axis {
    double x = 0.0, v = 0.0, xx = 0.0, xv = 0.0, vv = 0.0;
  };
  struct Track {
    double time = 0.0;
    double yaw = 0.0;          ///< [rad] last measured
    std::array<Axis, 3> axes;  ///< x, y, heading (not wrapped)
  };
  struct View {
    double time = 0.0, pixel = 0.0;
    std::array<double, 3> at{};
  };

  static void predict(Axis& axis, double dt, double acceleration);
  static void correct(Axis& axis, double measured, double sigma);
  static std::optional<View> merge(const Track* track, std::span<const Sighting> views, int& used);
  static bool is_near(const Track& track, const View& view);
  static void advance(Track& track, const View& view);

  std::map<std::uint32_t, Track> tracks_;
  std::vector<Sighting> sorted_;
  std::uint64_t refused_ = 0;
};

}  // namespace sf::vision
