#pragma once
// An extended Kalman filter of a team: the poses of robots that report their speeds and measure range and bearing of
// landmarks and of each other, jointly with the constants of their sensors and with landmarks at unknown positions.
// Since the errors of all robots have one covariance, no information counts twice. All functions are pure.
//
// Errors of range and bearing are not white: a landmark seen again from the same place has nearly the same error. A
// repeated sighting therefore counts less, and a constant share of the error never averages out.
//
// References: S. I. Roumeliotis and G. A. Bekey, Distributed multirobot localization, IEEE Transactions on Robotics and
// Automation 18, 2002; for the weights of outliers K. L. Lange, R. J. A. Little and J. M. G. Taylor, Robust statistical
// modeling using the t distribution, JASA 84, 1989; for the smoother H. E. Rauch, F. Tung and C. T. Striebel, AIAA
// Journal 3, 1965.

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "robots/estimation/state.h"

namespace sf::estimation {

/// Components of one robot, after which those of the next follow. x and y of the landmarks at unknown positions are
/// last.
enum TeamComponent : std::uint8_t {
  kTeamX,          ///< [m] world frame
  kTeamY,          ///< [m]
  kTeamYaw,        ///< [rad] not wrapped
  kSpeedScale,     ///< [-] true speed over the reported one
  kTurnScale,      ///< [-] the same of the turn rate
  kBearingOffset,  ///< [rad] measured bearing minus the true one
  kTurnDrift,      ///< [rad/s] turn rate of a moving robot that reports none
  kTeamComponents
};

/// Noise and constants of all robots of a team. Each standard deviation is >= 0. The defaults are those of the iRobot
/// Creates of MRCLAM; docs/derived.md says how they were found.
struct TeamModel {
  // Odometry. Speeds are held until the next ones take effect.
  double delay = 0.22;                            ///< [s] >= 0 from reported speeds to the motion
  double jitter = 0.05;                           ///< [s] standard deviation of `delay`, from change to change
  double hold = 1.5;                              ///< [s] > 0 after which a robot without new speeds may do anything
  std::array<double, 2> speed_scale{0.94, 0.02};  ///< [-] mean and standard deviation over robots
  std::array<double, 2> turn_scale{0.93, 0.025};  ///< [-] the same
  double scale_drift = 3e-4;                      ///< [s^(-1/2)] change of a scale in one second of motion
  std::array<double, 2> turn_drift{0.006, 10.0};  ///< [rad/s], [s] > 0 standard deviation and correlation time
  double along = 0.06, across = 0.01;             ///< [m^(1/2)] slip after one metre
  double pivot = 0.042;                           ///< [m rad^(-1/2)] change of position by turning one radian
  double yaw_per_metre = 0.05;                    ///< [rad m^(-1/2)] change of yaw after one metre
  double yaw_per_radian = 0.05;                   ///< [rad^(1/2)] change of yaw after turning one radian

  // Sightings.
  double exposure = 0.04;            ///< [s] >= 0 from the measurement to its timestamp
  double range_scale = -0.015;       ///< [-] > -1 measured range over the true one, minus 1
  double range_noise = 0.03;         ///< [m] > 0
  double range_noise_share = 0.085;  ///< [-] of the range; both add in squares
  double bearing_noise = 0.009;      ///< [rad] > 0
  double target_size = 0.003;        ///< [m] bearing noise at one metre, falling with the range
  double turn_blur = 0.03;           ///< [s] bearing noise per turn rate
  double bearing_offset = 0.01;      ///< [rad] standard deviation over robots
  double repeat = 2.9;               ///< [s] correlation time of the errors of one target
  double freedom = 12.0;             ///< [-] > 0 degrees of freedom of Student's t distribution
  double outlier = 400.0;            ///< [-] > 0 squared innovation beyond which a sighting is rejected

  // Errors that do not average out, added to the covariance of every estimate.
  double place_error = 0.025;  ///< [m]
  double yaw_error = 0.008;    ///< [rad]
};

/// Reported speeds.
struct Speeds {
  std::int64_t time = 0;  ///< [ns] from which they take effect
  double forward = 0.0;   ///< [m/s]
  double turn = 0.0;      ///< [rad/s]

  auto operator<=>(const Speeds&) const = default;
};

/// One event of a team, in the order of application.
struct TeamEvent {
  enum class Kind : std::uint8_t {
    step,     ///< brings a robot to `time`; no measurement
    pose,     ///< values: x, y, yaw; replaces the pose, e.g. at the start
    sighting  ///< values: range [m], bearing [rad]
  };
  std::int64_t time = 0;  ///< [ns]
  Kind kind = Kind::step;
  std::uint32_t robot = 0;
  std::uint32_t target = 0;        ///< a robot, or number of robots + k for landmark k
  std::array<double, 3> values{};  ///< as stated by `kind`; the others are 0
  PoseCovariance covariance{};     ///< of a pose

  auto operator<=>(const TeamEvent&) const = default;
};

/// The fixed part of the problem.
struct Team {
  TeamModel model;
  std::uint32_t robots = 1;
  std::vector<std::optional<glm::dvec2>> landmarks;  ///< [m] world frame; nullopt: unknown, estimated with the poses
};

struct TeamState {
  struct Robot {
    std::int64_t time = -1;               ///< [ns] of its components; -1: not started
    std::vector<std::int64_t> last_seen;  ///< [ns] by target; -1: never
  };
  std::int64_t event = -1;  ///< [ns] time of the last event
  std::vector<Robot> robots;
  std::vector<std::uint8_t> mapped;  ///< by landmark: its position is known or estimated
  std::vector<double> mean;          ///< kTeamComponents of each robot, then two of each landmark not known at first
  std::vector<double> covariance;    ///< symmetric

  bool known() const { return event >= 0; }
  std::int64_t time() const { return event; }
};

/// Returns a team of which no robot has started.
TeamState first_state(const Team& team);

/// Mean of one robot's components at a later time, with its derivative and the noise added on the way.
struct TeamMotion {
  static constexpr std::size_t kSize = kTeamComponents;
  std::array<double, kSize> mean{};
  std::array<double, kSize * kSize> derivative{};  ///< column-major
  std::array<double, kSize * kSize> noise{};       ///< symmetric

  /// Begins with the components of a robot.
  static TeamMotion from(const TeamState& state, std::uint32_t robot);
};

/// Continues a motion from `begin` to `end`. Stops at the times of speeds on the way change no bit of the result.
/// @param speeds sorted by time
void drive(const TeamModel& model, std::int64_t begin, std::int64_t end, std::span<const Speeds> speeds,
           TeamMotion& all);

/// Brings one robot to `time`. Earlier times leave it unchanged.
void advance(const Team& team, std::uint32_t robot, std::int64_t time, std::span<const Speeds> speeds,
             TeamState& state);

enum class TeamUse : std::uint8_t { used, outlier, unknown /*robot or target*/ };
struct TeamResult {
  TeamUse use = TeamUse::unknown;
  double squared = 0.0;  ///< innovation of a sighting, normalised without the weight of outliers
};

/// Applies an event. @param speeds of each robot, sorted by time
TeamResult apply(const Team& team, const TeamEvent& event, std::span<const std::vector<Speeds>> speeds,
                 TeamState& state);

/// Returns pose and covariance of a robot at `time` after a motion from `state`, including the errors that do not
/// average out. The velocity is 0.
Estimate estimate_after(const Team& team, const TeamState& state, std::uint32_t robot, const TeamMotion& moved,
                        std::int64_t time);

// Events and speeds of readings, with the times at which they are applied. `time` [ns] is the reading's timestamp.

TeamEvent start_event(std::uint32_t robot, std::int64_t time, const base::Pose& X_WM, const PoseCovariance& covariance);
TeamEvent sighting_event(const TeamModel& model, std::uint32_t robot, std::int64_t time, std::uint32_t target,
                         double range, double bearing);
Speeds effective_speeds(const TeamModel& model, std::int64_t time, double forward, double turn);

}  // namespace sf::estimation
