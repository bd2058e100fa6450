#pragma once
// Forwards velocities that users of bridges command to the processes that own the robots, as DRIVE packets.
//
//   relay.command(mover, twist);         // a user's command
//   relay.send(now, receiver);           // each tick

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/pose.h"
#include "server/state_receiver.h"
#include "world/world.h"

namespace sf::server {

struct DriveCounts {
  std::uint64_t sent = 0;     ///< DRIVE packets queued
  std::uint64_t dropped = 0;  ///< commands of robots that no process drives by DRIVE
};

/// Sends at most one packet per robot and tick, whatever the number of commands. A command is repeated every tick until
/// the next one, so that a lost packet does not stop the robot; a command of rest for a second only. Single-threaded,
/// except for `follows`.
class DriveRelay {
 public:
  /// The world must outlive it.
  explicit DriveRelay(const world::World& world);

  /// Replaces the command of a mover. @param twist finite; clamped to kMaxSpeed
  void command(std::uint32_t mover, const base::Twist& twist);
  /// Queues the packets of a tick at `now` [ns]. Drops commands for robots without a process that follows them, and
  /// logs the reason at once and then at most every ten seconds per robot.
  void send(std::int64_t now, StateReceiver& receiver);

  /// Returns whether the robot's process followed DRIVE at the last tick. Any thread may call it.
  bool follows(std::uint32_t mover) const { return rows_[mover].follows; }
  const DriveCounts& counts() const { return counts_; }

 private:
  struct Row {
    std::optional<base::Twist> twist;
    std::int64_t rests_since = -1;  ///< [ns] of the first packet with this command of rest; -1: none
    std::uint32_t sequence = 0;
    std::int64_t next_line = 0;  ///< [ns] time before which nothing is logged
    std::atomic<bool> follows = false;
  };
  void refuse(Row& row, std::uint32_t mover, std::int64_t now, StateReceiver& receiver);

  const world::World& world_;
  std::vector<Row> rows_;  ///< per mover
  base::Bytes packet_;
  DriveCounts counts_;
};

}  // namespace sf::server
