#pragma once
// Log of a robot's process: why the robot stands, and when it drives on.

#include <cstdint>
#include <optional>
#include <string>

#include "netio/rate_limited_log.h"
#include "server/robot_link.h"

namespace sf::server {

/// One thread. Times are of the robot's own clock [ns].
class RobotClientLog {
 public:
  /// @param robot name in the world @param descriptor of the lines; -1: none
  /// @param reading_timeout [ns] without a reading after which the robot stands; 0: never
  RobotClientLog(std::string robot, std::uint32_t id, int descriptor, std::int64_t reading_timeout);

  /// Logs what has changed since the last step: no answer or refused signatures, lost positions, missing readings.
  /// @param lost no camera sees the robot; nullopt: it has no cameras
  void note_link(const RobotLink& link, std::optional<bool> lost, std::int64_t now);
  /// Logs the reason for which the real robot does not drive each time that it changes, but not the silence before its
  /// first answer is due. @param problem "": none @param answered a frame has arrived
  void note_create(const std::string& problem, bool answered, std::int64_t now);

  /// No whole reading has arrived for the timeout.
  bool readings_timed_out(const RobotLink& link, std::int64_t now) const;
  std::uint64_t stops() const { return stops_; }  ///< times that the robot stood for want of readings or positions
  std::uint64_t left_out() const { return log_.left_out(); }  ///< lines

 private:
  void note_signatures(const RobotLink& link, std::int64_t now);

  std::string robot_;
  std::uint32_t id_;
  std::int64_t reading_timeout_;
  netio::RateLimitedLog log_;
  bool problem_logged_ = false;
  std::uint64_t troubles_ = 0;     ///< refused packets that came before
  std::int64_t next_trouble_ = 0;  ///< [ns] not logged before
  bool stands_ = false;            ///< for want of readings
  bool was_lost_ = true;           ///< at the last step; no camera has seen the robot at the start
  std::uint64_t stops_ = 0;
  std::string create_problem_;  ///< as logged last
};

}  // namespace sf::server
