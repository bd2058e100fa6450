#pragma once
// Merges the sightings of all cameras and tracks pose and velocity of each tag.

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
  double turn = 0.0;    ///< [rad/s]; it and the velocity are 0 at a tag's first sighting, where they are unknown
  int cameras = 0;      ///< number of cameras that saw it this time
  /// [m], [rad] As in TagFit, of the camera with the smallest `height_sigma`; 0: not measured.
  double height_sigma = 0.0, roll = 0.0, pitch = 0.0, tilt_sigma = 0.0;
  double position_sigma = 0.0;  ///< [m] standard deviation of x, and of y, by the noise of the images alone
  double yaw_sigma = 0.0;       ///< [rad] as `position_sigma`
};

/// One filter for each tag and axis (x, y, heading), with constant velocity and white acceleration (Bar-Shalom, Li,
/// Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 6.2.2). The velocity turns
/// with the measured heading, as for a wheeled robot, so that it does not lag behind in curves.
///
/// A tag that was not seen for a second is new again. Views of several cameras are moved to a common time by the tag's
/// velocity and averaged, weighted by pixel size.
class Tracker {
 public:
  /// @param report_from number of the sighting from which a tag is reported: 1 reports its first sighting, 2 rejects
  /// single false sightings
  explicit Tracker(std::uint32_t report_from = 1) : report_from_(report_from) {}

  /// Processes the sightings of all cameras at one time, grouped by camera. Replaces the content of `out` by the tags
  /// seen, sorted by id.
  void update(std::span<const Sighting> sightings, std::vector<TrackedTag>& out);

  /// A tag's place expected at some time.
  struct Prediction {
    glm::dvec2 at;        ///< [m]
    glm::dvec2 velocity;  ///< [m/s]
    double height = 0.0;  ///< [m] of its last sighting
    double sigma = 0.0;   ///< [m] standard deviation of x, and of y
    double age = 0.0;     ///< [s] since its last sighting
  };
  /// @return nullopt for a tag that was never seen
  std::optional<Prediction> predicted(std::uint32_t id, double time) const;

  /// Returns the number of rejected sightings: too far from the tag's last position, older than its last sighting, or
  /// at a second position at the same time.
  std::uint64_t refused() const { return refused_; }

  /// Returns the ids that two cameras saw at two places in the last update; valid until the next.
  std::span<const RepeatedTag> repeated() const { return repeated_; }

 private:
  /// Position and velocity along one axis, with their covariance.
  struct Axis {
    double x = 0.0, v = 0.0, xx = 0.0, xv = 0.0, vv = 0.0;
  };
  struct Track {
    double time = 0.0;
    double yaw = 0.0;          ///< [rad] last measured
    std::array<Axis, 3> axes;  ///< x, y, heading (not wrapped)
    std::uint32_t seen = 1;    ///< number of sightings, at most `report_from_`
    double height = 0.0;       ///< [m] last measured or given
  };
  struct View {
    double time = 0.0, pixel = 0.0;
    std::array<double, 3> at{};
    const TagFit* fit = nullptr;  ///< the one with the smallest `height_sigma`
  };

  static void predict(Axis& axis, double dt, double acceleration);
  static void correct(Axis& axis, double measured, double sigma);
  std::optional<View> merge(const Track* track, std::span<const Sighting> views, int& used);
  static bool is_near(const Track& track, const View& view);
  static void advance(Track& track, const View& view);

  std::map<std::uint32_t, Track> tracks_;
  std::vector<Sighting> sorted_;
  std::vector<RepeatedTag> repeated_;
  std::uint64_t refused_ = 0;
  std::uint32_t report_from_;
};

}  // namespace sf::vision
