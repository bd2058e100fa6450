#pragma once
// Data exchanged between the thread of a run and the thread of the Player server.

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "bridges/bridge.h"
#include "bridges/player/devices.h"
#include "bridges/player/readings.h"
#include "bridges/player/robot_control.h"

namespace sf::bridges::player {

/// The run as last copied by the server.
struct Snapshot {
  std::int64_t time = 0;               ///< [ns] simulated
  bool is_new = false;                 ///< whether a tick was published since the last `look`
  std::vector<base::Report> reports;   ///< per mover
  std::vector<base::Pose> odometry;    ///< per mover
  std::vector<std::uint8_t> contacts;  ///< per mover
  std::vector<LastReading> readings;   ///< per slot
};

/// Thread-safe. Every call is short: it copies changes, and newer data replaces data that was not fetched.
class Exchange {
 public:
  Exchange(const Scene& scene, const Devices& devices);

  // For the run's thread.
  void publish(const base::TickRecord& tick, const RunState& state);
  void publish(const RunState& state);
  void take(Requests& requests);

  // For the server's thread.
  /// Selects a slot. Readings of unused slots are not copied.
  void use(std::uint32_t slot, bool used);
  void look(Snapshot& snapshot);
  /// Returns the mover's current pose, or the pose where it was last placed. NaN: absent.
  base::Pose pose_of(std::uint32_t mover);
  double seconds();  ///< [s] simulated
  void drive(std::uint32_t mover, const base::Twist& twist);
  void drive(std::uint32_t mover, const Goal& goal);
  /// Stops the robot if a client drives it.
  void stop(std::uint32_t mover);
  /// While off, a robot stays at rest and ignores commands.
  void set_motors(std::uint32_t mover, bool on);
  void set_odometry(std::uint32_t mover, const base::Pose& X_OM);
  void place(std::uint32_t mover, const base::Pose& X_WM);
  void toggle_pause();
  void reset();

 private:
  struct Robot {
    Odometry odometry;
    std::uint32_t encoder = world::kNone;  ///< slot of its encoders
    bool motors = true;
    bool driven = false;  ///< whether a command other than stop is in force
    std::optional<base::Twist> command;
    std::optional<Goal> goal;
    std::optional<base::Pose> placement;
    bool placed = false;  ///< whether the run received the placement
  };
  void begin();
  void set_state(const RunState& state);
  void update(Robot& robot, std::uint32_t mover);

  const Scene scene_;
  const Devices& devices_;
  std::mutex mutex_;
  RunState state_;
  bool is_new_ = false;
  std::int64_t time_ = 0;
  std::vector<Robot> robots_;  ///< per mover
  std::vector<base::Report> reports_;
  std::vector<std::uint8_t> contacts_;
  std::vector<LastReading> readings_;
  std::vector<std::uint32_t> users_;  ///< per slot
  std::vector<std::uint32_t> new_;    ///< slots
  std::optional<bool> pause_;
  bool reset_ = false;
};

}  // namespace sf::bridges::player
