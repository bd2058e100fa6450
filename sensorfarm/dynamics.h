#pragma once
// Your own actuator models: how a robot moves in six degrees of freedom (docs/own_controller.md#dynamics).
//
//   class Balloon : public sensorfarm::Dynamics {
//    public:
//     Balloon(const sensorfarm::DynamicsSite&, sensorfarm::Settings& settings) : rise_(settings.number("rise", 1, 0,
//     9))
//     {}
//     std::size_t state_size() const override { return 0; }
//     sensorfarm::BodyState move(const sensorfarm::BodyState& from, const sensorfarm::Twist&, double seconds,
//                                const sensorfarm::Ground&, std::span<double>) const override {
//       sensorfarm::BodyState to = from;
//       to.pose.z += rise_ * seconds;
//       return to;
//     }
//
//    private:
//     double rise_;  // [m/s]
//   };
//
//   SENSORFARM_PLUGIN(plugin) { plugin.add_dynamics<Balloon>("balloon", "rises"); }
//
// In a world file: position( drive "omni" dynamics "./libballoon.so rise=2" )

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "sensorfarm/controller.h"

namespace sensorfarm {

/// The robot that moves, at the time when its dynamics are created.
struct DynamicsSite {
  std::string name;          ///< name in the world file
  std::uint32_t row = 0;     ///< among all robots and tags of the world
  Pose pose;                 ///< pose at the start
  double radius = 0.0;       ///< [m] radius of the circle about its origin that contains its body
  double max_forward = 0.0;  ///< [m/s] `velocity_bounds`, which limit commands
  double max_turn = 0.0;     ///< [rad/s]
  double wheelbase = 0.0;    ///< [m]
  double track = 0.0;        ///< [m]
  std::string world;         ///< path of the world file, as given by the user
};

/// Where a body is. Its orientation is Rz(yaw) Ry(pitch) Rx(roll).
struct BodyState {
  Pose pose;
  double roll = 0.0;   ///< [rad] positive: the left side is higher
  double pitch = 0.0;  ///< [rad] positive: the front is lower
  Twist velocity;      ///< horizontal, in the frame of the heading; turn: rate of the yaw
};

/// The floor, the terrain and the roads of the world.
class Ground {
 public:
  virtual ~Ground() = default;
  /// Returns the height [m] of the highest road at (x, y) that is at most `most` [m] high, or of the terrain or the
  /// floor.
  virtual double height(double x, double y, double most) const = 0;
};

/// One object per robot, which calls do not change: all that changes, and that a BodyState does not have, is in
/// `state`. So a run may move robots in parallel, in several processes, and restart them. The same inputs have to give
/// the same bytes. An exception ends the run with its message.
///
/// Obstacles are the farm's: it moves the robot from one pose to the next along an arc, at the height of the first one,
/// and stops it where a wall or another robot touches its outline.
class Dynamics {
 public:
  virtual ~Dynamics() = default;
  /// Returns the number of elements of `state`, at most 4096. Read once.
  virtual std::size_t state_size() const = 0;
  /// Sets the state of a robot that starts at `at`, or was put there. 0 by default.
  virtual void place(const BodyState&, std::span<double> state) const { std::fill(state.begin(), state.end(), 0.0); }
  /// Sets the state of a robot that an obstacle stopped at `at`, where its velocity is 0 or a turn in place.
  virtual void stop(const BodyState& at, std::span<double> state) const { place(at, state); }
  /// Returns the body after `seconds` > 0, without obstacles: finite, within 1e7 m of the origin.
  /// @param command within the limits of the robot's drive; finite
  virtual BodyState move(const BodyState& from, const Twist& command, double seconds, const Ground& ground,
                         std::span<double> state) const = 0;
};

/// A kind of dynamics: its name, and how to create one.
struct DynamicsEntry {
  std::string name;     ///< name after the file and a colon in `dynamics`
  std::string summary;  ///< one line
  /// Throws an exception to refuse the robot; its message is reported.
  std::function<std::unique_ptr<Dynamics>(const DynamicsSite&, Settings&)> make;
};

}  // namespace sensorfarm
