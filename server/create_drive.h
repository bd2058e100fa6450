#pragma once
// A real iRobot Create on a serial line, in place of a robot's motion model: commands go to its wheels, and its pose is
// the sum of the distances and angles that it reports (odometry) from the start pose on.

#include <cstdint>
#include <optional>
#include <string>

#include "base/report.h"
#include "netio/serial_line.h"
#include "robots/open_interface.h"

namespace sf::server {

struct CreateOptions {
  std::string device;     ///< "/dev/ttyUSB0"
  unsigned baud = 57600;  ///< Create: 57600; Create 2 and Roombas of the series 500 and later: 115200
};

struct CreateCounts {
  std::uint64_t frames = 0;           ///< of its sensor stream
  std::uint64_t wrong_checksums = 0;  ///< frames that were left out; the way in them is lost
  std::uint64_t skipped_bytes = 0;    ///< in no frame
  std::uint64_t starts = 0;           ///< times that the robot was started: again after silence and after a new line
  std::uint64_t lines = 0;            ///< times that the line was opened
  std::uint64_t refused = 0;          ///< commands that a full line did not take
};

/// Times are of the robot's own clock [ns], which does not go back. One thread.
class CreateDrive {
 public:
  /// @param X_WM start pose @param track [m] > 0
  /// @throws base::InputError where the line cannot be opened
  CreateDrive(const CreateOptions& options, const base::Pose& X_WM, double track);
  /// Stops the robot.
  ~CreateDrive() { stop(); }
  CreateDrive(const CreateDrive&) = delete;
  CreateDrive& operator=(const CreateDrive&) = delete;

  /// Takes what came. After half a second of silence it starts the robot anew, once a second, and opens a lost line.
  void update(std::int64_t now);
  /// Until the next call; call it at every step. At rest while the robot is silent or has left safe mode.
  void drive(const base::Twist& twist, std::int64_t now);
  /// At rest, stream off, passive mode.
  void stop();

  /// A frame came in the last half second, and the robot takes commands.
  bool ready(std::int64_t now) const { return problem(now).empty(); }
  /// Why not; empty: it is ready.
  std::string problem(std::int64_t now) const;
  /// Pose by odometry, twist of the last update.
  const base::Report& state() const { return state_; }
  /// A bump or a wheel drop in any frame of the last update with frames.
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
  std::optional<netio::SerialLine> line_;  ///< none: lost
  robots::CreateStream stream_;
  robots::CreateFrame frame_;  ///< the last one
  bool contact_ = false;
  std::optional<std::int64_t> last_;     ///< [ns] of the last update with a frame
  std::optional<std::int64_t> revived_;  ///< [ns]
  bool lifted_ = false;                  ///< since it was last in safe mode
  base::Report state_;
  CreateCounts counts_;
};

}  // namespace sf::server
