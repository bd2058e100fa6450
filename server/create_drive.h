#pragma once
// Drives a real iRobot Create on a serial line in place of a robot's motion model. Commands are sent to its wheels. Its
// pose is dead-reckoned from the start pose, by the distances and angles that it reports (odometry).

#include <cstdint>
#include <optional>
#include <string>

#include "base/report.h"
#include "netio/serial_line.h"
#include "robots/open_interface.h"
#include "sensors/odometer.h"

namespace sf::server {

struct CreateOptions {
  std::string device;     ///< "/dev/ttyUSB0"
  unsigned baud = 57600;  ///< Create: 57600; Create 2 and Roombas of the series 500 and later: 115200
};

struct CreateCounts {
  std::uint64_t frames = 0;           ///< received from its sensor stream
  std::uint64_t wrong_checksums = 0;  ///< dropped frames; the distance in them is lost
  std::uint64_t skipped_bytes = 0;    ///< outside frames
  std::uint64_t starts = 0;           ///< starts of the robot, repeated after silence and after reopening the line
  std::uint64_t lines = 0;            ///< number of times the line was opened
  std::uint64_t refused = 0;          ///< commands dropped because the line's buffer was full
};

/// Times [ns] are on the robot's own monotonic clock. Not thread-safe.
class CreateDrive {
 public:
  /// @param X_WM start pose @param track [m] > 0
  /// @throws base::InputError if the line cannot be opened
  CreateDrive(const CreateOptions& options, const base::Pose& X_WM, double track);
  /// Stops the robot.
  ~CreateDrive() { stop(); }
  CreateDrive(const CreateDrive&) = delete;
  CreateDrive& operator=(const CreateDrive&) = delete;

  /// Processes received frames. After half a second of silence, restarts the robot once a second and reopens a lost
  /// line.
  void update(std::int64_t now);
  /// Applies until the next call; call it at every step. The robot stops while it is silent or not in safe mode.
  void drive(const base::Twist& twist, std::int64_t now);
  /// Stops the wheels and the stream, and enters passive mode.
  void stop();

  /// Returns whether a frame arrived in the last half second and the robot accepts commands.
  bool ready(std::int64_t now) const { return problem(now).empty(); }
  /// Returns why the robot is not ready; empty if it is.
  std::string problem(std::int64_t now) const;
  /// Pose by odometry, and twist of the last update.
  const base::Report& state() const { return state_; }
  /// [m] Distances of its wheels since the start, by odometry.
  const sensors::Rolled& rolled() const { return rolled_; }
  /// Returns whether any frame of the last update that had frames reported a bump or a wheel drop.
  bool contact() const { return contact_; }
  CreateCounts counts() const;

 private:
  bool silent(std::int64_t now) const;
  bool receive();
  void revive(std::int64_t now);
  void start();
  void take(const robots::CreateFrame& frame);

  CreateOptions options_;
  double track_;
  std::optional<netio::SerialLine> line_;  ///< empty: the line is lost
  robots::CreateStream stream_;
  robots::CreateFrame frame_;  ///< most recent
  bool contact_ = false;
  std::optional<std::int64_t> last_;     ///< [ns] of the last update with a frame
  std::optional<std::int64_t> revived_;  ///< [ns]
  bool lifted_ = false;                  ///< lifted since it was last in safe mode
  base::Report state_;
  sensors::Rolled rolled_;
  CreateCounts counts_;
};

}  // namespace sf::server
