#pragma once
// A real robot, on a serial line or behind a Player server, in place of a robot's motion model. Commands are sent to
// its wheels. Its pose is dead-reckoned from the start pose, by its own odometry.
//
//   const auto robot = make_real_robot({.type = "khepera", .device = "/dev/ttyUSB0"}, X_WM, track);
//   robot->update(now);
//   robot->drive(twist, now);

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "netio/byte_line.h"
#include "netio/endpoint.h"
#include "sensors/odometer.h"
#include "server/own_reading.h"
#include "world/world.h"

namespace sf::server {

class RealRobot;

struct RealRobotOptions {
  std::string type = "create";  ///< word of a RealRobotType
  std::string device;           ///< "/dev/ttyUSB0"; empty for a server; the name of an emulated robot
  unsigned baud = 0;            ///< 0: the default of the type
  netio::Endpoint server;       ///< of a type that is behind a server
  std::shared_ptr<const world::World> world = {};  ///< that an emulated robot drives in
  std::uint64_t seed = 1;                          ///< of the noise of its sensors
};

/// Description of one type of real robots.
struct RealRobotType {
  std::string_view word;          ///< "create"
  std::string_view title;         ///< "Create"
  bool behind_server = false;     ///< on TCP, instead of a serial line
  bool emulated = false;          ///< without a line: it drives in a world of its own
  unsigned baud = 57600;          ///< default
  int stop_bits = 1;              ///< 1 or 2
  double distance = 1e-3;         ///< [m] resolution of its odometry
  double angle = 0.0;             ///< [rad] resolution of its heading; 0: it counts the wheels
  double slip = 0.003;            ///< [m^(1/2)] assumed slip of its wheels on a smooth floor
  std::size_t most_bytes = 8192;  ///< read per update: on a serial line, more than one second at 57600 baud
  std::int64_t restart = 0;       ///< [ns] of silence of a robot behind a server after which its connection is replaced
  std::int64_t poll = 0;          ///< [ns] longest time between two updates, for answers and its watchdog; 0: unlimited
  std::unique_ptr<RealRobot> (*make)(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM,
                                     double track) = nullptr;
};
std::span<const RealRobotType> real_robot_types();
/// @throws base::InputError for an unknown word; the message lists all
const RealRobotType& real_robot_type(std::string_view word);

/// @param X_WM start pose @param track [m] > 0
/// @throws base::InputError for an unknown type, or if the line cannot be opened or the server does not accept the
/// connection within three seconds
std::unique_ptr<RealRobot> make_real_robot(const RealRobotOptions& options, const base::Pose& X_WM, double track);

struct RealRobotCounts {
  std::uint64_t frames = 0;         ///< valid frames or answers received
  std::uint64_t wrong = 0;          ///< dropped: wrong checksum, or not the expected answer
  std::uint64_t skipped_bytes = 0;  ///< outside frames
  std::uint64_t starts = 0;         ///< starts of the robot, repeated after silence and after reopening the line
  std::uint64_t lines = 0;          ///< number of times the line was opened
  std::uint64_t refused = 0;        ///< commands dropped because the line's buffer was full
  std::uint64_t timeouts = 0;       ///< requests without an answer
};

/// A quantity that the robot reported, for reports: {"battery_V", 14.2}.
struct RobotFact {
  std::string_view name;  ///< with its unit
  double value = 0.0;
};

/// Times [ns] are on the robot's own monotonic clock. Not thread-safe. Derived classes stop the robot on destruction.
class RealRobot {
 public:
  virtual ~RealRobot() = default;
  RealRobot(const RealRobot&) = delete;
  RealRobot& operator=(const RealRobot&) = delete;

  /// Processes received bytes. After half a second of silence, restarts the robot once a second, except behind a
  /// server, and reopens a lost line.
  void update(std::int64_t now);
  /// Applies until the next call; call it at every step. The robot stops while it is not ready.
  virtual void drive(const base::Twist& twist, std::int64_t now) = 0;
  /// Sets digital outputs, by the numbers of the robot's bits, from the next `drive` on.
  /// @return false if it has none
  virtual bool set_outputs(std::uint8_t /*bits*/) { return false; }
  /// Stops the wheels and ends the session. Blocks for less than a second.
  virtual void stop() = 0;
  /// Returns the time of the next `update` that the robot needs between steps, INT64_MAX: none.
  std::int64_t due() const { return due_; }

  /// Returns whether the robot answered in the last half second and accepts commands.
  bool ready(std::int64_t now) const { return problem(now).empty(); }
  /// Returns why the robot is not ready; empty if it is.
  std::string problem(std::int64_t now) const;
  /// Pose by odometry, and twist between the last two reports of it.
  const base::Report& state() const { return state_; }
  /// [m] Distances since the start, by odometry, of wheels at the distance `track` [m] from each other.
  sensors::Rolled rolled(double track) const;
  std::uint64_t odometry() const { return odometry_; }  ///< number of odometry reports
  /// Returns whether the last update that had reports of contacts had one of a contact.
  bool contact() const { return contact_; }
  std::span<const OwnReading> readings() const { return readings_; }
  virtual std::vector<RobotFact> facts() const { return {}; }
  virtual RealRobotCounts counts() const { return counts_; }
  const RealRobotType& type() const { return type_; }

 protected:
  /// @throws base::InputError if the line cannot be opened
  RealRobot(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM);

  /// Starts or restarts the robot.
  virtual void start(std::int64_t now) = 0;
  virtual void take(std::span<const std::uint8_t> bytes, std::int64_t now) = 0;
  /// Sends due requests. Called after `take`.
  virtual void run(std::int64_t) {}
  /// Returns why an answering robot is not ready; empty if it is.
  virtual std::string fault() const { return {}; }
  /// Returns why a robot does not answer. @param connected the line is open
  virtual std::string silence(bool connected) const;

  bool write(std::span<const std::uint8_t> bytes);
  netio::ByteLine* line() { return line_.get(); }  ///< null: lost
  const netio::Endpoint& server() const { return options_.server; }
  /// Closes the line, which is opened again as a lost one.
  void hang_up() { line_.reset(); }
  /// Notes that the robot answered in this update.
  void heard(std::int64_t now) { last_ = now; }
  /// Adds motion along an arc. @param way [m] forward positive @param turn [rad] counter-clockwise
  void advance(double way, double turn);
  /// Returns `counts_` with those of the stream of frames.
  template <class Stream>
  RealRobotCounts counts_with(const Stream& stream) const {
    RealRobotCounts counts = counts_;
    counts.frames = stream.frames();
    counts.wrong = stream.wrong_checksums();
    counts.skipped_bytes = stream.skipped();
    return counts;
  }
  void touch(bool contact) { touched_ = touched_.value_or(false) || contact; }
  /// Takes the newest reading of one of its own sensors. Sets its number.
  void measured(OwnReading own);
  void measured(std::uint8_t type, std::vector<double> values, std::int64_t now) {
    measured({.type = type, .time = now, .values = std::move(values)});
  }

  RealRobotCounts counts_;

 private:
  std::unique_ptr<netio::ByteLine> open(int wait_ms) const;
  bool silent(std::int64_t now) const;
  void receive(std::int64_t now);
  void revive(std::int64_t now);

  const RealRobotType& type_;
  RealRobotOptions options_;
  std::unique_ptr<netio::ByteLine> line_;  ///< null: the line is lost
  std::optional<std::int64_t> last_;       ///< [ns] of the last update with an answer
  std::optional<std::int64_t> revived_;    ///< [ns]
  std::int64_t due_ = INT64_MAX;           ///< [ns]
  base::Report state_;
  double way_ = 0.0, turn_ = 0.0;  ///< [m], [rad] since the start
  std::uint64_t odometry_ = 0;
  std::int64_t odometry_time_ = 0;  ///< [ns] of the last update with an odometry report
  std::optional<bool> touched_;     ///< in this update
  bool contact_ = false;
  std::vector<OwnReading> readings_;
};

}  // namespace sf::server
