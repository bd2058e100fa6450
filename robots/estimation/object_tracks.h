#pragma once
// Tracks of objects that several sensors of several robots observe, with identities.
//
// Each track is a Kalman filter with constant velocity and white acceleration. Observations of one reading are assigned
// to tracks greedily, the most likely pair first, within a gate. An unassigned one that no track explains starts a
// track.
//
// Errors of two kinds are kept apart: those of the sensor, which are independent, and those of the robot's pose and of
// the object's extent, which repeat in an unknown way. The gain and the velocity's covariance take the sum of both as
// independent, and a drift of the second kind as motion; the position's covariance states it once more in full, since
// repeated observations from one wrong pose do not make a track more certain than the pose.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "base/pose.h"

namespace sf::estimation {

/// Upper triangle of a covariance of x, y [m^2].
using Spread = std::array<double, 3>;

/// The speed of an object along a line of sight, as radars measure it.
struct RadialSpeed {
  glm::dvec2 along;       ///< unit vector in the world frame
  double speed = 0.0;     ///< [m/s] of the object along it
  double variance = 0.0;  ///< [m^2/s^2] > 0
};

/// One observation of an object, in the world frame.
struct Observation {
  glm::dvec2 p;                            ///< [m] the point observed: on a surface, or a tag
  glm::dvec2 to_middle;                    ///< [m] from there to the middle of the object, if known
  Spread own{};                            ///< of the sensor's error
  Spread repeated{};                       ///< of the errors that repeat
  bool corner = false;                     ///< corners are tracked apart from other objects
  std::uint32_t tag = 0;                   ///< of a tag; 0: unknown
  std::optional<RadialSpeed> radial = {};  ///< nullopt: not measured
};

/// A wall, on which echoes are no objects.
struct SeenWall {
  glm::dvec2 middle, along;  ///< [m], unit vector
  double half_length = 0.0;  ///< [m]
  double across = 0.0;       ///< [m^2] variance
};

struct TrackOptions {
  double agility = 0.2;  ///< [m/s^1.5] > 0: in time t a speed changes by agility sqrt(t)
  double speed = 1.0;    ///< [m/s] > 0 standard deviation of the velocity of a new track
  double keep = 1.0;     ///< [s] > 0 without an observation, after which a track ends
  double gate = 13.8;    ///< of the squared normalised distance
};

/// An object.
struct ObjectTrack {
  std::uint32_t identity = 0;    ///< from 1, never used again
  std::int64_t time = 0;         ///< [ns] of its state
  glm::dvec2 p, v;               ///< [m], [m/s]
  std::array<double, 16> own{};  ///< covariance of x, y, vx, vy, without what the next adds to that of x, y
  Spread repeated{};             ///< of errors that repeat
  std::int64_t seen = 0;         ///< [ns] time of the last observation
  std::uint32_t hits = 0;        ///< readings in which it was observed
  bool moving = false, corner = false;
  std::uint32_t tag = 0;  ///< 0: unknown

  double covariance(std::size_t i, std::size_t j) const {
    return own[4 * i + j] + (i < 2 && j < 2 ? repeated[i + j] : 0.0);
  }
};

/// Not thread-safe. Work per reading is bounded by `kMostTracks`.
class ObjectTracks {
 public:
  static constexpr std::size_t kMostTracks = 128, kMostWalls = 1024;
  static constexpr std::uint32_t kConfirmed = 3;  ///< readings that make a track an object

  explicit ObjectTracks(const TrackOptions& options) : options_(options) {}

  /// Adds all observations of one reading. Readings older than a track's state count as of the time of that state.
  void add(std::int64_t time, std::span<const Observation> observations);
  /// Adds the walls of one reading. They are used for `kWallTime`.
  void add_walls(std::int64_t time, std::span<const SeenWall> walls);
  /// Ends tracks that have not been seen, and one of two that are the same object. Call it with ascending times.
  void end_old(std::int64_t time);
  /// Returns the objects at `time`, not before their states, by identity.
  std::vector<ObjectTrack> at(std::int64_t time) const;
  /// Observations that would have started a track when there were too many.
  std::uint64_t left_out() const { return left_out_; }

 private:
  struct TimedWall {
    std::int64_t time;
    SeenWall wall;
  };
  struct Pair {
    bool other_tag;  ///< not known to be the same
    double cost;
    std::size_t track, observation;
    auto key() const { return std::tuple(other_tag, cost, track, observation); }
  };

  bool on_wall(std::int64_t time, const Observation& observation) const;
  void assign(std::span<const Observation> observations);
  void start(std::int64_t time, const Observation& observation);

  TrackOptions options_;
  std::vector<ObjectTrack> tracks_;  ///< by identity
  std::deque<TimedWall> walls_;      ///< at most kMostWalls, in the order of arrival
  std::uint32_t next_identity_ = 1;
  std::uint64_t left_out_ = 0;
  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> used_, explained_, updated_;
};

}  // namespace sf::estimation
